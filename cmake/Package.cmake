# Packages of the installed tree: `cpack` in a build folder makes a .deb and a .tar.gz with the C++ library.
# tools/release.sh makes those of releases.

set(CPACK_GENERATOR "DEB;TGZ")
set(CPACK_PACKAGE_NAME retarget)
set(CPACK_PACKAGE_VENDOR retarget)
# The Debian maintainer: the name in CITATION.cff with an invalid address. Package publishers
# set their own: -DRETARGET_PACKAGE_CONTACT="NAME <ADDRESS>"
set(RETARGET_PACKAGE_CONTACT "retarget contributors <contributors@retarget.invalid>"
  CACHE STRING "Maintainer of the packages")
mark_as_advanced(RETARGET_PACKAGE_CONTACT)
set(CPACK_PACKAGE_CONTACT "${RETARGET_PACKAGE_CONTACT}")
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "${PROJECT_DESCRIPTION}")
set(CPACK_RESOURCE_FILE_LICENSE ${PROJECT_SOURCE_DIR}/LICENSE)
set(CPACK_RESOURCE_FILE_README ${PROJECT_SOURCE_DIR}/README.md)
set(CPACK_OUTPUT_FILE_PREFIX ${PROJECT_BINARY_DIR}/packages)
set(CPACK_STRIP_FILES ON)
# Files of a wheel are not part of the tree.
set(CPACK_COMPONENTS_ALL Unspecified)
set(CPACK_ARCHIVE_COMPONENT_INSTALL OFF)

set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_SECTION science)
set(CPACK_DEBIAN_PACKAGE_HOMEPAGE "")
# The linked libraries determine the other dependencies; MuJoCo is included.
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
get_filename_component(mujoco_folder "${MuJoCo_RUNTIME_LIBRARY}" REALPATH)
get_filename_component(mujoco_folder "${mujoco_folder}" DIRECTORY)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS_PRIVATE_DIRS ${mujoco_folder})
# Programs that link the library need these packages.
set(CPACK_DEBIAN_PACKAGE_SUGGESTS
  "libeigen3-dev, libexpected-dev, zlib1g-dev, libzip-dev, libtinyxml2-dev, liblz4-dev, libzmq3-dev, libhiredis-dev")

# Debian expects all licences in one file.
file(READ THIRD_PARTY_NOTICES third_party_notices)
string(REGEX REPLACE "\n\n" "\n.\n" third_party_notices "${third_party_notices}")
string(REGEX REPLACE "\n\n" "\n.\n" third_party_notices "${third_party_notices}")
string(REGEX REPLACE "\n" "\n " third_party_notices "${third_party_notices}")
file(CONFIGURE OUTPUT copyright @ONLY CONTENT [[
Format: https://www.debian.org/doc/packaging-manuals/copyright-format/1.0/
Upstream-Name: retarget

Files: *
Copyright: retarget contributors
License: Apache-2.0
 On Debian systems, the text of the Apache License 2.0 is in
 /usr/share/common-licenses/Apache-2.0.
Comment: What is inside from others has the following notices; LICENSE means the text above.
 .
 @third_party_notices@]])
install(FILES ${PROJECT_BINARY_DIR}/copyright DESTINATION ${CMAKE_INSTALL_DOCDIR})
include(CPack)
