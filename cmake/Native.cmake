# RETARGET_NATIVE: the library and everything built with it use all instructions of this machine's
# processor. Users of the installed library choose their own flags.

include(CheckCXXCompilerFlag)
set(retarget_native_flag -march=native)
check_cxx_compiler_flag(${retarget_native_flag} RETARGET_HAS_NATIVE_FLAG)
if(NOT RETARGET_HAS_NATIVE_FLAG)
  message(FATAL_ERROR "RETARGET_NATIVE: the compiler does not know ${retarget_native_flag}")
endif()
# GCC defaults to -ffp-contract=fast; set it for Clang too. A product and a sum become one
# instruction that rounds once.
target_compile_options(retarget PUBLIC
  $<BUILD_INTERFACE:${retarget_native_flag}> $<BUILD_INTERFACE:-ffp-contract=fast>)
set_property(SOURCE src/version.cpp APPEND PROPERTY COMPILE_DEFINITIONS RETARGET_NATIVE_BUILD)
