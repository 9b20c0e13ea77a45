# Cross-compiles to WebAssembly with what tools/browser.sh installs in build/deps/wasm (docs/browser.md).
set(CMAKE_SYSTEM_NAME Generic)
set(CMAKE_SYSTEM_PROCESSOR wasm32)  # WASI is a system that this version of CMake does not support.
get_filename_component(retarget_wasm_root "${CMAKE_CURRENT_LIST_DIR}/../build/deps/wasm" ABSOLUTE)
set(CMAKE_C_COMPILER ${retarget_wasm_root}/bin/wasm-cc)
set(CMAKE_CXX_COMPILER ${retarget_wasm_root}/bin/wasm-c++)
set(CMAKE_AR ${retarget_wasm_root}/bin/wasm-ar CACHE FILEPATH "")
set(CMAKE_RANLIB ${retarget_wasm_root}/bin/wasm-ranlib CACHE FILEPATH "")
# The try-compile step of CMake would link a program that no operating system here can run.
set(CMAKE_TRY_COMPILE_TARGET_TYPE STATIC_LIBRARY)
set(CMAKE_FIND_ROOT_PATH ${retarget_wasm_root})
set(CMAKE_FIND_ROOT_PATH_MODE_PROGRAM NEVER)
set(CMAKE_FIND_ROOT_PATH_MODE_LIBRARY ONLY)
set(CMAKE_EXECUTABLE_SUFFIX .wasm)
