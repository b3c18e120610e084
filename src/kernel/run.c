// Integrates the contacts of a kernel through a step of the world, and keeps what happened.
//
// Rows u of relative motion, W their mobility and g their free acceleration, both taken as
// constant over the step, f(u, u') the contacts' forces:
//     u'' = g + W f
// With the impulse P' = f and its integral Q' = P that is
//     u' = u0' + g t + W P,   u = u0 + u0' t + g t^2 / 2 + W Q
// Of few rows W may be linear in time, and g in time and in the impulse:
//     u'' = g + g' (t - h/2) + 2 S P + (W + (t - h/2) (S + S^T)) f
// which P, Q and the integral R of Q solve as well (kernel/motion.c), so that only P, Q and R are
// integrated, in local steps (kernel/local_step.c). Ends of a contact are found to rounding, and
// steps end there.
//
// Between two nodes the integral Q of the impulse is Hermite's quintic through Q, P = Q' and f =
// Q'' at both; its derivatives are impulse and force, right to the orders 4 and 3 of the local
// step. Where two contacts that should end together do so a rounding apart, the force is linear
// between the nodes: a difference of integrals over the square of that time would be rounding.
//
// Arrays by contact and by row grow as contacts are added. Mobilities stand in rows, of which each
// has the columns next to its diagonal: rows times columns of few rows, else in proportion to the
// rows.
#include "kernel/internal.h"

#include "base/memory.h"
#include "base/zeroed.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

// rad: of implicit steps, where the phase is not given
static const double STIFF_PHASE = 0.05;

Kernel kernel_start(double phase)
{
    return (Kernel){
        .phase = phase,
        .stiff_phase = phase > 0.0 ? phase : STIFF_PHASE,
        .stable = 2.0,
        .event_most = SIZE_MAX,
        .longest_s = {INFINITY, INFINITY},
    };
}

size_t kernel_rows(const Kernel *kernel)
{
    return kernel->row_count;
}

static void grow(Kernel *kernel, size_t rows)
{
    if (kernel->contact_count == kernel->contact_room) {
        const size_t room = 2 * kernel->contact_room + 1;
        kernel->contacts = memory_grown(kernel->contacts, room, sizeof *kernel->contacts);
        kernel->contact_room = room;
    }
    while (kernel->row_count + rows > kernel->row_room) {
        const size_t room = 2 * kernel->row_room + KERNEL_ROWS_PLAIN;
        kernel->contact_of = memory_grown(kernel->contact_of, room, sizeof *kernel->contact_of);
        kernel->row_room = room;
    }
}

void kernel_add(Kernel *kernel, const KernelContact *contact, size_t rows)
{
    grow(kernel, rows);
    KernelContact *added = &kernel->contacts[kernel->contact_count];
    *added = *contact;
    added->first_row = kernel->row_count;
    added->row_count = rows;
    added->has_friction =
        added->law.friction > 0.0 && (rows > KERNEL_ROWS_PLAIN || added->shape == KERNEL_LINE);
    if (added->is_rub) {
        kernel->rubs = memory_grown(kernel->rubs, kernel->rub_count + 1, sizeof *kernel->rubs);
        kernel->rubs[kernel->rub_count++] =
            (KernelRub){.contact = kernel->contact_count, .is_new = true};
    }
    added->has_bristle =
        added->has_friction && rows < KERNEL_ROWS_MOST && added->law.bristle.law == BRISTLE_STICK;
    kernel->has_bristles = kernel->has_bristles || added->has_bristle;
    for (size_t i = 0; i < rows; i++) {
        kernel->contact_of[kernel->row_count++] = (int)kernel->contact_count;
    }
    kernel->contact_count++;
}

KernelPoint kernel_point(size_t rows, size_t contacts)
{
    // one piece of memory, so that there is no moment at which half of it has no owner
    const size_t bytes = 5 * rows * sizeof(double);
    const size_t each = sizeof(KernelKnownPose) + sizeof(KernelBend);
    double *numbers = zeroed(1, bytes + contacts * each);
    KernelKnownPose *known = (KernelKnownPose *)(numbers + 5 * rows);
    return (KernelPoint){
        .known = known,
        .bends = (KernelBend *)(known + contacts),
        .impulse = numbers,
        .moment = numbers + rows,
        .force = numbers + 3 * rows,
        .rate = numbers + 4 * rows,
    };
}

void kernel_point_free(KernelPoint *point)
{
    free(point->impulse);
    *point = (KernelPoint){.time_s = 0.0};
}

// The kernel owns it before it is filled.
static void make_work(Kernel *kernel)
{
    const size_t rows = kernel->row_count;
    const size_t contacts = kernel->contact_count;
    KernelWork *work = kernel->work = zeroed(1, sizeof *work);
    work->ends[0] = kernel_point(rows, contacts);
    work->ends[1] = kernel_point(rows, contacts);
    work->inside = kernel_point(rows, contacts);
    work->last = kernel_point(rows, contacts);
    work->trial = kernel_point(rows, contacts);
    work->touching = zeroed(contacts, sizeof *work->touching);
    work->forces = zeroed(rows, sizeof *work->forces);
    work->positions = zeroed(rows, sizeof *work->positions);
    work->speeds = zeroed(rows, sizeof *work->speeds);
    for (size_t i = 0; i < KERNEL_ERRORS; i++) {
        work->errors[i] = zeroed(2 * rows, sizeof *work->errors[i]);
    }
    work->crossings_s = zeroed(contacts, sizeof *work->crossings_s);
    work->has_event = zeroed(contacts, sizeof *work->has_event);
    work->mode_ends_s = zeroed(contacts, sizeof *work->mode_ends_s);
    work->modes = zeroed(contacts, sizeof *work->modes);
}

static void free_work(KernelWork *work)
{
    if (work == NULL) {
        return;
    }
    kernel_point_free(&work->ends[0]);
    kernel_point_free(&work->ends[1]);
    kernel_point_free(&work->inside);
    kernel_point_free(&work->last);
    kernel_point_free(&work->trial);
    free(work->touching);
    free(work->forces);
    free(work->positions);
    free(work->speeds);
    for (size_t i = 0; i < KERNEL_ERRORS; i++) {
        free(work->errors[i]);
    }
    free(work->crossings_s);
    free(work->has_event);
    free(work->mode_ends_s);
    free(work->modes);
    free(work);
}

void kernel_make_rows(Kernel *kernel)
{
    const size_t rows = kernel->row_count;
    kernel->free = zeroed(rows, sizeof *kernel->free);
    kernel->position = zeroed(rows, sizeof *kernel->position);
    kernel->speed = zeroed(rows, sizeof *kernel->speed);
}

void kernel_make_room(Kernel *kernel, size_t reach)
{
    const size_t rows = kernel->row_count;
    const bool is_dense = 2 * reach + 1 >= rows;
    // row i begins with column 0, or with column i - reach
    kernel->reach = is_dense ? rows : reach;
    kernel->origin = is_dense ? 0 : reach;
    kernel->pitch = is_dense ? rows : 2 * reach;
    kernel->mobility = zeroed(rows * (is_dense ? rows : 2 * reach + 1), sizeof *kernel->mobility);
    kernel_make_rows(kernel);
    make_work(kernel);
}

void kernel_carry(Kernel *kernel, Carry *carry)
{
    CARRY_ARRAY(carry, kernel->contacts, kernel->contact_count);
    CARRY_ARRAY(carry, kernel->free, kernel->row_count);
    for (size_t i = 0; i < kernel->rub_count; i++) {
        CARRY(carry, kernel->rubs[i].reaction);
        CARRY(carry, kernel->rubs[i].most);
        CARRY(carry, kernel->rubs[i].is_new);
        CARRY(carry, kernel->rubs[i].is_damped);
    }
    CARRY(carry, kernel->longest_s);
    CARRY(carry, kernel->duration_before_s);
    CARRY(carry, kernel->stiff_width_s);
    CARRY(carry, kernel->evaluations);
    CARRY(carry, kernel->work_done);
}

void kernel_finish(Kernel *kernel)
{
    free(kernel->contacts);
    free(kernel->contact_of);
    free(kernel->rubs);
    free(kernel->mobility);
    free(kernel->drift);
    free(kernel->mobility_rate);
    free(kernel->free_rate);
    free(kernel->free);
    free(kernel->position);
    free(kernel->speed);
    free(kernel->times);
    free(kernel->values);
    free(kernel->closings);
    free(kernel->losses);
    free(kernel->touching);
    free_work(kernel->work);
    kernel_implicit_finish(kernel);
    *kernel = (Kernel){.contact_count = 0};
}

KernelSums kernel_sums(size_t rows)
{
    double *numbers = zeroed(4 * rows, sizeof *numbers);
    return (KernelSums){.impulse = numbers, .moment = numbers + rows, .force = numbers + 3 * rows};
}

void kernel_sums_free(KernelSums *sums)
{
    free(sums->impulse);
    *sums = (KernelSums){.impulse = NULL};
}

enum {
    NODE_ROOM_FIRST = 8, // nodes; a step without contacts has two
    // what more a step took is given back when steps are calm again: of many mechanisms side by
    // side few touch at a time
    KEPT_ROOM_MOST = 32,
};

// Marks which contacts touch from a node on, and how fast they close.
static void set_touching(const Kernel *kernel, const KernelPoint *point, uint64_t *words,
                         double *closings)
{
    const size_t count = kernel->contact_count;
    for (size_t first = 0; first < count; first += 64) {
        uint64_t bits = 0;
        for (size_t i = first; i < count && i < first + 64; i++) {
            const bool touches = kernel->contacts[i].state.is_touching;
            bits |= touches ? UINT64_C(1) << (i - first) : 0;
            closings[i] = touches ? kernel_point_pose(kernel, point, i)->approach_speed : 0.0;
        }
        words[first / 64] = bits;
    }
}

bool kernel_touches_any(const Kernel *kernel, size_t node)
{
    const size_t words = (kernel->contact_count + 63) / 64;
    for (size_t i = 0; i < words; i++) {
        if (kernel->touching[node * words + i] != 0) {
            return true;
        }
    }
    return false;
}

// Gives back the room for nodes.
static void drop_nodes(Kernel *kernel)
{
    free(kernel->times);
    free(kernel->values);
    free(kernel->closings);
    free(kernel->losses);
    free(kernel->touching);
    kernel->times = kernel->values = kernel->closings = kernel->losses = NULL;
    kernel->touching = NULL;
    kernel->node_room = 0;
}

void kernel_nodes_begin(Kernel *kernel)
{
    if (kernel->node_room > KEPT_ROOM_MOST && kernel->node_room > 4 * kernel->node_count) {
        drop_nodes(kernel);
    }
    kernel->node_count = 0;
}

// Makes room for more nodes.
static void grow_nodes(Kernel *kernel)
{
    const size_t room = 2 * kernel->node_room + NODE_ROOM_FIRST;
    const size_t rows = kernel->row_count;
    const size_t contacts = kernel->contact_count;
    const size_t words = (contacts + 63) / 64;
    kernel->times = memory_grown(kernel->times, room, sizeof *kernel->times);
    kernel->values = memory_grown(kernel->values, 4 * rows * room + 1, sizeof *kernel->values);
    kernel->closings =
        memory_grown(kernel->closings, contacts * room + 1, sizeof *kernel->closings);
    kernel->losses = memory_grown(kernel->losses, 2 * room, sizeof *kernel->losses);
    kernel->touching = memory_grown(kernel->touching, words * room + 1, sizeof *kernel->touching);
    kernel->node_room = room;
}

void kernel_nodes_add(Kernel *kernel, const KernelPoint *point)
{
    if (kernel->node_count == kernel->node_room) {
        grow_nodes(kernel);
    }
    const size_t rows = kernel->row_count;
    const size_t contacts = kernel->contact_count;
    const size_t words = (contacts + 63) / 64;
    const size_t node = kernel->node_count++;
    double *values = kernel->values + 4 * rows * node;
    kernel->times[node] = point->time_s;
    // as they stand in the point: impulses, both integrals, forces
    for (size_t i = 0; i < 4 * rows; i++) {
        values[i] = point->impulse[i];
    }
    memcpy(kernel->losses + 2 * node, point->losses, sizeof point->losses);
    set_touching(kernel, point, kernel->touching + words * node,
                 kernel->closings + contacts * node);
}

void kernel_nodes_settle(Kernel *kernel)
{
    kernel_implicit_settled(kernel, kernel->values + 3 * kernel->row_count);
}

size_t kernel_node(const Kernel *kernel, double time_s)
{
    size_t low = 0;
    size_t high = kernel->node_count;
    while (high - low > 1) {
        const size_t middle = (low + high) / 2;
        if (kernel->times[middle] <= time_s) {
            low = middle;
        } else {
            high = middle;
        }
    }
    return low;
}

static KernelNodeRow node_row(const double *values, size_t rows, size_t row)
{
    return (KernelNodeRow){.impulse = values[row],
                           .moment = values[rows + row],
                           .second = values[2 * rows + row],
                           .force = values[3 * rows + row]};
}

// Where a time lies between a node and the next.
typedef struct Between {
    const double *first; // values at the node
    const double *last;  // at the next
    double width_s;
    double share; // of it, up to the time
    bool is_short;
} Between;

static Between find_between(const Kernel *kernel, size_t node, double time_s)
{
    const size_t next = node + 1 < kernel->node_count ? node + 1 : node;
    const double width_s = kernel->times[next] - kernel->times[node];
    return (Between){
        .first = kernel_node_values(kernel, node),
        .last = kernel_node_values(kernel, next),
        .width_s = width_s,
        .share = width_s > 0.0 ? (time_s - kernel->times[node]) / width_s : 0.0,
        .is_short = width_s < KERNEL_LINEAR_WIDTH * kernel->times[kernel->node_count - 1],
    };
}

static inline KernelNodeRow row_between(const Between *of, size_t rows, size_t row)
{
    return kernel_quintic(node_row(of->first, rows, row), node_row(of->last, rows, row),
                          of->width_s, of->share, of->is_short);
}

static void find_sums(const Between *between, size_t rows, KernelSpan span, KernelSums *sums)
{
    for (size_t i = span.first; i < span.end; i++) {
        const KernelNodeRow at = row_between(between, rows, i);
        sums->impulse[i] = at.impulse;
        sums->moment[i] = at.moment;
        sums->moment[rows + i] = at.second;
        sums->force[i] = at.force;
    }
}

void kernel_at(const Kernel *kernel, size_t node, double time_s, KernelSums *sums)
{
    const size_t next = node + 1 < kernel->node_count ? node + 1 : node;
    const Between between = find_between(kernel, node, time_s);
    find_sums(&between, kernel_rows(kernel), (KernelSpan){0, kernel_rows(kernel)}, sums);
    const double *before = kernel->losses + 2 * node;
    const double *after = kernel->losses + 2 * next;
    const double s = between.share;
    sums->dissipated = before[0] + s * (after[0] - before[0]);
    sums->friction = before[1] + s * (after[1] - before[1]);
}

void kernel_around(const Kernel *kernel, size_t contact, size_t node, double time_s,
                   KernelSums *sums)
{
    const Between between = find_between(kernel, node, time_s);
    find_sums(&between, kernel_rows(kernel), kernel_contact_span(kernel, contact), sums);
}

void kernel_contact_at(const Kernel *kernel, size_t contact, size_t node, double time_s,
                       double *impulse, double *moment, double *force)
{
    const size_t rows = kernel_rows(kernel);
    const KernelContact *of = &kernel->contacts[contact];
    const Between between = find_between(kernel, node, time_s);
    for (size_t i = 0; i < of->row_count; i++) {
        const KernelNodeRow at = row_between(&between, rows, of->first_row + i);
        impulse[i] = at.impulse;
        moment[i] = at.moment;
        force[i] = at.force;
    }
}

KernelPose kernel_pose(const Kernel *kernel, size_t contact, size_t node, double time_s,
                       const KernelSums *sums)
{
    const size_t row = kernel->contacts[contact].first_row;
    return (KernelPose){
        .pose = kernel_motion_pose(kernel, contact, time_s, sums->impulse, sums->moment),
        .force = {sums->force[row], sums->force[row + 1]},
        .is_touching = kernel_touches(kernel, node, contact),
    };
}

// beyond this a step of the world holds more of a contact than anybody can want
enum { NODE_MAX = 100000 };

// the error of a classical step of order 4 in its phase, which is what is meant where one is given
static const double PHASE_ERROR = 1.0 / 120.0;

// what is allowed where it is not given: of the error that comes of a response that is taken as
// constant
static const double ERROR_SHARE = 0.004;

// the same where it changes in the step, which leaves a tenth of that error, and of its square,
// which is left beside that
static const double DRIFT_SHARE = 0.002;
static const double DRIFT_SQUARE = 0.5;
static const double TOLERANCE_LEAST = 1e-10;
static const double TOLERANCE_MOST = 1e-3;

// of a contact's first step: times the tolerance, to the power 2/3, in rad
static const double FIRST_STEP_FACTOR = 50.0;

// of the closing speed at a local step's start: less than that at its end is none
static const double TURNED_SHARE = 0.03;

// restitutions below a tenth or so
static const double OVERDAMPED_FREQUENCIES = 8.0;

// The force grows as the power 1.5 of the time since the onset.
static void set_first_width(KernelContact *contact)
{
    contact->first_width_s = contact->frequency > 0.0
                                 ? cbrt(FIRST_STEP_FACTOR * FIRST_STEP_FACTOR * contact->tolerance *
                                        contact->tolerance) /
                                       contact->frequency
                                 : 0.0;
}

// How much the mobility of a contact has changed since the step before, in the time between their
// middles, relative to it.
static double response_change(const Kernel *kernel, const KernelContact *contact)
{
    const double *own = kernel_mobility(kernel, contact->first_row, contact->first_row);
    const double now[3] = {own[0], own[1], own[kernel->pitch + 1]};
    double change = 0.0;
    double size = 0.0;
    for (size_t i = 0; i < 3; i++) {
        change += (now[i] - contact->mobility_before[i]) * (now[i] - contact->mobility_before[i]);
        size += now[i] * now[i];
    }
    return sqrt(change / size);
}

// The error that is allowed where the response changes by a share in the step.
static double allowed_error(const Kernel *kernel, double change)
{
    return kernel->drift != NULL ? change * (DRIFT_SHARE + DRIFT_SQUARE * change)
                                 : ERROR_SHARE * change;
}

// of what presses in an ideal joint, the least change in a step by which its friction is judged
static const double RUB_CHANGE_LEAST = 1e-3;

// The same of the friction of an ideal joint, where what presses changes by a share.
static double rub_tolerance(const Kernel *kernel, size_t number, double duration_s)
{
    const KernelRub *rub = kernel_rub_of(kernel, number);
    const double change =
        duration_s * hypot(rub->rate[0], rub->rate[1]) / hypot(rub->reaction[0], rub->reaction[1]);
    const double known = change < 1.0 ? fmax(change, RUB_CHANGE_LEAST) : RUB_CHANGE_LEAST;
    return fmin(allowed_error(kernel, known), TOLERANCE_MOST);
}

// Sets the errors allowed of frictions of ideal joints: no more than of the contacts, whose impacts
// press in these joints far more than all that was known when the step began.
static void set_rub_tolerances(Kernel *kernel, double duration_s)
{
    double least = INFINITY;
    for (size_t i = 0; i < kernel->contact_count; i++) {
        const KernelContact *contact = &kernel->contacts[i];
        least = contact->is_rub ? least : fmin(least, contact->tolerance);
    }
    for (size_t i = 0; i < kernel->rub_count; i++) {
        const size_t contact = kernel->rubs[i].contact;
        kernel->contacts[contact].tolerance =
            fmin(rub_tolerance(kernel, contact, duration_s), least);
    }
}

// Sets the errors allowed: a share of what comes of the response being taken as constant, which
// moves a pin by W' h^2 / 12 for each newton second.
static void set_tolerances(Kernel *kernel, double duration_s)
{
    const double phase = kernel->phase;
    const double between_s = 0.5 * (duration_s + kernel->duration_before_s);
    for (size_t i = 0; i < kernel->contact_count; i++) {
        KernelContact *contact = &kernel->contacts[i];
        const double *own = kernel_mobility(kernel, contact->first_row, contact->first_row);
        if (phase > 0.0) {
            contact->tolerance = phase * phase * phase * phase * PHASE_ERROR;
        } else if (kernel->duration_before_s > 0.0) {
            const double change = response_change(kernel, contact) * duration_s / between_s;
            const double turned = fmin(1.0, contact->frequency * duration_s / M_PI);
            const double allowed = allowed_error(kernel, change) * turned;
            contact->tolerance = fmin(fmax(allowed, TOLERANCE_LEAST), TOLERANCE_MOST);
        } else {
            contact->tolerance = TOLERANCE_LEAST;
        }
        contact->mobility_before[0] = own[0];
        contact->mobility_before[1] = own[1];
        contact->mobility_before[2] = own[kernel->pitch + 1];
        set_first_width(contact);
    }
    kernel->duration_before_s = duration_s;
    set_rub_tolerances(kernel, duration_s);
}

// Works out how fast a contact that began with its impact speed will oscillate, and how long its
// first local step is.
static void expect_contact(Kernel *kernel, size_t number, Vec2 normal)
{
    KernelContact *contact = &kernel->contacts[number];
    kernel->stiff_width_s = 0.0;
    // the depth at which a spring of that frequency would have taken up the speed
    double depth = 1e-6;
    for (int i = 0; i < 8; i++) {
        const double speed = fmax(contact->state.impact_speed, contact->law.impact_speed_floor);
        depth = fmin(speed / kernel_force_frequency(kernel, number, normal, depth),
                     0.5 * force_law_depth_limit(&contact->law));
    }
    contact->frequency = kernel_force_frequency(kernel, number, normal, depth);
    const double mobility =
        contact->frequency * contact->frequency / force_law_tangent(&contact->law, depth);
    contact->force_per_speed = contact->frequency / mobility;
    set_first_width(contact);
    for (int k = 0; k < 2; k++) {
        kernel->longest_s[k] = contact->first_width_s;
    }
    contact->is_overdamped = kernel_force_decay(kernel, number, normal, depth) >
                             OVERDAMPED_FREQUENCIES * contact->frequency;
}

static void begin_contact(Kernel *kernel, size_t number, KernelPoint *point)
{
    const PinHole pose = *kernel_point_pose(kernel, point, number);
    kernel->contacts[number].state = contact_state_begun(pose.approach_speed);
    expect_contact(kernel, number, pose.normal);
    kernel_bristle_begin(kernel, number, point);
    if (kernel->contacts[number].shape == KERNEL_SLOT) {
        kernel_slot_find_part(kernel, number, point);
    }
}

static void end_contact(KernelContact *contact)
{
    contact->state.is_touching = false;
    contact->part = KERNEL_PART_NEAREST;
}

// Contacts that were set touching before a first step.
static void resume_contacts(Kernel *kernel, const KernelPoint *point)
{
    for (size_t i = 0; i < kernel->contact_count; i++) {
        const KernelContact *contact = &kernel->contacts[i];
        if (contact->state.is_touching && !contact->is_rub && contact->frequency == 0.0) {
            expect_contact(kernel, i, kernel_point_pose(kernel, point, i)->normal);
        }
    }
}

// Contacts that a step of the world finds begun or over already: by rounding, as the positions of
// the bodies and those of the step before differ in the last bits.
static void settle_contacts(Kernel *kernel, KernelPoint *point)
{
    for (size_t i = 0; i < kernel->contact_count; i++) {
        KernelContact *contact = &kernel->contacts[i];
        const PinHole *pose = kernel_point_pose(kernel, point, i);
        if (contact->state.is_touching) {
            contact->state.is_touching = pose->penetration > 0.0 || pose->approach_speed > 0.0;
            if (contact->shape == KERNEL_SLOT && contact->state.is_touching) {
                kernel_slot_find_part(kernel, i, point);
            }
        } else if (pose->penetration > 0.0 && pose->approach_speed > 0.0) {
            begin_contact(kernel, i, point);
        }
    }
}

// After a run all poses are those of the nearest part again, whenever they are asked for.
static bool leave_parts(Kernel *kernel, bool is_run)
{
    for (size_t i = 0; i < kernel->contact_count; i++) {
        kernel->contacts[i].part = KERNEL_PART_NEAREST;
    }
    return is_run;
}

static void change_contacts(Kernel *kernel, KernelPoint *point)
{
    for (size_t i = 0; i < kernel->contact_count; i++) {
        if (!kernel->work->has_event[i]) {
            continue;
        }
        if (kernel->contacts[i].state.is_touching) {
            end_contact(&kernel->contacts[i]);
        } else {
            begin_contact(kernel, i, point);
        }
    }
}

// Lets impacts be over by the end of a local step. Returns whether any is whose force changes.
static bool rest_contacts(Kernel *kernel, const KernelPoint *from, const KernelPoint *to)
{
    bool is_any = false;
    for (size_t i = 0; i < kernel->contact_count; i++) {
        KernelContact *contact = &kernel->contacts[i];
        if (!contact->state.is_touching || !(contact->law.resting_speed > 0.0)) {
            continue;
        }
        const double closing = kernel_point_pose(kernel, to, i)->approach_speed;
        const double before = kernel_point_pose(kernel, from, i)->approach_speed;
        // the step was shortened to where it turns, by a line
        const bool has_turned = closing < 0.0 && closing > TURNED_SHARE * before;
        const double turned = has_turned && contact->state.is_released ? 0.0 : closing;
        is_any =
            contact_state_follow(&contact->state, turned, contact->law.resting_speed) || is_any;
    }
    return is_any;
}

// The point at the start of a step.
static void begin_step(const Kernel *kernel, KernelPoint *point)
{
    kernel_point_begin(kernel, point, 0.0);
    memset(point->impulse, 0, kernel->row_count * sizeof *point->impulse);
    memset(point->moment, 0, 2 * kernel->row_count * sizeof *point->moment);
    memset(point->losses, 0, sizeof point->losses);
}

// Finds forces and rates at the end of a local step.
static void complete(Kernel *kernel, KernelPoint *point)
{
    kernel_rates_find(kernel, point);
    if (kernel->rub_count > 0 && kernel_rubs_face(kernel, point)) {
        kernel_rates_find(kernel, point);
    }
}

bool kernel_run(Kernel *kernel, double duration)
{
    KernelPoint *from = &kernel->work->ends[0];
    KernelPoint *to = &kernel->work->ends[1];
    LocalStep step;
    begin_step(kernel, from);
    kernel_nodes_begin(kernel);
    kernel->event_count = 0;
    set_tolerances(kernel, duration);
    resume_contacts(kernel, from);
    kernel_rubs_begin(kernel, from);
    kernel_bristles_take(kernel, from);
    if (kernel_rubs_hold(kernel, from)) {
        kernel_bristles_take(kernel, from);
    }
    settle_contacts(kernel, from);
    complete(kernel, from);
    kernel_nodes_add(kernel, from);
    const double rounding_s = 1e-14 * duration;
    while (duration - from->time_s > rounding_s) {
        if (kernel->node_count > NODE_MAX || kernel->event_count > kernel->event_most ||
            (kernel->work_most > 0.0 && kernel->work_done > kernel->work_most)) {
            return leave_parts(kernel, false);
        }
        size_t events;
        step.from = from;
        // what others do is smooth between the ends of their contacts
        const double stop_s = fmin(duration, kernel_input_stop(kernel, from->time_s + rounding_s));
        if (!kernel_local_step(kernel, &step, stop_s - from->time_s, to, &events)) {
            continue;
        }
        if (fabs(to->time_s - stop_s) <= rounding_s && stop_s < duration) {
            kernel_point_begin(kernel, to, stop_s);
            step.is_ended = false;
        }
        if (step.method == LOCAL_STEP_IMPLICIT && kernel->node_count == 1) {
            kernel_nodes_settle(kernel);
        }
        if (step.is_ended && events == 0) {
            kernel_explicit_extend(kernel, &step.explicit, from, to);
        } else {
            complete(kernel, to);
        }
        kernel_nodes_add(kernel, to);
        const bool is_over = rest_contacts(kernel, from, to);
        if (events != 0) {
            kernel->event_count++;
            change_contacts(kernel, to);
        }
        if (events != 0 || is_over) {
            complete(kernel, to);
            kernel_nodes_add(kernel, to);
        }
        KernelPoint *const spare = from;
        from = to;
        to = spare;
    }
    kernel_bristles_give(kernel, from);
    return leave_parts(kernel, true);
}
