# Finds MuJoCo >= the requested version and defines the target mujoco::mujoco, MuJoCo_VERSION and
# MuJoCo_RUNTIME_LIBRARY (the shared library file, installed with the tool).
#
# Search order:
#   1. MuJoCo_ROOT or MUJOCO_DIR (variable or environment): a release archive, an install prefix
#      or the `mujoco` folder of a Python wheel;
#   2. a CMake package (mujocoConfig.cmake);
#   3. the wheel that tools/setup.sh puts into build/deps;
#   4. the wheel of the Python in use;
#   5. system paths.
# If (1) names an unusable MuJoCo, that is an error; the search does not continue.

if(TARGET mujoco::mujoco)
  set(MuJoCo_FOUND TRUE)
  return()
endif()

# major.minor.patch from mjVERSION_HEADER: three digits up to 3.4.0, seven since 3.6.0
function(_mujoco_header_version include_dir result)
  set(${result} "" PARENT_SCOPE)
  if(NOT EXISTS "${include_dir}/mujoco/mujoco.h")
    return()
  endif()
  file(STRINGS "${include_dir}/mujoco/mujoco.h" line REGEX "#define mjVERSION_HEADER +[0-9]+")
  if(NOT line MATCHES "([0-9]+)$")
    return()
  endif()
  set(number ${CMAKE_MATCH_1})
  if(number GREATER 99999)
    math(EXPR major "${number} / 1000000")
    math(EXPR minor "${number} / 1000 % 1000")
    math(EXPR patch "${number} % 1000")
  else()
    math(EXPR major "${number} / 100")
    math(EXPR minor "${number} / 10 % 10")
    math(EXPR patch "${number} % 10")
  endif()
  set(${result} "${major}.${minor}.${patch}" PARENT_SCOPE)
endfunction()

# Uses the MuJoCo below `hint` if it is complete and new enough; sets _mujoco_{include,library,version}
macro(_mujoco_try hint)
  if(NOT _mujoco_library AND NOT "${hint}" STREQUAL "" AND EXISTS "${hint}/include/mujoco/mujoco.h")
    # The wheel contains only the versioned file name.
    file(GLOB _mujoco_candidates
      "${hint}/lib/libmujoco.so" "${hint}/libmujoco.so" "${hint}/lib/*/libmujoco.so"
      "${hint}/lib/libmujoco.so.*" "${hint}/libmujoco.so.*"
      "${hint}/lib/libmujoco*.dylib" "${hint}/libmujoco*.dylib")
    if(WIN32)
      file(GLOB _mujoco_candidates "${hint}/bin/mujoco.dll" "${hint}/mujoco.dll")
    endif()
    _mujoco_header_version("${hint}/include" _mujoco_found_version)
    if(_mujoco_candidates AND _mujoco_found_version)
      if(_mujoco_found_version VERSION_LESS "${MuJoCo_FIND_VERSION}")
        list(APPEND _mujoco_too_old "${_mujoco_found_version} in ${hint}")
      else()
        list(GET _mujoco_candidates 0 _mujoco_library)
        set(_mujoco_include "${hint}/include")
        set(_mujoco_version "${_mujoco_found_version}")
      endif()
    endif()
  endif()
endmacro()

set(_mujoco_library "")
set(_mujoco_too_old "")
set(_mujoco_config FALSE)

set(_mujoco_asked "")
foreach(_root IN ITEMS "${MuJoCo_ROOT}" "$ENV{MuJoCo_ROOT}" "${MUJOCO_DIR}" "$ENV{MUJOCO_DIR}")
  if(NOT _root STREQUAL "")
    list(APPEND _mujoco_asked "${_root}")
  endif()
endforeach()
foreach(_root IN LISTS _mujoco_asked)
  _mujoco_try("${_root}")
endforeach()

if(NOT _mujoco_library AND NOT _mujoco_asked)
  # Skips a package that is too old, and reports it if no other MuJoCo is found.
  find_package(mujoco ${MuJoCo_FIND_VERSION} CONFIG QUIET)
  foreach(_config _number IN ZIP_LISTS mujoco_CONSIDERED_CONFIGS mujoco_CONSIDERED_VERSIONS)
    if(_number VERSION_LESS "${MuJoCo_FIND_VERSION}")
      list(APPEND _mujoco_too_old "${_number} in ${_config}")
    endif()
  endforeach()
  if(TARGET mujoco::mujoco)
    set(_mujoco_config TRUE)
    set(_mujoco_version "${mujoco_VERSION}")
    set(_mujoco_library mujoco::mujoco)
    # Use the file for any build type of the package.
    get_target_property(MuJoCo_RUNTIME_LIBRARY mujoco::mujoco IMPORTED_LOCATION)
    get_target_property(_configurations mujoco::mujoco IMPORTED_CONFIGURATIONS)
    foreach(_configuration IN LISTS _configurations)
      if(NOT MuJoCo_RUNTIME_LIBRARY)
        get_target_property(MuJoCo_RUNTIME_LIBRARY mujoco::mujoco
          IMPORTED_LOCATION_${_configuration})
      endif()
    endforeach()
  else()
    if(WIN32)
      _mujoco_try("${CMAKE_CURRENT_LIST_DIR}/../build/deps/windows/mujoco")
    endif()
    _mujoco_try("${CMAKE_CURRENT_LIST_DIR}/../build/deps/mujoco")
    find_package(Python3 COMPONENTS Interpreter QUIET)
    if(NOT _mujoco_library AND Python3_FOUND)
      execute_process(COMMAND ${Python3_EXECUTABLE} -c
        "import importlib.util as u; s = u.find_spec('mujoco'); print(list(s.submodule_search_locations)[0] if s and s.submodule_search_locations else '')"
        OUTPUT_VARIABLE _mujoco_wheel OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET)
      _mujoco_try("${_mujoco_wheel}")
    endif()
    foreach(_root IN ITEMS /usr/local /usr)
      _mujoco_try("${_root}")
    endforeach()
  endif()
endif()

if(NOT _mujoco_library)
  list(JOIN _mujoco_too_old ", " _mujoco_too_old)
  if(_mujoco_asked)
    set(MuJoCo_NOT_FOUND_MESSAGE "no MuJoCo >= ${MuJoCo_FIND_VERSION} in ${_mujoco_asked} (wanted: include/mujoco/mujoco.h and libmujoco there)")
  elseif(_mujoco_too_old)
    set(MuJoCo_NOT_FOUND_MESSAGE "found only MuJoCo ${_mujoco_too_old}, older than ${MuJoCo_FIND_VERSION}: run tools/setup.sh, which puts the PyPI wheel `mujoco-core` into build/deps, or give a release with -DMuJoCo_ROOT=DIR")
  else()
    set(MuJoCo_NOT_FOUND_MESSAGE "run tools/setup.sh, which puts the PyPI wheel `mujoco-core` into build/deps, or give a release with -DMuJoCo_ROOT=DIR")
  endif()
elseif(NOT _mujoco_config)
  add_library(mujoco::mujoco SHARED IMPORTED)
  set_target_properties(mujoco::mujoco PROPERTIES
    IMPORTED_LOCATION "${_mujoco_library}" INTERFACE_INCLUDE_DIRECTORIES "${_mujoco_include}")
  if(WIN32)
    # MinGW's linker reads the DLL itself, since the wheel has no import library.
    set_target_properties(mujoco::mujoco PROPERTIES IMPORTED_IMPLIB "${_mujoco_library}")
  endif()
  set(MuJoCo_RUNTIME_LIBRARY "${_mujoco_library}")
endif()

include(FindPackageHandleStandardArgs)
set(MuJoCo_VERSION "${_mujoco_version}")
find_package_handle_standard_args(MuJoCo REQUIRED_VARS _mujoco_library VERSION_VAR MuJoCo_VERSION
  REASON_FAILURE_MESSAGE "${MuJoCo_NOT_FOUND_MESSAGE}")
