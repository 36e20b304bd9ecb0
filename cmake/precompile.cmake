# Precompiled headers: parsing the headers of other projects takes a fifth to a third of the time in which a source compiles.
# Sets of headers are shared by all targets with the same options. Builds without unity builds do not use them, so that a
# source which does not include what it uses is noticed there; packages do not either.
if(CMAKE_UNITY_BUILD AND NOT KOBOSHI_PACKAGE)
  set(KOBOSHI_MAY_PRECOMPILE ON)
else()
  set(KOBOSHI_MAY_PRECOMPILE OFF)
endif()
option(KOBOSHI_PRECOMPILE "Precompile the headers of other projects" ${KOBOSHI_MAY_PRECOMPILE})

set(KOBOSHI_STANDARD_HEADERS
  <algorithm> <array> <charconv> <chrono> <cmath> <functional> <iomanip> <map> <memory> <numbers> <numeric> <optional> <random> <ranges>
  <set> <span> <sstream> <stdexcept> <string> <string_view> <tuple> <unordered_map> <utility> <variant> <vector>)
set(KOBOSHI_HOST_HEADERS ${KOBOSHI_STANDARD_HEADERS} <filesystem> <fstream> <thread> <Eigen/Dense> <fmt/format.h> <nlohmann/json.hpp>)
set(KOBOSHI_QT_HEADERS ${KOBOSHI_HOST_HEADERS} <QtWidgets>)

# The libraries whose headers are precompiled, with all definitions that the users of a set have: _FILE_OFFSET_BITS is one of
# tinyxml2 in Debian 13, and changes the standard library's headers.
if(KOBOSHI_SIMULATION)
  find_package(fmt REQUIRED)
  find_package(Eigen3 REQUIRED NO_MODULE)
  find_package(nlohmann_json REQUIRED)
  find_package(tinyxml2 REQUIRED)
  set(KOBOSHI_HOST_LIBRARIES fmt::fmt Eigen3::Eigen nlohmann_json::nlohmann_json tinyxml2::tinyxml2)
endif()

# koboshi_share_headers(TARGET SET OPTIONS options LIBRARIES library ... HEADERS header ...) gives the target the set of
# precompiled headers. The first call for a set defines it as koboshi_SET, which is never linked. The options are those that
# the target has beside koboshi_options.
function(koboshi_share_headers target set)
  cmake_parse_arguments(PARSE_ARGV 2 arg "" "OPTIONS" "LIBRARIES;HEADERS")
  get_target_property(type ${target} TYPE)
  if(NOT TARGET koboshi_${set})
    set(source ${PROJECT_BINARY_DIR}/koboshi_${set}.cc)
    if(NOT EXISTS ${source})
      file(WRITE ${source} "int main() {}\n")
    endif()
    if(type STREQUAL "EXECUTABLE")  # position-independent code of an executable has other options than that of a library
      add_executable(koboshi_${set} EXCLUDE_FROM_ALL ${source})
    else()
      add_library(koboshi_${set} STATIC EXCLUDE_FROM_ALL ${source})
    endif()
    target_link_libraries(koboshi_${set} PRIVATE koboshi_options ${arg_LIBRARIES})
    target_compile_options(koboshi_${set} PRIVATE ${arg_OPTIONS})
    target_precompile_headers(koboshi_${set} PRIVATE ${arg_HEADERS})
  endif()
  foreach(library ${arg_LIBRARIES})  # without linking them
    target_compile_definitions(${target} PRIVATE $<TARGET_PROPERTY:${library},INTERFACE_COMPILE_DEFINITIONS>)
  endforeach()
  target_precompile_headers(${target} REUSE_FROM koboshi_${set})
  target_compile_options(${target} PRIVATE -Wno-error=invalid-pch)  # the compiler then reads the headers themselves
  if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
    # GCC takes precompiled functions of the standard library for ours, and warns of memory that they do not touch. The presets
    # without precompiled headers have these warnings.
    target_compile_options(${target} PRIVATE -Wno-array-bounds -Wno-maybe-uninitialized -Wno-restrict -Wno-stringop-overflow
                                             -Wno-stringop-overread)
  endif()
endfunction()

# koboshi_share_library_headers(NAME [QT]) is for a library of the host with the options of its folder. Only GCC accepts the
# headers in spite of the definitions of a single library.
function(koboshi_share_library_headers name)
  cmake_parse_arguments(PARSE_ARGV 1 arg "QT" "" "")
  if(NOT KOBOSHI_PRECOMPILE OR NOT KOBOSHI_SIMULATION OR NOT CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
    return()
  endif()
  get_directory_property(options COMPILE_OPTIONS)
  set(level "")
  if(KOBOSHI_LIGHT_OPTIONS IN_LIST options)
    set(level light_)
  endif()
  if(arg_QT AND level)
    koboshi_share_headers(${name} light_qt_headers LIBRARIES ${KOBOSHI_HOST_LIBRARIES} koboshi_qt HEADERS ${KOBOSHI_QT_HEADERS})
  elseif(NOT arg_QT)
    koboshi_share_headers(${name} ${level}host_headers LIBRARIES ${KOBOSHI_HOST_LIBRARIES} HEADERS ${KOBOSHI_HOST_HEADERS})
  endif()
endfunction()

# koboshi_share_test_headers(NAME [QT]) is for a test program with the options KOBOSHI_TEST_OPTIONS.
function(koboshi_share_test_headers name)
  cmake_parse_arguments(PARSE_ARGV 1 arg "QT" "" "")
  if(NOT KOBOSHI_PRECOMPILE)
    return()
  endif()
  cmake_path(RELATIVE_PATH CMAKE_CURRENT_SOURCE_DIR BASE_DIRECTORY ${koboshi_SOURCE_DIR} OUTPUT_VARIABLE folder)
  set(gtest LIBRARIES GTest::gtest GTest::gmock)
  if(arg_QT)
    koboshi_share_headers(${name} qt_test_headers OPTIONS ${KOBOSHI_TEST_OPTIONS} LIBRARIES ${KOBOSHI_HOST_LIBRARIES} Qt6::Test koboshi_qt
                          HEADERS ${KOBOSHI_QT_HEADERS} <QtTest>)
  elseif(NOT KOBOSHI_SIMULATION OR folder MATCHES "^tests/unit/(firmware|hal)")
    koboshi_share_headers(${name} firmware_test_headers OPTIONS ${KOBOSHI_TEST_OPTIONS} ${gtest}
                          HEADERS ${KOBOSHI_STANDARD_HEADERS} <gmock/gmock.h> <gtest/gtest.h>)
  else()
    koboshi_share_headers(${name} host_test_headers OPTIONS ${KOBOSHI_TEST_OPTIONS} ${gtest} ${KOBOSHI_HOST_LIBRARIES}
                          HEADERS ${KOBOSHI_HOST_HEADERS} <regex> <gmock/gmock.h> <gtest/gtest.h>)
  endif()
endfunction()
