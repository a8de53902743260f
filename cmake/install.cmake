# `cmake --install`: the tool, its decoder, the library and the package that find_package(chiaro) finds.
include(CMakePackageConfigHelpers)
set(package_dir ${CMAKE_INSTALL_LIBDIR}/cmake/chiaro)
install(TARGETS chiaro EXPORT chiaro-targets)
install(TARGETS chiaro-cli)
install(TARGETS ${CHIARO_DECODERS} RUNTIME DESTINATION ${CMAKE_INSTALL_LIBEXECDIR}/chiaro)
install(DIRECTORY include/chiaro DESTINATION ${CMAKE_INSTALL_INCLUDEDIR})
install(EXPORT chiaro-targets NAMESPACE chiaro:: DESTINATION ${package_dir})

configure_package_config_file(cmake/chiaro-config.cmake.in chiaro-config.cmake INSTALL_DESTINATION ${package_dir})
write_basic_package_version_file(chiaro-config-version.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/chiaro-config.cmake ${PROJECT_BINARY_DIR}/chiaro-config-version.cmake
        DESTINATION ${package_dir})
