// Do the constants for other programs come to the contact that they stand for?
#include "commands/tune/tune_export.h"

#include "commands/tune/tune_linear.h"
#include "contact/law.h"
#include "contact/map.h"

#include "close.h"
#include "mechanism.h"

#include <stdlib.h>

typedef struct Fixture {
    Scenario scenario;
    Tune *tune;
    TuneReport report;
} Fixture;

// One linear contact, taken.
static Fixture *make(void)
{
    Fixture *made = calloc(1, sizeof *made);
    assert_non_null(made);
    made->scenario = mechanism_paper();
    mechanism_loosen(&made->scenario, "crank-coupler");
    made->tune = tune_create(&made->scenario, NULL, 0, 1e-3);
    made->tune->contact = (TuneContact){
        .is_known = true,
        .joint = (size_t)linkage_find_joint(&made->scenario.linkage, "crank-coupler"),
        .mass = 0.5,
    };
    made->tune->linears[0] = (TuneLinear){.stiffness = 2e8, .damping = 600.0, .step_s = 1e-6};
    made->tune->linear_count = 1;
    made->tune->linear = 0;
    made->report = (TuneReport){.scenario = &made->scenario, .tune = made->tune};
    return made;
}

static void finish_export(Fixture *made)
{
    tune_destroy(made->tune);
    free(made);
}

static void the_secant_spring_gives_the_law_s_force(void **state)
{
    (void)state;
    const ForceLaw law = force_law_power(6.6e10, 1.5);
    const double depth = 1e-5;
    assert_close(force_law_secant(&law, depth) * depth, 6.6e10 * pow(depth, 1.5), 1e-9);
}

// A mass on the spring and damper, pushed only, stepped so finely that the step does not show.
static double bounce(double stiffness, double damping, double mass)
{
    const double h = 1e-4 * sqrt(mass / stiffness);
    double depth = 0.0;
    double speed = 1.0;
    do {
        const double force = fmax(0.0, stiffness * depth + damping * speed);
        speed -= h * force / mass;
        depth += h * speed;
    } while (depth > 0.0);
    return -speed;
}

static void the_damper_gives_the_restitution(void **state)
{
    (void)state;
    for (double asked = 0.3; asked < 1.0; asked += 0.2) {
        const double damping = tune_linear_damping(2e8, 0.5, asked);
        // symplectic steps of 1e-4 of the period: right to their size
        assert_close(bounce(2e8, damping, 0.5), asked, 1e-3);
        // control: for another mass it is another restitution
        assert_true(fabs(bounce(2e8, damping, 5.0) - asked) > 1e-2);
    }
}

static void two_surfaces_of_gazebo_make_the_contact(void **state)
{
    (void)state;
    Fixture *made = make();
    TuneGazebo gazebo;
    assert_true(tune_gazebo_find(made->tune, &gazebo));
    // ODEPhysics::Collide: springs one behind the other, dampers side by side, the textbook map
    const double kp = 1.0 / (1.0 / gazebo.kp + 1.0 / gazebo.kp);
    const double kd = gazebo.kd + gazebo.kd;
    assert_close(kp, 2e8, 1e-15);
    assert_close(kd, 600.0, 1e-15);
    const MapContact contact = {.stiffness = kp, .damping = kd, .step = gazebo.step_s};
    const ErpCfm row = map_get(ODE_MAP_TEXTBOOK)->convert(&contact);
    assert_close(row.erp, gazebo.soft_erp, 1e-15);
    assert_close(row.cfm, gazebo.soft_cfm, 1e-15);
    finish_export(made);
}

// The force of one row of MuJoCo: f = (a_ref - a0) / (W + R), of a contact that is r < 0 apart.
static double mujoco_force(const TuneMujoco *mujoco, double impedance, double weight, double gap,
                           double rate, double free)
{
    const double b = -mujoco->solref[1] / impedance;
    const double k = -mujoco->solref[0] / impedance;
    const double regular = mujoco->weight * (1.0 - impedance) / impedance;
    return (-b * rate - k * gap - free) / (weight + regular);
}

static void the_row_of_mujoco_is_the_spring_whatever_the_mass(void **state)
{
    (void)state;
    Fixture *made = make();
    TuneMujoco mujoco;
    assert_true(tune_mujoco_find(&made->report, &mujoco));
    const double depth = 1e-5;
    const double expected = 2e8 * depth + 600.0 * 0.05;
    for (double weight = 1.0; weight <= 10.0; weight *= 2.0) {
        const double force = mujoco_force(&mujoco, mujoco.impedance, weight, -depth, -0.05, 100.0);
        // the share d of all accelerations, 1e-4, times the masses' ratio
        assert_close(force, expected, 1e-3);
    }
    // control: at MuJoCo's default impedance the mass that is met decides
    assert_true(fabs(mujoco_force(&mujoco, 0.9, 10.0, -depth, -0.05, 100.0) - expected) >
                0.1 * expected);
    finish_export(made);
}

static void a_step_that_mujoco_takes_as_asked_is_not_called_finer(void **state)
{
    (void)state;
    Fixture *made = make();
    TuneMujoco mujoco;
    // 1 us is far below the contact's own 50 us
    made->tune->held_s = 1e-6;
    assert_true(tune_mujoco_find(&made->report, &mujoco));
    assert_near(mujoco.step_s, 1e-6, 0.0);
    assert_false(tune_mujoco_is_finer(&made->report, &mujoco));
    // and 1 ms far above
    made->tune->held_s = made->tune->linears[0].step_s = 1e-3;
    assert_true(tune_mujoco_find(&made->report, &mujoco));
    assert_true(mujoco.step_s < 1e-3);
    assert_true(tune_mujoco_is_finer(&made->report, &mujoco));
    finish_export(made);
}

static void nothing_is_written_without_a_contact(void **state)
{
    (void)state;
    Fixture *made = make();
    made->tune->linear = TUNE_NONE;
    Text text;
    text_init(&text);
    tune_gazebo_write(&made->report, &text);
    tune_mujoco_write(&made->report, &text);
    assert_int_equal(text.length, 0);
    text_finish(&text);
    finish_export(made);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_secant_spring_gives_the_law_s_force),
        cmocka_unit_test(the_damper_gives_the_restitution),
        cmocka_unit_test(two_surfaces_of_gazebo_make_the_contact),
        cmocka_unit_test(the_row_of_mujoco_is_the_spring_whatever_the_mass),
        cmocka_unit_test(a_step_that_mujoco_takes_as_asked_is_not_called_finer),
        cmocka_unit_test(nothing_is_written_without_a_contact),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
