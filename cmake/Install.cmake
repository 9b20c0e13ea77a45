# The installed tree. It may be moved as a whole: everything is found relative to the binary.
#
#   bin/retarget                   the tool
#   lib/libretarget.a              the library; include/retarget/ its headers
#   lib/libretarget_*.a            edit, rig, batch (Library.cmake)
#   lib/retarget/                  MuJoCo: library, headers, licences (RETARGET_BUNDLE_MUJOCO)
#   lib/cmake/retarget/            find_package(retarget)
#   share/retarget/                robots/ and configs/

include(CMakePackageConfigHelpers)
set(retarget_package_folder ${CMAKE_INSTALL_LIBDIR}/cmake/retarget)
set(retarget_mujoco_folder ${CMAKE_INSTALL_LIBDIR}/retarget)
set(retarget_data_folder ${CMAKE_INSTALL_DATADIR}/retarget)

install(TARGETS ${retarget_exported} EXPORT retargetTargets
  ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR}
  LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR}
  RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR})
install(EXPORT retargetTargets NAMESPACE retarget:: DESTINATION ${retarget_package_folder})
install(DIRECTORY include/ DESTINATION ${CMAKE_INSTALL_INCLUDEDIR} FILES_MATCHING PATTERN "*.h")
install(FILES LICENSE CHANGELOG.md DESTINATION ${CMAKE_INSTALL_DOCDIR})
foreach(folder IN ITEMS robots configs)
  if(EXISTS ${PROJECT_SOURCE_DIR}/${folder})
    install(DIRECTORY ${folder} DESTINATION ${retarget_data_folder})
  endif()
endforeach()
if(TARGET retarget_cli)
  install(TARGETS retarget_cli DESTINATION ${CMAKE_INSTALL_BINDIR})
endif()

# MuJoCo lies in a folder of our own, so that an install never replaces another one's
if(RETARGET_BUNDLE_MUJOCO)
  # the file itself, not a link to it: its name is the one that programs ask for
  file(REAL_PATH "${MuJoCo_RUNTIME_LIBRARY}" retarget_mujoco_library)
  get_target_property(retarget_mujoco_headers mujoco::mujoco INTERFACE_INCLUDE_DIRECTORIES)
  install(FILES ${retarget_mujoco_library} DESTINATION ${retarget_mujoco_folder})
  foreach(folder IN LISTS retarget_mujoco_headers)
    install(DIRECTORY ${folder}/mujoco DESTINATION ${retarget_mujoco_folder}/include
      FILES_MATCHING PATTERN "*.h")
    file(GLOB licences ${folder}/../LICENSE* ${folder}/../THIRD_PARTY_NOTICES*)
    install(FILES ${licences} DESTINATION ${retarget_mujoco_folder})
  endforeach()
endif()
include(cmake/RunPath.cmake)

configure_package_config_file(cmake/retargetConfig.cmake.in
  ${PROJECT_BINARY_DIR}/retargetConfig.cmake
  INSTALL_DESTINATION ${retarget_package_folder}
  PATH_VARS retarget_mujoco_folder retarget_data_folder)
# before 1.0 a minor version may change the headers
write_basic_package_version_file(${PROJECT_BINARY_DIR}/retargetConfigVersion.cmake
  COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/retargetConfig.cmake
  ${PROJECT_BINARY_DIR}/retargetConfigVersion.cmake cmake/FindMuJoCo.cmake
  DESTINATION ${retarget_package_folder})
