# Compiles the scene files into the program: one byte array each, and the table of builtin.h.
file(GLOB scene_files CONFIGURE_DEPENDS ${CMAKE_SOURCE_DIR}/bench/scenes/*.cfg)
set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${scene_files})
set(scene_arrays "")
set(scene_entries "")
foreach(scene_file ${scene_files})
  get_filename_component(scene_name ${scene_file} NAME_WE)
  string(MAKE_C_IDENTIFIER "text_${scene_name}" scene_array)
  file(READ ${scene_file} scene_bytes HEX)
  string(REGEX REPLACE "(..)" "0x\\1," scene_bytes "${scene_bytes}")
  string(APPEND scene_arrays "static const unsigned char ${scene_array}[] = {${scene_bytes}0};\n")
  string(APPEND scene_entries
    "    {\"${scene_name}\", (const char *)${scene_array}, sizeof ${scene_array} - 1},\n")
endforeach()
file(GENERATE OUTPUT ${CMAKE_BINARY_DIR}/builtin.c CONTENT
"/* Made by bench/scenes.cmake from the files in bench/scenes. */
#include \"${CMAKE_SOURCE_DIR}/bench/scene/builtin.h\"

${scene_arrays}
const BenchBuiltin bench_builtin[] = {
${scene_entries}    {0, 0, 0},
};
")
if(TARGET shapebench_bench)
  target_sources(shapebench_bench PRIVATE ${CMAKE_BINARY_DIR}/builtin.c)
endif()
