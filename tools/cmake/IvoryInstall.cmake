# cmake --install: the command, and the libraries that engines link as a CMake package (see ivoryConfig.cmake.in), which
# --component runtime installs alone.
include(CMakePackageConfigHelpers)

set(module_folder ${CMAKE_INSTALL_LIBDIR}/ivory)
if(IVORY_BUILD_TOOLS)
  # Relative to itself, so that the whole may be moved. Below /usr nothing moves, and a program's $ORIGIN asks for /proc,
  # which a chroot may lack.
  set(module_path "$ORIGIN/../${module_folder}")
  if(CMAKE_INSTALL_PREFIX STREQUAL "/usr")
    set(module_path ${CMAKE_INSTALL_FULL_LIBDIR}/ivory)
  endif()
  set_target_properties(ivory PROPERTIES INSTALL_RPATH ${module_path})
  install(TARGETS ivory COMPONENT tools)
  install(TARGETS ivory_images LIBRARY DESTINATION ${module_folder} COMPONENT tools)
  install(FILES tools/cmake/completion.bash DESTINATION ${CMAKE_INSTALL_DATADIR}/bash-completion/completions
    RENAME ivory COMPONENT tools)
  # Pages are made when installing, as building them would run the command 50 times.
  find_program(HELP2MAN help2man DOC "makes the man pages from --help; none are installed without")
  if(HELP2MAN)
    set(man_folder ${CMAKE_CURRENT_BINARY_DIR}/man)
    install(CODE "execute_process(COMMAND \"${CMAKE_CURRENT_SOURCE_DIR}/tools/cmake/man_pages.sh\"
      \"$<TARGET_FILE:ivory>\" \"${man_folder}\" COMMAND_ERROR_IS_FATAL ANY)" COMPONENT tools)
    install(DIRECTORY ${man_folder}/ DESTINATION ${CMAKE_INSTALL_MANDIR}/man1 COMPONENT tools)
  endif()
  # What desktops show: the viewer's entry, its description, and the type of .vdb files.
  install(FILES tools/view/desktop/ivory-view.desktop DESTINATION ${CMAKE_INSTALL_DATADIR}/applications COMPONENT tools)
  install(FILES tools/view/desktop/ivory.svg DESTINATION ${CMAKE_INSTALL_DATADIR}/icons/hicolor/scalable/apps
    COMPONENT tools)
  install(FILES tools/view/desktop/ivory-mime.xml DESTINATION ${CMAKE_INSTALL_DATADIR}/mime/packages RENAME ivory.xml
    COMPONENT tools)
  install(FILES tools/view/desktop/io.ivory.view.metainfo.xml DESTINATION ${CMAKE_INSTALL_DATADIR}/metainfo
    COMPONENT tools)
  # What ivory chart runs and measures.
  install(DIRECTORY tools/chart DESTINATION ${CMAKE_INSTALL_DATADIR}/ivory/tools COMPONENT tools
    PATTERN "__pycache__" EXCLUDE PATTERN "*.cpp" EXCLUDE)
  install(DIRECTORY scenes DESTINATION ${CMAKE_INSTALL_DATADIR}/ivory COMPONENT tools PATTERN "__pycache__" EXCLUDE)
  install(FILES ${PROJECT_BINARY_DIR}/ivory_blender.zip DESTINATION ${CMAKE_INSTALL_DATADIR}/ivory/blender COMPONENT tools)
endif()

if(IVORY_BUILD_RUNTIME)
  set(IVORY_SHADER_FOLDER ${CMAKE_INSTALL_DATADIR}/ivory/shaders)
  set(package_folder ${CMAKE_INSTALL_LIBDIR}/cmake/ivory)
  set(config_folder ${CMAKE_CURRENT_BINARY_DIR}/package)
  install(TARGETS ivory_runtime ivory_grid_io ivory_grid EXPORT ivory
    ARCHIVE COMPONENT runtime
    FILE_SET HEADERS DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/ivory COMPONENT runtime)
  install(TARGETS ivory_images LIBRARY DESTINATION ${module_folder} COMPONENT runtime)
  install(DIRECTORY shaders/ DESTINATION ${IVORY_SHADER_FOLDER} COMPONENT runtime)
  if(TARGET ivory_translations)
    install(DIRECTORY ${CMAKE_CURRENT_BINARY_DIR}/runtime/translations/ DESTINATION ${IVORY_SHADER_FOLDER}/translations
      COMPONENT runtime PATTERN done EXCLUDE)
  endif()
  install(EXPORT ivory NAMESPACE ivory:: FILE ivoryTargets.cmake DESTINATION ${package_folder} COMPONENT runtime)
  configure_package_config_file(tools/cmake/ivoryConfig.cmake.in ${config_folder}/ivoryConfig.cmake
    INSTALL_DESTINATION ${package_folder} PATH_VARS IVORY_SHADER_FOLDER)
  write_basic_package_version_file(${config_folder}/ivoryConfigVersion.cmake COMPATIBILITY SameMinorVersion)
  install(FILES ${config_folder}/ivoryConfig.cmake ${config_folder}/ivoryConfigVersion.cmake
    tools/cmake/IvoryRuntimeDependencies.cmake DESTINATION ${package_folder} COMPONENT runtime)
endif()
