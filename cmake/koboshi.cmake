# How this project declares its targets: one library a second-level folder, one test program a test file's subject.

# What a translation unit needs that includes headers of this project. A foreign project's own warnings do not apply to them.
add_library(koboshi_headers INTERFACE)
target_compile_features(koboshi_headers INTERFACE cxx_std_20)
if(PROJECT_IS_TOP_LEVEL)
  target_include_directories(koboshi_headers INTERFACE $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}>)
else()
  target_include_directories(koboshi_headers SYSTEM INTERFACE $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}>)
endif()
target_include_directories(koboshi_headers INTERFACE $<INSTALL_INTERFACE:include/koboshi>)

# What every translation unit of this project is compiled with; libraries do not pass it on. Contraction is off so that a run
# repeats to the bit.
add_library(koboshi_options INTERFACE)
target_compile_options(koboshi_options INTERFACE
  -Wall -Wextra -Wconversion -Wsign-conversion -Wdouble-promotion -ffp-contract=off)
if(PROJECT_IS_TOP_LEVEL)  # at another optimisation, another compiler warns of other things: no reason to stop somebody else's build
  target_compile_options(koboshi_options INTERFACE -Werror)
endif()
target_link_libraries(koboshi_options INTERFACE koboshi_headers)

# What the firmware is compiled with besides, on every board: any float arithmetic is a hard error on the host. tests/proof
# reads the types of all variables from the debug information.
set(KOBOSHI_FIRMWARE_FLAGS -fno-exceptions -fno-rtti -fno-threadsafe-statics -g)
# Not for the target (-mfloat-abi=soft; the linked image has no function for it), nor for clang, which cannot read the standard
# headers with it.
if(NOT CMAKE_SYSTEM_PROCESSOR STREQUAL "cortex-m4" AND NOT CMAKE_CXX_CLANG_TIDY)
  list(APPEND KOBOSHI_FIRMWARE_FLAGS -mgeneral-regs-only)
endif()
add_library(koboshi_firmware_options INTERFACE)
target_compile_options(koboshi_firmware_options INTERFACE ${KOBOSHI_FIRMWARE_FLAGS})

# koboshi_library(NAME [FIRMWARE] [SOURCES ...] [DEPS ...]) makes koboshi::NAME; without sources, an interface library. It belongs to
# the component of its folder, as cmake/install.cmake installs them.
function(koboshi_library name)
  cmake_parse_arguments(PARSE_ARGV 1 arg "FIRMWARE" "" "SOURCES;DEPS")
  if(arg_SOURCES)
    add_library(${name} STATIC ${arg_SOURCES})
    target_link_libraries(${name} PRIVATE $<BUILD_INTERFACE:koboshi_options> PUBLIC koboshi_headers ${arg_DEPS})
    if(arg_FIRMWARE)
      target_link_libraries(${name} PRIVATE $<BUILD_INTERFACE:koboshi_firmware_options>)
      set_property(GLOBAL APPEND PROPERTY KOBOSHI_FIRMWARE_LIBRARIES ${name})
    endif()
  else()
    add_library(${name} INTERFACE)
    target_link_libraries(${name} INTERFACE koboshi_headers ${arg_DEPS})
  endif()
  add_library(koboshi::${name} ALIAS ${name})
  cmake_path(RELATIVE_PATH CMAKE_CURRENT_SOURCE_DIR BASE_DIRECTORY ${koboshi_SOURCE_DIR} OUTPUT_VARIABLE folder)
  if(folder MATCHES "^(hal|firmware)")
    set_property(GLOBAL APPEND PROPERTY KOBOSHI_COMPONENT_firmware ${name})
  elseif(folder MATCHES "^(sim_board|simulation)")
    set_property(GLOBAL APPEND PROPERTY KOBOSHI_COMPONENT_simulation ${name})
  endif()
endfunction()

# koboshi_test(NAME LABEL label SOURCES ... [DEPS ...]) makes a GoogleTest program whose cases ctest runs under the label.
function(koboshi_test name)
  cmake_parse_arguments(PARSE_ARGV 1 arg "" "LABEL" "SOURCES;DEPS")
  add_executable(${name} ${arg_SOURCES})
  target_link_libraries(${name} PRIVATE koboshi_options ${arg_DEPS} GTest::gtest GTest::gmock GTest::gtest_main)
  # What a test spends its time in is the code under test, which has its own options; its own is compiled in half the time.
  target_compile_options(${name} PRIVATE $<$<CONFIG:Release>:-O1>)
  target_compile_definitions(${name} PRIVATE KOBOSHI_SOURCE_DIR="${PROJECT_SOURCE_DIR}"
                                             KOBOSHI_BINARY_DIR="${PROJECT_BINARY_DIR}")
  gtest_discover_tests(${name} DISCOVERY_MODE PRE_TEST DISCOVERY_TIMEOUT 60 PROPERTIES LABELS ${arg_LABEL})
endfunction()

# koboshi_command_test(NAME LABEL label [NEEDS thing ...] COMMAND command ...) runs a command from the source folder. The test is skipped
# where a thing is missing (a program, a path, or module:NAME of Python), or the command ends with status 77.
function(koboshi_command_test name)
  cmake_parse_arguments(PARSE_ARGV 1 arg "" "LABEL" "NEEDS;COMMAND")
  list(TRANSFORM arg_NEEDS PREPEND "--need=")
  add_test(NAME ${name}
           COMMAND /usr/bin/python3 -B ${koboshi_SOURCE_DIR}/tests/support/run_test.py ${arg_NEEDS} -- ${arg_COMMAND}
           WORKING_DIRECTORY ${koboshi_SOURCE_DIR})
  set_tests_properties(${name} PROPERTIES LABELS ${arg_LABEL} SKIP_RETURN_CODE 77)
endfunction()

# koboshi_python_test(NAME LABEL label SCRIPT script [NEEDS thing ...] [ARGS ...]) runs a Python program with Debian's interpreter; it is
# skipped if tests of its unittest are and none fails.
function(koboshi_python_test name)
  cmake_parse_arguments(PARSE_ARGV 1 arg "" "LABEL;SCRIPT" "NEEDS;ARGS")
  koboshi_command_test(${name} LABEL ${arg_LABEL} NEEDS ${arg_NEEDS} COMMAND ${CMAKE_CURRENT_SOURCE_DIR}/${arg_SCRIPT} ${arg_ARGS})
endfunction()

# koboshi_skipped_test(NAME LABEL label REASON reason) stands for a test that this build cannot have.
function(koboshi_skipped_test name)
  cmake_parse_arguments(PARSE_ARGV 1 arg "" "LABEL;REASON" "")
  koboshi_command_test(${name} LABEL ${arg_LABEL} COMMAND ${CMAKE_COMMAND} -E echo "skipped: ${arg_REASON}")
  set_tests_properties(${name} PROPERTIES SKIP_REGULAR_EXPRESSION "^skipped: ")
endfunction()
