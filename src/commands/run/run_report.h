// Everything that is reported of the runs of one case, plain pointers, nothing owned; and the forms
// of the report.
#pragma once

#include "analytic/stackup.h"
#include "analytic/summary.h"
#include "measure/ensemble.h"
#include "measure/error.h"
#include "measure/truth.h"
#include "model/trajectory.h"
#include "run/spread.h"
#include "write/number_fields.h"
#include "write/table.h"

#include <math.h>
#include <string.h>

// The contacts of one run beside the reference's, by joint.
typedef struct RunMatches {
    SpikeMatch *joints; // owned by the CaseRun
} RunMatches;

typedef struct RunReport {
    const Scenario *scenario;
    size_t run_count;
    Trajectory *const *runs;        // one a backend, in the order in which they ran
    const TrajectoryError *errors;  // one a run; not known for the run that is the truth
    const AnalyticSummary *summary; // NULL where the closed form had no part in it
    const char *no_summary;         // why there is none though it was asked for, or NULL
    const Stackup *stackup;         // NULL where the closed form had no part in it
    const char *no_stackup;         // why there is none though it was asked for, or NULL
    const Truth *truth;             // NULL where no reference was asked for
    const RunMatches *matches;      // one a run; NULL without a reference
    const Ensemble *ensembles;      // one a run, some empty; NULL where the motion is predictable
    const Spread *spread;           // NULL where nobody looked
    bool is_quick;                  // whether nothing beside the runs was looked at
    bool has_log_forces;            // whether the picture has forces in decades
} RunReport;

// Whether there is a certified solution.
static inline bool run_report_has_truth(const RunReport *report)
{
    return report->truth != NULL && report->truth->trajectory->is_complete;
}

// The horizon up to which errors are stated, s.
static inline double run_report_horizon(const RunReport *report)
{
    return run_report_has_truth(report) ? report->truth->horizon_s : INFINITY;
}

// The run that a run with a known error was held against; the truth of a case need not be among
// its runs.
static inline const Trajectory *run_report_against(const RunReport *report, size_t index)
{
    const Trajectory *against = report->truth != NULL ? report->truth->trajectory : NULL;
    for (size_t i = 0; i < report->run_count; i++) {
        const bool is_it = strcmp(report->runs[i]->backend, report->errors[index].against) == 0;
        against = is_it ? report->runs[i] : against;
    }
    return against;
}

// Whether an error is against the certified solution, so that uncertainty and horizon belong to it.
static inline bool run_report_is_certified(const RunReport *report, const TrajectoryError *error)
{
    return error->is_known && run_report_has_truth(report) && report->truth->message[0] == '\0' &&
           strcmp(error->against, report->truth->trajectory->backend) == 0;
}

static inline bool run_report_is_limited_by_reference(const RunReport *report,
                                                      const TrajectoryError *error)
{
    return run_report_is_certified(report, error) &&
           error->max_in_horizon < ERROR_CLEAR_OF_TRUTH * report->truth->uncertainty;
}

// Whether the tolerance of a run is held only up to a change point of the ideal joints.
static inline bool run_report_leaves_branch(const RunReport *report, const Trajectory *run)
{
    return run->is_short && run_report_has_truth(report) &&
           change_point_is_near(report->truth->trajectory, run->estimate_s);
}

// Whether errors against the reference contain more than a solver's own: it knows contact by its
// elastic law alone.
static inline bool run_report_mixes_models(const RunReport *report)
{
    return run_report_has_truth(report) && report->scenario->contact.model == CONTACT_POISSON &&
           scenario_has_clearance(report->scenario);
}

// Whether the error of a run is that of ideal joints against joints with play.
static inline bool run_report_includes_play(const RunReport *report, size_t run)
{
    return scenario_has_clearance(report->scenario) &&
           (!options_backend_has_play(report->errors[run].against) ||
            !options_backend_has_play(report->runs[run]->backend));
}

// Whether spikes of a signal were looked for and it can have any.
static inline bool run_report_has_body_spikes(const RunReport *report, const Trajectory *run,
                                              size_t body)
{
    return run->is_complete && run->alpha_spikes[body].is_known &&
           !linkage_is_driven(&report->scenario->linkage, (int)body);
}

// What the numbers of a run of a report are taken from.
static inline NumberSource run_report_source(const RunReport *report, size_t index)
{
    return (NumberSource){.scenario = report->scenario,
                          .run = report->runs[index],
                          .error = report->errors != NULL ? &report->errors[index] : NULL,
                          .truth = report->truth};
}

// Whether tables say by the crank's angle when something was, or by the time.
static inline bool run_report_has_crank(const RunReport *report)
{
    return drive_is_steady(&report->scenario->linkage.driver);
}

// What a run is called, and how it ended: fields of a Trajectory.
extern const Field RUN_FIELDS[];

enum { RUN_TEXT_SPIKES = 5 }; // contacts listed of each joint, spikes of each body

// The forms, each of a RunReport: the whole text, the whole JSON object (a new reference; keys as
// docs/output.md lists them), and the picture as SVG, 1000 pixels wide, without runs that failed.
void run_text_write(const void *report, const Style *style, Text *text);
json_t *run_json_build(const void *report);
void plot_run_write(const void *report, Text *svg);

// Heads a column of a table for when something was, and fills in a cell of it.
void run_when_head(Table *table, size_t column, const RunReport *report);
void run_when_cell(Table *table, const RunReport *report, double time_s, double crank_rad);

// The parts of the text, each of which appends nothing where it has nothing to say. Extremes of
// each body that is not driven; how sliders move along their lines; the forces of joints without
// play; the contacts of each joint with play, how its pin tilts and slides in space, how its block
// tilts, and at most `limit` of the strongest, of the last backend that has any; numbers of all
// bodies and joints together; steps and time, and why runs failed.
void run_tables_extremes(const RunReport *report, const Style *style, Text *text);
void run_tables_forces(const RunReport *report, const Style *style, Text *text);

// What wears the pins in their holes.
void run_tables_wear(const RunReport *report, const Style *style, Text *text);
void run_tables_contacts(const RunReport *report, const Style *style, Text *text);
void run_tables_pins(const RunReport *report, const Style *style, Text *text);
// Where joints have axes that are not z, the largest angular velocity and acceleration of each body
// as vectors.
void run_turns_write(const RunReport *report, const Style *style, Text *text);
void run_slides_motion(const RunReport *report, const Style *style, Text *text);
void run_slides_blocks(const RunReport *report, const Style *style, Text *text);
void run_tables_spikes(const RunReport *report, size_t limit, const Style *style, Text *text);
void run_tables_whole(const RunReport *report, const Style *style, Text *text);
void run_tables_cost(const RunReport *report, const Style *style, Text *text);

// The spikes of accelerations and forces: how many, and at most `limit` of the strongest of each
// body, of the last backend that has any.
void spike_tables_write(const RunReport *report, size_t limit, const Style *style, Text *text);

// How far off the runs are: errors against the run that is taken as the truth, with its own
// uncertainty; contacts beside those of the reference; where the energy went; and, where the motion
// cannot be predicted, distributions over many starts.
void run_truth_errors(const RunReport *report, const Style *style, Text *text);
void run_truth_matches(const RunReport *report, const Style *style, Text *text);
void run_truth_ensembles(const RunReport *report, const Style *style, Text *text);
void run_truth_energy(const RunReport *report, const Style *style, Text *text);

// The same in JSON, where the report has a summary or a stack-up; what was measured against the
// truth, null where nothing was; and the bands of the crank angle with their spikes. New
// references.
json_t *spike_json_bands(const RunReport *report, const Trajectory *run);

// Puts `section` and `spectrum` of a complete run into an object: its state once a revolution, and
// its signals by order; null where nothing that acts has a period, or for less than one.
void run_signals_json(json_t *object, const Scenario *scenario, const Trajectory *run);

// Puts the spikes of a body or joint into an object: <name>_spikes, their count, threshold and
// resolution. The owner is NUMBER_OWNER_BODY_SPIKE or NUMBER_OWNER_JOINT_SPIKE.
void spike_json_set(json_t *object, NumberOwner owner, const Trajectory *run, size_t member);

enum { SPIKE_BAND_COUNT = 2 }; // of the crank angle, in which the paper saw its spikes

// 120 to 130 and 290 to 300 deg, each from its first sector to before its last: Sec. on Fig. 6,
// where the crank is normal to the coupler, and the coupler to the ground. Angles of the crank
// against the ground, whichever way it turns.
extern const size_t SPIKE_BANDS[SPIKE_BAND_COUNT];

// Spikes of one signal with their peaks in the bands and outside of them.
typedef struct SpikeBandSums {
    SignalSector inside;
    SignalSector outside;
} SpikeBandSums;

// The size below which a number of a run is nothing but rounding.

// Of each quantity what one rounding is of the largest that the mechanism has of it, or gravity
// makes of it: tables for people show what is below as 0. Files keep their numbers.
typedef struct RunFloor {
    double turning;      // rad/s
    double spinning_up;  // rad/s^2
    double length;       // m
    double speed;        // m/s
    double acceleration; // m/s^2
    double force;        // N
    double energy;       // J, and N m
} RunFloor;

// Of a run, all zero of one that is not complete.
RunFloor run_floor_of(const Scenario *scenario, const Trajectory *run);

// Of every run of a report, all zero of one that is not complete; the caller frees it.
RunFloor *run_floor_list(const RunReport *report);

// The value, or 0 where it is below the floor.
double run_floor_cut(double value, double floor);

// The numbers of a member of a run as tables show them.
NumberRecord run_floor_record(const RunReport *report, size_t run, const RunFloor *floor,
                              NumberOwner owner, size_t member);

// How far and how fast the slider of a prismatic joint or of a block between guides went along its
// line, at the samples of a run.

typedef struct SlideRange {
    Extreme position[2];     // m, least and most, along the line from its point on body a
    Extreme velocity[2];     // m/s, likewise, of the slider against the line's body
    Extreme acceleration[2]; // m/s^2, of the slider's centre of mass, along the line
    Extreme resultant;       // N, largest size of the vector sum of all forces on the slider in it
} SlideRange;

// Whether a joint has a slider.
bool slide_range_has(const Joint *joint);

SlideRange slide_range_find(const Linkage *linkage, const Trajectory *run, size_t joint);

// The acceleration of the slider's centre of mass along the line at a sample, m/s^2.
double slide_range_acceleration(const Linkage *linkage, const Trajectory *run, size_t sample,
                                size_t joint);
