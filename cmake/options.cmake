# Compiler options shared by every target of the project.
add_library(raywatt_options INTERFACE)
target_include_directories(raywatt_options INTERFACE ${PROJECT_SOURCE_DIR})
target_compile_options(raywatt_options INTERFACE
  -Wall -Wextra -Wpedantic -Wconversion -Wshadow
  # A hit must be the same hit with every compiler: no fused multiply-add that the source does not spell out.
  -ffp-contract=off
  # Nobody replaces our functions when a module is loaded: they may be inlined though the code is relocatable.
  -fno-semantic-interposition)
if(CMAKE_SYSTEM_PROCESSOR MATCHES "x86_64|AMD64")
  target_compile_options(raywatt_options INTERFACE -march=x86-64-v3)
endif()
if(RAYWATT_WERROR)
  target_compile_options(raywatt_options INTERFACE -Werror)
endif()
if(RAYWATT_SANITIZE)
  target_compile_options(raywatt_options INTERFACE -fsanitize=${RAYWATT_SANITIZE} -fno-omit-frame-pointer)
  target_link_options(raywatt_options INTERFACE -fsanitize=${RAYWATT_SANITIZE})
endif()

# raywatt_library(NAME libraries...): a static library of every .cc below the calling folder.
function(raywatt_library name)
  file(GLOB_RECURSE sources CONFIGURE_DEPENDS ${CMAKE_CURRENT_SOURCE_DIR}/*.cc)
  if(NOT sources)
    file(WRITE ${CMAKE_CURRENT_BINARY_DIR}/empty.cc "")
    set(sources ${CMAKE_CURRENT_BINARY_DIR}/empty.cc)
  endif()
  add_library(${name} STATIC ${sources})
  set_target_properties(${name} PROPERTIES LINKER_LANGUAGE CXX)
  set_target_properties(${name} PROPERTIES POSITION_INDEPENDENT_CODE ON)
  target_link_libraries(${name} PUBLIC raywatt_options ${ARGN})
endfunction()

# raywatt_test(FOLDER [FAST] libraries...): one GoogleTest program of every .cc below tests/FOLDER. FAST: its tests are
# chosen by `ctest -L fast`, which must end within 30 seconds.
function(raywatt_test folder)
  cmake_parse_arguments(PARSE_ARGV 1 test "FAST" "" "")
  file(GLOB_RECURSE sources CONFIGURE_DEPENDS ${CMAKE_CURRENT_SOURCE_DIR}/${folder}/*.cc)
  if(NOT sources)
    return()
  endif()
  string(REPLACE "/" "_" name ${folder})
  add_executable(test_${name} ${sources})
  target_link_libraries(test_${name} PRIVATE raywatt_options GTest::gtest_main ${test_UNPARSED_ARGUMENTS})
  set(labels)
  if(test_FAST)
    set(labels LABELS fast)
  endif()
  gtest_discover_tests(test_${name} TEST_PREFIX "${folder}/" DISCOVERY_MODE PRE_TEST
    WORKING_DIRECTORY ${PROJECT_SOURCE_DIR} PROPERTIES TIMEOUT 600 ${labels})
endfunction()
