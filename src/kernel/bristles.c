// Follows the bristles of contacts with friction that holds (kernel/bristle.h) through local steps.
//
// A bend z is integrated like an impulse, from its rate and that one's. A mode ends where a margin
// does; a local step ends there too. Friction is continuous across that, and within a mode smooth
// beyond its end, so that the end need not be found to rounding.
#include "kernel/internal.h"

#include <math.h>

// of a margin, beyond which a mode is over
static const double MARGIN_PASSED = 1e-9;

enum { MARGINS = 2, END_HALVINGS = 50, SETTLES_MOST = 4 };

// Contacts to go through: none where no friction holds.
static inline size_t count_of(const Kernel *kernel)
{
    return kernel->has_bristles ? kernel->contact_count : 0;
}

// How fast what is left of the friction changes with the sliding speed, s/m.
static double left_slope(const BristlePair *pair, double speed)
{
    const double over = speed / pair->speed;
    return pair->ratio == 1.0 ? 0.0
                              : -2.0 * (pair->ratio - 1.0) * over / pair->speed * exp(-over * over);
}

BristleRates kernel_bristle_rates(const KernelContact *contact, KernelBend *bend,
                                  const double pressing[2], const double speed[2])
{
    if (pressing[0] == 0.0 && pressing[1] == 0.0) {
        // it overlaps, but nothing presses any more
        bend->bending = bend->bending_rate = 0.0;
        return (BristleRates){0.0, 0.0};
    }
    const BristlePair pair = contact->is_rub ? contact->law.bristle
                                             : bristle_pressed(&contact->law.bristle, pressing[0]);
    const BristleMode mode = contact->state.bristle;
    const BristleHold hold = bristle_hold(&pair, mode, bend->bend, speed[0]);
    const double way = bristle_way(mode);
    const double slope = left_slope(&pair, speed[0]) * speed[1];
    const double stiffness = pair.ratio / pair.limit;
    const double damping_rate = pressing[0] > 0.0 && !contact->is_rub
                                    ? -0.5 * pair.damping * pressing[1] / pressing[0]
                                    : 0.0;
    bend->bending = hold.bending;
    bend->bending_rate = bristle_slides(mode) ? 0.0 : speed[1];
    return (BristleRates){
        .share = hold.share,
        .share_rate = way == 0.0 ? (stiffness + damping_rate) * speed[0] + pair.damping * speed[1]
                                 : way * slope,
    };
}

static double bend_after(KernelBend from, double h, double first, double second)
{
    return from.bend + h * (from.bending + h * (first + second));
}

void kernel_bends_middle(const Kernel *kernel, const KernelPoint *from, double since_s,
                         KernelPoint *point)
{
    for (size_t i = 0; i < count_of(kernel); i++) {
        point->bends[i].bend =
            bend_after(from->bends[i], since_s, 0.5 * from->bends[i].bending_rate, 0.0);
    }
}

void kernel_bends_last(const Kernel *kernel, const KernelPoint *from, double h,
                       const KernelPoint *inside, KernelPoint *point)
{
    for (size_t i = 0; i < count_of(kernel); i++) {
        point->bends[i].bend = bend_after(from->bends[i], h, 0.75 * inside->bends[i].bending_rate,
                                          -0.25 * from->bends[i].bending_rate);
    }
}

void kernel_bends_finish(const Kernel *kernel, const KernelPoint *from, double h,
                         const KernelPoint *inside, const KernelPoint *last, KernelPoint *to)
{
    for (size_t i = 0; i < count_of(kernel); i++) {
        const double start = from->bends[i].bending_rate;
        const double middle = inside->bends[i].bending_rate;
        to->bends[i].bend = last == NULL
                                ? bend_after(from->bends[i], h, start / 6.0, middle / 3.0)
                                : bend_after(from->bends[i], h, start / 8.0 + 25.0 / 72.0 * middle,
                                             last->bends[i].bending_rate / 36.0);
    }
}

void kernel_bends_keep(const Kernel *kernel, const KernelPoint *from, KernelPoint *to)
{
    for (size_t i = 0; i < count_of(kernel); i++) {
        to->bends[i] = from->bends[i];
    }
}

void kernel_bristle_begin(Kernel *kernel, size_t number, KernelPoint *point)
{
    KernelContact *contact = &kernel->contacts[number];
    point->bends[number] = (KernelBend){0.0, 0.0, 0.0};
    contact->state.bend = 0.0;
    if (contact->has_bristle) {
        contact->state.bristle = bristle_onset(kernel_force_sliding(kernel, point, number));
    }
}

// A margin of a contact's mode at a point, and the mode that follows.
static double margin_at(const Kernel *kernel, const KernelPoint *point, size_t number, int which,
                        BristleMode *next)
{
    const KernelContact *contact = &kernel->contacts[number];
    if (contact->is_rub) {
        return bristle_margin(&contact->law.bristle, contact->state.bristle, which,
                              point->bends[number].bend,
                              kernel_force_sliding(kernel, point, number), next);
    }
    const double pressing = contact->law.friction * kernel_force_pressing(kernel, point, number);
    if (pressing == 0.0 && kernel_point_pose(kernel, point, number)->approach_speed < 0.0) {
        return INFINITY;
    }
    const BristlePair pair = bristle_pressed(&contact->law.bristle, pressing);
    return bristle_margin(&pair, contact->state.bristle, which, point->bends[number].bend,
                          kernel_force_sliding(kernel, point, number), next);
}

void kernel_bristles_take(Kernel *kernel, KernelPoint *point)
{
    for (size_t i = 0; i < count_of(kernel); i++) {
        KernelContact *contact = &kernel->contacts[i];
        point->bends[i] = (KernelBend){.bend = contact->state.bend};
        if (!contact->state.is_touching || !contact->has_bristle) {
            continue;
        }
        for (int k = 0; k < SETTLES_MOST * MARGINS; k++) {
            BristleMode next;
            if (margin_at(kernel, point, i, k % MARGINS, &next) < -MARGIN_PASSED) {
                contact->state.bristle = next;
            }
        }
    }
}

void kernel_bristles_give(Kernel *kernel, const KernelPoint *point)
{
    for (size_t i = 0; i < count_of(kernel); i++) {
        kernel->contacts[i].state.bend = point->bends[i].bend;
    }
}

// The width at which a margin passes: between one at which it has not and one at which it has.
static double find_end(Kernel *kernel, LocalStep *step, size_t number, int which, double width_s)
{
    double low = 0.0;
    double high = width_s;
    BristleMode next;
    for (int i = 0; i < END_HALVINGS && high - low > 1e-13 * width_s; i++) {
        const double middle = 0.5 * (low + high);
        kernel_local_step_inside(kernel, step, number, middle);
        const bool is_over =
            margin_at(kernel, &kernel->work->trial, number, which, &next) < -MARGIN_PASSED;
        *(is_over ? &high : &low) = middle;
    }
    return high;
}

bool kernel_bristles_shorten(Kernel *kernel, LocalStep *step, const KernelPoint *to,
                             double *width_s)
{
    const double whole_s = *width_s;
    for (size_t i = 0; i < count_of(kernel); i++) {
        const KernelContact *contact = &kernel->contacts[i];
        kernel->work->mode_ends_s[i] = INFINITY;
        if (!contact->state.is_touching || !contact->has_bristle) {
            continue;
        }
        for (int which = 0; which < MARGINS; which++) {
            BristleMode next;
            if (margin_at(kernel, to, i, which, &next) < -MARGIN_PASSED) {
                const double end_s = find_end(kernel, step, i, which, whole_s);
                if (end_s < kernel->work->mode_ends_s[i]) {
                    kernel->work->mode_ends_s[i] = end_s;
                    kernel->work->modes[i] = next;
                }
            }
        }
        *width_s = fmin(*width_s, kernel->work->mode_ends_s[i]);
    }
    return *width_s < whole_s;
}

bool kernel_bristles_follow(Kernel *kernel, KernelPoint *point, double width_s)
{
    bool is_any = false;
    for (size_t i = 0; i < count_of(kernel); i++) {
        if (kernel->work->mode_ends_s[i] <= width_s) {
            KernelContact *contact = &kernel->contacts[i];
            const bool has_slid = bristle_slides(contact->state.bristle);
            contact->state.bristle = kernel->work->modes[i];
            is_any = true;
            if (bristle_slides(contact->state.bristle)) {
                // a bristle without damping would stick and yield by what rounding leaves beyond
                point->bends[i].bend =
                    bristle_way(contact->state.bristle) * contact->law.bristle.limit;
            }
            if (contact->is_rub && has_slid) {
                kernel_rub_stick_at(kernel, i, point);
            }
        }
    }
    return is_any;
}
