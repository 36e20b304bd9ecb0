# The window of the studio needs Qt 6. Without it, everything else is built.
set(KOBOSHI_STUDIO AUTO CACHE STRING "The studio, a program with a window: AUTO where Qt 6 is installed, ON, OFF")
set_property(CACHE KOBOSHI_STUDIO PROPERTY STRINGS AUTO ON OFF)
set(KOBOSHI_HAS_QT FALSE)
if(KOBOSHI_STUDIO)
  find_package(Qt6 6.4 QUIET COMPONENTS Test Widgets)
  set(KOBOSHI_HAS_QT ${Qt6_FOUND})
  if(NOT Qt6_FOUND AND KOBOSHI_STUDIO STREQUAL "ON")
    message(FATAL_ERROR "KOBOSHI_STUDIO is ON, but there is no Qt 6.4 here: on Debian, apt-get install qt6-base-dev")
  endif()
endif()
message(STATUS "The studio: ${KOBOSHI_HAS_QT}")

# Qt Widgets as all sources here use it.
add_library(koboshi_qt INTERFACE)
target_compile_definitions(koboshi_qt INTERFACE QT_NO_KEYWORDS QT_NO_CAST_FROM_ASCII QT_NO_CAST_TO_ASCII)
if(KOBOSHI_HAS_QT)
  target_link_libraries(koboshi_qt INTERFACE Qt6::Widgets)
  # Without the definitions that tell a test its folders: no test needs them, and precompiled headers would serve one folder.
  set_target_properties(Qt6::Test PROPERTIES INTERFACE_COMPILE_DEFINITIONS QT_TESTLIB_LIB)
endif()

# koboshi_qt_library(NAME [SOURCES ...] [DEPS ...]) defines koboshi::NAME as koboshi_library does, with Qt Widgets. Classes with
# Q_OBJECT are in the headers.
function(koboshi_qt_library name)
  koboshi_library(${name} QT ${ARGN})
  koboshi_use_moc(${name})
endfunction()

# The macros QTRY_* of Qt 6.8 convert a number of milliseconds to int in the source that uses them. Linked last, so that this
# option comes after those of koboshi_options.
add_library(koboshi_qt_test_options INTERFACE)
target_compile_options(koboshi_qt_test_options INTERFACE -Wno-conversion)

# koboshi_qt_test(NAME [WINDOW_MANAGER] SOURCES ... [DEPS ...]) defines a program of Qt Test, which ctest runs as one test with the label gui. The
# source has a class with Q_OBJECT, QTEST_MAIN and, at its end, #include "FILE.moc". With WINDOW_MANAGER it runs under one, and
# can press real keys with xdotool.
function(koboshi_qt_test name)
  cmake_parse_arguments(PARSE_ARGV 1 arg "WINDOW_MANAGER" "" "SOURCES;DEPS")
  add_executable(${name} ${arg_SOURCES})
  target_link_libraries(${name} PRIVATE koboshi_options ${arg_DEPS} Qt6::Test koboshi_qt_test_options)
  target_compile_options(${name} PRIVATE ${KOBOSHI_TEST_OPTIONS})
  target_compile_definitions(${name} PRIVATE KOBOSHI_SOURCE_DIR="${PROJECT_SOURCE_DIR}")
  koboshi_use_moc(${name})
  koboshi_share_test_headers(${name} QT)
  set(needs Xvfb)
  set(environment MESA_SHADER_CACHE_DIR=${PROJECT_BINARY_DIR}/shader_cache)
  if(arg_WINDOW_MANAGER)
    list(APPEND needs openbox xdotool)
    list(APPEND environment KOBOSHI_WINDOW_MANAGER=1)
  endif()
  koboshi_command_test(gui.${name} LABEL gui NEEDS ${needs}
    COMMAND ${PROJECT_SOURCE_DIR}/tests/support/with_display.sh $<TARGET_FILE:${name}>)
  # Mesa keeps compiled shaders, as for a user, so that not every program compiles them again.
  set_tests_properties(gui.${name} PROPERTIES ENVIRONMENT "${environment}")
endfunction()

# The compiler's warnings are not for the code that moc generates, and what it includes may not be in a unity build.
function(koboshi_use_moc name)
  set_target_properties(${name} PROPERTIES AUTOMOC ON)
  target_link_libraries(${name} PUBLIC koboshi_qt)
endfunction()
