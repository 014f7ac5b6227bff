/* test_damage.h - stored files that are not what they should be: each is refused in one line that
 * names it and says why. For the tests of a kind of file, in a folder of their own. */
#ifndef BENCH_TEST_DAMAGE_H
#define BENCH_TEST_DAMAGE_H

#include <sys/stat.h>
#include <unistd.h>

#include "../../lib/test_folder.h"
#include "h5.h"

typedef struct {
    const char *kind;                                 /* "shapebench sweep" */
    void (*write)(const char *path);                  /* a good one */
    SmCode (*load)(const char *path, SmError *error); /* asserts that a failure leaves nothing */
} TestStored;

typedef struct {
    void (*change)(hid_t file);
    const char *words; /* of the refusal */
} TestChange;

static inline void refuses(const TestStored *stored, const char *path, const char *words)
{
    SmError error = {0};
    assert_int_equal(stored->load(path, &error), SM_INPUT);
    if (!strstr(error.text, words) || !strstr(error.text, path))
        fail_msg("'%s' does not say '%s'", error.text, words);
}

/* None, another's, none that is a file, and one that is cut off. */
static inline void refuses_foreign(const TestStored *stored)
{
    const char *path = path_in("foreign.h5");
    char kind[64];
    struct stat status;
    snprintf(kind, sizeof kind, "not a %s file", stored->kind);
    refuses(stored, path, "no such file");
    write_text("foreign.h5", "this is no HDF5\n");
    refuses(stored, path, "not an HDF5 file");
    BenchH5 h5;
    bench_h5_create(&h5, path);
    assert_true(bench_h5_close(&h5));
    refuses(stored, path, kind);
    unlink(path);
    refuses(stored, folder, "is a directory");
    assert_int_equal(mkfifo(path, 0600), 0);
    refuses(stored, path, "is a pipe");
    unlink(path);
    for (int eighth = 7; eighth >= 0; eighth--) {
        stored->write(path);
        assert_int_equal(stat(path, &status), 0);
        assert_int_equal(truncate(path, status.st_size * eighth / 8), 0);
        refuses(stored, path, "not an HDF5 file, or cut off");
    }
    unlink(path);
}

/* A good file with each of the changes. */
static inline void refuses_changed(const TestStored *stored, const TestChange *changes,
                                   size_t count)
{
    const char *path = path_in("changed.h5");
    for (size_t c = 0; c < count; c++) {
        stored->write(path);
        hid_t file = H5Fopen(path, H5F_ACC_RDWR, H5P_DEFAULT);
        changes[c].change(file);
        H5Fclose(file);
        refuses(stored, path, changes[c].words);
    }
    unlink(path);
}

/* ---- changes */

static inline void set_int(hid_t file, const char *object, const char *name, int value)
{
    hid_t holder = H5Oopen(file, object, H5P_DEFAULT);
    hid_t attribute = H5Aopen(holder, name, H5P_DEFAULT);
    assert_true(H5Awrite(attribute, H5T_NATIVE_INT, &value) >= 0);
    H5Aclose(attribute);
    H5Oclose(holder);
}

static inline void older(hid_t file)
{
    set_int(file, ".", "schema", 0);
}

static inline void newer(hid_t file)
{
    int schema;
    hid_t attribute = H5Aopen(file, "schema", H5P_DEFAULT);
    assert_true(H5Aread(attribute, H5T_NATIVE_INT, &schema) >= 0);
    H5Aclose(attribute);
    set_int(file, ".", "schema", schema + 1);
}

#endif
