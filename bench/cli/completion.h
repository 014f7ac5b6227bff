/* completion.h - what may come next on a command line, for the shells that ask
 * (scripts/completions/): commands, options, their values, arguments, all from the commands' tables
 * of settings. */
#ifndef BENCH_COMPLETION_H
#define BENCH_COMPLETION_H

#include <stdio.h>

#include "command.h"

/* Prints what the last of the words behind the program's name can be: lines of a word, a tab and
 * what it is. A line that begins with the tab says that files are good, too; what follows is the
 * ending of their names, or nothing. Words that make no sense have no lines. `commands` ends with
 * NULL. */
void bench_complete(FILE *file, const BenchCommand *const *commands, int words, char **word);

#endif
