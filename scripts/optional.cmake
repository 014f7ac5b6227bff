# What the program can do without: each library, the line that says what goes without it, and the
# sources that it decides about.

# Makes the target `name`, to be linked where the library is used. Where `program` compiles and links
# with the first of PACKAGES that pkg-config knows, and the include folders and libraries given (packages
# come without their headers, or without what they need), the target carries them, has_<name> is set, and the source of USED_BY is compiled with
# its definition; else the target is empty and `without` is said.
function(optional_library name program without)
  cmake_parse_arguments(PARSE_ARGV 3 of "" "" "PACKAGES;INCLUDES;LIBRARIES;USED_BY")
  if(of_PACKAGES)
    string(TOUPPER ${name} package)
    pkg_search_module(${package} QUIET ${of_PACKAGES})
    list(APPEND of_INCLUDES ${${package}_INCLUDE_DIRS})
    list(APPEND of_LIBRARIES ${${package}_LINK_LIBRARIES})
  endif()
  add_library(${name} INTERFACE)
  unset(works CACHE) # try_compile keeps its result there
  if(NOT "${of_INCLUDES};${of_LIBRARIES};" MATCHES "-NOTFOUND;")
    set(probe ${CMAKE_BINARY_DIR}/CMakeFiles/probe_${name})
    file(WRITE ${probe}.c "${program}\n")
    try_compile(works ${probe} ${probe}.c CMAKE_FLAGS "-DINCLUDE_DIRECTORIES=${of_INCLUDES}"
      LINK_LIBRARIES ${of_LIBRARIES})
  endif()
  set(has_${name} ${works} PARENT_SCOPE)
  if(NOT works)
    message(STATUS "${without}")
    return()
  endif()
  target_include_directories(${name} SYSTEM INTERFACE ${of_INCLUDES})
  target_link_libraries(${name} INTERFACE ${of_LIBRARIES})
  if(of_USED_BY)
    list(POP_FRONT of_USED_BY source)
    set_source_files_properties(${source} PROPERTIES COMPILE_DEFINITIONS ${of_USED_BY})
  endif()
endfunction()

optional_library(cmocka [[
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>
#include <cmocka.h>
int main(void) { return cmocka_run_group_tests((const struct CMUnitTest *)0, 0, 0); }]]
  "No unit tests: no cmocka"
  PACKAGES cmocka)

optional_library(jansson [[
#include <jansson.h>
int main(void) { return json_error_code(&(json_error_t){0}) + !json_null(); }]]
  "No glTF: no jansson"
  PACKAGES jansson
  USED_BY lib/mesh/read_gltf.c SM_JANSSON)
optional_library(zlib [[
#include <zlib.h>
int main(void) { return !zlibVersion(); }]]
  "No compressed meshes (.gz): no zlib"
  PACKAGES zlib
  USED_BY lib/mesh/reader.c SM_ZLIB)
set(pc_needs ${JANSSON_LDFLAGS} ${ZLIB_LDFLAGS})

set(sources_of_files other|child)
if(SHAPEBENCH_CORE)
  optional_library(gsl [[
#include <gsl/gsl_linalg.h>
int main(void) { return gsl_linalg_SV_decomp_jacobi((gsl_matrix *)0, 0, 0); }]]
    "No unit tests: no GSL" PACKAGES gsl)
  if(NOT has_gsl)
    set(has_cmocka OFF)
  endif()
  set(sources_left_out elastic_absent|dense_plain|modes|node_order|solver|semidefinite|${sources_of_files})
  if(CMAKE_SIZEOF_VOID_P EQUAL 4) # the library's header has 64-bit numbers of particles
    string(APPEND sources_left_out |cores|public/[a-z_]*)
  endif()
  return()
endif()
# shapebench.pc.in. Not Requires: a program linked with the shared library needs none of their headers.
list(APPEND pc_needs ${GSL_LDFLAGS})

optional_library(assimp [[
#include <assimp/cimport.h>
#include <assimp/scene.h>
int main(void) { return !aiGetErrorString(); }]]
  "No meshes but OBJ, PLY, STL, OFF and glTF: no Assimp"
  PACKAGES assimp
  USED_BY bench/system/machine.c SHAPEBENCH_ASSIMP)

optional_library(mpi [[
#include <mpi.h>
int main(void) { return MPI_Init(0, 0); }]]
  "No MPI: 'mpirun shapebench' will refuse"
  PACKAGES mpi-c ompi-c mpich
  USED_BY bench/campaign/ranks.c SHAPEBENCH_MPI)

pkg_check_modules(ARPACK QUIET arpack)
find_path(CHOLMOD_INCLUDE cholmod.h PATH_SUFFIXES suitesparse)
find_library(CHOLMOD_LIBRARY cholmod)
find_library(LAPACK_LIBRARY lapack)
optional_library(modes [[ /* those of reference/meshless/solve */
#include <arpack.h>
#include <cholmod.h>
void dpstrf_(void);
int main(void) { dpstrf_(); return dsaupd_c != 0 && cholmod_start(0); }]]
  "No meshless bodies: no SuiteSparse, ARPACK or LAPACK"
  INCLUDES ${ARPACK_INCLUDE_DIRS} ${CHOLMOD_INCLUDE}
  LIBRARIES ${ARPACK_LINK_LIBRARIES} ${CHOLMOD_LIBRARY} ${LAPACK_LIBRARY})
if(has_modes) # sources that are not compiled
  set(sources_left_out modes_absent|solver_absent)
  list(APPEND pc_needs ${ARPACK_LDFLAGS} -lcholmod -llapack)
else()
  set(sources_left_out modes|node_order|solver|semidefinite)
endif()

string(APPEND sources_left_out |references_absent|elastic_absent|dense_plain)
string(APPEND sources_of_files |other_absent)
if(has_assimp)
  string(APPEND sources_left_out |other_absent)
  list(APPEND pc_needs ${ASSIMP_LDFLAGS})
else()
  string(APPEND sources_left_out |other|child)
endif()
