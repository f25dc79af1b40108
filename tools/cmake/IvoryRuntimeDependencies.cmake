# The third parties of the installed libraries, found as Debian 12 packages: by ivory's own build and by
# find_package(ivory).
# OpenVDB's CMake module lies in the multiarch folder and is not on the default module path.
list(APPEND CMAKE_MODULE_PATH /usr/lib/${CMAKE_LIBRARY_ARCHITECTURE}/cmake/OpenVDB)

find_package(Imath CONFIG REQUIRED)
find_package(OpenEXR CONFIG REQUIRED)
find_package(nlohmann_json CONFIG REQUIRED)
find_package(fmt CONFIG REQUIRED)
find_package(PkgConfig REQUIRED)
find_package(ZLIB REQUIRED)
pkg_check_modules(zstd REQUIRED IMPORTED_TARGET libzstd)
if(IVORY_BUILD_RUNTIME OR NOT DEFINED IVORY_BUILD_RUNTIME)
  pkg_check_modules(epoxy REQUIRED IMPORTED_TARGET epoxy)
endif()

# Before OpenVDB, whose module would make a TBB of its own.
find_package(TBB CONFIG REQUIRED)
set(OpenVDB_FIND_QUIETLY ON)
find_package(OpenVDB REQUIRED)

find_package(OpenImageIO CONFIG REQUIRED)
# Debian's exported target names an OpenCV include folder that its package does not bring.
get_target_property(oiio_includes OpenImageIO::OpenImageIO INTERFACE_INCLUDE_DIRECTORIES)
list(FILTER oiio_includes EXCLUDE REGEX "opencv")
set_target_properties(OpenImageIO::OpenImageIO PROPERTIES INTERFACE_INCLUDE_DIRECTORIES "${oiio_includes}")
