# Finds hiredis and defines the target RedisClient::hiredis: its versions have CMake packages with different names
# and targets.

find_path(RedisClient_INCLUDE_DIR hiredis/hiredis.h)
find_library(RedisClient_LIBRARY hiredis)
mark_as_advanced(RedisClient_INCLUDE_DIR RedisClient_LIBRARY)
if(RedisClient_INCLUDE_DIR)
  set(RedisClient_VERSION "")
  foreach(part IN ITEMS MAJOR MINOR PATCH)
    file(STRINGS ${RedisClient_INCLUDE_DIR}/hiredis/hiredis.h line REGEX "#define HIREDIS_${part} ")
    string(REGEX REPLACE ".* ([0-9]+).*" "\\1" number "${line}")
    list(APPEND RedisClient_VERSION ${number})
  endforeach()
  list(JOIN RedisClient_VERSION "." RedisClient_VERSION)
endif()
include(FindPackageHandleStandardArgs)
find_package_handle_standard_args(RedisClient
  REQUIRED_VARS RedisClient_LIBRARY RedisClient_INCLUDE_DIR VERSION_VAR RedisClient_VERSION)
if(RedisClient_FOUND AND NOT TARGET RedisClient::hiredis)
  add_library(RedisClient::hiredis UNKNOWN IMPORTED)
  set_target_properties(RedisClient::hiredis PROPERTIES IMPORTED_LOCATION "${RedisClient_LIBRARY}"
    INTERFACE_INCLUDE_DIRECTORIES "${RedisClient_INCLUDE_DIR}")
endif()
