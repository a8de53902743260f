# `cmake --install`: the tool with its helper programs, page and completions, the library, and the package that
# find_package(chiaro) finds. Each is a component of its own, as packages are (cmake/packages.cmake).
include(CMakePackageConfigHelpers)
set(package_dir ${CMAKE_INSTALL_LIBDIR}/cmake/chiaro)
install(TARGETS chiaro_shared EXPORT chiaro-targets LIBRARY COMPONENT library NAMELINK_COMPONENT development)
install(TARGETS chiaro EXPORT chiaro-static-targets ARCHIVE COMPONENT development)
install(TARGETS chiaro-cli RUNTIME COMPONENT tool)
install(TARGETS ${CHIARO_DECODERS} RUNTIME DESTINATION ${CMAKE_INSTALL_LIBEXECDIR}/chiaro COMPONENT tool)
if(TARGET chiaro-decode-vdb)  # for itself, as libopenvdb is larger than all the rest
  install(TARGETS chiaro-decode-vdb RUNTIME DESTINATION ${CMAKE_INSTALL_LIBEXECDIR}/chiaro COMPONENT openvdb)
endif()
install(DIRECTORY include/chiaro DESTINATION ${CMAKE_INSTALL_INCLUDEDIR} COMPONENT development)
install(EXPORT chiaro-targets NAMESPACE chiaro:: DESTINATION ${package_dir} COMPONENT development)
install(EXPORT chiaro-static-targets NAMESPACE chiaro:: DESTINATION ${package_dir} COMPONENT development)

configure_package_config_file(cmake/chiaro-config.cmake.in chiaro-config.cmake INSTALL_DESTINATION ${package_dir})
write_basic_package_version_file(chiaro-config-version.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/chiaro-config.cmake ${PROJECT_BINARY_DIR}/chiaro-config-version.cmake
        DESTINATION ${package_dir} COMPONENT development)
