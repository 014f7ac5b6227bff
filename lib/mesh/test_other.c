/* Formats that Assimp reads, in a child process; what becomes of children. */
#include <dirent.h>
#include <errno.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include "../system/child.h"
#include "test_meshes.h"

static int open_descriptors(void)
{
    int count = 0;
    DIR *listing = opendir("/proc/self/fd");
    assert_non_null(listing);
    while (readdir(listing)) count++;
    closedir(listing);
    return count;
}

/* Two nodes use one mesh; one moves it, the other mirrors it. */
static const char *write_two(void)
{
    static char text[4096];
    static const char geometry[] =
        "<library_geometries><geometry id=\"g\"><mesh><source id=\"p\"><float_array id=\"pa\" "
        "count=\"12\">0 0 0 1 0 0 0 1 0 0 0 1</float_array><technique_common><accessor "
        "source=\"#pa\" count=\"4\" stride=\"3\"><param name=\"X\" type=\"float\"/><param "
        "name=\"Y\" type=\"float\"/><param name=\"Z\" type=\"float\"/></accessor>"
        "</technique_common></source><vertices id=\"v\"><input semantic=\"POSITION\" "
        "source=\"#p\"/></vertices><triangles count=\"4\"><input semantic=\"VERTEX\" "
        "source=\"#v\" offset=\"0\"/><p>0 2 1 0 1 3 1 2 3 0 3 2</p></triangles></mesh>"
        "</geometry></library_geometries>";
    snprintf(text, sizeof text,
             "<?xml version=\"1.0\"?><COLLADA xmlns=\"http://www.collada.org/2005/11/"
             "COLLADASchema\" version=\"1.4.1\"><asset><up_axis>Y_UP</up_axis></asset>%s"
             "<library_visual_scenes><visual_scene id=\"s\"><node><translate>10 0 0</translate>"
             "<node><translate>0 5 0</translate><instance_geometry url=\"#g\"/></node></node>"
             "<node><scale>-2 1 1</scale><instance_geometry url=\"#g\"/></node>"
             "</visual_scene></library_visual_scenes><scene><instance_visual_scene "
             "url=\"#s\"/></scene></COLLADA>",
             geometry);
    return write_text("two.dae", text);
}

TEST(test_node_transforms)
{
    SmMeshInfo info = import_info(write_two());
    assert_int_equal(info.components, 2);
    assert_true(info.watertight);
    assert_near(info.volume, 0.5, 1e-6); /* 1/6 and, outside kept, 2/6 */
    assert_near(info.low[0], -2, 1e-6);
    assert_near(info.high[0], 11, 1e-6);
    assert_near(info.high[1], 6, 1e-6);
}

/* A mesh of 100,000 triangles, used 100 times: 10 million in a file of a megabyte. */
static const char *write_many(void)
{
    const char *path = path_in("many.dae");
    FILE *file = fopen(path, "w");
    assert_non_null(file);
    fputs("<?xml version=\"1.0\"?><COLLADA xmlns=\"http://www.collada.org/2005/11/COLLADASchema\" "
          "version=\"1.4.1\"><library_geometries><geometry id=\"g\"><mesh><source id=\"p\">"
          "<float_array id=\"pa\" count=\"9\">0 0 0 1 0 0 0 1 0</float_array><technique_common>"
          "<accessor source=\"#pa\" count=\"3\" stride=\"3\"><param name=\"X\" type=\"float\"/>"
          "<param name=\"Y\" type=\"float\"/><param name=\"Z\" type=\"float\"/></accessor>"
          "</technique_common></source><vertices id=\"v\"><input semantic=\"POSITION\" "
          "source=\"#p\"/></vertices><triangles count=\"100000\"><input semantic=\"VERTEX\" "
          "source=\"#v\" offset=\"0\"/><p>",
          file);
    for (int t = 0; t < 100000; t++) fputs("0 1 2 ", file);
    fputs("</p></triangles></mesh></geometry></library_geometries><library_visual_scenes>"
          "<visual_scene id=\"s\">",
          file);
    for (int n = 0; n < 100; n++) fputs("<node><instance_geometry url=\"#g\"/></node>", file);
    fputs(
        "</visual_scene></library_visual_scenes><scene><instance_visual_scene url=\"#s\"/></scene>"
        "</COLLADA>",
        file);
    fclose(file);
    return path;
}

TEST(parts_used_again_and_again_are_counted_first)
{
    expect_error(write_many(), NULL, "it uses its parts so often");
}

TEST(test_unusable_files)
{
    expect_error(write_text("empty.dae", ""), NULL, "empty");
    expect_error(write_text("words.dae", "these are words\n"), NULL, "Export it again");
    expect_error(write_text("text.docx", "hello"), NULL, "save it as ");
}

static int body_echo(void *argument, int reply)
{
    return write(reply, argument, strlen(argument)) != (ssize_t)strlen(argument);
}

static int body_flood(void *argument, int reply)
{
    static const char block[65536];
    (void)argument;
    while (write(reply, block, sizeof block) > 0) continue;
    return 0;
}

static int body_crash(void *argument, int reply)
{
    (void)reply;
    raise(*(int *)argument);
    return 0;
}

static int body_sleep(void *argument, int reply)
{
    (void)argument;
    (void)reply;
    for (;;) pause();
    return 0;
}

static int body_close_and_sleep(void *argument, int reply)
{
    close(reply);
    return body_sleep(argument, reply);
}

static int body_status(void *argument, int reply)
{
    (void)reply;
    return *(int *)argument;
}

static int body_hungry(void *argument, int reply)
{
    (void)argument;
    (void)reply;
    for (int megabyte = 0; megabyte < 1024; megabyte++) {
        char *volatile block = malloc(1 << 20); /* or clang leaves it out */
        if (!block) return SM_CHILD_NO_MEMORY;
        memset(block, 1, 1 << 20);
    }
    return 0;
}

static SmChildResult run_child(SmChildBody body, void *argument, double seconds)
{
    SmChildLimits limits = {seconds, 64};
    int before = open_descriptors();
    SmChildResult result = sm_child_run(body, argument, &limits);
    assert_int_equal(open_descriptors(), before);
    assert_int_equal(waitpid(-1, NULL, WNOHANG), -1); /* no child, living or dead */
    assert_int_equal(errno, ECHILD);
    return result;
}

TEST(test_child_ends)
{
    char word[] = "words";
    SmChildResult result = run_child(body_echo, word, 20);
    assert_int_equal(result.end, SM_CHILD_REPLIED);
    assert_int_equal(result.size, 5);
    assert_memory_equal(result.reply, word, 5);
    free(result.reply);

    int signals[] = {SIGSEGV, SIGABRT, SIGKILL};
    for (int i = 0; i < 3; i++) {
        result = run_child(body_crash, &signals[i], 20);
        assert_int_equal(result.end, SM_CHILD_CRASHED);
        assert_int_equal(result.signal, signals[i]);
        free(result.reply);
    }
    int status = 3;
    result = run_child(body_status, &status, 20);
    assert_int_equal(result.end, SM_CHILD_CRASHED);
    assert_int_equal(result.status, 3);
    free(result.reply);
}

TEST(test_child_limits)
{
    SmChildResult result = run_child(body_sleep, NULL, 0.2);
    assert_int_equal(result.end, SM_CHILD_TOO_LONG);
    free(result.reply);
    result = run_child(body_close_and_sleep, NULL, 0.2);
    assert_int_equal(result.end, SM_CHILD_TOO_LONG);
    free(result.reply);
    result = run_child(body_flood, NULL, 20);
    assert_int_equal(result.end, SM_CHILD_TOO_LARGE);
    free(result.reply);
}

static void needs_memory_limit(void)
{
    needs(SM_CHILD_LIMITS_MEMORY, "sanitizers leave a child's memory without a limit");
}

TEST(test_child_without_memory)
{
    needs_memory_limit();
    SmChildResult result = run_child(body_hungry, NULL, 20);
    assert_int_equal(result.end, SM_CHILD_TOO_LARGE);
    free(result.reply);
}

TEST(test_limits)
{
    expect_error(write_many(), &(SmImportLimits){0.001, 0}, "longer than 0.001 s");
    needs_memory_limit();
    expect_error(write_many(), &(SmImportLimits){0, 2}, "more than 2 MB");
}

TEST(test_parent_ignores_children)
{
    void (*old)(int) = signal(SIGCHLD, SIG_IGN);
    SmMeshInfo info = import_info(write_two());
    signal(SIGCHLD, old);
    assert_int_equal(info.triangles, 8);
}

/* Children forked by many threads at once neither hold up nor disturb one another. */
TEST(test_parallel_imports)
{
    const char *path = write_two();
    int before = open_descriptors(), good = 0;
#pragma omp parallel for num_threads(4) reduction(+ : good)
    for (int i = 0; i < 16; i++) {
        SmMesh mesh;
        good += sm_import(path, NULL, &mesh, NULL, NULL) == SM_OK && mesh.triangle_count == 8;
        sm_mesh_free(&mesh);
    }
    assert_int_equal(good, 16);
    assert_int_equal(open_descriptors(), before);
    assert_int_equal(waitpid(-1, NULL, WNOHANG), -1);
}
