# CPack: the packages for Debian that `./run package` builds (docs/reference/development.md): koboshi, koboshi-studio,
# libkoboshi-dev, python3-koboshi. Every release of Debian gets its own, because it has its own libraries.
set(KOBOSHI_MAINTAINER "Koboshi maintainers <koboshi@example.org>" CACHE STRING "Maintainer of the packages")

set(files ${CMAKE_CURRENT_BINARY_DIR}/package_files)

# Before a release: 0.1.0~20261126.051125+deb12, which is later for later commits, less than 0.1.0+deb12, and less than the same
# commit's in the next release of Debian.
execute_process(COMMAND date -u -d @${KOBOSHI_SOURCE_DATE} +%Y%m%d.%H%M%S OUTPUT_VARIABLE date OUTPUT_STRIP_TRAILING_WHITESPACE)
set(version ${PROJECT_VERSION})
if(NOT KOBOSHI_IS_RELEASE)
  string(APPEND version ~${date})
endif()
if(EXISTS /etc/os-release)
  file(STRINGS /etc/os-release release REGEX "^VERSION_ID=")
  string(REGEX REPLACE "[^0-9.]" "" release "${release}")
  if(release)
    string(APPEND version +deb${release})
  endif()
endif()

file(MAKE_DIRECTORY ${files})
configure_file(cmake/package/copyright ${files}/copyright COPYONLY)
execute_process(
  COMMAND /usr/bin/python3 -B ${PROJECT_SOURCE_DIR}/cmake/package/debian_changelog.py ${PROJECT_SOURCE_DIR}/CHANGELOG.md
          ${version} ${KOBOSHI_SOURCE_DATE} ${KOBOSHI_MAINTAINER}
  COMMAND gzip -9n OUTPUT_FILE ${files}/changelog.gz COMMAND_ERROR_IS_FATAL ANY)

# package(NAME SECTION section COMPONENTS component ... SUMMARY summary TEXT line ... [DEPENDS relation ...] [RECOMMENDS ...]
# [SUGGESTS ...]) declares a package of these components of cmake/install.cmake.
set(CPACK_COMPONENTS_ALL)
function(package name)
  cmake_parse_arguments(PARSE_ARGV 1 arg "" "SECTION;SUMMARY" "COMPONENTS;TEXT;DEPENDS;RECOMMENDS;SUGGESTS")
  install(FILES ${files}/copyright ${files}/changelog.gz DESTINATION share/doc/${name} COMPONENT ${name}-doc EXCLUDE_FROM_ALL)
  string(TOUPPER ${name} group)
  foreach(component IN LISTS arg_COMPONENTS ITEMS ${name}-doc)
    string(TOUPPER ${component} upper)
    set(CPACK_COMPONENT_${upper}_GROUP ${name} PARENT_SCOPE)
    list(APPEND CPACK_COMPONENTS_ALL ${component})
  endforeach()
  set(CPACK_COMPONENTS_ALL ${CPACK_COMPONENTS_ALL} PARENT_SCOPE)
  list(JOIN arg_TEXT "\n" text)
  set(CPACK_DEBIAN_${group}_PACKAGE_NAME ${name} PARENT_SCOPE)
  set(CPACK_DEBIAN_${group}_PACKAGE_SECTION ${arg_SECTION} PARENT_SCOPE)
  set(CPACK_DEBIAN_${group}_DESCRIPTION "${arg_SUMMARY}\n${text}" PARENT_SCOPE)
  foreach(relation DEPENDS RECOMMENDS SUGGESTS)
    list(JOIN arg_${relation} ", " relations)
    set(CPACK_DEBIAN_${group}_PACKAGE_${relation} "${relations}" PARENT_SCOPE)
  endforeach()
endfunction()

# gnuplot draws the figures of a run, Mesa and DejaVu the pictures of koboshi render, ffmpeg its films.
package(koboshi SECTION science COMPONENTS program
  SUMMARY "firmware of a small humanoid robot, and its simulated board"
  TEXT "Koboshi is the firmware of a small humanoid robot, and a simulated board to"
       "run it on. The firmware walks, detects falls, gets up, and commands 20 CANopen"
       "servo drives. The simulated board puts it on a robot in a physics engine, in"
       "lockstep and bit-for-bit repeatable, with a CAN bus."
       "."
       "This package contains the program koboshi, the robots, scenarios and studies,"
       "and the documentation."
  RECOMMENDS fonts-dejavu-core gnuplot-nox libgl1-mesa-dri
  SUGGESTS can-utils ffmpeg koboshi-studio python3-koboshi)
if(TARGET koboshi-studio)
  package(koboshi-studio SECTION science COMPONENTS studio
    SUMMARY "window to run, watch and push a simulated humanoid robot"
    TEXT "Koboshi Studio runs the scenarios of Koboshi, the firmware of a small humanoid"
         "robot: run, push, rewind and plot, follow events and CAN frames, edit motions"
         "and the model of the robot."
    DEPENDS "koboshi (= ${version})")
endif()
set(mujoco)
if(TARGET koboshi_mujoco)
  set(mujoco libmujoco-dev)
endif()
package(libkoboshi-dev SECTION libdevel COMPONENTS firmware simulation
  SUMMARY "libraries of a humanoid robot's firmware and simulation"
  TEXT "Koboshi is the firmware of a small humanoid robot, and a simulated board to"
       "run it on."
       "."
       "This package contains the static libraries and headers of the firmware, for"
       "boards and controllers of one's own, and of the simulation. CMake finds them"
       "by find_package(koboshi COMPONENTS firmware simulation)."
  DEPENDS libeigen3-dev libfmt-dev libfyaml-dev libode-dev libtinyxml2-dev libxxhash-dev nlohmann-json3-dev pkgconf
          ${mujoco}
  RECOMMENDS "koboshi (= ${version})"
  SUGGESTS cmake)
if(TARGET koboshi_python)
  # The module is made for one version of Python.
  math(EXPR next "${KOBOSHI_PYTHON_MINOR} + 1")
  package(python3-koboshi SECTION python COMPONENTS python
    SUMMARY "simulate a small humanoid robot from Python"
    TEXT "This package contains the Python module of Koboshi, the firmware of a small"
         "humanoid robot, and the simulated board it runs on: pushes, commands, sensors"
         "and many worlds in parallel from a script."
    DEPENDS "koboshi (= ${version})" "python3 (>= 3.${KOBOSHI_PYTHON_MINOR})" "python3 (<< 3.${next})" python3-numpy)
endif()

if(KOBOSHI_PACKAGE)
  foreach(target koboshi-studio koboshi_python)
    if(NOT TARGET ${target})
      message(FATAL_ERROR "A package needs ${target}: install the packages of tools/dev/packages-{build,python,studio}.txt")
    endif()
  endforeach()
  add_custom_target(package_files ALL DEPENDS koboshi_manual)
endif()

set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_NAME koboshi)
set(CPACK_PACKAGE_CONTACT ${KOBOSHI_MAINTAINER})
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "")  # CPack would put it before each package's own
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_STRIP_FILES ON)
set(CPACK_COMPONENTS_GROUPING ONE_PER_GROUP)
set(CPACK_INSTALL_DEFAULT_DIRECTORY_PERMISSIONS OWNER_READ OWNER_WRITE OWNER_EXECUTE GROUP_READ GROUP_EXECUTE WORLD_READ WORLD_EXECUTE)
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_VERSION ${version})
set(CPACK_DEBIAN_PACKAGE_PRIORITY optional)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PACKAGE_CONTROL_STRICT_PERMISSION ON)
set(CPACK_DEBIAN_COMPRESSION_TYPE xz)
set(CPACK_THREADS 1)  # more make other bytes
set(CPACK_PROJECT_CONFIG_FILE ${CMAKE_CURRENT_BINARY_DIR}/package_config.cmake)
configure_file(cmake/package/config.cmake.in package_config.cmake @ONLY)
include(CPack)
