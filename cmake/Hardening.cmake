# RETARGET_HARDENING: compiler and linker options that turn a memory error in a reader into an abort
# instead of a possible code execution. They apply to the library and everything
# built with it; users of an installed library choose their own flags. docs/building.md
# states the costs.

include(CheckCXXCompilerFlag)
include(CheckLinkerFlag)
include(CheckPIESupported)
add_library(retarget_hardening INTERFACE)
set(retarget_is_hardened OFF)  # For the tests.
# Options of the solvers. They read no files, and the assertions would take 4 % of a run (docs/building.md). Without the
# others, loops with square roots and conditional expressions do not vectorise; no code reads errno after a square root
# or traps floating-point exceptions, and the values stay the same.
set(retarget_solver_wing solve)
set(retarget_solver_options "")

# The Python module is a shared library of the same objects; its symbols are never interposed.
set(retarget_position_independent "")
if(RETARGET_BUILD_PYTHON AND NOT MSVC)
  set(retarget_position_independent -fPIC $<$<CXX_COMPILER_ID:GNU,Clang>:-fno-semantic-interposition>)
endif()

# Sanitizers check more and conflict with these options.
string(FIND "${CMAKE_CXX_FLAGS}" "-fsanitize" sanitized)
if(NOT sanitized EQUAL -1 OR RETARGET_BUILD_FUZZERS OR MSVC)
  return()
endif()
set(retarget_solver_options -fno-math-errno -fno-trapping-math)
if(NOT RETARGET_HARDENING)
  return()
endif()
set(retarget_is_hardened ON)
list(APPEND retarget_solver_options -U_GLIBCXX_ASSERTIONS)

# On Windows the linker randomises addresses and forbids code in data by default.
if(MINGW)
  target_compile_options(retarget_hardening INTERFACE -fstack-protector-strong)
  target_link_options(retarget_hardening INTERFACE -fstack-protector-strong)
  target_compile_definitions(retarget_hardening INTERFACE _GLIBCXX_ASSERTIONS)
  return()
endif()

# Indirect jumps may only target function entries. Clang accepts both options everywhere and warns
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

# The C library's checks need optimisation; the compilers of some distributions enable them by default.
target_compile_options(retarget_hardening INTERFACE
  $<$<CONFIG:Release,RelWithDebInfo,MinSizeRel>:-U_FORTIFY_SOURCE>
  $<$<CONFIG:Release,RelWithDebInfo,MinSizeRel>:-D_FORTIFY_SOURCE=2>)
target_compile_definitions(retarget_hardening INTERFACE _GLIBCXX_ASSERTIONS)

# The tool is position-independent (see its CMakeLists.txt), so the libraries must be, too.
if(NOT APPLE AND NOT CMAKE_POSITION_INDEPENDENT_CODE AND NOT BUILD_SHARED_LIBS AND NOT RETARGET_BUILD_PYTHON)
  target_compile_options(retarget_hardening INTERFACE -fPIE)
endif()
check_pie_supported(LANGUAGES CXX)
# Address tables are resolved at start and read-only afterwards.
check_linker_flag(CXX "LINKER:-z,relro,-z,now" RETARGET_HAS_RELRO)
if(RETARGET_HAS_RELRO)
  target_link_options(retarget_hardening INTERFACE "LINKER:-z,relro,-z,now")
endif()
