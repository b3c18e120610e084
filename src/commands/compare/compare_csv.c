// What does a spreadsheet read of a comparison?
#include "commands/compare/compare_csv.h"

#include "write/csv.h"
#include "write/file.h"

#include <math.h>
#include <stdio.h>

static const char HEAD[] =
    "scheme,step_s,status,steps,evaluations,error_omega,limited_by_truth,omega_max,omega_rms,"
    "alpha_max,angle_max_rad,wall_median_s,wall_min_s,wall_max_s,on_frontier,message\n";

static void write_numbers(FILE *stream, const LadderPoint *point)
{
    const TrajectoryError *error = &point->run.error;
    const double numbers[] = {error->omega_max,     error->omega_rms,     error->alpha_max,
                              error->angle_max_rad, point->wall_median_s, point->wall_min_s,
                              point->wall_max_s};
    fprintf(stream, "ok,%zu,%zu,", point->run.steps, point->run.evaluations);
    csv_write_number(stream, point->error);
    fprintf(stream, ",%d,", point->is_limited_by_truth);
    for (size_t i = 0; i < sizeof numbers / sizeof *numbers; i++) {
        csv_write_number(stream, numbers[i]);
        fputc(',', stream);
    }
    fprintf(stream, "%d,", point->is_on_frontier);
}

static void write_row(FILE *stream, const Ladder *ladder, const LadderPoint *point)
{
    fprintf(stream, "%s,", ladder->schemes[point->scheme].name);
    csv_write_number(stream, point->step_s > 0.0 ? point->step_s : NAN);
    fputc(',', stream);
    if (point->is_failed) {
        fputs("failed,,,,,,,,,,,,,", stream);
        csv_write_quoted(stream, point->reason);
    } else {
        write_numbers(stream, point);
        if (point->reason[0] != '\0') {
            csv_write_quoted(stream, point->reason);
        }
    }
    fputc('\n', stream);
}

bool compare_csv_write(const CompareReport *report, const char *path, Err *err)
{
    WholeFile file;
    if (!file_begin(&file, FILE_TABLE, path, err)) {
        return false;
    }
    fputs(HEAD, file.stream);
    for (size_t i = 0; i < report->ladder->point_count; i++) {
        write_row(file.stream, report->ladder, &report->ladder->points[i]);
    }
    return file_end(&file, err);
}
