/* claim_store.h - findings in HDF5, with all that was measured for them. Schema: results/README.md.
 */
#ifndef BENCH_CLAIM_STORE_H
#define BENCH_CLAIM_STORE_H

#include "../store/h5.h"
#include "verdict.h"

/* The layout written; raised with every change that a reader must know of. */
enum { BENCH_CLAIM_SCHEMA = 2 };

/* A finding as it is stored, exported and shown. Its tables for people are those of the claims'
 * kinds, by BenchClaimKind. */
extern const BenchField bench_claim_fields[];
extern const int bench_claim_field_count;

/* Where the lab's curve is in the file: its row's group if it is a row's, else its own. */
void bench_claim_place(const BenchLab *lab, int curve, size_t size, char *place);

/* Writes the findings, and of the lab every row and every curve that is no row's. */
void bench_claim_write(BenchH5 *h5, const BenchFinding *findings, int count, const BenchLab *lab);

/* Reads all curves back, into a lab that begins zeroed; the caller frees it. */
void bench_claim_read_curves(BenchH5 *h5, BenchLab *lab);

#endif
