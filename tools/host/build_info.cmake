# Writes build_info_data.h at every build, but touches it only when something changed: version, git state, compiler,
# model_id, the hash of the model's sources and of the libraries that a result depends on, and report_id.
file(GLOB_RECURSE RAYWATT_MODEL_SOURCES CONFIGURE_DEPENDS RELATIVE ${PROJECT_SOURCE_DIR}
  ${PROJECT_SOURCE_DIR}/sim/*.h ${PROJECT_SOURCE_DIR}/sim/*.cc
  ${PROJECT_SOURCE_DIR}/traces/*.h ${PROJECT_SOURCE_DIR}/traces/*.cc
  ${PROJECT_SOURCE_DIR}/shader_kernels/*.h ${PROJECT_SOURCE_DIR}/shader_kernels/*.cc
  ${PROJECT_SOURCE_DIR}/hw_models/*.h ${PROJECT_SOURCE_DIR}/hw_models/*.cc)
list(SORT RAYWATT_MODEL_SOURCES)
# What makes a report of the model's figures, or estimates them: results are stored under both ids.
file(GLOB_RECURSE RAYWATT_REPORT_SOURCES CONFIGURE_DEPENDS RELATIVE ${PROJECT_SOURCE_DIR}
  host/*.h host/*.cc run/*.h run/*.cc analysis/*.h analysis/*.cc sampling/*.h sampling/*.cc
  studies/sweep/launch/compute.h studies/sweep/launch/compute.cc)
raywatt_require_files(host run analysis sampling studies/sweep/launch/compute.h studies/sweep/launch/compute.cc)
list(SORT RAYWATT_REPORT_SOURCES)

string(TOUPPER "${CMAKE_BUILD_TYPE}" build_type)
string(STRIP "${CMAKE_CXX_FLAGS} ${CMAKE_CXX_FLAGS_${build_type}}" flags)
configure_file(${CMAKE_CURRENT_LIST_DIR}/build_info_script.cmake.in ${CMAKE_CURRENT_BINARY_DIR}/build_info_script.cmake
  @ONLY)
add_custom_target(raywatt_build_info
  COMMAND ${CMAKE_COMMAND} -P ${CMAKE_CURRENT_BINARY_DIR}/build_info_script.cmake
  BYPRODUCTS ${CMAKE_CURRENT_BINARY_DIR}/build_info_data.h)
