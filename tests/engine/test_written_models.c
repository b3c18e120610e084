// Does a model that MuJoCo's driver writes move as the driver says that it moved?
//
// Springs, dampers and what is constant are elements of the file, which MuJoCo alone runs from its
// key here. Truth: the driver's samples, at its steps, to a rounding. The controls: another spring,
// another load, another damper.
#include "engine_outcome.h"

#include <mujoco/mujoco.h>
#include <unistd.h>

static const char TEXT[] =
    "bodies:\n"
    "  crank: {mass: 0.3 kg, inertia: 400 kg mm^2, at: [20 mm, 0 mm], angle: 20 deg}\n"
    "  rod: {mass: 0.2 kg, inertia: 250 kg mm^2, at: [120 mm, 10 mm], angle: -35 deg}\n"
    "  bead: {mass: 0.1 kg, inertia: 50 kg mm^2, at: [150 mm, 30 mm]}\n"
    "joints:\n"
    "  pivot: {between: [crank, ground], at: [0 mm, 0 mm]}\n"
    "  elbow: {between: [rod, crank], at: [50 mm, 0 mm]}\n"
    "  rail: {between: [rod, bead], at: [150 mm, 30 mm], along: 25 deg}\n"
    "springs:\n"
    "  return: {between: [rod, ground], at-a: [120 mm, 10 mm], at-b: [200 mm, -80 mm],\n"
    "           stiffness: 900 N/m, length: 60 mm, damping: 2 N s/m}\n"
    "  hold: {between: [rod, bead], at-a: [60 mm, 5 mm], at-b: [150 mm, 30 mm],\n"
    "         stiffness: 300 N/m, length: 80 mm}\n"
    "torsion-springs:\n"
    "  one: {joint: pivot, stiffness: 0.5 N m/rad, angle: 10 deg, damping: 1 N mm s/rad}\n"
    "  two: {joint: pivot, stiffness: 0.2 N m/rad, angle: -30 deg}\n"
    "  three: {joint: elbow, stiffness: 0.3 N m/rad, angle: 15 deg, damping: 2 N mm s/rad}\n"
    "loads:\n"
    "  push: {body: bead, at: [150 mm, 35 mm], direction: 40 deg, frame: body, force: 3 N}\n"
    "  wind: {body: rod, at: [100 mm, 0 mm], direction: 90 deg, force: 0.5 N}\n"
    "  twist: {joint: elbow, torque: 0.1 N m}\n"
    "gravity: 9.81 m/s^2\n"
    "run: {duration: 40 ms, samples: 80, step: 100 us}\n";

// m, rad: sums over hundreds of steps, in the order of another program
static const double ROUNDING = 1e-10;

typedef struct Written {
    char *text;
    Trajectory *run;
} Written;

static Written write_model(void)
{
    Scenario read;
    Err err = {0};
    Written written;
    EngineSaid said;
    if (!casefile_load_text("sprung", TEXT, strlen(TEXT), NULL, 0, &read, &err)) {
        fail_msg("%s", err.text);
    }
    const Scenario scenario = kept_instead(&read);
    const EngineDriver driver = engine_named("mujoco");
    written.run = engine_run_model(&driver, "native", &scenario, LIMIT_S, &said, &written.text);
    if (!written.run->is_complete || written.text == NULL) {
        fail_msg("%s", written.run->message);
    }
    return written;
}

// The text with one word in place of another.
static char *replaced(const char *text, const char *from, const char *to)
{
    const char *at = strstr(text, from);
    char *other = calloc(1, strlen(text) + strlen(to) + 1);
    assert_non_null(at);
    assert_non_null(other);
    memcpy(other, text, (size_t)(at - text));
    strcat(other, to);
    strcat(other, at + strlen(from));
    return other;
}

static mjModel *load_model(const char *text)
{
    char path[] = "/tmp/jointplay-model-XXXXXX";
    char words[512] = "";
    const int file = mkstemp(path);
    assert_true(file >= 0);
    assert_int_equal(write(file, text, strlen(text)), (ssize_t)strlen(text));
    close(file);
    mjModel *model = mj_loadXML(path, NULL, words, sizeof words);
    unlink(path);
    if (model == NULL) {
        fail_msg("%s", words);
    }
    return model;
}

// How far the bodies are from a sample at most, m and rad.
static double apart_at(const mjData *data, const Trajectory *run, size_t sample)
{
    double most = 0.0;
    for (size_t i = 0; i < run->body_count; i++) {
        const Motion *at = trajectory_motion(run, sample, i);
        const double *place = data->xpos + 3 * (i + 1);
        const double *turn = data->xmat + 9 * (i + 1);
        const double angle = remainder(atan2(turn[3], turn[0]) - at->angle, 2.0 * M_PI);
        most = fmax(most,
                    fmax(hypot(place[0] - at->position.x, place[1] - at->position.y), fabs(angle)));
    }
    return most;
}

// Runs a model from its key by itself; how far it comes from the run's samples.
static double apart(const char *text, const Trajectory *run)
{
    mjModel *model = load_model(text);
    mjData *data = mj_makeData(model);
    double most = 0.0;
    size_t sample = 0;
    mj_resetDataKeyframe(model, data, 0);
    assert_int_equal(model->nbody, run->body_count + 1);
    for (size_t step = 0; sample < run->sample_count; step++) {
        const double time_s = (double)step * model->opt.timestep;
        while (sample < run->sample_count &&
               run->times[sample] < time_s + 0.5 * model->opt.timestep) {
            mj_kinematics(model, data);
            most = fmax(most, apart_at(data, run, sample++));
        }
        mj_step(model, data);
    }
    mj_deleteData(data);
    mj_deleteModel(model);
    return most;
}

static void a_written_model_moves_as_the_driver_said(void **state)
{
    (void)state;
    const Written written = write_model();
    const double off = apart(written.text, written.run);
    print_message("# written model: off by %.2g\n", off);
    assert_true(off < ROUNDING);
    static const char *const CHANGES[][2] = {
        {"stiffness='900'", "stiffness='901'"}, {"damping='2'", "damping='2.1'"},
        {"biasprm='3 ", "biasprm='3.1 "},       {"biasprm='-0.1", "biasprm='0.1"},
        {"stiffness='0.69", "stiffness='0.79"},
    };
    for (size_t i = 0; i < sizeof CHANGES / sizeof *CHANGES; i++) {
        char *other = replaced(written.text, CHANGES[i][0], CHANGES[i][1]);
        const double control = apart(other, written.run);
        if (!(control > 1e3 * ROUNDING)) {
            fail_msg("%s: off by %g", CHANGES[i][1], control);
        }
        free(other);
    }
    free(written.text);
    trajectory_destroy(written.run);
}

static void what_has_no_element_is_named(void **state)
{
    (void)state;
    const Written written = write_model();
    assert_non_null(strstr(written.text, "<!-- left out: the load 'wind', whose direction stays as "
                                         "its body turns -->"));
    assert_null(strstr(written.text, "left out: the load 'push'"));
    free(written.text);
    trajectory_destroy(written.run);
}

// A file has the speed of its drive at the start, which stays: one that changes only the driver
// can turn, and what it ran would not be the file.
static void a_drive_over_time_has_no_file(void **state)
{
    (void)state;
    static const char *const SPEEDS[] = {"5 rad/s", "[[0 ms, 5 rad/s], [10 ms, 10 rad/s]]"};
    for (size_t i = 0; i < 2; i++) {
        char text[512];
        snprintf(text, sizeof text,
                 "bodies:\n  crank: {mass: 0.3 kg, inertia: 400 kg mm^2, at: [20 mm, 0 mm]}\n"
                 "joints:\n  pivot: {between: [ground, crank], at: [0 mm, 0 mm]}\n"
                 "drive: {joint: pivot, speed: %s}\n"
                 "run: {%s, samples: 100, step: 100 us}\n",
                 SPEEDS[i], i == 0 ? "revolutions: 0.2" : "duration: 20 ms");
        Scenario read;
        Err err = {0};
        EngineSaid said;
        char *model = NULL;
        if (!casefile_load_text("driven", text, strlen(text), NULL, 0, &read, &err)) {
            fail_msg("%s", err.text);
        }
        const Scenario scenario = kept_instead(&read);
        const EngineDriver driver = engine_named("mujoco");
        Trajectory *run = engine_run_model(&driver, "native", &scenario, LIMIT_S, &said, &model);
        if (run->is_complete != (i == 0) || (model != NULL) != (i == 0)) {
            fail_msg("%s: %s", SPEEDS[i], run->is_complete ? "it runs" : run->message);
        }
        if (i == 1) {
            assert_true(said.is_refused);
            assert_non_null(strstr(run->message, "the drive at 'pivot' in a file"));
        }
        free(model);
        trajectory_destroy(run);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_written_model_moves_as_the_driver_said),
        cmocka_unit_test(what_has_no_element_is_named),
        cmocka_unit_test(a_drive_over_time_has_no_file),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
