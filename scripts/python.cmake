# The Python module (lib/python/README.md): where it is installed, and its tests.

set(python_folder lib/python3/dist-packages) # Debian's python3 looks there in /usr
set(python_module ${python_folder}/shapebench)
install(DIRECTORY lib/python/shapebench DESTINATION ${python_folder} FILES_MATCHING PATTERN *.py PATTERN py.typed
  PATTERN __pycache__ EXCLUDE)
install(FILES lib/public/shapebench.h DESTINATION ${python_module})
install(CODE "file(RELATIVE_PATH library /${python_module} \"/${CMAKE_INSTALL_LIBDIR}/$<TARGET_SONAME_FILE_NAME:shapebench_shared>\")
file(CREATE_LINK \"\${library}\" \"\$ENV{DESTDIR}\${CMAKE_INSTALL_PREFIX}/${python_module}/libshapebench.so\" SYMBOLIC)")

# The wheel has the core alone, and the libraries that it needs (scripts/wheel.py); so no compiler and no packages.
if(NOT SHAPEBENCH_CORE)
  set(absent lib/mesh/other_absent.c lib/public/references_absent.c)
endif()
add_library(shapebench_wheel_library SHARED ${core_objects} ${absent})
target_link_libraries(shapebench_wheel_library PRIVATE shapebench_flags ${needed_by_core})
set_target_properties(shapebench_wheel_library PROPERTIES OUTPUT_NAME shapebench LIBRARY_OUTPUT_DIRECTORY wheel
  BUILD_RPATH "$ORIGIN") # where the wheel has OpenMP's library
show_header_alone(shapebench_wheel_library)
add_custom_target(wheel COMMAND ${CMAKE_SOURCE_DIR}/scripts/wheel.py $<TARGET_FILE:shapebench_wheel_library>
  ${CMAKE_BINARY_DIR} DEPENDS shapebench_wheel_library VERBATIM)
