# Groups the files of a library that are compiled as one unit, at most RETARGET_UNITY_FILES: files of a module, or of
# the modules that one entry lists here. They share includes and template instantiations; each avoided unit saves
# about four seconds. Names in their anonymous namespaces differ (tests/architecture/unity_names_test.py reads this list).
# RETARGET_QUICK_CODE optimises fully only the modules in retarget_hot_wings, which contain the inner loops.
set(retarget_unity_wings "base motion scene" "app view batch" "solve rig" edit formats human judge live robot)
set(retarget_hot_wings "base motion scene" "solve rig" robot)
set(retarget_levels -O3 -O1)
if(RETARGET_QUICK_START)
  # Larger units at lower levels: the same bytes, but slower runs.
  set(retarget_unity_wings solve "human judge" "app robot" "base motion scene view" formats edit)
  set(retarget_hot_wings "base motion scene view" solve)
  set(retarget_levels -O1 -Og)
endif()
list(GET retarget_levels 0 retarget_hot_level)
list(GET retarget_levels 1 retarget_cold_level)

function(retarget_group_by_rooms target)
  set_target_properties(${target} PROPERTIES UNITY_BUILD ON UNITY_BUILD_MODE GROUP)
  if(RETARGET_QUICK_CODE)
    # Overrides the level of the build type; GCC 12 compiles a unit in three quarters of the time.
    target_compile_options(${target} PRIVATE ${retarget_cold_level})
  endif()
  foreach(wings IN LISTS retarget_unity_wings)
    string(REPLACE " " "|" pattern "${wings}")
    # The number decides the order in which ninja starts the units. The quick build takes 149 s instead of 134 s if its
    # largest unit starts last.
    list(FIND retarget_unity_wings "${wings}" place)
    string(REPLACE " " "_" name "${place}_${wings}")
    set(files ${ARGN})
    list(FILTER files INCLUDE REGEX "/src/(${pattern})/")
    # The headers of Windows define many short words as macros.
    list(FILTER files EXCLUDE REGEX "_win32\\.cpp$")
    list(LENGTH files count)
    # Make units of equal size, because the last one determines the end.
    math(EXPR units "(${count} + ${RETARGET_UNITY_FILES} - 1) / ${RETARGET_UNITY_FILES}")
    set(index 0)
    foreach(file IN LISTS files)
      math(EXPR unit "${index} * ${units} / ${count}")
      math(EXPR index "${index} + 1")
      set_source_files_properties(${file} PROPERTIES UNITY_GROUP ${name}_${unit})
    endforeach()
    set(options "")
    if(RETARGET_QUICK_CODE AND target STREQUAL retarget AND wings IN_LIST retarget_hot_wings)
      list(APPEND options ${retarget_hot_level})
    endif()
    if(target STREQUAL retarget AND wings MATCHES "^${retarget_solver_wing}( |$)")
      list(APPEND options ${retarget_solver_options})
    endif()
    if(options)
      # The precompiled headers would bring their own level and definitions with them.
      math(EXPR last "${units} - 1")
      foreach(unit RANGE ${last})
        set_source_files_properties(
          ${CMAKE_CURRENT_BINARY_DIR}/CMakeFiles/${target}.dir/Unity/unity_${name}_${unit}_cxx.cxx
          PROPERTIES COMPILE_OPTIONS "${options}" SKIP_PRECOMPILE_HEADERS ON)
      endforeach()
    endif()
  endforeach()
endfunction()
