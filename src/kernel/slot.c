// Follows pins in slots: at which part of the wall they are, and when one in flight is back at it.
//
// At a part of the wall the force is smooth; where the pin passes the centre of an end's arc, y =
// +-l in the slot's axes, the curvature of the gap jumps, and with it the rates of the force. A
// local step ends there, and the next one begins at the other part.
//
// A flight is under a constant acceleration.
// In the slot's axes p(t) = p + v t + a t^2 / 2. Where it passes the ends' centres, y = +-l, its
// distance from the middle line changes from one polynomial to another. It is back where
//     x = +-w                  between the ends
//     |p - (0, +-l)|^2 = w^2   beyond one
// with w the distance that it starts at, and leaves.
#include "kernel/internal.h"

// of a slot's play: so far from the end of its part a pin is there
static const double PART_ROUNDING = 1e-9;

double kernel_slot_rounding(const KernelContact *contact)
{
    return PART_ROUNDING * contact->radial_clearance;
}

double kernel_slot_beyond(const Kernel *kernel, size_t contact, const KernelPoint *point)
{
    const KernelContact *of = &kernel->contacts[contact];
    const double y = kernel_motion_position(kernel, contact, point).y;
    switch (of->part) {
    case KERNEL_PART_LOW:
        return y + of->half_length;
    case KERNEL_PART_HIGH:
        return of->half_length - y;
    case KERNEL_PART_NEAREST:
    case KERNEL_PART_WALLS:
        break;
    }
    return fabs(y) - of->half_length;
}

void kernel_slot_find_part(Kernel *kernel, size_t contact, KernelPoint *point)
{
    KernelContact *of = &kernel->contacts[contact];
    KernelKnownPose *known = &point->known[contact];
    kernel_point_pose(kernel, point, contact);
    const double y = kernel_motion_position(kernel, contact, point).y;
    const double outward = y > 0.0 ? known->speed[1] : -known->speed[1];
    const double beyond = fabs(y) - of->half_length;
    const bool is_at_end = fabs(beyond) <= kernel_slot_rounding(of) ? outward > 0.0 : beyond > 0.0;
    of->part = !is_at_end ? KERNEL_PART_WALLS : y > 0.0 ? KERNEL_PART_HIGH : KERNEL_PART_LOW;
    known->is_known = false;
}

bool kernel_slots_follow(Kernel *kernel, KernelPoint *point)
{
    bool is_any = false;
    for (size_t i = 0; i < kernel->contact_count; i++) {
        const KernelContact *contact = &kernel->contacts[i];
        if (contact->part != KERNEL_PART_NEAREST &&
            kernel_slot_beyond(kernel, i, point) >= -kernel_slot_rounding(contact)) {
            kernel_slot_find_part(kernel, i, point);
            is_any = true;
        }
    }
    return is_any;
}

enum { DEGREE_MOST = 4, CHANGES_MOST = 4, ROOT_HALVINGS = 100 };

// A polynomial over time, its constant first.
typedef struct Polynomial {
    int degree;
    double c[DEGREE_MOST + 1];
} Polynomial;

static double polynomial_at(const Polynomial *of, double t)
{
    double sum = of->c[of->degree];
    for (int k = of->degree; k-- > 0;) {
        sum = of->c[k] + t * sum;
    }
    return sum;
}

// Where it changes its sign between two times at which it has two.
static double change_between(const Polynomial *of, double low, double high)
{
    const bool is_high_above = polynomial_at(of, high) > 0.0;
    for (int i = 0; i < ROOT_HALVINGS && high - low > 1e-16 * high; i++) {
        const double middle = 0.5 * (low + high);
        const bool is_above = polynomial_at(of, middle) > 0.0;
        *(is_above == is_high_above ? &high : &low) = middle;
    }
    return high;
}

// The times between 0 and the last one at which it changes its sign, in their order.
static size_t find_changes(const Polynomial *of, double last, double changes[DEGREE_MOST])
{
    double turns[DEGREE_MOST + 1];
    size_t turn_count = 0;
    size_t count = 0;
    if (of->degree > 1) {
        Polynomial slope = {.degree = of->degree - 1};
        for (int k = 0; k < of->degree; k++) {
            slope.c[k] = (k + 1) * of->c[k + 1];
        }
        turn_count = find_changes(&slope, last, turns);
    }
    turns[turn_count++] = last;
    double low = 0.0;
    for (size_t i = 0; i < turn_count; i++) {
        const bool was_above = polynomial_at(of, low) > 0.0;
        if ((polynomial_at(of, turns[i]) > 0.0) != was_above) {
            changes[count++] = change_between(of, low, turns[i]);
        }
        low = turns[i];
    }
    return count;
}

// Where the pin is after some time.
static Vec2 flown(const SlotFlight *flight, double t)
{
    return vec2_add(
        flight->position,
        vec2_scale(t, vec2_add(flight->speed, vec2_scale(0.5 * t, flight->acceleration))));
}

// The square of its distance from the middle line over that of the wall's less 1, from a time on:
// of the part of the slot where it is after another one.
static Polynomial distance_from(const SlotFlight *flight, double from_s, double part_s)
{
    const Vec2 a = flight->acceleration;
    Vec2 p = flown(flight, from_s);
    Vec2 v = vec2_add(flight->speed, vec2_scale(from_s, a));
    const double y = flown(flight, part_s).y;
    Vec2 bent = a;
    if (fabs(y) <= flight->half_length) {
        p.y = v.y = bent.y = 0.0;
    } else {
        p.y -= copysign(flight->half_length, y);
    }
    return (Polynomial){
        .degree = DEGREE_MOST,
        .c = {vec2_dot(p, p) - flight->distance * flight->distance, 2.0 * vec2_dot(p, v),
              vec2_dot(v, v) + vec2_dot(p, bent), vec2_dot(v, bent), 0.25 * vec2_dot(bent, bent)},
    };
}

// The first time above 0 at which it is no longer below 0; at 0 it is 0 to rounding, and falls, in
// the first part.
static double first_rise(Polynomial *of, bool is_first, double last)
{
    double changes[DEGREE_MOST];
    if (is_first) {
        // without its root at the start
        of->degree--;
        for (int k = 0; k <= of->degree; k++) {
            of->c[k] = of->c[k + 1];
        }
    }
    if (polynomial_at(of, 0.0) >= 0.0) {
        return is_first ? INFINITY : 0.0;
    }
    return find_changes(of, last, changes) > 0 ? changes[0] : INFINITY;
}

// The times up to the last one at which the pin passes the ends' centres, in their order.
static size_t find_parts(const SlotFlight *flight, double last_s, double parts[CHANGES_MOST + 1])
{
    size_t count = 0;
    for (int end = 0; end < 2; end++) {
        const Polynomial past = {
            .degree = 2,
            .c = {flight->position.y + (end == 0 ? flight->half_length : -flight->half_length),
                  flight->speed.y, 0.5 * flight->acceleration.y},
        };
        double changes[DEGREE_MOST];
        const size_t found = find_changes(&past, last_s, changes);
        for (size_t i = 0; i < found; i++) {
            size_t at = count++;
            for (; at > 0 && parts[at - 1] > changes[i]; at--) {
                parts[at] = parts[at - 1];
            }
            parts[at] = changes[i];
        }
    }
    parts[count++] = last_s;
    return count;
}

double kernel_slot_return(const SlotFlight *flight, double last_s)
{
    double parts[CHANGES_MOST + 1];
    const size_t count = find_parts(flight, last_s, parts);
    double from_s = 0.0;
    for (size_t i = 0; i < count; i++) {
        Polynomial distance = distance_from(flight, from_s, 0.5 * (from_s + parts[i]));
        const double back_s = from_s + first_rise(&distance, i == 0, parts[i] - from_s);
        if (back_s <= parts[i]) {
            return back_s;
        }
        from_s = parts[i];
    }
    return INFINITY;
}
