# The Python module (lib/python/README.md): where it is installed, and its tests.

set(python_folder lib/python3/dist-packages) # Debian's python3 looks there in /usr
set(python_module ${python_folder}/shapebench)
install(DIRECTORY lib/python/shapebench DESTINATION ${python_folder} FILES_MATCHING PATTERN *.py PATTERN py.typed)
install(FILES lib/public/shapebench.h DESTINATION ${python_module})
install(CODE "file(RELATIVE_PATH library /${python_module} \"/${CMAKE_INSTALL_LIBDIR}/$<TARGET_SONAME_FILE_NAME:shapebench_shared>\")
file(CREATE_LINK \"\${library}\" \"\$ENV{DESTDIR}\${CMAKE_INSTALL_PREFIX}/${python_module}/libshapebench.so\" SYMBOLIC)")
