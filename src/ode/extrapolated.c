// How does the linkage move in ODE, with what several worlds of different steps say put together?
//
// The worlds give positions and speeds at nodes H apart (ode/nodes.c). In between, each coordinate
// is the polynomial of degree 11 through positions and speeds at six nodes, three on each side;
// speeds and accelerations are its derivatives. The nodes run ahead of what is handed out by two
// intervals.
//
// Forces in the joints follow from the accelerations (ode/ideal_forces.c), those of the drive from
// the balance of the driven body. Work of the drive, P its power, over a part from t1 to t2:
//     W = (t2 - t1) / 6 (P(t1) + 4 P((t1 + t2) / 2) + P(t2))        (Simpson)
#include "base/hermite.h"
#include "base/zeroed.h"
#include "ode/ideal_forces.h"
#include "ode/nodes.h"
#include "ode/stepping.h"

#include <assert.h>
#include <stdlib.h>
#include <string.h>

// of an interval: a part that ends so close to a node goes up to it, or as little beyond
static const double ROUNDING = 1e-6;

// W, of the drive, and what the dampers take.
typedef struct Powers {
    double drive;
    double damping;
} Powers;

typedef struct Extrapolated {
    const Scenario *scenario;
    Nodes nodes;
    Response *response;  // room to work in; owned
    int driven;          // body, or LINKAGE_GROUND
    bool is_begun;       // the part at time zero has been handed out
    long interval;       // number of the node before it
    Hermite (*paths)[3]; // x, y and angle in the interval; owned, as are all arrays
    double start_s;      // of the last part
    Sample begin;        // of it, once the next one is being made
    Sample middle;       // likewise
    Sample end;          // of it
    Powers powers;       // there
    double drive_work;   // J, in the last part
    double damped;       // J, in dampers, likewise
    double *omega;
    double *alpha;
    double *impulse;
    double *approach; // zero: an ideal joint never begins to touch
    BodyLoad *loads;  // to work with, as the next
    Vec2 *offsets;
    double *rows; // of the response
} Extrapolated;

static void extrapolated_close(void *state)
{
    Extrapolated *own = state;
    if (own != NULL) {
        nodes_finish(&own->nodes);
        response_finish(own->response);
        sample_free(&own->begin);
        sample_free(&own->middle);
        sample_free(&own->end);
        free(own->response);
        free(own->paths);
        free(own->omega);
        free(own->alpha);
        free(own->impulse);
        free(own->approach);
        free(own->loads);
        free(own->offsets);
        free(own->rows);
        free(own);
    }
}

static void make_extrapolated(const Linkage *linkage, Extrapolated *own)
{
    own->response = zeroed(1, sizeof *own->response);
    response_init(linkage, false, own->response);
    own->paths = zeroed(linkage->body_count, sizeof *own->paths);
    own->omega = zeroed(linkage->body_count, sizeof *own->omega);
    own->alpha = zeroed(linkage->body_count, sizeof *own->alpha);
    own->impulse = zeroed(linkage->joint_count, sizeof *own->impulse);
    own->approach = zeroed(linkage->joint_count, sizeof *own->approach);
    own->loads = zeroed(linkage->body_count, sizeof *own->loads);
    own->offsets = zeroed(linkage->joint_count, sizeof *own->offsets);
    own->rows = zeroed(own->response->ideal_rows, sizeof *own->rows);
}

static bool extrapolated_open(const Scenario *scenario, void **state, Err *err)
{
    if (scenario_has_clearance(scenario)) {
        return err_set(err, ERR_SOLVER,
                       "extrapolated stepping is for ideal joints: contacts are not smooth");
    }
    Extrapolated *own = calloc(1, sizeof *own);
    assert(own != NULL);
    own->scenario = scenario;
    own->begin = sample_create(&scenario->linkage);
    own->middle = sample_create(&scenario->linkage);
    own->end = sample_create(&scenario->linkage);
    own->driven = linkage_driven_body(&scenario->linkage);
    make_extrapolated(&scenario->linkage, own);
    if (nodes_init(scenario, &own->nodes, err)) {
        *state = own;
        return true;
    }
    extrapolated_close(own);
    return false;
}

// Fits the paths through the nodes around an interval: three on each side of its middle, but where
// the nodes do not begin that early, the first six.
static bool enter_interval(Extrapolated *own, long interval, Err *err)
{
    Nodes *nodes = &own->nodes;
    while (nodes->next <= interval + NODES_KEPT / 2 || nodes->kept < NODES_KEPT) {
        if (!nodes_advance(nodes, err)) {
            return false;
        }
    }
    double times[NODES_KEPT];
    for (size_t k = 0; k < NODES_KEPT; k++) {
        times[k] = (double)(nodes->next - NODES_KEPT + (long)k) * nodes->interval_s;
    }
    for (size_t i = 0; i < own->scenario->linkage.body_count; i++) {
        for (size_t c = 0; c < 3; c++) {
            double positions[NODES_KEPT];
            double speeds[NODES_KEPT];
            for (size_t k = 0; k < NODES_KEPT; k++) {
                positions[k] = nodes->states[k][i].position[c];
                speeds[k] = nodes->states[k][i].speed[c];
            }
            own->paths[i][c] = hermite_fit(NODES_KEPT, times, positions, speeds);
        }
    }
    own->interval = interval;
    return true;
}

static void fill_motions(const Extrapolated *own, double time_s, Motion *motions)
{
    const Linkage *linkage = &own->scenario->linkage;
    for (int i = 0; i < (int)linkage->body_count; i++) {
        if (i == own->driven) {
            motions[i] = stepping_driven(linkage, time_s);
            continue;
        }
        const HermitePoint x = hermite_at(&own->paths[i][0], time_s);
        const HermitePoint y = hermite_at(&own->paths[i][1], time_s);
        const HermitePoint angle = hermite_at(&own->paths[i][2], time_s);
        motions[i] = (Motion){
            .position = {x.value, y.value},
            .angle = angle.value,
            .velocity = {x.slope, y.slope},
            .omega = angle.slope,
            .acceleration = {x.curvature, y.curvature},
            .alpha = angle.curvature,
        };
    }
}

// The motions and the joints' forces at a time in the interval, and the powers. Returns false where
// the forces are not determined; they are then untouched.
static bool work_out(const Extrapolated *own, double time_s, Sample *sample, Powers *powers)
{
    const Linkage *linkage = &own->scenario->linkage;
    BodyLoad *loads = own->loads;
    sample->time_s = time_s;
    sample->crank_rad = linkage_crank_angle(linkage, time_s);
    fill_motions(own, time_s, sample->bodies);
    forces_loads(linkage, sample->bodies, time_s, loads);
    if (!ideal_forces_solve(own->scenario, sample->bodies, loads, own->response, own->rows,
                            sample->joints)) {
        return false;
    }
    powers->drive = forces_torque_power(linkage, sample->bodies, time_s);
    powers->damping = forces_damping_power(linkage, sample->bodies);
    if (own->driven >= 0) {
        stepping_offsets(linkage, sample->bodies, own->driven, own->offsets);
        powers->drive = stepping_drive(own->scenario, &sample->bodies[own->driven],
                                       &loads[own->driven], own->offsets, sample->joints);
    }
    return true;
}

static void observe_joints(const Extrapolated *own, Sample *sample)
{
    for (size_t i = 0; i < own->scenario->linkage.joint_count; i++) {
        stepping_observe_joint(&own->scenario->linkage, i, sample);
    }
}

// Hands out the part from the end of the last one to a time in the interval.
static bool make_part(Extrapolated *own, double end_s, Err *err)
{
    sample_copy(&own->scenario->linkage, &own->end, &own->begin);
    const Sample start = own->begin;
    const Powers from = own->powers;
    const double sixth_s = (end_s - start.time_s) / 6.0;
    Sample middle = own->middle;
    Powers mid = {0.0, 0.0};
    if (!work_out(own, 0.5 * (start.time_s + end_s), &middle, &mid) ||
        !work_out(own, end_s, &own->end, &own->powers)) {
        err_set(err, ERR_SOLVER,
                "the ideal joints are redundant: give one joint of the loop some play, or "
                "choose another stepping");
        return stepping_fail(own->scenario, start.time_s, own->nodes.steps, own->scenario->run.step,
                             err);
    }
    observe_joints(own, &own->end);
    own->start_s = start.time_s;
    own->drive_work = sixth_s * (from.drive + 4.0 * mid.drive + own->powers.drive);
    own->damped = sixth_s * (from.damping + 4.0 * mid.damping + own->powers.damping);
    for (size_t i = 0; i < own->scenario->linkage.body_count; i++) {
        own->omega[i] = own->end.bodies[i].omega;
        own->alpha[i] = own->end.bodies[i].alpha;
    }
    for (size_t i = 0; i < own->scenario->linkage.joint_count; i++) {
        own->impulse[i] = sixth_s * (start.joints[i].force + 4.0 * middle.joints[i].force +
                                     own->end.joints[i].force);
    }
    return true;
}

static bool extrapolated_step(void *state, double stop_s, Err *err)
{
    Extrapolated *own = state;
    if (!own->is_begun) {
        // a part of no length, so that what stands at time zero is on record
        own->is_begun = true;
        return enter_interval(own, 0, err) && make_part(own, 0.0, err);
    }
    const double interval_s = own->nodes.interval_s;
    const double done = own->end.time_s / interval_s - (double)own->interval;
    if (done > 1.0 - ROUNDING && !enter_interval(own, own->interval + 1, err)) {
        return false;
    }
    // no part goes beyond a node
    const double node_s = (double)(own->interval + 1) * interval_s;
    return make_part(own, stop_s < node_s + ROUNDING * interval_s ? stop_s : node_s, err);
}

static StepRecord extrapolated_record(const void *state)
{
    const Extrapolated *own = state;
    return (StepRecord){
        .start_s = own->start_s,
        .end_s = own->end.time_s,
        .joint_s = own->end.time_s,
        .omega = own->omega,
        .alpha = own->alpha,
        .joints = own->end.joints,
        .impulse = own->impulse,
        .approach = own->approach,
        .drive_work = own->drive_work,
        .dissipated = own->damped,
    };
}

static void extrapolated_observe(const void *state, double time_s, Sample *sample)
{
    const Extrapolated *own = state;
    // should the forces not be determined, those of the end stand
    sample_copy(&own->scenario->linkage, &own->end, sample);
    if (time_s == own->end.time_s) {
        return;
    }
    Powers unused;
    work_out(own, time_s, sample, &unused);
    observe_joints(own, sample);
}

static SolverModel extrapolated_model(const void *state)
{
    const Extrapolated *own = state;
    SolverModel model = {
        .step_s = own->scenario->run.step,
        .constraint_rows = own->nodes.levels[0].world.constraint_rows,
        .steps = own->nodes.steps,
    };
    stepping_label(own->scenario, "extrapolated", NULL, model.label);
    return model;
}

const Solver STEPPING_EXTRAPOLATED = {
    .name = "extrapolated",
    .open = extrapolated_open,
    .step = extrapolated_step,
    .record = extrapolated_record,
    .observe = extrapolated_observe,
    .model = extrapolated_model,
    .close = extrapolated_close,
};
