// What runs are called in tables and JSON, and the size below which a number of one is rounding.
#include "base/zeroed.h"
#include "commands/run/run_report.h"
#include "model/joint_rows.h"

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

#define RUN(member) .offset = offsetof(Trajectory, member)

// clang-format off
const Field RUN_FIELDS[] = {
    {"backend", FIELD_TEXT, FIELD_JSON | FIELD_TABLE, "backend", "", RUN(backend)},
    {"label", FIELD_TEXT, FIELD_JSON, RUN(label)},
    {NULL, FIELD_NAME, FIELD_TABLE, "status", "", .word = status_shown},
    {"status", FIELD_NAME, FIELD_JSON, .word = run_fields_status_of},
    {"message", FIELD_TEXT, FIELD_JSON, RUN(message)},
    {0},
};
// clang-format on

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
    double gyration = 0.0;
    for (size_t i = 0; i < run->body_count; i++) {
        const BodyExtremes *body = &run->bodies[i];
        gyration = fmax(gyration, sqrt(linkage->bodies[i].inertia / linkage->bodies[i].mass));
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
    // a ball that no joint holds has no other length
    largest.reach = largest.reach > 0.0 ? largest.reach : gyration;
    if (largest.reach > 0.0) {
        largest.omega = fmax(largest.omega, largest.speed / largest.reach);
        largest.alpha = fmax(largest.alpha, largest.acceleration / largest.reach);
    }
    return largest;
}

RunFloor run_floor_of(const Scenario *scenario, const Trajectory *run)
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
        floors[i] = run_floor_of(report->scenario, report->runs[i]);
    }
    return floors;
}

double run_floor_cut(double value, double floor)
{
    return fabs(value) < floor ? 0.0 : value;
}

// The floor of a kind of number.
static double floor_of(NumberKind kind, NumberTurn turn, const RunFloor *floor)
{
    switch (kind) {
    case NUMBER_OF_FORCE:
        return turn == NUMBER_TURNED ? floor->energy : floor->force;
    case NUMBER_OF_ENERGY:
        return floor->energy;
    case NUMBER_OF_LENGTH:
        return floor->length;
    case NUMBER_OF_SPEED:
        return floor->speed;
    case NUMBER_OF_ANGULAR_SPEED:
        return floor->turning;
    case NUMBER_OF_ANGULAR_ACCELERATION:
        return floor->spinning_up;
    case NUMBER_OF_COUNT:
    case NUMBER_OF_EFFORT:
    case NUMBER_OF_SHARE:
    case NUMBER_OF_RATIO:
    case NUMBER_OF_IMPULSE:
    case NUMBER_OF_DEPTH:
    case NUMBER_OF_APPROACH:
    case NUMBER_OF_SIGNAL:
    case NUMBER_OF_SIGNAL_IMPULSE:
    case NUMBER_OF_ANGLE:
    case NUMBER_OF_TIME:
    case NUMBER_OF_SPAN:
    case NUMBER_OF_MICROSECONDS:
    case NUMBER_OF_PRESSURE:
    case NUMBER_OF_PRESSURE_SPEED:
    case NUMBER_KIND_COUNT:
        break;
    }
    return 0.0;
}

// Whether all numbers of a kind are 0: then they stand at no time.
static bool is_nothing(const NumberRecord *record, NumberOwner owner, NumberKind kind)
{
    bool is_zero = true;
    for (NumberId id = 0; id < NUMBER_COUNT; id++) {
        const bool is_its = NUMBERS[id].owner == owner && NUMBERS[id].kind == kind &&
                            (NUMBERS[id].traits & NUMBER_TIMED) != 0;
        is_zero = is_zero && (!is_its || record->values[id].value == 0.0);
    }
    return is_zero;
}

NumberRecord run_floor_record(const RunReport *report, size_t run, const RunFloor *floor,
                              NumberOwner owner, size_t member)
{
    const NumberSource source = run_report_source(report, run);
    const NumberTurn turn = number_turn(owner, &report->scenario->linkage, member);
    NumberRecord record = number_record(owner, &source, member);
    for (NumberId id = 0; id < NUMBER_COUNT; id++) {
        Extreme *number = &record.values[id];
        number->value = run_floor_cut(number->value, floor_of(NUMBERS[id].kind, turn, floor));
    }
    const bool is_unloaded = record.values[NUMBER_JOINT_FORCE_MAX].value == 0.0;
    if (record.values[NUMBER_ENERGY_RESIDUAL].value == 0.0) {
        record.values[NUMBER_ENERGY_RESIDUAL_SHARE].value *= 0.0;
    }
    for (NumberId id = 0; id < NUMBER_COUNT; id++) {
        const NumberKind kind = NUMBERS[id].kind;
        if ((NUMBERS[id].traits & NUMBER_TIMED) != 0 && is_nothing(&record, owner, kind)) {
            record.values[id].time_s = record.values[id].crank_rad = NAN;
        }
        // what follows from a force that is nothing
        if (is_unloaded && (kind == NUMBER_OF_IMPULSE || kind == NUMBER_OF_DEPTH)) {
            record.values[id].value *= 0.0;
        }
    }
    return record;
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
