# The build information of `retarget --version`: the version, and the git commit at the time of each
# build.

set(retarget_facts_folder ${PROJECT_BINARY_DIR}/generated)
add_custom_target(retarget_build_facts
  COMMAND ${CMAKE_COMMAND} -DSOURCE=${PROJECT_SOURCE_DIR} -DVERSION=${PROJECT_VERSION}
    -DOUTPUT=${retarget_facts_folder}/build_facts.h
    -P ${CMAKE_CURRENT_LIST_DIR}/write_build_facts.cmake
  BYPRODUCTS ${retarget_facts_folder}/build_facts.h
  COMMENT "Looking up the git commit"
  VERBATIM)
add_dependencies(retarget retarget_build_facts)
target_include_directories(retarget PRIVATE ${retarget_facts_folder})
