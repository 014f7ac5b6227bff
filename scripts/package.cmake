# The Debian package, by `cpack` in the build folder: all that is installed, under /usr.
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
set(CPACK_DEBIAN_PACKAGE_RECOMMENDS "python3, python3-numpy, python3-h5py, python3-matplotlib, python3-jinja2") # report, plots
set(CPACK_DEBIAN_PACKAGE_SUGGESTS "gcc, pkg-config, cmake, libassimp-dev, libgsl-dev, libseccomp-dev, libarpack2-dev, \
libsuitesparse-dev, liblapack-dev, valgrind, ffmpeg, openmpi-bin") # the -dev ones for the static library
include(CPack)
