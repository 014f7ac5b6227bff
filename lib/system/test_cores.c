/* Quotas of control groups, from copies of the system's files. */
#include "../test_folder.h"
#include "cores.h"
#include "team.h"

/* A system: its files, "NAME=TEXT;" each, below the root; and what they mean. */
static const struct {
    const char *group, *files;
    double cores, throttled;
} systems[] = {
    {"0::/a/b\n", "a/b/cpu.max=50000 100000;a/b/cpu.stat=x 9\nthrottled_usec 2500000\n;", 0.5, 2.5},
    {"0::/a/b\n",
     "a/b/cpu.max=max 100000;a/cpu.max=150000 100000;a/cpu.stat=throttled_usec 1000000;", 1.5, 1},
    {"0::/a/b\n", "a/b/cpu.max=300000 100000;cpu.max=200000 100000;", 2, 0},
    {"0::/a\n", "a/cpu.max=max 100000;", INFINITY, 0},
    {"0::/\n", "cpu.max=25000 50000;cpu.stat=throttled_usec 1000000;", 0.5, 1},
    {"3:memory:/m\n2:cpuacct,cpu:/a\n0::/\n",
     "cpu/a/cpu.cfs_quota_us=75000;cpu/a/cpu.cfs_period_us=50000;"
     "cpu/a/cpu.stat=nr_throttled 7\nthrottled_time 3000000000\n;",
     1.5, 3},
    {"2:cpu:/docker/x\n", "cpu/cpu.cfs_quota_us=50000;cpu/cpu.cfs_period_us=100000;", 0.5, 0},
    {"2:cpu:/a\n", "cpu/a/cpu.cfs_quota_us=-1;cpu/a/cpu.cfs_period_us=100000;", INFINITY, 0},
    {"0::/a\n", "a/cpu.max=0x nan;a/cpu.stat=throttled_usec;cpu.max=-5 0;", INFINITY, 0},
    {"0:\n::::\n:cpu:\n\n9:cpu,,:x\n", "cpu.max=max;", INFINITY, 0},
    {NULL, "", INFINITY, 0},
};

/* Writes "NAME=TEXT;" in the folder `top` of a system with the folders on its way. */
static void write_below(size_t s, const char *top, const char *file)
{
    char command[256], path[128], name[64], text[128];
    assert_int_equal(sscanf(file, "%63[^=]=%127[^;]", name, text), 2);
    snprintf(path, sizeof path, "%zu/%s/%s", s, top, name);
    snprintf(command, sizeof command, "mkdir -p $(dirname %s/%s)", folder, path);
    assert_int_equal(system(command), 0);
    write_text(path, text);
}

TEST(the_smallest_quota_of_a_group_and_its_ancestors_counts)
{
    for (size_t s = 0; s < sizeof systems / sizeof *systems; s++) {
        char root[16], group[128];
        snprintf(root, sizeof root, "%zu", s);
        snprintf(group, sizeof group, "cgroup=%s;", systems[s].group);
        if (systems[s].group) write_below(s, "proc/self", group);
        for (const char *file = systems[s].files; *file; file = strchr(file, ';') + 1)
            write_below(s, "sys/fs/cgroup", file);
        SmQuota quota = sm_quota(path_in(root));
        int whole = quota.cores < 2 ? 1 : 2, procs = omp_get_num_procs();
        assert_int_equal(sm_cores(path_in(root)),
                         isinf(quota.cores) || procs < whole ? procs : whole);
        if (quota.cores != systems[s].cores || fabs(quota.throttled - systems[s].throttled) > 1e-9)
            fail_msg("system %zu: %g cores, throttled for %g s", s, quota.cores, quota.throttled);
    }
}
