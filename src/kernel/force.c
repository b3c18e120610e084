// Computes the forces of contacts on the rows of relative motion, and how they change with
// position and speed, and in time along the motion.
//
// Normal force by the law (kernel/force_law.h). Friction is
// mu N tanh(v_t / v_s) against the sliding speed
//     v_t = t . u_e' + R u_a' - (R - |e|) u_b',   t the normal turned by a quarter turn,
// R the hole's radius, e eccentricity, u_a', u_b' the turning of the hole's and the pin's body
// about the pin's axis. Two discs outside each other are a hole of negative radius, and |e| is then
// -|e|. At a line normal and tangent are the rows. In a slot |e| is infinite between the ends where
// it divides, and R - |e| is the arm of both bodies, for u_e' is against the point under the pin.
// In space the pin slides along the axis too, with w the turning about x and y,
//     v_z = u_z' - R t . w_a + (R - |e|) t . w_b
// and friction is mu N tanh(s / v_s) against the direction of (v_t, v_z), s its size.
//
// With position and speed: e eccentricity, v its rate, n the normal (inwards), t = perp n, o = -n,
// d = |e| - clearance:
//     d' = o . v            dd = o . de,   dn = -t (t . de) / |e|,   dt = n (t . de) / |e|
//     N(d, d')              dN = N_d o . de + N_d' (o . dv + (t . v) (t . de) / |e|)
// of two discs |e| is -|e|, at a line infinite: neither n nor t turns. With friction
//     H = mu N tanh(v_t / v_s)
//     dv_t = (n . v) (t . de) / |e| + u_b' o . de + t . dv + R du_a' - (R - |e|) du_b'
//     F = N n - H t,  moments -R H and (R - |e|) H
// In space, with s = |(v_t, v_z)| and phi = tanh(s / v_s) / s,
//     H_t = mu N phi v_t,  H_z = mu N phi v_z
//     dv_z = du_z' + (R - |e|) t . dw_b - R t . dw_a
//            + ((R - |e|) n . w_b - R n . w_a) (t . de) / |e| - t . w_b o . de
//
// Along the motion, with ' the derivative in time, a = u'' = g + W f:
//     n' = -t (t . v) / |e|,  t' = n (t . v) / |e|
//     d'' = o . a + (t . v)^2 / |e|
//     N' = k (1 + chi d' / v0) d' + c_d d'^2 + (chi F_el / v0 + c) d'',  c_d = dc / dd
//     v_t' = t . a + t' . v + R w_a' - (R - |e|) w_b' + d' w_b,   H' = mu (N tanh(v_t / v_s))'
// of the friction of a pin in space H_t and H_z likewise, with their share phi of the sliding.
#include "kernel/friction_law.h"
#include "kernel/internal.h"

#include <math.h>
#include <string.h>

// rows of a kernel from which on all are worked out together
enum { ROWS_TOGETHER_LEAST = 8 };

// The pose of a contact at a point from rows that were found together.
static void pose_by_rows(const Kernel *kernel, size_t contact, KernelKnownPose *known)
{
    const size_t row = kernel->contacts[contact].first_row;
    const KernelWork *work = kernel->work;
    const double position[2] = {work->positions[row], work->positions[row + 1]};
    known->speed[0] = work->speeds[row];
    known->speed[1] = work->speeds[row + 1];
    known->pose = kernel_motion_pose_of(kernel, contact, position, known->speed);
    known->is_known = true;
}

// The arms of friction about a pin's axis: of its hole the radius, of the pin itself less than that
// by the eccentricity. In a slot both bodies have the pin's.
static inline double pin_arm_of(const KernelContact *contact, const PinHole *pose)
{
    return contact->shape == KERNEL_SLOT
               ? contact->hole_radius - contact->radial_clearance + pose->gap
               : contact->hole_radius - pose->eccentricity_size;
}

static inline double hole_arm_of(const KernelContact *contact, const PinHole *pose)
{
    return contact->shape == KERNEL_SLOT ? pin_arm_of(contact, pose) : contact->hole_radius;
}

// How fast a pin slides round its hole.
static double sliding_round(const double *speed, Vec2 tangent, double hole_arm, double pin_arm)
{
    return tangent.x * speed[0] + tangent.y * speed[1] + hole_arm * speed[KERNEL_ROW_TURN] -
           pin_arm * speed[KERNEL_ROW_TURN + 1];
}

// How fast a pin slides along its axis.
static double sliding_along(const double *speed, Vec2 tangent, double hole_arm, double pin_arm)
{
    const double *hole = speed + KERNEL_ROW_HOLE;
    const double *pin = speed + KERNEL_ROW_PIN;
    return speed[KERNEL_ROW_AXIAL] - hole_arm * (tangent.x * hole[0] + tangent.y * hole[1]) +
           pin_arm * (tangent.x * pin[0] + tangent.y * pin[1]);
}

// The share of mu N that is held against a sliding.
static double held_share(const KernelPoint *point, const KernelContact *of, size_t contact,
                         double normal, double sliding)
{
    if (!of->has_bristle) {
        return friction_hold(sliding, of->law.friction_speed).held;
    }
    const BristlePair pair = bristle_pressed(&of->law.bristle, of->law.friction * normal);
    return bristle_hold(&pair, of->state.bristle, point->bends[contact].bend, sliding).share;
}

double kernel_force_sliding(const Kernel *kernel, const KernelPoint *point, size_t contact)
{
    const KernelContact *of = &kernel->contacts[contact];
    const PinHole *pose = kernel_point_pose(kernel, point, contact);
    double speed[KERNEL_ROWS_MOST] = {point->known[contact].speed[0],
                                      point->known[contact].speed[1]};
    if (of->shape == KERNEL_LINE) {
        return speed[of->is_rub ? 0 : 1];
    }
    for (size_t i = KERNEL_ROWS_PLAIN; i < of->row_count; i++) {
        speed[i] = kernel_motion_speed(kernel, of->first_row + i, point->time_s, point->impulse,
                                       point->moment);
    }
    return sliding_round(speed, vec2_perp(pose->normal), hole_arm_of(of, pose),
                         pin_arm_of(of, pose));
}

// Adds friction to a contact's rows that press with a normal force; returns the power it takes, W.
static double add_friction(const Kernel *kernel, const KernelPoint *point, size_t contact,
                           const double *speed, const PinHole *pose, double normal, double *force)
{
    const KernelContact *of = &kernel->contacts[contact];
    const size_t row = of->first_row;
    if (of->shape == KERNEL_LINE) {
        const double taken =
            of->law.friction * normal * held_share(point, of, contact, normal, speed[1]);
        force[row + 1] -= taken;
        return taken * speed[1];
    }
    const double hole_arm = hole_arm_of(of, pose);
    const double pin_arm = pin_arm_of(of, pose);
    const Vec2 tangent = vec2_perp(pose->normal);
    const double sliding = sliding_round(speed, tangent, hole_arm, pin_arm);
    double held;
    double power;
    if (of->row_count < KERNEL_ROWS_MOST) {
        held = of->law.friction * normal * held_share(point, of, contact, normal, sliding);
        power = held * sliding;
    } else {
        const double axial = sliding_along(speed, tangent, hole_arm, pin_arm);
        const double size = hypot(sliding, axial);
        const double grip =
            of->law.friction * normal * friction_grip(size, of->law.friction_speed).share;
        const double along = grip * axial;
        held = grip * sliding;
        power = grip * size * size;
        force[row + KERNEL_ROW_AXIAL] = -along;
        force[row + KERNEL_ROW_HOLE] = hole_arm * along * tangent.x;
        force[row + KERNEL_ROW_HOLE + 1] = hole_arm * along * tangent.y;
        force[row + KERNEL_ROW_PIN] = -pin_arm * along * tangent.x;
        force[row + KERNEL_ROW_PIN + 1] = -pin_arm * along * tangent.y;
    }
    force[row] -= held * tangent.x;
    force[row + 1] -= held * tangent.y;
    force[row + KERNEL_ROW_TURN] = -hole_arm * held;
    force[row + KERNEL_ROW_TURN + 1] = pin_arm * held;
    return power;
}

// What the law of a contact has at a depth, from its spring there.
static inline ForceLawTerms terms_of(const KernelContact *contact, double depth, double elastic,
                                     double tangent)
{
    return (ForceLawTerms){
        .elastic = elastic,
        .tangent = tangent,
        .viscous = force_law_viscous(&contact->law, depth),
        .viscous_slope = force_law_viscous_slope(&contact->law, depth),
    };
}

static inline double damping_rate_of(const KernelContact *contact)
{
    return force_law_damping_rate(&contact->law, contact->state.damping_speed);
}

// What presses along the normal of a contact that touches. Where a contact has just begun its depth
// is zero but for rounding, of either sign, and a viscous damper presses hardest.
static double pressing(const KernelContact *contact, const KernelTouch *touch)
{
    const PinHole *pose = &touch->pose;
    const ForceLawTerms at = terms_of(contact, pose->penetration, touch->elastic, touch->tangent);
    const double total = force_law_damped(at, damping_rate_of(contact), pose->approach_speed).force;
    return total < 0.0 ? 0.0 : total; // a comparison that lets NaN through
}

double kernel_force_pressing(const Kernel *kernel, const KernelPoint *point, size_t contact)
{
    const KernelContact *of = &kernel->contacts[contact];
    KernelTouch touch = {.pose = *kernel_point_pose(kernel, point, contact)};
    force_law_both(&of->law, touch.pose.penetration, &touch.elastic, &touch.tangent);
    return pressing(of, &touch);
}

// How a contact is at a point; of its rows beyond the first two only where there is friction. Many
// rows have been found together.
static void find_touch(const Kernel *kernel, const KernelPoint *point, size_t contact, bool is_wide,
                       KernelTouch *touch)
{
    const KernelContact *of = &kernel->contacts[contact];
    KernelKnownPose *known = &point->known[contact];
    if (is_wide) {
        pose_by_rows(kernel, contact, known);
    }
    touch->pose = *kernel_point_pose(kernel, point, contact);
    touch->speed[0] = known->speed[0];
    touch->speed[1] = known->speed[1];
    for (size_t i = KERNEL_ROWS_PLAIN; i < of->row_count; i++) {
        const size_t row = of->first_row + i;
        touch->speed[i] = is_wide ? kernel->work->speeds[row]
                                  : kernel_motion_speed(kernel, row, point->time_s, point->impulse,
                                                        point->moment);
    }
    force_law_both(&of->law, touch->pose.penetration, &touch->elastic, &touch->tangent);
}

void kernel_force_find_touching(Kernel *kernel, const KernelPoint *point, double *force,
                                double powers[2], KernelTouch *touching)
{
    const bool is_wide = kernel->row_count >= ROWS_TOGETHER_LEAST;
    bool is_any = false;
    powers[0] = powers[1] = 0.0;
    for (size_t i = 0; i < kernel->contact_count; i++) {
        const KernelContact *contact = &kernel->contacts[i];
        double *own = force + contact->first_row;
        if (!contact->state.is_touching || contact->is_rub) {
            memset(own, 0, contact->row_count * sizeof *own);
            continue;
        }
        if (!is_any && is_wide) {
            kernel_motion_all(kernel, point->time_s, point->impulse, point->moment,
                              kernel->work->positions, kernel->work->speeds);
        }
        is_any = true;
        KernelTouch *touch = &touching[i];
        find_touch(kernel, point, i, is_wide, touch);
        const PinHole *pose = &touch->pose;
        const double normal = pressing(contact, touch);
        own[0] = normal * pose->normal.x;
        own[1] = normal * pose->normal.y;
        powers[0] += (normal - touch->elastic) * pose->approach_speed;
        if (contact->has_friction) {
            powers[1] += add_friction(kernel, point, i, touch->speed, pose, normal, force);
        }
    }
    if (kernel->rub_count > 0) {
        kernel_rubs_press(kernel, point, force, powers);
        is_any = true;
    }
    kernel->evaluations += is_any ? 1 : 0;
    kernel_count_work(kernel);
}

void kernel_force_find(Kernel *kernel, double time_s, const double *impulse, const double *moment,
                       double *force, double powers[2])
{
    KernelPoint *point = &kernel->work->last; // of explicit steps, which ask for no forces
    kernel_point_begin(kernel, point, time_s);
    memcpy(point->impulse, impulse, kernel->row_count * sizeof *impulse);
    memcpy(point->moment, moment, 2 * kernel->row_count * sizeof *moment);
    kernel_force_find_touching(kernel, point, force, powers, kernel->work->touching);
}

// By how much the contacts that can press together with one move it along its normal, 1/kg; of a
// block only the corners that touch, for most of its impacts are of one.
static double mobility_between(const Kernel *kernel, const KernelContact *of, Vec2 normal)
{
    double sum = 0.0;
    for (int k = of->siblings[0]; k <= of->siblings[1]; k++) {
        const double *other = kernel_mobility(kernel, of->first_row, of[k].first_row);
        const double *below = other + kernel->pitch;
        const double between = normal.x * (other[0] * normal.x + other[1] * normal.y) +
                               normal.y * (below[0] * normal.x + below[1] * normal.y);
        const bool presses = of[k].state.is_touching || of[k].shape != KERNEL_LINE;
        sum += k != 0 && presses ? fabs(between) : 0.0;
    }
    return sum;
}

// Mobility along the normal of a contact, 1/kg. Places that press together move each other.
static inline double normal_mobility(const Kernel *kernel, size_t contact, Vec2 normal)
{
    const KernelContact *of = &kernel->contacts[contact];
    const double *first = kernel_mobility(kernel, of->first_row, of->first_row);
    const double own = normal.x * (first[0] * normal.x + 2.0 * first[1] * normal.y) +
                       normal.y * first[kernel->pitch + 1] * normal.y;
    return of->siblings[0] == of->siblings[1] ? own : own + mobility_between(kernel, of, normal);
}

double kernel_force_frequency(const Kernel *kernel, size_t contact, Vec2 normal, double depth)
{
    const double stiffness = force_law_tangent(&kernel->contacts[contact].law, depth);
    return sqrt(normal_mobility(kernel, contact, normal) * stiffness);
}

double kernel_force_decay(const Kernel *kernel, size_t contact, Vec2 normal, double depth)
{
    const KernelContact *of = &kernel->contacts[contact];
    return normal_mobility(kernel, contact, normal) *
           force_law_damping(&of->law, depth, of->state.damping_speed);
}

double kernel_force_friction_time(const Kernel *kernel, size_t contact, const double *force)
{
    const size_t row = kernel->contacts[contact].first_row;
    const double arm = kernel->contacts[contact].hole_radius;
    double mobility = 0.0;
    for (size_t k = 0; k < kernel->contacts[contact].row_count; k++) {
        const double diagonal = *kernel_mobility(kernel, row + k, row + k);
        const bool is_turn = k >= KERNEL_ROWS_PLAIN && k != KERNEL_ROW_AXIAL;
        mobility += is_turn ? arm * arm * diagonal : diagonal;
    }
    const KernelContact *of = &kernel->contacts[contact];
    const double held = of->law.friction * hypot(force[row], force[row + 1]);
    if (!(held > 0.0)) {
        return INFINITY;
    }
    return of->has_bristle
               ? bristle_time(&of->law.bristle, of->state.bristle, held, held * mobility)
               : of->law.friction_speed / (held * mobility);
}

enum { POSITIONS = 2, SPEEDS = KERNEL_ROWS_MOST, PARTS = POSITIONS + SPEEDS };

// A scalar's derivatives: by e, then by the rates of the contact's rows.
typedef struct Gradient {
    double of[PARTS];
} Gradient;

static Gradient along(Vec2 by_position, Vec2 by_speed)
{
    return (Gradient){{by_position.x, by_position.y, by_speed.x, by_speed.y}};
}

// The normal force and its gradient.
static double find_normal(const KernelContact *contact, const PinHole *pose, Vec2 velocity,
                          double from_depth, Gradient *gradient)
{
    const ForceLaw *law = &contact->law;
    const Vec2 outward = vec2_scale(-1.0, pose->normal);
    const Vec2 tangent = vec2_perp(pose->normal);
    const double depth = fmax(pose->penetration, from_depth);
    const double below = pose->penetration - depth;
    const double stiffness = force_law_tangent(law, depth);
    const ForceLawTerms at = terms_of(contact, depth, force_law_elastic(law, depth), stiffness);
    const ForceLawDamped damped =
        force_law_damped(at, damping_rate_of(contact), pose->approach_speed);
    const double by_depth = below < 0.0 ? stiffness : damped.by_depth;
    const double turning = damped.by_rate * vec2_dot(tangent, velocity) / pose->eccentricity_size;
    *gradient = along(vec2_add(vec2_scale(by_depth, outward), vec2_scale(turning, tangent)),
                      vec2_scale(damped.by_rate, outward));
    return damped.force + stiffness * below;
}

// The derivatives of x g, with those of g.
static Gradient product_rule(double x, const Gradient *dx, double g, const Gradient *dg)
{
    Gradient sum;
    for (size_t k = 0; k < PARTS; k++) {
        sum.of[k] = x * dg->of[k] + g * dx->of[k];
    }
    return sum;
}

static void write_slopes(KernelSlopes *slopes, size_t row, double force, const Gradient *gradient)
{
    slopes->force[row] = force;
    memcpy(slopes->by_position[row], gradient->of, POSITIONS * sizeof *gradient->of);
    memcpy(slopes->by_speed[row], gradient->of + POSITIONS, SPEEDS * sizeof *gradient->of);
}

// Friction's force, taken from the pin: along the tangent, and along its axis; with gradients.
typedef struct FrictionRows {
    double round;
    double axial;
    Gradient by_round;
    Gradient by_axial;
} FrictionRows;

// How fast the pin slides along its axis, and how that changes.
static double find_axial(const KernelContact *contact, const PinHole *pose, const double *speeds,
                         Gradient *gradient)
{
    const double hole_arm = contact->hole_radius;
    const double pin_arm = hole_arm - pose->eccentricity_size;
    const Vec2 tangent = vec2_perp(pose->normal);
    const Vec2 hole = {speeds[KERNEL_ROW_HOLE], speeds[KERNEL_ROW_HOLE + 1]};
    const Vec2 pin = {speeds[KERNEL_ROW_PIN], speeds[KERNEL_ROW_PIN + 1]};
    const Vec2 arms = vec2_sub(vec2_scale(pin_arm, pin), vec2_scale(hole_arm, hole));
    const double turning = vec2_dot(pose->normal, arms) / pose->eccentricity_size;
    *gradient = along(
        vec2_add(vec2_scale(turning, tangent), vec2_scale(vec2_dot(tangent, pin), pose->normal)),
        (Vec2){0.0, 0.0});
    double *by_speed = gradient->of + POSITIONS;
    by_speed[KERNEL_ROW_AXIAL] = 1.0;
    by_speed[KERNEL_ROW_HOLE] = -hole_arm * tangent.x;
    by_speed[KERNEL_ROW_HOLE + 1] = -hole_arm * tangent.y;
    by_speed[KERNEL_ROW_PIN] = pin_arm * tangent.x;
    by_speed[KERNEL_ROW_PIN + 1] = pin_arm * tangent.y;
    return speeds[KERNEL_ROW_AXIAL] + vec2_dot(tangent, arms);
}

// Friction against a sliding that has two directions.
static void find_both(const KernelContact *contact, double round, const Gradient *by_round,
                      double axial, const Gradient *by_axial, double normal,
                      const Gradient *by_normal, FrictionRows *held)
{
    const FrictionGrip grip = friction_grip(hypot(round, axial), contact->law.friction_speed);
    const double share = grip.share;
    for (size_t k = 0; k < PARTS; k++) {
        const double growth = grip.bend * (round * by_round->of[k] + axial * by_axial->of[k]);
        const double along_round = share * by_round->of[k] + growth * round;
        const double along_axis = share * by_axial->of[k] + growth * axial;
        held->by_round.of[k] =
            contact->law.friction * (share * round * by_normal->of[k] + normal * along_round);
        held->by_axial.of[k] =
            contact->law.friction * (share * axial * by_normal->of[k] + normal * along_axis);
    }
    held->round = contact->law.friction * normal * share * round;
    held->axial = contact->law.friction * normal * share * axial;
}

// How fast the pin slides round its hole, or a circle along its line, and how that changes.
static double find_round(const KernelContact *contact, const PinHole *pose, const double *speeds,
                         Gradient *gradient)
{
    const Vec2 tangent = vec2_perp(pose->normal);
    const Vec2 velocity = {speeds[0], speeds[1]};
    if (contact->shape == KERNEL_LINE) {
        *gradient = along((Vec2){0.0, 0.0}, tangent);
        return speeds[1];
    }
    const double hole_arm = hole_arm_of(contact, pose);
    const double pin_arm = pin_arm_of(contact, pose);
    const double turning = vec2_dot(pose->normal, velocity) / pose->eccentricity_size;
    const double shortened = contact->shape == KERNEL_SLOT ? speeds[2] - speeds[3] : -speeds[3];
    *gradient =
        along(vec2_add(vec2_scale(turning, tangent), vec2_scale(shortened, pose->normal)), tangent);
    gradient->of[POSITIONS + 2] = hole_arm;
    gradient->of[POSITIONS + 3] = -pin_arm;
    return vec2_dot(tangent, velocity) + hole_arm * speeds[2] - pin_arm * speeds[3];
}

static void find_friction(const KernelContact *contact, const PinHole *pose, const double *speeds,
                          double normal, const Gradient *by_normal, FrictionRows *held)
{
    Gradient by_sliding;
    const double sliding = find_round(contact, pose, speeds, &by_sliding);
    if (contact->row_count == KERNEL_ROWS_MOST) {
        Gradient by_axial;
        const double axial = find_axial(contact, pose, speeds, &by_axial);
        find_both(contact, sliding, &by_sliding, axial, &by_axial, normal, by_normal, held);
        return;
    }
    const FrictionHold hold = friction_hold(sliding, contact->law.friction_speed);
    for (size_t k = 0; k < PARTS; k++) {
        held->by_round.of[k] = contact->law.friction * (hold.held * by_normal->of[k] +
                                                        normal * hold.slope * by_sliding.of[k]);
    }
    held->round = contact->law.friction * normal * hold.held;
}

// The rows of the bodies' turns about the pin's axis.
static void write_turns(const KernelContact *contact, const PinHole *pose, const FrictionRows *held,
                        KernelSlopes *slopes)
{
    const Vec2 still = {0.0, 0.0};
    const double arm = hole_arm_of(contact, pose);
    const double pin_arm = pin_arm_of(contact, pose);
    const Gradient fixed = along(still, still);
    const Gradient shortens = along(pose->normal, still);                    // of R - |e|
    const Gradient lengthens = along(vec2_scale(-1.0, pose->normal), still); // of minus that
    const Gradient on_hole = product_rule(held->round, &held->by_round, -arm,
                                          contact->shape == KERNEL_SLOT ? &lengthens : &fixed);
    const Gradient on_pin = product_rule(held->round, &held->by_round, pin_arm, &shortens);
    write_slopes(slopes, KERNEL_ROW_TURN, -arm * held->round, &on_hole);
    write_slopes(slopes, KERNEL_ROW_TURN + 1, pin_arm * held->round, &on_pin);
}

// The rows that friction along the axis acts in.
static void write_axial(const KernelContact *contact, const PinHole *pose, const FrictionRows *held,
                        KernelSlopes *slopes)
{
    const Vec2 still = {0.0, 0.0};
    const Vec2 tangent = vec2_perp(pose->normal);
    const Vec2 round = vec2_scale(1.0 / pose->eccentricity_size, tangent);
    const double n[2] = {pose->normal.x, pose->normal.y};
    const double t[2] = {tangent.x, tangent.y};
    const double arm = contact->hole_radius;
    const double pin_arm = arm - pose->eccentricity_size;
    const Gradient fixed = along(still, still);
    const Gradient lengthens = along(vec2_scale(-1.0, pose->normal), still); // of |e| - R
    const Gradient on_axis = product_rule(held->axial, &held->by_axial, -1.0, &fixed);
    write_slopes(slopes, KERNEL_ROW_AXIAL, -held->axial, &on_axis);
    for (size_t i = 0; i < 2; i++) {
        const Gradient turns = along(vec2_scale(n[i], round), still);
        const double part = held->axial * t[i];
        const Gradient by_part = product_rule(held->axial, &held->by_axial, t[i], &turns);
        const Gradient on_hole = product_rule(part, &by_part, arm, &fixed);
        const Gradient on_pin = product_rule(part, &by_part, -pin_arm, &lengthens);
        write_slopes(slopes, KERNEL_ROW_HOLE + i, arm * part, &on_hole);
        write_slopes(slopes, KERNEL_ROW_PIN + i, -pin_arm * part, &on_pin);
    }
}

void kernel_slopes_find(const Kernel *kernel, size_t number, double time_s, const double *impulse,
                        const double *moment, double from_depth, KernelSlopes *slopes)
{
    const KernelContact *contact = &kernel->contacts[number];
    const PinHole pose = kernel_motion_pose(kernel, number, time_s, impulse, moment);
    memset(slopes, 0, sizeof *slopes);
    if (!contact->state.is_touching || (pose.penetration <= 0.0 && from_depth == 0.0)) {
        return;
    }
    double speeds[SPEEDS] = {0.0};
    for (size_t i = 0; i < contact->row_count; i++) {
        speeds[i] = kernel_motion_speed(kernel, contact->first_row + i, time_s, impulse, moment);
    }
    Gradient by_normal;
    const double normal =
        find_normal(contact, &pose, (Vec2){speeds[0], speeds[1]}, from_depth, &by_normal);
    if (normal < 0.0 && from_depth == 0.0) {
        return;
    }
    // the directions turn with the pin's way round the hole
    const Vec2 tangent = vec2_perp(pose.normal);
    const Vec2 round = vec2_scale(1.0 / pose.eccentricity_size, tangent);
    const Vec2 still = {0.0, 0.0};
    const double n[2] = {pose.normal.x, pose.normal.y};
    const double t[2] = {tangent.x, tangent.y};
    FrictionRows held = {.round = 0.0};
    // a wall that pulls rubs on nothing
    if (contact->has_friction && normal > 0.0) {
        find_friction(contact, &pose, speeds, normal, &by_normal, &held);
    }
    for (size_t i = 0; i < 2; i++) {
        const Gradient normal_turns = along(vec2_scale(-t[i], round), still);
        const Gradient tangent_turns = along(vec2_scale(n[i], round), still);
        Gradient row = product_rule(normal, &by_normal, n[i], &normal_turns);
        const Gradient taken = product_rule(held.round, &held.by_round, t[i], &tangent_turns);
        for (size_t k = 0; k < PARTS; k++) {
            row.of[k] -= taken.of[k];
        }
        write_slopes(slopes, i, normal * n[i] - held.round * t[i], &row);
    }
    if (contact->row_count > KERNEL_ROWS_PLAIN) {
        write_turns(contact, &pose, &held, slopes);
    }
    if (contact->row_count == KERNEL_ROWS_MOST) {
        write_axial(contact, &pose, &held, slopes);
    }
}

// A number and its derivative in time.
typedef struct Rated {
    double value;
    double rate;
} Rated;

static inline Rated rated_times(Rated a, Rated b)
{
    return (Rated){a.value * b.value, a.rate * b.value + a.value * b.rate};
}

static inline Rated rated_plus(Rated a, Rated b)
{
    return (Rated){a.value + b.value, a.rate + b.rate};
}

static inline Rated rated_scale(double factor, Rated a)
{
    return (Rated){factor * a.value, factor * a.rate};
}

// What is known of a contact that touches: rows' speeds and accelerations, directions, and what
// presses.
typedef struct MovingContact {
    const KernelContact *contact;
    Rated speed[KERNEL_ROWS_MOST];
    Rated normal[2];  // the direction of the force on the pin
    Rated tangent[2]; // that turned by a quarter turn
    Rated pin_arm;    // R - |e|
    Rated pressing;   // N
    KernelBend *bend; // of its bristle
    double *force;    // of its rows
    double *rate;
} MovingContact;

// The share of mu N that is held against a sliding.
static Rated rated_hold(const MovingContact *moving, Rated grip, Rated sliding)
{
    const KernelContact *contact = moving->contact;
    if (contact->has_bristle) {
        const BristleRates held =
            kernel_bristle_rates(contact, moving->bend, (double[]){grip.value, grip.rate},
                                 (double[]){sliding.value, sliding.rate});
        return (Rated){held.share, held.share_rate};
    }
    const FrictionHold hold = friction_hold(sliding.value, contact->law.friction_speed);
    return (Rated){hold.held, hold.slope * sliding.rate};
}

static inline Rated directed(const Rated direction[2], const Rated vector[2])
{
    return rated_plus(rated_times(direction[0], vector[0]), rated_times(direction[1], vector[1]));
}

static void push_row(MovingContact *moving, size_t row, Rated force)
{
    moving->force[row] += force.value;
    moving->rate[row] += force.rate;
}

static Rated rows_along(const MovingContact *moving, const Rated direction[2], size_t row)
{
    return directed(direction, moving->speed + row);
}

// Friction of a pin in space, round its axis and along it; returns the power it takes.
static Rated rate_space_friction(MovingContact *moving, Rated round, Rated *held)
{
    const double hole_arm = moving->contact->hole_radius;
    const Rated by_hole =
        rated_scale(-hole_arm, rows_along(moving, moving->tangent, KERNEL_ROW_HOLE));
    const Rated by_pin =
        rated_times(moving->pin_arm, rows_along(moving, moving->tangent, KERNEL_ROW_PIN));
    const Rated axial = rated_plus(moving->speed[KERNEL_ROW_AXIAL], rated_plus(by_hole, by_pin));
    const FrictionGrip found =
        friction_grip(hypot(round.value, axial.value), moving->contact->law.friction_speed);
    const Rated share = {found.share,
                         found.bend * (round.value * round.rate + axial.value * axial.rate)};
    const Rated grip =
        rated_times(rated_scale(moving->contact->law.friction, moving->pressing), share);
    const Rated along_axis = rated_times(grip, axial);
    *held = rated_times(grip, round);
    push_row(moving, KERNEL_ROW_AXIAL, rated_scale(-1.0, along_axis));
    for (size_t i = 0; i < 2; i++) {
        const Rated part = rated_times(along_axis, moving->tangent[i]);
        push_row(moving, KERNEL_ROW_HOLE + i, rated_scale(hole_arm, part));
        push_row(moving, KERNEL_ROW_PIN + i, rated_scale(-1.0, rated_times(moving->pin_arm, part)));
    }
    return rated_plus(rated_times(*held, round), rated_times(along_axis, axial));
}

// Adds friction to the rows; returns the power it takes.
static Rated rate_friction(MovingContact *moving)
{
    const KernelContact *contact = moving->contact;
    const Rated grip = rated_scale(contact->law.friction, moving->pressing);
    if (contact->shape == KERNEL_LINE) {
        const Rated held = rated_times(grip, rated_hold(moving, grip, moving->speed[1]));
        push_row(moving, 1, rated_scale(-1.0, held));
        return rated_times(held, moving->speed[1]);
    }
    const bool is_slot = contact->shape == KERNEL_SLOT;
    const Rated hole_arm = is_slot ? moving->pin_arm : (Rated){contact->hole_radius, 0.0};
    const Rated sliding = rated_plus(
        rated_plus(rows_along(moving, moving->tangent, 0),
                   rated_times(hole_arm, moving->speed[KERNEL_ROW_TURN])),
        rated_scale(-1.0, rated_times(moving->pin_arm, moving->speed[KERNEL_ROW_TURN + 1])));
    Rated held;
    Rated power;
    if (contact->row_count == KERNEL_ROWS_MOST) {
        power = rate_space_friction(moving, sliding, &held);
    } else {
        held = rated_times(grip, rated_hold(moving, grip, sliding));
        power = rated_times(held, sliding);
    }
    for (size_t i = 0; i < 2; i++) {
        push_row(moving, i, rated_scale(-1.0, rated_times(held, moving->tangent[i])));
    }
    push_row(moving, KERNEL_ROW_TURN, rated_scale(-1.0, rated_times(hole_arm, held)));
    push_row(moving, KERNEL_ROW_TURN + 1, rated_times(moving->pin_arm, held));
    return power;
}

// What a contact presses with, from how it is and its closing speed, and the part of it that is
// lost.
static Rated rate_pressing(const KernelContact *contact, const KernelTouch *touch, Rated closing,
                           Rated *lost)
{
    // at no depth the slope of a law of exponent below 1 is infinite
    const double slope = touch->tangent < INFINITY ? touch->tangent : 0.0;
    const Rated elastic = {touch->elastic, slope * closing.value};
    const double depth = touch->pose.penetration;
    const ForceLawTerms at = terms_of(contact, depth, touch->elastic, slope);
    const double rate = damping_rate_of(contact);
    const double force = force_law_damped(at, rate, closing.value).force;
    if (force < 0.0 || (depth <= 0.0 && closing.value <= 0.0)) {
        *lost = rated_scale(-1.0, elastic);
        return (Rated){0.0, 0.0};
    }
    const double change = force_law_damped_rate(at, rate, closing.value, closing.rate);
    *lost = (Rated){force - elastic.value, change - elastic.rate};
    return (Rated){force, change};
}

// Directions, arms and pressing of a contact from its pose.
static Rated find_pressing(MovingContact *moving, const KernelTouch *touch)
{
    const PinHole *pose = &touch->pose;
    const Rated *v = moving->speed;
    const double n[2] = {pose->normal.x, pose->normal.y};
    const double t[2] = {-n[1], n[0]};
    const double round = t[0] * v[0].value + t[1] * v[1].value;
    const double turning = round / pose->eccentricity_size;
    for (size_t i = 0; i < 2; i++) {
        moving->normal[i] = (Rated){n[i], -turning * t[i]};
        moving->tangent[i] = (Rated){t[i], turning * n[i]};
    }
    const Rated closing = {
        pose->approach_speed,
        round * turning - n[0] * v[0].rate - n[1] * v[1].rate,
    };
    moving->pin_arm = (Rated){pin_arm_of(moving->contact, pose), -pose->approach_speed};
    Rated lost;
    moving->pressing = rate_pressing(moving->contact, touch, closing, &lost);
    return rated_times(lost, closing);
}

// Adds what a contact that touches presses and rubs with to its rows, which are empty.
static void rate_contact(MovingContact *moving, const KernelTouch *touch, KernelPoint *point)
{
    const Rated damped = find_pressing(moving, touch);
    point->powers[0] += damped.value;
    point->power_rates[0] += damped.rate;
    if (moving->contact->shape == KERNEL_LINE) {
        push_row(moving, 0, moving->pressing);
    } else {
        push_row(moving, 0, rated_times(moving->pressing, moving->normal[0]));
        push_row(moving, 1, rated_times(moving->pressing, moving->normal[1]));
    }
    if (moving->contact->has_friction) {
        const Rated rubbed = rate_friction(moving);
        point->powers[1] += rubbed.value;
        point->power_rates[1] += rubbed.rate;
    }
}

// How a contact's rows move under the forces.
static void find_moving(const Kernel *kernel, const KernelPoint *point, const double *forces,
                        const KernelTouch *touch, MovingContact *moving)
{
    const size_t first = moving->contact->first_row;
    for (size_t k = 0; k < moving->contact->row_count; k++) {
        const double acceleration =
            kernel_motion_acceleration(kernel, first + k, point->time_s, point->impulse, forces);
        moving->speed[k] = (Rated){touch->speed[k], acceleration};
    }
}

void kernel_rates_find(Kernel *kernel, KernelPoint *point)
{
    const size_t rows = kernel->row_count;
    const KernelTouch *touching = kernel->work->touching;
    double *forces = kernel->work->forces;
    kernel_force_find_touching(kernel, point, forces, point->powers, kernel->work->touching);
    memset(point->force, 0, rows * sizeof *point->force);
    memset(point->rate, 0, rows * sizeof *point->rate);
    memset(point->powers, 0, sizeof point->powers);
    memset(point->power_rates, 0, sizeof point->power_rates);
    for (size_t i = 0; i < kernel->contact_count; i++) {
        const KernelContact *contact = &kernel->contacts[i];
        if (contact->state.is_touching && !contact->is_rub) {
            MovingContact moving = {
                .contact = contact,
                .bend = &point->bends[i],
                .force = point->force + contact->first_row,
                .rate = point->rate + contact->first_row,
            };
            find_moving(kernel, point, forces, &touching[i], &moving);
            rate_contact(&moving, &touching[i], point);
        }
    }
    if (kernel->rub_count > 0) {
        kernel_rubs_rate(kernel, point);
    }
}
