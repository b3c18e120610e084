// Do a rack and its pinion rattle as the closed form says?
//
// A rack of mass m along n, its pinion of inertia I and radius r, both free: with the rack's way x
// and the pinion's turn theta the teeth are at q = r theta - x from the middle of a gap of 2 g.
// Without a loss, between flanks that are springs k:
//     mu = 1 / (1 / m + r^2 / I),    P = m x' + I theta' / r  stays as it is
//     q is free at +-v, or a half sine in a flank of depth v sqrt(mu / k) and pi sqrt(mu / k) long
//     x = x_0 + (P t - I / r^2 (q - q_0)) / (m + I / r^2)
#include "complete_run.h"
#include "kept.h"

enum { RACK, PINION };

typedef struct Rattle {
    double mass;    // kg
    double inertia; // kg m^2
    double radius;  // m, negative where the pinion is to the right of the line
    double gap;     // m, from flank to flank
    double stiffness;
    double along; // rad
    double spin;  // rad/s, of the pinion at time zero
    double speed; // m/s, of the rack
} Rattle;

static const Rattle RATTLE = {
    .mass = 2.0,
    .inertia = 6e-5,
    .radius = 0.02,
    .gap = 1e-4,
    .stiffness = 1e7,
    .along = 0.4,
    .spin = 20.0,
    .speed = -0.1,
};

// The way q between the teeth, from the middle of the gap at time zero.
static double way_of(const Rattle *rattle, double time)
{
    const double reduced =
        1.0 / (1.0 / rattle->mass + rattle->radius * rattle->radius / rattle->inertia);
    const double start = rattle->radius * rattle->spin - rattle->speed;
    const double rate = sqrt(rattle->stiffness / reduced);
    const double half = 0.5 * rattle->gap;
    const double v = fabs(start);
    // from the middle to a flank, into it and back to the middle
    const double crossing = half / v;
    const double cycle = 2.0 * crossing + M_PI / rate;
    const double turns = floor(time / cycle);
    const double since = time - turns * cycle;
    const double side = fmod(turns, 2.0) == 0.0 ? copysign(1.0, start) : -copysign(1.0, start);
    const double in_flank = since - crossing;
    const double way = in_flank < 0.0           ? v * since
                       : in_flank * rate > M_PI ? half - v * (in_flank - M_PI / rate)
                                                : half + v / rate * sin(rate * in_flank);
    return side * way;
}

static Scenario rattle_scenario(const Rattle *rattle)
{
    Scenario scenario = kept_default();
    Linkage *linkage = &scenario.linkage;
    const Vec2 along = vec2_rotate(rattle->along, (Vec2){1.0, 0.0});
    const Vec2 pivot = vec2_scale(rattle->radius, vec2_perp(along));
    scenario.gravity = scenario_downward(0.0);
    scenario.contact.damping = DAMPING_HUNT_CROSSLEY;
    scenario.run.duration = 0.05;
    scenario.run.samples = 400;
    linkage->body_count = 2;
    linkage->bodies[RACK] = (Body){.name = "rack", .mass = rattle->mass, .inertia = 1.0};
    linkage->bodies[RACK].start.velocity = vec2_scale(rattle->speed, along);
    linkage->bodies[PINION] = (Body){.name = "pinion", .mass = 0.3, .inertia = rattle->inertia};
    linkage->bodies[PINION].start = (Motion){.position = pivot, .omega = rattle->spin};
    linkage->joint_count = 3;
    linkage->joints[0] = (Joint){.name = "line",
                                 .kind = JOINT_PRISMATIC,
                                 .body_a = LINKAGE_GROUND,
                                 .body_b = RACK,
                                 .direction = rattle->along};
    linkage->joints[1] =
        (Joint){.name = "pivot", .body_a = LINKAGE_GROUND, .body_b = PINION, .anchor_a = pivot};
    linkage->joints[2] = (Joint){
        .name = "mesh",
        .kind = JOINT_RACK,
        .body_a = RACK,
        .body_b = PINION,
        .direction = rattle->along,
        .gear = {.pivots = {0, 1}, .radius_a = INFINITY, .radius_b = rattle->radius},
        .limits = {.kind = LIMIT_BACKLASH, .backlash = rattle->gap},
        .contact = {.stiffness = rattle->stiffness,
                    .exponent = 1.0,
                    .has_restitution = true,
                    .restitution = 1.0},
    };
    return scenario;
}

typedef struct Off {
    double rack;   // m
    double pinion; // m, at its pitch circle
} Off;

// How far a run is off the closed form of a rattle.
static Off off_closed_form(const Rattle *rattle, const Trajectory *run)
{
    const Vec2 along = vec2_rotate(rattle->along, (Vec2){1.0, 0.0});
    const double turning = rattle->inertia / (rattle->radius * rattle->radius);
    const double momentum = rattle->mass * rattle->speed + turning * rattle->radius * rattle->spin;
    Off off = {0.0, 0.0};
    for (size_t k = 0; k < run->sample_count; k++) {
        const double way = way_of(rattle, run->times[k]);
        const double x = (momentum * run->times[k] - turning * way) / (rattle->mass + turning);
        const Motion *rack = trajectory_motion(run, k, RACK);
        const Motion *pinion = trajectory_motion(run, k, PINION);
        off.rack = fmax(off.rack, fabs(vec2_dot(along, rack->position) - x));
        off.pinion = fmax(off.pinion, fabs(rattle->radius * pinion->angle - x - way));
    }
    return off;
}

static void a_free_rack_rattles_as_its_closed_form(void **state)
{
    (void)state;
    for (int i = 0; i < 2; i++) {
        Rattle rattle = RATTLE;
        rattle.radius *= i == 0 ? 1.0 : -1.0;
        const Scenario scenario = rattle_scenario(&rattle);
        Trajectory *run = complete_run(&scenario, BACKEND_REFERENCE);
        const Off off = off_closed_form(&rattle, run);
        print_message("# off by %.3g m and %.3g m, %zu impacts\n", off.rack, off.pinion,
                      run->joints[2].impacts);
        // some rounding of a second of 0.5 m/s, which each impact hands on
        assert_true(off.rack < 1e-13 && off.pinion < 1e-12);
        assert_true(run->joints[2].impacts > 60);
        // what holds the rack across is its guide: teeth push along the line alone
        assert_near(run->joints[0].force_max.value, 0.0, 1e-9);
        // the control: a pinion that is a thousandth heavier
        Rattle heavier = rattle;
        heavier.inertia *= 1.001;
        const Off other = off_closed_form(&heavier, run);
        assert_true(other.rack > 1e-6 && other.pinion > 1e-6);
        trajectory_destroy(run);
    }
}

// A step four times finer is sixteen times closer.
static void ode_follows_it_at_second_order(void **state)
{
    (void)state;
    Scenario scenario = rattle_scenario(&RATTLE);
    scenario.run.duration = 0.01;
    scenario.run.samples = 100;
    double errors[2];
    for (int i = 0; i < 2; i++) {
        scenario.run.step = i == 0 ? 4e-6 : 1e-6;
        scenario.ode.stepping = ODE_STAGGERED;
        scenario.ode.map = ODE_MAP_MIDPOINT;
        Trajectory *run = complete_run(&scenario, BACKEND_ODE);
        const Off off = off_closed_form(&RATTLE, run);
        errors[i] = fmax(off.rack, off.pinion);
        trajectory_destroy(run);
    }
    print_message("# off by %.3g m and, of a fourth of the step, %.3g m\n", errors[0], errors[1]);
    assert_true(errors[1] < 1e-8);
    assert_true(errors[0] / errors[1] > 10.0);
    // the impulse way has contacts inside its steps: ten of them in one
    scenario.run.step = 1e-3;
    scenario.ode.map = ODE_MAP_IMPULSE;
    Trajectory *run = complete_run(&scenario, BACKEND_ODE);
    const Off off = off_closed_form(&RATTLE, run);
    print_message("# by impulses in steps of 1 ms %.3g m and %.3g m\n", off.rack, off.pinion);
    assert_true(fmax(off.rack, off.pinion) < 1e-9);
    trajectory_destroy(run);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_free_rack_rattles_as_its_closed_form),
        cmocka_unit_test(ode_follows_it_at_second_order),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
