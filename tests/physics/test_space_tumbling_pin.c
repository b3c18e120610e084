// Does a pin of any inertia that tilts, slides, rubs and bounces in its hole move as an integration
// that shares nothing with the reference has it?
//
// The truth: the pin as a free body, quaternion and angular velocity in its own frame, Euler's
// equations by the classical method of Runge and Kutta at steps of 0.1 us; forces from the text of
// docs/space.md: at each end N = (K / 2) d^1.5 across the pin's axis, friction mu N tanh(|s| / v_s)
// at the wall, K d^1.5 along the hole at the collars. Without events: d^1.5 and its slope have
// none.
#include "space_pin.h"

#include "complete_run.h"

static const double CLEARANCE = 50e-6;
static const double AXIAL = 80e-6;
static const double STIFFNESS = 1e9; // N/m^1.5
static const double FRICTION = 0.15;
static const double SLIDING_SPEED = 0.02; // m/s
static const double GRAVITY = 9.80665;
static const double RADIUS = 5e-3 + 50e-6;      // m, of the hole
static const Vec3 OFFSET = {2e-3, -1e-3, 7e-3}; // m, from the pin's middle to the centre of mass
static const Vec3 VELOCITY = {0.02, -0.05, 0.06};
static const Vec3 SPIN = {8.0, -6.0, 20.0};

static Scenario tumbling(double friction)
{
    Scenario scenario = space_pin(CLEARANCE, AXIAL, OFFSET.z, STIFFNESS);
    scenario.gravity = scenario_downward(GRAVITY);
    scenario.contact.exponent = 1.5;
    scenario.contact.friction = friction;
    scenario.contact.friction_speed = SLIDING_SPEED;
    Linkage *linkage = &scenario.linkage;
    Body *body = &linkage->bodies[0];
    body->start.position = (Vec2){OFFSET.x, OFFSET.y};
    linkage->joints[0].anchor_b = (Vec2){-OFFSET.x, -OFFSET.y};
    body->space.inertia_x = 1.1e-4;
    body->space.inertia_y = 0.8e-4;
    body->inertia = 0.5e-4;
    body->space.product_xy = 0.1e-4;
    body->space.product_xz = -0.15e-4;
    body->space.product_yz = 0.05e-4;
    body->start.velocity = (Vec2){VELOCITY.x, VELOCITY.y};
    body->space.velocity_z = VELOCITY.z;
    body->space.omega_x = SPIN.x;
    body->space.omega_y = SPIN.y;
    body->start.omega = SPIN.z;
    scenario.run.duration = 12e-3;
    scenario.run.samples = 12;
    return scenario;
}

// x, v, q, w in the body, 13 numbers.
typedef struct Free {
    Vec3 x;
    Vec3 v;
    Quat q;
    Vec3 w;
} Free;

typedef struct Force {
    Vec3 sum;
    Vec3 moment;
} Force;

static void push(Force *force, Vec3 centre, Vec3 point, Vec3 by)
{
    force->sum = vec3_add(force->sum, by);
    force->moment = vec3_add(force->moment, vec3_cross(vec3_sub(point, centre), by));
}

static Force forces_on(const Free *at, double friction)
{
    Force force = {{0.0, -GRAVITY, 0.0}, {0.0, 0.0, 0.0}}; // 1 kg
    const Vec3 axis = quat_rotate(at->q, (Vec3){0.0, 0.0, 1.0});
    const Vec3 middle = vec3_sub(at->x, quat_rotate(at->q, OFFSET));
    const Vec3 omega = quat_rotate(at->q, at->w);
    for (int end = -1; end <= 1; end += 2) {
        const Vec3 hole = {0.0, 0.0, 0.5 * end * SPACE_PIN_WIDTH};
        const Vec3 off = vec3_across(vec3_sub(middle, hole), axis);
        const double depth = vec3_length(off) - CLEARANCE;
        if (depth > 0.0) {
            const Vec3 out = vec3_scale(1.0 / vec3_length(off), off);
            const Vec3 wall = vec3_add(hole, vec3_scale(RADIUS, out));
            const Vec3 v = vec3_add(at->v, vec3_cross(omega, vec3_sub(wall, at->x)));
            const Vec3 s = vec3_sub(v, vec3_scale(vec3_dot(v, out), out));
            const double speed = vec3_length(s);
            const double normal = 0.5 * STIFFNESS * depth * sqrt(depth);
            push(&force, at->x, wall, vec3_scale(-normal, out));
            push(&force, at->x, wall,
                 vec3_scale(-friction * normal * tanh(speed / SLIDING_SPEED) / speed, s));
        }
    }
    const double beyond = fabs(middle.z) - AXIAL;
    if (beyond > 0.0) {
        const double normal = STIFFNESS * beyond * sqrt(beyond);
        push(&force, at->x, middle, (Vec3){0.0, 0.0, middle.z > 0.0 ? -normal : normal});
    }
    return force;
}

static Free rates_of(const Body *body, const Free *at, double friction)
{
    const Force force = forces_on(at, friction);
    const Mat3 inertia = space_inertia(body);
    const Mat3 inverse = mat3_inverse(&inertia);
    const Vec3 own = quat_rotate_back(at->q, force.moment);
    const Vec3 gyration = vec3_cross(at->w, mat3_apply(&inertia, at->w));
    const Quat turning = quat_product(at->q, (Quat){0.0, at->w.x, at->w.y, at->w.z});
    return (Free){
        .x = at->v,
        .v = force.sum,
        .q = {0.5 * turning.w, 0.5 * turning.x, 0.5 * turning.y, 0.5 * turning.z},
        .w = mat3_apply(&inverse, vec3_sub(own, gyration)),
    };
}

static void add(Free *sum, double weight, const Free *by)
{
    sum->x = vec3_add(sum->x, vec3_scale(weight, by->x));
    sum->v = vec3_add(sum->v, vec3_scale(weight, by->v));
    sum->w = vec3_add(sum->w, vec3_scale(weight, by->w));
    sum->q.w += weight * by->q.w;
    sum->q.x += weight * by->q.x;
    sum->q.y += weight * by->q.y;
    sum->q.z += weight * by->q.z;
}

static Free moved(const Free *at, double h, const Free *by)
{
    Free next = *at;
    add(&next, h, by);
    return next;
}

static void step(const Body *body, double friction, double h, Free *at)
{
    const Free a = rates_of(body, at, friction);
    const Free second = moved(at, 0.5 * h, &a);
    const Free b = rates_of(body, &second, friction);
    const Free third = moved(at, 0.5 * h, &b);
    const Free c = rates_of(body, &third, friction);
    const Free fourth = moved(at, h, &c);
    const Free d = rates_of(body, &fourth, friction);
    const Free *stages[] = {&a, &b, &c, &d};
    const double weights[] = {1.0 / 6.0, 1.0 / 3.0, 1.0 / 3.0, 1.0 / 6.0};
    Free mean = {.x = {0.0, 0.0, 0.0}};
    for (int i = 0; i < 4; i++) {
        add(&mean, weights[i], stages[i]);
    }
    *at = moved(at, h, &mean);
    at->q = quat_unit(at->q);
}

// The largest distance of the reference's velocity, m/s, and angular velocity times 10 mm from the
// truth's.
static double largest_error(const Scenario *scenario, const Trajectory *run, double friction)
{
    const size_t steps = 10000; // a sample
    const double h = run->duration_s / (double)(run->sample_count - 1) / (double)steps;
    Free at = {{OFFSET.x, OFFSET.y, OFFSET.z}, VELOCITY, {1.0, 0.0, 0.0, 0.0}, SPIN};
    double largest = 0.0;
    for (size_t k = 0; k < run->sample_count; k++) {
        const SpaceMotion *motion = trajectory_space_motion(run, k, 0);
        const Vec3 turning = vec3_sub(motion->omega, quat_rotate(at.q, at.w));
        largest = fmax(largest, vec3_length(vec3_sub(motion->velocity, at.v)));
        largest = fmax(largest, 10e-3 * vec3_length(turning));
        for (size_t i = 0; i < steps; i++) {
            step(&scenario->linkage.bodies[0], friction, h, &at);
        }
    }
    return largest;
}

static void a_pin_that_tumbles_moves_as_the_truth(void **state)
{
    (void)state;
    const Scenario scenario = tumbling(FRICTION);
    Trajectory *run = complete_run(&scenario, BACKEND_REFERENCE);
    const double error = largest_error(&scenario, run, FRICTION);
    assert_true(run->joints[0].impacts >= 2);
    assert_true(run->joints[0].axial_max.value > AXIAL);
    assert_true(run->joints[0].tilt_max.value > 1e-3);
    assert_true(error < 1e-10);
    // control: of a hundredth more friction
    assert_true(largest_error(&scenario, run, 1.01 * FRICTION) > 1e-5);
    trajectory_destroy(run);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_pin_that_tumbles_moves_as_the_truth),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
