# cpack: the Debian packages ivory (the program, and what reads images for the others), libivory-dev (the libraries of
# engines) and python3-ivory, from the components that are installed. tools/package makes them, from a build that runs on
# any machine (preset package).
set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_NAME ivory)
set(CPACK_PACKAGE_VENDOR "the ivory authors")
set(CPACK_PACKAGE_VERSION ${PROJECT_VERSION})
# What CPack takes for none: each package has a summary of its own, the first line of its description.
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "${CMAKE_PROJECT_NAME} built using CMake")
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_STRIP_FILES ON)
set(CPACK_PACKAGE_DIRECTORY ${PROJECT_BINARY_DIR}/packages)
set(CPACK_COMPONENTS_ALL tools runtime)
if(IVORY_BUILD_PYTHON)
  list(APPEND CPACK_COMPONENTS_ALL python)
endif()

set(IVORY_MAINTAINER "the ivory authors <ivory@packages.invalid>" CACHE STRING "Whom the Debian packages name")
set(CPACK_DEBIAN_PACKAGE_MAINTAINER "${IVORY_MAINTAINER}")
set(CPACK_DEBIAN_PACKAGE_RELEASE 1)
set(CPACK_DEBIAN_PACKAGE_CONTROL_STRICT_PERMISSION ON)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(same_version "(= ${PROJECT_VERSION}-${CPACK_DEBIAN_PACKAGE_RELEASE})")
set(bakes "ivory traces photons through a glTF scene and writes small assets that an
offline renderer or a game engine reads: grids of irradiance vectors, FIV
occluder tables, spherical harmonics, irradiance maps, localized cube maps and
cosine lobes.
")

set(CPACK_DEBIAN_TOOLS_PACKAGE_NAME ivory)
set(CPACK_DEBIAN_TOOLS_PACKAGE_SECTION graphics)
set(CPACK_DEBIAN_TOOLS_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_TOOLS_PACKAGE_RECOMMENDS "libegl1, libgl1")
set(CPACK_DEBIAN_TOOLS_PACKAGE_SUGGESTS "python3, python3-jinja2, python3-matplotlib, python3-numpy")
set(CPACK_COMPONENT_TOOLS_DESCRIPTION "bakes the light of glTF scenes into small assets
${bakes}
This package has the command and the viewer.")

set(CPACK_DEBIAN_RUNTIME_PACKAGE_NAME libivory-dev)
set(CPACK_DEBIAN_RUNTIME_PACKAGE_SECTION libdevel)
# What IvoryRuntimeDependencies.cmake finds; of OpenImageIO its tools too, which its CMake package names.
set(CPACK_DEBIAN_RUNTIME_PACKAGE_DEPENDS "ivory ${same_version}, libboost-iostreams-dev, libepoxy-dev, libfmt-dev, \
libimath-dev, libopenexr-dev, libopenimageio-dev, libopenvdb-dev, libtbb-dev, libzstd-dev, nlohmann-json3-dev, \
openimageio-tools, pkg-config, zlib1g-dev")
set(CPACK_COMPONENT_RUNTIME_DESCRIPTION "baked light in your engine: static libraries, headers, shaders
${bakes}
This package has the libraries that read them and draw by them in OpenGL, for
C++ and C, the GLSL, and a CMake package.")

set(CPACK_DEBIAN_PYTHON_PACKAGE_NAME python3-ivory)
set(CPACK_DEBIAN_PYTHON_PACKAGE_SECTION python)
set(CPACK_DEBIAN_PYTHON_PACKAGE_SHLIBDEPS ON)
if(IVORY_BUILD_PYTHON)
  math(EXPR next_minor "${Python3_VERSION_MINOR} + 1")
  set(CPACK_DEBIAN_PYTHON_PACKAGE_DEPENDS "ivory ${same_version}, python3 (>= 3.${Python3_VERSION_MINOR}~), \
python3 (<< 3.${next_minor}), python3-numpy")
endif()
set(CPACK_DEBIAN_PYTHON_PACKAGE_CONTROL_EXTRA
  "${CMAKE_CURRENT_LIST_DIR}/debian/postinst;${CMAKE_CURRENT_LIST_DIR}/debian/prerm")
set(CPACK_COMPONENT_PYTHON_DESCRIPTION "baked light in Python, NumPy in and out
${bakes}
This package has the Python module: it bakes, looks up, renders, reads and
writes.")

# Debian's own rules for what is in a package; runs on each package's files before it is packed.
set(CPACK_PRE_BUILD_SCRIPTS ${CMAKE_CURRENT_LIST_DIR}/debian/files.cmake)
set(CPACK_IVORY_SOURCE ${PROJECT_SOURCE_DIR})
include(CPack)
