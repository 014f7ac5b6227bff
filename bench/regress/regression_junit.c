#include <math.h>
#include <string.h>

#include "../store/export.h"
#include "regression.h"

/* What the verdict is to JUnit; NULL: passed. */
static const char *element(BenchComparisonVerdict verdict)
{
    if (verdict == BENCH_SLOWER) return "failure";
    if (verdict == BENCH_INCORRECT) return "error";
    return verdict == BENCH_SAME || verdict == BENCH_FASTER ? NULL : "skipped";
}

static void write_case(FILE *file, const BenchComparison *one)
{
    char line[320];
    const char *name = element(one->verdict);
    double seconds = isfinite(one->ms[BENCH_NEW]) ? 1e-3 * one->ms[BENCH_NEW] : 0;
    if (one->reason[0])
        snprintf(line, sizeof line, "%s", one->reason);
    else
        snprintf(line, sizeof line,
                 "%s: %.4f times (%.4f to %.4f), threshold %.1f%%, p %.3g adjusted",
                 bench_comparison_name(one->verdict), one->ratio, one->low, one->high,
                 100 * one->threshold, one->adjusted);
    fputs("    <testcase classname=\"", file);
    bench_xml_text(file, one->contest->scene);
    fprintf(file, "\" name=\"%s\" time=\"%.9f\">\n", bench_time_name(one->time), seconds);
    fprintf(file, name ? "      <%s message=\"" : "      <system-out>", name);
    bench_xml_text(file, line);
    fputs(name ? "\"/>\n" : "</system-out>\n", file);
    fputs("    </testcase>\n", file);
}

void bench_regression_junit(FILE *file, const BenchRegression *found)
{
    int failures = 0, errors = 0, skipped = 0;
    char line[512];
    for (int i = 0; i < found->count; i++) {
        const char *name = element(found->list[i].verdict);
        failures += name && name[0] == 'f';
        errors += name && name[0] == 'e';
        skipped += name && name[0] == 's';
    }
    bench_regression_summary(found, sizeof line, line);
    fputs(
        "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<testsuites>\n  <testsuite name=\"shapebench "
        "regress against ",
        file);
    bench_xml_text(file, found->baseline);
    fprintf(file, "\" tests=\"%d\" failures=\"%d\" errors=\"%d\" skipped=\"%d\" time=\"%.3f\">\n",
            found->count, failures, errors, skipped, found->seconds);
    for (int i = 0; i < found->count; i++) write_case(file, &found->list[i]);
    fputs("    <system-out>", file);
    bench_xml_text(file, line);
    for (int i = 0; i < found->remarks; i++) {
        fputc('\n', file);
        bench_xml_text(file, found->remark[i]);
    }
    fputs("</system-out>\n  </testsuite>\n</testsuites>\n", file);
}
