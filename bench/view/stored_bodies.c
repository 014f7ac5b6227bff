#include "stored_bodies.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "../../lib/box.h"
#include "../../lib/system/hash.h"
#include "../engines.h"
#include "view.h"

enum { MOST_BODIES = 16 };

static struct {
    unsigned char *bytes; /* the room for a file */
    size_t size;
    int count;
    RefStored body[MOST_BODIES];
    SmError error;
} stored;

unsigned char *view_stored_room(int bytes)
{
    free(stored.bytes);
    stored.size = (size_t)bytes;
    return stored.bytes = sm_alloc(stored.size, 1);
}

static RefStored *find(const char *key)
{
    for (int i = 0; i < stored.count; i++)
        if (!strcmp(stored.body[i].key, key)) return &stored.body[i];
    return NULL;
}

const char *view_stored_take(void)
{
    RefStored body;
    SmCode code = ref_stored_read(stored.bytes, stored.size, &body, &stored.error);
    free(stored.bytes);
    stored.bytes = NULL;
    stored.size = 0;
    if (code) return stored.error.text;
    RefStored *place = find(body.key);
    if (!place) place = &stored.body[stored.count < MOST_BODIES ? stored.count++ : 0];
    ref_stored_free(place);
    *place = body;
    return "";
}

/* Where handles hold, as a short name: files have it in a line. */
static unsigned long long handles_of(const BenchScene *scene)
{
    unsigned long long hash = SM_HASH_START;
    for (int i = 0; i < scene->handle_count; i++) {
        const BenchSelect *select = &scene->handle[i].select;
        char text[256];
        int size = select->sphere
                       ? snprintf(text, sizeof text, "%.9g %.9g %.9g %.9g", select->centre[0],
                                  select->centre[1], select->centre[2], select->radius)
                       : snprintf(text, sizeof text, "%.9g %.9g %.9g to %.9g %.9g %.9g",
                                  select->low[0], select->low[1], select->low[2], select->high[0],
                                  select->high[1], select->high[2]);
        hash = sm_hash_bytes(hash, text, (size_t)size + 1);
    }
    return hash;
}

void view_stored_key(const BenchScene *scene, char key[REF_STORED_KEY])
{
    const RefMeshlessOptions *options = &scene->meshless;
    const char *slash = strrchr(scene->mesh, '/');
    snprintf(key, REF_STORED_KEY,
             "mesh %.256s, points %ld, nodes %ld, uniform %d, modes %d, basis %d, poisson %.9g, "
             "metre %.9g, handles %d: %016llx",
             slash ? slash + 1 : scene->mesh, options->points, options->nodes, options->uniform,
             options->modes, options->basis, options->material.poisson, scene->metre,
             scene->handle_count, handles_of(scene));
}

const RefStored *view_stored_find(const BenchScene *scene, const SmMesh *mesh)
{
    char key[REF_STORED_KEY];
    view_stored_key(scene, key);
    const RefStored *body = find(key);
    if (!body) return NULL;
    SmBox is = sm_box_around(mesh->vertex_count, (const double(*)[3])mesh->position);
    SmBox nodes = sm_box_around(body->nodes, (const double(*)[3])body->position);
    double most = 2 * body->cell; /* of the nodes nearest to a face: those are in the middles */
    for (int d = 0; d < 3; d++)
        if (fabs(is.low[d] - nodes.low[d]) > most || fabs(is.high[d] - nodes.high[d]) > most)
            return NULL;
    return body;
}

int view_stored_for(int bytes)
{
    static BenchScene scene;
    char key[REF_STORED_KEY];
    if (bench_scene_parse(view_text(), (size_t)bytes, "scene", &scene, NULL)) return 0;
    if (bench_engine(scene.engine)->own != BENCH_OF_ELASTIC) return 0;
    view_stored_key(&scene, key);
    return find(key) ? 1 : 2;
}
