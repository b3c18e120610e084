// What are the numbers of a run called, and in which units?
#include "commands/run/run_report.h"
#include "write/units.h"

#include <math.h>

static const char *status_of(const void *record)
{
    return ((const Trajectory *)record)->is_complete ? "ok" : "failed";
}

static const char *status_shown(const void *record)
{
    return ((const Trajectory *)record)->is_complete ? "done" : "failed";
}

static const void *if_estimated(const void *record)
{
    return ((const Trajectory *)record)->trials > 0 ? record : NULL;
}

static double step_of(const void *record)
{
    const Trajectory *run = record;
    return run->step_s > 0.0 ? run->step_s : NAN;
}

static double us_per_step_of(const void *record)
{
    const Trajectory *run = record;
    return run->wall_s / (double)run->steps * UNITS_US;
}

static double step_wall_of(const void *record)
{
    const Trajectory *run = record;
    return run->steps > 0 && run->wall_s > 0.0 ? run->wall_s / (double)run->steps : NAN;
}

static double real_time_of(const void *record)
{
    const Trajectory *run = record;
    return run->duration_s / run->wall_s;
}

static double real_time_shown(const void *record)
{
    return isfinite(step_wall_of(record)) ? real_time_of(record) : NAN;
}

static double evaluations_shown(const void *record)
{
    const size_t evaluations = ((const Trajectory *)record)->evaluations;
    return evaluations > 0 ? (double)evaluations : NAN;
}

static json_t *is_held(const void *record)
{
    const Trajectory *run = record;
    return json_boolean(!run->is_short && !run->estimate_is_cut);
}

static double unknown(const void *record)
{
    (void)record;
    return NAN;
}

static double duration_of(const void *record)
{
    const SignalSpike *spike = record;
    return spike->end_s - spike->onset_s;
}

static const void *if_felt(const void *record)
{
    return ((const RunJoint *)record)->is_felt ? record : NULL;
}

RunJoint run_fields_joint(const Linkage *linkage, const Trajectory *run, size_t number)
{
    const JointExtremes *extremes = &run->joints[number];
    const bool is_felt = trajectory_feels_play(run, &linkage->joints[number]);
    return (RunJoint){
        .is_felt = is_felt,
        .impacts = extremes->impacts,
        .force_max = extremes->force_max,
        .impulse = is_felt ? extremes->impulse : NAN,
        .penetration_max = is_felt ? extremes->penetration_max.value : NAN,
        .tilt_max = is_felt ? extremes->tilt_max.value : NAN,
        .axial_max = is_felt ? extremes->axial_max.value : NAN,
        .contact_share = is_felt ? trajectory_contact_share(run, number) : NAN,
    };
}

#define RUN(member)     .offset = offsetof(Trajectory, member)
#define BODY(member)    .offset = offsetof(BodyExtremes, member)
#define JOINT(member)   .offset = offsetof(RunJoint, member)
#define CONTACT(member) .offset = offsetof(Spike, member)
#define SPIKE(member)   .offset = offsetof(SignalSpike, member)
#define ENERGY(member)  .offset = offsetof(Energy, member)

// An extreme, and when it was: by the crank's angle, or by the time where nothing drives a crank.
#define EXTREME(name, key_unit, title, unit, member)                                               \
    {name "_" key_unit, FIELD_NUMBER, FIELD_JSON | FIELD_TABLE, title, unit, "%.6g",               \
     BODY(member.value)},                                                                          \
        {name "_crank_deg",     FIELD_DEGREES, FIELD_JSON | RUN_DRIVEN, "at crank", "deg", "%.1f", \
         BODY(member.crank_rad)},                                                                  \
    {                                                                                              \
        NULL, FIELD_NUMBER, RUN_FREE, "at time", "ms", "%.4f", BODY(member.time_s)                 \
    }

// clang-format off
static const Field ESTIMATE_FIELDS[] = {
    {"error_estimate", FIELD_NUMBER, FIELD_JSON, RUN(error_estimate)},
    {"error_estimate_until_s", FIELD_NUMBER, FIELD_JSON, RUN(estimate_s)},
    {"trials", FIELD_COUNT, FIELD_JSON, RUN(trials)},
    {"tolerance_held", FIELD_VALUE, FIELD_JSON, .json = is_held},
    {0},
};
static const Field COMPLETE_FIELDS[] = {
    {"step_s", FIELD_NUMBER, FIELD_JSON, .number = step_of},
    {"steps", FIELD_COUNT, FIELD_JSON | FIELD_TABLE, "steps", "", RUN(steps)},
    {"evaluations", FIELD_COUNT, FIELD_JSON, RUN(evaluations)},
    {NULL, FIELD_NUMBER, FIELD_TABLE, "evaluations", "", .number = evaluations_shown},
    {"duration_s", FIELD_NUMBER, FIELD_JSON, RUN(duration_s)},
    {"wall_s", FIELD_NUMBER, FIELD_JSON | FIELD_TABLE, "wall time", "ms", RUN(wall_s)},
    {"us_per_step", FIELD_NUMBER, FIELD_JSON, .number = us_per_step_of},
    {NULL, FIELD_NUMBER, FIELD_TABLE, "a step", "us", .number = step_wall_of},
    {"real_time_factor", FIELD_NUMBER, FIELD_JSON, .number = real_time_of},
    {NULL, FIELD_NUMBER, FIELD_TABLE, "simulated/wall", "1", .number = real_time_shown},
    {"constraint_rows", FIELD_COUNT, FIELD_JSON, RUN(constraint_rows)},
    {"contact_rows", FIELD_COUNT, FIELD_JSON, RUN(contact_rows)},
    {"fallback_rows", FIELD_COUNT, FIELD_JSON, RUN(fallback_rows)},
    {NULL, FIELD_PART, FIELD_JSON, .of = ESTIMATE_FIELDS, .has_nulls = true, .part = if_estimated},
    {0},
};
const Field RUN_FIELDS[] = {
    {"backend", FIELD_TEXT, FIELD_JSON | FIELD_TABLE, "backend", "", RUN(backend)},
    {"label", FIELD_TEXT, FIELD_JSON, RUN(label)},
    {NULL, FIELD_NAME, FIELD_TABLE, "status", "", .word = status_shown},
    {"status", FIELD_NAME, FIELD_JSON, .word = status_of},
    {"message", FIELD_TEXT, FIELD_JSON, RUN(message)},
    {NULL, FIELD_IF, FIELD_JSON | FIELD_TABLE, .known = offsetof(Trajectory, is_complete),
     .of = COMPLETE_FIELDS},
    {0},
};

const Field RUN_BODY_FIELDS[] = {
    {NULL, FIELD_LABEL, FIELD_TABLE, .title = "body"},
    {NULL, FIELD_LABEL, FIELD_TABLE, .title = "backend"},
    EXTREME("omega_max", "rad_s", "omega max", "rad/s", omega_max),
    EXTREME("omega_min", "rad_s", "omega min", "rad/s", omega_min),
    EXTREME("alpha_max", "rad_s2", "alpha max", "rad/s^2", alpha_max),
    EXTREME("alpha_min", "rad_s2", "alpha min", "rad/s^2", alpha_min),
    {0},
};

static const Field IMPACT_FIELDS[] = {
    {"impacts", FIELD_COUNT, FIELD_JSON | FIELD_TABLE, "impacts", "", JOINT(impacts)},
    {0},
};
const Field RUN_JOINT_FIELDS[] = {
    {NULL, FIELD_LABEL, FIELD_TABLE, .title = "joint"},
    {NULL, FIELD_LABEL, FIELD_TABLE, .title = "backend"},
    {NULL, FIELD_PART, FIELD_JSON | FIELD_TABLE, .of = IMPACT_FIELDS, .has_nulls = true,
     .part = if_felt},
    {"force_max_N", FIELD_NUMBER, RUN_PUSHED, "force max", "N", JOINT(force_max.value)},
    {"force_max_N_m", FIELD_NUMBER, RUN_TURNED, "torque max", "N m", JOINT(force_max.value)},
    {"force_max_crank_deg", FIELD_DEGREES, FIELD_JSON | RUN_DRIVEN, "at crank", "deg", "%.1f",
     JOINT(force_max.crank_rad)},
    {NULL, FIELD_NUMBER, RUN_FREE, "at time", "ms", "%.4f", JOINT(force_max.time_s)},
    {"impulse_N_s", FIELD_NUMBER, RUN_PUSHED, "impulse", "N s", JOINT(impulse),
     .align = TABLE_DETAIL},
    {"impulse_N_m_s", FIELD_NUMBER, RUN_TURNED, "impulse", "N m s", JOINT(impulse),
     .align = TABLE_DETAIL},
    {"penetration_max_m", FIELD_NUMBER, RUN_PUSHED, "deepest", "um", JOINT(penetration_max)},
    {"penetration_max_rad", FIELD_NUMBER, RUN_TURNED, "deepest", "mrad", JOINT(penetration_max)},
    {"tilt_max_rad", FIELD_NUMBER, RUN_SPATIAL, JOINT(tilt_max)},
    {"axial_max_m", FIELD_NUMBER, RUN_SPATIAL, JOINT(axial_max)},
    {"contact_fraction", FIELD_NUMBER, FIELD_JSON | FIELD_TABLE, "in contact", "%", "%.1f",
     JOINT(contact_share)},
    {0},
};

const Field RUN_CONTACT_FIELDS[] = {
    {NULL, FIELD_LABEL, FIELD_TABLE, .title = "joint"},
    {"onset_s", FIELD_NUMBER, FIELD_JSON | FIELD_TABLE, "onset", "ms", "%.4f", CONTACT(onset_s)},
    {"crank_deg", FIELD_DEGREES, FIELD_JSON | RUN_DRIVEN, "crank", "deg", "%.1f",
     CONTACT(crank_rad)},
    {"approach_speed_m_s", FIELD_NUMBER, RUN_PUSHED, "approach", "mm/s", CONTACT(approach_speed)},
    {"approach_speed_rad_s", FIELD_NUMBER, RUN_TURNED, "approach", "rad/s",
     CONTACT(approach_speed)},
    {"force_max_N", FIELD_NUMBER, RUN_PUSHED, "force max", "N", CONTACT(force_max)},
    {"force_max_N_m", FIELD_NUMBER, RUN_TURNED, "torque max", "N m", CONTACT(force_max)},
    {"duration_s", FIELD_NUMBER, FIELD_JSON | FIELD_TABLE, "duration", "us", CONTACT(duration_s)},
    {"impulse_N_s", FIELD_NUMBER, RUN_PUSHED, "impulse", "N s", CONTACT(impulse)},
    {"impulse_N_m_s", FIELD_NUMBER, RUN_TURNED, "impulse", "N m s", CONTACT(impulse)},
    {"penetration_max_m", FIELD_NUMBER, RUN_PUSHED, "deepest", "um", CONTACT(penetration_max)},
    {"penetration_max_rad", FIELD_NUMBER, RUN_TURNED, "deepest", "mrad",
     CONTACT(penetration_max)},
    {0},
};

const Field RUN_SPIKE_FIELDS[] = {
    {NULL, FIELD_LABEL, FIELD_TABLE, .title = "body"},
    {"onset_s", FIELD_NUMBER, FIELD_JSON, SPIKE(onset_s)},
    {"peak_s", FIELD_NUMBER, FIELD_JSON | FIELD_TABLE, "peak", "ms", "%.4f", SPIKE(time_s)},
    {"end_s", FIELD_NUMBER, FIELD_JSON, SPIKE(end_s)},
    {"crank_deg", FIELD_DEGREES, RUN_DRIVEN, "crank", "deg", "%.1f", SPIKE(crank_rad)},
    {"crank_deg", FIELD_NUMBER, RUN_NO_CRANK, .number = unknown},
    {"value_rad_s2", FIELD_NUMBER, RUN_ALPHA, SPIKE(value)},
    {"value_N", FIELD_NUMBER, RUN_FORCE, SPIKE(value)},
    {"value_N_m", FIELD_NUMBER, RUN_TORQUE, SPIKE(value)},
    {"prominence_rad_s2", FIELD_NUMBER, RUN_ALPHA, SPIKE(prominence)},
    {"prominence_N", FIELD_NUMBER, RUN_FORCE, SPIKE(prominence)},
    {"prominence_N_m", FIELD_NUMBER, RUN_TORQUE, SPIKE(prominence)},
    {NULL, FIELD_NUMBER, FIELD_TABLE, "alpha", "rad/s^2", SPIKE(value)},
    {NULL, FIELD_NUMBER, FIELD_TABLE, "height", "rad/s^2", SPIKE(prominence),
     .align = TABLE_DETAIL},
    {"width_s", FIELD_NUMBER, FIELD_JSON | FIELD_TABLE, "width", "us", SPIKE(width_s)},
    {NULL, FIELD_NUMBER, FIELD_TABLE, "duration", "us", .number = duration_of},
    {NULL, FIELD_NUMBER, FIELD_TABLE, "impulse", "rad/s", SPIKE(impulse)},
    {"impulse_rad_s", FIELD_NUMBER, RUN_ALPHA, SPIKE(impulse)},
    {"impulse_N_s", FIELD_NUMBER, RUN_FORCE, SPIKE(impulse)},
    {"impulse_N_m_s", FIELD_NUMBER, RUN_TORQUE, SPIKE(impulse)},
    {NULL, FIELD_LABEL, FIELD_TABLE, .title = "joint"},
    {0},
};

const Field RUN_ENERGY_FIELDS[] = {
    {NULL, FIELD_LABEL, FIELD_TABLE, .title = "backend"},
    {"drive_work_J", FIELD_NUMBER, FIELD_JSON | FIELD_TABLE, "drive work", "J", ENERGY(drive_work)},
    {NULL, FIELD_NUMBER, FIELD_TABLE, "change", "J", ENERGY(change)},
    {"dissipated_J", FIELD_NUMBER, FIELD_JSON | FIELD_TABLE, "dissipated", "J", ENERGY(dissipated)},
    {"friction_J", FIELD_NUMBER, FIELD_JSON | FIELD_TABLE, "friction", "J", ENERGY(friction)},
    {"change_J", FIELD_NUMBER, FIELD_JSON, ENERGY(change)},
    {"residual_J", FIELD_NUMBER, FIELD_JSON | FIELD_TABLE, "residual", "J", ENERGY(residual)},
    {NULL, FIELD_LABEL, FIELD_TABLE, "residual", "of energy", .align = TABLE_RIGHT},
    {0},
};
// clang-format on
