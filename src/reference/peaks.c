// When do the force and the depth of a contact stop growing?
//
//     F = F_el(d) (1 + chi d'/v0) + c d'
//     dF/dt = F_el' d' (1 + chi d'/v0) + (F_el chi / v0 + c) d''
// A maximum lies where such a rate turns from positive to negative; it is found on the polynomial
// of the step.
#include "reference/peaks.h"

#include "base/root.h"
#include "base/zeroed.h"

// of a step: a maximum missed by so much is too low by half the square of it, 1e-10 of itself
static const double NARROW = 1e-5;

// how much higher than both its ends a part of a step can rise: it is a seventh of a swing or so
static const double OVERSHOOT = 1.5;

// Which of the quantities of a contact.
enum { PEAK_FORCE, PEAK_DEPTH, PEAK_COUNT };

// Maxima that a step is handed on in parts for; more are found together.
enum { SOUGHT_MOST = 8 };

typedef struct Search {
    Stepper *stepper;
    SystemState *scratch;
    size_t contact;
    int which;
} Search;

Peaks peaks_create(const System *system, SystemState *scratch)
{
    return (Peaks){
        .scratch = scratch,
        .peaks = zeroed(PEAK_COUNT * system->contact_count, sizeof(Peak)),
        .crowd = peaks_crowd_create(system, scratch),
    };
}

void peaks_finish(Peaks *peaks)
{
    free(peaks->peaks);
    peaks_crowd_finish(&peaks->crowd);
}

static double peak_rate(double time, void *context)
{
    const Search *search = context;
    const System *system = search->stepper->system;
    double values[PEAK_COUNT];
    double rates[PEAK_COUNT];
    const double *y = dop853_dense(&search->stepper->integrator, time);
    if (search->which == PEAK_DEPTH) {
        // its rate needs no accelerations
        return system->kind->press(system, search->contact, time, y).closing;
    }
    if (!system->kind->evaluate(system, time, y, search->scratch, NULL)) {
        return NAN;
    }
    system->kind->peak(system, search->scratch, search->contact, values, rates);
    return rates[search->which];
}

// Whether a maximum of one quantity lies behind where it was left, and could be the largest of its
// contact.
static bool has_peak(const Peak *peak)
{
    return peak->was_rising && peak->rate < 0.0 &&
           OVERSHOOT * fmax(peak->value, peak->last) > peak->largest;
}

// When a maximum of one quantity is passed up to the end of a step, s; INFINITY: not at all. It is
// sought once, however many maxima of other contacts the step is interrupted for.
static double seek(Peak *peak, Search search, double start_s, double end_s)
{
    if (!peak->is_sought) {
        double time = end_s;
        const bool is_found =
            root_find(peak_rate, &search, start_s, end_s, NARROW * (end_s - start_s), &time);
        peak->is_sought = true;
        peak->passes_s = is_found && time > start_s ? time : INFINITY;
    }
    return peak->passes_s;
}

// Leaves a contact where it is now, or at its end.
static void leave(Peak *peak, bool is_pressing)
{
    if (is_pressing) {
        peak->was_rising = peak->rate > 0.0;
        peak->last = peak->value;
        peak->largest = fmax(peak->largest, peak->value);
        peak->is_sought = false;
    } else {
        // the next contact begins with both rising from nothing
        *peak = (Peak){.was_rising = true};
    }
}

// Passes all maxima at a time, which several contacts may have at once.
static void pass(Peaks *peaks, const System *system, double time_s)
{
    for (size_t i = 0; i < PEAK_COUNT * system->contact_count; i++) {
        Peak *peak = &peaks->peaks[i];
        if (peak->is_sought && peak->passes_s <= time_s) {
            peak->was_rising = false;
        }
    }
}

// What the quantities of a contact that presses are now.
static void look_at(Peak pair[PEAK_COUNT], const System *system, const SystemState *state,
                    size_t contact)
{
    double values[PEAK_COUNT];
    double rates[PEAK_COUNT];
    system->kind->peak(system, state, contact, values, rates);
    for (int which = PEAK_FORCE; which < PEAK_COUNT; which++) {
        pair[which].value = values[which];
        pair[which].rate = rates[which];
    }
}

// Looks at all contacts. Returns how many maxima may lie behind where they were left.
static size_t look_at_all(Peaks *peaks, const System *system, const SystemState *state)
{
    size_t count = 0;
    for (size_t i = 0; i < system->contact_count; i++) {
        Peak *pair = &peaks->peaks[PEAK_COUNT * i];
        if (system->contacts[i].mode == CONTACT_PRESSING) {
            look_at(pair, system, state, i);
            count += (has_peak(&pair[PEAK_FORCE]) ? 1 : 0) + (has_peak(&pair[PEAK_DEPTH]) ? 1 : 0);
        }
    }
    return count;
}

// The first maximum between two times, or the later of them.
static double seek_first(Peaks *peaks, Stepper *stepper, double start_s, double end_s)
{
    const System *system = stepper->system;
    double earliest = end_s;
    for (size_t i = 0; i < system->contact_count; i++) {
        for (int which = PEAK_FORCE; which < PEAK_COUNT; which++) {
            const Search search = {stepper, peaks->scratch, i, which};
            Peak *peak = &peaks->peaks[PEAK_COUNT * i + (size_t)which];
            if (system->contacts[i].mode == CONTACT_PRESSING && has_peak(peak)) {
                earliest = fmin(earliest, seek(peak, search, start_s, end_s));
            }
        }
    }
    return earliest;
}

double peaks_next(Peaks *peaks, Stepper *stepper, double start_s, double end_s,
                  const SystemState *state)
{
    const System *system = stepper->system;
    const size_t count = look_at_all(peaks, system, state);
    peaks->has_tops =
        count > SOUGHT_MOST && peaks_crowd_find(&peaks->crowd, stepper, start_s, end_s, state);
    if (count > 0 && !peaks->has_tops) {
        const double earliest = seek_first(peaks, stepper, start_s, end_s);
        if (earliest < end_s) {
            pass(peaks, system, earliest);
            return earliest;
        }
    }
    for (size_t i = 0; i < PEAK_COUNT * system->contact_count; i++) {
        leave(&peaks->peaks[i], system->contacts[i / PEAK_COUNT].mode == CONTACT_PRESSING);
    }
    return end_s;
}
