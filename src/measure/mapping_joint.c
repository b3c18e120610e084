// With which mass, and how fast, do the bodies of a joint meet?
//
// The mass along a normal n is 1 / (n W n), W the block of one place of the joint in the linkage's
// mobility (model/response.h), the ideal joints holding and all other places free. It is looked up
// at instants spread over the run. Of a pin in directions spread over half a turn: which of them
// contacts choose is known only after a run, and changes with the setting that is sought. Of a
// block's corners and of stops along the normals that they have.
//
// The closing speeds are those at the onsets of the reference's contacts, every one of them.
#include "measure/mapping_joint.h"

#include "base/clock.h"
#include "base/room.h"
#include "base/sorted.h"
#include "contact/touch.h"
#include "model/space.h"
#include "run/registry.h"

#include <assert.h>
#include <math.h>
#include <stdlib.h>

enum { INSTANT_COUNT = 120, DIRECTION_COUNT = 24, MASS_COUNT = INSTANT_COUNT * DIRECTION_COUNT };

// What is known of one joint with play.
typedef struct Gathered {
    int joint; // its number
    bool was_touching;
    size_t mass_count;
    double *masses; // owned, MASS_COUNT of them
    size_t speed_count;
    size_t speed_room;
    double *speeds; // owned
    double penetration;
    double force;
} Gathered;

typedef struct Gathering {
    const Scenario *scenario;
    Response response;
    size_t place_count;
    Touch *places; // owned
    size_t play_count;
    Gathered *play;  // owned
    size_t *play_of; // by joint, its number there plus one; 0: it has none; owned
} Gathering;

static void gathering_finish(Gathering *gathering)
{
    for (size_t i = 0; i < gathering->play_count; i++) {
        free(gathering->play[i].masses);
        free(gathering->play[i].speeds);
    }
    response_finish(&gathering->response);
    free(gathering->play);
    free(gathering->play_of);
    free(gathering->places);
    free(gathering);
}

static Gathering *gathering_start(const Scenario *scenario)
{
    Gathering *gathering = calloc(1, sizeof *gathering);
    assert(gathering != NULL);
    gathering->scenario = scenario;
    gathering->play = calloc(scenario->linkage.joint_count + 1, sizeof *gathering->play);
    gathering->play_of = calloc(scenario->linkage.joint_count + 1, sizeof *gathering->play_of);
    assert(gathering->play != NULL && gathering->play_of != NULL);
    for (size_t i = 0; i < scenario->linkage.joint_count; i++) {
        if (linkage_has_play(&scenario->linkage.joints[i])) {
            Gathered *gathered = &gathering->play[gathering->play_count++];
            gathered->joint = (int)i;
            gathering->play_of[i] = gathering->play_count;
            gathered->masses = calloc(MASS_COUNT, sizeof *gathered->masses);
            assert(gathered->masses != NULL);
        }
    }
    return gathering;
}

static void add_mass(Gathering *gathering, size_t play, size_t place, Vec2 along)
{
    const size_t row = response_first_row(&gathering->response, place);
    Gathered *gathered = &gathering->play[play];
    gathered->masses[gathered->mass_count++] = response_mass(&gathering->response, row, along);
}

// The masses at one place, as the bodies stand.
static void add_place(Gathering *gathering, size_t play, size_t place, const Motion *motions)
{
    const Touch *touch = &gathering->places[place];
    if (touch_is_scalar(touch)) {
        // its rows are along the normal or the coordinate, and across
        add_mass(gathering, play, place, (Vec2){1.0, 0.0});
    } else if (touch->shape == TOUCH_DISC) {
        const TouchPose pose = touch_pose(&gathering->scenario->linkage, touch, motions);
        add_mass(gathering, play, place, pose.has_normal ? pose.normal : (Vec2){1.0, 0.0});
    } else {
        for (int k = 0; k < DIRECTION_COUNT; k++) {
            const double angle = M_PI * k / DIRECTION_COUNT;
            add_mass(gathering, play, place, (Vec2){cos(angle), sin(angle)});
        }
    }
}

static void add_masses(Gathering *gathering, const Motion *motions)
{
    // in a position where the ideal joints lock, no mass is defined
    if (!response_place(&gathering->response, motions)) {
        return;
    }
    size_t play = 0;
    for (size_t place = 0; place < gathering->place_count; place++) {
        play += gathering->places[place].joint != gathering->play[play].joint ? 1 : 0;
        add_place(gathering, play, place, motions);
    }
}

static void add_speed(Gathered *gathered, double speed)
{
    gathered->speeds = room_grow(gathered->speeds, &gathered->speed_room, gathered->speed_count + 1,
                                 sizeof *gathered->speeds);
    gathered->speeds[gathered->speed_count++] = speed;
}

static void add_record(Gathering *gathering, const StepRecord *record)
{
    const size_t count = solver_joint_count(record->part, &gathering->scenario->linkage);
    for (size_t k = 0; k < count; k++) {
        const size_t play = gathering->play_of[solver_joint(record->part, k)];
        if (play == 0) {
            continue;
        }
        Gathered *gathered = &gathering->play[play - 1];
        const double approach = record->approach[k];
        const JointState *state = &record->joints[k];
        if (state->is_touching && !gathered->was_touching && approach > 0.0) {
            add_speed(gathered, approach);
        }
        if (state->is_touching) {
            gathered->penetration = fmax(gathered->penetration, -state->gap);
            gathered->force = fmax(gathered->force, state->force);
        }
        gathered->was_touching = state->is_touching;
    }
}

// Steps the reference to a time and takes every record on the way.
static bool step_to(Gathering *gathering, void *state, double time_s, double *reached_s, Err *err)
{
    const Solver *solver = registry_solver(BACKEND_REFERENCE);
    while (*reached_s < time_s) {
        if (!solver->step(state, time_s, err)) {
            return false;
        }
        const StepRecord record = solver->record(state);
        add_record(gathering, &record);
        *reached_s = record.is_partial ? *reached_s : solver_reached(&record);
    }
    return true;
}

// Runs the reference from instant to instant, and from the last one to the end of the run.
static bool gather(Gathering *gathering, RunWatch watch, Err *err)
{
    const Scenario *scenario = gathering->scenario;
    const Solver *solver = registry_solver(BACKEND_REFERENCE);
    const double duration_s = scenario_duration(scenario);
    const double started_s = clock_now_s();
    void *state = NULL;
    if (!solver->open(scenario, &state, err)) {
        return false;
    }
    Sample sample = sample_create(&scenario->linkage);
    bool is_right = true;
    double reached_s = 0.0;
    for (int k = 0; is_right && k < INSTANT_COUNT; k++) {
        const double time_s = duration_s * (k + 0.5) / INSTANT_COUNT;
        is_right = step_to(gathering, state, time_s, &reached_s, err);
        if (is_right) {
            solver->observe(state, fmin(time_s, reached_s), &sample);
            add_masses(gathering, sample.bodies);
        }
        if (watch.progress != NULL) {
            watch.progress(reached_s / duration_s, clock_now_s() - started_s, watch.context);
        }
    }
    is_right = is_right && step_to(gathering, state, duration_s, &reached_s, err);
    sample_free(&sample);
    solver->close(state);
    return is_right;
}

static MappingJoint conclude(Gathered *gathered)
{
    sorted_make(gathered->masses, gathered->mass_count);
    MappingJoint joint = {
        .joint = gathered->joint,
        .mass_least = gathered->masses[0],
        .mass_median = sorted_median(gathered->masses, gathered->mass_count),
        .mass_most = gathered->masses[gathered->mass_count - 1],
        .onsets = gathered->speed_count,
        .penetration_max = gathered->penetration,
        .force_max = gathered->force,
    };
    if (gathered->speed_count > 0) {
        sorted_make(gathered->speeds, gathered->speed_count);
        joint.speed_median = sorted_median(gathered->speeds, gathered->speed_count);
        joint.speed_most = gathered->speeds[gathered->speed_count - 1];
    }
    return joint;
}

MappingJoint *mapping_joint_list(const Scenario *scenario, size_t *count)
{
    const Linkage *linkage = &scenario->linkage;
    MappingJoint *joints = calloc(linkage->joint_count + 1, sizeof *joints);
    assert(joints != NULL);
    *count = 0;
    for (size_t i = 0; i < linkage->joint_count; i++) {
        if (linkage_has_play(&linkage->joints[i])) {
            joints[(*count)++].joint = (int)i;
        }
    }
    return joints;
}

bool mapping_joint_measure(const Scenario *scenario, RunWatch watch, MappingJoint **joints,
                           size_t *count, Err *err)
{
    if (!space_has_plane(&scenario->linkage)) {
        return err_set(err, ERR_SOLVER,
                       "the mapping takes masses from the plane, and not all axes of this case are "
                       "along z; run and compare show what each map makes of it");
    }
    Gathering *gathering = gathering_start(scenario);
    bool is_right = touch_list(scenario, &gathering->places, &gathering->place_count, err);
    if (is_right) {
        touch_response(&scenario->linkage, gathering->places, gathering->place_count, false,
                       &gathering->response);
        is_right = gather(gathering, watch, err);
    }
    if (is_right && gathering->play[0].mass_count == 0) {
        is_right = err_set(err, ERR_SOLVER, "the ideal joints are redundant throughout the run");
    }
    if (is_right) {
        *joints = mapping_joint_list(scenario, count);
        for (size_t i = 0; i < *count; i++) {
            (*joints)[i] = conclude(&gathering->play[i]);
        }
    }
    gathering_finish(gathering);
    return is_right;
}
