/* Claims files: any bytes are claims or one error line. */
#include <assert.h>
#include <stdint.h>
#include <string.h>

#include "claim.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    BenchClaims claims = {0};
    SmError error = {0};
    SmCode code = bench_claims_parse((const char *)data, size, "fuzz.cfg", &claims, &error);
    assert(code == SM_OK || (code == SM_INPUT && claims.count == 0));
    assert(code == SM_OK || (error.text[0] && !strchr(error.text, '\n')));
    bench_claims_free(&claims);
    return 0;
}
