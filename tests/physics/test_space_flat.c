// Does a linkage in space that never leaves the plane move by the equations of the plane, and only
// such a one?
//
// The truth are the equations in space, which a pull across the plane of 1e-30 m/s^2 asks for: it
// moves nothing, but is no part of the plane. Random four-bars and chains, of hinges and pins.
// Controls: what tilts a pin or lifts a body must be seen, and must not be left to the plane.
#include "complete_run.h"
#include "load_case.h"
#include "mechanism.h"

#include "base/lcg.h"
#include "model/space.h"
#include "model/space_flat.h"

#include <stdio.h>
#include <string.h>

static const double PULL = 1e-30; // m/s^2

enum { FOUR_BARS = 6, CHAINS = 4, LINKS = 7 };

static double draw_between(uint64_t *seed, double low, double high)
{
    return low + 0.5 * (1.0 + lcg_draw(seed)) * (high - low);
}

static bool draw_chance(uint64_t *seed)
{
    return lcg_draw(seed) > 0.0;
}

// A four-bar with play in some joints. With one loose joint its bodies are held, and have offsets
// and products of inertia that do not matter; with more the coupler floats.
static Scenario random_four_bar(unsigned number)
{
    static const char *const JOINTS[3] = {"crank-coupler", "coupler-follower", "follower-ground"};
    uint64_t seed = lcg_stirred(number);
    char texts[6][128];
    const char *overrides[6];
    size_t count = 0;
    const size_t loose = 1 + number % 3;
    for (size_t i = 0; i < loose; i++) {
        snprintf(texts[count], sizeof texts[count],
                 "joints.%s={radial-clearance: %.3f um, width: %.3f mm}", JOINTS[i],
                 draw_between(&seed, 5.0, 80.0), draw_between(&seed, 5.0, 20.0));
        overrides[count] = texts[count];
        count++;
    }
    snprintf(texts[count], sizeof texts[count], "drive.speed=%.3f rpm",
             draw_between(&seed, 300.0, 1500.0));
    overrides[count] = texts[count];
    count++;
    snprintf(texts[count], sizeof texts[count], "contact.friction=%.3f",
             draw_chance(&seed) ? 0.0 : draw_between(&seed, 0.01, 0.2));
    overrides[count] = texts[count];
    count++;
    overrides[count++] = "space=spatial";
    Scenario scenario = load("cases/paper/impact-k66.yaml", overrides, count);
    scenario.run.revolutions = 0.08;
    scenario.run.samples = 1000;
    if (loose == 1) {
        for (size_t i = 0; i < scenario.linkage.body_count; i++) {
            Body *body = &scenario.linkage.bodies[i];
            body->space.height = draw_between(&seed, -0.02, 0.02);
            body->space.product_xz = 0.05 * body->inertia * lcg_draw(&seed);
        }
        scenario.linkage.joints[1].space.height = 0.01;
    }
    return scenario;
}

// A chain of hinges and pins, each link with a speed of its own.
static Scenario random_chain(unsigned number)
{
    uint64_t seed = lcg_stirred(100 + number);
    Scenario scenario = scenario_default();
    scenario.linkage = mechanism_chain(LINKS, 0.1, 0.1);
    scenario = kept_instead(&scenario);
    scenario.linkage.is_spatial = true;
    double end = 0.0;
    for (size_t i = 0; i < LINKS; i++) {
        Body *body = &scenario.linkage.bodies[i];
        Joint *joint = &scenario.linkage.joints[i];
        body->space.height = joint->space.height = 0.03;
        body->start.velocity.y = end + 0.03 * lcg_draw(&seed);
        body->start.omega = (body->start.velocity.y - end) / 0.05;
        if (draw_chance(&seed)) {
            joint->kind = JOINT_CLEARANCE;
            joint->clearance =
                (Clearance){.hole_radius = 5.01e-3, .pin_radius = 5e-3, .width = 0.02};
            joint->space.axial_clearance = draw_chance(&seed) ? 1e-4 : 0.0;
            body->start.omega += 0.3 * lcg_draw(&seed);
        }
        end = body->start.velocity.y + 0.05 * body->start.omega;
    }
    space_complete(&scenario.linkage);
    scenario.contact.stiffness = 6.6e9;
    scenario.contact.exponent = 1.5;
    scenario.run.duration = 4e-3;
    scenario.run.samples = 100;
    return scenario;
}

static Scenario random_scenario(unsigned number)
{
    return number < FOUR_BARS ? random_four_bar(number) : random_chain(number - FOUR_BARS);
}

// The largest difference of position and speed of any body in space, the first over a reach, the
// second over the largest of the truth.
static double apart(const Trajectory *run, const Trajectory *truth)
{
    double largest = 0.0;
    for (size_t i = 0; i < truth->body_count; i++) {
        double fastest = 1e-30;
        double difference = 0.0;
        for (size_t k = 0; k < truth->sample_count; k++) {
            const SpaceMotion *a = trajectory_space_motion(run, k, i);
            const SpaceMotion *b = trajectory_space_motion(truth, k, i);
            const double reach = truth->reach[i];
            const Vec3 turned = quat_turn_between(a->turn, b->turn);
            fastest = fmax(fastest, vec3_length(b->velocity) + reach * vec3_length(b->omega));
            difference = fmax(difference, vec3_length(vec3_sub(a->velocity, b->velocity)) +
                                              reach * vec3_length(vec3_sub(a->omega, b->omega)));
            largest = fmax(largest, vec3_length(vec3_sub(a->position, b->position)) / reach +
                                        vec3_length(turned));
        }
        largest = fmax(largest, difference / fastest);
    }
    return largest;
}

// What is said of joints: forces over the largest of any joint, and places of pins in their play.
static void joints_apart(const Trajectory *run, const Trajectory *truth, double *forces,
                         double *places)
{
    double largest = 0.0;
    double strongest = 1e-30;
    *places = 0.0;
    for (size_t i = 0; i < truth->joint_count * truth->sample_count; i++) {
        const SpaceJointState *a = &run->space_states[i];
        const SpaceJointState *b = &truth->space_states[i];
        const double play =
            fmax(1e-6, linkage_radial_clearance(&truth->linkage.joints[i % truth->joint_count]));
        strongest = fmax(strongest, truth->states[i].force);
        largest = fmax(largest, fabs(run->states[i].force - truth->states[i].force));
        largest = fmax(largest, vec3_length(vec3_sub(a->force_on_b, b->force_on_b)));
        for (int end = 0; end < 2; end++) {
            largest = fmax(largest, fabs(a->end_forces[end] - b->end_forces[end]));
            *places = fmax(*places, fabs(a->end_gaps[end] - b->end_gaps[end]) / play);
            *places = fmax(*places, vec3_length(vec3_sub(a->ends[end], b->ends[end])) / play);
        }
        *places = fmax(*places, vec3_length(vec3_sub(a->offset, b->offset)) / play);
        *places = fmax(*places, fabs(a->tilt - b->tilt));
    }
    *forces = largest / strongest;
}

static void random_linkages_move_as_the_equations_in_space_say(void **state)
{
    (void)state;
    size_t impacts = 0;
    for (unsigned number = 0; number < FOUR_BARS + CHAINS; number++) {
        Scenario scenario = random_scenario(number);
        scenario.reference.tolerance = 1e-12;
        assert_true(space_flat_is(&scenario));
        Trajectory *run = complete_run(&scenario, BACKEND_REFERENCE);
        scenario.gravity.z = PULL;
        assert_false(space_flat_is(&scenario));
        Trajectory *truth = complete_run(&scenario, BACKEND_REFERENCE);
        impacts += run_impacts(truth);
        const double motion = apart(run, truth);
        double forces;
        double places;
        joints_apart(run, truth, &forces, &places);
        // the tolerance, grown in the impacts
        if (!(motion < 1e-7 && forces < 1e-5 && places < 1e-5)) {
            fail_msg("case %u: the motion differs by %.3g, the forces by %.3g, the pins by %.3g",
                     number, motion, forces, places);
        }
        for (size_t i = 0; i < run->joint_count; i++) {
            assert_true(run->joints[i].impacts == truth->joints[i].impacts);
        }
        // it takes the steps of the plane, and has its results to the last bit; bodies beside the
        // plane reach further, and their errors are of other sizes
        scenario.gravity.z = 0.0;
        const bool is_beside = number < FOUR_BARS && number % 3 == 0;
        const Scenario flat = space_flat_scenario(&scenario);
        Trajectory *plane = complete_run(&flat, BACKEND_REFERENCE);
        assert_true(is_beside || plane->evaluations == run->evaluations);
        for (size_t i = 0; i < plane->body_count * plane->sample_count && !is_beside; i++) {
            assert_true(plane->motions[i].omega == run->motions[i].omega);
        }
        Scenario used = flat;
        scenario_free(&used);
        trajectory_destroy(plane);
        trajectory_destroy(truth);
        trajectory_destroy(run);
    }
    assert_true(impacts > 60);
}

// The control: what leaves the plane is seen by the equations in space, which it is left to.
static void what_leaves_the_plane_is_left_to_the_equations_in_space(void **state)
{
    (void)state;
    enum { WAYS = 6 };
    for (int way = 0; way < WAYS; way++) {
        Scenario scenario = random_four_bar(1); // with play at both ends of the coupler
        assert_true(space_flat_is(&scenario));
        Trajectory *flat = complete_run(&scenario, BACKEND_REFERENCE);
        Body *coupler = &scenario.linkage.bodies[1];
        switch (way) {
        case 0:
            coupler->space.height = 1e-3;
            break;
        case 1:
            coupler->space.product_xz = 5e-6;
            break;
        case 2:
            coupler->space.velocity_z = 0.1;
            break;
        case 3:
            coupler->space.omega_x = 1.0;
            break;
        case 4:
            scenario.linkage.joints[1].space.height = 2e-3;
            break;
        default:
            scenario.gravity.z = 9.8;
            break;
        }
        assert_false(space_flat_is(&scenario));
        Trajectory *run = complete_run(&scenario, BACKEND_REFERENCE);
        if (!(apart(flat, run) > 1e-5)) {
            fail_msg("way %d: it differs by %.3g", way, apart(flat, run));
        }
        trajectory_destroy(run);
        trajectory_destroy(flat);
    }
}

// Axes elsewhere, ends that do not touch alike, and what the plane alone has.
static void other_linkages_are_not_flat(void **state)
{
    (void)state;
    Scenario scenario = random_four_bar(0);
    Linkage *linkage = &scenario.linkage;
    assert_true(space_flat_is(&scenario));
    linkage->is_spatial = false;
    assert_false(space_flat_is(&scenario));
    linkage->is_spatial = true;
    linkage->joints[2].space.axis = (Vec3){0.0, 0.6, 0.8};
    assert_false(space_flat_is(&scenario));
    linkage->joints[2].space.axis = (Vec3){0.0, 0.0, 1.0};
    linkage->joints[1].contacts[0].is_touching = true;
    assert_false(space_flat_is(&scenario));
    linkage->joints[1].contacts[1].is_touching = true;
    assert_true(space_flat_is(&scenario));
    linkage->joints[1].contacts[2].is_touching = true;
    assert_false(space_flat_is(&scenario));
    linkage->joints[1].contacts[2].is_touching = false;
    // a body that is held and starts elsewhere is turned about z
    linkage->bodies[2].space.is_elsewhere = true;
    linkage->bodies[2].space.turn = quat_of_turn((Vec3){0.0, 0.0, 0.3});
    assert_true(space_flat_is(&scenario));
    linkage->bodies[2].space.turn = quat_of_turn((Vec3){0.1, 0.0, 0.3});
    assert_false(space_flat_is(&scenario));
}

// Three parallel cranks, of which one is redundant, and a link on a pin with play: what ODE cannot
// solve is refused with the words of space. The control: the reference, which chooses rows.
static void redundant_joints_are_refused(void **state)
{
    (void)state;
    const Scenario parallelogram = mechanism_parallelogram();
    Scenario scenario = kept_copy(&parallelogram);
    Linkage *linkage = &scenario.linkage;
    linkage->is_spatial = true;
    Joint *hung = &linkage->joints[linkage->joint_count++];
    *hung = (Joint){.name = "hung", .kind = JOINT_CLEARANCE, .body_a = LINKAGE_GROUND};
    hung->body_b = (int)linkage->body_count;
    hung->clearance = (Clearance){.hole_radius = 5.05e-3, .pin_radius = 5e-3, .width = 0.02};
    linkage->bodies[linkage->body_count++] =
        (Body){.name = "link", .mass = 0.1, .inertia = 1e-4, .start.velocity = {0.1, 0.2}};
    for (size_t i = 0; i < linkage->joint_count; i++) {
        linkage->joints[i].space.axis = (Vec3){0.0, 0.0, 1.0};
    }
    space_complete(linkage);
    scenario.contact.stiffness = 6.6e9;
    scenario.contact.exponent = 1.5;
    scenario.ode.stepping = ODE_STAGGERED;
    scenario.ode.map = ODE_MAP_IMPULSE;
    scenario.run.revolutions = 0.02;
    scenario.run.samples = 500;
    scenario.run.step = 1e-5;
    assert_false(space_flat_is(&scenario));
    const RunWatch nobody = {NULL, NULL};
    Trajectory *run = run_scenario(&scenario, registry_solver(BACKEND_ODE), nobody);
    assert_false(run->is_complete);
    assert_non_null(strstr(run->message, "the points of the ideal joints depend on each other"));
    trajectory_destroy(run);
    // the reference chooses rows
    Trajectory *control = complete_run(&scenario, BACKEND_REFERENCE);
    assert_true(run_impacts(control) > 0);
    trajectory_destroy(control);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(random_linkages_move_as_the_equations_in_space_say),
        cmocka_unit_test(what_leaves_the_plane_is_left_to_the_equations_in_space),
        cmocka_unit_test(other_linkages_are_not_flat),
        cmocka_unit_test(redundant_joints_are_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
