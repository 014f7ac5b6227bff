/* elastic_check.h - is the meshless body right that is timed? In double precision, on its very
 * matrices, modes and state, by what must hold whichever way they were computed. */
#ifndef BENCH_ELASTIC_CHECK_H
#define BENCH_ELASTIC_CHECK_H

#include "../measure/elastic.h"
#include "elastic_found.h"

/* What stays while it moves: the first nine findings. O(modes^2 nodes), and one factorisation.
 * SM_INPUT: the matrices cannot be factorised. */
SmCode bench_elastic_check_body(const BenchElastic *elastic, BenchElasticFound *found,
                                SmError *error);

/* The others, of the present state, which is as it was afterwards. */
void bench_elastic_check_state(BenchElastic *elastic, BenchElasticFound *found);

#endif
