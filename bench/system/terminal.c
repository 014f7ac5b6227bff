#include "terminal.h"

#include <stdlib.h>
#include <string.h>
#include <unistd.h>

bool bench_colours(FILE *file)
{
    const char *unwanted = getenv("NO_COLOR"), *type = getenv("TERM");
    return !(unwanted && *unwanted) && type && strcmp(type, "dumb") != 0 && isatty(fileno(file));
}
