# retarget_add_library(NAME [ROOMS room...] [PUBLIC library...] [PRIVATE library...]): a library of the
# folders src/ROOM (modules or their folders), with the project's warnings and hardening, installed and exported as retarget::NAME (the core,
# `retarget`, as retarget::retarget). The core has every module that no other library has, so it comes last.
#
# The libraries use each other's internal headers and names. A shared build hides these names, so
# there the core contains all modules, and the other libraries are aliases of it.

set(retarget_libraries "")     # Libraries with their own objects; build flags apply to each.
set(retarget_exported "")      # Targets to install.
set(retarget_taken_rooms "")   # Modules of libraries other than the core.
set(retarget_needed_files "")  # Files of those modules that the core has nevertheless, without src/ and .cpp.
set(retarget_shared_links "")  # Links of the modules that a shared core includes.

include(cmake/GroupByRooms.cmake)

# Files named after a system hold its calls; their counterparts have the same functions.
set(retarget_other_system win32)
if(WIN32)
  set(retarget_other_system posix)
endif()

macro(retarget_add_library name)
  cmake_parse_arguments(arg "" "" "ROOMS;PUBLIC;PRIVATE" ${ARGN})
  set(target retarget)
  if(NOT ${name} STREQUAL retarget)
    set(target retarget_${name})
  endif()
  list(APPEND retarget_exported ${target})
  if(arg_ROOMS AND BUILD_SHARED_LIBS)
    list(APPEND retarget_shared_links ${arg_PRIVATE})
    add_library(${target} INTERFACE)
    target_link_libraries(${target} INTERFACE ${arg_PUBLIC})
  else()
    file(GLOB_RECURSE sources CONFIGURE_DEPENDS src/*.cpp)
    list(FILTER sources EXCLUDE REGEX "_${retarget_other_system}\\.cpp$")
    list(JOIN arg_ROOMS "|" rooms)
    list(JOIN retarget_taken_rooms "|" taken)
    if(arg_ROOMS)
      list(FILTER sources INCLUDE REGEX "/src/(${rooms})/")
      list(APPEND retarget_taken_rooms ${arg_ROOMS})
    elseif(taken)
      list(FILTER sources EXCLUDE REGEX "/src/(${taken})/")
      list(TRANSFORM retarget_needed_files REPLACE "(.+)" "${CMAKE_CURRENT_SOURCE_DIR}/src/\\1.cpp"
        OUTPUT_VARIABLE needed)
      list(APPEND sources ${needed})
    endif()
    list(APPEND retarget_libraries ${target})
    add_library(${target} ${sources})
    target_include_directories(${target} PRIVATE src)
    target_link_libraries(${target} PUBLIC ${arg_PUBLIC}
      PRIVATE ${arg_PRIVATE} $<BUILD_INTERFACE:retarget_warnings> $<BUILD_INTERFACE:retarget_hardening>)
    target_compile_options(${target} PRIVATE ${retarget_position_independent})
    if(RETARGET_UNITY_BUILD)
      retarget_group_by_rooms(${target} ${sources})
    elseif(${name} STREQUAL retarget AND retarget_solver_options)
      list(FILTER sources INCLUDE REGEX "/src/${retarget_solver_wing}/")
      set_source_files_properties(${sources}
        PROPERTIES COMPILE_OPTIONS "${retarget_solver_options}" SKIP_PRECOMPILE_HEADERS ON)
    endif()
    if(RETARGET_PRECOMPILE_HEADERS)
      target_precompile_headers(${target} PRIVATE <Eigen/Dense> <algorithm> <functional> <map> <memory>
        <optional> <span> <string> <tl/expected.hpp> <vector>)
    endif()
  endif()
  set_target_properties(${target} PROPERTIES EXPORT_NAME ${name})
  add_library(retarget::${name} ALIAS ${target})
endmacro()
