/* stored_bodies.h - the elastic bodies that a page carries, by what they are of.
 *
 * Modes cannot be found in the page: store_body.c has them found by the program, and writes them
 * (reference/meshless/stored.h) for the page to hand over. They are those of a scene's mesh, its
 * group `meshless` and where its handles are. All else may change: Young's modulus and density,
 * gravity, damping, time step, how handles move, and the lattice that carries the surface. */
#ifndef BENCH_STORED_BODIES_H
#define BENCH_STORED_BODIES_H

#include "../../reference/meshless/stored.h"
#include "../scene/body.h"

/* Room of zeros for a file's bytes, which the page fills; and takes the body that is in it: "", or
 * the line that says why it is none. One of the same settings takes another's place. */
unsigned char *view_stored_room(int bytes);
const char *view_stored_take(void);

/* Of the scene whose text is in view.h's room: 0, it is of no elastic body; 1, it is, and the page
 * has it; 2, it is, and the page has it not. */
int view_stored_for(int bytes);

/* What a scene's modes are of, one line. */
void view_stored_key(const BenchScene *scene, char key[REF_STORED_KEY]);

/* The body that is stored for a scene, or NULL: none is, or it is not where this mesh is. */
const RefStored *view_stored_find(const BenchScene *scene, const SmMesh *mesh);

#endif
