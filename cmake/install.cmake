# What `cmake --install` and the two Debian packages contain:
#
#   quayside       the program with what it puts into FMUs, the cases, the documentation
#   quayside-dev   libraries, headers and find_package(Quayside): Quayside::contact, Quayside::harness, Quayside::case_unit
include(GNUInstallDirs)
set(CMAKE_INSTALL_DOCDIR ${CMAKE_INSTALL_DATAROOTDIR}/doc/quayside)
include(CMakePackageConfigHelpers)
set(CMAKE_SKIP_INSTALL_ALL_DEPENDENCY ON)  # the tests need not be built to install

# The program looks for the library of the FMUs beside itself; what users start is a link to it.
set(program_dir ${CMAKE_INSTALL_LIBDIR}/quayside)
install(TARGETS quayside quayside_fmu
  RUNTIME DESTINATION ${program_dir} COMPONENT runtime LIBRARY DESTINATION ${program_dir} COMPONENT runtime)
file(RELATIVE_PATH program_link /${CMAKE_INSTALL_BINDIR} /${program_dir}/quayside)
file(CREATE_LINK ${program_link} ${CMAKE_BINARY_DIR}/installed_link SYMBOLIC)
install(FILES ${CMAKE_BINARY_DIR}/installed_link DESTINATION ${CMAKE_INSTALL_BINDIR} RENAME quayside COMPONENT runtime)
add_custom_command(OUTPUT completion.bash COMMAND quayside completion > completion.bash DEPENDS quayside VERBATIM)
add_custom_target(completion ALL DEPENDS completion.bash)
install(FILES ${CMAKE_BINARY_DIR}/completion.bash RENAME quayside
  DESTINATION ${CMAKE_INSTALL_DATADIR}/bash-completion/completions COMPONENT runtime)
set_target_properties(quayside_fmu PROPERTIES INSTALL_RPATH "\$ORIGIN")
install(DIRECTORY cases/ DESTINATION ${CMAKE_INSTALL_DATADIR}/quayside/cases COMPONENT runtime
  FILES_MATCHING PATTERN "*.yaml" PATTERN "*.csv" PATTERN "schema.json")
foreach(document README.md cases/README.md cases/format.md contact_nn/README.md contact_nn/paper/README.md harness/README.md spreader/README.md)
  get_filename_component(folder ${document} DIRECTORY)
  install(FILES ${document} DESTINATION ${CMAKE_INSTALL_DOCDIR}/${folder} COMPONENT runtime)
endforeach()

# Every library that quayside_case_unit needs, all of them static. Eigen's alignment is part of their interface.
set(libraries contact spreader crane_models cases core simbody mujoco fmi_import harness case_unit)
foreach(library ${libraries})
  set_target_properties(quayside_${library} PROPERTIES EXPORT_NAME ${library})
  target_compile_features(quayside_${library} INTERFACE cxx_std_17)
  if(QUAYSIDE_NATIVE)
    target_compile_options(quayside_${library} INTERFACE $<INSTALL_INTERFACE:-march=native>)
  else()
    target_compile_definitions(quayside_${library} INTERFACE $<INSTALL_INTERFACE:EIGEN_MAX_ALIGN_BYTES=16>)
  endif()
endforeach()
list(TRANSFORM libraries PREPEND quayside_)
install(TARGETS ${libraries} EXPORT quayside_targets ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR} COMPONENT development
  INCLUDES DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/quayside)
foreach(folder contact_nn spreader crane_models cases harness)
  install(DIRECTORY ${folder} DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/quayside COMPONENT development
    FILES_MATCHING PATTERN "*.h" PATTERN "commands" EXCLUDE PATTERN "report" EXCLUDE PATTERN "results" EXCLUDE
    PATTERN "networks" EXCLUDE)
endforeach()
set(config_dir ${CMAKE_INSTALL_LIBDIR}/cmake/Quayside)
install(EXPORT quayside_targets NAMESPACE Quayside:: FILE QuaysideTargets.cmake DESTINATION ${config_dir} COMPONENT development)
write_basic_package_version_file(${CMAKE_BINARY_DIR}/QuaysideConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES cmake/QuaysideConfig.cmake ${CMAKE_BINARY_DIR}/QuaysideConfigVersion.cmake
  DESTINATION ${config_dir} COMPONENT development)
install(DIRECTORY tests/package/contact_query tests/package/step_case
  DESTINATION ${CMAKE_INSTALL_DOCDIR}/examples COMPONENT development)

set(CPACK_GENERATOR DEB)
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_PACKAGE_VENDOR Quayside)
set(CPACK_PACKAGE_CONTACT "Quayside developers <quayside@example.org>")
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_STRIP_FILES ON)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_SECTION science)
set(CPACK_DEBIAN_RUNTIME_PACKAGE_NAME quayside)
set(CPACK_COMPONENT_RUNTIME_DESCRIPTION "Harbour-crane container-handling simulator
 Simulates scripted crane handling in Simbody with SUNDIALS, with contact forces
 from a neural contact module, and in MuJoCo as the independent reference.")
set(CPACK_DEBIAN_RUNTIME_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_NAME quayside-dev)
set(CPACK_COMPONENT_DEVELOPMENT_DESCRIPTION "Harbour-crane simulator, libraries for C++
 The contact module for boxes (Quayside::contact), engines, units and master
 (Quayside::harness) and whole cases (Quayside::case_unit), with headers, CMake package and examples.")
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_DEPENDS "quayside (= ${PROJECT_VERSION}), libsimbody-dev, libsundials-dev, \
libmujoco-dev, libeigen3-dev, libyaml-cpp-dev, libcli11-dev, libfmt-dev, libtinyxml2-dev, libzip-dev, libonnx-dev, libprotobuf-dev")
set(CPACK_COMPONENTS_ALL runtime development)
include(CPack)
