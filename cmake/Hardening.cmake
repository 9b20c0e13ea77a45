# RETARGET_HARDENING: options of compiler and linker with which an error in reading an untrusted file
# ends the process instead of executing an attacker's code. They apply to the library and everything
# that is built with it; users of an installed library choose their own flags. docs/building.md
# states the costs.

include(CheckCXXCompilerFlag)
include(CheckLinkerFlag)
include(CheckPIESupported)
add_library(retarget_hardening INTERFACE)
set(retarget_is_hardened OFF)  # for the tests

# the Python module is a shared library, made of the same objects; nothing in it is replaced from outside
set(retarget_position_independent "")
if(RETARGET_BUILD_PYTHON AND NOT MSVC)
  set(retarget_position_independent -fPIC $<$<CXX_COMPILER_ID:GNU,Clang>:-fno-semantic-interposition>)
endif()

# the sanitizers look at more, and get in the way of these
string(FIND "${CMAKE_CXX_FLAGS}" "-fsanitize" sanitized)
if(NOT RETARGET_HARDENING OR NOT sanitized EQUAL -1 OR RETARGET_BUILD_FUZZERS OR MSVC)
  return()
endif()
set(retarget_is_hardened ON)

# Indirect jumps land only where functions begin. Clang accepts both options everywhere, and warns
# about the one without effect.
set(landing -fcf-protection)
if(CMAKE_SYSTEM_PROCESSOR MATCHES "^(aarch64|arm64|ARM64)")
  set(landing -mbranch-protection=standard)
endif()
foreach(flag IN ITEMS -fstack-protector-strong -fstack-clash-protection ${landing})
  string(MAKE_C_IDENTIFIER "RETARGET_HAS${flag}" known)
  check_cxx_compiler_flag(${flag} ${known})
  if(${known})
    target_compile_options(retarget_hardening INTERFACE ${flag})
  endif()
endforeach()

# checks of the C library's need an optimising compiler; some distributions' have them already
target_compile_options(retarget_hardening INTERFACE
  $<$<CONFIG:Release,RelWithDebInfo,MinSizeRel>:-U_FORTIFY_SOURCE>
  $<$<CONFIG:Release,RelWithDebInfo,MinSizeRel>:-D_FORTIFY_SOURCE=2>)
target_compile_definitions(retarget_hardening INTERFACE _GLIBCXX_ASSERTIONS)

# the tool lies anywhere in memory (its own CMakeLists.txt), and so must what it links
if(NOT APPLE AND NOT CMAKE_POSITION_INDEPENDENT_CODE AND NOT BUILD_SHARED_LIBS AND NOT RETARGET_BUILD_PYTHON)
  target_compile_options(retarget_hardening INTERFACE -fPIE)
endif()
check_pie_supported(LANGUAGES CXX)
# tables of addresses are filled at the start and cannot be written to afterwards
check_linker_flag(CXX "LINKER:-z,relro,-z,now" RETARGET_HAS_RELRO)
if(RETARGET_HAS_RELRO)
  target_link_options(retarget_hardening INTERFACE "LINKER:-z,relro,-z,now")
endif()
