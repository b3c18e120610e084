// Do the numbers of a series obey Newton's and Euler's laws?
//
// Whoever has the file alone must be able to work with it. Each series is written, read back as
// text, and held against
//
//     m a = F + sum of the joints' forces
//     I alpha = M + T + sum of (r x force + moment)
//
// of every body at every sample, with masses and anchors of the case, springs and gravity at the
// positions and velocities in the file, and the torque of the drive. That torque must also do the
// work that the run's audit of energy has. Controls: a mass that is 1 part in 10^6 larger, and the
// friction's moment left out.
#include "complete_run.h"
#include "load_case.h"
#include "scratch.h"

#include "../measure/random_case.h"
#include "base/lookup.h"
#include "commands/run/run_files.h"
#include "model/loads.h"

#include <math.h>

typedef struct Series {
    char *text;    // owned
    char **names;  // owned, into the text
    double *cells; // owned, by row and column
    size_t columns;
    size_t rows;
    Lookup by_name; // owned
} Series;

static Series read_series(const char *path)
{
    Series series = {0};
    FILE *stream = fopen(path, "r");
    assert_non_null(stream);
    size_t room = 0;
    const ssize_t length = getline(&series.text, &room, stream);
    assert_true(length > 0);
    series.text[length - 1] = '\0';
    series.names = calloc((size_t)length, sizeof *series.names);
    char *rest = series.text;
    for (char *name; (name = strsep(&rest, ",")) != NULL; series.columns++) {
        series.names[series.columns] = name;
        lookup_add(&series.by_name, lookup_hash(name), series.columns);
    }
    char *line = NULL;
    size_t line_room = 0;
    size_t rows_room = 0;
    while (getline(&line, &line_room, stream) > 0) {
        if (series.rows == rows_room) {
            rows_room = 2 * rows_room + 64;
            series.cells = realloc(series.cells, rows_room * series.columns * sizeof(double));
        }
        char *cells = line;
        for (size_t i = 0; i < series.columns; i++) {
            const char *cell = strsep(&cells, ",\n");
            assert_non_null(cell);
            series.cells[series.rows * series.columns + i] =
                *cell != '\0' ? strtod(cell, NULL) : NAN;
        }
        series.rows++;
    }
    free(line);
    fclose(stream);
    return series;
}

static void free_series(Series *series)
{
    free(series->text);
    free(series->names);
    free(series->cells);
    lookup_finish(&series->by_name);
}

// A name that is looked for in a series.
typedef struct SoughtName {
    const Series *series;
    const char *name;
} SoughtName;

static bool is_sought(size_t number, const void *sought)
{
    const SoughtName *of = sought;
    return strcmp(of->series->names[number], of->name) == 0;
}

// The cell of a column "of_number"; without such a column zero.
static double cell(const Series *series, size_t row, const char *of, const char *number)
{
    char name[2 * LINKAGE_NAME_SIZE];
    snprintf(name, sizeof name, "%s%s%s", of, *of != '\0' ? "_" : "", number);
    const SoughtName sought = {series, name};
    const int column = lookup_find(&series->by_name, lookup_hash(name), is_sought, &sought);
    return column == LOOKUP_NONE ? 0.0 : series->cells[row * series->columns + (size_t)column];
}

static Motion motion_of(const Series *series, size_t row, const char *body)
{
    return (Motion){
        .position = {cell(series, row, body, "x_m"), cell(series, row, body, "y_m")},
        .angle = cell(series, row, body, "angle_rad"),
        .velocity = {cell(series, row, body, "vx_m_s"), cell(series, row, body, "vy_m_s")},
        .omega = cell(series, row, body, "omega_rad_s"),
        .acceleration = {cell(series, row, body, "ax_m_s2"), cell(series, row, body, "ay_m_s2")},
        .alpha = cell(series, row, body, "alpha_rad_s2"),
    };
}

// What the laws leave, with the largest force and moment that they are to be held against.
typedef struct Balance {
    double force;
    double moment;
    double force_scale;
    double moment_scale;
} Balance;

typedef struct Fault {
    double mass;            // by which masses and inertias are larger, 1
    bool leaves_out_moment; // of joints
} Fault;

// Adds a force at a point and a moment to the load of a body.
static void push(const Motion *motions, int body, Vec2 point, Vec2 force, double moment,
                 BodyLoad *loads, Balance *balance)
{
    if (body == LINKAGE_GROUND) {
        return;
    }
    const Vec2 arm = vec2_sub(point, motions[body].position);
    loads[body].force = vec2_add(loads[body].force, force);
    loads[body].moment += vec2_cross(arm, force) + moment;
    balance->force_scale = fmax(balance->force_scale, vec2_length(force));
    balance->moment_scale =
        fmax(balance->moment_scale, vec2_length(arm) * vec2_length(force) + fabs(moment));
}

static void add_joints(const Scenario *scenario, const Series *series, size_t row, Fault fault,
                       const Motion *motions, BodyLoad *loads, Balance *balance)
{
    const Linkage *linkage = &scenario->linkage;
    for (size_t i = 0; i < linkage->joint_count; i++) {
        const Joint *joint = &linkage->joints[i];
        const Vec2 point = linkage_point(motions, joint->body_b, joint->anchor_b);
        const Vec2 force = {cell(series, row, joint->name, "force_x_N"),
                            cell(series, row, joint->name, "force_y_N")};
        const double moment =
            fault.leaves_out_moment ? 0.0 : cell(series, row, joint->name, "moment_N_m");
        push(motions, joint->body_b, point, force, moment, loads, balance);
        push(motions, joint->body_a, point, vec2_scale(-1.0, force), -moment, loads, balance);
        const int drive = linkage_drive_of_joint(linkage, i);
        if (drive >= 0) {
            const double torque =
                cell(series, row, drive == 0 ? "" : joint->name, "drive_torque_N_m");
            push(motions, joint->body_b, point, (Vec2){0.0, 0.0}, torque, loads, balance);
            push(motions, joint->body_a, point, (Vec2){0.0, 0.0}, -torque, loads, balance);
        }
    }
}

static Balance balance_of(const Scenario *scenario, const Series *series, Fault fault)
{
    const Linkage *linkage = &scenario->linkage;
    Motion *motions = calloc(linkage->body_count, sizeof *motions);
    BodyLoad *loads = calloc(linkage->body_count, sizeof *loads);
    Balance balance = {0};
    // of a long series some hundred rows
    for (size_t row = 0; row < series->rows; row += 1 + series->rows / 500) {
        for (size_t i = 0; i < linkage->body_count; i++) {
            motions[i] = motion_of(series, row, linkage->bodies[i].name);
        }
        const double time_s = cell(series, row, "", "time_s");
        loads_of_all(linkage, motions, time_s, time_s, loads);
        add_joints(scenario, series, row, fault, motions, loads, &balance);
        for (size_t i = 0; i < linkage->body_count; i++) {
            const Body *body = &linkage->bodies[i];
            const double mass = body->mass * (1.0 + fault.mass);
            const Vec2 wants =
                vec2_scale(mass, vec2_add(motions[i].acceleration, scenario_upward(scenario)));
            balance.force = fmax(balance.force, vec2_length(vec2_sub(wants, loads[i].force)));
            balance.force_scale = fmax(balance.force_scale, vec2_length(wants));
            const double turning = body->inertia * (1.0 + fault.mass) * motions[i].alpha;
            balance.moment = fmax(balance.moment, fabs(turning - loads[i].moment));
            balance.moment_scale = fmax(balance.moment_scale, fabs(turning));
        }
    }
    free(motions);
    free(loads);
    return balance;
}

static Series series_of(const Scenario *scenario, const Trajectory *run)
{
    char path[256];
    Err err = {0};
    scratch_path("newton.csv", path, sizeof path);
    assert_true(series_write(scenario, run, NULL, path, &err));
    Series series = read_series(path);
    unlink(path);
    return series;
}

static double share(double part, double of)
{
    return of > 0.0 ? part / of : 0.0;
}

// of the largest force or moment of the run
static const double BALANCED = 1e-9;

// Returns whether anything pushes: of a case in which nothing does, nothing is shown.
static bool check_laws(const char *name, const Scenario *scenario)
{
    Trajectory *run = complete_run(scenario, BACKEND_REFERENCE);
    Series series = series_of(scenario, run);
    const Balance balance = balance_of(scenario, &series, (Fault){0});
    const Balance heavier = balance_of(scenario, &series, (Fault){.mass = 1e-6});
    print_message("%s: %.2g of %.3g N, %.2g of %.3g N m\n", name, balance.force,
                  balance.force_scale, balance.moment, balance.moment_scale);
    assert_true(share(balance.force, balance.force_scale) < BALANCED);
    assert_true(share(balance.moment, balance.moment_scale) < BALANCED);
    const bool pushes = balance.force_scale > 0.0 || balance.moment_scale > 0.0;
    assert_true(!pushes || heavier.force > 10.0 * balance.force ||
                heavier.moment > 10.0 * balance.moment);
    free_series(&series);
    trajectory_destroy(run);
    return pushes;
}

static void the_shipped_cases_obey(void **state)
{
    (void)state;
    static const char *const PATHS[] = {
        "cases/paper/impact-k66.yaml",
        "cases/paper/stackup-impact.yaml",
        "cases/mechanisms/andrews.yaml",
        "cases/mechanisms/cam-roller.yaml",
        "cases/mechanisms/pin-slot.yaml",
        "cases/mechanisms/compressor.yaml",
        "cases/mechanisms/five-bar.yaml",
        "cases/mechanisms/gear-pair.yaml",
        "cases/mechanisms/newtons-cradle.yaml",
        "cases/mechanisms/planetary-gear.yaml",
        "cases/mechanisms/rack-and-pinion.yaml",
        "cases/mechanisms/servo-backlash.yaml",
        "cases/mechanisms/slider-crank-both.yaml",
        "cases/mechanisms/slider-crank-guide.yaml",
        "cases/mechanisms/stop-rebound.yaml",
        "cases/mechanisms/woodpecker.yaml",
    };
    static const char *const SHORT[] = {"run.samples=200"};
    for (size_t i = 0; i < sizeof PATHS / sizeof *PATHS; i++) {
        const Scenario scenario = load(PATHS[i], SHORT, 1);
        assert_true(check_laws(PATHS[i], &scenario));
    }
}

static Scenario random_case_of(const CaseKind *kind, uint64_t seed)
{
    char *text = NULL;
    size_t size = 0;
    FILE *file = open_memstream(&text, &size);
    kind->write(seed, file);
    fclose(file);
    const char *all[LOAD_OVERRIDE_MAX];
    const bool turns = strstr(text, "revolutions: ") != NULL;
    const char *const settings[] = {"run.samples=100",
                                    turns ? "run.revolutions=0.05" : "run.duration=30ms"};
    const size_t used = of_one_start(settings, 2, all);
    Scenario scenario;
    Err err = {0};
    if (!casefile_load_text("random case", text, size, all, used, &scenario, &err)) {
        fail_msg("%s %d: %s", kind->name, (int)seed, err.text);
    }
    free(text);
    return kept_instead(&scenario);
}

static void random_cases_obey(void **state)
{
    (void)state;
    const CaseKind *const KINDS[] = {&CASE_FOUR_BAR, &CASE_BODIES, &CASE_SPRUNG,
                                     &CASE_SLIDERS,  &CASE_LIMITS, &CASE_SLOTS};
    int pushed = 0;
    for (size_t k = 0; k < sizeof KINDS / sizeof *KINDS; k++) {
        for (uint64_t seed = 1; seed <= 6; seed++) {
            char name[64];
            snprintf(name, sizeof name, "%s %d", KINDS[k]->name, (int)seed);
            const Scenario scenario = random_case_of(KINDS[k], seed);
            pushed += check_laws(name, &scenario);
        }
    }
    assert_true(pushed >= 28);
}

// The work of the drive's torque over the run, by the trapezoidal rule.
static double work_of(const Series *series, const char *crank)
{
    double work = 0.0;
    for (size_t row = 0; row + 1 < series->rows; row++) {
        const double step = cell(series, row + 1, "", "time_s") - cell(series, row, "", "time_s");
        work +=
            0.5 * step *
            (cell(series, row, "", "drive_torque_N_m") * cell(series, row, crank, "omega_rad_s") +
             cell(series, row + 1, "", "drive_torque_N_m") *
                 cell(series, row + 1, crank, "omega_rad_s"));
    }
    return work;
}

static void the_torque_of_the_drive_does_its_work(void **state)
{
    (void)state;
    // friction in the hole turns the crank, which has it
    static const char *const SETTINGS[] = {"contact.friction=0.2", "run.samples=20000",
                                           "ode.stepping=staggered", "ode.map=impulse",
                                           "run.step=2us"};
    const Scenario scenario = load("cases/paper/impact-k66.yaml", SETTINGS, 5);
    for (int k = 0; k < 2; k++) {
        Trajectory *run = complete_run(&scenario, k == 0 ? BACKEND_REFERENCE : BACKEND_ODE);
        Series series = series_of(&scenario, run);
        const double work = work_of(&series, "crank");
        const double turned = 1e-6 * fabs(run->energy.drive_work) + fabs(run->energy.dissipated) +
                              fabs(run->energy.friction);
        print_message("%s: work %.9g J of %.9g J, friction %.3g J\n", run->backend, work,
                      run->energy.drive_work, run->energy.friction);
        assert_true(fabs(work - run->energy.drive_work) < 1e-3 * turned);
        const Balance balance = balance_of(&scenario, &series, (Fault){0});
        const Balance without = balance_of(&scenario, &series, (Fault){.leaves_out_moment = true});
        print_message("moments: %.2g of %.3g N m, without friction's %.2g\n", balance.moment,
                      balance.moment_scale, without.moment);
        if (k == 0) {
            assert_true(balance.moment < BALANCED * balance.moment_scale);
            assert_true(without.moment > 1e-3 * without.moment_scale);
        }
        free_series(&series);
        trajectory_destroy(run);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_shipped_cases_obey),
        cmocka_unit_test(random_cases_obey),
        cmocka_unit_test(the_torque_of_the_drive_does_its_work),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
