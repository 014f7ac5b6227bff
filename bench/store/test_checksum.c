/* Damaged files: what is changed in a stored file is noticed before anything of it is believed. */
#include "../../lib/test_folder.h"
#include "../../lib/test_frame.h"
#include "checksum.h"
#include "h5.h"

#include <sys/wait.h>
#include <unistd.h>

enum { NUMBERS = 500 };

static const hsize_t numbers_size = NUMBERS;

static void write_numbers(BenchH5 *h5, void *record)
{
    const double one = 1.5;
    bench_h5_text(h5, h5->file, "kind", "numbers");
    bench_h5_numbers(h5, h5->file, "one", H5T_IEEE_F64LE, 0, &one);
    bench_h5_dataset(h5, h5->file, "many", H5T_IEEE_F64LE, 1, &numbers_size, record);
}

static void read_numbers(BenchH5 *h5, void *record)
{
    bench_h5_read(h5, bench_h5_find_dataset(h5, h5->file, "many", 1, &numbers_size),
                  H5T_NATIVE_DOUBLE, record);
}

/* The bytes of a stored file; the caller frees them. */
static unsigned char *store(const char *name, size_t *size)
{
    double number[NUMBERS];
    SmError error = {0};
    for (int i = 0; i < NUMBERS; i++) number[i] = i;
    if (bench_h5_store(path_in(name), write_numbers, number, &error)) fail_msg("%s", error.text);
    FILE *file = fopen(path_in(name), "rb");
    assert_non_null(file);
    fseek(file, 0, SEEK_END);
    *size = (size_t)ftell(file);
    rewind(file);
    unsigned char *bytes = malloc(*size);
    assert_int_equal(fread(bytes, 1, *size, file), *size);
    fclose(file);
    return bytes;
}

static void loads(const char *name)
{
    double number[NUMBERS];
    SmError error = {0};
    if (bench_h5_load(path_in(name), read_numbers, number, &error)) fail_msg("%s", error.text);
    for (int i = 0; i < NUMBERS; i++) assert_true(number[i] == i);
}

static void refuses(const char *name, void (*read)(BenchH5 *h5, void *record), const char *words)
{
    double number[NUMBERS];
    SmError error = {0};
    assert_int_equal(bench_h5_load(path_in(name), read, number, &error), SM_INPUT);
    if (!strstr(error.text, words) || !strstr(error.text, name))
        fail_msg("'%s' does not say '%s'", error.text, words);
}

/* Is the file refused, or read right with a remark, as one that another program has written to? */
static void is_noticed(const char *name)
{
    double number[NUMBERS];
    SmError error = {0};
    BenchChecksum found;
    FILE *file = fopen(path_in(name), "rb");
    assert_int_equal(bench_checksum_check(file, &found), 0);
    fclose(file);
    assert_int_not_equal(found, BENCH_CHECKSUM_HOLDS);
    if (!bench_h5_load(path_in(name), read_numbers, number, &error))
        for (int i = 0; i < NUMBERS; i++) assert_true(number[i] == i);
    else if (!strstr(error.text, name))
        fail_msg("'%s' does not name the file", error.text);
}

TEST(every_flipped_bit_is_noticed)
{
    size_t size;
    unsigned char *bytes = store("whole.h5", &size);
    loads("whole.h5");
    for (size_t bit = 0; bit < 8 * size; bit += 61) {
        bytes[bit / 8] ^= (unsigned char)(1 << bit % 8);
        write_bytes("flipped.h5", bytes, size);
        is_noticed("flipped.h5");
        bytes[bit / 8] ^= (unsigned char)(1 << bit % 8);
    }
    free(bytes);
}

TEST(what_is_cut_off_is_noticed)
{
    size_t size;
    unsigned char *bytes = store("whole.h5", &size);
    for (size_t cut = 1; cut < size; cut += cut < 70 ? 9 : size / 10) {
        write_bytes("cut.h5", bytes, size - cut);
        refuses("cut.h5", read_numbers, "cut off");
    }
    free(bytes);
}

/* Stores a file that another program changes. */
static void write_changed(const char *name, void (*change)(hid_t file))
{
    size_t size;
    free(store(name, &size));
    hid_t file = H5Fopen(path_in(name), H5F_ACC_RDWR, H5P_DEFAULT);
    change(file);
    H5Fclose(file);
}

static void lose_kind(hid_t file)
{
    H5Adelete(file, "kind");
}

TEST(a_file_that_another_program_has_written_to_is_read)
{
    write_changed("changed.h5", lose_kind);
    is_noticed("changed.h5");
    loads("changed.h5");
}

static void replace_by_plain(hid_t file)
{
    double number[NUMBERS];
    hid_t space = H5Screate_simple(1, &numbers_size, NULL);
    for (int i = 0; i < NUMBERS; i++) number[i] = i;
    H5Ldelete(file, "many", H5P_DEFAULT);
    hid_t plain =
        H5Dcreate2(file, "many", H5T_IEEE_F64LE, space, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT);
    H5Dwrite(plain, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, number);
    H5Dclose(plain);
    H5Sclose(space);
}

static void find_unchecked(BenchH5 *h5, void *record)
{
    double number[NUMBERS];
    read_numbers(h5, number);
    *(bool *)record = h5->unchecked;
}

TEST(data_without_checksums_are_told_from_those_that_have_them)
{
    bool unchecked[2];
    write_changed("changed.h5", lose_kind);
    write_changed("plain.h5", replace_by_plain);
    assert_int_equal(bench_h5_load(path_in("changed.h5"), find_unchecked, &unchecked[0], NULL), 0);
    assert_int_equal(bench_h5_load(path_in("plain.h5"), find_unchecked, &unchecked[1], NULL), 0);
    assert_true(!unchecked[0] && unchecked[1]);
}

TEST(a_file_that_another_program_has_open_is_refused_with_the_remedy)
{
    size_t size;
    free(store("open.h5", &size));
    pid_t child = fork();
    if (child == 0) { /* ends while it has it open */
        H5Fopen(path_in("open.h5"), H5F_ACC_RDWR, H5P_DEFAULT);
        _exit(0);
    }
    waitpid(child, NULL, 0);
    refuses("open.h5", read_numbers, "another program has it open, or ended while it had");
}

TEST(a_file_of_the_old_format_is_refused_with_the_remedy)
{
    H5Fclose(H5Fcreate(path_in("old.h5"), H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT));
    refuses("old.h5", read_numbers, "convert it: h5repack");
}

static const hsize_t huge = (hsize_t)1 << 40;

/* 8 TB that were never written, in a file of some KB. */
static void replace_by_hole(hid_t file)
{
    H5Ldelete(file, "many", H5P_DEFAULT);
    hid_t space = H5Screate_simple(1, &huge, NULL);
    hid_t hole =
        H5Dcreate2(file, "many", H5T_IEEE_F64LE, space, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT);
    assert_true(hole >= 0);
    H5Dclose(hole);
    H5Sclose(space);
}

static void read_hole(BenchH5 *h5, void *record)
{
    (void)record;
    bench_h5_find_dataset(h5, h5->file, "many", 1, &huge);
}

/* Two times the same numbers are more than the file, too. */
static void read_twice(BenchH5 *h5, void *record)
{
    read_numbers(h5, record);
    read_numbers(h5, record);
}

TEST(no_more_is_read_than_the_file_holds)
{
    size_t size;
    write_changed("hole.h5", replace_by_hole);
    refuses("hole.h5", read_hole, "'many' holds more than the file does");
    free(store("whole.h5", &size));
    refuses("whole.h5", read_twice, "'many' holds more than the file does");
}

TEST(every_dataset_has_a_checksum)
{
    size_t size;
    free(store("whole.h5", &size));
    BenchH5 h5;
    bench_h5_open(&h5, path_in("whole.h5"));
    hid_t dataset = H5Dopen2(h5.file, "many", H5P_DEFAULT), layout = H5Dget_create_plist(dataset);
    assert_true(H5Pall_filters_avail(layout) > 0 && H5Pget_nfilters(layout) == 1);
    H5Pclose(layout);
    H5Dclose(dataset);
    assert_true(bench_h5_close(&h5));
}
