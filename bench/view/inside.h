/* inside.h - what the page shows of the inside of a side: particles, links and cells, one
 * particle's region with what sums it and its goal; the shape at rest; and how far the two sides'
 * surfaces are apart. As view.h: by number and pointer, pointers valid until the next call that
 * steps, changes, opens, or finds the same of the same side. Nothing here changes the motion but
 * for rounding, and that view_mark() alone: the next rotations begin from those of its goals.
 *
 * Places are those now, in mesh units. A side's particles, of the octree, of an elastic body and of
 * a shell its simulation nodes, are numbered from 0 through all of its bodies; while they run, an
 * octree's numbers change with its cells, and a shell's with its cracks. An elastic body's node has
 * a cover for a region: it moves what is there (meshless section 3), in one cube, which
 * view_boxes() has as it is turned; and no goal. A shell's node has for a region the nodes that
 * move the surface where it stands, and no box. */
#ifndef BENCH_INSIDE_H
#define BENCH_INSIDE_H

/* Where all particles are, [particles][3], and how many. O(particles). NULL and 0 of a side that is
 * not there. */
int view_particles(int side);
const float *view_particle_points(int side);

/* Unbroken links of FastLSM, of all bodies: how many, O(particles); and their ends, [links][2],
 * O(links): first those along the lattice's axes, of which view_straight_links() says how many
 * there were. 0 of other engines. */
int view_links(int side);
const int *view_link_ends(int side);
int view_straight_links(int side);

/* Cells of the octree's leaves, particle by particle, as the surface is carried (octree section 7):
 * [cells][VIEW_CELL_NUMBERS], the middle, from there the way to three faces, and the level, 0 of a
 * base cell. O(edges of the visibility graph). Of a shell the cells of its quadtree on its middle
 * surface, as thick as it is, the largest of level 0. 0 and NULL of other engines. */
enum { VIEW_CELL_NUMBERS = 13 };
int view_cells(int side);
const float *view_cell_frames(int side);

/* Marks a particle: finds its region, what sums that, and its goal. Returns how many members it
 * has, 0 where there is no such particle. O(particles); and goals, about what half a step costs. */
int view_mark(int side, int particle);

/* Of the particle marked last. Members: [members][3], their numbers in rising order, and of each
 * the bar and the plate of FastLSM's sums (fastlsm section 3.1), or the octree's summation node
 * (octree section 4.2) and 0, from 0 on: none where members are summed one by one. */
const int *view_members(int side);

/* How many of each there are; and how far the goal is, in finest cells. */
enum { VIEW_BARS, VIEW_PLATES, VIEW_NODES, VIEW_GOAL_CELLS, VIEW_MARK_FIGURES };
double view_mark_figure(int side, int figure);

/* Its goal position, [3]. */
const double *view_goal(int side);

/* Cells of the summation nodes: [nodes][VIEW_BOX_NUMBERS], eight corners, bit d of a corner's place
 * set where it is the higher along axis d, each carried as the nearest leaf below the node is; then
 * the level. */
enum { VIEW_BOX_NUMBERS = 25 };
const float *view_boxes(int side);

/* The surface of all bodies at rest, each in its pose, vertex by vertex as view_points() and
 * view_normals() have it. view_rest_points() finds both. O(vertices). */
const float *view_rest_points(int side);
const float *view_rest_normals(int side);

/* How far each vertex of this side's surface is from the same vertex of the other's, in finest
 * cells, [vertices]; both surfaces as they were last found (view_surface()). NULL where vertices do
 * not correspond, and then view_not_comparable() says why; else that is "". O(vertices). */
const float *view_difference(int side);
const char *view_not_comparable(void);

#endif
