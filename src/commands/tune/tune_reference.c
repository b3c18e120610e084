// What would the reference cost for the error asked for, without ODE?
//
// Its error depends on reference.tolerance as a scheme's does on the step, so it is searched for in
// the same way, from loose to tight, two to a decade, until two neighbours meet the target.
#include "commands/tune/tune_reference.h"

#include "base/sorted.h"
#include "commands/tune/tune_setting.h"
#include "write/json_value.h"
#include "write/number.h"
#include "write/units.h"

#include <inttypes.h>
#include <math.h>

// the loosest one that has an effect, and the others
static const double TOLERANCES[] = {3e-5, 1e-5, 3e-6,  1e-6,  3e-7,  1e-7,  3e-8,  1e-8,
                                    3e-9, 1e-9, 3e-10, 1e-10, 3e-11, 1e-11, 3e-12, 1e-12};

enum { TOLERANCE_COUNT = sizeof TOLERANCES / sizeof TOLERANCES[0] };

typedef struct Looking {
    Tune *tune;
    double least;            // tolerance of the truth
    size_t next;             // tolerance to be run
    bool is_busy;            // it is being run
    TuneReference candidate; // the last one, if it met the target
    bool is_done;            // so did the next tighter one
    double times_s[TUNE_REPEATS];
    size_t timed;
} Looking;

static bool choose_tolerance(void *owner, size_t *number)
{
    Looking *looking = owner;
    if (looking->is_busy || looking->is_done || looking->next == TOLERANCE_COUNT ||
        !(TOLERANCES[looking->next] > looking->least)) {
        return false;
    }
    looking->is_busy = true;
    *number = looking->next;
    return true;
}

static void apply_tolerance(void *owner, size_t number, Scenario *scenario)
{
    (void)owner;
    scenario->reference.tolerance = TOLERANCES[number];
}

static void take_error(void *owner, size_t number, const LadderRun *run)
{
    Looking *looking = owner;
    const Tune *tune = looking->tune;
    char reason[LADDER_MESSAGE_SIZE];
    const double error = tune_error(tune, run, reason);
    const bool meets = error + tune->truth.uncertainty <= tune->target;
    looking->is_busy = false;
    looking->next++;
    looking->is_done = meets && looking->candidate.tolerance > 0.0;
    if (!looking->is_done) {
        looking->candidate =
            meets ? (TuneReference){.tolerance = TOLERANCES[number], .error = error, .run = *run}
                  : (TuneReference){.tolerance = 0.0};
    }
}

static void apply_found(void *owner, size_t number, Scenario *scenario)
{
    (void)number;
    scenario->reference.tolerance = ((const Looking *)owner)->tune->reference.tolerance;
}

static void take_time(void *owner, size_t number, const LadderRun *run)
{
    (void)number;
    Looking *looking = owner;
    if (run->is_complete) {
        looking->times_s[looking->timed++] = run->processor_s;
    }
}

static bool time_found(const TuneSearch *search, Looking *looking, Err *err)
{
    const TuneRuns runs = {.doing = "timing the reference",
                           .count = TUNE_REPEATS,
                           .is_timing = true,
                           .is_reference = true,
                           .apply = apply_found,
                           .take = take_time,
                           .owner = looking};
    if (!tune_runs_make(search, &runs, err)) {
        return false;
    }
    sorted_make(looking->times_s, looking->timed);
    looking->tune->reference.processor_median_s =
        looking->timed > 0 ? sorted_median(looking->times_s, looking->timed) : NAN;
    return true;
}

bool tune_reference_run(const TuneSearch *search, Err *err)
{
    Tune *tune = search->tune;
    Looking looking = {.tune = tune, .least = search->scenario->reference.tolerance};
    const TuneRuns runs = {.doing = "running the reference",
                           .is_reference = true,
                           .apply = apply_tolerance,
                           .take = take_error,
                           .choose = choose_tolerance,
                           .owner = &looking};
    if (!tune_runs_make(search, &runs, err)) {
        return false;
    }
    if (!looking.is_done) {
        return true;
    }
    tune->reference = looking.candidate;
    return time_found(search, &looking, err);
}

void tune_reference_write(const TuneReport *report, const Style *style, Text *text)
{
    const Tune *tune = report->tune;
    const TuneReference *reference = &tune->reference;
    const TuneTrial *best = tune_best(tune, tune->winner);
    if (!(reference->tolerance > 0.0)) {
        return;
    }
    text_append(text,
                "\n%sWithout ODE%s\n\n"
                "  The reference meets the error, too, where no world of ODE is needed:\n"
                "  setting     reference, tolerance %s\n"
                "  error       %.3g\n"
                "  cost        %zu evaluations, %.4g ms of the processor",
                style->heading, style->end, number_shortest(reference->tolerance).text,
                reference->error, reference->run.evaluations,
                reference->processor_median_s * UNITS_MS);
    if (best != NULL) {
        text_append(text, ", %.3g of the setting's above",
                    reference->processor_median_s / tune_setting_time(tune, best));
    }
    text_append(text,
                "\n  in a case   run.backends=[reference]\n"
                "              reference.tolerance=%s\n",
                number_shortest(reference->tolerance).text);
}

json_t *tune_reference_object(const TuneReport *report)
{
    const TuneReference *reference = &report->tune->reference;
    if (!(reference->tolerance > 0.0)) {
        return json_null();
    }
    json_t *object = json_object();
    json_value_set(object, "tolerance", reference->tolerance);
    json_value_set(object, "error_max", reference->error);
    json_object_set_new(object, "evaluations",
                        json_integer((json_int_t)reference->run.evaluations));
    json_value_set(object, "processor_median_s", reference->processor_median_s);
    json_object_set_new(object, "hash", json_sprintf("%016" PRIx64, reference->run.hash));
    return object;
}
