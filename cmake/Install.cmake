# The installed tree. It may be moved as a whole: everything is found relative to the binary.
#
#   bin/retarget                   the tool
#   lib/libretarget.a              the library; include/retarget/ its headers
#   lib/libretarget_*.a            edit, rig, live, batch (Library.cmake)
#   lib/retarget/                  MuJoCo: library, headers, licences (RETARGET_BUNDLE_MUJOCO)
#   lib/cmake/retarget/            find_package(retarget)
#   share/retarget/                robots/ and configs/; robots/index.json names all robots there are
#   share/doc/retarget/            docs that help and messages name, licences of all included parts
#   share/man, bash-completion, zsh, fish   made by the tool

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
install(FILES LICENSE THIRD_PARTY_NOTICES CHANGELOG.md README.md DESTINATION ${CMAKE_INSTALL_DOCDIR})
install(DIRECTORY docs DESTINATION ${CMAKE_INSTALL_DOCDIR} FILES_MATCHING PATTERN "*.md" PATTERN "*.svg" PATTERN "*.png")
install(DIRECTORY configs DESTINATION ${retarget_data_folder})
install(DIRECTORY robots DESTINATION ${retarget_data_folder} PATTERN unverified EXCLUDE)
if(RETARGET_INSTALL_UNVERIFIED_ROBOTS)
  install(DIRECTORY robots/unverified DESTINATION ${retarget_data_folder}/robots)
endif()
if(TARGET retarget_cli)
  install(TARGETS retarget_cli DESTINATION ${CMAKE_INSTALL_BINDIR})
endif()
# The tool generates its own completions and man page.
if(TARGET retarget_cli AND NOT CMAKE_CROSSCOMPILING)
  function(retarget_install_generated what folder name)
    set(file ${PROJECT_BINARY_DIR}/generated/${what}/${name})
    file(MAKE_DIRECTORY ${PROJECT_BINARY_DIR}/generated/${what})
    add_custom_command(OUTPUT ${file} COMMAND retarget_cli generate ${what} > ${file}
      DEPENDS retarget_cli VERBATIM)
    add_custom_target(retarget_${what} ALL DEPENDS ${file})
    install(FILES ${file} DESTINATION ${folder})
  endfunction()
  retarget_install_generated(bash ${CMAKE_INSTALL_DATADIR}/bash-completion/completions retarget)
  retarget_install_generated(zsh ${CMAKE_INSTALL_DATADIR}/zsh/site-functions _retarget)
  retarget_install_generated(fish ${CMAKE_INSTALL_DATADIR}/fish/vendor_completions.d retarget.fish)
  retarget_install_generated(man ${CMAKE_INSTALL_MANDIR}/man1 retarget.1)
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

# a shared library finds its data beside itself; a static one learns of it from the package
if(BUILD_SHARED_LIBS)
  file(RELATIVE_PATH retarget_data_from_library
    /${CMAKE_INSTALL_LIBDIR} /${CMAKE_INSTALL_DATADIR}/retarget)
  if(IS_ABSOLUTE "${CMAKE_INSTALL_LIBDIR}" OR IS_ABSOLUTE "${CMAKE_INSTALL_DATADIR}")
    file(RELATIVE_PATH retarget_data_from_library
      ${CMAKE_INSTALL_FULL_LIBDIR} ${CMAKE_INSTALL_FULL_DATADIR}/retarget)
  endif()
  set_property(SOURCE ${PROJECT_SOURCE_DIR}/src/app/plan/installed_data_folder.cpp APPEND PROPERTY
    COMPILE_DEFINITIONS RETARGET_DATA_FROM_LIBRARY="${retarget_data_from_library}")
  target_link_libraries(retarget PRIVATE ${CMAKE_DL_LIBS})
endif()

configure_package_config_file(cmake/retargetConfig.cmake.in
  ${PROJECT_BINARY_DIR}/retargetConfig.cmake
  INSTALL_DESTINATION ${retarget_package_folder}
  PATH_VARS retarget_mujoco_folder retarget_data_folder)
# before 1.0 a minor version may change the headers
write_basic_package_version_file(${PROJECT_BINARY_DIR}/retargetConfigVersion.cmake
  COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/retargetConfig.cmake
  ${PROJECT_BINARY_DIR}/retargetConfigVersion.cmake cmake/package_data_folder.cpp.in cmake/FindMuJoCo.cmake cmake/FindLibZip.cmake
  cmake/FindLZ4.cmake cmake/FindZeroMQ.cmake cmake/FindRedisClient.cmake
  DESTINATION ${retarget_package_folder})
if(PROJECT_IS_TOP_LEVEL)
  include(cmake/Package.cmake)
endif()
