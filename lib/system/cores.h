/* cores.h - how many cores this process may use: the one answer for library, program and Python. */
#ifndef SM_CORES_H
#define SM_CORES_H

typedef struct {
    double cores;     /* the smallest quota of its control groups; INFINITY: none has one */
    double throttled; /* s for which quotas have stopped it, of all cores together */
} SmQuota;

/* Reads /proc and the control groups (version 1 and 2) below the folder `root`, "" for the system.
 */
SmQuota sm_quota(const char *root);

/* Threads to start where nobody asks for a number: the whole cores of that quota, at most those of
 * the affinity, at least one. */
int sm_cores(const char *root);

#endif
