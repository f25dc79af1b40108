# cmake --install: the command, and the runtime library as a CMake package (see ivoryConfig.cmake.in), which
# --component runtime installs alone.
include(GNUInstallDirs)
include(CMakePackageConfigHelpers)
set(IVORY_SHADER_FOLDER ${CMAKE_INSTALL_DATADIR}/ivory/shaders)
set(package_folder ${CMAKE_INSTALL_LIBDIR}/cmake/ivory)

install(TARGETS ivory COMPONENT tools)
# What ivory chart runs and measures.
install(DIRECTORY tools/chart DESTINATION ${CMAKE_INSTALL_DATADIR}/ivory/tools COMPONENT tools PATTERN "__pycache__" EXCLUDE)
install(DIRECTORY scenes DESTINATION ${CMAKE_INSTALL_DATADIR}/ivory COMPONENT tools PATTERN "__pycache__" EXCLUDE)
install(TARGETS ivory_runtime ivory_grid_io ivory_grid ivory_options EXPORT ivory COMPONENT runtime)
install(DIRECTORY grid runtime DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/ivory COMPONENT runtime
  FILES_MATCHING PATTERN "*.h" PATTERN "gl_check.h" EXCLUDE PATTERN "shader_table.h" EXCLUDE PATTERN "example" EXCLUDE)
install(DIRECTORY shaders/ DESTINATION ${IVORY_SHADER_FOLDER} COMPONENT runtime)
install(EXPORT ivory NAMESPACE ivory:: FILE ivoryTargets.cmake DESTINATION ${package_folder} COMPONENT runtime)

configure_package_config_file(tools/cmake/ivoryConfig.cmake.in ${CMAKE_BINARY_DIR}/ivoryConfig.cmake
  INSTALL_DESTINATION ${package_folder} PATH_VARS IVORY_SHADER_FOLDER)
write_basic_package_version_file(${CMAKE_BINARY_DIR}/ivoryConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${CMAKE_BINARY_DIR}/ivoryConfig.cmake ${CMAKE_BINARY_DIR}/ivoryConfigVersion.cmake
  tools/cmake/IvoryRuntimeDependencies.cmake DESTINATION ${package_folder} COMPONENT runtime)
