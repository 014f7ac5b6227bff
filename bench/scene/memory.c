#include "memory.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "../engines.h"

/* Of what is available; the rest is for results and for others. */
#define SHARE 0.8

/* Of a solid cube: offsets along an axis stay inside for (2w + 1) - w (w + 1) / side places on
 * average; of a shell, a surface of two dimensions. */
static double members(const BenchScene *scene, double particles)
{
    bool shell = scene->voxel.fill == SM_SHELL;
    double side = fmax(1, shell ? sqrt(particles) : cbrt(particles));
    double w = fmin(scene->params.w, side - 1);
    double along = fmax(1, 2 * w + 1 - w * (w + 1) / side);
    return particles * (shell ? along * along : along * along * along);
}

double bench_memory_lattice(const BenchScene *scene, double particles)
{
    return (200 + 130 * ((double)scene->instances - 1)) * particles;
}

double bench_memory_octree(const BenchScene *scene, double particles)
{
    (void)scene;
    return 90 * particles;
}

double bench_memory_brute(const BenchScene *scene, double particles)
{
    return (double)scene->instances * (450 * particles + sizeof(int) * members(scene, particles));
}

double bench_memory_wanted(const BenchScene *scene, double particles)
{
    return bench_engine(scene->engine)->memory(scene, particles);
}

/* The number behind `name` in the file, or, with an empty name, at its start; else INFINITY. */
static double read_number(const char *path, const char *name)
{
    char line[256];
    double number = INFINITY;
    size_t length = strlen(name);
    FILE *file = fopen(path, "re");
    if (!file) return INFINITY;
    while (fgets(line, sizeof line, file))
        if (!strncmp(line, name, length) && sscanf(line + length, "%lf", &number) == 1) break;
    fclose(file);
    return number; /* "max" is no number */
}

/* What this process's control group (Linux, version 2) leaves of its limit. */
static double group_leaves(void)
{
    char line[512], path[640];
    double leaves = INFINITY;
    FILE *file = fopen("/proc/self/cgroup", "re");
    if (!file) return INFINITY;
    while (fgets(line, sizeof line, file)) {
        if (strncmp(line, "0::/", 4) != 0) continue;
        line[strcspn(line, "\n")] = '\0';
        snprintf(path, sizeof path, "/sys/fs/cgroup%s/memory.max", line + 3);
        double limit = read_number(path, "");
        snprintf(path, sizeof path, "/sys/fs/cgroup%s/memory.current", line + 3);
        double used = read_number(path, "");
        snprintf(path, sizeof path, "/sys/fs/cgroup%s/memory.stat", line + 3);
        double cache = read_number(path, "inactive_file "); /* of files: given back when wanted */
        if (isfinite(cache)) used -= cache;
        if (isfinite(limit) && isfinite(used)) leaves = fmax(0, limit - used);
    }
    fclose(file);
    return leaves;
}

double bench_memory_available(void)
{
    return fmin(1024 * read_number("/proc/meminfo", "MemAvailable:"), group_leaves());
}

static SmCode check(const char *what, const char *engine, double particles, double wanted,
                    SmError *error)
{
    double available = bench_memory_available();
    if (wanted <= SHARE * available) return SM_OK;
    return sm_fail(
        error, SM_MEMORY,
        "%s: %.0f particles on %s take about %.3g GB of memory, more than four fifths of "
        "the %.3g GB available: ask for fewer particles, or larger cells",
        what, particles, engine, wanted / 1e9, available / 1e9);
}

SmCode bench_memory_check(const BenchScene *scene, double particles, SmError *error)
{
    return check(scene->file, scene->engine, particles, bench_memory_wanted(scene, particles),
                 error);
}

SmCode bench_memory_cube(int side, const char *engine, double each, SmError *error)
{
    char what[32];
    double particles = pow(side, 3);
    snprintf(what, sizeof what, "cube of side %d", side);
    return check(what, engine, particles, each * particles, error);
}
