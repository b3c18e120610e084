// Lets ideal joints rub: their friction grows with what presses in them, and changes that.
//
// Of joint i, with s_i the share that its sliding or its bristle holds, a_i the arm and N_i what
// presses, from the reaction R_i (kernel/kernel.h):
//     T_i = s_i a_i N_i,   N_i = |R_i|, or max(|R_ix|, |R_iy|) of a guide
//     R_i = R_i0 - sum over j of A_ij T_j,   R_i0 what all other rows leave of it
//     T_i' = a_i (s_i' N_i + s_i N_i'),   N_i' = n_i . R_i'
// Both are linear in each other but for the size of R, and contract where the frictions have one
// answer, which whoever fills in the reactions makes sure of (kernel/friction_answer.h): they are
// found by going round the joints until nothing changes but by rounding.
#include "kernel/friction_law.h"
#include "kernel/internal.h"

#include <float.h>
#include <math.h>

// of frictions that contract by nine tenths each time round, to rounding
enum { RUB_ROUNDS = 400 };

static const double RUB_ROUNDING = 4.0 * DBL_EPSILON;

// times the speed of the law, from which on regularized friction is that of sliding
static const double RUB_SLIDES = 6.0;

// of the time in which friction changes what slides, and of the time until it slides that slowly
static const double RUB_DECAYS_MOST = 1.5;
static const double RUB_AWAY_MOST = 0.5;

KernelRub *kernel_rub_of(const Kernel *kernel, size_t contact)
{
    size_t i = 0;
    while (kernel->rubs[i].contact != contact) {
        i++;
    }
    return &kernel->rubs[i];
}

static const KernelContact *contact_of(const Kernel *kernel, const KernelRub *rub)
{
    return &kernel->contacts[rub->contact];
}

// How the sliding of a joint accelerates under its own friction, 1/kg or 1/(kg m^2); 0: hardly.
static double mobility_of(const Kernel *kernel, const KernelRub *rub)
{
    const size_t row = contact_of(kernel, rub)->first_row;
    const double own = *kernel_mobility(kernel, row, row);
    return own > BRISTLE_MOBILITY * rub->alone ? own : 0.0;
}

// The direction in which a face of a guide presses.
static Vec2 face_of(int face)
{
    const double sign = face % 2 == 0 ? 1.0 : -1.0;
    return face < 2 ? (Vec2){sign, 0.0} : (Vec2){0.0, sign};
}

// What presses, of a reaction, and the direction in which it grows. That of a guide's face goes on
// smoothly where another presses.
static double press_of(const KernelRub *rub, Vec2 reaction, Vec2 *way)
{
    if (rub->steady > 0.0) {
        *way = (Vec2){0.0, 0.0};
        return rub->steady;
    }
    if (rub->is_guide) {
        *way = face_of(rub->face);
        return vec2_dot(*way, reaction);
    }
    const double size = vec2_length(reaction);
    *way = size > 0.0 ? vec2_scale(1.0 / size, reaction) : (Vec2){0.0, 0.0};
    return size;
}

static Vec2 answer_to(const double *by_row, size_t row, double value)
{
    return (Vec2){value * by_row[2 * row], value * by_row[2 * row + 1]};
}

// What is added by values in all rows.
static Vec2 answer_to_all(const Kernel *kernel, const double *by_row, const double *values)
{
    Vec2 sum = {0.0, 0.0};
    for (size_t row = 0; row < kernel->row_count; row++) {
        sum = vec2_add(sum, answer_to(by_row, row, values[row]));
    }
    return sum;
}

// The reaction of a joint at a point, under the forces in all rows, its own friction among them.
static Vec2 reaction_of(const Kernel *kernel, const KernelRub *rub, const KernelPoint *point,
                        const double *force)
{
    const double since_s = point->time_s - kernel->middle_s;
    const Vec2 of = {rub->reaction[0] + since_s * rub->rate[0],
                     rub->reaction[1] + since_s * rub->rate[1]};
    const Vec2 late = answer_to_all(kernel, rub->late, point->impulse);
    const Vec2 turned = vec2_scale(since_s, answer_to_all(kernel, rub->turning, force));
    return vec2_add(vec2_add(of, late),
                    vec2_add(turned, answer_to_all(kernel, rub->answers, force)));
}

static double sliding_of(const Kernel *kernel, const KernelRub *rub, const KernelPoint *point)
{
    return kernel_motion_speed(kernel, contact_of(kernel, rub)->first_row, point->time_s,
                               point->impulse, point->moment);
}

// The share that is held against a sliding.
static double share_of(const Kernel *kernel, const KernelRub *rub, const KernelPoint *point,
                       double sliding)
{
    const KernelContact *contact = contact_of(kernel, rub);
    return contact->has_bristle ? bristle_hold(&contact->law.bristle, contact->state.bristle,
                                               point->bends[rub->contact].bend, sliding)
                                      .share
                                : friction_hold(sliding, contact->law.friction_speed).held;
}

// What presses in a joint at a point, once the forces of all rows are known.
static double pressing_at(const Kernel *kernel, const KernelRub *rub, const KernelPoint *point,
                          const double *force, Vec2 *way)
{
    return press_of(rub, reaction_of(kernel, rub, point, force), way);
}

enum { FACES = 4, FACE_HALVINGS = 50 };

// of a reaction, by which another face has to press more
static const double FACE_PASSED = 1e-12;

// The face that presses most; the one that does where none presses more.
static int pressing_face(const KernelRub *rub, Vec2 reaction)
{
    const double rounding = FACE_PASSED * (fabs(reaction.x) + fabs(reaction.y));
    int most = rub->face;
    for (int face = 0; face < FACES; face++) {
        const Vec2 more = vec2_sub(face_of(face), face_of(most));
        most = vec2_dot(more, reaction) > rounding ? face : most;
    }
    return most;
}

// Lets the faces of guides press that press most under the forces in all rows. Returns whether any
// is another one.
static bool find_faces(Kernel *kernel, const KernelPoint *point, const double *force)
{
    bool is_any = false;
    for (size_t i = 0; i < kernel->rub_count; i++) {
        KernelRub *rub = &kernel->rubs[i];
        const int face =
            rub->is_guide ? pressing_face(rub, reaction_of(kernel, rub, point, force)) : rub->face;
        is_any = is_any || face != rub->face;
        rub->face = face;
    }
    return is_any;
}

bool kernel_rubs_face(Kernel *kernel, const KernelPoint *point)
{
    return find_faces(kernel, point, point->force);
}

// Damps a bristle by what was found to press last.
static void damp_bristle(Kernel *kernel, size_t number)
{
    KernelContact *contact = &kernel->contacts[number];
    BristlePair *pair = &contact->law.bristle;
    KernelRub *rub = kernel_rub_of(kernel, number);
    const double mobility = mobility_of(kernel, rub);
    rub->is_damped = true;
    pair->damping = contact->has_bristle && mobility > 0.0
                        ? bristle_damping(pair, pair->zeta, rub->most, 1.0 / mobility)
                        : 0.0;
}

void kernel_rub_stick_at(Kernel *kernel, size_t number, KernelPoint *point)
{
    double powers[2];
    kernel->contacts[number].law.bristle.damping = 0.0;
    kernel_force_find_touching(kernel, point, kernel->work->forces, powers, kernel->work->touching);
    damp_bristle(kernel, number);
}

void kernel_rubs_begin(Kernel *kernel, KernelPoint *point)
{
    double powers[2];
    bool is_known = true;
    for (size_t i = 0; i < kernel->rub_count; i++) {
        is_known = is_known && kernel->rubs[i].most > 0.0;
    }
    // as if bristles held nothing yet; one face may turn on another
    bool is_other = !is_known;
    for (int round = 0; round <= FACES && is_other; round++) {
        kernel_force_find_touching(kernel, point, kernel->work->forces, powers,
                                   kernel->work->touching);
        is_other = find_faces(kernel, point, kernel->work->forces);
    }
    for (size_t i = 0; i < kernel->rub_count; i++) {
        if (!kernel->rubs[i].is_damped) {
            damp_bristle(kernel, kernel->rubs[i].contact);
        }
    }
}

// Of joints that stand and stick: each in turn is bent by what its acceleration asks for, until
// none is. What friction cannot hold is left at its end.

enum { HOLD_SWEEPS = 1000 }; // of joints that hardly hold each other: what is left starts a swing

static const double HOLD_SETTLED = 1e-12; // of the presliding

// of the speed that uses friction up in the bristle's damper: what slides no faster stands
static const double HOLD_SPEED = 0.01;

// Bends one; returns by how much, over its presliding.
static double hold_one(Kernel *kernel, size_t number, KernelPoint *point)
{
    const KernelRub *rub = &kernel->rubs[number];
    KernelContact *contact = &kernel->contacts[rub->contact];
    const BristlePair *pair = &contact->law.bristle;
    const double mobility = mobility_of(kernel, rub);
    double *force = kernel->work->forces;
    double powers[2];
    kernel_force_find_touching(kernel, point, force, powers, kernel->work->touching);
    if (!(mobility > 0.0 && rub->most > 0.0) ||
        fabs(sliding_of(kernel, rub, point)) * pair->damping > HOLD_SPEED) {
        return 0.0;
    }
    const double asked = kernel_motion_acceleration(kernel, contact->first_row, point->time_s,
                                                    point->impulse, force) /
                         mobility;
    const double share = (asked - force[contact->first_row]) / (pair->ratio * rub->most);
    double *bend = &point->bends[rub->contact].bend;
    const double before = *bend;
    *bend = contact->state.bend = pair->limit * fmax(-1.0, fmin(share, 1.0));
    return fabs(*bend - before) / pair->limit;
}

bool kernel_rubs_hold(Kernel *kernel, KernelPoint *point)
{
    bool is_first = false;
    double most = 1.0;
    for (size_t i = 0; i < kernel->rub_count; i++) {
        KernelRub *rub = &kernel->rubs[i];
        is_first = is_first || rub->is_new;
        // not what another run has bent
        rub->is_new = rub->is_new && contact_of(kernel, rub)->has_bristle &&
                      contact_of(kernel, rub)->state.bend == 0.0;
    }
    for (int sweep = 0; is_first && sweep < HOLD_SWEEPS && most > HOLD_SETTLED; sweep++) {
        most = 0.0;
        for (size_t i = 0; i < kernel->rub_count; i++) {
            most = fmax(most, kernel->rubs[i].is_new ? hold_one(kernel, i, point) : 0.0);
        }
    }
    for (size_t i = 0; i < kernel->rub_count; i++) {
        kernel->rubs[i].is_new = false;
    }
    return is_first;
}

void kernel_rubs_press(Kernel *kernel, const KernelPoint *point, double *force, double powers[2])
{
    // as they slide, whatever presses
    for (size_t i = 0; i < kernel->rub_count; i++) {
        KernelRub *rub = &kernel->rubs[i];
        rub->at.sliding = sliding_of(kernel, rub, point);
        rub->at.share = share_of(kernel, rub, point, rub->at.sliding);
    }
    double moved = INFINITY;
    double size = 0.0;
    for (int round = 0; round < RUB_ROUNDS && moved > RUB_ROUNDING * size; round++) {
        moved = size = 0.0;
        for (size_t i = 0; i < kernel->rub_count; i++) {
            KernelRub *rub = &kernel->rubs[i];
            const KernelContact *contact = contact_of(kernel, rub);
            Vec2 way;
            rub->most = contact->law.friction * pressing_at(kernel, rub, point, force, &way);
            double *held = &force[contact->first_row];
            const double next = -rub->at.share * rub->most;
            moved += fabs(next - *held);
            size += rub->most;
            *held = next;
        }
    }
    for (size_t i = 0; i < kernel->rub_count; i++) {
        const KernelRub *rub = &kernel->rubs[i];
        powers[1] -= force[contact_of(kernel, rub)->first_row] * rub->at.sliding;
    }
}

// Looks at a joint under the forces in all rows.
static void look_at(const Kernel *kernel, KernelRub *rub, KernelPoint *point, const double *forces)
{
    const KernelContact *contact = contact_of(kernel, rub);
    KernelRubbing *at = &rub->at;
    Vec2 way;
    at->sliding = sliding_of(kernel, rub, point);
    at->rate = kernel_motion_acceleration(kernel, contact->first_row, point->time_s, point->impulse,
                                          forces);
    at->pressing = pressing_at(kernel, rub, point, forces, &way);
    const Vec2 pushed = vec2_add(answer_to_all(kernel, rub->late, forces),
                                 answer_to_all(kernel, rub->turning, forces));
    at->way[0] = way.x;
    at->way[1] = way.y;
    at->pushed[0] = pushed.x;
    at->pushed[1] = pushed.y;
    if (contact->has_bristle) {
        const BristleRates held =
            kernel_bristle_rates(contact, &point->bends[rub->contact],
                                 (double[]){contact->law.friction * at->pressing, 0.0},
                                 (double[]){at->sliding, at->rate});
        at->share = held.share;
        at->share_rate = held.share_rate;
        return;
    }
    const FrictionHold hold = friction_hold(at->sliding, contact->law.friction_speed);
    at->share = hold.held;
    at->share_rate = hold.slope * at->rate;
}

// How fast what presses grows, N/s, with the rates in all rows.
static double pressing_rate(const Kernel *kernel, const KernelRub *rub, const KernelPoint *point)
{
    const double since_s = point->time_s - kernel->middle_s;
    const Vec2 answer =
        vec2_add(answer_to_all(kernel, rub->answers, point->rate),
                 vec2_scale(since_s, answer_to_all(kernel, rub->turning, point->rate)));
    return rub->at.way[0] * (rub->rate[0] + (rub->at.pushed[0] + answer.x)) +
           rub->at.way[1] * (rub->rate[1] + (rub->at.pushed[1] + answer.y));
}

void kernel_rubs_rate(Kernel *kernel, KernelPoint *point)
{
    const double *forces = kernel->work->forces;
    for (size_t i = 0; i < kernel->rub_count; i++) {
        const size_t row = contact_of(kernel, &kernel->rubs[i])->first_row;
        point->force[row] = forces[row];
        look_at(kernel, &kernel->rubs[i], point, forces);
    }
    double moved = INFINITY;
    double size = 0.0;
    for (int round = 0; round < RUB_ROUNDS && moved > RUB_ROUNDING * size; round++) {
        moved = size = 0.0;
        for (size_t i = 0; i < kernel->rub_count; i++) {
            const KernelRub *rub = &kernel->rubs[i];
            const KernelContact *contact = contact_of(kernel, rub);
            const double grown = pressing_rate(kernel, rub, point);
            double *rate = &point->rate[contact->first_row];
            const double next = -contact->law.friction *
                                (rub->at.share_rate * rub->at.pressing + rub->at.share * grown);
            moved += fabs(next - *rate);
            size += fabs(next);
            *rate = next;
        }
    }
    for (size_t i = 0; i < kernel->rub_count; i++) {
        const KernelRubbing *at = &kernel->rubs[i].at;
        const size_t row = contact_of(kernel, &kernel->rubs[i])->first_row;
        point->powers[1] -= point->force[row] * at->sliding;
        point->power_rates[1] -= point->rate[row] * at->sliding + point->force[row] * at->rate;
    }
}

// Whether another face presses more after a part of a step.
static bool has_passed(Kernel *kernel, LocalStep *step, const KernelRub *rub, double width_s)
{
    KernelPoint *at = &kernel->work->trial;
    kernel_local_step_inside(kernel, step, rub->contact, width_s);
    kernel_explicit_forces(kernel, &step->explicit, step->from, width_s, kernel->work->forces);
    return pressing_face(rub, reaction_of(kernel, rub, at, kernel->work->forces)) != rub->face;
}

bool kernel_rubs_shorten(Kernel *kernel, LocalStep *step, double *width_s)
{
    const double whole_s = *width_s;
    for (size_t i = 0; i < kernel->rub_count; i++) {
        const KernelRub *rub = &kernel->rubs[i];
        if (!rub->is_guide || rub->steady > 0.0 || !has_passed(kernel, step, rub, *width_s)) {
            continue;
        }
        double low = 0.0;
        double high = *width_s;
        for (int k = 0; k < FACE_HALVINGS && high - low > FACE_PASSED * whole_s; k++) {
            const double middle = 0.5 * (low + high);
            *(has_passed(kernel, step, rub, middle) ? &high : &low) = middle;
        }
        *width_s = high;
    }
    return *width_s < whole_s;
}

double kernel_rub_time(const Kernel *kernel, const KernelPoint *point, size_t number)
{
    const KernelContact *contact = &kernel->contacts[number];
    const KernelRub *rub = kernel_rub_of(kernel, number);
    const double fastest = rub->most * mobility_of(kernel, rub);
    if (!(fastest > 0.0)) {
        return INFINITY;
    }
    if (contact->has_bristle) {
        const BristlePair *pair = &contact->law.bristle;
        return bristle_slides(contact->state.bristle)
                   ? INFINITY
                   : RUB_DECAYS_MOST /
                         fmax(fastest * pair->damping, sqrt(fastest * pair->ratio / pair->limit));
    }
    const double speed = contact->law.friction_speed;
    const double away = fabs(sliding_of(kernel, rub, point)) - RUB_SLIDES * speed;
    const double rate = fabs(kernel_motion_acceleration(kernel, contact->first_row, point->time_s,
                                                        point->impulse, point->force));
    const double holds_s = RUB_DECAYS_MOST * speed / fastest;
    return away > 0.0 ? fmax(holds_s, RUB_AWAY_MOST * away / rate) : holds_s;
}
