# Finds libzip and defines the target LibZip::zip. The CMake package of Debian's libzip-dev asks for programs
# (zipcmp and others) that other packages hold, so it is not used.

find_path(LibZip_INCLUDE_DIR zip.h)
find_library(LibZip_LIBRARY zip)
mark_as_advanced(LibZip_INCLUDE_DIR LibZip_LIBRARY)
# zipconf.h may be in an architecture-specific folder, which compilers also search.
if(LibZip_INCLUDE_DIR AND EXISTS ${LibZip_INCLUDE_DIR}/zipconf.h)
  file(STRINGS ${LibZip_INCLUDE_DIR}/zipconf.h line REGEX "#define LIBZIP_VERSION \"")
  string(REGEX REPLACE ".*\"([0-9.]+).*" "\\1" LibZip_VERSION "${line}")
endif()
include(FindPackageHandleStandardArgs)
find_package_handle_standard_args(LibZip REQUIRED_VARS LibZip_LIBRARY LibZip_INCLUDE_DIR VERSION_VAR LibZip_VERSION)
if(LibZip_FOUND AND NOT TARGET LibZip::zip)
  add_library(LibZip::zip UNKNOWN IMPORTED)
  set_target_properties(LibZip::zip PROPERTIES IMPORTED_LOCATION "${LibZip_LIBRARY}"
    INTERFACE_INCLUDE_DIRECTORIES "${LibZip_INCLUDE_DIR}")
  if(LibZip_LIBRARY MATCHES "\\.a$" AND TARGET ZLIB::ZLIB)
    # A static library does not name its dependencies.
    set_target_properties(LibZip::zip PROPERTIES INTERFACE_LINK_LIBRARIES ZLIB::ZLIB)
  endif()
endif()
