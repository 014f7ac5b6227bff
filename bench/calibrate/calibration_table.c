#include "calibration_table.h"

#include "../campaign/export.h"
#include "../table/records.h"

enum { REASONS = 8 };

static void write_reasons(FILE *file, const BenchCampaign *calibration)
{
    int said = 0;
    for (long i = 0; i < calibration->count && said < REASONS; i++) {
        const BenchSpecimen *s = bench_campaign_at(calibration, i);
        if (s->valid) continue;
        fprintf(file, "  %s w %d epsilon %g is INVALID: %s\n", s->engine, s->w, s->epsilon,
                s->reason);
        said++;
    }
}

static void write_text(FILE *file, const BenchCampaign *calibration,
                       const BenchConclusion *conclusion, const BenchGrid *grid,
                       const BenchGrid *laws)
{
    const BenchCalibrationPlan *plan = calibration->plan;
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
        if (conclusion->found[i][0]) fprintf(file, "%s\n", conclusion->found[i]);
    write_reasons(file, calibration);
}

static json_t *json_conclusion(const BenchConclusion *conclusion)
{
    json_t *object = json_object(), *found = json_array();
    json_object_set_new(object, "laws",
                        bench_json_records(bench_stiffness_fit_fields,
                                           bench_stiffness_fit_field_count, conclusion->law,
                                           sizeof *conclusion->law, conclusion->laws));
    for (int i = 0; i < BENCH_FOUND; i++)
        json_array_append_new(found, bench_json_text(conclusion->found[i]));
    json_object_set_new(object, "found", found);
    return object;
}

void bench_calibration_table(FILE *file, BenchFormat format, const BenchCampaign *calibration)
{
    BenchConclusion conclusion = bench_calibration_conclude(calibration);
    if (format == BENCH_AS_CSV || format == BENCH_AS_JSON) {
        bench_campaign_export(file, format, calibration, json_conclusion(&conclusion));
        return;
    }
    BenchGrid grid =
        bench_records_grid(bench_specimen_fields, bench_specimen_field_count, calibration->point,
                           sizeof(BenchSpecimen), calibration->count, 0);
    BenchGrid laws = bench_records_grid(bench_stiffness_fit_fields, bench_stiffness_fit_field_count,
                                        conclusion.law, sizeof *conclusion.law, conclusion.laws, 0);
    if (format == BENCH_AS_TEXT) {
        write_text(file, calibration, &conclusion, &grid, &laws);
    } else {
        bench_grid_whole(file, &grid, bench_format_form(format));
        fputc('\n', file);
        if (laws.lines) bench_grid_whole(file, &laws, bench_format_form(format));
    }
    bench_grid_free(&grid);
    bench_grid_free(&laws);
}
