# Compiles papers.cfg into the program as the string ref_papers_text; adds it to reference_sources.
set(papers ${CMAKE_SOURCE_DIR}/reference/papers.cfg)
set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${papers})
file(READ ${papers} papers_text)
string(REPLACE "\\" "\\\\" papers_text "${papers_text}")
string(REPLACE "\"" "\\\"" papers_text "${papers_text}")
string(REPLACE "\n" "\\n\"\n\"" papers_text "${papers_text}")
file(CONFIGURE OUTPUT ${CMAKE_BINARY_DIR}/papers.c @ONLY CONTENT
"/* Made by reference/papers.cmake from reference/papers.cfg. */
extern const char ref_papers_text[];
const char ref_papers_text[] = \"@papers_text@\";
")
list(APPEND reference_sources ${CMAKE_BINARY_DIR}/papers.c)
