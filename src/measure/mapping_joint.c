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
#include "base/sorted.h"
#include "contact/touch.h"
#include "model/space.h"
#include "run/registry.h"

#include <assert.h>
#include <math.h>
#include <stdlib.h>

enum { INSTANT_COUNT = 120, DIRECTION_COUNT = 24, MASS_COUNT = INSTANT_COUNT * DIRECTION_COUNT };

typedef struct Gathering {
    const Scenario *scenario;
    Response response;
    size_t place_count;
    Touch *places; // owned
    size_t play_count;
    int play[MAPPING_JOINT_MAX]; // numbers of the joints with play
    bool was_touching[MAPPING_JOINT_MAX];
    double *masses[MAPPING_JOINT_MAX]; // owned, as the next
    size_t mass_counts[MAPPING_JOINT_MAX];
    double *speeds[MAPPING_JOINT_MAX];
    size_t speed_counts[MAPPING_JOINT_MAX];
    size_t speed_rooms[MAPPING_JOINT_MAX];
    double penetrations[MAPPING_JOINT_MAX];
    double forces[MAPPING_JOINT_MAX];
} Gathering;

static void gathering_finish(Gathering *gathering)
{
    for (size_t i = 0; i < gathering->play_count; i++) {
        free(gathering->masses[i]);
        free(gathering->speeds[i]);
    }
    response_finish(&gathering->response);
    free(gathering->places);
    free(gathering);
}

static Gathering *gathering_start(const Scenario *scenario)
{
    Gathering *gathering = calloc(1, sizeof *gathering);
    assert(gathering != NULL);
    gathering->scenario = scenario;
    for (size_t i = 0; i < scenario->linkage.joint_count; i++) {
        if (linkage_has_play(&scenario->linkage.joints[i]) &&
            gathering->play_count < MAPPING_JOINT_MAX) {
            gathering->masses[gathering->play_count] = calloc(MASS_COUNT, sizeof(double));
            assert(gathering->masses[gathering->play_count] != NULL);
            gathering->play[gathering->play_count++] = (int)i;
        }
    }
    return gathering;
}

static void add_mass(Gathering *gathering, size_t play, size_t place, Vec2 along)
{
    const size_t row = response_first_row(&gathering->response, place);
    gathering->masses[play][gathering->mass_counts[play]++] =
        response_mass(&gathering->response, row, along);
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
        play += gathering->places[place].joint != gathering->play[play] ? 1 : 0;
        add_place(gathering, play, place, motions);
    }
}

static void add_speed(Gathering *gathering, size_t play, double speed)
{
    if (gathering->speed_counts[play] == gathering->speed_rooms[play]) {
        const size_t room = 2 * gathering->speed_rooms[play] + 64;
        double *grown = realloc(gathering->speeds[play], room * sizeof *grown);
        assert(grown != NULL);
        gathering->speeds[play] = grown;
        gathering->speed_rooms[play] = room;
    }
    gathering->speeds[play][gathering->speed_counts[play]++] = speed;
}

static void add_record(Gathering *gathering, const StepRecord *record)
{
    for (size_t i = 0; i < gathering->play_count; i++) {
        const int joint = gathering->play[i];
        const JointState *state = &record->joints[joint];
        if (state->is_touching && !gathering->was_touching[i] && record->approach[joint] > 0.0) {
            add_speed(gathering, i, record->approach[joint]);
        }
        if (state->is_touching) {
            gathering->penetrations[i] = fmax(gathering->penetrations[i], -state->gap);
            gathering->forces[i] = fmax(gathering->forces[i], state->force);
        }
        gathering->was_touching[i] = state->is_touching;
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
        *reached_s = record.end_s;
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

static void conclude(Gathering *gathering, MappingJoint *joints)
{
    for (size_t i = 0; i < gathering->play_count; i++) {
        double *masses = gathering->masses[i];
        double *speeds = gathering->speeds[i];
        const size_t mass_count = gathering->mass_counts[i];
        const size_t speed_count = gathering->speed_counts[i];
        sorted_make(masses, mass_count);
        joints[i] = (MappingJoint){
            .joint = gathering->play[i],
            .mass_least = masses[0],
            .mass_median = sorted_median(masses, mass_count),
            .mass_most = masses[mass_count - 1],
            .onsets = speed_count,
            .penetration_max = gathering->penetrations[i],
            .force_max = gathering->forces[i],
        };
        if (speed_count > 0) {
            sorted_make(speeds, speed_count);
            joints[i].speed_median = sorted_median(speeds, speed_count);
            joints[i].speed_most = speeds[speed_count - 1];
        }
    }
}

bool mapping_joint_check(const Scenario *scenario, Err *err)
{
    size_t count = 0;
    for (size_t i = 0; i < scenario->linkage.joint_count; i++) {
        count += linkage_has_play(&scenario->linkage.joints[i]) ? 1 : 0;
    }
    return count <= MAPPING_JOINT_MAX ||
           err_set(err, ERR_SOLVER, "%zu joints have play; a mapping takes at most %d", count,
                   MAPPING_JOINT_MAX);
}

bool mapping_joint_measure(const Scenario *scenario, RunWatch watch,
                           MappingJoint joints[MAPPING_JOINT_MAX], size_t *count, Err *err)
{
    if (!space_has_plane(&scenario->linkage)) {
        return err_set(err, ERR_SOLVER,
                       "the mapping takes masses from the plane, and not all axes of this case are "
                       "along z; run and compare show what each map makes of it");
    }
    if (!mapping_joint_check(scenario, err)) {
        return false;
    }
    Gathering *gathering = gathering_start(scenario);
    bool is_right = touch_list(scenario, &gathering->places, &gathering->place_count, err);
    if (is_right) {
        touch_response(&scenario->linkage, gathering->places, gathering->place_count, false,
                       &gathering->response);
        is_right = gather(gathering, watch, err);
    }
    if (is_right && gathering->mass_counts[0] == 0) {
        is_right = err_set(err, ERR_SOLVER, "the ideal joints are redundant throughout the run");
    }
    if (is_right) {
        conclude(gathering, joints);
        *count = gathering->play_count;
    }
    gathering_finish(gathering);
    return is_right;
}
