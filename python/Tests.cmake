# One ctest test per file of tests/: python.NAME.
file(GLOB python_tests CONFIGURE_DEPENDS RELATIVE ${CMAKE_CURRENT_SOURCE_DIR}/tests tests/test_*.py)
set(tool "")
if(TARGET retarget_cli)
  set(tool $<TARGET_FILE:retarget_cli>)
endif()
set(deps ${PROJECT_SOURCE_DIR}/build/deps)
set(environment "PYTHONDONTWRITEBYTECODE=1" "RETARGET_TOOL=${tool}"
  "PYTHONPATH=${PROJECT_BINARY_DIR}/python:${pinned_tools}:${deps}/data_sets:${deps}/docs")
include(${PROJECT_SOURCE_DIR}/cmake/SanitizerRuntime.cmake)
sanitizer_runtime(runtime)
if(runtime MATCHES "NOTFOUND$")
  message(STATUS "Tests of the Python module are left out: this compiler's sanitizer does not work in Python")
  return()
elseif(runtime)
  # Python never frees some of its allocations.
  list(APPEND environment "LD_PRELOAD=${runtime}" "ASAN_OPTIONS=detect_leaks=0")
endif()
foreach(file IN LISTS python_tests)
  string(REGEX REPLACE "test_(.*)\\.py$" "python.\\1" name ${file})
  add_test(NAME ${name}
    COMMAND ${Python_EXECUTABLE} -m pytest -q -p no:cacheprovider ${CMAKE_CURRENT_SOURCE_DIR}/tests/${file})
  set_tests_properties(${name} PROPERTIES TIMEOUT 600 ENVIRONMENT "${environment}")
  # Ray itself occupies both workers of its cluster.
  if(name STREQUAL "python.ray")
    set_tests_properties(${name} PROPERTIES RUN_SERIAL ON)
  endif()
endforeach()
