# Runs clang-tidy on the project's code during compilation; .clang-tidy is written for version 14.

find_program(RETARGET_CLANG_TIDY_PROGRAM
  NAMES clang-tidy-14 clang-tidy clang-tidy-19 clang-tidy-18 clang-tidy-17 clang-tidy-16 clang-tidy-15
  PATHS /usr/lib/llvm-14/bin)
if(NOT RETARGET_CLANG_TIDY_PROGRAM)
  message(FATAL_ERROR "RETARGET_CLANG_TIDY is on, but there is no clang-tidy: tools/setup.sh --dev installs it")
endif()
foreach(target IN LISTS retarget_libraries ITEMS retarget_cli)
  if(TARGET ${target})
    set_target_properties(${target} PROPERTIES CXX_CLANG_TIDY ${RETARGET_CLANG_TIDY_PROGRAM})
  endif()
endforeach()
