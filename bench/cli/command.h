/* command.h - the program's commands. Each parses its own options and returns the exit code. */
#ifndef BENCH_COMMAND_H
#define BENCH_COMMAND_H

/* Exit codes as every command's help prints them; error.h has them as SmCode. */
#define BENCH_EXIT_CODES                                                                           \
    "Exit codes: 0 done; 1 a correctness check failed (INVALID); 2 unknown option or value out "   \
    "of range; 3 a mesh, scene or result file cannot be used; 4 a file cannot be written; "        \
    "70 out of memory; 128 + N ended by signal N (Ctrl-C: 130)."

typedef struct {
    const char *name;
    const char *summary;               /* one line for the program's help */
    int (*run)(int argc, char **argv); /* argv[0] is "shapebench NAME" */
} BenchCommand;

int bench_command_scenes(int argc, char **argv);
int bench_command_info(int argc, char **argv);
int bench_command_run(int argc, char **argv);
int bench_command_tables(int argc, char **argv);
int bench_command_regress(int argc, char **argv);
int bench_command_kernels(int argc, char **argv);
int bench_command_report(int argc, char **argv);
int bench_command_sweep(int argc, char **argv);
int bench_command_calibrate(int argc, char **argv);
int bench_command_merge(int argc, char **argv);
int bench_command_claims(int argc, char **argv);

#endif
