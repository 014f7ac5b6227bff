/* body.h - a scene's body: its mesh, lattice, masses and where its instances stand. */
#ifndef BENCH_BODY_H
#define BENCH_BODY_H

#include "../../reference/meshless/surface/mpu.h"
#include "scene.h"

typedef struct BenchBody {
    SmMesh mesh;
    const RefMpu *given; /* of points whose surface the mesh is, the caller's; NULL: a mesh alone */
    bool of_points;      /* its triangles are those between points, which are its vertices */
    const RefStored *stored; /* what the meshless engine takes in place of the mesh, the caller's */
    SmVoxels voxels;
    double low[3], high[3]; /* the mesh's bounding box */
    double (*x0)[3];        /* [voxels.particle_count] rest positions, instance pose not applied */
    double *mass;           /* [voxels.particle_count] kg; NULL: 1 each */
    const SmCut *cut;       /* what has cut a lattice that breaks in no other way, the caller's; or
                               NULL */
    long instances;
    double (*pose)[3][4];    /* [instances] rest to initial position: translations */
    double voxelise_seconds; /* wall clock */
    unsigned long long hash; /* FNV-1a of the mesh's coordinates and indices */
} BenchBody;

/* Reads a mesh: "shape:NAME" or a mesh file. A remark says what the file has that is left out. */
SmCode bench_mesh_load(const char *mesh, SmMesh *result, SmError *error);

/* Reads points from text (x y z nx ny nz) or a mesh file without faces, into `points`; from
 * anything else a mesh, as bench_mesh_load(), into `mesh`. The other one is zeroed, so that both
 * can be freed. Errors: those of reading either. */
SmCode bench_points_or_mesh(const char *path, RefPoints *points, SmMesh *mesh, SmError *error);

/* Reads a shell's mesh: as bench_mesh_load(), or of such a file of points, with normals or
 * without, that of the triangles between them, and sets `of_points`. */
SmCode bench_sheet_load(const char *path, SmMesh *mesh, bool *of_points, SmError *error);

/* Reads the scene's mesh; or, unless NULL, the mesh file `substitute` in its place: scaled evenly
 * to the same largest extent, standing on the same height, centred on the same vertical axis, so
 * that the scene's handles, obstacles and forces fit it. */
SmCode bench_mesh_of_scene(const BenchScene *scene, const char *substitute, SmMesh *result,
                           SmError *error);

/* The name of a mesh alone: its file's, without the folder. */
void bench_mesh_name(const char *path, char name[BENCH_NAME]);

/* The scene that `shapebench run MESH` uses for a mesh alone: solid, about 2,000 particles (fewer
 * where so many take too large a lattice), w 2,
 * dropped from half its height onto a ground plane. Mesh units are unknown, so gravity is 9.81
 * body heights per second squared: a body 70 units tall falls as one of 1 m does. */
void bench_scene_drop(const SmMesh *mesh, const char *path, BenchScene *scene);

/* Makes it the octree's: a finer lattice, of 35,000 particles, epsilon 0.5; the rest is the
 * octree's own defaults. */
void bench_scene_sample(const SmMesh *mesh, BenchScene *scene);

/* Makes it one of the meshless engines': held at its lowest tenth, a mesh that lies flat at one
 * end; gravity as before, no ground; the mesh is taken to be 1 m high, or as long. A shell's needs
 * no inside. */
void bench_scene_hold(const SmMesh *mesh, BenchScene *scene);
void bench_scene_hold_shell(const SmMesh *mesh, BenchScene *scene);

/* Voxelises, and fills in the rest. Takes `mesh` over, also when it fails. Errors as sm_voxelise(),
 * and SM_MEMORY when the scene's engine would not fit (memory.h). */
SmCode bench_body_create(const BenchScene *scene, SmMesh *mesh, BenchBody *body, SmError *error);

/* The same of bench_mesh_of_scene(). When it fails the body is zeroed. */
SmCode bench_body_of_scene(const BenchScene *scene, const char *substitute, BenchBody *body,
                           SmError *error);
void bench_body_free(BenchBody *body);

/* Largest extent of the body at rest. */
double bench_body_size(const BenchBody *body);

#endif
