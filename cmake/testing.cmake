# quayside_test(NAME SOURCE... LIBS LIBRARY...): one GoogleTest binary, its tests registered one by one with CTest.
find_package(GTest REQUIRED)
include(GoogleTest)

function(quayside_test name)
  cmake_parse_arguments(PARSE_ARGV 1 arg "" "" "LIBS")
  add_executable(${name} ${arg_UNPARSED_ARGUMENTS})
  target_link_libraries(${name} PRIVATE ${arg_LIBS} GTest::gtest_main)
  gtest_discover_tests(${name} DISCOVERY_TIMEOUT 60 WORKING_DIRECTORY ${CMAKE_SOURCE_DIR})
endfunction()
