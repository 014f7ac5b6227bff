# The page's module: what bench/view exports, with all that plays a scene, for WebAssembly. Of bench/ it
# takes no more than that, and of libraries the sources of libconfig and, where they are there, of jansson (glTF), zlib
# (compressed meshes) and, for thin shells, SuiteSparse's CHOLMOD, in the folders of these names in SHAPEBENCH_VIEW. Of
# CHOLMOD it has what needs no BLAS: simplicial factors. Its module Core is Utility from SuiteSparse 7.4 on.

foreach(header bench/view/view.h bench/view/given.h bench/view/carried.h bench/view/inside.h bench/view/stored_bodies.h)
  set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${header})
  file(STRINGS ${header} declared REGEX "^[a-z ]+[*]?view_[a-z_]+\\(")
  list(TRANSFORM declared REPLACE "^[a-z ]+[*]?(view_[a-z_]+)\\(.*" "-Wl,--export=\\1")
  list(APPEND exports ${declared})
endforeach()

include(scripts/embed.cmake) # builtin.c, papers.c
file(GLOB libconfig CONFIGURE_DEPENDS ${SHAPEBENCH_VIEW}/libconfig/lib/*.c)
set(json ${SHAPEBENCH_VIEW}/jansson)
file(GLOB jansson CONFIGURE_DEPENDS ${json}/src/*.c)
file(GLOB zlib CONFIGURE_DEPENDS ${SHAPEBENCH_VIEW}/zlib/*.c)
set(sparse ${SHAPEBENCH_VIEW}/suitesparse)
file(GLOB cholmod CONFIGURE_DEPENDS ${sparse}/CHOLMOD/Core/cholmod_*.c ${sparse}/CHOLMOD/Utility/cholmod_*.c
  ${sparse}/CHOLMOD/Cholesky/cholmod_*.c ${sparse}/AMD/Source/amd_*.c ${sparse}/COLAMD/Source/colamd.c
  ${sparse}/SuiteSparse_config/SuiteSparse_config.c)
list(FILTER cholmod EXCLUDE REGEX "/(cholmod|amd)_l[0-9_]") # of 64-bit indices
set(solver solve/solver_absent)
if(cholmod)
  set(solver solve/solver solve/node_order)
endif()
set_source_files_properties(${libconfig} ${jansson} ${zlib} ${cholmod} PROPERTIES COMPILE_OPTIONS -w COMPILE_DEFINITIONS
  "NDEBUG;HAVE_STDINT_H;NPRINT;NTIMER;NSUPERNODAL;NPARTITION;NCAMD;NMODIFY;NMATRIXOPS;NCHECK")
if(jansson)
  file(CONFIGURE OUTPUT CMakeFiles/jansson_private_config.h CONTENT "") # what its ./configure would say is above
  set_property(SOURCE lib/mesh/read_gltf.c APPEND PROPERTY COMPILE_DEFINITIONS SM_JANSSON)
endif()
if(zlib)
  set_property(SOURCE lib/mesh/reader.c APPEND PROPERTY COMPILE_DEFINITIONS SM_ZLIB)
endif()
target_include_directories(shapebench_objects SYSTEM PRIVATE ${json}/src ${json}/android ${SHAPEBENCH_VIEW}/zlib)

sources_of(view_sources bench/view/*.c)
list(FILTER view_sources EXCLUDE REGEX "/store_body\\.c$")
list(APPEND view_sources bench/engines.c lib/public/skin.c reference/paper.c
  ${CMAKE_BINARY_DIR}/builtin.c ${CMAKE_BINARY_DIR}/papers.c)
foreach(noun scene/scene scene/scene_settings scene/body scene/memory scene/blades
    settings/setting settings/config_file system/suggest system/quote system/remark
    play/runner play/body_group play/carrier play/playback)
  list(APPEND view_sources bench/${noun}.c)
endforeach()

sources_of(shell_sources reference/meshless/map/*.c reference/meshless/shell/*.c)
list(FILTER shell_sources EXCLUDE REGEX "/(cell_functions|foot_search)\\.c$") # in frame_objects
list(APPEND view_sources ${shell_sources})
foreach(noun engine elastic_absent shell_engine stored body/body body/covers body/cylinders body/gauss_rule
    body/matrices body/mls body/nodes body/octants body/pairs motion/grip motion/motion motion/rotation motion/skin
    solve/dense_plain solve/least_squares surface/cloud surface/local_triangles surface/mpu surface/points
    ${solver})
  list(APPEND view_sources reference/meshless/${noun}.c)
endforeach()

add_executable(view ${view_sources} ${libconfig} ${jansson} ${zlib} ${cholmod} ${frame_objects})
target_include_directories(view SYSTEM PRIVATE ${SHAPEBENCH_VIEW}/libconfig/lib ${json}/src ${json}/android
  ${CMAKE_BINARY_DIR}/CMakeFiles ${sparse}/CHOLMOD/Include ${sparse}/SuiteSparse_config
  ${sparse}/AMD/Include ${sparse}/COLAMD/Include)
target_compile_options(view PRIVATE -ffp-contract=off)
target_link_libraries(view PRIVATE shapebench_flags shapebench_lib)
target_link_options(view PRIVATE -mexec-model=reactor -Wl,-z,stack-size=8388608 ${exports})
set_target_properties(view PROPERTIES SUFFIX .wasm)
