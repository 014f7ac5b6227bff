#include "cores.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "../printable.h"
#include "team.h"

enum { PATH = 4096 };

/* Returns the number in the first line that has the format; 0: there is none ("max"). */
static double read_number(const char *group, const char *name, const char *format)
{
    char path[PATH + 32] = "", line[128];
    double number = 0;
    sm_append(path, sizeof path, "%s/%s", group, name);
    FILE *file = fopen(path, "re");
    while (file && fgets(line, sizeof line, file) && sscanf(line, format, &number) != 1) number = 0;
    if (file) fclose(file);
    return number;
}

/* Lowers the quota to that of one control group and adds the time for which it was throttled. */
static void read_group(const char *group, SmQuota *quota)
{
    const double cores[] = {read_number(group, "cpu.max", "%lf") /
                                read_number(group, "cpu.max", "%*s %lf"),
                            read_number(group, "cpu.cfs_quota_us", "%lf") /
                                read_number(group, "cpu.cfs_period_us", "%lf")};
    for (int version = 0; version < 2; version++)
        if (cores[version] > 0) quota->cores = fmin(quota->cores, cores[version]);
    quota->throttled += 1e-6 * read_number(group, "cpu.stat", "throttled_usec %lf") +
                        1e-9 * read_number(group, "cpu.stat", "throttled_time %lf");
}

/* Reads the group and its ancestors. A container sees its group at the top, whatever the path. */
static void read_groups(const char *root, const char *top, const char *path, SmQuota *quota)
{
    char group[PATH] = "";
    sm_append(group, sizeof group, "%s/sys/fs/cgroup%s", root, top);
    size_t size = strlen(group);
    read_group(group, quota);
    for (sm_append(group, sizeof group, "%s", path); strlen(group) > size + 1;
         *strrchr(group, '/') = '\0')
        read_group(group, quota);
}

SmQuota sm_quota(const char *root)
{
    SmQuota quota = {.cores = INFINITY};
    char line[PATH] = "";
    sm_append(line, sizeof line, "%s/proc/self/cgroup", root);
    FILE *file = fopen(line, "re");
    while (file &&
           fgets(line, sizeof line, file)) { /* "2:cpu,cpuacct:PATH", version 2: "0::PATH" */
        char *list = strchr(line, ':'), *path = list ? strchr(list + 1, ':') : NULL;
        if (!path) continue;
        *path++ = '\0';
        path[strcspn(path, "\n")] = '\0';
        if (!*++list) read_groups(root, "", path, &quota);
        for (char *word; (word = strtok_r(list, ",", &list));)
            if (!strcmp(word, "cpu")) read_groups(root, "/cpu", path, &quota);
    }
    if (file) fclose(file);
    return quota;
}

int sm_cores(const char *root)
{
    return sm_team((int)fmax(1, fmin(omp_get_num_procs(), sm_quota(root).cores)));
}
