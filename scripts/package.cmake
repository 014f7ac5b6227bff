# What is installed beside the program and the library: manual, completions, documents; and the Debian package of
# all that is installed.

# The manual's pages, where help2man is there to make them of --help.
find_program(HELP2MAN help2man)
if(NOT HELP2MAN)
  message(STATUS "No man pages: install help2man")
elseif(NOT SHAPEBENCH_SANITIZE)
  add_custom_command(OUTPUT man.stamp COMMAND ${CMAKE_SOURCE_DIR}/scripts/man $<TARGET_FILE:shapebench> man
    COMMAND ${CMAKE_COMMAND} -E touch man.stamp DEPENDS shapebench scripts/man COMMENT "Writing man pages" VERBATIM)
  add_custom_target(man ALL DEPENDS man.stamp)
  install(DIRECTORY ${CMAKE_BINARY_DIR}/man/ DESTINATION ${CMAKE_INSTALL_MANDIR}/man1 FILES_MATCHING PATTERN *.1.gz)
endif()

install(FILES scripts/completions/shapebench.bash DESTINATION ${CMAKE_INSTALL_DATADIR}/bash-completion/completions
  RENAME shapebench)
# Debian's zsh looks for what packages bring elsewhere than for what is installed by hand.
install(CODE "string(REGEX REPLACE \".*/usr\" vendor-completions zsh_functions \"\${CMAKE_INSTALL_PREFIX}\")
  if(NOT zsh_functions STREQUAL vendor-completions)
    set(zsh_functions site-functions)
  endif()")
install(FILES scripts/completions/_shapebench DESTINATION "${CMAKE_INSTALL_DATADIR}/zsh/\${zsh_functions}")
install(FILES README.md CHANGELOG.md CITATION.cff DESTINATION ${CMAKE_INSTALL_DOCDIR})
install(FILES LICENSE DESTINATION ${CMAKE_INSTALL_DOCDIR} RENAME copyright)

# The package, by `cpack` in the build folder: all of it under /usr.
set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_NAME shapebench)
set(CPACK_PACKAGE_VENDOR "shapebench authors")
set(SHAPEBENCH_MAINTAINER "shapebench authors <shapebench@localhost>" CACHE STRING
  "NAME <ADDRESS> of who makes the Debian package")
set(CPACK_PACKAGE_CONTACT ${SHAPEBENCH_MAINTAINER})
set(CPACK_PACKAGE_DESCRIPTION "Engines for deformable bodies (FastLSM, octree shape matching, meshless
elastic solids), held to references in double precision, as a program that
measures them and as a library with one header.")
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_STRIP_FILES ON)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT) # shapebench_1.0.0_amd64.deb
set(CPACK_DEBIAN_PACKAGE_SECTION science)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON) # Depends: the libraries that program and library are linked with
# What is linked with this one depends on it; the system is told of it.
file(WRITE ${CMAKE_BINARY_DIR}/package/shlibs
  "libshapebench ${PROJECT_VERSION_MAJOR} shapebench (>= ${PROJECT_VERSION})\n")
file(WRITE ${CMAKE_BINARY_DIR}/package/triggers "activate-noawait ldconfig\n")
set(CPACK_DEBIAN_PACKAGE_CONTROL_EXTRA ${CMAKE_BINARY_DIR}/package/shlibs ${CMAKE_BINARY_DIR}/package/triggers)
set(CPACK_DEBIAN_PACKAGE_RECOMMENDS # report, plots
  "python3, python3-numpy, python3-h5py, python3-matplotlib, python3-jinja2")
set(CPACK_DEBIAN_PACKAGE_SUGGESTS "gcc, pkg-config, cmake, libassimp-dev, libgsl-dev, libarpack2-dev, \
libsuitesparse-dev, liblapack-dev, ffmpeg, openmpi-bin") # the -dev ones for the static library
include(CPack)
