# sanitizer_runtime(RUNTIME): the runtime library, for LD_PRELOAD, that a program without a sanitizer
# (Python) must load before a module with one; empty if the build needs none. NOTFOUND if the library
# is missing or unusable: clang's thread sanitizer crashes in a program that it did not link.
function(sanitizer_runtime runtime)
  set(${runtime} "" PARENT_SCOPE)
  string(REGEX MATCHALL "-fsanitize=[^ ]+" sanitizers "${CMAKE_CXX_FLAGS}")
  if(CMAKE_CXX_COMPILER_ID MATCHES "Clang")
    set(libraries address libclang_rt.asan-${CMAKE_SYSTEM_PROCESSOR}.so thread NOTFOUND
      undefined libclang_rt.ubsan_standalone-${CMAKE_SYSTEM_PROCESSOR}.so)
  else()
    # GCC's module includes the runtime library for undefined behaviour.
    set(libraries address libasan.so thread libtsan.so)
  endif()
  while(libraries)
    list(POP_FRONT libraries sanitizer library)
    if(sanitizers MATCHES "${sanitizer}")
      # The compiler prints the path, or only the name if the file is missing.
      execute_process(COMMAND ${CMAKE_CXX_COMPILER} -print-file-name=${library}
        OUTPUT_VARIABLE path OUTPUT_STRIP_TRAILING_WHITESPACE)
      # It resolves the exception functions at start, before Python has loaded them.
      execute_process(COMMAND ${CMAKE_CXX_COMPILER} -print-file-name=libstdc++.so
        OUTPUT_VARIABLE standard_library OUTPUT_STRIP_TRAILING_WHITESPACE)
      if(library AND IS_ABSOLUTE "${path}")
        set(${runtime} "${path} ${standard_library}" PARENT_SCOPE)
      else()
        set(${runtime} NOTFOUND PARENT_SCOPE)
      endif()
      return()
    endif()
  endwhile()
endfunction()
