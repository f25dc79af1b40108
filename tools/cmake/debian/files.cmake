# A CPack script, run when a package's files lie in CPACK_TEMPORARY_DIRECTORY: what Debian wants of them, and one owner
# for the module that all three components install.
cmake_minimum_required(VERSION 3.25)

function(run)
  execute_process(COMMAND ${ARGV} COMMAND_ERROR_IS_FATAL ANY)
endfunction()

foreach(component tools runtime python)
  set(root ${CPACK_TEMPORARY_INSTALL_DIRECTORY}/${component})
  if(NOT IS_DIRECTORY ${root}/usr)
    continue()
  endif()
  string(TOUPPER ${component} upper)
  set(package ${CPACK_DEBIAN_${upper}_PACKAGE_NAME})
  file(GLOB_RECURSE modules ${root}/usr/lib/*/ivory/ivory_images.so)
  if(NOT component STREQUAL "tools")
    foreach(module IN LISTS modules)
      get_filename_component(folder ${module} DIRECTORY)
      file(REMOVE_RECURSE ${folder})
    endforeach()
  endif()

  file(GLOB_RECURSE shared ${root}/usr/lib/*.so)
  foreach(module IN LISTS shared)
    file(CHMOD ${module} PERMISSIONS OWNER_READ OWNER_WRITE GROUP_READ WORLD_READ)
  endforeach()
  file(GLOB_RECURSE archives ${root}/usr/lib/*.a)
  foreach(archive IN LISTS archives)
    run(strip --strip-debug --enable-deterministic-archives --remove-section=.comment ${archive})
  endforeach()

  file(GLOB pages ${root}/usr/share/man/man1/*.1)
  foreach(page IN LISTS pages)
    run(gzip -9n ${page})
  endforeach()

  set(documents ${root}/usr/share/doc/${package})
  file(MAKE_DIRECTORY ${documents})
  file(READ ${CPACK_IVORY_SOURCE}/NOTICE notice)
  file(WRITE ${documents}/copyright "Format: https://www.debian.org/doc/packaging-manuals/copyright-format/1.0/
Upstream-Name: ivory

Files: *
Copyright: 2026 the ivory authors
License: Apache-2.0
 On Debian systems the full text of the Apache License, Version 2.0, is in
 /usr/share/common-licenses/Apache-2.0.
")
  file(WRITE ${documents}/NOTICE "${notice}")
  string(TIMESTAMP date "%a, %d %b %Y %H:%M:%S +0000" UTC)
  file(WRITE ${documents}/changelog.Debian "ivory (${CPACK_PACKAGE_VERSION}-${CPACK_DEBIAN_PACKAGE_RELEASE}) unstable; \
urgency=medium

  * Version ${CPACK_PACKAGE_VERSION}; changelog.gz says what there is.

 -- ${CPACK_DEBIAN_PACKAGE_MAINTAINER}  ${date}
")
  file(COPY ${CPACK_IVORY_SOURCE}/CHANGELOG.md DESTINATION ${documents})
  file(RENAME ${documents}/CHANGELOG.md ${documents}/changelog)
  run(gzip -9n ${documents}/changelog ${documents}/changelog.Debian)
  # These packages are not for Debian's archive, which wants a first upload to close a bug.
  file(WRITE ${root}/usr/share/lintian/overrides/${package} "${package}: initial-upload-closes-no-bugs *\n")
endforeach()
