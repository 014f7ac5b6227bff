/* stored.h - a meshless body and its modes as bytes, for where modes cannot be found: the page.
 *
 * What moves a body is made anew of it by the code that made it of the body that was stored: shape
 * functions of positions and reaches, from them the modes' curls, skin and grips. The modes are
 * those that it had under its handles when it was stored, and no others are sought: other handles,
 * and hands, bind what these can do.
 *
 * The format, version 1. A line of text, "shapebench elastic body 1"; a line that says of what body
 * and settings the modes are, the caller's; then numbers, little-endian, without gaps:
 *     uint32    nodes N, modes M, octants T, the root's edge in finest octants
 *     float64   Young's modulus, Poisson's ratio, density; a finest octant's edge; the octants'
 *               corner, 3; the volume
 *     int32     [T]       each octant's first child (octants.h), or -1
 *     float64   [N][3]    nodes' positions; [N] reaches; [N] shares of the mass (M 1)
 *     float64   [M]       eigenvalues, rising
 *     float32   [M][N][3] modes, each of mass 1
 *     uint64    FNV-1a of all bytes before
 * The basis is linear. */
#ifndef REF_STORED_H
#define REF_STORED_H

#include <stddef.h>
#include <stdint.h>

#include "engine.h"

enum { REF_STORED_KEY = 512 };

typedef struct RefStored {
    char key[REF_STORED_KEY]; /* of what body and settings: one line */
    int32_t nodes, modes, octants, root;
    RefMaterial material; /* in mesh units */
    double cell, origin[3], volume;
    int32_t *child;        /* [octants] */
    double (*position)[3]; /* [nodes] */
    double *reach, *mass;  /* [nodes] */
    double *lambda;        /* [modes] */
    float *shape;          /* [modes][nodes][3] */
} RefStored;

/* What there is to store of an engine's body, with the modes that it moves by now, under a key of
 * one line, shorter than REF_STORED_KEY. The caller frees. */
void ref_stored_of(const char *key, const RefElastic *elastic, RefStored *stored);
void ref_stored_free(RefStored *stored);

/* As bytes, which the caller frees, and how many. */
unsigned char *ref_stored_write(const RefStored *stored, size_t *size);

/* From bytes. SM_INPUT, and nothing to free: they are no stored body, of another version, or
 * damaged. The caller frees. */
SmCode ref_stored_read(const void *bytes, size_t size, RefStored *stored, SmError *error);

/* The body and its modes, of another Young's modulus and density than it was stored with: the first
 * scales eigenvalues, the second masses, both exactly. Its mass matrix has nothing but the nodes'
 * shares, its octants one integration point, of all the volume, and its stiffness is not there.
 * Frees belong to the caller. */
void ref_stored_body(const RefStored *stored, const RefMaterial *material, RefBody *body,
                     RefModes *modes);

#endif
