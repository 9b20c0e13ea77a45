# Libraries with which `retarget live` unpacks packets and sends frames: RETARGET_LZ4,
# RETARGET_ZEROMQ and RETARGET_REDIS are AUTO (used if available), ON (an error without the library)
# or OFF. retarget_live_links lists them for linking, retarget_live_definitions the macros of their sources.

set(RETARGET_LZ4 AUTO CACHE STRING "Compressed packets of live runs (LZ4): AUTO, ON, OFF")
set(RETARGET_ZEROMQ AUTO CACHE STRING "ZeroMQ outputs of live runs: AUTO, ON, OFF")
set(RETARGET_REDIS AUTO CACHE STRING "Redis outputs of live runs: AUTO, ON, OFF")
set_property(CACHE RETARGET_LZ4 RETARGET_ZEROMQ RETARGET_REDIS PROPERTY STRINGS AUTO ON OFF)
set(retarget_live_links "")
set(retarget_live_definitions "")
if(WIN32)
  list(APPEND retarget_live_links ws2_32 winmm)
endif()

# Finds a package, and lists a macro for the one source that needs it.
function(retarget_live_package choice package target source definition)
  if(choice STREQUAL "AUTO")
    find_package(${package} QUIET)
  elseif(choice)
    find_package(${package} REQUIRED)
  endif()
  if(TARGET ${target})
    set(retarget_live_definitions ${retarget_live_definitions} ${definition} PARENT_SCOPE)
    set(retarget_live_links ${retarget_live_links} ${target} PARENT_SCOPE)
  else()
    message(STATUS "${package} is not used: src/live/stream/${source} does without")
  endif()
endfunction()

retarget_live_package("${RETARGET_LZ4}" LZ4 LZ4::lz4 message_cutter.cpp RETARGET_HAS_LZ4)
retarget_live_package("${RETARGET_ZEROMQ}" ZeroMQ ZeroMQ::zmq zmq_output.cpp RETARGET_HAS_ZEROMQ)
retarget_live_package("${RETARGET_REDIS}" RedisClient RedisClient::hiredis redis_output.cpp RETARGET_HAS_HIREDIS)
