# cmake --install: headers, library, program, and what find_package(octavo) needs.
include(GNUInstallDirs)
include(CMakePackageConfigHelpers)

install(TARGETS octavo octavo_compile_options EXPORT octavo_targets
        ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR} LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR})
install(DIRECTORY src/octavo DESTINATION ${CMAKE_INSTALL_INCLUDEDIR} FILES_MATCHING
        PATTERN "*.h" PATTERN "*.glsl" PATTERN "*.comp")
install(FILES ${PROJECT_BINARY_DIR}/generated/octavo/core/version.h
        DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/octavo/core)
if(OCTAVO_BUILD_APPS)
    install(TARGETS octavo_command RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR})
endif()

set(octavo_cmake_dir ${CMAKE_INSTALL_LIBDIR}/cmake/octavo)
install(EXPORT octavo_targets NAMESPACE octavo:: DESTINATION ${octavo_cmake_dir})
configure_package_config_file(cmake/octavo-config.cmake.in
    ${PROJECT_BINARY_DIR}/octavo-config.cmake INSTALL_DESTINATION ${octavo_cmake_dir})
write_basic_package_version_file(${PROJECT_BINARY_DIR}/octavo-config-version.cmake
                                 COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/octavo-config.cmake
              ${PROJECT_BINARY_DIR}/octavo-config-version.cmake
        DESTINATION ${octavo_cmake_dir})
