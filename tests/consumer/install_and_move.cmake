# Installs BUILD into FIRST, moves that to MOVED, and looks for paths of the building machine.

file(REMOVE_RECURSE ${FIRST} ${MOVED})
execute_process(COMMAND ${CMAKE_COMMAND} --install ${BUILD} --config ${CONFIG} --prefix ${FIRST}
  OUTPUT_QUIET RESULT_VARIABLE failed)
if(failed)
  message(FATAL_ERROR "cmake --install failed; is everything built?")
endif()
file(RENAME ${FIRST} ${MOVED})

if(CONFIG STREQUAL Release)
  file(GLOB_RECURSE files ${MOVED}/*)
  foreach(file IN LISTS files)
    file(STRINGS ${file} lines REGEX "/")
    string(FIND "${lines}" "${SOURCE}/" place)
    if(NOT place EQUAL -1)
      string(SUBSTRING "${lines}" ${place} 160 found)
      message(SEND_ERROR "${file} names the source folder: ${found}")
    endif()
  endforeach()
endif()
