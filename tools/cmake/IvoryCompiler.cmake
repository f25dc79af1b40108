# Compiler settings shared by every target, carried by the interface target ivory_options.
add_library(ivory_options INTERFACE)
target_compile_options(ivory_options INTERFACE
  -Wall -Wextra -Wpedantic -Wshadow -Wconversion -Wno-sign-conversion
  # Same command, same bytes: a fused multiply-add rounds once where the source says twice, and
  # which of them fuse is the compiler's choice.
  -ffp-contract=off
  # Nobody reads errno after sqrt; without this every root costs a branch and a call that might set it.
  -fno-math-errno)
if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU" AND CMAKE_CXX_COMPILER_VERSION VERSION_LESS 13)
  # GCC 12 warns of overlapping copies inside std::string's operator+ (GCC bug 105651).
  target_compile_options(ivory_options INTERFACE -Wno-restrict)
endif()
if(IVORY_WERROR)
  target_compile_options(ivory_options INTERFACE -Werror)
endif()
if(IVORY_SANITIZE)
  target_compile_options(ivory_options INTERFACE -fsanitize=${IVORY_SANITIZE} -fno-omit-frame-pointer
    -fno-sanitize-recover=all)
  target_link_options(ivory_options INTERFACE -fsanitize=${IVORY_SANITIZE})
endif()

# ivory_includes_openvdb(<file>...): TBB's hash map, which its trees are made with, marks places by addresses that no node
# has, and UBSan takes them for nodes.
function(ivory_includes_openvdb)
  if(IVORY_SANITIZE MATCHES "undefined")
    set_source_files_properties(${ARGN} PROPERTIES COMPILE_OPTIONS -fno-sanitize=alignment)
  endif()
endfunction()

set(ivory_arch "${IVORY_ARCH}")
if(ivory_arch STREQUAL "auto")
  include(CheckCXXSourceRuns)
  set(CMAKE_REQUIRED_FLAGS "-march=x86-64-v3")
  check_cxx_source_runs("int main() { return __builtin_cpu_supports(\"avx2\") && __builtin_cpu_supports(\"fma\") ? 0 : 1; }"
    IVORY_HOST_IS_X86_64_V3)
  unset(CMAKE_REQUIRED_FLAGS)
  set(ivory_arch "")
  if(IVORY_HOST_IS_X86_64_V3)
    set(ivory_arch "x86-64-v3")
  endif()
endif()
if(ivory_arch)
  target_compile_options(ivory_options INTERFACE -march=${ivory_arch})
endif()

# ivory_position_independent(<target>): the Python module, a shared library, holds it too. Calls within it stay what they
# are in a program: nothing is to be put in their functions' place.
function(ivory_position_independent target)
  if(IVORY_BUILD_PYTHON)
    set_target_properties(${target} PROPERTIES POSITION_INDEPENDENT_CODE ON)
    target_compile_options(${target} PRIVATE -fno-semantic-interposition)
  endif()
endfunction()

# Header-only libraries cost most of the time of compiling; each target reads those it uses once.
set(ivory_std_headers <algorithm> <array> <cmath> <cstdint> <filesystem> <functional> <memory> <optional> <span> <string>
  <string_view> <utility> <vector> <ImathBox.h> <ImathColor.h> <ImathMatrix.h> <ImathVec.h>)
# ivory_precompile(<target> <header>...)
function(ivory_precompile target)
  target_precompile_headers(${target} PRIVATE ${ARGN} ${ivory_std_headers})
  if(CMAKE_CXX_COMPILER_ID MATCHES "Clang")
    # Without the time in it a header made anew is the same one to ccache.
    target_compile_options(${target} PRIVATE "SHELL:-Xclang -fno-pch-timestamp")
  endif()
endfunction()
# ivory_optimise_lightly(<target>): for code that runs once a command. Half of the time of compiling it goes otherwise
# into inlining what others' headers bring.
function(ivory_optimise_lightly target)
  target_compile_options(${target} PRIVATE $<$<CONFIG:Release>:-O1>)
endfunction()

find_program(IVORY_CCACHE ccache)
if(IVORY_CCACHE AND NOT CMAKE_CXX_COMPILER_LAUNCHER)
  # ccache keeps its hands off precompiled headers unless told that these are not tied to times and macros.
  set(CMAKE_CXX_COMPILER_LAUNCHER ${CMAKE_COMMAND} -E env
    CCACHE_SLOPPINESS=pch_defines,time_macros,include_file_mtime,include_file_ctime ${IVORY_CCACHE})
endif()
