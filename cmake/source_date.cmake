# KOBOSHI_SOURCE_DATE: when the sources were changed last, in seconds since 1970: SOURCE_DATE_EPOCH of the environment
# (reproducible-builds.org), or else the time of the last commit, or that of the changelog. Packages and manual pages bear it, so
# that the same sources give the same bytes. KOBOSHI_IS_RELEASE: whether the commit has the version's tag, such as v0.1.0.
set(KOBOSHI_SOURCE_DATE $ENV{SOURCE_DATE_EPOCH})
set(KOBOSHI_IS_RELEASE FALSE)
find_program(KOBOSHI_GIT git)
if(KOBOSHI_GIT)
  execute_process(COMMAND ${KOBOSHI_GIT} log -1 --format=%ct WORKING_DIRECTORY ${PROJECT_SOURCE_DIR}
                  OUTPUT_VARIABLE time_of_commit OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET)
  execute_process(COMMAND ${KOBOSHI_GIT} tag --points-at HEAD WORKING_DIRECTORY ${PROJECT_SOURCE_DIR}
                  OUTPUT_VARIABLE tags ERROR_QUIET)
  if("\n${tags}" MATCHES "\nv${PROJECT_VERSION}\n")
    set(KOBOSHI_IS_RELEASE TRUE)
  endif()
  if(NOT KOBOSHI_SOURCE_DATE)
    set(KOBOSHI_SOURCE_DATE ${time_of_commit})
  endif()
endif()
if(NOT KOBOSHI_SOURCE_DATE)
  file(TIMESTAMP CHANGELOG.md KOBOSHI_SOURCE_DATE %s UTC)
endif()
