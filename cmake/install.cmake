# `cmake --install`: the programs with their data and documentation, the Python module, and libraries and headers for
# find_package(koboshi COMPONENTS firmware simulation), all relocatable. What was not built is left out.
include(CMakePackageConfigHelpers)

function(koboshi_install_component component)
  get_property(libraries GLOBAL PROPERTY KOBOSHI_COMPONENT_${component})
  install(TARGETS ${libraries} ${ARGN} EXPORT koboshi-${component} ARCHIVE DESTINATION lib/koboshi COMPONENT ${component})
  install(EXPORT koboshi-${component} NAMESPACE koboshi:: DESTINATION lib/cmake/koboshi COMPONENT ${component})
endfunction()

function(koboshi_install_headers component)
  install(DIRECTORY ${ARGN} DESTINATION include/koboshi COMPONENT ${component} FILES_MATCHING PATTERN "*.h")
endfunction()

koboshi_install_component(firmware koboshi_headers)
koboshi_install_headers(firmware hal firmware)
if(KOBOSHI_SIMULATION)
  koboshi_install_component(simulation)
  koboshi_install_headers(simulation base mechanics sim_board simulation)
  # Programs find these from their own place (simulation/scenario/paths.h).
  install(DIRECTORY robots scenarios studies DESTINATION share/koboshi COMPONENT program)
  install(TARGETS koboshi RUNTIME DESTINATION bin COMPONENT program OPTIONAL)
  install(FILES README.md DESTINATION share/doc/koboshi COMPONENT program)
  install(DIRECTORY docs DESTINATION share/doc/koboshi COMPONENT program)

  # Manual pages and completion, from the same table of commands as --help.
  set(KOBOSHI_MANUAL ${CMAKE_CURRENT_BINARY_DIR}/manual)
  add_custom_command(OUTPUT ${KOBOSHI_MANUAL}.stamp
    COMMAND ${CMAKE_COMMAND} -E rm -rf ${KOBOSHI_MANUAL}
    COMMAND ${CMAKE_COMMAND} -E env SOURCE_DATE_EPOCH=${KOBOSHI_SOURCE_DATE} $<TARGET_FILE:koboshi> manual write --folder ${KOBOSHI_MANUAL}
    COMMAND sh -c "gzip -9n ${KOBOSHI_MANUAL}/man/man1/*.1"
    COMMAND ${CMAKE_COMMAND} -E touch ${KOBOSHI_MANUAL}.stamp
    DEPENDS koboshi COMMENT "Writing the manual pages" VERBATIM)
  add_custom_target(koboshi_manual DEPENDS ${KOBOSHI_MANUAL}.stamp)
  install(DIRECTORY ${KOBOSHI_MANUAL}/man DESTINATION share COMPONENT program OPTIONAL PATTERN "koboshi-studio.1.gz" EXCLUDE)
  install(DIRECTORY ${KOBOSHI_MANUAL}/bash-completion DESTINATION share COMPONENT program OPTIONAL)
  if(TARGET koboshi-studio)
    install(TARGETS koboshi-studio RUNTIME DESTINATION bin COMPONENT studio OPTIONAL)
    install(FILES ${KOBOSHI_MANUAL}/man/man1/koboshi-studio.1.gz DESTINATION share/man/man1 COMPONENT studio OPTIONAL)
    install(FILES studio/desktop/koboshi-studio.desktop DESTINATION share/applications COMPONENT studio)
    install(FILES studio/desktop/koboshi-studio.svg DESTINATION share/icons/hicolor/scalable/apps COMPONENT studio)
    install(DIRECTORY ${CMAKE_RUNTIME_OUTPUT_DIRECTORY}/translations DESTINATION share/koboshi COMPONENT studio OPTIONAL)
  endif()
  if(TARGET koboshi_python)
    # Where Debian's Python finds the modules of packages, below the prefix /usr.
    install(TARGETS koboshi_python LIBRARY DESTINATION lib/python3/dist-packages COMPONENT python OPTIONAL)
    install(FILES simulation/python/koboshi.pyi simulation/python/koboshi_env.py DESTINATION lib/python3/dist-packages COMPONENT python)
  endif()
endif()

# As strip does for programs, in packages and by `cmake --install --strip`.
foreach(component firmware simulation)
  install(CODE [[
    if(CMAKE_INSTALL_DO_STRIP)
      file(GLOB archives "$ENV{DESTDIR}${CMAKE_INSTALL_PREFIX}/lib/koboshi/*.a")
      execute_process(COMMAND strip --strip-debug --remove-section=.comment --enable-deterministic-archives ${archives} COMMAND_ERROR_IS_FATAL ANY)
    endif()]] COMPONENT ${component})
endforeach()

configure_file(cmake/koboshiConfig.cmake.in koboshiConfig.cmake @ONLY)
write_basic_package_version_file(${CMAKE_CURRENT_BINARY_DIR}/koboshiConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${CMAKE_CURRENT_BINARY_DIR}/koboshiConfig.cmake ${CMAKE_CURRENT_BINARY_DIR}/koboshiConfigVersion.cmake
        DESTINATION lib/cmake/koboshi COMPONENT firmware)
