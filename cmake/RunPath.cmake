# Where the tool and a shared library of ours look for libraries, in the build tree and installed.
#
# If an install changes a run path, CMake pads the old one with colons to the length of the new one.
# The loader treats an empty entry between or after colons as the working directory and loads code
# from there. Therefore the targets are linked with a run path that CMake does not change: the
# folders of the build tree, then those of the installed tree. The install keeps only the latter,
# which are shorter than both.
file(RELATIVE_PATH library_from_bin /${CMAKE_INSTALL_BINDIR} /${CMAKE_INSTALL_LIBDIR})
if(WIN32)
  return()  # Windows searches the program's own folder.
endif()
set(origin "$ORIGIN")
if(APPLE)
  set(origin "@loader_path")
endif()
set(installed_retarget "${origin}/")
set(installed_retarget_cli "${origin}/${library_from_bin}")
if(RETARGET_BUNDLE_MUJOCO)
  list(PREPEND installed_retarget "${origin}/retarget/")
  list(PREPEND installed_retarget_cli "${origin}/${library_from_bin}/retarget")
endif()

# Sets the run path of one target. build_folders: folders that only the build tree may name
function(retarget_set_run_path target build_folders installed destination)
  if(APPLE)
    # macOS has no separators: each folder is a separate entry, which the install replaces.
    set_target_properties(${target} PROPERTIES INSTALL_RPATH "${installed}"
      INSTALL_RPATH_USE_LINK_PATH $<NOT:$<BOOL:${RETARGET_BUNDLE_MUJOCO}>>)
    return()
  endif()
  set_target_properties(${target} PROPERTIES BUILD_WITH_INSTALL_RPATH ON
    INSTALL_RPATH "${build_folders};${installed}" INSTALL_RPATH_USE_LINK_PATH ON)
  list(JOIN installed ":" kept)
  list(JOIN build_folders ":" dropped)
  set(file "\$ENV{DESTDIR}\${CMAKE_INSTALL_PREFIX}/${destination}/$<TARGET_FILE_NAME:${target}>")
  if(IS_ABSOLUTE "${destination}")
    set(file "\$ENV{DESTDIR}${destination}/$<TARGET_FILE_NAME:${target}>")
  endif()
  string(REPLACE "$ORIGIN" "\\$ORIGIN" kept "${kept}")
  if(RETARGET_BUNDLE_MUJOCO)
    install(CODE "file(RPATH_SET FILE \"${file}\" NEW_RPATH \"${kept}\")")
  elseif(dropped)
    # Library folders outside the build tree follow the project's own.
    install(CODE "file(RPATH_CHANGE FILE \"${file}\" OLD_RPATH \"${dropped}:${kept}\"
      NEW_RPATH \"${kept}\")")
  endif()
endfunction()

set(build_folders "")
get_filename_component(mujoco_folder "${MuJoCo_RUNTIME_LIBRARY}" DIRECTORY)
get_filename_component(mujoco_folder "${mujoco_folder}" ABSOLUTE)
string(FIND "${mujoco_folder}/" "${PROJECT_SOURCE_DIR}/" in_source)
string(FIND "${mujoco_folder}/" "${PROJECT_BINARY_DIR}/" in_build)
# The linker already lists a folder outside the source and build trees, and an install keeps it
# unless it bundles MuJoCo.
if(in_source EQUAL 0 OR in_build EQUAL 0 OR RETARGET_BUNDLE_MUJOCO)
  list(APPEND build_folders "${mujoco_folder}")
endif()
if(BUILD_SHARED_LIBS)
  retarget_set_run_path(retarget "${build_folders}" "${installed_retarget}" ${CMAKE_INSTALL_LIBDIR})
  list(APPEND build_folders "$<TARGET_FILE_DIR:retarget>")
endif()
if(TARGET retarget_cli)
  retarget_set_run_path(retarget_cli "${build_folders}" "${installed_retarget_cli}"
    ${CMAKE_INSTALL_BINDIR})
endif()
