// Do flanks, stops and teeth press as their laws have it, on hinges, sliders and gears?
#include "complete_run.h"
#include "kept.h"

#include <stdio.h>

static const double INERTIA = 0.01; // kg m^2

static Scenario empty(double duration_s)
{
    Scenario scenario = kept_default();
    scenario.gravity = scenario_downward(0.0);
    scenario.run.backend_count = 1;
    scenario.run.backends[0] = BACKEND_REFERENCE;
    scenario.run.duration = duration_s;
    scenario.run.samples = 200;
    scenario.contact.damping = DAMPING_NONE;
    scenario.contact.impact_speed_floor = 1e-9;
    scenario.reference.tolerance = 1e-12;
    return scenario;
}

static void add_body(Linkage *linkage, double mass, double inertia, Motion start)
{
    linkage->bodies[linkage->body_count] = (Body){.mass = mass, .inertia = inertia, .start = start};
    snprintf(linkage->bodies[linkage->body_count].name, LINKAGE_NAME_SIZE, "body%zu",
             linkage->body_count);
    linkage->body_count++;
}

static Joint *add_joint(Linkage *linkage, JointKind kind, int a, Vec2 at_a, int b, Vec2 at_b)
{
    Joint *joint = &linkage->joints[linkage->joint_count];
    *joint = (Joint){.kind = kind, .body_a = a, .anchor_a = at_a, .body_b = b, .anchor_b = at_b};
    snprintf(joint->name, LINKAGE_NAME_SIZE, "joint%zu", linkage->joint_count++);
    return joint;
}

// A rotor about the origin that turns towards a stop at 0.1 rad.
static Scenario rotor(double speed, double stiffness, double exponent, double duration_s)
{
    Scenario scenario = empty(duration_s);
    Linkage *linkage = &scenario.linkage;
    add_body(linkage, 1.0, INERTIA, (Motion){.omega = speed});
    Joint *hinge =
        add_joint(linkage, JOINT_REVOLUTE, LINKAGE_GROUND, (Vec2){0.0, 0.0}, 0, (Vec2){0.0, 0.0});
    hinge->limits = (Limits){.kind = LIMIT_STOPS, .low = -INFINITY, .high = 0.1};
    hinge->contact = (JointContact){.stiffness = stiffness, .exponent = exponent};
    return scenario;
}

// The force of a spring and a damper met at a speed, after a time.
static double spring_force(double k, double c, double mass, double speed, double time_s)
{
    const double decay = 0.5 * c / mass;
    const double wave = sqrt(k / mass - decay * decay);
    const double depth = speed / wave * exp(-decay * time_s) * sin(wave * time_s);
    const double rate = speed * exp(-decay * time_s) * cos(wave * time_s) - decay * depth;
    return k * depth + c * rate;
}

typedef struct SpringImpact {
    double duration_s;
    double peak;
    double restitution;
} SpringImpact;

// Of the solution of m x'' + c x' + k x = 0 up to where the force is gone.
static SpringImpact spring_impact(double k, double c, double mass, double speed)
{
    const double decay = 0.5 * c / mass;
    const double wave = sqrt(k / mass - decay * decay);
    double low = 0.5 * M_PI / wave * (c > 0.0 ? 0.5 : 1.0);
    double high = M_PI / wave;
    for (int i = 0; i < 80; i++) {
        const double middle = 0.5 * (low + high);
        *(spring_force(k, c, mass, speed, middle) > 0.0 ? &low : &high) = middle;
    }
    SpringImpact impact = {.duration_s = low};
    const double depth = speed / wave * exp(-decay * low) * sin(wave * low);
    impact.restitution = -(exp(-decay * low) * cos(wave * low) - decay * depth / speed);
    // the spring lags behind what it pressed: the overlap ends at the speed of then
    impact.duration_s += depth / (speed * impact.restitution);
    // of one hump the third points close in on its top
    double ends[2] = {0.0, low};
    for (int i = 0; i < 200; i++) {
        const double third = (ends[1] - ends[0]) / 3.0;
        const double left = spring_force(k, c, mass, speed, ends[0] + third);
        const double right = spring_force(k, c, mass, speed, ends[1] - third);
        ends[left < right ? 0 : 1] += left < right ? third : -third;
        impact.peak = fmax(left, right);
    }
    return impact;
}

static void a_stop_with_a_spring_and_a_damper_rebounds_as_the_closed_form(void **state)
{
    (void)state;
    static const double RATIOS[] = {0.05, 0.2, 0.45};
    for (size_t i = 0; i < sizeof RATIOS / sizeof *RATIOS; i++) {
        const double k = 1e4;
        const double speed = 3.0;
        const double c = 2.0 * RATIOS[i] * sqrt(k * INERTIA);
        const SpringImpact impact = spring_impact(k, c, INERTIA, speed);
        Scenario scenario = rotor(speed, k, 1.0, 0.05);
        scenario.linkage.joints[0].contact.viscous = c;
        Trajectory *run = complete_run(&scenario, BACKEND_REFERENCE);
        const Spike *spike = &run->joints[0].spikes[0];
        const double after = -trajectory_motion(run, run->sample_count - 1, 0)->omega / speed;
        assert_int_equal(run->joints[0].impacts, 1);
        assert_near(after, impact.restitution, 1e-10);
        assert_near(spike->onset_s, 0.1 / speed, 1e-12);
        assert_near(spike->duration_s / impact.duration_s, 1.0, 1e-9);
        assert_near(run->joints[0].force_max.value / impact.peak, 1.0, 1e-9);
        assert_near(run->joints[0].impulse / (INERTIA * speed * (1.0 + impact.restitution)), 1.0,
                    1e-9);
        assert_near(run->energy.residual, 0.0, 1e-11 * INERTIA * speed * speed);
        // the control: a damper a ten thousandth stronger
        const SpringImpact other = spring_impact(k, 1.0001 * c, INERTIA, speed);
        assert_true(fabs(after - other.restitution) > 1e-6);
        trajectory_destroy(run);
    }
}

static void a_hysteretic_stop_gives_back_the_restitution_asked_for(void **state)
{
    (void)state;
    for (int i = 0; i < 4; i++) {
        const double e = 0.2 + 0.25 * i;
        const double n = 1.0 + 0.5 * (i % 3);
        Scenario scenario = rotor(2.0, 1e4, n, 0.15);
        scenario.contact.damping = DAMPING_EXACT;
        scenario.linkage.joints[0].contact.has_restitution = true;
        scenario.linkage.joints[0].contact.restitution = e;
        Trajectory *run = complete_run(&scenario, BACKEND_REFERENCE);
        const double after = -trajectory_motion(run, run->sample_count - 1, 0)->omega / 2.0;
        assert_near(after, e, 1e-9);
        trajectory_destroy(run);
        // the control: a law that promises the restitution and gives another
        scenario.contact.damping = DAMPING_LANKARANI_NIKRAVESH;
        run = complete_run(&scenario, BACKEND_REFERENCE);
        const double other = -trajectory_motion(run, run->sample_count - 1, 0)->omega / 2.0;
        assert_true(i == 3 || fabs(other - e) > 1e-3);
        trajectory_destroy(run);
    }
}

// An inertia between two flanks: a flight of gap / v and half an oscillation, again and again.
static void an_inertia_goes_to_and_fro_in_a_gap_with_the_period_of_the_closed_form(void **state)
{
    (void)state;
    const double gap = 0.02;
    const double speed = 1.5;
    const double k = 2e4;
    const double period_s = 2.0 * (gap / speed + M_PI * sqrt(INERTIA / k));
    Scenario scenario = rotor(speed, k, 1.0, 50.25 * period_s);
    Joint *hinge = &scenario.linkage.joints[0];
    hinge->limits = (Limits){.kind = LIMIT_BACKLASH, .backlash = gap, .middle = 7.0};
    scenario.linkage.bodies[0].start.angle = 7.0;
    hinge->held_angle = 7.0;
    Trajectory *run = complete_run(&scenario, BACKEND_REFERENCE);
    assert_int_equal(run->joints[0].impacts, 101);
    for (size_t k_sample = 0; k_sample < run->sample_count; k_sample++) {
        // where it is by the closed form
        const double phase = fmod(run->times[k_sample] + 0.5 * gap / speed, period_s);
        const double half = 0.5 * period_s;
        const double since = fmod(phase, half);
        const double sign = phase < half ? 1.0 : -1.0;
        const double wave = sqrt(k / INERTIA);
        const double at = since < gap / speed
                              ? speed * since - 0.5 * gap
                              : 0.5 * gap + speed / wave * sin(wave * (since - gap / speed));
        const double seen = trajectory_motion(run, k_sample, 0)->angle - 7.0;
        assert_near(seen, sign * at, 3e-10);
        assert_near(trajectory_state(run, k_sample, 0)->tilt, seen + 7.0, 1e-14);
        assert_near(trajectory_state(run, k_sample, 0)->gap, 0.5 * gap - fabs(seen), 1e-13);
    }
    assert_near(run->energy.residual, 0.0, 1e-11);
    trajectory_destroy(run);
}

// Two gears on the ground, or on a carrier that floats freely; the first turns against the second.
static Scenario gears(double teeth_b, bool is_floating, double spin, double duration_s)
{
    Scenario scenario = empty(duration_s);
    Linkage *linkage = &scenario.linkage;
    const double distance = 0.08;
    const double gear_spin[2] = {spin, 0.0};
    for (int i = 0; i < 2; i++) {
        add_body(linkage, 0.2 + 0.8 * i, i == 0 ? 4e-5 : 9e-4,
                 (Motion){.position = {i * distance, 0.0}, .omega = gear_spin[i]});
    }
    int carrier = LINKAGE_GROUND;
    Vec2 centre = {0.0, 0.0};
    if (is_floating) {
        carrier = 2;
        centre = (Vec2){0.05, 0.01};
        add_body(linkage, 0.5, 2e-3, (Motion){.position = centre});
    }
    for (int i = 0; i < 2; i++) {
        const Vec2 at = {i * distance - centre.x, -centre.y};
        add_joint(linkage, JOINT_REVOLUTE, carrier, at, i, (Vec2){0.0, 0.0});
    }
    Joint *mesh = add_joint(linkage, JOINT_GEAR, 0, (Vec2){0.0, 0.0}, 1, (Vec2){0.0, 0.0});
    const double sum = 20.0 + teeth_b;
    mesh->gear = (Gear){
        .pivots = {0, 1},
        .teeth = {20.0, teeth_b},
        .radius_a = distance * 20.0 / sum,
        .radius_b = distance * teeth_b / sum,
    };
    // of an internal gear the first radius is negative where the second gear is round it
    mesh->limits = (Limits){.kind = LIMIT_BACKLASH, .backlash = 1e-3};
    mesh->contact = (JointContact){.stiffness = 1e9, .exponent = 1.5};
    return scenario;
}

typedef struct Sums {
    double energy;
    double linear[2];
    double angular; // about the origin
    double meshed;  // I_a w_a / r_a - I_b w_b / r_b
} Sums;

static Sums sums_of(const Scenario *scenario, const Motion *motions)
{
    const Linkage *linkage = &scenario->linkage;
    const Gear *gear = &linkage->joints[2].gear;
    Sums sums = {.energy = linkage_kinetic_energy(linkage, motions)};
    for (size_t i = 0; i < linkage->body_count; i++) {
        const Body *body = &linkage->bodies[i];
        sums.linear[0] += body->mass * motions[i].velocity.x;
        sums.linear[1] += body->mass * motions[i].velocity.y;
        sums.angular += body->inertia * motions[i].omega +
                        body->mass * vec2_cross(motions[i].position, motions[i].velocity);
    }
    sums.meshed = linkage->bodies[0].inertia * motions[0].omega / gear->radius_a -
                  linkage->bodies[1].inertia * motions[1].omega / gear->radius_b;
    return sums;
}

static void undamped_gears_keep_energy_and_momentum(void **state)
{
    (void)state;
    static const double TEETH[] = {60.0, -57.0};
    for (int i = 0; i < 4; i++) {
        const bool is_floating = i / 2 == 1;
        Scenario scenario = gears(TEETH[i % 2], is_floating, 100.0, 0.02);
        scenario.reference.tolerance = 1e-13;
        Motion start[3];
        linkage_start(&scenario.linkage, start);
        const Sums before = sums_of(&scenario, start);
        Trajectory *run = complete_run(&scenario, BACKEND_REFERENCE);
        assert_true(run->joints[2].impacts > 10);
        size_t apart = 0;
        double passed = 0.0;
        for (size_t k = 0; k < run->sample_count; k++) {
            const Sums now = sums_of(&scenario, trajectory_motion(run, k, 0));
            const bool is_apart = !trajectory_state(run, k, 2)->is_touching;
            apart += is_apart ? 1 : 0;
            if (is_apart) {
                assert_near(now.energy / before.energy, 1.0, 1e-10);
            }
            if (is_floating) {
                assert_near(now.linear[0], 0.0, 1e-12);
                assert_near(now.linear[1], 0.0, 1e-12);
                assert_near(now.angular / before.angular, 1.0, 1e-10);
            } else {
                assert_near(now.meshed / before.meshed, 1.0, 1e-10);
                passed = fmax(passed, fabs(2.0 * scenario.linkage.bodies[1].inertia *
                                           trajectory_motion(run, k, 1)->omega /
                                           scenario.linkage.joints[2].gear.radius_b));
            }
        }
        assert_true(apart > 20);
        // the control: gears that passed on the momentum with the other sign
        assert_true(is_floating || passed > 1e-3 * fabs(before.meshed));
        trajectory_destroy(run);
    }
}

// Gears that roll together for a hundred turns: the gap between the teeth is what it was.
static void teeth_are_followed_over_many_turns(void **state)
{
    (void)state;
    Scenario scenario = gears(60.0, false, 600.0, 1.0);
    scenario.linkage.bodies[1].start.omega = -200.0;
    scenario.linkage.joints[2].limits.backlash = 1e-4;
    scenario.linkage.joints[2].limits.middle = -2e-5;
    Trajectory *run = complete_run(&scenario, BACKEND_REFERENCE);
    assert_int_equal(run->joints[2].impacts, 0);
    for (size_t k = 0; k < run->sample_count; k++) {
        // 12 m have gone by, in steps that are rounded
        assert_near(trajectory_state(run, k, 2)->gap, 3e-5, 1e-14);
    }
    trajectory_destroy(run);
    // the control: a ratio that is not theirs
    scenario.linkage.bodies[1].start.omega = -200.001;
    run = complete_run(&scenario, BACKEND_REFERENCE);
    assert_true(run->joints[2].impacts > 0);
    trajectory_destroy(run);
}

// A block on its line against stops is one against a wall: the same motion as with a stop joint.
static void the_stops_of_a_slider_are_walls_across_its_line(void **state)
{
    (void)state;
    Trajectory *runs[2];
    for (int way = 0; way < 2; way++) {
        Scenario scenario = empty(0.4);
        scenario.gravity = scenario_downward(1.0);
        scenario.contact.damping = DAMPING_EXACT;
        scenario.contact.restitution = 0.7;
        scenario.contact.stiffness = 1e6;
        scenario.contact.exponent = 1.5;
        Linkage *linkage = &scenario.linkage;
        add_body(linkage, 0.4, 1e-3, (Motion){.position = {0.1, 0.2}, .velocity = {0.6, 0.8}});
        Joint *slide = add_joint(linkage, JOINT_PRISMATIC, LINKAGE_GROUND, (Vec2){0.1, 0.2}, 0,
                                 (Vec2){0.0, 0.0});
        slide->direction = atan2(0.8, 0.6);
        if (way == 0) {
            slide->limits = (Limits){.kind = LIMIT_STOPS, .low = -0.02, .high = 0.05};
        } else {
            for (int i = 0; i < 2; i++) {
                const double at = i == 0 ? -0.02 : 0.05;
                Joint *stop =
                    add_joint(linkage, JOINT_STOP, LINKAGE_GROUND,
                              (Vec2){0.1 + 0.6 * at, 0.2 + 0.8 * at}, 0, (Vec2){0.0, 0.0});
                stop->direction = slide->direction + (i == 0 ? 0.0 : M_PI);
            }
        }
        runs[way] = complete_run(&scenario, BACKEND_REFERENCE);
    }
    assert_true(runs[0]->joints[0].impacts > 2);
    for (size_t k = 0; k < runs[0]->sample_count; k++) {
        const Motion *a = trajectory_motion(runs[0], k, 0);
        const Motion *b = trajectory_motion(runs[1], k, 0);
        assert_near(a->velocity.x, b->velocity.x, 1e-9);
        assert_near(trajectory_state(runs[0], k, 0)->eccentricity.x,
                    hypot(a->position.x - 0.1, a->position.y - 0.2) *
                        (a->position.x < 0.1 ? -1.0 : 1.0),
                    1e-14);
        assert_near(trajectory_state(runs[0], k, 0)->force,
                    trajectory_state(runs[1], k, 1)->force + trajectory_state(runs[1], k, 2)->force,
                    1e-6);
    }
    for (int way = 0; way < 2; way++) {
        trajectory_destroy(runs[way]);
    }
}

// Without a gap there is a spring to both sides: an oscillator.
static void a_gap_of_zero_is_a_spring_to_both_sides(void **state)
{
    (void)state;
    const double k = 400.0;
    Scenario scenario = rotor(1.0, k, 1.0, 1.0);
    scenario.linkage.joints[0].limits = (Limits){.kind = LIMIT_BACKLASH};
    Trajectory *run = complete_run(&scenario, BACKEND_REFERENCE);
    const double wave = sqrt(k / INERTIA);
    for (size_t i = 0; i < run->sample_count; i++) {
        assert_near(trajectory_motion(run, i, 0)->omega, cos(wave * run->times[i]), 1e-9);
    }
    // it never comes off
    assert_int_equal(run->joints[0].impacts, 1);
    assert_near(run->joints[0].contact_time, 1.0, 1e-9);
    trajectory_destroy(run);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_stop_with_a_spring_and_a_damper_rebounds_as_the_closed_form),
        cmocka_unit_test(a_hysteretic_stop_gives_back_the_restitution_asked_for),
        cmocka_unit_test(an_inertia_goes_to_and_fro_in_a_gap_with_the_period_of_the_closed_form),
        cmocka_unit_test(undamped_gears_keep_energy_and_momentum),
        cmocka_unit_test(teeth_are_followed_over_many_turns),
        cmocka_unit_test(the_stops_of_a_slider_are_walls_across_its_line),
        cmocka_unit_test(a_gap_of_zero_is_a_spring_to_both_sides),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
