// Takes explicit local steps, by methods that use the forces and their rates in time.
//
// For P' = f, Q' = P, with f' along the motion at two or three points of a step h:
//     order 4    P_c = P + c h f + (c h)^2 / 2 f',   c = 1/2
//                P+  = P + h f + h^2 (f' / 6 + f'_c / 3)
//     order 5    P_c as above, c = 2/5,   P_1 = P + h f + h^2 (3 f'_c - f') / 4
//                P+  = P + h f + h^2 (f' / 8 + 25/72 f'_c + f'_1 / 36)
// with Q one power of h further, at the stages by what f and f' say of it beyond that:
//     Q_c = Q + c h P + (c h)^2 / 2 f + (c h)^3 / 6 f'
//     Q_1 = Q + h P + h^2 / 2 f + h^3 (f' / 16 + 5/48 f'_c)
//     Q+  = Q + h P + h^2 (3/10 f + 1/5 f_c) + h^3 / 30 (f' + f'_c)           order 4
//     Q+  = Q + h P + h^2 (f / 8 + 25/72 f_c + f_1 / 36)                      order 5
// On a spring, at theta = h times its frequency, the errors relative to the amplitude are
// theta^5 / 120 and theta^6 / 3600; stable up to 2.9 and 1.
//
// The error is estimated without any further force. h^3 f''' is 12 / c^3 times the amount by which
// the trapezoidal rule for f' misses the change of f up to c; what of the error is beyond it
// follows from the contact's frequency, or where a force that is no power of 1 begins or ends from
// how near that is.
//
// The integral of Q need not be as good, for it stands beside the change of the mobility only:
//     R+ = R + h Q + h^2 / 2 P + h^3 / 6 f + h^4 / 24 f'
//
// Sources: R. P. K. Chan and A. Y. J. Tsai, Numer. Algorithms 53 (2010) 171, for the two methods.
#include "kernel/internal.h"

#include <float.h>
#include <math.h>
#include <string.h>

enum { POWERS = 2 }; // lost in damping and in friction

static const double MIDDLE_SHARES[2] = {1.0 / 2.0, 2.0 / 5.0};
static const double THETA_MOST[2] = {2.2, 1.0};
static const double ERROR_FACTORS[2] = {1.0 / 120.0, 1.0 / 3600.0};

// what the cubic misses at the end, in powers of theta as above, and how many times the error that
// is allowed of impulses it may be: forces are not summed up
static const double EXTEND_FACTORS[2] = {1.0 / 96.0, 0.36 / 24.0};
static const double EXTEND_MOST = 10.0;

// of the force of the impact that a contact began with, a share by which its errors are judged as
// long as it lasts: what is left of that impact's own errors is as large
static const double IMPACT_FORCE_SHARE = 1.0;

static const double EXPLICIT_SAFETY = 0.85;

// The integrals of the moments a time after a point.
static void add_second(const Kernel *kernel, const KernelPoint *from, KernelSpan span,
                       double since_s, double *moment)
{
    const size_t rows = kernel->row_count;
    for (size_t i = span.first; i < span.end; i++) {
        const double bend = from->force[i] / 6.0 + since_s / 24.0 * from->rate[i];
        moment[rows + i] =
            from->moment[rows + i] +
            since_s * (from->moment[i] + since_s * (0.5 * from->impulse[i] + since_s * bend));
    }
}

static KernelSpan all_rows(const Kernel *kernel)
{
    return (KernelSpan){0, kernel->row_count};
}

// The point at a share c of a step, by the rates at its start.
static void find_middle_point(const Kernel *kernel, const KernelPoint *from, double since_s,
                              KernelPoint *point)
{
    kernel_point_begin(kernel, point, from->time_s + since_s);
    for (size_t i = 0; i < kernel->row_count; i++) {
        const double half = 0.5 * since_s * from->rate[i];
        point->impulse[i] = from->impulse[i] + since_s * (from->force[i] + half);
        point->moment[i] =
            from->moment[i] +
            since_s * (from->impulse[i] + since_s * (0.5 * from->force[i] + half / 3.0));
    }
    add_second(kernel, from, all_rows(kernel), since_s, point->moment);
    if (kernel->has_bristles) {
        kernel_bends_middle(kernel, from, since_s, point);
    }
}

static void finish_order_4(const Kernel *kernel, const KernelPoint *from, double h,
                           const KernelPoint *inside, KernelPoint *to)
{
    for (size_t i = 0; i < kernel->row_count; i++) {
        const double rates = h * (from->rate[i] / 6.0 + inside->rate[i] / 3.0);
        const double second = 0.3 * from->force[i] + 0.2 * inside->force[i] +
                              h / 30.0 * (from->rate[i] + inside->rate[i]);
        to->impulse[i] = from->impulse[i] + h * (from->force[i] + rates);
        to->moment[i] = from->moment[i] + h * (from->impulse[i] + h * second);
    }
    if (kernel->has_bristles) {
        kernel_bends_finish(kernel, from, h, inside, NULL, to);
    }
    for (size_t i = 0; i < POWERS; i++) {
        const double rates = h * (from->power_rates[i] / 6.0 + inside->power_rates[i] / 3.0);
        to->losses[i] = from->losses[i] + h * (from->powers[i] + rates);
    }
}

static void finish_order_5(Kernel *kernel, const KernelPoint *from, double h,
                           const KernelPoint *inside, KernelPoint *to)
{
    KernelPoint *last = &kernel->work->last;
    kernel_point_begin(kernel, last, from->time_s + h);
    for (size_t i = 0; i < kernel->row_count; i++) {
        const double rates = 0.25 * h * (3.0 * inside->rate[i] - from->rate[i]);
        const double second =
            0.5 * from->force[i] + h * (from->rate[i] / 16.0 + 5.0 / 48.0 * inside->rate[i]);
        last->impulse[i] = from->impulse[i] + h * (from->force[i] + rates);
        last->moment[i] = from->moment[i] + h * (from->impulse[i] + h * second);
    }
    add_second(kernel, from, all_rows(kernel), h, last->moment);
    if (kernel->has_bristles) {
        kernel_bends_last(kernel, from, h, inside, last);
    }
    // what others do may jump at the end of the step, not inside it
    kernel_input_look(kernel, true);
    kernel_rates_find(kernel, last);
    kernel_input_look(kernel, false);
    for (size_t i = 0; i < kernel->row_count; i++) {
        const double rates =
            h * (from->rate[i] / 8.0 + 25.0 / 72.0 * inside->rate[i] + last->rate[i] / 36.0);
        const double second =
            from->force[i] / 8.0 + 25.0 / 72.0 * inside->force[i] + last->force[i] / 36.0;
        to->impulse[i] = from->impulse[i] + h * (from->force[i] + rates);
        to->moment[i] = from->moment[i] + h * (from->impulse[i] + h * second);
    }
    if (kernel->has_bristles) {
        kernel_bends_finish(kernel, from, h, inside, last, to);
    }
    for (size_t i = 0; i < POWERS; i++) {
        const double rates =
            h * (from->power_rates[i] / 8.0 + 25.0 / 72.0 * inside->power_rates[i] +
                 last->power_rates[i] / 36.0);
        to->losses[i] = from->losses[i] + h * (from->powers[i] + rates);
    }
}

void kernel_explicit_step(Kernel *kernel, const KernelPoint *from, int order, double width_s,
                          ExplicitStep *step, KernelPoint *to)
{
    step->order = order;
    step->width_s = width_s;
    step->middle = MIDDLE_SHARES[order - 4];
    step->inside = &kernel->work->inside;
    find_middle_point(kernel, from, step->middle * width_s, step->inside);
    kernel_rates_find(kernel, step->inside);
    kernel_point_begin(kernel, to, from->time_s + width_s);
    add_second(kernel, from, all_rows(kernel), width_s, to->moment);
    if (order == 4) {
        finish_order_4(kernel, from, width_s, step->inside, to);
    } else {
        finish_order_5(kernel, from, width_s, step->inside, to);
    }
}

// The cubic f + s h f' + a s^2 + b s^3 through a force and its rate at 0 and at c.
static void find_cubic(double c, double f, double slope, double at_c, double slope_at_c, double *a,
                       double *b)
{
    const double rise = at_c - f - c * slope;
    const double bend = slope_at_c - slope;
    *a = (3.0 * rise - c * bend) / (c * c);
    *b = (c * bend - 2.0 * rise) / (c * c * c);
}

void kernel_explicit_inside(const Kernel *kernel, const ExplicitStep *step, const KernelPoint *from,
                            KernelSpan span, double share, double *impulse, double *moment)
{
    const double h = step->width_s;
    const double s = share;
    for (size_t i = span.first; i < span.end; i++) {
        double a;
        double b;
        const double slope = h * from->rate[i];
        find_cubic(step->middle, from->force[i], slope, step->inside->force[i],
                   h * step->inside->rate[i], &a, &b);
        impulse[i] = from->impulse[i] +
                     h * s * (from->force[i] + s * (slope / 2.0 + s * (a / 3.0 + s * b / 4.0)));
        moment[i] = from->moment[i] + h * s * from->impulse[i] +
                    h * h * s * s *
                        (from->force[i] / 2.0 + s * (slope / 6.0 + s * (a / 12.0 + s * b / 20.0)));
    }
    add_second(kernel, from, span, h * s, moment);
}

double kernel_explicit_bend(const ExplicitStep *step, const KernelPoint *from, size_t contact,
                            double since_s)
{
    const double h = step->width_s;
    const double s = since_s / h;
    const KernelBend *start = &from->bends[contact];
    const KernelBend *inside = &step->inside->bends[contact];
    const double slope = h * start->bending_rate;
    double a;
    double b;
    find_cubic(step->middle, start->bending, slope, inside->bending, h * inside->bending_rate, &a,
               &b);
    return start->bend + h * s * (start->bending + s * (slope / 2.0 + s * (a / 3.0 + s * b / 4.0)));
}

void kernel_explicit_forces(const Kernel *kernel, const ExplicitStep *step, const KernelPoint *from,
                            double since_s, double *force)
{
    const double h = step->width_s;
    const double s = since_s / h;
    for (size_t i = 0; i < kernel->row_count; i++) {
        double a;
        double b;
        const double slope = h * from->rate[i];
        find_cubic(step->middle, from->force[i], slope, step->inside->force[i],
                   h * step->inside->rate[i], &a, &b);
        force[i] = from->force[i] + s * (slope + s * (a + s * b));
    }
}

void kernel_explicit_extend(const Kernel *kernel, const ExplicitStep *step, const KernelPoint *from,
                            KernelPoint *to)
{
    const double h = step->width_s;
    for (size_t i = 0; i < kernel->row_count; i++) {
        double a;
        double b;
        find_cubic(step->middle, from->force[i], h * from->rate[i], step->inside->force[i],
                   h * step->inside->rate[i], &a, &b);
        to->force[i] = from->force[i] + h * from->rate[i] + a + b;
    }
}

// h^3 times the third derivative of a contact's force, N.
static double third_change(const KernelContact *contact, const ExplicitStep *step,
                           const KernelPoint *from)
{
    double square = 0.0;
    for (size_t i = contact->first_row; i < contact->first_row + KERNEL_ROWS_PLAIN; i++) {
        const double c = step->middle;
        const double missed = step->inside->force[i] - from->force[i] -
                              0.5 * c * step->width_s * (from->rate[i] + step->inside->rate[i]);
        square += missed * missed;
    }
    return 12.0 * sqrt(square) / (step->middle * step->middle * step->middle);
}

// What says how large a contact's error is, and how large it may be.
typedef struct Allowance {
    double frequency; // rad/s
    double fastest;   // 1/s, that or whatever else changes its force faster
    double force;     // N
} Allowance;

static Allowance allow_contact(const Kernel *kernel, const ExplicitStep *step,
                               const KernelPoint *from, size_t number)
{
    const KernelContact *contact = &kernel->contacts[number];
    const PinHole pose = *kernel_point_pose(kernel, step->inside, number);
    const double depth = fmax(pose.penetration, 0.0);
    const double frequency = kernel_force_frequency(kernel, number, pose.normal, depth);
    double fastest = frequency;
    if (contact->law.friction > 0.0) {
        fastest = fmax(fastest, 1.0 / kernel_force_friction_time(kernel, number, from->force));
    }
    const bool is_linear = contact->law.family == FORCE_LAW_POWER && contact->law.exponent == 1.0 &&
                           contact->law.full_damping_depth == 0.0;
    if (!is_linear && depth > 0.0) {
        fastest = fmax(fastest, 1.5 * fabs(pose.approach_speed) / depth);
    }
    const double *force = step->inside->force + contact->first_row;
    return (Allowance){
        .frequency = frequency,
        .fastest = fastest,
        .force =
            fmax(contact->force_per_speed * fmax(fabs(pose.approach_speed),
                                                 IMPACT_FORCE_SHARE * contact->state.impact_speed),
                 vec2_length((Vec2){force[0], force[1]})),
    };
}

static Allowance allow_rub(const Kernel *kernel, const KernelPoint *from, size_t number)
{
    return (Allowance){
        .fastest = 1.0 / kernel_rub_time(kernel, from, number),
        .force = fmax(kernel_rub_of(kernel, number)->most, DBL_MIN),
    };
}

double kernel_explicit_error(const Kernel *kernel, ExplicitStep *step, const KernelPoint *from,
                             double longest_s[2])
{
    const double h = step->width_s;
    double worst = 0.0;
    longest_s[0] = longest_s[1] = INFINITY;
    step->extends = true;
    for (size_t i = 0; i < kernel->contact_count; i++) {
        const KernelContact *contact = &kernel->contacts[i];
        if (!contact->state.is_touching) {
            continue;
        }
        const Allowance of =
            contact->is_rub ? allow_rub(kernel, from, i) : allow_contact(kernel, step, from, i);
        const double changes = third_change(contact, step, from);
        const double allowed = contact->tolerance * of.force;
        // error over what is allowed, of either order at this length
        const double theta = of.fastest * h;
        const double errors[2] = {ERROR_FACTORS[0] * theta * changes / allowed,
                                  ERROR_FACTORS[1] * theta * theta * changes / allowed};
        const double own = errors[step->order - 4];
        step->extends = step->extends &&
                        EXTEND_FACTORS[step->order - 4] * theta * changes <= EXTEND_MOST * allowed;
        worst = own <= worst ? worst : own; // a NaN must show
        const double shares[2] = {1.0 / sqrt(sqrt(errors[0])), pow(errors[1], -1.0 / 5.0)};
        for (int k = 0; k < 2; k++) {
            const double wanted_s = EXPLICIT_SAFETY * shares[k] * h;
            longest_s[k] = fmin(longest_s[k], fmin(wanted_s, THETA_MOST[k] / of.frequency));
        }
    }
    return worst;
}
