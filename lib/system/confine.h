/* confine.h - a process that is about to read a file of unknown origin limits what it may do. */
#ifndef SM_CONFINE_H
#define SM_CONFINE_H

#include <stdbool.h>

/* What of it this build and kernel have: the filter needs libseccomp and a kernel with seccomp, the
 * rules on files a kernel with Landlock (Linux 5.13). Without either nothing is lost but the
 * protection. */
typedef struct {
    bool calls; /* system calls are filtered */
    bool files; /* by the kernel; mesh_files.h keeps to the folder anyway */
} SmConfined;

/* From now on this process and its children can only read files beneath `folder`, and `file`
 * itself, write to what is open already, ask for memory and time, and end; whatever else they ask
 * the system for fails with EPERM. Never undone: for a child (child.h). */
SmConfined sm_confine(const char *folder, const char *file);

/* What sm_confine() would do here; nothing is changed. */
SmConfined sm_confinable(void);

#endif
