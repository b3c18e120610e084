// Below which size is a number of a run nothing but rounding?
//
// A double is known to eps of itself, and what is the difference of two, or the sum of many, to eps
// of the largest of them: a slider's angular velocity of 1e-29 rad/s beside a crank's of 100 is
// what the sums of the joints' forces have left. Where everything rests, gravity says how large the
// forces are that cancel: g T for a speed in a run of T, m g for a force.
#include "commands/run/run_floor.h"

#include "base/zeroed.h"

#include <float.h>
#include <math.h>

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

static void take_samples(const Scenario *scenario, const Trajectory *run, Largest *largest)
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

static Largest find_largest(const Scenario *scenario, const Trajectory *run)
{
    const Linkage *linkage = &scenario->linkage;
    const double gravity = fabs(scenario->gravity);
    Largest largest = {.distance = 0.0};
    take_samples(scenario, run, &largest);
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
    const Largest largest = find_largest(scenario, run);
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
    shown.force_max.value =
        run_floor_cut(joint->force_max.value, is_torsional ? floor->energy : floor->force);
    if (shown.force_max.value == 0.0) {
        // what follows from it
        shown.force_max.time_s = shown.force_max.crank_rad = NAN;
        shown.impulse *= 0.0;
        shown.penetration_max *= 0.0;
    }
    return shown;
}

Energy run_floor_energy(const Energy *energy, const RunFloor *floor)
{
    return (Energy){
        .drive_work = run_floor_cut(energy->drive_work, floor->energy),
        .dissipated = run_floor_cut(energy->dissipated, floor->energy),
        .friction = run_floor_cut(energy->friction, floor->energy),
        .change = run_floor_cut(energy->change, floor->energy),
        .residual = run_floor_cut(energy->residual, floor->energy),
    };
}
