// Finds when the force and the depth of a contact stop growing.
//
//     F = F_el(d) (1 + chi d'/v0) + c(d) d'
//     dF/dt = F_el' d' (1 + chi d'/v0) + c' d'^2 + (F_el chi / v0 + c) d''
// A maximum lies where such a rate turns from positive to negative; it is found on the polynomial
// of the step.
#include "reference/peaks.h"

#include "base/curve.h"
#include "base/root.h"
#include "base/zeroed.h"

// The maxima of the forces and depths of many joints are found together.
//
// To search for each by itself evaluates all bodies for each of many, and to end a part of the step
// at each passes on all bodies as often. All are evaluated together at a few instants instead, and
// the polynomial through these (base/curve.h) has the maxima: forces are as smooth in a step as the
// motion that the step has followed to its tolerance.

static PeaksBatch peaks_batch_create(const System *system, SystemState *scratch)
{
    const size_t count = system->scenario->linkage.joint_count;
    return (PeaksBatch){
        .scratch = scratch,
        .peaks = zeroed(count, sizeof(JointPeak)),
        .joints = zeroed(count, sizeof(JointState)),
        .space_joints = zeroed(count, sizeof(SpaceJointState)),
        .forces = zeroed(CURVE_NODES * count, sizeof(double)),
        .depths = zeroed(CURVE_NODES * count, sizeof(double)),
    };
}

static void peaks_batch_finish(PeaksBatch *batch)
{
    free(batch->peaks);
    free(batch->joints);
    free(batch->space_joints);
    free(batch->forces);
    free(batch->depths);
}

static void note_node(PeaksBatch *batch, const System *system, const SystemState *state,
                      size_t node)
{
    system->kind->joints(system, state, batch->joints, batch->space_joints);
    for (size_t i = 0; i < system->scenario->linkage.joint_count; i++) {
        batch->forces[CURVE_NODES * i + node] = batch->joints[i].force;
        batch->depths[CURVE_NODES * i + node] = joint_state_depth(&batch->joints[i]);
    }
}

static JointPeak find_top(const PeaksBatch *batch, size_t joint, double start_s, double width_s)
{
    double force_share = 0.0;
    double depth_share = 0.0;
    JointPeak top = {
        .force = curve_top(batch->forces + CURVE_NODES * joint, &force_share),
        .depth = curve_top(batch->depths + CURVE_NODES * joint, &depth_share),
    };
    top.force_s = start_s + force_share * width_s;
    top.depth_s = start_s + depth_share * width_s;
    return top;
}

// Writes the peaks of all joints between two times of the present step, of which the state at the
// later one is given. Returns false where the accelerations are not determined in between.
static bool peaks_batch_find(PeaksBatch *batch, Stepper *stepper, double start_s, double end_s,
                             const SystemState *state)
{
    const System *system = stepper->system;
    const Linkage *linkage = &system->scenario->linkage;
    for (size_t node = 0; node + 1 < CURVE_NODES; node++) {
        const double time_s = start_s + curve_node(node) * (end_s - start_s);
        const double *y = dop853_dense(&stepper->integrator, time_s);
        if (!system->kind->evaluate(system, time_s, y, batch->scratch, NULL)) {
            return false;
        }
        note_node(batch, system, batch->scratch, node);
    }
    note_node(batch, system, state, CURVE_NODES - 1);
    const double since_s = system->kind->time(system, start_s);
    for (size_t i = 0; i < linkage->joint_count; i++) {
        batch->peaks[i] = (JointPeak){.force = 0.0};
        if (linkage_has_play(&linkage->joints[i])) {
            batch->peaks[i] = find_top(batch, i, since_s, end_s - start_s);
        }
    }
    return true;
}

// of a step: a maximum missed by so much is too low by half the square of it, 1e-10 of itself
static const double PEAK_TIME_SHARE = 1e-5;

// how much higher than both its ends a part of a step can rise: it is a seventh of a swing or so
static const double PEAK_OVERSHOOT = 1.5;

// Which of the quantities of a contact.
enum { PEAK_FORCE, PEAK_DEPTH, PEAK_COUNT };

// Maxima that a step is passed on in parts for; more are found together.
enum { PEAKS_SOUGHT_MOST = 8 };

typedef struct PeakSearch {
    Stepper *stepper;
    SystemState *scratch;
    size_t contact;
    int which;
} PeakSearch;

Peaks peaks_create(const System *system, SystemState *scratch)
{
    return (Peaks){
        .scratch = scratch,
        .peaks = zeroed(PEAK_COUNT * system->contact_count, sizeof(Peak)),
        .batch = peaks_batch_create(system, scratch),
    };
}

void peaks_finish(Peaks *peaks)
{
    free(peaks->peaks);
    peaks_batch_finish(&peaks->batch);
}

static double peak_rate(double time, void *context)
{
    const PeakSearch *search = context;
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
           PEAK_OVERSHOOT * fmax(peak->value, peak->last) > peak->largest;
}

// When a maximum of one quantity is passed up to the end of a step, s; INFINITY: not at all. It is
// sought once, however many maxima of other contacts the step is interrupted for.
static double seek(Peak *peak, PeakSearch search, double start_s, double end_s)
{
    if (!peak->is_sought) {
        double time = end_s;
        const bool is_found = root_find(peak_rate, &search, start_s, end_s,
                                        PEAK_TIME_SHARE * (end_s - start_s), &time);
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
static void peaks_evaluate(Peak pair[PEAK_COUNT], const System *system, const SystemState *state,
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

// Evaluates all contacts. Returns how many maxima may lie behind where they were left.
static size_t peaks_evaluate_all(Peaks *peaks, const System *system, const SystemState *state)
{
    size_t count = 0;
    for (size_t i = 0; i < system->contact_count; i++) {
        Peak *pair = &peaks->peaks[PEAK_COUNT * i];
        if (system->contacts[i].mode == CONTACT_PRESSING) {
            peaks_evaluate(pair, system, state, i);
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
            const PeakSearch search = {stepper, peaks->scratch, i, which};
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
    const size_t count = peaks_evaluate_all(peaks, system, state);
    peaks->has_peaks = count > PEAKS_SOUGHT_MOST &&
                       peaks_batch_find(&peaks->batch, stepper, start_s, end_s, state);
    if (count > 0 && !peaks->has_peaks) {
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
