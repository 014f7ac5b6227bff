# Writes HEADER with the git commit of SOURCE, whether the tree differs from it, and the compiler.
# Run by the build (target provenance); leaves the header alone when nothing has changed.
set(commit unknown)
set(dirty 0)
find_package(Git QUIET)
if(GIT_FOUND AND EXISTS "${SOURCE}/.git")
  execute_process(COMMAND ${GIT_EXECUTABLE} -C "${SOURCE}" rev-parse HEAD
    OUTPUT_VARIABLE head RESULT_VARIABLE failed ERROR_QUIET OUTPUT_STRIP_TRAILING_WHITESPACE)
  if(NOT failed)
    set(commit "${head}")
    execute_process(COMMAND ${GIT_EXECUTABLE} --no-optional-locks -C "${SOURCE}" status --porcelain --untracked-files=no
      OUTPUT_VARIABLE changes ERROR_QUIET)
    if(changes)
      set(dirty 1)
    endif()
  endif()
endif()

set(text "/* Written by scripts/provenance.cmake. */\n")
foreach(name VERSION COMPILER FLAGS)
  string(REPLACE "\\" "\\\\" value "${${name}}")
  string(REPLACE "\"" "\\\"" value "${value}")
  string(APPEND text "#define SHAPEBENCH_${name} \"${value}\"\n")
endforeach()
string(APPEND text "#define SHAPEBENCH_GIT_COMMIT \"${commit}\"\n#define SHAPEBENCH_GIT_DIRTY ${dirty}\n")

set(before "")
if(EXISTS "${HEADER}")
  file(READ "${HEADER}" before)
endif()
if(NOT text STREQUAL before)
  file(WRITE "${HEADER}" "${text}")
endif()
