# One ctest test per file of tests/: python.NAME.
file(GLOB python_tests CONFIGURE_DEPENDS RELATIVE ${CMAKE_CURRENT_SOURCE_DIR}/tests tests/test_*.py)
set(tool "")
if(TARGET retarget_cli)
  set(tool $<TARGET_FILE:retarget_cli>)
endif()
set(environment "PYTHONDONTWRITEBYTECODE=1" "RETARGET_TOOL=${tool}"
  "PYTHONPATH=${PROJECT_BINARY_DIR}/python:${pinned_tools}")
if(CMAKE_CXX_FLAGS MATCHES "-fsanitize")
  # Python is not built with it, and never frees some of what it allocates
  execute_process(COMMAND ${CMAKE_CXX_COMPILER} -print-file-name=libasan.so
    OUTPUT_VARIABLE runtime OUTPUT_STRIP_TRAILING_WHITESPACE)
  execute_process(COMMAND ${CMAKE_CXX_COMPILER} -print-file-name=libstdc++.so
    OUTPUT_VARIABLE standard_library OUTPUT_STRIP_TRAILING_WHITESPACE)
  list(APPEND environment "LD_PRELOAD=${runtime} ${standard_library}" "ASAN_OPTIONS=detect_leaks=0")
endif()
foreach(file IN LISTS python_tests)
  string(REGEX REPLACE "test_(.*)\\.py$" "python.\\1" name ${file})
  add_test(NAME ${name}
    COMMAND ${Python_EXECUTABLE} -m pytest -q -p no:cacheprovider ${CMAKE_CURRENT_SOURCE_DIR}/tests/${file})
  set_tests_properties(${name} PROPERTIES TIMEOUT 600 ENVIRONMENT "${environment}")
endforeach()
