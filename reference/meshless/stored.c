#include "stored.h"

#include <assert.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "../../lib/system/hash.h"

static const char version[] = "shapebench elastic body 1\n";
static const char family[] = "shapebench elastic body ";
enum { MOST_NODES = 1 << 20, MOST_MODES = 4096 };
/* The mean cube of reaches, by the smallest: at most 8 of a body whose octants are of two sizes. */
static const double MOST_UNLIKE = 64;

void ref_stored_free(RefStored *stored)
{
    sm_free_all(stored->child, stored->position, stored->reach, stored->mass, stored->lambda,
                stored->shape);
    *stored = (RefStored){0};
}

static void make_room(RefStored *stored)
{
    size_t nodes = (size_t)stored->nodes, modes = (size_t)stored->modes;
    stored->child = sm_alloc((size_t)stored->octants, sizeof *stored->child);
    stored->position = sm_alloc(nodes, sizeof *stored->position);
    stored->reach = sm_alloc(nodes, sizeof *stored->reach);
    stored->mass = sm_alloc(nodes, sizeof *stored->mass);
    stored->lambda = sm_alloc(modes, sizeof *stored->lambda);
    stored->shape = sm_alloc(modes * nodes, sizeof(float[3]));
}

void ref_stored_of(const char *key, const RefElastic *elastic, RefStored *stored)
{
    const RefBody *body = &elastic->body;
    const RefMotion *motion = &elastic->motion;
    size_t nodes = (size_t)motion->nodes, modes = (size_t)motion->modes;
    *stored = (RefStored){.nodes = (int32_t)nodes,
                          .modes = (int32_t)modes,
                          .octants = (int32_t)body->octants.count,
                          .root = body->octants.octant[0].size,
                          .material = elastic->material,
                          .cell = body->octants.cell,
                          .volume = ref_octants_volume(&body->octants)};
    assert(strlen(key) < sizeof stored->key);
    snprintf(stored->key, sizeof stored->key, "%s", key);
    memcpy(stored->origin, body->octants.origin, sizeof stored->origin);
    make_room(stored);
    for (int o = 0; o < stored->octants; o++) stored->child[o] = body->octants.octant[o].child;
    memcpy(stored->position, body->nodes.position, nodes * sizeof *stored->position);
    memcpy(stored->reach, body->nodes.reach, nodes * sizeof *stored->reach);
    memcpy(stored->lambda, motion->lambda, modes * sizeof *stored->lambda);
    ref_sparse_sums(&body->matrices.mass, stored->mass);
    for (size_t k = 0; k < modes; k++)
        for (size_t n = 0; n < nodes; n++)
            for (size_t d = 0; d < 3; d++)
                stored->shape[(k * nodes + n) * 3 + d] =
                    (float)motion->row[(6 * n + d) * modes + k];
}

/* ---- bytes: `pass` goes over them once, to count, to write or to read */

typedef struct {
    unsigned char *to;         /* NULL: not written */
    const unsigned char *from; /* NULL: not read */
    uint64_t at;               /* what is counted may be more than the address space of the page */
} Pass;

static void pass(Pass *pass, void *data, uint64_t size)
{
    if (pass->to) memcpy(pass->to + pass->at, data, (size_t)size);
    if (pass->from) memcpy(data, pass->from + pass->at, (size_t)size);
    pass->at += size;
}

static void pass_head(Pass *p, RefStored *stored)
{
    pass(p, &stored->nodes, sizeof stored->nodes);
    pass(p, &stored->modes, sizeof stored->modes);
    pass(p, &stored->octants, sizeof stored->octants);
    pass(p, &stored->root, sizeof stored->root);
    pass(p, &stored->material.young, sizeof(double));
    pass(p, &stored->material.poisson, sizeof(double));
    pass(p, &stored->material.density, sizeof(double));
    pass(p, &stored->cell, sizeof stored->cell);
    pass(p, stored->origin, sizeof stored->origin);
    pass(p, &stored->volume, sizeof stored->volume);
}

static void pass_arrays(Pass *p, RefStored *stored)
{
    uint64_t nodes = (uint64_t)stored->nodes, modes = (uint64_t)stored->modes;
    pass(p, stored->child, (uint64_t)stored->octants * sizeof *stored->child);
    pass(p, stored->position, nodes * sizeof *stored->position);
    pass(p, stored->reach, nodes * sizeof *stored->reach);
    pass(p, stored->mass, nodes * sizeof *stored->mass);
    pass(p, stored->lambda, modes * sizeof *stored->lambda);
    pass(p, stored->shape, modes * nodes * sizeof(float[3]));
}

unsigned char *ref_stored_write(const RefStored *stored, size_t *size)
{
    RefStored copy = *stored; /* which passes only read */
    Pass p = {0};
    size_t lines = strlen(version) + strlen(stored->key) + 1;
    pass_head(&p, &copy);
    pass_arrays(&p, &copy);
    *size = lines + (size_t)p.at + sizeof(uint64_t);
    unsigned char *bytes = sm_alloc(*size, 1);
    snprintf((char *)bytes, *size, "%s%s\n", version, stored->key);
    p = (Pass){.to = bytes, .at = lines};
    pass_head(&p, &copy);
    pass_arrays(&p, &copy);
    uint64_t hash = sm_hash_bytes(SM_HASH_START, bytes, (size_t)p.at);
    pass(&p, &hash, sizeof hash);
    return bytes;
}

static bool all_finite(size_t count, const double *value, double least)
{
    for (size_t i = 0; i < count; i++)
        if (!isfinite(value[i]) || value[i] < least) return false;
    return true;
}

/* Children are eight, behind their parent, and there. */
static bool is_tree(const RefStored *stored)
{
    for (int o = 0; o < stored->octants; o++) {
        int child = stored->child[o];
        if (child != -1 && (child <= o || child > stored->octants - 8)) return false;
    }
    return true;
}

/* Whether covers are of one size but for a few, so that bins (nodes.h) have few nodes each. */
static bool are_alike(const RefStored *stored)
{
    double least = INFINITY, sum = 0;
    for (int n = 0; n < stored->nodes; n++) least = fmin(least, stored->reach[n]);
    for (int n = 0; n < stored->nodes; n++) sum += pow(stored->reach[n] / least, 3);
    return sum <= MOST_UNLIKE * stored->nodes;
}

static bool is_sound(const RefStored *stored)
{
    const RefMaterial *material = &stored->material;
    size_t nodes = (size_t)stored->nodes, modes = (size_t)stored->modes;
    bool shapes = true;
    for (size_t i = 0; i < 3 * nodes * modes; i++) shapes &= isfinite(stored->shape[i]) != 0;
    return shapes && is_tree(stored) && ref_material_check(material, NULL) == SM_OK &&
           all_finite(1, &stored->cell, 1e-300) && all_finite(1, &stored->volume, 1e-300) &&
           all_finite(3, stored->origin, -1e300) &&
           all_finite(3 * nodes, stored->position[0], -1e300) &&
           all_finite(nodes, stored->reach, 1e-9 * stored->cell) && are_alike(stored) &&
           all_finite(nodes, stored->mass, -1e300) && all_finite(modes, stored->lambda, 0);
}

static SmCode damaged(SmError *error)
{
    return sm_fail(error, SM_INPUT,
                   "the stored elastic body is damaged: build the page again (scripts/run view)");
}

/* Past the two lines; 0: they are not there. */
static size_t read_lines(const char *bytes, size_t size, RefStored *stored)
{
    size_t words = strlen(version);
    const char *end = size > words ? memchr(bytes + words, '\n', size - words) : NULL;
    size_t key = end ? (size_t)(end - bytes) - words : REF_STORED_KEY;
    if (key >= REF_STORED_KEY) return 0;
    memcpy(stored->key, bytes + words, key);
    return words + key + 1;
}

SmCode ref_stored_read(const void *bytes, size_t size, RefStored *stored, SmError *error)
{
    *stored = (RefStored){0};
    if (size < strlen(version) || memcmp(bytes, family, strlen(family)) != 0)
        return sm_fail(error, SM_INPUT, "this is no stored elastic body");
    if (memcmp(bytes, version, strlen(version)) != 0)
        return sm_fail(error, SM_INPUT,
                       "the stored elastic body is of another version than this program's: build "
                       "the page again (scripts/run view)");
    Pass p = {.from = bytes, .at = read_lines(bytes, size, stored)}, all = {0};
    RefStored empty = {0};
    pass_head(&all, &empty);
    if (p.at == 0 || size - p.at < all.at + sizeof(uint64_t)) return damaged(error);
    pass_head(&p, stored);
    if (stored->nodes < 1 || stored->nodes > MOST_NODES || stored->modes < 1 ||
        stored->modes > MOST_MODES || stored->octants < 1 || stored->octants > REF_MOST_OCTANTS ||
        stored->root < 1)
        return damaged(error);
    all = (Pass){.at = p.at};
    empty = *stored;
    pass_arrays(&all, &empty);
    if (size != all.at + sizeof(uint64_t)) return damaged(error);
    uint64_t hash;
    memcpy(&hash, (const char *)bytes + all.at, sizeof hash);
    if (hash != sm_hash_bytes(SM_HASH_START, bytes, (size_t)all.at)) return damaged(error);
    make_room(stored);
    pass_arrays(&p, stored);
    if (is_sound(stored)) return SM_OK;
    ref_stored_free(stored);
    return damaged(error);
}

/* ---- the body */

static void make_octants(const RefStored *stored, RefOctants *octants)
{
    *octants = (RefOctants){.cell = stored->cell, .count = stored->octants, .points = 1};
    memcpy(octants->origin, stored->origin, sizeof octants->origin);
    octants->octant = sm_alloc((size_t)stored->octants, sizeof *octants->octant);
    octants->octant[0].size = stored->root;
    for (int o = 0; o < stored->octants; o++) {
        RefOctant *octant = octants->octant + o;
        octant->child = stored->child[o];
        for (int which = 0; octant->child >= 0 && which < 8; which++) {
            RefOctant *child = octants->octant + octant->child + which;
            child->size = octant->size / 2;
            for (int d = 0; d < 3; d++)
                child->corner[d] = octant->corner[d] + (which >> d & 1) * child->size;
        }
    }
    octants->point = sm_alloc(1, sizeof *octants->point);
    octants->point[0].weight = stored->volume;
}

static void make_nodes(const RefStored *stored, RefNodes *nodes)
{
    size_t count = (size_t)stored->nodes;
    *nodes = (RefNodes){.count = stored->nodes};
    nodes->position = sm_alloc(count, sizeof *nodes->position);
    nodes->reach = sm_alloc(count, sizeof *nodes->reach);
    memcpy(nodes->position, stored->position, count * sizeof *nodes->position);
    memcpy(nodes->reach, stored->reach, count * sizeof *nodes->reach);
    ref_nodes_bin(nodes);
}

static void make_masses(const RefStored *stored, double denser, RefMatrices *matrices)
{
    size_t count = (size_t)stored->nodes;
    RefSparse *mass = &matrices->mass;
    *matrices = (RefMatrices){.lumped = true, .mass.columns = stored->nodes};
    mass->start = sm_alloc(count + 1, sizeof *mass->start);
    mass->row = sm_alloc(count, sizeof *mass->row);
    mass->value = sm_alloc(count, sizeof *mass->value);
    for (size_t n = 0; n < count; n++) {
        mass->row[n] = (int)n;
        mass->start[n + 1] = (int)n + 1;
        mass->value[n] = denser * stored->mass[n];
    }
}

void ref_stored_body(const RefStored *stored, const RefMaterial *material, RefBody *body,
                     RefModes *modes)
{
    size_t nodes = (size_t)stored->nodes, count = (size_t)stored->modes;
    double denser = material->density / stored->material.density;
    double stiffer = material->young / stored->material.young / denser;
    *body = (RefBody){.basis = REF_MLS_LINEAR};
    make_octants(stored, &body->octants);
    make_nodes(stored, &body->nodes);
    make_masses(stored, denser, &body->matrices);
    *modes = (RefModes){.nodes = stored->nodes, .count = stored->modes};
    modes->lambda = sm_alloc(count, sizeof *modes->lambda);
    modes->shape = sm_alloc(3 * nodes * count, sizeof *modes->shape);
    for (size_t k = 0; k < count; k++) {
        modes->lambda[k] = stiffer * stored->lambda[k];
        for (size_t n = 0; n < 3 * nodes; n++)
            modes->shape[n * count + k] = stored->shape[3 * nodes * k + n] / sqrt(denser);
    }
}
