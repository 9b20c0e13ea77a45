# RETARGET_PYTHON: the Python of the tests and of the module in the build tree. One that has numpy, else
# any (tests that need numpy say so).
if(NOT RETARGET_PYTHON)
  find_package(Python3 REQUIRED COMPONENTS Interpreter)
  set(python ${Python3_EXECUTABLE})
  foreach(candidate IN ITEMS ${Python3_EXECUTABLE} /usr/bin/python3)
    execute_process(COMMAND ${candidate} -c "import numpy"
      RESULT_VARIABLE no_numpy OUTPUT_QUIET ERROR_QUIET)
    if(NOT no_numpy)
      set(python ${candidate})
      break()
    endif()
  endforeach()
  set(RETARGET_PYTHON ${python} CACHE FILEPATH "Python for the tests and for the module in the build tree")
endif()
