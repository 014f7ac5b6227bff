# The page's module: what bench/view exports, with all that plays a scene, for WebAssembly. Of bench/ it
# takes no more than that, and of libraries libconfig's sources, whose folder SHAPEBENCH_VIEW names.

foreach(header bench/view/view.h bench/view/given.h bench/view/carried.h bench/view/inside.h bench/view/stored_bodies.h)
  set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${header})
  file(STRINGS ${header} declared REGEX "^[a-z ]+[*]?view_[a-z_]+\\(")
  list(TRANSFORM declared REPLACE "^[a-z ]+[*]?(view_[a-z_]+)\\(.*" "-Wl,--export=\\1")
  list(APPEND exports ${declared})
endforeach()

include(scripts/embed.cmake) # builtin.c, papers.c
set(libconfig grammar libconfig scanctx scanner strbuf)
list(TRANSFORM libconfig REPLACE "(.+)" "${SHAPEBENCH_VIEW}/lib/\\1.c")
set_source_files_properties(${libconfig} PROPERTIES COMPILE_OPTIONS -w)

sources_of(view_sources bench/view/*.c)
list(FILTER view_sources EXCLUDE REGEX "/store_body\\.c$")
list(APPEND view_sources bench/engines.c lib/public/skin.c lib/mesh/polygon.c reference/paper.c
  ${CMAKE_BINARY_DIR}/builtin.c ${CMAKE_BINARY_DIR}/papers.c)
foreach(noun scene/scene scene/scene_settings scene/body scene/memory scene/nearest scene/blades
    settings/setting settings/config_file system/suggest system/quote
    play/runner play/body_group play/carrier play/playback)
  list(APPEND view_sources bench/${noun}.c)
endforeach()

foreach(noun engine stored elastic_absent body/body body/cylinders body/matrices body/mls body/nodes body/octants
    body/pairs motion/grip motion/motion motion/rotation motion/skin solve/dense_plain solve/least_squares
    solve/modes_absent surface/cloud surface/mpu surface/points)
  list(APPEND view_sources reference/meshless/${noun}.c)
endforeach()

add_executable(view ${view_sources} ${libconfig} ${frame_objects})
target_include_directories(view SYSTEM PRIVATE ${SHAPEBENCH_VIEW}/lib)
target_compile_options(view PRIVATE -ffp-contract=off)
target_link_libraries(view PRIVATE shapebench_flags shapebench_lib)
target_link_options(view PRIVATE -mexec-model=reactor -Wl,-z,stack-size=8388608 ${exports})
set_target_properties(view PROPERTIES SUFFIX .wasm)
