# find_package(Quayside)
#
#   Quayside::contact     the contact module for boxes alone
#   Quayside::harness     units, engines, master, running a case
#   Quayside::case_unit   a whole case as one unit
include(CMakeFindDependencyMacro)
find_dependency(Eigen3)
find_dependency(fmt)
find_dependency(Threads)
find_dependency(CLI11)
find_dependency(yaml-cpp)
find_dependency(tinyxml2)
include(${CMAKE_CURRENT_LIST_DIR}/QuaysideTargets.cmake)
