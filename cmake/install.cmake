# `cmake --install`: libraries and headers for find_package(koboshi COMPONENTS firmware simulation), relocatable.
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
  koboshi_install_headers(simulation sim_board simulation)
  install(DIRECTORY robots scenarios DESTINATION share/koboshi COMPONENT simulation)
endif()

configure_file(cmake/koboshiConfig.cmake.in koboshiConfig.cmake @ONLY)
write_basic_package_version_file(${CMAKE_CURRENT_BINARY_DIR}/koboshiConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${CMAKE_CURRENT_BINARY_DIR}/koboshiConfig.cmake ${CMAKE_CURRENT_BINARY_DIR}/koboshiConfigVersion.cmake
        DESTINATION lib/cmake/koboshi COMPONENT firmware)
