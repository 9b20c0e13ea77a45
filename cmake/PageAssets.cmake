# Embeds the page files of viewer/ as C++ strings: a build needs neither Node nor a network, and the
# library needs no folder for them. Runs at configure time and again when one of them changes.

set(retarget_page_source ${PROJECT_BINARY_DIR}/generated/page_files.cpp)

function(retarget_write_page_files output)
  set(text "// made by cmake/PageAssets.cmake\n#include \"view/page.h\"\n\nnamespace retarget {\nusing namespace std::string_view_literals;\n")
  foreach(each IN ITEMS kPageShell:page.html kPageStyle:page.css kPageScript:dist/viewer.js
      kGalleryShell:gallery.html kGalleryStyle:gallery.css kGalleryScript:dist/gallery.js)
    string(REPLACE ":" ";" each ${each})
    list(GET each 0 name)
    list(GET each 1 path)
    set(path ${PROJECT_SOURCE_DIR}/viewer/${path})
    set_property(DIRECTORY ${PROJECT_SOURCE_DIR} APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${path})
    file(SHA256 ${path} hash)
    file(READ ${path} content)
    string(LENGTH "${content}" length)
    string(APPEND text "\nstatic constexpr std::string_view ${name}Pieces[] = {\n")
    set(at 0)
    while(at LESS length)
      string(SUBSTRING "${content}" ${at} 16000 piece)
      string(APPEND text "R\"piece(${piece})piece\"sv,\n")
      math(EXPR at "${at} + 16000")
    endwhile()
    string(APPEND text "};\nconst PageAsset ${name} = {${name}Pieces, \"${hash}\"};\n")
  endforeach()
  string(APPEND text "\n}  // namespace retarget\n")
  file(WRITE ${output}.new "${text}")
  execute_process(COMMAND ${CMAKE_COMMAND} -E copy_if_different ${output}.new ${output})
  file(REMOVE ${output}.new)
endfunction()

retarget_write_page_files(${retarget_page_source})
target_sources(retarget PRIVATE ${retarget_page_source})
set_source_files_properties(${retarget_page_source} PROPERTIES
  SKIP_UNITY_BUILD_INCLUSION ON SKIP_PRECOMPILE_HEADERS ON)
