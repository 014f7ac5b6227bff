# Files that are compiled into the program: the papers' numbers (reference/paper.h), the claims and the
# built-in scenes (bench/scene/builtin.h). Adds the C files made of them to the sources.

# Sets `result` to a C initializer: the bytes of the file and a zero.
function(bytes_of file result)
  set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${file})
  file(READ ${file} bytes HEX)
  string(REGEX REPLACE "(..)" "0x\\1," bytes "${bytes}")
  set(${result} "{${bytes}0}" PARENT_SCOPE)
endfunction()

foreach(data papers claims)
  bytes_of(${CMAKE_SOURCE_DIR}/reference/${data}.cfg bytes)
  file(CONFIGURE OUTPUT ${CMAKE_BINARY_DIR}/${data}.c @ONLY CONTENT
"/* Made by scripts/embed.cmake from reference/${data}.cfg. */
extern const char ref_${data}_text[];
const char ref_${data}_text[] = @bytes@;
")
  list(APPEND bench_sources ${CMAKE_BINARY_DIR}/${data}.c)
endforeach()

file(GLOB scenes CONFIGURE_DEPENDS ${CMAKE_SOURCE_DIR}/bench/scenes/*.cfg)
set(entries "")
foreach(scene ${scenes})
  get_filename_component(name ${scene} NAME_WE)
  bytes_of(${scene} bytes)
  string(APPEND entries "    {\"${name}\", (const char[])${bytes}},\n")
endforeach()
file(CONFIGURE OUTPUT ${CMAKE_BINARY_DIR}/builtin.c @ONLY CONTENT
"/* Made by scripts/embed.cmake from the files in bench/scenes. */
#include \"@CMAKE_SOURCE_DIR@/bench/scene/builtin.h\"

const BenchBuiltin bench_builtin[] = {
@entries@    {0, 0},
};
")
list(APPEND bench_sources ${CMAKE_BINARY_DIR}/builtin.c)
