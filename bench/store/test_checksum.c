/* Damaged files: what is changed in a stored file is noticed before anything of it is believed. */
#include "../../lib/system/child.h"
#include "../../lib/test_folder.h"
#include "../../lib/test_frame.h"
#include "h5.h"

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

TEST(every_flipped_bit_is_noticed)
{
    size_t size;
    unsigned char *bytes = store("whole.h5", &size);
    loads("whole.h5");
    for (size_t bit = 0; bit < 8 * size; bit += 211) {
        bytes[bit / 8] ^= (unsigned char)(1 << bit % 8);
        write_bytes("flipped.h5", bytes, size);
        refuses("flipped.h5", read_numbers, "checksum");
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

/* Writes a file as the program did before there were checksums. */
static void write_old(const char *name, void (*change)(hid_t file))
{
    size_t size;
    free(store(name, &size));
    hid_t file = H5Fopen(path_in(name), H5F_ACC_RDWR, H5P_DEFAULT);
    H5Adelete(file, BENCH_H5_CHECKSUM);
    if (change) change(file);
    H5Fclose(file);
}

TEST(what_others_write_is_noticed_but_old_files_are_read)
{
    size_t size;
    free(store("changed.h5", &size));
    hid_t file = H5Fopen(path_in("changed.h5"), H5F_ACC_RDWR, H5P_DEFAULT);
    H5Adelete(file, "kind");
    H5Fclose(file);
    refuses("changed.h5", read_numbers, "something else wrote to it");
    write_old("old.h5", NULL);
    loads("old.h5");
}

/* 8 TB that were never written, in a file of some KB. */
static void replace_by_hole(hid_t file)
{
    const hsize_t huge = (hsize_t)1 << 40;
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
    const hsize_t huge = (hsize_t)1 << 40;
    bench_h5_find_dataset(h5, h5->file, "many", 1, &huge);
}

/* The same numbers again and again would be more than the file, too. */
static void read_twice(BenchH5 *h5, void *record)
{
    read_numbers(h5, record);
    read_numbers(h5, record);
}

static void link_elsewhere(hid_t file)
{
    H5Ldelete(file, "many", H5P_DEFAULT);
    H5Lcreate_external("/dev/zero", "many", file, "many", H5P_DEFAULT, H5P_DEFAULT);
}

TEST(what_is_not_in_the_file_is_not_read)
{
    write_old("hole.h5", replace_by_hole);
    refuses("hole.h5", read_hole, "'many' holds more than the file does");
    write_old("old.h5", NULL);
    refuses("old.h5", read_twice, "'many' holds more than the file does");
    write_old("link.h5", link_elsewhere);
    refuses("link.h5", read_numbers, "'many' is missing");
}

static void crash(BenchH5 *h5, void *record)
{
    (void)h5;
    (void)record;
    abort();
}

static void take_memory(BenchH5 *h5, void *record)
{
    (void)h5;
    (void)record;
    free(sm_alloc((size_t)1 << 32, 1));
}

TEST(damage_ends_a_child_only)
{
    size_t size;
    free(store("whole.h5", &size));
    refuses("whole.h5", crash, "crashes");
}

TEST(a_child_takes_no_more_memory_than_it_may)
{
    size_t size;
    needs(SM_CHILD_LIMITS_MEMORY, "sanitizers leave a child's memory without a limit");
    free(store("whole.h5", &size));
    refuses("whole.h5", take_memory, "takes more memory");
}
