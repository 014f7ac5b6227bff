#include "calibration_table.h"

#include <math.h>
#include <string.h>

#include "../engines.h"
#include "../store/export.h"
#include "../table/grid.h"

enum { REASONS = 8 };

static void young(double value, char text[BENCH_GRID_TEXT])
{
    if (isfinite(value))
        snprintf(text, BENCH_GRID_TEXT, "%.3e", value);
    else
        strcpy(text, "-");
}

static void number(const char *format, double value, char text[BENCH_GRID_TEXT])
{
    if (isnan(value))
        strcpy(text, "-");
    else
        snprintf(text, BENCH_GRID_TEXT, format, value);
}

static void add_columns(BenchGrid *grid)
{
    static const char *const heading[] = {
        "engine",  "w",      "epsilon", "spacing",     "h ms",       "aspect",
        "regions", "E Pa",   "by sag",  "by f1",       "by f2",      "by f3",
        "apart %", "theory", "f1 Hz",   "loss factor", "linear to %"};
    for (size_t c = 0; c < sizeof heading / sizeof heading[0]; c++)
        bench_grid_column(grid, heading[c], c == 0 || c == 6);
}

/* E by the reference; `theory`: Timoshenko's beam by the sag. */
static void add_line(BenchGrid *grid, bool meshless, const BenchSpecimen *s)
{
    const double *by = meshless ? s->young_meshless : s->young_timoshenko;
    BenchGridLine *line = bench_grid_add(grid);
    int c = 0;
    strcpy((*line)[c++], s->engine);
    snprintf((*line)[c++], BENCH_GRID_TEXT, "%d", s->w);
    number("%g", bench_engine(s->engine)->sampled ? s->epsilon : NAN, (*line)[c++]);
    number("%.4g", s->spacing, (*line)[c++]);
    number("%.4g", 1e3 * s->h, (*line)[c++]);
    number("%g", s->aspect, (*line)[c++]);
    strcpy((*line)[c++], s->wide ? "wide" : "narrow");
    if (s->valid)
        young(s->young, (*line)[c++]);
    else
        strcpy((*line)[c++], "INVALID");
    for (int i = 0; i < BENCH_YOUNGS; i++) young(by[i], (*line)[c++]);
    number("%.1f", 100 * s->spread, (*line)[c++]);
    young(s->young_timoshenko[0], (*line)[c++]);
    bench_grid_number(s->frequency[0], (*line)[c++]);
    number("%.0e", s->loss[0], (*line)[c++]);
    number("%g", 100 * s->linear_to, (*line)[c]);
}

static void estimate(const double value[3], char text[BENCH_GRID_TEXT])
{
    if (isnan(value[0]))
        strcpy(text, "-");
    else
        snprintf(text, BENCH_GRID_TEXT, "%.4g (%.4g to %.4g)", value[0], value[1], value[2]);
}

static BenchGrid law_grid(const BenchCalibration *calibration)
{
    static const char *const heading[] = {"engine", "law",      "specimens", "c", "spacing^p",
                                          "w^q",    "aspect^s", "1/h^r",     "d", "off by %"};
    BenchGrid grid = {0};
    for (size_t c = 0; c < sizeof heading / sizeof heading[0]; c++)
        bench_grid_column(&grid, heading[c], c < 2);
    for (int i = 0; i < calibration->laws; i++) {
        const BenchLaw *law = &calibration->law[i];
        BenchGridLine *line = bench_grid_add(&grid);
        strcpy((*line)[0], law->engine);
        strcpy((*line)[1], law->kind);
        snprintf((*line)[2], BENCH_GRID_TEXT, "%d", law->specimens);
        estimate(law->c, (*line)[3]);
        estimate(law->spacing, (*line)[4]);
        estimate(law->width, (*line)[5]);
        estimate(law->aspect, (*line)[6]);
        estimate(law->step, (*line)[7]);
        estimate(law->d, (*line)[8]);
        number("%.2g", 100 * law->scatter, (*line)[9]);
    }
    return grid;
}

static void write_reasons(FILE *file, const BenchCalibration *calibration)
{
    int said = 0;
    for (long i = 0; i < calibration->count && said < REASONS; i++) {
        const BenchSpecimen *s = &calibration->specimen[i];
        if (s->valid) continue;
        fprintf(file, "  %s w %d epsilon %g is INVALID: %s\n", s->engine, s->w, s->epsilon,
                s->reason);
        said++;
    }
}

static void write_text(FILE *file, const BenchCalibration *calibration, const BenchGrid *grid,
                       const BenchGrid *laws)
{
    const BenchCalibrationPlan *plan = &calibration->plan;
    fprintf(file,
            "%s: Young's modulus at %g kg/m^3 of the elastic beam that behaves alike, %ld of %d "
            "specimens.\n%g thick, %d times as long, %d cells through; damping %g; Poisson's ratio "
            "taken as %g.\n\n",
            plan->scene, plan->density, calibration->count, plan->specimens, plan->thickness,
            plan->aspect, plan->across, plan->damping, plan->poisson);
    bench_grid_whole(file, grid, BENCH_GRID_PLAIN);
    fprintf(
        file,
        "\nE: geometric mean of what the static sag and the first natural frequency of a clamped "
        "beam say, by the %s. by sag, by f1..f3: each alone; apart: the largest over the least.\n"
        "theory: by the sag, of Timoshenko's beam. regions: wide where 2 w + 1 particles are more "
        "than the beam is thick. loss factor: logarithmic decrement of the first mode / pi.\n"
        "linear to: largest of sags of 5, 10, 20, 40%% of the length in proportion to the load "
        "within 5%%; looked for at some.\n",
        plan->meshless ? "meshless reference"
                       : "theory of Timoshenko's beam (no meshless reference: built without its "
                         "libraries)");
    if (laws->lines) {
        fputs("\nLaws. narrow, wide: E = c rho spacing^p w^q aspect^s / h^r; two-term: E = rho "
              "(spacing/h)^2 "
              "w(w+1) (c + d w(w+1) (spacing/thickness)^2); with 95% confidence intervals.\n\n",
              file);
        bench_grid_whole(file, laws, BENCH_GRID_PLAIN);
    }
    fputc('\n', file);
    for (int i = 0; i < BENCH_FOUND; i++)
        if (calibration->found[i][0]) fprintf(file, "%s\n", calibration->found[i]);
    write_reasons(file, calibration);
}

static void write_csv(FILE *file, const BenchCalibration *calibration)
{
    int count;
    const BenchField *fields = bench_specimen_fields(&count);
    bench_csv_records(file, fields, count, calibration->specimen, sizeof *calibration->specimen,
                      calibration->count, NULL);
}

static void write_json(FILE *file, const BenchCalibration *calibration)
{
    int count;
    json_t *root = json_object(), *found = json_array();
    const BenchField *fields = bench_specimen_fields(&count);
    json_object_set_new(root, "specimens",
                        bench_json_records(fields, count, calibration->specimen,
                                           sizeof *calibration->specimen, calibration->count));
    fields = bench_law_fields(&count);
    json_object_set_new(root, "laws",
                        bench_json_records(fields, count, calibration->law,
                                           sizeof *calibration->law, calibration->laws));
    for (int i = 0; i < BENCH_FOUND; i++)
        json_array_append_new(found, bench_json_text(calibration->found[i]));
    fields = bench_calibration_fields(&count);
    json_object_set_new(root, "found", found);
    json_object_set_new(root, "plan", bench_json_record(fields, count, &calibration->plan));
    json_object_set_new(root, "environment", bench_json_machine(&calibration->machine));
    bench_json_write(file, root);
}

void bench_calibration_table(FILE *file, BenchFormat format, const BenchCalibration *calibration)
{
    if (format == BENCH_AS_CSV || format == BENCH_AS_JSON) {
        (format == BENCH_AS_CSV ? write_csv : write_json)(file, calibration);
        return;
    }
    BenchGrid grid = {0}, laws = law_grid(calibration);
    add_columns(&grid);
    for (long i = 0; i < calibration->count; i++)
        add_line(&grid, calibration->plan.meshless, &calibration->specimen[i]);
    if (format == BENCH_AS_TEXT) {
        write_text(file, calibration, &grid, &laws);
    } else {
        bench_grid_whole(file, &grid, bench_format_form(format));
        fputc('\n', file);
        if (laws.lines) bench_grid_whole(file, &laws, bench_format_form(format));
    }
    bench_grid_free(&grid);
    bench_grid_free(&laws);
}
