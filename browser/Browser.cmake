# The engine of the browser page: the core as WebAssembly, without MuJoCo, which is needed only to read models. Robots
# come as packs of compiled models (src/robot/model/model_pack.h), and the few MuJoCo functions that the core calls
# on a model have replacements in browser/engine. Included by the top CMakeLists.txt (preset wasm).

if(NOT CMAKE_CXX_COMPILER MATCHES "wasm-c\\+\\+$")
  message(FATAL_ERROR "the browser build needs the preset wasm: run tools/browser.sh")
endif()
find_path(RETARGET_MUJOCO_HEADERS mujoco/mujoco.h REQUIRED NO_DEFAULT_PATH
  PATHS ${PROJECT_SOURCE_DIR}/build/deps/mujoco/include $ENV{MuJoCo_ROOT}/include NO_CMAKE_FIND_ROOT_PATH)

file(GLOB_RECURSE sources CONFIGURE_DEPENDS src/*.cpp)
list(FILTER sources EXCLUDE REGEX "_win32\\.cpp$")
# Exclude modules that only other programs use ...
list(FILTER sources EXCLUDE REGEX "/src/(edit|rig|live|batch|app/provenance|app/run|solve/robot_setup|solve/online|judge/simulation)/")
# ... and files that read or write models through MuJoCo.
list(FILTER sources EXCLUDE REGEX
  "/(load_model|check_model|repair_spec|mujoco_messages|mujoco_contacts|reference_solver|scene_model)\\.cpp$")
file(GLOB replacements CONFIGURE_DEPENDS browser/engine/*.cpp)

add_library(retarget STATIC ${sources})
include(cmake/GroupByRooms.cmake)
retarget_group_by_rooms(retarget ${sources})
target_precompile_headers(retarget PRIVATE <Eigen/Dense> <nlohmann/json.hpp> <algorithm> <filesystem> <functional>
  <map> <memory> <optional> <span> <string> <tl/expected.hpp> <vector>)
target_include_directories(retarget PUBLIC include PRIVATE src)
# As in the other builds: no contraction, so that the bytes of motions are the same.
target_compile_options(retarget PUBLIC -ffp-contract=off)
target_compile_definitions(retarget PUBLIC EIGEN_MAX_ALIGN_BYTES=16 FMT_HEADER_ONLY=1)
# WASI has no process identifiers, so the engine links a constant one. Without this definition, the header warns of it.
target_compile_definitions(retarget PRIVATE _WASI_EMULATED_GETPID)
target_compile_features(retarget PUBLIC cxx_std_20)
target_include_directories(retarget SYSTEM PRIVATE ${RETARGET_MUJOCO_HEADERS})
include(cmake/Ufbx.cmake)
include(cmake/BuildFacts.cmake)
include(cmake/PageAssets.cmake)

add_executable(retarget_engine ${replacements})
set_target_properties(retarget_engine PROPERTIES OUTPUT_NAME retarget SUFFIX .wasm)
target_include_directories(retarget_engine PRIVATE src)
target_include_directories(retarget_engine SYSTEM PRIVATE ${RETARGET_MUJOCO_HEADERS})
target_link_libraries(retarget_engine PRIVATE retarget ${retarget_wasm_root}/lib/libzip.a ${retarget_wasm_root}/lib/libz.a
  ${retarget_wasm_root}/lib/libtinyxml2.a)
target_link_options(retarget_engine PRIVATE -O2 -s -Wl,--gc-sections)
