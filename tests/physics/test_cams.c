// Does a cam by its profile move its follower as what it stands for?
//
// An eccentric disc of radius R and eccentricity e is, as a profile about its pivot,
//     r = e cos t + sqrt(R^2 - e^2 sin^2 t)
// so that a roller on it, or a flat, moves as on the disc itself, which shares nothing with it but
// the law. A flat of mass m on it rises by e sin(w t): where its spring presses with F at the top
// it stays on while m e w^2 < F.
#include "complete_run.h"
#include "kept.h"

enum { CAM, FOLLOWER, POINTS = 360 };

static const double ECCENTRICITY = 5e-3; // m
static const double DISC = 20e-3;        // m
static const double ROLLER = 8e-3;       // m
static const double MASS = 0.2;          // kg, of the follower
static const double RATE = 2000.0;       // N/m
static const double PRELOAD = 20.0;      // N, at the lowest

static Profile *eccentric_profile(void)
{
    static Profile profile;
    Err err = {ERR_NONE, ""};
    profile.count = POINTS;
    for (size_t i = 0; i < POINTS; i++) {
        const double t = 2.0 * M_PI * (double)i / POINTS;
        const double side = ECCENTRICITY * sin(t);
        profile.angles[i] = t;
        profile.radii[i] = ECCENTRICITY * cos(t) + sqrt(DISC * DISC - side * side);
    }
    assert_true(profile_settle(&profile, &err));
    return &profile;
}

typedef struct Ride {
    bool is_flat;
    bool is_disc; // what it stands for
    double rpm;
} Ride;

static Stop stop_of(const Ride *ride, const Profile *profile)
{
    if (!ride->is_disc) {
        return (Stop){.cam = 1,
                      .radius_a = profile->reach,
                      .hump = profile->least_hump,
                      .radius_b = ride->is_flat ? 0.0 : ROLLER,
                      .is_flat = ride->is_flat,
                      .facing = -0.5 * M_PI};
    }
    return ride->is_flat ? (Stop){.radius_b = DISC}
                         : (Stop){.is_disc = true, .radius_a = DISC, .radius_b = ROLLER};
}

// The cam turns about the origin, its eccentricity along x at time zero; the follower slides on the
// y axis, and starts where the two touch, at the speed there.
static Scenario ride_scenario(const Ride *ride, const Profile *profile)
{
    Scenario scenario = kept_default();
    Linkage *linkage = &scenario.linkage;
    const double reach = DISC + ROLLER;
    const double start = ride->is_flat ? DISC : sqrt(reach * reach - ECCENTRICITY * ECCENTRICITY);
    const double lowest = (ride->is_flat ? DISC : reach) - ECCENTRICITY;
    const double top = 0.2;
    scenario.gravity = scenario_downward(0.0);
    scenario.contact.damping = DAMPING_HUNT_CROSSLEY;
    scenario.contact.stiffness = 1e8;
    scenario.contact.exponent = 1.0;
    scenario.contact.restitution = 0.5;
    linkage->driver = (Driver){.is_present = true, .joint = 0, .speed = ride->rpm * M_PI / 30.0};
    linkage->body_count = 2;
    linkage->bodies[CAM] = (Body){.name = "cam", .mass = 1.0, .inertia = 5e-4};
    linkage->bodies[CAM].start.omega = linkage->driver.speed;
    linkage->bodies[FOLLOWER] = (Body){.name = "follower", .mass = MASS, .inertia = 1e-4};
    linkage->bodies[FOLLOWER].start.position.y = start;
    linkage->bodies[FOLLOWER].start.velocity.y = ECCENTRICITY * linkage->driver.speed;
    linkage->joint_count = 3;
    linkage->joints[0] = (Joint){.name = "pivot", .body_a = LINKAGE_GROUND, .body_b = CAM};
    linkage->joints[1] = (Joint){.name = "guide",
                                 .kind = JOINT_PRISMATIC,
                                 .body_a = LINKAGE_GROUND,
                                 .body_b = FOLLOWER,
                                 .direction = 0.5 * M_PI};
    const bool is_turned_round = ride->is_flat && ride->is_disc;
    linkage->joints[2] = (Joint){
        .name = "ride",
        .kind = JOINT_STOP,
        .body_a = is_turned_round ? FOLLOWER : CAM,
        .body_b = is_turned_round ? CAM : FOLLOWER,
        .anchor_a = {ride->is_disc && !is_turned_round ? ECCENTRICITY : 0.0, 0.0},
        .anchor_b = {is_turned_round ? ECCENTRICITY : 0.0, 0.0},
        .direction = is_turned_round ? -0.5 * M_PI : 0.0,
        .stop = stop_of(ride, profile),
    };
    linkage->profile_count = 1;
    linkage->profiles = (Profile *)profile;
    linkage->spring_count = 1;
    linkage->springs[0] = (Spring){.name = "coil",
                                   .body_a = LINKAGE_GROUND,
                                   .body_b = FOLLOWER,
                                   .anchor_a = {0.0, top},
                                   .stiffness = RATE,
                                   .length = top - lowest + PRELOAD / RATE};
    scenario.run.duration = 3.0 * 2.0 * M_PI / linkage->driver.speed;
    scenario.run.samples = 1000;
    return scenario;
}

// The largest differences of the follower's position, m, and of the force, N.
static void compare(const Trajectory *one, const Trajectory *other, double *apart, double *force)
{
    *apart = *force = 0.0;
    for (size_t k = 0; k < one->sample_count; k++) {
        const Vec2 by = vec2_sub(trajectory_motion(one, k, FOLLOWER)->position,
                                 trajectory_motion(other, k, FOLLOWER)->position);
        *apart = fmax(*apart, vec2_length(by));
        *force = fmax(*force, fabs(trajectory_state(one, k, 2)->force -
                                   trajectory_state(other, k, 2)->force));
    }
}

static void an_eccentric_profile_is_the_disc(void **state)
{
    (void)state;
    const Profile *profile = eccentric_profile();
    for (int i = 0; i < 4; i++) {
        const bool is_flat = i % 2 == 1;
        const BackendKind backend = i < 2 ? BACKEND_REFERENCE : BACKEND_ODE;
        Trajectory *runs[2];
        for (int k = 0; k < 2; k++) {
            const Ride ride = {.is_flat = is_flat, .is_disc = k == 1, .rpm = 1500.0};
            Scenario scenario = ride_scenario(&ride, profile);
            scenario.run.step = 1e-5;
            scenario.ode.stepping = ODE_STAGGERED;
            scenario.ode.map = ODE_MAP_IMPULSE;
            runs[k] = complete_run(&scenario, backend);
        }
        double apart;
        double force;
        compare(runs[0], runs[1], &apart, &force);
        print_message("# %s, %s: %.3g m and %.3g N of %.4g N apart\n", is_flat ? "flat" : "roller",
                      backend == BACKEND_ODE ? "ode" : "reference", apart, force,
                      runs[0]->joints[2].force_max.value);
        if (backend == BACKEND_REFERENCE) {
            // a spline through 360 points is off by some 1e-15 m, the rounding of both motions is
            // as much; the wall's stiffness makes a force of it
            assert_true(apart < 1e-12 && force < 1e8 * 1e-14);
        } else {
            // the disc is a circle in ODE's step, a profile a line that bends
            assert_true(apart < 1e-12);
        }
        trajectory_destroy(runs[0]);
        trajectory_destroy(runs[1]);
    }
}

static void a_flat_stays_on_up_to_the_speed_of_the_closed_form(void **state)
{
    (void)state;
    const Profile *profile = eccentric_profile();
    const double limit = sqrt((PRELOAD + 2.0 * ECCENTRICITY * RATE) / (MASS * ECCENTRICITY));
    assert_near(limit * 30.0 / M_PI, 1910.0, 0.5);
    static const double SPEEDS[] = {1800.0, 1950.0};
    for (int i = 0; i < 2; i++) {
        const Ride ride = {.is_flat = true, .rpm = SPEEDS[i]};
        Scenario scenario = ride_scenario(&ride, profile);
        Trajectory *run = complete_run(&scenario, BACKEND_REFERENCE);
        double highest = -INFINITY;
        const double omega = scenario.linkage.driver.speed;
        double off = 0.0;
        for (size_t k = 1; k < run->sample_count; k++) {
            highest = fmax(highest, trajectory_state(run, k, 2)->gap);
            // while it stays on it rises with the eccentricity, less what the flat gives way
            const double rises = DISC + ECCENTRICITY * sin(omega * run->times[k]);
            off = fmax(off, fabs(trajectory_motion(run, k, FOLLOWER)->position.y - rises));
        }
        print_message("# %.0f rpm: gap up to %.3g m, %.3g m off the cam's lift\n", SPEEDS[i],
                      highest, off);
        assert_true(i == 0 ? highest < 0.0 && off < 2e-6 : highest > 1e-6);
        trajectory_destroy(run);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(an_eccentric_profile_is_the_disc),
        cmocka_unit_test(a_flat_stays_on_up_to_the_speed_of_the_closed_form),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
