# Contents of the package that `pip install .` makes, in addition to the Python files (component `python`). The layout is that of an
# install, so that module and program find MuJoCo and the data relative to themselves.
#
#   retarget/_retarget*.so, *.pyi
#   retarget/bin/retarget          the program; the entry point `retarget` becomes it
#   retarget/lib/retarget/         MuJoCo, for both of them, with its licences
#   retarget/share/retarget/       robots/ and configs/

file(REAL_PATH "${MuJoCo_RUNTIME_LIBRARY}" mujoco_library)
get_filename_component(mujoco_folder ${mujoco_library} DIRECTORY)
# In the build tree, MuJoCo stays at its location. CMake would end the run path with a colon, which represents the
# working directory (cmake/RunPath.cmake).
set_target_properties(retarget_python PROPERTIES
  BUILD_WITH_INSTALL_RPATH ON INSTALL_RPATH "${mujoco_folder};$ORIGIN/lib/retarget")
if(NOT SKBUILD)
  return()
endif()

# run_path(FILE PATH): sets the run path of an installed file, replacing that of the build
function(run_path file path)
  string(REPLACE "$ORIGIN" "\\$ORIGIN" path "${path}")
  install(CODE "file(RPATH_SET FILE \"\${CMAKE_INSTALL_PREFIX}/${file}\" NEW_RPATH \"${path}\")" COMPONENT python)
endfunction()

install(TARGETS retarget_python LIBRARY DESTINATION retarget COMPONENT python)
run_path(retarget/$<TARGET_FILE_NAME:retarget_python> $ORIGIN/lib/retarget)
install(FILES ${stubs} DESTINATION retarget COMPONENT python)
set_target_properties(retarget_cli PROPERTIES
  BUILD_WITH_INSTALL_RPATH ON INSTALL_RPATH "${mujoco_folder};$ORIGIN/../lib/retarget")
install(TARGETS retarget_cli RUNTIME DESTINATION retarget/bin COMPONENT python)
run_path(retarget/bin/$<TARGET_FILE_NAME:retarget_cli> $ORIGIN/../lib/retarget)
install(FILES ${mujoco_library} DESTINATION retarget/lib/retarget COMPONENT python)
file(GLOB mujoco_licences ${mujoco_folder}/LICENSE* ${mujoco_folder}/THIRD_PARTY_NOTICES*)
install(FILES ${mujoco_licences} DESTINATION retarget/lib/retarget COMPONENT python)
install(DIRECTORY ${PROJECT_SOURCE_DIR}/configs DESTINATION retarget/share/retarget COMPONENT python)
install(DIRECTORY ${PROJECT_SOURCE_DIR}/robots DESTINATION retarget/share/retarget COMPONENT python
  PATTERN unverified EXCLUDE)
