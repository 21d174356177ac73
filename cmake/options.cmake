# Compiler options shared by every target of the project.
add_library(raywatt_options INTERFACE)
target_include_directories(raywatt_options INTERFACE ${PROJECT_SOURCE_DIR})
target_compile_options(raywatt_options INTERFACE
  -Wall -Wextra -Wpedantic -Wconversion -Wshadow
  # Hits must be equal with every compiler: no implicit fused multiply-add.
  -ffp-contract=off
  # Loaded modules replace no functions, so relocatable code may be inlined.
  -fno-semantic-interposition)
# A fold over all kernels is deeper than clang allows by default.
target_compile_options(raywatt_options INTERFACE $<$<CXX_COMPILER_ID:Clang>:-fbracket-depth=1024>)
if(CMAKE_SYSTEM_PROCESSOR MATCHES "x86_64|AMD64")
  target_compile_options(raywatt_options INTERFACE -march=x86-64-v3)
endif()
if(RAYWATT_WERROR)
  target_compile_options(raywatt_options INTERFACE -Werror)
endif()
if(RAYWATT_SANITIZE)
  target_compile_options(raywatt_options INTERFACE -fsanitize=${RAYWATT_SANITIZE} -fno-omit-frame-pointer
    -fno-sanitize-recover=all  # a program ends at its first finding (of threads: halt_on_error)
    # GCC 12 warns of uninitialised values in sanitizer checks inside <regex>.
    $<$<CXX_COMPILER_ID:GNU>:-Wno-maybe-uninitialized>)
  # Tests that need the plain heap or an installation check it.
  target_compile_definitions(raywatt_options INTERFACE RAYWATT_SANITIZED)
  target_link_options(raywatt_options INTERFACE -fsanitize=${RAYWATT_SANITIZE})
endif()

# Precompiled: outside headers that most files include. An edit of our headers rebuilds only their users. Sources still
# include what they use; the preset `clang` builds without precompiled headers.
set(raywatt_common_headers <algorithm> <array> <cmath> <cstdint> <filesystem> <functional> <map> <memory> <optional>
  <set> <span> <string> <string_view> <utility> <vector> <fmt/format.h>)

# raywatt_light(TARGET): -O1, for code that does not run often.
function(raywatt_light target)
  target_compile_options(${target} PRIVATE $<$<CONFIG:Release>:-O1>)
endfunction()

# raywatt_joined(TARGET): compiles ten sources as one, so that templates (CLI11, JSON, GoogleTest) are instantiated once
# a batch.
function(raywatt_joined target)
  if(NOT CMAKE_DISABLE_PRECOMPILE_HEADERS)
    set_target_properties(${target} PROPERTIES UNITY_BUILD ON UNITY_BUILD_BATCH_SIZE 10)
  endif()
endfunction()

# raywatt_library(NAME [LIGHT] libraries...): a static library of every .cc below the calling folder. LIGHT:
# raywatt_light(), with its own precompiled header, because GCC 14 refuses one compiled at another -O.
function(raywatt_library name)
  cmake_parse_arguments(PARSE_ARGV 1 library "LIGHT" "" "")
  file(GLOB_RECURSE sources CONFIGURE_DEPENDS ${CMAKE_CURRENT_SOURCE_DIR}/*.cc)
  if(NOT sources)
    file(WRITE ${CMAKE_CURRENT_BINARY_DIR}/empty.cc "")
    set(sources ${CMAKE_CURRENT_BINARY_DIR}/empty.cc)
  endif()
  add_library(${name} STATIC ${sources})
  set_target_properties(${name} PROPERTIES LINKER_LANGUAGE CXX)
  set_target_properties(${name} PROPERTIES POSITION_INDEPENDENT_CODE ON)
  target_link_libraries(${name} PUBLIC raywatt_options ${library_UNPARSED_ARGUMENTS})
  if(library_LIGHT)
    raywatt_light(${name})
  endif()
  if(library_LIGHT OR name STREQUAL raywatt_sim)
    target_precompile_headers(${name} PRIVATE ${raywatt_common_headers})
  else()
    target_precompile_headers(${name} REUSE_FROM raywatt_sim)
  endif()
endfunction()

# raywatt_test(FOLDER [FAST] [HOT] libraries... [TOGETHER suites...]): one GoogleTest program of every .cc below
# tests/FOLDER. FAST: its tests run in `ctest -L fast`, which must end within 30 seconds. HOT: see raywatt_test_program().
# TOGETHER: suites that share a fixture, which run in one process each; "*" runs the whole program in one.
function(raywatt_test folder)
  cmake_parse_arguments(PARSE_ARGV 1 test "FAST;HOT" "" "TOGETHER")
  file(GLOB_RECURSE sources CONFIGURE_DEPENDS ${CMAKE_CURRENT_SOURCE_DIR}/${folder}/*.cc)
  if(NOT sources)
    return()
  endif()
  string(REPLACE "/" "_" name test_${folder})
  set(hot)
  if(test_HOT)
    set(hot HOT)
  endif()
  raywatt_test_program(${name} ${hot} ${sources})
  target_link_libraries(${name} PRIVATE ${test_UNPARSED_ARGUMENTS})
  set(labels)
  if(test_FAST)
    set(labels LABELS fast)
  endif()
  set(others)
  foreach(suite ${test_TOGETHER})
    set(test ${folder})
    if(NOT suite STREQUAL "*")
      set(test ${folder}/${suite})
    endif()
    add_test(NAME ${test} COMMAND ${name} "--gtest_filter=${suite}.*" WORKING_DIRECTORY ${PROJECT_SOURCE_DIR})
    set_tests_properties(${test} PROPERTIES TIMEOUT 600 ${labels})
    list(APPEND others "${suite}.*")
  endforeach()
  if("*" IN_LIST test_TOGETHER)
    return()
  endif()
  if(others)
    list(JOIN others ":" others)
    set(others TEST_FILTER "-${others}")
  endif()
  # Parameters have the generator's names: GoogleTest would print structs as bytes and pointers.
  gtest_discover_tests(${name} TEST_PREFIX "${folder}/" ${others} DISCOVERY_MODE PRE_TEST NO_PRETTY_VALUES
    WORKING_DIRECTORY ${PROJECT_SOURCE_DIR} PROPERTIES TIMEOUT 600 ${labels})
endfunction()

# raywatt_test_program(NAME [HOT] sources...): compiled without optimisation, which takes half the time, unless HOT: tests
# that simulate or compute much themselves. Programs of a kind share the precompiled header of the first.
function(raywatt_test_program name)
  cmake_parse_arguments(PARSE_ARGV 1 program "HOT" "" "")
  add_executable(${name} ${program_UNPARSED_ARGUMENTS})
  target_link_libraries(${name} PRIVATE raywatt_options GTest::gtest_main nlohmann_json::nlohmann_json)
  raywatt_joined(${name})
  set_target_properties(${name} PROPERTIES UNITY_BUILD_BATCH_SIZE 20)
  if(program_HOT)
    raywatt_light(${name})
  else()
    target_compile_options(${name} PRIVATE $<$<CONFIG:Release>:-O0>)
  endif()
  get_property(first GLOBAL PROPERTY raywatt_first_test_program_${program_HOT})
  if(first)
    target_precompile_headers(${name} REUSE_FROM ${first})
  else()
    target_precompile_headers(${name} PRIVATE ${raywatt_common_headers} <gtest/gtest.h>)
    set_property(GLOBAL PROPERTY raywatt_first_test_program_${program_HOT} ${name})
  endif()
endfunction()
