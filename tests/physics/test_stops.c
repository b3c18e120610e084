// Do bodies that stop one another bounce as they must?
#include "complete_run.h"
#include "kept.h"

#include <stdio.h>

static const double GRAVITY = 9.81;

static Scenario empty(void)
{
    Scenario scenario = kept_default();
    scenario.gravity = scenario_downward(GRAVITY);
    scenario.run.backend_count = 1;
    scenario.run.backends[0] = BACKEND_REFERENCE;
    scenario.contact.exponent = 1.0;
    scenario.contact.friction_speed = 1e-3;
    scenario.reference.tolerance = 1e-12;
    return scenario;
}

static const double BALL = 0.02; // m, its radius

// A ball let go a metre above a floor, or two, with a restitution that the law holds exactly but
// for gravity during the contact.
static Scenario ball(double stiffness, double restitution)
{
    Scenario scenario = empty();
    scenario.contact.stiffness = stiffness;
    scenario.contact.damping = DAMPING_EXACT;
    scenario.contact.restitution = restitution;
    scenario.contact.impact_speed_floor = 1e-9;
    Linkage *linkage = &scenario.linkage;
    linkage->body_count = 1;
    linkage->bodies[0] = (Body){
        .name = "ball",
        .mass = 0.1,
        .inertia = 1.6e-5,
        .start = {.position = {0.3, 1.0 + BALL}},
    };
    linkage->joint_count = 1;
    linkage->joints[0] = (Joint){
        .name = "floor",
        .kind = JOINT_STOP,
        .body_a = LINKAGE_GROUND,
        .body_b = 0,
        .direction = 0.5 * M_PI,
        .stop = {.radius_b = BALL},
    };
    return scenario;
}

enum { BOUNCES = 8 };

// Onsets and speeds of the first contacts, and the onset of that which never ends.
typedef struct Bounces {
    double times[BOUNCES];
    double speeds[BOUNCES];
    double last_s;
    size_t count;
} Bounces;

static Bounces bounce(const Scenario *scenario, double until_s)
{
    const Solver *solver = registry_solver(BACKEND_REFERENCE);
    Bounces bounces = {.count = 0};
    Err err = {ERR_NONE, ""};
    void *reference = NULL;
    assert_true(solver->open(scenario, &reference, &err));
    bool was_touching = false;
    for (double time_s = 0.0; time_s < until_s;) {
        if (!solver->step(reference, until_s, &err)) {
            fail_msg("%s", err.text);
        }
        const StepRecord record = solver->record(reference);
        time_s = record.end_s;
        if (record.joints[0].is_touching && !was_touching) {
            if (bounces.count < BOUNCES) {
                bounces.times[bounces.count] = time_s;
                bounces.speeds[bounces.count] = record.approach[0];
            }
            bounces.last_s = time_s;
            bounces.count++;
        }
        was_touching = record.joints[0].is_touching;
    }
    assert_true(was_touching);
    solver->close(reference);
    return bounces;
}

// The largest relative errors of bounces against a ball that bounces at a point in no time: of
// heights e^(2n) h0, of times, and of the end at sqrt(2 h0 / g) (1 + e) / (1 - e).
static void against_rigid(const Bounces *bounces, double e, double errors[3])
{
    const double fall_s = sqrt(2.0 / GRAVITY);
    const double end_s = fall_s * (1.0 + e) / (1.0 - e);
    double time_s = fall_s;
    double speed = sqrt(2.0 * GRAVITY);
    errors[0] = errors[1] = 0.0;
    for (int n = 0; n < BOUNCES; n++) {
        const double height = pow(bounces->speeds[n], 2.0) / (2.0 * GRAVITY);
        errors[0] = fmax(errors[0], fabs(height / pow(e, 2.0 * n) - 1.0));
        errors[1] = fmax(errors[1], fabs(bounces->times[n] - time_s) / end_s);
        speed *= e;
        time_s += 2.0 * speed / GRAVITY;
    }
    errors[2] = fabs(bounces->last_s - end_s) / end_s;
}

static void a_ball_on_a_stiff_floor_bounces_as_on_a_rigid_one(void **state)
{
    (void)state;
    for (int i = 0; i < 2; i++) {
        const double e = i == 0 ? 0.5 : 0.8;
        const double end_s = sqrt(2.0 / GRAVITY) * (1.0 + e) / (1.0 - e);
        double errors[3][3];
        for (int k = 0; k < 3; k++) {
            const Scenario scenario = ball(pow(10.0, 8.0 + 2.0 * k), e);
            Scenario run = kept_copy(&scenario);
            run.run.duration = end_s + 0.1;
            const Bounces bounces = bounce(&run, end_s + 0.05);
            against_rigid(&bounces, e, errors[k]);
            print_message("# e %g, k 1e%d: %zu contacts; heights %.3g, times %.3g, end %.3g\n", e,
                          8 + 2 * k, bounces.count, errors[k][0], errors[k][1], errors[k][2]);
        }
        // a contact lasts for some sqrt(m / k), and all errors go with it; the number of contacts
        // is whole, and with it the end jumps
        for (int what = 0; what < 3; what++) {
            for (int k = 0; k < 2; k++) {
                assert_near(log10(errors[k][what] / errors[k + 1][what]), 1.0,
                            what == 2 ? 0.2 : 0.05);
            }
            assert_true(errors[2][what] < 1e-3);
        }
    }
    // the control: another restitution
    Scenario other = ball(1e12, 0.5);
    other.contact.restitution = 0.501;
    other.run.duration = 1.5;
    const Bounces bounces = bounce(&other, 1.4);
    double errors[3];
    against_rigid(&bounces, 0.5, errors);
    assert_true(errors[0] > 1e-2 && errors[1] > 5e-4);
}

// A damper so strong that the ball creeps into the floor: the implicit method has the slopes that
// it needs. Depth d: m d'' = m g - k d - c d', from the onset on. Returns the largest error of it,
// m, of a damper that is stronger than the formula's by a factor.
static double creep(double factor, size_t *steps)
{
    const double mass = 0.1;
    const double stiffness = 1e6;
    const double damping = 1e6;
    Scenario scenario = ball(stiffness, 0.5);
    scenario.contact.damping = DAMPING_VISCOUS;
    scenario.contact.viscous_coefficient = factor * damping;
    const double onset_s = sqrt(2.0 / GRAVITY);
    const double speed = GRAVITY * onset_s;
    scenario.run.duration = onset_s + 0.5;
    scenario.run.samples = 1000;
    Trajectory *trajectory = complete_run(&scenario, BACKEND_REFERENCE);
    // rates of decay, the slower without cancellation; shares that fit the onset
    const double half = 0.5 * damping / mass;
    const double fast = half + sqrt(half * half - stiffness / mass);
    const double slow = stiffness / mass / fast;
    const double rest = mass * GRAVITY / stiffness;
    const double share = (speed - rest * fast) / (fast - slow);
    double worst = 0.0;
    for (size_t k = 0; k < trajectory->sample_count; k++) {
        const double since_s = trajectory->times[k] - onset_s;
        if (since_s > 0.0) {
            const double depth =
                rest + share * exp(-slow * since_s) - (rest + share) * exp(-fast * since_s);
            const double seen = BALL - trajectory_motion(trajectory, k, 0)->position.y;
            worst = fmax(worst, fabs(seen - depth));
        }
    }
    *steps = trajectory->steps;
    print_message("# off by %.3g m of %.3g m, in %zu steps\n", worst, speed / fast, *steps);
    trajectory_destroy(trajectory);
    return worst;
}

static void a_ball_creeps_into_a_strongly_damped_floor(void **state)
{
    (void)state;
    size_t steps = 0;
    assert_true(creep(1.0, &steps) < 1e-15);
    // an explicit method would need some 3e6 of them
    assert_true(steps < 3000);
    assert_true(creep(1.0 + 1e-6, &steps) > 1e-13);
}

// Five steel balls on threads of 0.25 m, 2 % of their diameter apart.
enum { BALLS = 5 };

static const double THREAD = 0.25;
static const double APART = 0.04 * 1.02;
static const double CRADLE_STIFFNESS = 1e6;

static double cradle_mass(void)
{
    return 7800.0 * 4.0 / 3.0 * M_PI * BALL * BALL * BALL;
}

static double cradle_inertia(void)
{
    return 0.4 * cradle_mass() * BALL * BALL;
}

static Scenario cradle(double angle, double duration)
{
    Scenario scenario = empty();
    scenario.contact.stiffness = CRADLE_STIFFNESS;
    scenario.contact.damping = DAMPING_NONE;
    scenario.contact.restitution = 1.0;
    scenario.run.duration = duration;
    scenario.run.samples = 100;
    Linkage *linkage = &scenario.linkage;
    for (int i = 0; i < BALLS; i++) {
        const double turned = i == 0 ? angle : 0.0;
        const Vec2 pivot = {APART * i, THREAD};
        Body *body = &linkage->bodies[linkage->body_count++];
        *body = (Body){.mass = cradle_mass(), .inertia = cradle_inertia()};
        body->start.angle = turned;
        body->start.position = vec2_add(pivot, vec2_rotate(turned, (Vec2){0.0, -THREAD}));
        snprintf(body->name, sizeof body->name, "ball-%d", i);
        Joint *thread = &linkage->joints[linkage->joint_count++];
        *thread = (Joint){
            .body_a = LINKAGE_GROUND,
            .body_b = i,
            .anchor_a = pivot,
            .anchor_b = {0.0, THREAD},
        };
        snprintf(thread->name, sizeof thread->name, "thread-%d", i);
    }
    for (int i = 0; i + 1 < BALLS; i++) {
        Joint *stop = &linkage->joints[linkage->joint_count++];
        *stop = (Joint){
            .kind = JOINT_STOP,
            .body_a = i,
            .body_b = i + 1,
            .stop = {.is_disc = true, .radius_a = BALL, .radius_b = BALL},
        };
        snprintf(stop->name, sizeof stop->name, "stop-%d", i);
    }
    return scenario;
}

// The same from the balls' angles alone, by the classical method of order 4; steps end where
// contacts begin and end.
typedef struct Swing {
    long double angle[BALLS];
    long double omega[BALLS];
} Swing;

// Accelerations, and which of the pairs touch, a bit each.
static unsigned accelerate(const long double *angle, long double stiffness, long double *alpha)
{
    const long double mass = cradle_mass();
    const long double thread = THREAD;
    const long double about_pivot = mass * thread * thread + (long double)cradle_inertia();
    unsigned touching = 0;
    for (int i = 0; i < BALLS; i++) {
        alpha[i] = -mass * (long double)GRAVITY * thread * sinl(angle[i]) / about_pivot;
    }
    for (int i = 0; i + 1 < BALLS; i++) {
        const long double dx = (long double)APART + thread * (sinl(angle[i + 1]) - sinl(angle[i]));
        const long double dy = thread * (cosl(angle[i]) - cosl(angle[i + 1]));
        const long double distance = sqrtl(dx * dx + dy * dy);
        const long double depth = 2.0L * (long double)BALL - distance;
        if (depth > 0.0L) {
            const long double fx = stiffness * depth * dx / distance;
            const long double fy = stiffness * depth * dy / distance;
            alpha[i] -= thread * (cosl(angle[i]) * fx + sinl(angle[i]) * fy) / about_pivot;
            alpha[i + 1] +=
                thread * (cosl(angle[i + 1]) * fx + sinl(angle[i + 1]) * fy) / about_pivot;
            touching |= 1u << i;
        }
    }
    return touching;
}

static Swing step_by(const Swing *from, long double h, long double stiffness)
{
    static const long double SHARES[4] = {0.0L, 0.5L, 0.5L, 1.0L};
    static const long double WEIGHTS[4] = {1.0L / 6.0L, 1.0L / 3.0L, 1.0L / 3.0L, 1.0L / 6.0L};
    Swing to = *from;
    Swing at = *from;
    long double alpha[BALLS] = {0.0L};
    for (int stage = 0; stage < 4; stage++) {
        for (int i = 0; i < BALLS; i++) {
            at.angle[i] = from->angle[i] + SHARES[stage] * h * at.omega[i];
            at.omega[i] = from->omega[i] + SHARES[stage] * h * alpha[i];
        }
        accelerate(at.angle, stiffness, alpha);
        for (int i = 0; i < BALLS; i++) {
            to.angle[i] += WEIGHTS[stage] * h * at.omega[i];
            to.omega[i] += WEIGHTS[stage] * h * alpha[i];
        }
    }
    return to;
}

static Swing integrate(double angle, double duration, size_t steps, long double stiffness)
{
    const long double length = (long double)duration / (long double)steps;
    Swing swing = {.angle = {angle}};
    long double left = duration;
    while (left > 1e-15L) {
        long double alpha[BALLS];
        const unsigned before = accelerate(swing.angle, stiffness, alpha);
        long double h = fminl(length, left);
        Swing next = step_by(&swing, h, stiffness);
        if (accelerate(next.angle, stiffness, alpha) != before) {
            // the step is halved down to the first change, and ends behind it
            long double low = 0.0L;
            for (int i = 0; i < 50; i++) {
                const long double middle = 0.5L * (low + h);
                const Swing tried = step_by(&swing, middle, stiffness);
                const bool is_same = accelerate(tried.angle, stiffness, alpha) == before;
                low = is_same ? middle : low;
                h = is_same ? h : middle;
            }
            next = step_by(&swing, h, stiffness);
        }
        swing = next;
        left -= h;
    }
    return swing;
}

static void a_cradle_swings_as_an_independent_calculation_says(void **state)
{
    (void)state;
    // to where the last ball is at its highest, and on until it has come back and the first is
    const double durations[] = {0.51, 1.03};
    for (int i = 0; i < 2; i++) {
        const Scenario scenario = cradle(-0.5, durations[i]);
        Trajectory *trajectory = complete_run(&scenario, BACKEND_REFERENCE);
        const Swing truth = integrate(-0.5, durations[i], 100000, CRADLE_STIFFNESS);
        double worst = 0.0;
        const Motion *motions = trajectory_motion(trajectory, 100, 0);
        for (int k = 0; k < BALLS; k++) {
            worst = fmax(worst, fabs(motions[k].omega - (double)truth.omega[k]));
            worst = fmax(worst, fabs(motions[k].angle - (double)truth.angle[k]));
        }
        print_message("# %.3g s: off by %.3g, energy by %.2g J\n", durations[i], worst,
                      trajectory->energy.residual);
        assert_true(worst < 1e-8);
        // of some 0.08 J
        assert_true(fabs(trajectory->energy.residual) < 1e-11);
        // at the first passage the momentum has gone to the last ball
        assert_true(motions[i == 0 ? BALLS - 1 : 0].angle * (i == 0 ? 1.0 : -1.0) > 0.45);
        // the control: springs stiffer by a hundred thousandth
        const Swing other = integrate(-0.5, durations[i], 100000, CRADLE_STIFFNESS * (1.0 + 1e-5));
        assert_true(fabs(motions[BALLS - 1].omega - (double)other.omega[BALLS - 1]) > 1e-7);
        trajectory_destroy(trajectory);
    }
}

// Where one ball meets one ball the whole momentum goes over.
static void a_ball_gives_its_momentum_to_one_like_it(void **state)
{
    (void)state;
    Scenario scenario = cradle(0.0, 2e-3);
    Linkage *linkage = &scenario.linkage;
    scenario.gravity = scenario_downward(0.0);
    linkage->body_count = 2;
    linkage->joint_count = 0;
    linkage->joints[linkage->joint_count++] = linkage->joints[BALLS];
    linkage->bodies[0].start.velocity.x = 1.0;
    Trajectory *trajectory = complete_run(&scenario, BACKEND_REFERENCE);
    const Motion *motions = trajectory_motion(trajectory, 100, 0);
    assert_int_equal(trajectory->joints[0].impacts, 1);
    // half a swing of the reduced mass on the spring
    const double frequency = sqrt(2.0 * CRADLE_STIFFNESS / cradle_mass());
    assert_close(trajectory->joints[0].spikes[0].duration_s, M_PI / frequency, 1e-10);
    assert_close(trajectory->joints[0].penetration_max.value, 1.0 / frequency, 1e-10);
    assert_near(motions[0].velocity.x, 0.0, 1e-11);
    assert_near(motions[1].velocity.x, 1.0, 1e-11);
    trajectory_destroy(trajectory);
}

// Spinning discs that rub on each other, on a floor and on a lever that turns: momentum about the
// ground's origin without gravity, and energy.
static void what_rubs_and_stops_keeps_energy_and_momentum(void **state)
{
    (void)state;
    Scenario scenario = cradle(0.0, 0.02);
    Linkage *linkage = &scenario.linkage;
    scenario.gravity = scenario_downward(0.0);
    scenario.contact.stiffness = 1e9;
    scenario.contact.friction = 0.3;
    scenario.contact.damping = DAMPING_EXACT;
    scenario.contact.restitution = 0.7;
    linkage->body_count = 4;
    linkage->joints[0] = linkage->joints[BALLS];
    linkage->joints[1] = linkage->joints[BALLS + 1];
    // a wall that the fourth carries at the end of an arm, which follows the first
    linkage->joints[2] = (Joint){
        .name = "wall",
        .kind = JOINT_STOP,
        .body_a = 3,
        .body_b = 0,
        .anchor_a = {0.17, 0.0},
        .direction = 0.2,
        .stop = {.radius_b = BALL},
    };
    linkage->joint_count = 3;
    linkage->bodies[0].start.velocity = (Vec2){3.0, 0.3};
    linkage->bodies[0].start.omega = 200.0;
    linkage->bodies[1].start.omega = -50.0;
    linkage->bodies[2].start.omega = -30.0;
    linkage->bodies[3].start.position = (Vec2){-0.2, 0.0};
    linkage->bodies[3].start.velocity = (Vec2){6.0, 0.0};
    linkage->bodies[3].start.omega = -10.0;
    Trajectory *trajectory = complete_run(&scenario, BACKEND_REFERENCE);
    const Energy *energy = &trajectory->energy;
    print_message("# %zu, %zu, %zu contacts, lost %.3g J, sliding %.3g J, residual %.2g J\n",
                  trajectory->joints[0].impacts, trajectory->joints[1].impacts,
                  trajectory->joints[2].impacts, energy->dissipated, energy->friction,
                  energy->residual);
    double momentum[2][3] = {{0.0}};
    for (int end = 0; end < 2; end++) {
        const Motion *motions = trajectory_motion(trajectory, end == 0 ? 0 : 100, 0);
        for (int i = 0; i < 4; i++) {
            const double mass = linkage->bodies[i].mass;
            momentum[end][0] += mass * motions[i].velocity.x;
            momentum[end][1] += mass * motions[i].velocity.y;
            momentum[end][2] += mass * vec2_cross(motions[i].position, motions[i].velocity) +
                                linkage->bodies[i].inertia * motions[i].omega;
        }
    }
    for (int i = 0; i < 3; i++) {
        assert_true(trajectory->joints[i].impacts > 0);
        assert_near(momentum[1][i], momentum[0][i], 1e-12);
    }
    assert_true(energy->friction > 1e-3 && energy->dissipated > 1e-3);
    assert_true(fabs(energy->residual) < 1e-10 * energy->friction);
    trajectory_destroy(trajectory);
    // the control: the first body would go on through all of them
    for (size_t j = 0; j < 3; j++) {
        linkage->joints[j].anchor_a.y += 10.0;
    }
    linkage->joints[2].anchor_a.x = -10.0;
    trajectory = complete_run(&scenario, BACKEND_REFERENCE);
    assert_near(trajectory_motion(trajectory, 100, 0)->velocity.x, 3.0, 0.0);
    trajectory_destroy(trajectory);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_ball_on_a_stiff_floor_bounces_as_on_a_rigid_one),
        cmocka_unit_test(a_ball_creeps_into_a_strongly_damped_floor),
        cmocka_unit_test(a_cradle_swings_as_an_independent_calculation_says),
        cmocka_unit_test(a_ball_gives_its_momentum_to_one_like_it),
        cmocka_unit_test(what_rubs_and_stops_keeps_energy_and_momentum),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
