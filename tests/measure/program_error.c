// What is the error of the series that a program of `tune --code` printed?
//
// program_error CASE.yaml SERIES.csv HORIZON_S [SETTING...]
// Against the reference of the case in another frame and at a tighter tolerance, at the times of
// the series. Prints the error and the rate that has it; columns are time, then x, y, angle, vx,
// vy, omega of each body.
#include "random_scenario.h"

#include "casefile/casefile.h"
#include "model/distance.h"
#include "run/registry.h"
#include "run/run.h"

#include <assert.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { LINE_SIZE = 1 << 14, PER_BODY = 6 };

static const double TOLERANCE = 1e-13;

typedef struct Series {
    size_t rows;
    double interval; // s
    Motion *motions; // owned; rows times bodies
} Series;

// Whether the columns of a body are those of its pivot: then it turns about it, driven.
static bool is_at_pivot(const char *head, const Body *body)
{
    char name[LINE_SIZE];
    snprintf(name, sizeof name, ",%s_pivot_x_m", body->name);
    return strstr(head, name) != NULL;
}

static void move_to_centre(const Linkage *linkage, Motion *motion)
{
    const Joint *joint = &linkage->joints[linkage->driver.joint];
    const Vec2 pivot = joint->body_a == LINKAGE_GROUND ? joint->anchor_b : joint->anchor_a;
    const Vec2 arm = vec2_scale(-1.0, vec2_rotate(motion->angle, pivot));
    motion->position = vec2_add(motion->position, arm);
    motion->velocity = vec2_scale(motion->omega, vec2_perp(arm));
}

static void read_row(const Linkage *linkage, const char *head, char *line, Motion *motions)
{
    char *cell = line + strcspn(line, ",");
    for (size_t i = 0; i < linkage->body_count; i++) {
        double values[PER_BODY];
        for (size_t k = 0; k < PER_BODY; k++) {
            assert(*cell == ',');
            values[k] = strtod(cell + 1, &cell);
        }
        motions[i] = (Motion){.position = {values[0], values[1]},
                              .angle = values[2],
                              .velocity = {values[3], values[4]},
                              .omega = values[5]};
        if (is_at_pivot(head, &linkage->bodies[i])) {
            move_to_centre(linkage, &motions[i]);
        }
    }
}

static Series read_series(const Linkage *linkage, const char *path)
{
    static char head[LINE_SIZE];
    static char line[LINE_SIZE];
    Series series = {0};
    FILE *file = fopen(path, "r");
    assert(file != NULL && fgets(head, sizeof head, file) != NULL);
    while (fgets(line, sizeof line, file) != NULL) {
        const size_t bodies = linkage->body_count;
        series.motions =
            realloc(series.motions, (series.rows + 1) * bodies * sizeof *series.motions);
        read_row(linkage, head, line, &series.motions[series.rows * bodies]);
        if (series.rows == 1) {
            series.interval = strtod(line, NULL);
        }
        series.rows++;
    }
    fclose(file);
    return series;
}

int main(int argc, char **argv)
{
    static Scenario scenario;
    Err err = {0};
    if (argc < 4 ||
        !casefile_load(argv[1], (const char *const *)argv + 4, (size_t)argc - 4, &scenario, &err)) {
        fprintf(stderr, "program_error CASE.yaml SERIES.csv HORIZON_S [SETTING...] %s\n", err.text);
        return 2;
    }
    const Linkage *linkage = &scenario.linkage;
    Series series = read_series(linkage, argv[2]);
    Scenario judge = moved_scenario(&scenario, TOLERANCE);
    judge.run.interval = series.interval;
    Trajectory *truth = run_motion(&judge, registry_solver(BACKEND_REFERENCE), (RunWatch){0});
    if (!truth->is_complete || truth->sample_count + 1 < series.rows) {
        fprintf(stderr, "the truth: %s, %zu samples for %zu rows\n", truth->message,
                truth->sample_count, series.rows);
        return 4;
    }
    DistanceMeasure measure = distance_measure(truth);
    // the last step may end past the end of the run
    double error = 0.0;
    const DistanceRate *worst = &measure.rates[0];
    for (size_t i = 0;
         i < series.rows && i < truth->sample_count && truth->times[i] <= atof(argv[3]); i++) {
        for (size_t k = 0; k < measure.count; k++) {
            const DistanceRate *rate = &measure.rates[k];
            const DistanceMotion own = {&series.motions[i * linkage->body_count], NULL};
            const double apart = distance_between(
                rate, distance_value(linkage, rate, own),
                distance_value(&judge.linkage, rate, distance_motion_at(truth, i)));
            if (!(apart <= error)) {
                error = apart;
                worst = rate;
            }
        }
    }
    char name[DISTANCE_NAME_SIZE];
    distance_name(linkage, worst, name);
    printf("%.6g %s\n", error, name);
    distance_finish(&measure);
    trajectory_destroy(truth);
    free(series.motions);
    return 0;
}
