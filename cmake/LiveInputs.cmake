# What packets of `retarget live` are unpacked with, where the library is there: RETARGET_LZ4 is AUTO, ON (an error
# without it) or OFF. retarget_live_input_links has what to link.

set(RETARGET_LZ4 AUTO CACHE STRING "Compressed packets of live runs (LZ4): AUTO, ON, OFF")
set_property(CACHE RETARGET_LZ4 PROPERTY STRINGS AUTO ON OFF)
set(retarget_live_input_links "")
set(retarget_has_lz4 FALSE)
if(RETARGET_LZ4 STREQUAL "AUTO")
  find_package(LZ4 QUIET)
elseif(RETARGET_LZ4)
  find_package(LZ4 REQUIRED)
endif()
if(RETARGET_LZ4 AND LZ4_FOUND)
  set(retarget_live_input_links LZ4::lz4)
  set(retarget_has_lz4 TRUE)
  set_property(SOURCE ${PROJECT_SOURCE_DIR}/src/stream/lz4_frame.cpp APPEND PROPERTY
    COMPILE_DEFINITIONS RETARGET_HAS_LZ4)
else()
  message(STATUS "LZ4 is not used: src/stream/lz4_frame.cpp does without")
endif()
