// The field tables of a run: names and units of its numbers, and the size below which one is
// rounding.
#include "base/zeroed.h"
#include "commands/run/run_report.h"
#include "model/joint_rows.h"
#include "write/units.h"

#include <float.h>
#include <math.h>

static const char *run_fields_status_of(const void *record)
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

static double run_fields_step_of(const void *record)
{
    const Trajectory *run = record;
    return run->step_s > 0.0 ? run->step_s : NAN;
}

static double run_fields_us_per_step_of(const void *record)
{
    const Trajectory *run = record;
    return run->wall_s / (double)run->steps * UNITS_US;
}

static double run_fields_step_wall_of(const void *record)
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
    return isfinite(run_fields_step_wall_of(record)) ? real_time_of(record) : NAN;
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

static double run_fields_unknown(const void *record)
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
    RunJoint joint = {
        .is_felt = is_felt,
        .tilt_max = is_felt ? extremes->tilt_max.value : NAN,
        .axial_max = is_felt ? extremes->axial_max.value : NAN,
    };
    for (JointNumberId id = 0; id < JOINT_NUMBER_COUNT; id++) {
        const bool is_count = JOINT_NUMBERS[id].kind == JOINT_NUMBER_OF_COUNT;
        joint.numbers[id] = joint_numbers_find(id, run, number);
        const double value = joint.numbers[id].value; // NaN of what a joint of that kind has not
        joint.counts[id] = is_count && is_felt && isfinite(value) ? (size_t)value : 0;
    }
    return joint;
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
    {"budget_wanted_s", FIELD_NUMBER, FIELD_JSON, RUN(wanted_s)},
    {"trials", FIELD_COUNT, FIELD_JSON, RUN(trials)},
    {"tolerance_held", FIELD_VALUE, FIELD_JSON, .json = is_held},
    {0},
};
static const Field COMPLETE_FIELDS[] = {
    {"step_s", FIELD_NUMBER, FIELD_JSON, .number = run_fields_step_of},
    {"steps", FIELD_COUNT, FIELD_JSON | FIELD_TABLE, "steps", "", RUN(steps)},
    {"evaluations", FIELD_COUNT, FIELD_JSON, RUN(evaluations)},
    {NULL, FIELD_NUMBER, FIELD_TABLE, "evaluations", "", .number = evaluations_shown},
    {"duration_s", FIELD_NUMBER, FIELD_JSON, RUN(duration_s)},
    {"wall_s", FIELD_NUMBER, FIELD_JSON | FIELD_TABLE, "wall time", "ms", RUN(wall_s)},
    {"us_per_step", FIELD_NUMBER, FIELD_JSON, .number = run_fields_us_per_step_of},
    {NULL, FIELD_NUMBER, FIELD_TABLE, "a step", "us", .number = run_fields_step_wall_of},
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
    {"status", FIELD_NAME, FIELD_JSON, .word = run_fields_status_of},
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
    {"crank_deg", FIELD_NUMBER, RUN_NO_CRANK, .number = run_fields_unknown},
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
    {"load_work_J", FIELD_NUMBER, RUN_LOADED, "load work", "J", ENERGY(load_work)},
    {NULL, FIELD_NUMBER, FIELD_TABLE, "change", "J", ENERGY(change)},
    {"dissipated_J", FIELD_NUMBER, FIELD_JSON | FIELD_TABLE, "dissipated", "J", ENERGY(dissipated)},
    {"friction_J", FIELD_NUMBER, FIELD_JSON | FIELD_TABLE, "friction", "J", ENERGY(friction)},
    {"change_J", FIELD_NUMBER, FIELD_JSON, ENERGY(change)},
    {"residual_J", FIELD_NUMBER, FIELD_JSON | FIELD_TABLE, "residual", "J", ENERGY(residual)},
    {NULL, FIELD_LABEL, FIELD_TABLE, "residual", "of energy", .align = TABLE_RIGHT},
    {0},
};
// clang-format on

// The fields of a joint: whole numbers in a part that is known with the play, then all others,
// shares behind them.

static void add_number(JointNumberId id, bool is_torsional, Field **next)
{
    const JointNumber *number = &JOINT_NUMBERS[id];
    const size_t offset = offsetof(RunJoint, numbers) + id * sizeof(Extreme);
    *(*next)++ = (Field){
        .key = number->keys[is_torsional],
        .type = FIELD_NUMBER,
        .where = FIELD_JSON | FIELD_TABLE,
        .title = number->titles[is_torsional],
        .unit = number->units[is_torsional],
        .format = number->format,
        .offset = offset + offsetof(Extreme, value),
        .align = number->is_detail ? TABLE_DETAIL : 0,
    };
    if (number->is_timed) {
        *(*next)++ = (Field){.key = number->crank_key,
                             .type = FIELD_DEGREES,
                             .where = FIELD_JSON | RUN_DRIVEN,
                             .title = "at crank",
                             .unit = "deg",
                             .format = "%.1f",
                             .offset = offset + offsetof(Extreme, crank_rad)};
        *(*next)++ = (Field){.type = FIELD_NUMBER,
                             .where = RUN_FREE,
                             .title = "at time",
                             .unit = "ms",
                             .format = "%.4f",
                             .offset = offset + offsetof(Extreme, time_s)};
    }
}

static void add_numbers(bool is_of_shares, bool is_torsional, Field **next)
{
    for (JointNumberId id = 0; id < JOINT_NUMBER_COUNT; id++) {
        const JointNumberKind kind = JOINT_NUMBERS[id].kind;
        if (kind != JOINT_NUMBER_OF_COUNT && (kind == JOINT_NUMBER_OF_SHARE) == is_of_shares) {
            add_number(id, is_torsional, next);
        }
    }
}

static void add_counts(Field *next)
{
    for (JointNumberId id = 0; id < JOINT_NUMBER_COUNT; id++) {
        if (JOINT_NUMBERS[id].kind == JOINT_NUMBER_OF_COUNT) {
            *next++ = (Field){.key = JOINT_NUMBERS[id].keys[false],
                              .type = FIELD_COUNT,
                              .where = FIELD_JSON | FIELD_TABLE,
                              .title = JOINT_NUMBERS[id].titles[false],
                              .unit = "",
                              .offset = offsetof(RunJoint, counts) + id * sizeof(size_t)};
        }
    }
}

void run_fields_of_joint(bool is_torsional, RunJointFields *fields)
{
    *fields = (RunJointFields){0};
    Field *next = fields->rows;
    *next++ = (Field){.type = FIELD_LABEL, .where = FIELD_TABLE, .title = "joint"};
    *next++ = (Field){.type = FIELD_LABEL, .where = FIELD_TABLE, .title = "backend"};
    add_counts(fields->counts);
    *next++ = (Field){.type = FIELD_PART,
                      .where = FIELD_JSON | FIELD_TABLE,
                      .of = fields->counts,
                      .has_nulls = true,
                      .part = if_felt};
    add_numbers(false, is_torsional, &next);
    *next++ = (Field){"tilt_max_rad", FIELD_NUMBER, RUN_SPATIAL, JOINT(tilt_max)};
    *next++ = (Field){"axial_max_m", FIELD_NUMBER, RUN_SPATIAL, JOINT(axial_max)};
    add_numbers(true, is_torsional, &next);
}

// The size below which a number of a run is nothing but rounding.
//
// A double is known to eps of itself, and what is the difference of two, or the sum of many, to eps
// of the largest of them: a slider's angular velocity of 1e-29 rad/s beside a crank's of 100 is
// what the sums of the joints' forces have left. Where everything rests, gravity says how large the
// forces are that cancel: g T for a speed in a run of T, m g for a force.

// The largest values of a run: of all bodies together.
typedef struct Largest {
    double distance; // m
    double reach;    // m
    double speed;
    double acceleration;
    double omega;
    double alpha;
    double kinetic; // J
    double force;   // N
} Largest;

static void run_fields_take_samples(const Scenario *scenario, const Trajectory *run,
                                    Largest *largest)
{
    for (size_t k = 0; k < run->sample_count; k++) {
        for (size_t i = 0; i < run->body_count; i++) {
            const Motion *motion = trajectory_motion(run, k, i);
            largest->distance = fmax(largest->distance, vec2_length(motion->position));
            largest->speed = fmax(largest->speed, vec2_length(motion->velocity));
            largest->acceleration = fmax(largest->acceleration, vec2_length(motion->acceleration));
        }
        largest->kinetic =
            fmax(largest->kinetic,
                 linkage_kinetic_energy(&scenario->linkage, trajectory_motion(run, k, 0)));
    }
}

static Largest run_fields_find_largest(const Scenario *scenario, const Trajectory *run)
{
    const Linkage *linkage = &scenario->linkage;
    const double gravity = vec3_length(scenario->gravity);
    Largest largest = {.distance = 0.0};
    run_fields_take_samples(scenario, run, &largest);
    double mass = 0.0;
    for (size_t i = 0; i < run->body_count; i++) {
        const BodyExtremes *body = &run->bodies[i];
        largest.reach = fmax(largest.reach, run->reach[i]);
        largest.omega =
            fmax(largest.omega, fmax(fabs(body->omega_max.value), fabs(body->omega_min.value)));
        largest.alpha =
            fmax(largest.alpha, fmax(fabs(body->alpha_max.value), fabs(body->alpha_min.value)));
        mass += linkage->bodies[i].mass;
    }
    for (size_t i = 0; i < run->joint_count; i++) {
        const bool is_torsional = linkage_is_torsional(&linkage->joints[i]);
        largest.force = fmax(largest.force, is_torsional ? 0.0 : run->joints[i].force_max.value);
    }
    const double duration_s = run->duration_s;
    largest.speed = fmax(largest.speed, gravity * duration_s);
    largest.acceleration = fmax(largest.acceleration, gravity);
    largest.force = fmax(largest.force, mass * gravity);
    largest.kinetic = fmax(largest.kinetic, 0.5 * mass * largest.speed * largest.speed);
    if (largest.reach > 0.0) {
        largest.omega = fmax(largest.omega, largest.speed / largest.reach);
        largest.alpha = fmax(largest.alpha, largest.acceleration / largest.reach);
    }
    return largest;
}

static RunFloor find_floor(const Scenario *scenario, const Trajectory *run)
{
    if (!run->is_complete) {
        return (RunFloor){0};
    }
    const Largest largest = run_fields_find_largest(scenario, run);
    return (RunFloor){
        .turning = DBL_EPSILON * largest.omega,
        .spinning_up = DBL_EPSILON * largest.alpha,
        .length = DBL_EPSILON * fmax(largest.distance, largest.reach),
        .speed = DBL_EPSILON * largest.speed,
        .acceleration = DBL_EPSILON * largest.acceleration,
        .force = DBL_EPSILON * largest.force,
        .energy = DBL_EPSILON * largest.kinetic,
    };
}

RunFloor *run_floor_list(const RunReport *report)
{
    RunFloor *floors = zeroed(report->run_count, sizeof *floors);
    for (size_t i = 0; i < report->run_count; i++) {
        floors[i] = find_floor(report->scenario, report->runs[i]);
    }
    return floors;
}

double run_floor_cut(double value, double floor)
{
    return fabs(value) < floor ? 0.0 : value;
}

// What is 0 in both directions stands at no time.
static void cut_extremes(Extreme *most, Extreme *least, double floor)
{
    most->value = run_floor_cut(most->value, floor);
    least->value = run_floor_cut(least->value, floor);
    if (most->value == 0.0 && least->value == 0.0) {
        most->time_s = most->crank_rad = NAN;
        least->time_s = least->crank_rad = NAN;
    }
}

BodyExtremes run_floor_body(const BodyExtremes *body, const RunFloor *floor)
{
    BodyExtremes shown = *body;
    cut_extremes(&shown.omega_max, &shown.omega_min, floor->turning);
    cut_extremes(&shown.alpha_max, &shown.alpha_min, floor->spinning_up);
    return shown;
}

RunJoint run_floor_joint(const RunJoint *joint, bool is_torsional, const RunFloor *floor)
{
    RunJoint shown = *joint;
    for (JointNumberId id = 0; id < JOINT_NUMBER_COUNT; id++) {
        if (JOINT_NUMBERS[id].kind == JOINT_NUMBER_OF_FORCE) {
            shown.numbers[id].value = run_floor_cut(joint->numbers[id].value,
                                                    is_torsional ? floor->energy : floor->force);
        }
    }
    Extreme *force = &shown.numbers[JOINT_NUMBER_FORCE_MAX];
    if (force->value == 0.0) {
        force->time_s = force->crank_rad = NAN;
    }
    // what follows from it
    for (JointNumberId id = 0; force->value == 0.0 && id < JOINT_NUMBER_COUNT; id++) {
        const JointNumberKind kind = JOINT_NUMBERS[id].kind;
        if (kind == JOINT_NUMBER_OF_IMPULSE || kind == JOINT_NUMBER_OF_DEPTH) {
            shown.numbers[id].value *= 0.0;
        }
    }
    return shown;
}

Energy run_floor_energy(const Energy *energy, const RunFloor *floor)
{
    return (Energy){
        .drive_work = run_floor_cut(energy->drive_work, floor->energy),
        .load_work = run_floor_cut(energy->load_work, floor->energy),
        .dissipated = run_floor_cut(energy->dissipated, floor->energy),
        .friction = run_floor_cut(energy->friction, floor->energy),
        .change = run_floor_cut(energy->change, floor->energy),
        .residual = run_floor_cut(energy->residual, floor->energy),
    };
}

// How far, how fast and how hard a slider went along its line.

bool slide_range_has(const Joint *joint)
{
    return joint_rows_is_angle(joint->kind, 1);
}

double slide_range_acceleration(const Linkage *linkage, const Trajectory *run, size_t sample,
                                size_t joint)
{
    const Motion *motions = trajectory_motion(run, sample, 0);
    const Joint *of = &linkage->joints[joint];
    const int body = of->body_b == LINKAGE_GROUND ? of->body_a : of->body_b;
    return vec2_dot(joint_rows_along(linkage, motions, (int)joint), motions[body].acceleration);
}

static Extreme at_sample(double value, const Trajectory *run, size_t sample)
{
    return (Extreme){value, run->times[sample], run->crank_angles[sample]};
}

// Takes a value that was then into the least and most.
static void run_fields_widen(Extreme range[2], double value, const Trajectory *run, size_t sample)
{
    const Extreme now = at_sample(value, run, sample);
    range[0] = sample == 0 || value < range[0].value ? now : range[0];
    range[1] = sample == 0 || value > range[1].value ? now : range[1];
}

SlideRange slide_range_find(const Linkage *linkage, const Trajectory *run, size_t joint)
{
    SlideRange range = {0};
    for (size_t i = 0; i < run->sample_count; i++) {
        const Motion *motions = trajectory_motion(run, i, 0);
        const JointGap gap = linkage_joint_gap(linkage, motions, (int)joint);
        const Vec2 along = joint_rows_along(linkage, motions, (int)joint);
        const int body = linkage->joints[joint].body_a;
        const double omega = body == LINKAGE_GROUND ? 0.0 : motions[body].omega;
        run_fields_widen(range.position, vec2_dot(along, gap.position), run, i);
        // the line turns with its body
        run_fields_widen(range.velocity,
                         vec2_dot(along, gap.velocity) +
                             omega * vec2_dot(vec2_perp(along), gap.position),
                         run, i);
        run_fields_widen(range.acceleration, slide_range_acceleration(linkage, run, i, joint), run,
                         i);
        const double resultant = vec2_length(trajectory_state(run, i, joint)->force_on_b);
        if (i == 0 || resultant > range.resultant.value) {
            range.resultant = at_sample(resultant, run, i);
        }
    }
    return range;
}
