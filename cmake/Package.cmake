# Packages of the installed tree: `cpack` in a build folder makes a .deb and a .tar.gz (tools/package.sh).

set(CPACK_GENERATOR "DEB;TGZ")
set(CPACK_PACKAGE_NAME retarget)
set(CPACK_PACKAGE_VENDOR retarget)
set(CPACK_PACKAGE_CONTACT "the authors of retarget")
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "${PROJECT_DESCRIPTION}")
set(CPACK_RESOURCE_FILE_LICENSE ${PROJECT_SOURCE_DIR}/LICENSE)
set(CPACK_RESOURCE_FILE_README ${PROJECT_SOURCE_DIR}/README.md)
set(CPACK_OUTPUT_FILE_PREFIX ${PROJECT_BINARY_DIR}/packages)
set(CPACK_STRIP_FILES ON)
# what belongs to a wheel is none of the tree
set(CPACK_COMPONENTS_ALL Unspecified)
set(CPACK_ARCHIVE_COMPONENT_INSTALL OFF)

set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_SECTION science)
set(CPACK_DEBIAN_PACKAGE_HOMEPAGE "")
# what the tool is linked with decides the rest; MuJoCo is inside
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
get_filename_component(mujoco_folder "${MuJoCo_RUNTIME_LIBRARY}" REALPATH)
get_filename_component(mujoco_folder "${mujoco_folder}" DIRECTORY)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS_PRIVATE_DIRS ${mujoco_folder})
# for programs that link the library
set(CPACK_DEBIAN_PACKAGE_SUGGESTS
  "libeigen3-dev, libexpected-dev, zlib1g-dev, libzip-dev, libtinyxml2-dev, libssl-dev")
include(CPack)
