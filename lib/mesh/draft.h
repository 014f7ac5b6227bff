/* draft.h - a mesh while it is read from bytes, and the readers of each format.
 *
 * Numbers are binary or words of text, in which blanks and tabulators divide words, and LF, CRLF or
 * CR ends a line. Numbers in text are decimal with a point in every locale, and correctly rounded.
 * Functions that return bool return false after they have written the line of error; those that are
 * said to ask return false without one. Polygons are cut when all vertices are known: formats may
 * name vertices that come later. */
#ifndef SM_DRAFT_H
#define SM_DRAFT_H

#include <locale.h>

#include "reader.h"

/* Ends messages about files that another program must have damaged. */
#define SM_AGAIN "; is it damaged or cut off? Export it again"

#define SM_NO_MESH "not a mesh file that can be read; save it as OBJ, PLY, STL, OFF or glTF"

/* Says what to do with points without triangles. */
#define SM_POINTS_GO                                                                               \
    "'run --engine meshless' takes points with normals (PLY, .xyz, .pts, .txt), 'run --engine "    \
    "shell' also without"

typedef struct {
    const SmMeshFile *file;
    SmError *error;
    bool of_points;               /* keep points and their normals; the mesh is not wanted */
    const char *begin, *at, *end; /* bytes, without compression and byte order mark; `at`: next */
    long line;                    /* of text, that `at` is in, from 1; 0: places are bytes */
    bool big;                     /* order of bytes */
    char comment;                 /* begins what is skipped up to the line's end; 0: nothing does */
    bool joined;                  /* a backslash at a line's end joins it with the next one */
    bool commas;                  /* commas and semicolons divide words, too */
    locale_t locale;              /* "C" */
    double most; /* triangles, and a third of the vertices: a small file that uses its parts again
                  * and again would take minutes and all memory */
    SmMesh mesh;
    double (*normal)[3]; /* of points, or NULL */
    SmMeshLeftOut left_out;
    int *corner; /* of the face that is read */
    long corners, corner_room, vertex_room, triangle_room;
    long (*polygon)[2]; /* first of its triangles, which hold its corners; how many corners */
    long polygons, polygon_room;
    long largest, largest_at; /* vertex that a face names, and the face's line or byte */
} SmDraft;

/* Writes "FILE: line N: " or "FILE: byte N: ", or "FILE: " alone where `at` is NULL, and the
 * message. Returns false. */
bool sm_draft_fail(SmDraft *draft, const char *format, ...) __attribute__((format(printf, 2, 3)));

/* Writes the place, the word at `at` in quotes, and what it is not. Returns false. */
bool sm_draft_fail_word(SmDraft *draft, const char *what);

/* ---- text */

/* Leaves out the zero bytes that some programs fill a text file up with. */
void sm_draft_trim(SmDraft *draft);

/* Finds the next word of this line. Asks. */
bool sm_draft_word(SmDraft *draft);

/* Goes to the next line. Asks: false at the end of the text. */
bool sm_draft_line(SmDraft *draft);

/* Finds the next word of this line or a later one. Asks. */
bool sm_draft_find(SmDraft *draft);

/* Takes the word at `at` if it is `word`; `any_case`: which is in lower case, in any. Asks. */
bool sm_draft_take(SmDraft *draft, const char *word, bool any_case);

/* Length of the word at `at`. */
int sm_draft_length(const SmDraft *draft);

/* Passes over at most `count` words of this line. */
void sm_draft_skip(SmDraft *draft, long count);

/* Reads the word at `at` as a number, which may be nan or inf, and is where it is too large. */
bool sm_draft_decimal(SmDraft *draft, double *value);

/* ---- text or binary */

/* In the order of PLY's names and of glTF's componentType. */
typedef enum { SM_I8, SM_U8, SM_I16, SM_U16, SM_I32, SM_U32, SM_F32, SM_F64 } SmNumberType;

int sm_number_size(SmNumberType type);

/* Returns the binary number at `at`, which need not be aligned. */
double sm_number_at(const void *at, SmNumberType type, bool big);

/* Reads the next `count` numbers: of `type`, or in text words on this line or later ones. */
bool sm_draft_numbers(SmDraft *draft, SmNumberType type, int count, double *value);

/* Reads how many things of at least `bytes` each follow. */
bool sm_draft_count(SmDraft *draft, SmNumberType type, int bytes, long *count);

/* ---- the mesh */

/* Makes room for as many more, once their number is known; others may follow. */
void sm_draft_reserve(SmDraft *draft, long vertices, long triangles);

/* Adds a vertex; `normal` may be NULL. */
bool sm_draft_vertex(SmDraft *draft, const double position[3], const double normal[3]);

/* Adds a corner, a vertex's number from 0, to the face that is read. */
bool sm_draft_corner(SmDraft *draft, double vertex);

/* Ends the face; one of one or two corners is left out. */
bool sm_draft_face(SmDraft *draft);

/* Checks the numbers of faces' vertices and cuts polygons. */
bool sm_draft_finish(SmDraft *draft);

/* ---- formats */

/* Reads as sm_mesh_read() does, by this reader, not by that of the name's suffix. */
SmCode sm_mesh_read_by(const SmMeshFile *file, bool (*read)(SmDraft *), SmMesh *mesh,
                       SmMeshLeftOut *left_out, SmError *error);

bool sm_read_obj(SmDraft *draft);
bool sm_read_ply(SmDraft *draft);
bool sm_read_stl(SmDraft *draft);
bool sm_read_off(SmDraft *draft);
bool sm_read_gltf(SmDraft *draft);
bool sm_read_rows(SmDraft *draft); /* points, one a line */

#endif
