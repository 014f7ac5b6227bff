# The program: bench/ and what it is linked with.

# provenance.h in the build folder: what results say about the program that made them. Its target
# runs in every build, because only git knows whether the tree has changed; the header is touched
# only when it changes. A target that includes it names `provenance` as a dependency.
string(TOUPPER "${CMAKE_BUILD_TYPE}" build_type)
get_target_property(flags shapebench_flags INTERFACE_COMPILE_OPTIONS)
list(JOIN flags " " flags)
foreach(isa ${isas}) # the kernels' own
  list(JOIN flags_of_${isa} " " own)
  if(own)
    string(APPEND flags " ${isa}: ${own}")
  endif()
endforeach()
string(STRIP "${CMAKE_C_FLAGS} ${CMAKE_C_FLAGS_${build_type}} ${OpenMP_C_FLAGS} ${flags}" flags)
add_custom_target(provenance
  COMMAND ${CMAKE_COMMAND} -D "SOURCE=${CMAKE_SOURCE_DIR}" -D "HEADER=${CMAKE_BINARY_DIR}/provenance.h"
    -D "VERSION=${PROJECT_VERSION}" -D "FLAGS=${flags}"
    -D "COMPILER=${CMAKE_C_COMPILER_ID} ${CMAKE_C_COMPILER_VERSION}"
    -P "${CMAKE_SOURCE_DIR}/scripts/provenance.cmake"
  BYPRODUCTS ${CMAKE_BINARY_DIR}/provenance.h COMMENT "Noting provenance" VERBATIM)

sources_of(bench_sources bench/*.c reference/paper.c)
include(scripts/embed.cmake)
list(FILTER bench_sources EXCLUDE REGEX "/(main|replay|engine_list|store_body)\\.c$")

# How a mesh is put in place of another has the same bits on every machine, as what is simulated has.
set_source_files_properties(bench/scene/body.c PROPERTIES COMPILE_OPTIONS -ffp-contract=off)

set(kernel_steps ${bench_sources}) # steps kernels, or measures what they could reach
list(FILTER kernel_steps INCLUDE REGEX "/bench/kernels/(tree_steps|peak_loops)\\.c$")
list(REMOVE_ITEM bench_sources ${kernel_steps})
include_directories(SYSTEM ${HDF5_INCLUDE_DIRS}) # their rows are stored
add_kernels(kernel_steps kernel_steps "32;64" ${kernel_steps})
add_library(shapebench_bench STATIC ${bench_sources} ${kernel_steps})
add_dependencies(shapebench_bench provenance)
target_include_directories(shapebench_bench PRIVATE ${CMAKE_BINARY_DIR})
target_compile_definitions(shapebench_bench PRIVATE SHAPEBENCH_SCRIPTS="${CMAKE_SOURCE_DIR}/scripts")
target_link_libraries(shapebench_bench PRIVATE shapebench_flags mpi
  PUBLIC shapebench_lib
  PkgConfig::CONFIG PkgConfig::JANSSON PkgConfig::HDF5 PkgConfig::ZLIB)
add_library(shapebench_engines OBJECT bench/engine_list.c) # of each program that runs them
target_link_libraries(shapebench_engines PRIVATE shapebench_flags)
add_executable(shapebench bench/main.c)
target_link_libraries(shapebench PRIVATE shapebench_flags shapebench_engines shapebench_bench)
add_executable(replay EXCLUDE_FROM_ALL bench/regress/replay.c) # of scripts/check_regress.sh
target_link_libraries(replay PRIVATE shapebench_flags shapebench_engines shapebench_bench)
add_executable(store_body bench/view/store_body.c) # of scripts/run view
target_link_libraries(store_body PRIVATE shapebench_flags shapebench_engines shapebench_bench)

set(scripts_folder ${CMAKE_INSTALL_DATADIR}/shapebench)
install(TARGETS shapebench)
install(PROGRAMS scripts/build_revision scripts/plot_sweep.py scripts/plot_map.py
  scripts/plot_calibration.py scripts/render.py scripts/brute_force.py DESTINATION ${scripts_folder})
install(FILES scripts/plots.py DESTINATION ${scripts_folder})
install(FILES results/README.md DESTINATION ${CMAKE_INSTALL_DOCDIR}/results) # has readers of the files
install(FILES scripts/view/build.py DESTINATION ${scripts_folder}/view) # puts a scene or a mesh into the page
install(FILES results/page.html DESTINATION ${scripts_folder}) # reports have it, and pictures on their cards
install(FILES reference/papers.cfg DESTINATION ${scripts_folder}) # and what the papers print
install(DIRECTORY results/scenes DESTINATION ${scripts_folder} FILES_MATCHING PATTERN *.webp)
install(DIRECTORY scripts/report DESTINATION ${scripts_folder}
  FILES_MATCHING PATTERN *.py PATTERN *.html PATTERN *.css PATTERN *.js PATTERN test_* EXCLUDE
  PATTERN __pycache__ EXCLUDE PATTERN stored.py EXCLUDE) # a link
install(FILES lib/python/shapebench/stored.py DESTINATION ${scripts_folder}/report)
