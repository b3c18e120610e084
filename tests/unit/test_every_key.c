// Does each key of a case reach the two places that list the scenario's numbers by hand?
//
// model/shake.c moves them by rounding, and tune's C program for libjointplay states them. A key
// that is missing in one of them changes no result there, so nothing else would show it.
#include "kept.h"
#include "load_case.h"

#include "base/text.h"
#include "casefile/schema.h"
#include "commands/tune/tune_world.h"
#include "model/shake.h"

#include <math.h>
#include <string.h>

// How a run is made and reported: chosen by the user, not measured, and the same on any machine.
static const char *const UNSHAKEN[] = {
    "run.revolutions",
    "run.duration",
    "run.tolerance",
    "run.spike-threshold",
    "run.report-from",
    "reference.tolerance",
    "drive.period",
    "run.settle-to",
    "run.settle-budget",
    "run.budget",
    // shaken where friction has bristles
    "contact.breakaway-ratio",
    "contact.presliding",
    "contact.presliding-damping",
};

// What has no line in the program for libjointplay that is looked at here.
static const char *const UNWRITTEN[] = {
    // read before the run, or by the reference: programs are of the plane, bodies say where they
    // start, and the step is chosen already
    "space",
    "four-bar.assembly",
    "drive.start",
    "run.most-steps",
    "run.spike-threshold",
    "run.report-from",
    "run.start",
    "run.settle-least",
    "run.settle-most",
    "run.settle-to",
    "run.settle-budget",
    "run.budget",
    "run.settle-starts",
    "run.samples",
    // of other engines
    "engines.mujoco",
    "engines.chipmunk",
    "engines.bullet",
    "engines.simbody",
    "engines.driver",
    "run.tolerance",
    "run.tolerance-of",
    "reference.tolerance",
    // replaced in this case: by its revolutions and its damping that grows with the depth
    "run.duration",
    "contact.restitution",
    "contact.resting-speed",
    "contact.dissipation",
    "contact.restitution-speed",
    // of a speed over time, which this case has not (test_tune_world.c)
    "drive.period",
    // refused where it has them
    "drive.stall-torque",
    "drive.profile",
    "drive.no-load-speed",
    "drive.rotor-inertia",
    "drive.stiffness",
    "drive.damping",
    "drive.torque-limit",
    // of the contact model and the rows of the program's own world, which the library has not
    "contact.model",
    "contact.penalty",
    "contact.bounce-speed",
    "ode.map",
    "ode.collider",
    "ode.facets",
    "ode.polygon",
    "ode.cfm",
    "ode.push-out",
    "ode.seed",
    "ode.settle-steps",
    "ode.levels",
    "ode.gear",
    "ode.contact-phase",
};

static bool is_listed(const char *path, const char *const *list, size_t count)
{
    for (size_t i = 0; i < count; i++) {
        if (strcmp(path, list[i]) == 0) {
            return true;
        }
    }
    return false;
}
#define IS_LISTED(path, list) is_listed(path, list, sizeof(list) / sizeof *(list))

static bool is_own(const SchemaRow *row, SchemaType type)
{
    return row->family == SCHEMA_SINGLE && row->holder == SCHEMA_SINGLE && row->type == type;
}

// A number that the row allows, is not 0 and is no default.
static double unusual(const SchemaRow *row)
{
    const double high = fmin(row->high, row->low + 1.0);
    return row->low + 0.377 * (high - row->low);
}

static void every_physical_number_is_shaken(void **state)
{
    (void)state;
    const Scenario still = load("cases/paper/impact-k66.yaml", NULL, 0);
    size_t checked = 0;
    for (size_t i = 0; i < SCHEMA_ROW_COUNT; i++) {
        const SchemaRow *row = &SCHEMA_ROWS[i];
        if (!is_own(row, SCHEMA_QUANTITY)) {
            continue;
        }
        bool has_moved = false;
        for (unsigned seed = 1; seed <= 20; seed++) {
            Scenario scenario = kept_copy(&still);
            double *field = schema_field(row, &scenario, 0);
            const double before = *field = unusual(row);
            shake_inputs(&scenario, seed);
            has_moved = has_moved || *field != before;
        }
        if (has_moved == IS_LISTED(row->path, UNSHAKEN)) {
            fail_msg("%s is %s: add it to model/shake.c if it is a physical number, otherwise to "
                     "UNSHAKEN in %s",
                     row->path, has_moved ? "shaken" : "not shaken", __FILE__);
        }
        checked++;
    }
    assert_true(checked > 20);
}

// Gravity's numbers are three.
static void gravity_is_shaken_in_every_direction(void **state)
{
    (void)state;
    Scenario still = load("cases/paper/impact-k66.yaml", NULL, 0);
    still.gravity = (Vec3){1.1, -2.2, 3.3};
    bool has_moved[3] = {false, false, false};
    for (unsigned seed = 1; seed <= 20; seed++) {
        Scenario scenario = kept_copy(&still);
        shake_inputs(&scenario, seed);
        has_moved[0] = has_moved[0] || scenario.gravity.x != still.gravity.x;
        has_moved[1] = has_moved[1] || scenario.gravity.y != still.gravity.y;
        has_moved[2] = has_moved[2] || scenario.gravity.z != still.gravity.z;
        // by a unit in the last place
        assert_true(vec3_length(vec3_sub(scenario.gravity, still.gravity)) < 1e-15);
    }
    assert_true(has_moved[0] && has_moved[1] && has_moved[2]);
}

static void write_code(const Scenario *scenario, Text *text)
{
    const TuneCode code = {
        .scenario = scenario, .words = "", .command = "", .error = 1e-3, .target = 1e-3};
    Err err = {0};
    text_init(text);
    if (!tune_world_write(&code, text, &err)) {
        fail_msg("%s", err.text);
    }
}

// Changes the value of a row; false where this test does not know how.
static bool change(const SchemaRow *row, Scenario *scenario)
{
    if (is_own(row, SCHEMA_QUANTITY)) {
        *(double *)schema_field(row, scenario, 0) = unusual(row);
    } else if (is_own(row, SCHEMA_INTEGER)) {
        *(size_t *)schema_field(row, scenario, 0) += 1;
    } else if (is_own(row, SCHEMA_CHOICE)) {
        unsigned *choice = schema_field(row, scenario, 0);
        *choice = row->words[*choice + 1] != NULL ? *choice + 1 : 0;
    } else if (is_own(row, SCHEMA_GRAVITY)) {
        scenario->gravity.x += 1.0;
    } else {
        return false;
    }
    return true;
}

static void every_setting_of_the_library_is_in_the_program(void **state)
{
    (void)state;
    const char *const overrides[] = {"run.step=1 us",
                                     "contact.law=johnson",
                                     "contact.damping=step",
                                     "contact.viscous-coefficient=100 N s/m",
                                     "contact.full-damping-depth=0.1 mm",
                                     "contact.friction=0.1",
                                     "ode.solver=quick",
                                     "ode.stepping=plain"};
    Scenario as_it_is = load("cases/paper/stackup-impact.yaml", overrides, 8);
    as_it_is.contact.friction_law = BRISTLE_STICK; // the steps of a case with it have no row
    Text before;
    write_code(&as_it_is, &before);
    size_t checked = 0;
    for (size_t i = 0; i < SCHEMA_ROW_COUNT; i++) {
        const SchemaRow *row = &SCHEMA_ROWS[i];
        Scenario scenario = kept_copy(&as_it_is);
        const bool is_of_case = strncmp(row->path, "slider-crank", strlen("slider-crank")) != 0;
        if (!is_of_case || !change(row, &scenario)) {
            continue;
        }
        Text after;
        write_code(&scenario, &after);
        const bool is_written = strcmp(before.data, after.data) != 0;
        text_finish(&after);
        if (is_written == IS_LISTED(row->path, UNWRITTEN)) {
            fail_msg("%s is %s the program of tune --code: add it to commands/tune/tune_world*.c "
                     "if the library has it, otherwise to UNWRITTEN in %s",
                     row->path, is_written ? "in" : "not in", __FILE__);
        }
        checked++;
    }
    text_finish(&before);
    assert_true(checked > 30);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_physical_number_is_shaken),
        cmocka_unit_test(gravity_is_shaken_in_every_direction),
        cmocka_unit_test(every_setting_of_the_library_is_in_the_program),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
