// Do Gazebo and MuJoCo get a joint's stops as numbers that rebound as the case has it?
//
// cases/mechanisms/stop-rebound.yaml: .01 kg m^2 at 10 rad/s, 1e4 N m/rad, 1 N m s/rad, which gives
// back exp(-2 z acos z / sqrt(1 - z^2)) = .858754, z = .05. The SDF's numbers go into a hinge of
// ODE's as Gazebo hands them on (ODEJoint::Load), the MJCF's into the row of MuJoCo's
// documentation.
#include "program.h"

#include <math.h>
#include <ode/ode.h>
#include <unistd.h>

static const double INERTIA = 0.01; // kg m^2
static const double SPEED = 10.0;   // rad/s
static const double ASKED = 0.858754;

#define REBOUND                                                                                    \
    "tune $cases/mechanisms/stop-rebound.yaml --error 0.1 --schemes direct/staggered/impulse "     \
    "--set run.duration='0.4 s' --set run.samples=400 --quiet "

static void read_file(Program *program, const char *name)
{
    char path[PROGRAM_PATH_SIZE];
    program_path(program, name, path);
    program_read(path, program->output);
}

// The number that stands behind a mark, and behind blanks the one after it.
static const char *number_at(const char *text, const char *mark, double *number)
{
    const char *found = strstr(text, mark);
    if (found == NULL) {
        fail_msg("no %s in:\n%s", mark, text);
    }
    char *end;
    *number = strtod(found + strlen(mark), &end);
    return end;
}

static double number_in(const char *text, const char *mark)
{
    double number;
    number_at(text, mark, &number);
    return number;
}

// A hinge of ODE's, turning until it has come back from its high stop.
static double rebound_in_ode(double step, double erp, double cfm, double high)
{
    dInitODE2(0);
    const dWorldID world = dWorldCreate();
    const dBodyID lever = dBodyCreate(world);
    dMass mass;
    dMassSetParameters(&mass, 1, 0, 0, 0, INERTIA, INERTIA, INERTIA, 0, 0, 0);
    dBodySetMass(lever, &mass);
    dBodySetAngularVel(lever, 0, 0, SPEED);
    const dJointID hinge = dJointCreateHinge(world, 0);
    dJointAttach(hinge, lever, 0);
    dJointSetHingeAxis(hinge, 0, 0, 1);
    dJointSetHingeParam(hinge, dParamHiStop, high);
    dJointSetHingeParam(hinge, dParamStopERP, erp);
    dJointSetHingeParam(hinge, dParamStopCFM, cfm);
    for (double time = 0.0; time < 0.2; time += step) {
        dWorldStep(world, step);
    }
    const double rebound = -dBodyGetAngularVel(lever)[2] / SPEED;
    dWorldDestroy(world);
    dCloseODE();
    return rebound;
}

// The row of a limit of MuJoCo: f = (a_ref - a0) / (W + R), R = A (1 - d) / d, a_ref = -b v - k r.
static double rebound_in_mujoco(double step, const double solref[2], double impedance)
{
    const double weight = 1.0 / INERTIA;
    const double b = -solref[1] / impedance;
    const double k = -solref[0] / impedance;
    double apart = 1e-3;
    double rate = -SPEED;
    do {
        const double sum = weight + weight * (1.0 - impedance) / impedance;
        const double force = apart < 0.0 ? fmax(0.0, (-b * rate - k * apart) / sum) : 0.0;
        rate += step * force / INERTIA;
        apart += step * rate;
    } while (apart < 1e-3);
    return rate / SPEED;
}

static void the_stop_of_gazebo_rebounds_as_asked(void **state)
{
    Program *program = *state;
    program_run(program, REBOUND "--sdf stop.sdf");
    assert_int_equal(program->status, 0);
    read_file(program, "stop.sdf");
    const char *sdf = program->output;
    const double step = number_in(sdf, "<max_step_size>");
    const char *limit = strstr(sdf, "<joint name=\"hinge\"");
    assert_non_null(limit);
    const double erp = number_in(limit, "<erp>");
    const double cfm = number_in(limit, "<cfm>");
    const double high = number_in(limit, "<upper>");
    assert_true(fabs(high - 0.5 * M_PI) < 1e-12);
    assert_true(fabs(number_in(limit, "<lower>") + M_PI / 6.0) < 1e-12);
    // the textbook's row adds a damper h k, a tenth of the joint's at this step
    assert_true(fabs(step - 1e-5) < 1e-12);
    assert_true(fabs(rebound_in_ode(step, erp, cfm, high) / ASKED - 1.0) < 0.02);
    // the control: of a step that the numbers are not for
    assert_true(fabs(rebound_in_ode(1e-3, erp, cfm, high) / ASKED - 1.0) > 0.2);
}

static void the_limit_of_mujoco_rebounds_as_asked(void **state)
{
    Program *program = *state;
    program_run(program, REBOUND "--mjcf stop.xml");
    assert_int_equal(program->status, 0);
    read_file(program, "stop.xml");
    const char *mjcf = program->output;
    double solref[2];
    const char *next = number_at(mjcf, "solreflimit=\"", &solref[0]);
    solref[1] = strtod(next, NULL);
    double range[2];
    next = number_at(mjcf, "range=\"", &range[0]);
    range[1] = strtod(next, NULL);
    assert_true(fabs(range[1] - range[0] - 2.0 * M_PI / 3.0) < 1e-12);
    const double impedance = number_in(mjcf, "solimplimit=\"");
    const double step = number_in(mjcf, "timestep=\"");
    assert_true(fabs(rebound_in_mujoco(step, solref, impedance) / ASKED - 1.0) < 0.01);
    // the control: without the joint's own A
    const double wrong[2] = {solref[0] / 100.0, solref[1]};
    assert_true(fabs(rebound_in_mujoco(step, wrong, impedance) / ASKED - 1.0) > 0.05);
}

static void backlash_is_a_range_about_its_middle(void **state)
{
    Program *program = *state;
    program_run(program, "tune $cases/mechanisms/servo-backlash.yaml --error 0.1 --at-step '1 ms' "
                         "--schemes direct/staggered/impulse --set run.duration='1.5 s' --json "
                         "--sdf gap.sdf --mjcf gap.xml --quiet");
    assert_int_equal(program->status, 0);
    json_t *root = program_json(program);
    const json_t *gazebo = json_object_get(root, "gazebo");
    assert_true(json_is_true(json_object_get(gazebo, "is_limit")));
    assert_true(fabs(json_number_value(json_object_get(gazebo, "kp")) - 168.516969) < 1e-9);
    const json_t *constants = json_array_get(json_object_get(root, "constants"), 0);
    const double stiffness = json_number_value(json_object_get(constants, "stiffness_N_m_rad"));
    assert_true(fabs(stiffness - 168.516969) < 1e-9);
    json_decref(root);
    read_file(program, "gap.sdf");
    const double gap = 0.62 * M_PI / 180.0;
    assert_true(fabs(number_in(program->output, "<upper>") - 0.5 * gap) < 1e-12);
    assert_true(fabs(number_in(program->output, "<lower>") + 0.5 * gap) < 1e-12);
    assert_true(fabs(number_in(program->output, "<dissipation>") - 0.2) < 1e-12);
}

#define GEARS                                                                                      \
    "tune $cases/mechanisms/gear-pair.yaml --error 0.1 --schemes direct/staggered/impulse "

static bool is_absent(Program *program, const char *name)
{
    char path[PROGRAM_PATH_SIZE];
    program_path(program, name, path);
    return access(path, F_OK) != 0;
}

static void what_they_have_not_is_said(void **state)
{
    Program *program = *state;
    const char *const gears = "Gazebo and MuJoCo get constants of pins in holes, or of the stops "
                              "or backlash of one pivot or slider that alone has play";
    // before the search, whatever else is asked for
    program_fails_usage(program, GEARS "--quiet --sdf none.sdf", gears);
    program_fails_usage(program, GEARS "--mjcf none.xml", gears);
    assert_true(is_absent(program, "none.sdf") && is_absent(program, "none.xml"));
    // where no constants are stable a step is named that was not tried
    program_run(program, "tune $cases/paper/impact-k66.yaml --at-step 200us -q --sdf none.sdf");
    assert_says(program->errors, "no contact with constants that was tried is stable; try "
                                 "--at-step 86us or less");
    assert_true(is_absent(program, "none.sdf"));
    // what is not asked for by name is named, and the others are written
    program_run(program, GEARS "--quiet --out all");
    assert_int_equal(program->status, 0);
    assert_says(program->errors, "jointplay: warning: not written: all/gear-pair-tune.sdf (Gazebo");
    assert_says(program->errors, "jointplay: warning: not written: all/gear-pair-tune.xml (Gazebo");
    assert_true(is_absent(program, "all/gear-pair-tune.sdf"));
    assert_false(is_absent(program, "all/gear-pair-tune.json"));
    // nor is offered what would be refused
    assert_null(strstr(program->output, "--code"));
    program_run(program, GEARS "--full");
    assert_says(program->output, "As Gazebo SDF and MuJoCo MJCF There is none: Gazebo and MuJoCo");
    // flanks without a gap: ODE's stop has them, a range of MuJoCo has not
    program_run(program, "tune $cases/mechanisms/servo-backlash.yaml --error 0.1 --at-step '1 ms' "
                         "--schemes direct/staggered/impulse --set run.duration='1.5 s' "
                         "--set 'joints.output.backlash=0 deg' --sdf zero.sdf");
    assert_int_equal(program->status, 0);
    read_file(program, "zero.sdf");
    assert_says(program->output, "<upper>0</upper>");
    program_fails_usage(program,
                        "tune $cases/mechanisms/servo-backlash.yaml --error 0.1 "
                        "--set 'joints.output.backlash=0 deg' --mjcf zero.xml",
                        "--mjcf: MuJoCo has no range of length 0");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(the_stop_of_gazebo_rebounds_as_asked, program_set_up,
                                        program_tear_down),
        cmocka_unit_test_setup_teardown(the_limit_of_mujoco_rebounds_as_asked, program_set_up,
                                        program_tear_down),
        cmocka_unit_test_setup_teardown(backlash_is_a_range_about_its_middle, program_set_up,
                                        program_tear_down),
        cmocka_unit_test_setup_teardown(what_they_have_not_is_said, program_set_up,
                                        program_tear_down),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
