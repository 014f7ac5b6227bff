/* file.h - files that users name, for reading. */
#ifndef SM_FILE_H
#define SM_FILE_H

#include <stdio.h>

#include "../error.h"

/* Opens a regular file and never waits. The caller closes it. NULL and `error` (SM_INPUT) for
 * anything else: a folder, a pipe or device, which could be waited for or read for ever; nothing of
 * that name; no permission. `bytes` (may be NULL) receives the file's size. */
FILE *sm_file_open(const char *path, double *bytes, SmError *error);

#endif
