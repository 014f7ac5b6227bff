/* contacts.h - collisions of FastLSM bodies (lib/collide/collide.h): before a step finds the
 * contacts, after it answers them. */
#ifndef LSM_CONTACTS_H
#define LSM_CONTACTS_H

#include "state.h"

#define LsmContacts         SM_NAME(LsmContacts)
#define lsm_contacts_build  SM_NAME(lsm_contacts_build)
#define lsm_contacts_free   SM_NAME(lsm_contacts_free)
#define lsm_contacts_list   SM_NAME(lsm_contacts_list)
#define lsm_contacts_before SM_NAME(lsm_contacts_before)
#define lsm_contacts_after  SM_NAME(lsm_contacts_after)
#define lsm_contacts_fix    SM_NAME(lsm_contacts_fix)
#define lsm_contacts_count  SM_NAME(lsm_contacts_count)

typedef struct LsmContacts LsmContacts;

/* Of a body, or of instances, which must outlive it; `rounding` as of bodies at rest. NULL where
 * nothing is to collide. */
LsmContacts *lsm_contacts_build(Lsm *lsm, real rounding);
void lsm_contacts_free(LsmContacts *contacts);

/* Contacts of the present positions, numbered as the lattice counts; the caller frees. */
long lsm_contacts_list(LsmContacts *contacts, SmContact **contact);

/* Around a step. Links that broke since the last one make the body's description anew. */
void lsm_contacts_before(LsmContacts *contacts);
void lsm_contacts_after(LsmContacts *contacts, Momentum *momentum);

/* Particles that nothing moves: particle p, as the lattice counts, of body b is b * particles + p.
 */
void lsm_contacts_fix(LsmContacts *contacts, long count, const long *particle);

long lsm_contacts_count(const LsmContacts *contacts);

#endif
