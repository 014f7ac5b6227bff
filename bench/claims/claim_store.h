/* claim_store.h - findings in HDF5, with all that was measured for them. Schema: results/README.md.
 */
#ifndef BENCH_CLAIM_STORE_H
#define BENCH_CLAIM_STORE_H

#include "../store/h5.h"
#include "verdict.h"

/* The layout written; raised with every change that a reader must know of. */
enum { BENCH_CLAIM_SCHEMA = 2 };

/* A finding as it is stored, exported and shown. What the members are is said in claim_store.c. */
typedef struct {
    const BenchFinding *finding;
    char paper[24], name[BENCH_CLAIM_NAME], place[32], unit[32], statement[240], note[200];
    char status[16], take[16], test[96], expect[16], because[320], verdict[16], words[560];
    char evidence[208], over[208], kind[20], unset_evidence[208];
    int values, count, trend;
    double tolerance, ratio[3], unset;
    double paper_value[BENCH_CLAIM_VALUES], measured[BENCH_CLAIM_VALUES];
    double low[BENCH_CLAIM_VALUES], high[BENCH_CLAIM_VALUES];
} BenchClaimRecord;

/* Its tables for people are those of the claims' kinds, by BenchClaimKind. */
extern const BenchField bench_claim_fields[];
extern const int bench_claim_field_count;

/* Records of the findings, which the caller frees. */
BenchClaimRecord *bench_claim_records(const BenchFinding *findings, int count);

/* Where the lab's curve is in the file: its row's group if it is a row's, else its own. */
void bench_claim_place(const BenchLab *lab, int curve, size_t size, char *place);

/* Writes the findings, and of the lab every row and every curve that is no row's. */
void bench_claim_write(BenchH5 *h5, const BenchFinding *findings, int count, const BenchLab *lab);

/* Reads all curves back, into a lab that begins zeroed; the caller frees it. */
void bench_claim_read_curves(BenchH5 *h5, BenchLab *lab);

#endif
