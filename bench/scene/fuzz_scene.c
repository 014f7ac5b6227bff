/* Scene files: any bytes are a scene or one error line. */
#include <assert.h>
#include <stdint.h>
#include <string.h>

#include "scene.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    BenchScene scene;
    SmError error = {0};
    SmCode code = bench_scene_parse((const char *)data, size, "fuzz.cfg", &scene, &error);
    assert(code == SM_OK || code == SM_INPUT);
    assert(code == SM_OK || (error.text[0] && !strchr(error.text, '\n')));
    return 0;
}
