/* test_folder.h - a folder of the test's own, for files that it writes.
 *
 * make_folder() and remove_folder() are the group's fixture, unless the file names another, which
 * calls them: between them the folder is there, and afterwards nothing in it. */
#ifndef SM_TEST_FOLDER_H
#define SM_TEST_FOLDER_H

#include <dirent.h>

#include "test_frame.h"

static char folder[] = "/tmp/shapebench_test_XXXXXX";

static inline int make_folder(void **state)
{
    (void)state;
    return mkdtemp(folder) ? 0 : -1;
}

static inline int remove_folder(void **state)
{
    (void)state;
    char command[128];
    snprintf(command, sizeof command, "rm -rf %s", folder);
    return system(command);
}

TEST_GROUP(make_folder, remove_folder)

/* Where `name` is in the folder; stands until the next call. */
static inline const char *path_in(const char *name)
{
    static char path[256];
    snprintf(path, sizeof path, "%s/%s", folder, name);
    return path;
}

/* Writes a file in the folder and returns its path, as path_in() does. */
static inline const char *write_bytes(const char *name, const void *bytes, size_t size)
{
    const char *path = path_in(name);
    FILE *file = fopen(path, "wb");
    assert_non_null(file);
    assert_int_equal(fwrite(bytes, 1, size, file), size);
    assert_int_equal(fclose(file), 0);
    return path;
}

static inline const char *write_text(const char *name, const char *text)
{
    return write_bytes(name, text, strlen(text));
}

/* How many entries of the folder end in `end`. */
static inline int entries(const char *end)
{
    DIR *all = opendir(folder);
    int count = 0;
    assert_non_null(all);
    for (struct dirent *entry; (entry = readdir(all));) {
        const char *name = entry->d_name;
        size_t length = strlen(name), tail = strlen(end);
        if (!strcmp(name, ".") || !strcmp(name, "..")) continue;
        count += length >= tail && !strcmp(name + length - tail, end);
    }
    closedir(all);
    return count;
}

#endif
