/* carrier.h - what carries surfaces and how it is changed, of each kind of engine. */
#ifndef BENCH_CARRIER_H
#define BENCH_CARRIER_H

#include "body_group.h"

extern const BenchCarrier bench_octree_carrier, bench_lattice_carrier;

#endif
