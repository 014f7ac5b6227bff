/* What several leaves own, as found on processors without AVX-512. */
#define OCT_PORTABLE
#include "multi_source_search.c"
#include "test_multi_source_search.c"
