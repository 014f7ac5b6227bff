/* warp.h - large turns of a shell: where its nodes are when its parameters' displacements are u.
 *
 * Strains are linear in u (thin.h), and so are turns: at every sample
 *     u,k = w x a_k + e_k,  w = a3 x da3 + ((a^k x u,k) . a3 / 2) a3,  e_k in the tangent plane
 * What the surface is to have there are the tangents exp(w) (a_k + e_k), and it is put where its
 * own come closest to them: least squares over the samples, a solve with one factorised matrix of
 * [nodes]^2, the surface's Laplacian (rotation and strain in place of displacements: Huang, Tong,
 * Zhou, Bao and Desbrun 2011). Small displacements and rigid motions of any size are exact, of
 * a shell that breaks to 1e-5: its nodes are tied a little to u, because between cracks some hang
 * on the others by next to no slope. And where bending strains nothing, lengths stay, whatever it
 * has turned by: modal warping at the nodes (motion.h) shortens a strip that is bent by 90 degrees
 * by an eighth. */
#ifndef REF_WARP_H
#define REF_WARP_H

#include "../../../lib/pieces.h"
#include "../motion/frame_sums.h"
#include "../solve/solver.h"
#include "shell.h"

enum { REF_WARP_PLACES = REF_FRAME_SLOPES / 2 }; /* of a cell */

/* The surface in rest at a place. */
typedef struct {
    double tangent[2][3], normal[3];
    double across[2][3]; /* a3 x a^k */
    double area;         /* that it stands for */
    double metric[3];    /* area times g^kl */
} RefWarpPlace;

/* How it has turned: with tangents exp(w) s_k, s_k = a_k + e_k. */
typedef struct {
    double w[3], R[9], tangent[2][3];
} RefWarpTurn;

typedef struct {
    long nodes, cells;
    long *start;                       /* [cells + 1] */
    int *node;                         /* [start[cells]] those that cover a cell's places */
    double (*slope)[REF_FRAME_SLOPES]; /* [start[cells]] phi,k of its place p at 2 p + k */
    RefWarpPlace *place;               /* [4 cells] */
    long *near;                        /* [nodes + 1] what covers the nodes themselves, */
    int *other;                        /* [near[nodes]] */
    double (*lean)[2];                 /* [near[nodes]] and phi,k there */
    RefMatrices laplacian;             /* of the nodes; its stiffness alone */
    double (*X)[3], (*rest_normal)[3]; /* [nodes] normals as without cracks, */
    double (*tilt)[3]; /* [nodes] in a frame whose first axis is along a_1 and third the normal */
    double *mass;      /* [nodes] their shares of 1, of each piece */
    long pieces;       /* of what hangs together: one but for cracks */
    int *piece;        /* [nodes] */
    bool *held;        /* [pieces] by rows */
    bool cut;          /* there are cracks */

    RefRows rows; /* of the nodes: what holds; the mean of a piece that is not held moves as of u */
    RefSolver *solver;
    double (*target)[3]; /* [rows] by how much these move: the caller's */

    double (*moved)[3];  /* [nodes] displacements */
    double (*turned)[3]; /* [nodes] normals, less those at rest */
    double (*pulled)[3]; /* [nodes] what forces do to parameters, from their potential's slope */
    double (*right)[3];  /* [nodes] of the solve */
    double (*answer)[3]; /* [nodes] what answers to the forces at the nodes: its slopes */
    double (*tug)[2][3]; /* [4 cells] pull at tangents, raised; */
    double (*drawn)[3];  /* [nodes] and the rest of them, whatever the pose */
    RefWarpTurn *turn;   /* [4 cells] */
    double (*sum)[REF_FRAME_SLOPES]; /* [nodes] */
    double *column[2];               /* [3][nodes] */
    double *bound;                   /* [3][rows] */
    double (*all)[3];                /* [pieces] */
} RefWarp;

/* The parameters of a cell's place number p: the middles of its quarters. */
void ref_warp_place_at(const double middle[2], const double edge[2], int p, double theta[3]);

/* Of a shell at rest that nothing holds. The caller frees. Errors, and nothing to free: solver.h's.
 */
SmCode ref_warp_create(const RefShell *shell, RefWarp *warp, SmError *error);
void ref_warp_free(RefWarp *warp);

/* Holds it by these rows of the nodes, copied; none: frees it. Targets are zero then. One
 * factorisation. Errors, and what held goes on to: solver.h's. */
SmCode ref_warp_hold(RefWarp *warp, const RefRows *rows, SmError *error);

/* The Laplacian under these rows, which hold nothing yet; the caller's to destroy. Errors:
 * solver.h's. */
SmCode ref_warp_solver(const RefWarp *warp, const RefRows *rows, RefSolver **solver,
                       SmError *error);

/* int share g^kl phi_I,k phi_J,l over the places, [4 cells] shares or NULL: 1; of pairs that have
 * mass together, as integration points are there, too. The caller frees L's arrays. */
void ref_warp_laplacian(const RefWarp *warp, const RefSparse *mass, const double *share,
                        RefSparse *L);

/* Forces at the nodes, [nodes][3], whose work `pulled` is the slope of from the next pose on. Three
 * solves. */
void ref_warp_pull(RefWarp *warp, const double (*force)[3]);

/* Adds to a field, [nodes][3], of every piece that is not held the constant that makes its mean
 * that of another one. */
void ref_warp_match(RefWarp *warp, const double (*model)[3], double (*field)[3]);

/* moved, turned and pulled from u, [nodes][3]. O(cells * covers), and three solves. */
void ref_warp_pose(RefWarp *warp, const double (*u)[3]);

/* Of a field on the nodes, [nodes]: area g^kl times its slopes at the places, [4 cells][2]. */
void ref_warp_flux(const RefWarp *warp, const double *reach, double (*flux)[2]);

/* What a flux along an axis that pulls at the tangents does to the parameters, as they were posed
 * last: [nodes][3]. */
void ref_warp_slope(RefWarp *warp, const double (*flux)[2], int axis, double (*force)[3]);

/* The turn w that u, [nodes][3], has on average over the places of a cell. */
void ref_warp_turn(const RefWarp *warp, long cell, const double (*u)[3], double w[3]);

#endif
