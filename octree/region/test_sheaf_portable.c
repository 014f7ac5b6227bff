/* What several leaves own, as found on processors without AVX-512. */
#define OCT_PORTABLE
#include "sheaf.c"
#include "test_sheaf.c"
