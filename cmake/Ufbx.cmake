# ufbx (third_party/ufbx), the part of the core that only reads FBX files. It opens no file,
# and its sines are ours (src/formats/scene/fbx_math.cpp), so that every machine gets the same bytes.
target_sources(retarget PRIVATE third_party/ufbx/ufbx.c)
target_include_directories(retarget SYSTEM PRIVATE third_party)
set(retarget_ufbx_options -w -fvisibility=hidden)
set_source_files_properties(third_party/ufbx/ufbx.c PROPERTIES LANGUAGE CXX
  SKIP_UNITY_BUILD_INCLUSION ON SKIP_PRECOMPILE_HEADERS ON
  COMPILE_OPTIONS "${retarget_ufbx_options}"
  COMPILE_DEFINITIONS "UFBX_MINIMAL;UFBX_NO_STDIO;UFBX_EXTERNAL_MATH;UFBX_NO_UNALIGNED_LOADS")
