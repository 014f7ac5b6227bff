# Compiles papers.cfg and claims.cfg into the program as the strings ref_papers_text and
# ref_claims_text; adds them to reference_sources.
foreach(data papers claims)
  set(data_file ${CMAKE_SOURCE_DIR}/reference/${data}.cfg)
  set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${data_file})
  file(READ ${data_file} data_text)
  string(REPLACE "\\" "\\\\" data_text "${data_text}")
  string(REPLACE "\"" "\\\"" data_text "${data_text}")
  string(REPLACE "\n" "\\n\"\n\"" data_text "${data_text}")
  file(CONFIGURE OUTPUT ${CMAKE_BINARY_DIR}/${data}.c @ONLY CONTENT
"/* Made by reference/papers.cmake from reference/${data}.cfg. */
extern const char ref_${data}_text[];
const char ref_${data}_text[] = \"@data_text@\";
")
  list(APPEND reference_sources ${CMAKE_BINARY_DIR}/${data}.c)
endforeach()
