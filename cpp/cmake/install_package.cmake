# Installs headers, library and the package for find_package(pendcore). In a wheel the prefix is the
# Python package itself; the entry point cmake.root tells CMake where it is.
include(CMakePackageConfigHelpers)

set(package_dir ${CMAKE_INSTALL_LIBDIR}/cmake/pendcore)
install(TARGETS pendcore EXPORT pendcore ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR})
install(DIRECTORY cpp/include/pendcore DESTINATION ${CMAKE_INSTALL_INCLUDEDIR})
install(EXPORT pendcore NAMESPACE pendcore:: FILE pendcoreTargets.cmake DESTINATION ${package_dir})

configure_package_config_file(cpp/cmake/pendcoreConfig.cmake.in pendcoreConfig.cmake
                              INSTALL_DESTINATION ${package_dir})
write_basic_package_version_file(pendcoreConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/pendcoreConfig.cmake
              ${PROJECT_BINARY_DIR}/pendcoreConfigVersion.cmake cpp/cmake/FindEigen.cmake
        DESTINATION ${package_dir})
