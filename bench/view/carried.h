/* carried.h - what carries the surface of FastLSM, and of an elastic body, whose surface a
 * lattice's corners carry, too, for a vertex shader that interpolates it (fastlsm section 4, eqs.
 * 15 to 17), as lib/voxel/embed.h does here: with particles i of a vertex's cell, x = x_0 + sum_i
 * phi_i (x_i - x_0),   normal along (sum_i u_i (x_i - x_0)) x (sum_i v_i (x_i - x_0)).
 *
 * Pointers stay valid until the next call that steps, changes or opens. */
#ifndef BENCH_CARRIED_H
#define BENCH_CARRIED_H

/* A number that changes with what follows; 0: the side's surface is not carried so (an octree's, or
 * one that has been cut). */
int view_carried(int side);

/* Of one body: vertices and particles; and how many bodies there are. */
int view_carried_vertices(int side);
int view_carried_particles(int side);
int view_carried_bodies(int side);

/* [vertices][8]: particles' numbers in a body; and phi (0), u (1) or v (2) of each. */
const int *view_carriers(int side);
const float *view_carried_weights(int side, int which);

/* Where the particles of all bodies are now: x, y, z and 0, in rows of VIEW_ROW of which the last
 * is filled up. O(particles). */
enum { VIEW_ROW = 2048 };
const float *view_places(int side);

#endif
