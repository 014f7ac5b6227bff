/* contacts.h - collisions of octree bodies (lib/collide/collide.h): before a step finds the
 * contacts, after it answers them. */
#ifndef OCT_CONTACTS_H
#define OCT_CONTACTS_H

#include "change/structure.h"
#include "state.h"

#define OctContacts          SM_NAME(OctContacts)
#define oct_contacts_build   SM_NAME(oct_contacts_build)
#define oct_contacts_rebuild SM_NAME(oct_contacts_rebuild)
#define oct_contacts_free    SM_NAME(oct_contacts_free)
#define oct_contacts_list    SM_NAME(oct_contacts_list)
#define oct_contacts_before  SM_NAME(oct_contacts_before)
#define oct_contacts_after   SM_NAME(oct_contacts_after)
#define oct_contacts_fix     SM_NAME(oct_contacts_fix)
#define oct_contacts_count   SM_NAME(oct_contacts_count)

typedef struct OctContacts OctContacts;

/* Of all instances of `oct`, which must outlive it; the structure is only read. NULL where nothing
 * is to collide. */
OctContacts *oct_contacts_build(Oct *oct, const OctStructure *structure,
                                const SmCollideParams *params);
void oct_contacts_free(OctContacts *contacts);

/* The structure has changed, and `oct` with it. What was fixed is fixed no more. O(leaves): the
 * description is made anew, about 0.7 us a leaf; the next steps search between nodes and the cells
 * across a cut that they touch, each pair once. */
void oct_contacts_rebuild(OctContacts *contacts, const OctStructure *structure);

/* Contacts of the present positions, of finest cells this long, and the rotations of all nodes'
 * cells: `turn` is [instances * nodes][9], or NULL. The caller frees. */
long oct_contacts_list(OctContacts *contacts, double cell, double (*turn)[9], SmContact **contact);

/* Around a step. */
void oct_contacts_before(OctContacts *contacts);
void oct_contacts_after(OctContacts *contacts, Momentum *momentum);

/* Nodes that nothing moves: node p of instance b is b * nodes + p (outline.h). */
void oct_contacts_fix(OctContacts *contacts, long count, const long *node);

long oct_contacts_count(const OctContacts *contacts);

#endif
