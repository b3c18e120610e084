// Finds the forces and moments on the bodies of a case: springs, bushings, loads, servos, and
// steady friction in ideal joints.
//
// Between points p_a and p_b, d = p_b - p_a, n = d / |d|:
//     force (k (|d| - l) + c d|d|/dt) n on body a, the other way on body b
// About a joint, phi the angle of its turned body, which is b but for one on the ground, less that
// of the other:
//     moment -k (phi - phi_0) - c dphi/dt on the turned body, the other way on the other
// A bushing acts at its point of body b on both bodies, along axes e that turn with body a:
//     force (k u + c u') e on body a, or by a curve f(u) in place of k u;  u = e . (p_b - p_a),
//     u' = e . (v_b - v_a), v_a that of the point of body a there;  likewise by angle
// A load along a sliding joint acts on body b at its anchor, along the line of body a, and the
// other way on body a at that point; along any other joint it is such a moment. Steady friction is
// such a load, - T tanh(rate / its speed).
#include "drivers/common/actions.h"

#include "kernel/friction_law.h"

#include <math.h>

bool actions_any(const DriverCase *of)
{
    return of->spring_count > 0 || of->torsion_count > 0 || of->bushing_count > 0 ||
           of->load_count > 0 || of->servo_count > 0 || of->drag_count > 0;
}

static void add_at(const DriverMotion *motions, int body, Vec2 point, Vec2 force,
                   DriverAction *actions)
{
    if (body == DRIVER_GROUND) {
        return;
    }
    DriverAction *action = &actions[body];
    action->force = vec2_add(action->force, force);
    action->moment += vec2_cross(vec2_sub(point, motions[body].position), force);
}

void actions_add(const DriverMotion *motions, int body, Vec2 local, Vec2 force,
                 DriverAction *actions)
{
    add_at(motions, body, driver_point(motions, body, local), force, actions);
}

static void add_spring(const DriverSpring *spring, const DriverMotion *motions,
                       DriverAction *actions)
{
    const Vec2 a = driver_point(motions, spring->bodies[0], spring->anchors[0]);
    const Vec2 b = driver_point(motions, spring->bodies[1], spring->anchors[1]);
    const Vec2 going =
        vec2_sub(driver_point_velocity(motions, spring->bodies[1], spring->anchors[1]),
                 driver_point_velocity(motions, spring->bodies[0], spring->anchors[0]));
    const Vec2 along = vec2_sub(b, a);
    const double distance = vec2_length(along);
    if (!(distance > 0.0)) {
        return;
    }
    const Vec2 normal = vec2_scale(1.0 / distance, along);
    const Vec2 force = vec2_scale(spring->stiffness * (distance - spring->length) +
                                      spring->damping * vec2_dot(normal, going),
                                  normal);
    add_at(motions, spring->bodies[0], a, force, actions);
    add_at(motions, spring->bodies[1], b, vec2_scale(-1.0, force), actions);
}

static DriverMotion motion_of(const DriverMotion *motions, int body)
{
    return body == DRIVER_GROUND ? (DriverMotion){.angle = 0.0} : motions[body];
}

// What a bushing pulls with along one of its rows.
static double pull_of(const DriverBushing *bushing, size_t row, double deflection, double rate)
{
    const ForceCurve *curve = &bushing->curves[row];
    const double pull =
        curve->count > 0 ? force_curve_at(curve, deflection) : bushing->stiffness[row] * deflection;
    return pull + bushing->damping[row] * rate;
}

static void add_bushing(const DriverBushing *bushing, const DriverMotion *motions,
                        DriverAction *actions)
{
    const int *bodies = bushing->bodies;
    const DriverMotion first = motion_of(motions, bodies[0]);
    const DriverMotion second = motion_of(motions, bodies[1]);
    const Vec2 b = driver_point(motions, bodies[1], bushing->anchors[1]);
    const Vec2 apart = vec2_sub(b, driver_point(motions, bodies[0], bushing->anchors[0]));
    const Vec2 moving = vec2_sub(driver_point_velocity(motions, bodies[1], bushing->anchors[1]),
                                 driver_point_velocity(motions, bodies[0], bushing->anchors[0]));
    const Vec2 against = vec2_sub(moving, vec2_scale(first.omega, vec2_perp(apart)));
    const Vec2 x = vec2_rotate(first.angle + bushing->direction, (Vec2){1.0, 0.0});
    const Vec2 axes[2] = {x, vec2_perp(x)};
    for (size_t row = 0; row < 2; row++) {
        const double pull =
            pull_of(bushing, row, vec2_dot(axes[row], apart), vec2_dot(axes[row], against));
        const Vec2 force = vec2_scale(pull, axes[row]);
        add_at(motions, bodies[0], b, force, actions);
        add_at(motions, bodies[1], b, vec2_scale(-1.0, force), actions);
    }
    const double moment = pull_of(bushing, 2, second.angle - first.angle - bushing->angle,
                                  second.omega - first.omega);
    for (int side = 0; side < 2; side++) {
        if (bodies[side] != DRIVER_GROUND) {
            actions[bodies[side]].moment += side == 0 ? moment : -moment;
        }
    }
}

// The angle of a joint, rad, and its rate; or the way along a sliding one, m, and its direction.
typedef struct Coordinate {
    double value;
    double rate;
    Vec2 along;
    int turned;
    int against;
} Coordinate;

static Coordinate angle_of(const DriverJoint *joint, const DriverMotion *motions)
{
    const bool is_b = joint->bodies[1] != DRIVER_GROUND;
    Coordinate is = {.turned = joint->bodies[is_b ? 1 : 0], .against = joint->bodies[is_b ? 0 : 1]};
    is.value = motions[is.turned].angle;
    is.rate = motions[is.turned].omega;
    if (is.against != DRIVER_GROUND) {
        is.value -= motions[is.against].angle;
        is.rate -= motions[is.against].omega;
    }
    return is;
}

static Coordinate coordinate_of(const DriverJoint *joint, const DriverMotion *motions)
{
    if (!joint->slides) {
        return angle_of(joint, motions);
    }
    const int a = joint->bodies[0];
    const double turned = a == DRIVER_GROUND ? 0.0 : motions[a].angle;
    Coordinate is = {.along = vec2_rotate(turned + joint->direction, (Vec2){1.0, 0.0})};
    const Vec2 gap = vec2_sub(driver_point(motions, joint->bodies[1], joint->anchors[1]),
                              driver_point(motions, a, joint->anchors[0]));
    const Vec2 going = vec2_sub(driver_point_velocity(motions, joint->bodies[1], joint->anchors[1]),
                                driver_point_velocity(motions, a, joint->anchors[0]));
    const double omega = a == DRIVER_GROUND ? 0.0 : motions[a].omega;
    is.value = vec2_dot(is.along, gap);
    is.rate = vec2_dot(is.along, vec2_sub(going, vec2_scale(omega, vec2_perp(gap))));
    return is;
}

static void add_moment(const Coordinate *about, double moment, DriverAction *actions)
{
    actions[about->turned].moment += moment;
    if (about->against != DRIVER_GROUND) {
        actions[about->against].moment -= moment;
    }
}

static void add_along(const DriverJoint *joint, double value, const DriverMotion *motions,
                      DriverAction *actions)
{
    const Coordinate is = coordinate_of(joint, motions);
    if (!joint->slides) {
        add_moment(&is, value, actions);
        return;
    }
    const Vec2 point = driver_point(motions, joint->bodies[1], joint->anchors[1]);
    const Vec2 force = vec2_scale(value, is.along);
    add_at(motions, joint->bodies[0], point, vec2_scale(-1.0, force), actions);
    add_at(motions, joint->bodies[1], point, force, actions);
}

static double value_of(const DriverCase *of, const DriverLoad *load, const DriverMotion *motions,
                       double from_s, double to_s)
{
    double at = load->shift + load->rate * 0.5 * (from_s + to_s);
    if (load->over_joint >= 0) {
        at = load->shift + coordinate_of(&of->joints[load->over_joint], motions).value;
    } else if (to_s > from_s && load->rate != 0.0) {
        return load_table_mean(&load->table, load->shift + load->rate * from_s,
                               load->shift + load->rate * to_s);
    }
    return load_table_value(&load->table, at, load->rate < 0.0 ? -1.0 : 1.0, at);
}

// What a servo does in the middle of two times.
static double servo_value(const DriverCase *of, const DriverServo *servo,
                          const DriverMotion *motions, double from_s, double to_s)
{
    const Coordinate is = coordinate_of(&of->joints[servo->joint], motions);
    const double mean = to_s > from_s ? time_table_mean(&servo->table, from_s, to_s)
                                      : time_table_at(&servo->table, from_s);
    double value = mean - servo->slope * is.rate;
    if (servo->followed.is_present) {
        const DriveState to = drive_since(&servo->followed, from_s, 0.5 * (from_s + to_s));
        value += servo->stiffness * (to.angle - is.value) + servo->slope * to.omega;
    }
    return servo->limit > 0.0 ? fmin(fmax(value, -servo->limit), servo->limit) : value;
}

static void add_load(const DriverCase *of, const DriverLoad *load, double value,
                     const DriverMotion *motions, DriverAction *actions)
{
    switch (load->kind) {
    case DRIVER_FORCE: {
        const double turned =
            load->turns_along && load->body != DRIVER_GROUND ? motions[load->body].angle : 0.0;
        actions_add(motions, load->body, load->anchor,
                    vec2_rotate(load->direction + turned, (Vec2){value, 0.0}), actions);
        break;
    }
    case DRIVER_TORQUE:
        actions[load->body].moment += value;
        break;
    case DRIVER_ALONG:
        add_along(&of->joints[load->joint], value, motions, actions);
        break;
    }
}

void actions_find(const DriverCase *of, const DriverMotion *motions, double from_s, double to_s,
                  DriverAction *actions)
{
    for (size_t i = 0; i < of->body_count; i++) {
        actions[i] = (DriverAction){.moment = 0.0};
    }
    for (size_t i = 0; i < of->spring_count; i++) {
        add_spring(&of->springs[i], motions, actions);
    }
    for (size_t i = 0; i < of->torsion_count; i++) {
        const DriverTorsion *spring = &of->torsions[i];
        const Coordinate is = angle_of(&of->joints[spring->joint], motions);
        add_moment(&is, -spring->stiffness * (is.value - spring->angle) - spring->damping * is.rate,
                   actions);
    }
    for (size_t i = 0; i < of->bushing_count; i++) {
        add_bushing(&of->bushings[i], motions, actions);
    }
    for (size_t i = 0; i < of->load_count; i++) {
        add_load(of, &of->loads[i], value_of(of, &of->loads[i], motions, from_s, to_s), motions,
                 actions);
    }
    for (size_t i = 0; i < of->servo_count; i++) {
        const DriverServo *servo = &of->servos[i];
        add_along(&of->joints[servo->joint], servo_value(of, servo, motions, from_s, to_s), motions,
                  actions);
    }
    for (size_t i = 0; i < of->drag_count; i++) {
        const DriverDrag *drag = &of->drags[i];
        if (drag->holds) {
            continue;
        }
        const DriverJoint *joint = &of->joints[drag->joint];
        const double held = friction_hold(coordinate_of(joint, motions).rate, drag->speed).held;
        add_along(joint, -drag->most * held, motions, actions);
    }
}
