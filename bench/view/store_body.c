/* store_body.c - finds the modes of a scene's elastic body, and stores them for the page.
 *
 * usage: store_body SCENE FILE     SCENE: a built-in scene's name or a scene file
 *
 * exit codes: 0 stored; 2 usage, or SCENE is of no elastic body; 3 SCENE or its mesh cannot be
 * used; 4 FILE cannot be written; others as those of shapebench */
#include <stdio.h>
#include <stdlib.h>

#include "../engines.h"
#include "../play/runner.h"
#include "../store/draft.h"
#include "stored_bodies.h"

static int say(const SmError *error)
{
    fprintf(stderr, "store_body: %s\n", error->text);
    return error->code;
}

static void print_body(FILE *file, const void *what)
{
    size_t size;
    unsigned char *bytes = ref_stored_write(what, &size);
    fwrite(bytes, 1, size, file);
    free(bytes);
}

int main(int count, char **argument)
{
    static BenchScene scene;
    BenchBody body;
    BenchRunner runner;
    RefStored stored;
    SmError error;
    char key[REF_STORED_KEY];
    if (count != 3) {
        fprintf(stderr, "usage: store_body SCENE FILE\n");
        return SM_USAGE;
    }
    if (bench_scene_find(argument[1], &scene, &error)) return say(&error);
    if (bench_engine(scene.engine)->own != BENCH_OF_ELASTIC) {
        sm_fail(&error, SM_USAGE, "%s: its engine is %s, whose bodies have no modes to store",
                scene.file, scene.engine);
        return say(&error);
    }
    if (scene.meshless.basis == REF_MESHLESS_QUADRATIC) {
        sm_fail(&error, SM_USAGE, "%s: stored bodies are of the linear basis", scene.file);
        return say(&error);
    }
    if (bench_body_of_scene(&scene, NULL, &body, &error)) return say(&error);
    SmCode code =
        bench_runner_create(&scene, &body, bench_engine(scene.engine)->type[0], 0, &runner, &error);
    if (!code) {
        view_stored_key(&scene, key);
        ref_stored_of(key, ref_meshless_elastic(runner.engine), &stored);
        code = bench_draft_write(argument[2], print_body, &stored, &error);
        ref_stored_free(&stored);
        bench_runner_free(&runner);
    }
    bench_body_free(&body);
    return code ? say(&error) : SM_OK;
}
