# Functions to declare targets: one library per second-level folder, one test program per subject.

# Properties of translation units that include this project's headers. They do not include the project's warnings, so
# external projects keep their own.
add_library(koboshi_headers INTERFACE)
target_compile_features(koboshi_headers INTERFACE cxx_std_20)
if(PROJECT_IS_TOP_LEVEL)
  target_include_directories(koboshi_headers INTERFACE $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}>)
else()
  target_include_directories(koboshi_headers SYSTEM INTERFACE $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}>)
endif()
target_include_directories(koboshi_headers INTERFACE $<INSTALL_INTERFACE:include/koboshi>)

# Compiler options of every translation unit of this project, not propagated by libraries. Floating-point contraction is
# off so that runs are bit-identical. No program replaces a function of ours, so that position-independent code may inline it
# (-fno-semantic-interposition; clang does so by itself). Warnings are errors only in our presets, because compilers and
# optimisation levels differ in them (CMAKE_COMPILE_WARNING_AS_ERROR).
add_library(koboshi_options INTERFACE)
target_compile_options(koboshi_options INTERFACE
  -Wall -Wextra -Wconversion -Wsign-conversion -Wdouble-promotion -ffp-contract=off
  $<$<CXX_COMPILER_ID:GNU>:-fno-semantic-interposition>)
target_link_libraries(koboshi_options INTERFACE koboshi_headers)

# Additional compiler options of the firmware on every board: floating-point arithmetic is a compile error on the host.
# tests/proof checks the types of all variables in the debug information.
set(KOBOSHI_FIRMWARE_FLAGS -fno-exceptions -fno-rtti -fno-threadsafe-statics -g)
# Not for the target (-mfloat-abi=soft; the linked image has no such functions), nor for clang, which cannot parse the
# standard headers with this option.
if(NOT CMAKE_SYSTEM_PROCESSOR STREQUAL "cortex-m4" AND NOT CMAKE_CXX_CLANG_TIDY AND CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
  list(APPEND KOBOSHI_FIRMWARE_FLAGS -mgeneral-regs-only)
endif()
add_library(koboshi_firmware_options INTERFACE)
target_compile_options(koboshi_firmware_options INTERFACE ${KOBOSHI_FIRMWARE_FLAGS})

# Options for code outside of a run's loop, which reads, writes and computes tables: it compiles in three quarters of the time.
set(KOBOSHI_LIGHT_OPTIONS $<$<CONFIG:Release>:-O1>)

# Options for tests. Most spend their time in the code under test, which has its own options, and compile in half of the time.
set(KOBOSHI_TEST_OPTIONS $<$<CONFIG:Release>:-O0>)

# For mutants: a change of one source compiles that source alone.
set(KOBOSHI_SEPARATE "" CACHE STRING "Libraries of folders that match this regular expression are built without unity builds")

# koboshi_library(NAME [FIRMWARE] [OBJECT] [QT] [MATRICES] [SOURCES ...] [DEPS ...]) defines koboshi::NAME: a static library,
# with OBJECT an object library, without sources an interface library. cmake/install.cmake installs it with the component of
# its folder. QT: it uses Qt Widgets. MATRICES: its time is that of small matrices. Without Eigen's assertions and with -O3, a
# step of `lumped` takes three quarters of the time and has the same bits; KOBOSHI_ASSERT checks in every build.
function(koboshi_library name)
  cmake_parse_arguments(PARSE_ARGV 1 arg "FIRMWARE;OBJECT;QT;MATRICES" "" "SOURCES;DEPS")
  if(arg_SOURCES)
    set(type STATIC)
    if(arg_OBJECT)
      set(type OBJECT)
    endif()
    add_library(${name} ${type} ${arg_SOURCES})
    target_link_libraries(${name} PRIVATE $<BUILD_INTERFACE:koboshi_options> PUBLIC koboshi_headers ${arg_DEPS})
    if(arg_FIRMWARE)
      target_link_libraries(${name} PRIVATE $<BUILD_INTERFACE:koboshi_firmware_options>)
      set_property(GLOBAL APPEND PROPERTY KOBOSHI_FIRMWARE_LIBRARIES ${name})
    elseif(arg_MATRICES)
      target_compile_options(${name} PRIVATE $<$<CONFIG:Release>:-O3 -DNDEBUG>)
    elseif(arg_QT)
      target_link_libraries(${name} PUBLIC koboshi_qt)
      koboshi_share_library_headers(${name} QT)
    else()
      koboshi_share_library_headers(${name})
    endif()
  else()
    add_library(${name} INTERFACE)
    target_link_libraries(${name} INTERFACE koboshi_headers ${arg_DEPS})
  endif()
  add_library(koboshi::${name} ALIAS ${name})
  cmake_path(RELATIVE_PATH CMAKE_CURRENT_SOURCE_DIR BASE_DIRECTORY ${koboshi_SOURCE_DIR} OUTPUT_VARIABLE folder)
  if(KOBOSHI_SEPARATE AND folder MATCHES "${KOBOSHI_SEPARATE}")
    set_target_properties(${name} PROPERTIES UNITY_BUILD OFF)
  endif()
  if(folder MATCHES "^(hal|firmware)")
    set_property(GLOBAL APPEND PROPERTY KOBOSHI_COMPONENT_firmware ${name})
  elseif(folder MATCHES "^(base|mechanics|sim_board|simulation)")
    set_property(GLOBAL APPEND PROPERTY KOBOSHI_COMPONENT_simulation ${name})
  endif()
endfunction()

# koboshi_test(NAME LABEL label [TOGETHER] [COMPUTES] SOURCES ... [DEPS ...]) defines a GoogleTest program. ctest runs its
# cases under the label; with TOGETHER as one test, for short cases whose common set-up would take most of the time.
# COMPUTES optimises a program that spends much time in its own code.
function(koboshi_test name)
  cmake_parse_arguments(PARSE_ARGV 1 arg "TOGETHER;COMPUTES" "LABEL" "SOURCES;DEPS")
  add_executable(${name} ${arg_SOURCES})
  target_link_libraries(${name} PRIVATE koboshi_options ${arg_DEPS} GTest::gtest GTest::gmock GTest::gtest_main)
  target_compile_options(${name} PRIVATE $<IF:$<BOOL:${arg_COMPUTES}>,${KOBOSHI_LIGHT_OPTIONS},${KOBOSHI_TEST_OPTIONS}>)
  target_compile_definitions(${name} PRIVATE KOBOSHI_SOURCE_DIR="${PROJECT_SOURCE_DIR}"
                                             KOBOSHI_BINARY_DIR="${PROJECT_BINARY_DIR}")
  if(NOT arg_COMPUTES)  # which has other options
    koboshi_share_test_headers(${name})
  endif()
  if(arg_TOGETHER)
    add_test(NAME ${name} COMMAND ${name})
    set_tests_properties(${name} PROPERTIES LABELS ${arg_LABEL})
    return()
  endif()
  gtest_discover_tests(${name} DISCOVERY_MODE PRE_TEST DISCOVERY_TIMEOUT 60 PROPERTIES LABELS ${arg_LABEL})
endfunction()

# koboshi_command_test(NAME LABEL label [NEEDS thing ...] COMMAND command ...) runs a command from the source folder.
# The test is skipped if a needed thing is missing (a program, a path, or module:NAME of Python) or if the command exits
# with status 77.
function(koboshi_command_test name)
  cmake_parse_arguments(PARSE_ARGV 1 arg "" "LABEL" "NEEDS;COMMAND")
  list(TRANSFORM arg_NEEDS PREPEND "--need=")
  add_test(NAME ${name}
           COMMAND /usr/bin/python3 -B ${koboshi_SOURCE_DIR}/tests/support/run_test.py ${arg_NEEDS} -- ${arg_COMMAND}
           WORKING_DIRECTORY ${koboshi_SOURCE_DIR})
  set_tests_properties(${name} PROPERTIES LABELS ${arg_LABEL} SKIP_RETURN_CODE 77)
endfunction()

# koboshi_python_test(NAME LABEL label SCRIPT script [NEEDS thing ...] [ARGS ...]) runs a Python program with Debian's
# interpreter. It is skipped if its unittest skips tests and none fails.
function(koboshi_python_test name)
  cmake_parse_arguments(PARSE_ARGV 1 arg "" "LABEL;SCRIPT" "NEEDS;ARGS")
  koboshi_command_test(${name} LABEL ${arg_LABEL} NEEDS ${arg_NEEDS} COMMAND ${CMAKE_CURRENT_SOURCE_DIR}/${arg_SCRIPT} ${arg_ARGS})
endfunction()

# koboshi_skipped_test(NAME LABEL label REASON reason) reports a test that this build cannot contain as skipped.
function(koboshi_skipped_test name)
  cmake_parse_arguments(PARSE_ARGV 1 arg "" "LABEL;REASON" "")
  koboshi_command_test(${name} LABEL ${arg_LABEL} COMMAND ${CMAKE_COMMAND} -E echo "skipped: ${arg_REASON}")
  set_tests_properties(${name} PROPERTIES SKIP_REGULAR_EXPRESSION "^skipped: ")
endfunction()
