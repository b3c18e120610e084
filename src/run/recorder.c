// Records the extremes and contacts of a run step by step, whatever its samples show.
//
// Every step counts: extremes of omega (at the step's end) and alpha (its mean), each contact from
// the first step with overlap to the last: force maximum, impulse, depth, duration; and the energy
// that went in and out. Extremes and contacts are those of the reported time alone: a contact that
// is under way when it begins has not begun in it, and the rest of its duration, impulse and forces
// counts (run/report_cut.h). The ranges hold the same values, and every value that is shown, over
// the whole run; a step that crosses the border of two stretches belongs to both where its values
// are means.
#include "run/recorder.h"
#include "base/hash.h"
#include "base/sorted.h"
#include "base/zeroed.h"

#include <assert.h>

// The range of every value in each stretch of a run.
//
// A value of an instant belongs to the stretch in which its step ends, a mean over a step to every
// stretch that the step reaches into.

// of a stretch: what ends so little behind its border ends there
static const double BORDER_ROUNDING = 1e-9;

static void empty_stretch(RecorderRanges *own)
{
    for (size_t i = 0; i < own->trajectory->ranges.signal_count; i++) {
        own->now[i] = RANGE_EMPTY;
    }
}

// The end of a stretch, with room for rounding; the last one has none.
static void set_stretch_end(RecorderRanges *own)
{
    const Ranges *ranges = &own->trajectory->ranges;
    own->stretch_end_s = own->stretch + 1 < ranges->count
                             ? ((double)(own->stretch + 1) + BORDER_ROUNDING) * ranges->width_s
                             : INFINITY;
}

static RecorderRanges recorder_ranges_start(const Scenario *scenario, Trajectory *trajectory)
{
    RecorderRanges own = {
        .scenario = scenario,
        .trajectory = trajectory,
        .now = zeroed(trajectory->ranges.signal_count, sizeof *own.now),
        .forces = zeroed(scenario->linkage.body_count, sizeof *own.forces),
    };
    set_stretch_end(&own);
    empty_stretch(&own);
    return own;
}

// The force on each body's centre of mass: its weight, and what its joints do.
static void add_up_forces(const Scenario *scenario, const StepRecord *step, Vec2 *forces)
{
    const Linkage *linkage = &scenario->linkage;
    const size_t body_count = solver_body_count(step->part, linkage);
    const size_t joint_count = solver_joint_count(step->part, linkage);
    for (size_t k = 0; k < body_count; k++) {
        const size_t i = solver_body(step->part, k);
        forces[i] = vec2_scale(linkage->bodies[i].mass, scenario_gravity(scenario));
    }
    for (size_t k = 0; k < joint_count; k++) {
        const Joint *joint = &linkage->joints[solver_joint(step->part, k)];
        const Vec2 force = step->joints[k].force_on_b;
        if (joint->body_b != LINKAGE_GROUND) {
            forces[joint->body_b] = vec2_add(forces[joint->body_b], force);
        }
        if (joint->body_a != LINKAGE_GROUND) {
            forces[joint->body_a] = vec2_sub(forces[joint->body_a], force);
        }
    }
}

// Takes a step into a stretch.
static void add_to_stretch(RecorderRanges *own, const StepRecord *step, Range *values)
{
    const Linkage *linkage = &own->scenario->linkage;
    const Ranges *ranges = &own->trajectory->ranges;
    const size_t body_count = solver_body_count(step->part, linkage);
    const size_t joint_count = solver_joint_count(step->part, linkage);
    // without a drive the centres may be all that moves
    const bool has_accelerations = !linkage->driver.is_present;
    if (has_accelerations) {
        add_up_forces(own->scenario, step, own->forces);
    }
    for (size_t k = 0; k < body_count; k++) {
        const size_t i = solver_body(step->part, k);
        Range *range = values + ranges_of_body(i, 0);
        range_add(&range[RANGES_OMEGA], step->omega[k]);
        range_add(&range[RANGES_ALPHA], step->alpha[k]);
        if (has_accelerations) {
            range_add(&range[RANGES_ACCELERATION],
                      vec2_length(own->forces[i]) / linkage->bodies[i].mass);
        }
    }
    for (size_t k = 0; k < joint_count; k++) {
        Range *range = values + ranges_of_joint(ranges, solver_joint(step->part, k), 0);
        range_add(&range[RANGES_FORCE], step->joints[k].force);
        range_add(&range[RANGES_GAP], step->joints[k].gap);
    }
}

static void close_stretch(RecorderRanges *own)
{
    Ranges *ranges = &own->trajectory->ranges;
    Range *values = ranges->values + own->stretch * ranges->signal_count;
    for (size_t i = 0; i < ranges->signal_count; i++) {
        range_join(&values[i], &own->now[i]);
    }
    empty_stretch(own);
}

// Goes on to the stretch in which a step ends.
static void turn_to_stretch(RecorderRanges *own, const StepRecord *step)
{
    const Ranges *ranges = &own->trajectory->ranges;
    const size_t target = ranges_find(ranges, step->end_s - BORDER_ROUNDING * ranges->width_s);
    while (own->stretch < target) {
        if (step->is_mean) {
            add_to_stretch(own, step, own->now);
        }
        close_stretch(own);
        own->stretch = step->is_mean ? own->stretch + 1 : target;
    }
    set_stretch_end(own);
}

// Takes in one step.
static void recorder_ranges_add(RecorderRanges *own, const StepRecord *step)
{
    const Ranges *ranges = &own->trajectory->ranges;
    if (ranges->count == 0) {
        return;
    }
    if (step->part != NULL) {
        // parts are not in the order of their times
        const size_t stretch = ranges_find(ranges, step->end_s - BORDER_ROUNDING * ranges->width_s);
        add_to_stretch(own, step, ranges->values + stretch * ranges->signal_count);
        return;
    }
    if (step->end_s > own->stretch_end_s) {
        turn_to_stretch(own, step);
    }
    add_to_stretch(own, step, own->now);
}

// Takes in a state of a part or of all (NULL) at any time: into one stretch or, at a border, into
// two that follow one another.
static inline void recorder_ranges_see(const RecorderRanges *own, const SolverPart *part,
                                       const Sample *sample)
{
    const Linkage *linkage = &own->scenario->linkage;
    const Ranges *ranges = &own->trajectory->ranges;
    if (ranges->count == 0) {
        return;
    }
    size_t first;
    const size_t last = ranges_find_all(ranges, sample->time_s, &first);
    Range *before = ranges->values + first * ranges->signal_count;
    Range *behind = ranges->values + last * ranges->signal_count;
    const size_t body_count = solver_body_count(part, linkage);
    const size_t joint_count = solver_joint_count(part, linkage);
    for (size_t k = 0; k < body_count; k++) {
        const size_t i = solver_body(part, k);
        const Motion *motion = &sample->bodies[i];
        const double acceleration = vec2_length(motion->acceleration);
        const size_t at = ranges_of_body(i, 0);
        for (Range *range = before + at; range <= behind + at; range += ranges->signal_count) {
            range_add(&range[RANGES_OMEGA], motion->omega);
            range_add(&range[RANGES_ALPHA], motion->alpha);
            range_add(&range[RANGES_ACCELERATION], acceleration);
        }
    }
    for (size_t k = 0; k < joint_count; k++) {
        const size_t i = solver_joint(part, k);
        const JointState *joint = &sample->joints[i];
        const size_t at = ranges_of_joint(ranges, i, 0);
        for (Range *range = before + at; range <= behind + at; range += ranges->signal_count) {
            range_add(&range[RANGES_FORCE], joint->force);
            range_add(&range[RANGES_GAP], joint->gap);
        }
    }
}

// Closes the stretch under way and frees the room.
static void recorder_ranges_finish(RecorderRanges *own)
{
    if (own->trajectory->ranges.count > 0) {
        close_stretch(own);
    }
    free(own->now);
    free(own->forces);
}

Recorder recorder_start(const Scenario *scenario, Trajectory *trajectory, const Solver *solver,
                        const void *of)
{
    trajectory->hash = HASH_START;
    const Linkage *linkage = &scenario->linkage;
    Recorder recorder = {
        .scenario = scenario,
        .trajectory = trajectory,
        .has_body = zeroed(linkage->body_count, sizeof *recorder.has_body),
        .has_joint = zeroed(linkage->joint_count, sizeof *recorder.has_joint),
        .was_touching = zeroed(linkage->joint_count, sizeof *recorder.was_touching),
        .open = zeroed(linkage->joint_count, sizeof *recorder.open),
        .cut = report_cut_start(linkage, solver, of, trajectory->report_from_s),
        .ranges = recorder_ranges_start(scenario, trajectory),
        .marking = solver != NULL && solver->is_ideal ? NULL : marking_start(scenario, trajectory),
    };
    // a contact that is under way has begun before
    for (size_t i = 0; i < linkage->joint_count; i++) {
        for (size_t k = 0; k < JOINT_PLACES; k++) {
            const ContactState *state = &linkage->joints[i].contacts[k];
            if (state->is_touching) {
                recorder.was_touching[i] = true;
                recorder.open[i].onset_s = -state->age_s;
                recorder.open[i].approach_speed = state->impact_speed;
            }
        }
    }
    return recorder;
}

static inline void raise_to(Extreme *extreme, bool is_first, double value, double time_s)
{
    if (is_first || value > extreme->value) {
        extreme->value = value;
        extreme->time_s = time_s;
    }
}

static inline void lower_to(Extreme *extreme, bool is_first, double value, double time_s)
{
    if (is_first || value < extreme->value) {
        extreme->value = value;
        extreme->time_s = time_s;
    }
}

// Whether a step that ends then belongs to the reported time. The first of all may have no length.
static bool is_after_start(const Recorder *recorder, double end_s)
{
    const double from_s = recorder->trajectory->report_from_s;
    return end_s > from_s || from_s == 0.0;
}

static bool recorder_is_stronger(const void *a, const void *b)
{
    return ((const Spike *)a)->force_max > ((const Spike *)b)->force_max;
}

static void keep_contact(Trajectory *trajectory, size_t joint, const Spike *spike)
{
    if (trajectory->contact_count == trajectory->contact_room) {
        trajectory->contact_room = trajectory->contact_room > 0 ? 2 * trajectory->contact_room : 64;
        trajectory->contacts =
            realloc(trajectory->contacts, trajectory->contact_room * sizeof *trajectory->contacts);
        assert(trajectory->contacts != NULL);
    }
    trajectory->contacts[trajectory->contact_count++] = (JointSpike){joint, *spike};
}

// One that began before the reported time is not a contact of it.
static void end_contact(Recorder *recorder, size_t number)
{
    if (recorder->open[number].onset_s >= recorder->trajectory->report_from_s) {
        if (recorder->scenario->run.keeps_contacts) {
            keep_contact(recorder->trajectory, number, &recorder->open[number]);
        }
        JointExtremes *joint = &recorder->trajectory->joints[number];
        sorted_insert(joint->spikes, &joint->spike_count, TRAJECTORY_SPIKE_MAX,
                      &recorder->open[number], sizeof(Spike), recorder_is_stronger);
    }
}

// Whether a peak that a step shows is on its side of the start of the reported time.
static bool is_kept(const Recorder *recorder, const StepRecord *step, double peak_s)
{
    const double from_s = recorder->trajectory->report_from_s;
    return peak_s >= from_s || step->end_s <= from_s;
}

// The force and depth of a joint at a time.
static JointPeak top_at(const JointState *state, double time_s)
{
    return (JointPeak){state->force, joint_state_depth(state), time_s, time_s};
}

// The largest force and depth of a joint in a step, as far as it knows. A step may show a peak of
// the one before, which need not have been reported.
static JointPeak top_of(const Recorder *recorder, const StepRecord *step, size_t index)
{
    const size_t number = solver_joint(step->part, index);
    if (recorder->is_cut && recorder->cut.is_cut[number]) {
        return recorder->cut.tops[number];
    }
    JointPeak top = top_at(&step->joints[index], step->joint_s);
    if (step->peaks == NULL) {
        return top;
    }
    const JointPeak *between = &step->peaks[index];
    const double force_s = between->force_s > 0.0 ? between->force_s : step->joint_s;
    const double depth_s = between->depth_s > 0.0 ? between->depth_s : step->joint_s;
    if (between->force > top.force && is_kept(recorder, step, force_s)) {
        top.force = between->force;
        top.force_s = force_s;
    }
    if (between->depth > top.depth && is_kept(recorder, step, depth_s)) {
        top.depth = between->depth;
        top.depth_s = depth_s;
    }
    return top;
}

// Of a joint in a step, by its place there.
static void recorder_add_contact(Recorder *recorder, const StepRecord *step, size_t index)
{
    const size_t number = solver_joint(step->part, index);
    const JointState *state = &step->joints[index];
    JointExtremes *joint = &recorder->trajectory->joints[number];
    Spike *spike = &recorder->open[number];
    const double duration = step->end_s - step->start_s;
    const double from_s = recorder->trajectory->report_from_s;
    const bool is_cut = recorder->is_cut && recorder->cut.is_cut[number];
    const bool is_reported = is_after_start(recorder, step->end_s);
    if (state->is_touching && !recorder->was_touching[number]) {
        joint->impacts += step->start_s >= from_s ? 1 : 0;
        *spike = (Spike){
            .onset_s = step->start_s,
            .crank_rad = linkage_crank_angle(&recorder->scenario->linkage, step->start_s),
            .approach_speed = step->approach[index],
        };
    }
    if (state->is_touching) {
        spike->duration_s += duration;
        spike->impulse += step->impulse[index];
        const JointPeak top = top_of(recorder, step, index);
        if (top.force > spike->force_max) {
            spike->force_max = top.force;
            spike->peak_s = top.force_s;
            spike->eccentricity = state->eccentricity;
        }
        spike->penetration_max = fmax(spike->penetration_max, top.depth);
        joint->contact_time += is_reported ? step->end_s - fmax(step->start_s, from_s) : 0.0;
        joint->impulse += is_cut        ? recorder->cut.after[number]
                          : is_reported ? step->impulse[index]
                                        : 0.0;
    } else if (recorder->was_touching[number]) {
        end_contact(recorder, number);
    }
    recorder->was_touching[number] = state->is_touching;
}

// Likewise into its marks.
static void add_marks(Recorder *recorder, const StepRecord *step, size_t index)
{
    if (recorder->marking != NULL) {
        const JointPeak top = top_of(recorder, step, index);
        marking_add(recorder->marking, step, index, &top);
    }
}

// Raises the extremes of one body and one joint to what they are at a time.
static inline void raise_body(BodyExtremes *body, bool is_first, double omega, double alpha,
                              double time_s)
{
#define MOVE_EXTREME(name, signal, how) how(&body->name, is_first, signal, time_s);
    BODY_EXTREMES_LIST(MOVE_EXTREME)
}

// The tilt is that of a block between guides.
static inline void raise_joint(JointExtremes *extremes, bool is_first, const Joint *joint,
                               const JointPeak *top, double tilt, double time_s)
{
    raise_to(&extremes->force_max, is_first, top->force, top->force_s);
    raise_to(&extremes->penetration_max, is_first, top->depth, top->depth_s);
    if (joint_has_guides(joint->kind)) {
        raise_to(&extremes->tilt_max, is_first, fabs(tilt), time_s);
    }
}

static void raise_joint_space(JointExtremes *joint, bool is_first, const SpaceJointState *state,
                              double time_s)
{
    raise_to(&joint->tilt_max, is_first, state->tilt, time_s);
    raise_to(&joint->axial_max, is_first, fabs(state->axial), time_s);
}

// Those of one body, by its number in the step's record.
static void recorder_raise_body(Recorder *recorder, const StepRecord *step, size_t k)
{
    const size_t i = solver_body(step->part, k);
    raise_body(&recorder->trajectory->bodies[i], !recorder->has_body[i], step->omega[k],
               step->alpha[k], step->end_s);
    recorder->has_body[i] = true;
}

static void recorder_raise_joint(Recorder *recorder, const StepRecord *step, size_t k)
{
    const size_t i = solver_joint(step->part, k);
    if (!report_cut_has(&recorder->cut, i)) {
        return; // the last that is known of it is not reported
    }
    const JointPeak top = top_of(recorder, step, k);
    const bool is_first = !recorder->has_joint[i];
    JointExtremes *joint = &recorder->trajectory->joints[i];
    if (step->space_joints != NULL) {
        raise_joint_space(joint, is_first, &step->space_joints[k], step->joint_s);
    }
    raise_joint(joint, is_first, &recorder->scenario->linkage.joints[i], &top, step->joints[k].tilt,
                step->joint_s);
    recorder->has_joint[i] = true;
}

// Of what is as it was in the record before nothing rises.
static void raise_changed(Recorder *recorder, const StepRecord *step)
{
    for (size_t n = 0; n < step->changed->body_count; n++) {
        recorder_raise_body(recorder, step, step->changed->bodies[n]);
    }
    for (size_t n = 0; n < step->changed->joint_count; n++) {
        recorder_raise_joint(recorder, step, step->changed->joints[n]);
    }
}

static void recorder_raise_all(Recorder *recorder, const StepRecord *step)
{
    const Linkage *linkage = &recorder->scenario->linkage;
    const size_t body_count = solver_body_count(step->part, linkage);
    const size_t joint_count = solver_joint_count(step->part, linkage);
    if (step->changed != NULL && recorder->has_all) {
        raise_changed(recorder, step);
        return;
    }
    for (size_t k = 0; k < body_count; k++) {
        recorder_raise_body(recorder, step, k);
    }
    for (size_t k = 0; k < joint_count; k++) {
        recorder_raise_joint(recorder, step, k);
    }
    recorder->has_all = step->part == NULL;
}

void recorder_add(Recorder *recorder, const StepRecord *step)
{
    Trajectory *trajectory = recorder->trajectory;
    const Linkage *linkage = &recorder->scenario->linkage;
    const size_t body_count = solver_body_count(step->part, linkage);
    const size_t joint_count = solver_joint_count(step->part, linkage);
    uint64_t hash = trajectory->hash;
    recorder->is_cut = report_cut_take(&recorder->cut, step);
    for (size_t k = 0; k < body_count; k++) {
        hash = hash_number(hash_number(hash, step->omega[k]), step->alpha[k]);
    }
    for (size_t k = 0; k < joint_count; k++) {
        hash = hash_number(hash, step->joints[k].force);
        if (linkage_has_play(&linkage->joints[solver_joint(step->part, k)])) {
            recorder_add_contact(recorder, step, k);
            add_marks(recorder, step, k);
        }
    }
    trajectory->hash = hash;
    if (is_after_start(recorder, step->end_s)) {
        recorder_raise_all(recorder, step);
    }
    recorder_ranges_add(&recorder->ranges, step);
    trajectory->energy.drive_work += step->drive_work;
    trajectory->energy.load_work += step->load_work;
    trajectory->energy.dissipated += step->dissipated;
    trajectory->energy.friction += step->friction;
}

// Raises the contact under way to what a sample in it shows.
static inline void see_contact(Recorder *recorder, size_t number, const JointState *state,
                               double time_s)
{
    Spike *spike = &recorder->open[number];
    if (!recorder->was_touching[number] || time_s < spike->onset_s) {
        return;
    }
    if (state->force > spike->force_max) {
        spike->force_max = state->force;
        spike->peak_s = time_s;
        spike->eccentricity = state->eccentricity;
    }
    const double depth = joint_state_depth(state);
    spike->penetration_max = depth > spike->penetration_max ? depth : spike->penetration_max;
}

double recorder_contact_force(const Recorder *recorder, size_t joint)
{
    const JointExtremes *of = &recorder->trajectory->joints[joint];
    const Spike *spike = &recorder->open[joint];
    // one that is weaker than all that are kept is in no result
    const bool is_kept = recorder->scenario->run.keeps_contacts ||
                         of->spike_count < TRAJECTORY_SPIKE_MAX ||
                         spike->force_max > of->spikes[TRAJECTORY_SPIKE_MAX - 1].force_max;
    // a contact may have been stronger before run.report-from than the joint has been since
    return recorder->was_touching[joint] && is_kept ? fmin(spike->force_max, of->force_max.value)
                                                    : of->force_max.value;
}

// Raises the extremes to those of a sample of a part or of all (NULL).
static inline void see_extremes(Recorder *recorder, const SolverPart *part, const Sample *sample)
{
    Trajectory *trajectory = recorder->trajectory;
    const Linkage *linkage = &recorder->scenario->linkage;
    const size_t body_count = solver_body_count(part, linkage);
    const size_t joint_count = solver_joint_count(part, linkage);
    const double time_s = sample->time_s;
    for (size_t k = 0; k < body_count; k++) {
        const size_t i = solver_body(part, k);
        if (recorder->has_body[i]) {
            raise_body(&trajectory->bodies[i], false, sample->bodies[i].omega,
                       sample->bodies[i].alpha, time_s);
        }
    }
    for (size_t k = 0; k < joint_count; k++) {
        const size_t i = solver_joint(part, k);
        if (!recorder->has_joint[i]) {
            continue;
        }
        const JointState *state = &sample->joints[i];
        const JointPeak top = top_at(state, time_s);
        raise_joint(&trajectory->joints[i], false, &linkage->joints[i], &top, state->tilt, time_s);
        see_contact(recorder, i, state, time_s);
        marking_see(recorder->marking, part, i, sample);
        if (linkage->is_spatial) {
            raise_joint_space(&trajectory->joints[i], false, &sample->space_joints[i], time_s);
        }
    }
}

static inline void see(Recorder *recorder, const SolverPart *part, const Sample *sample)
{
    recorder_ranges_see(&recorder->ranges, part, sample);
    if (!(sample->time_s < recorder->trajectory->report_from_s)) {
        see_extremes(recorder, part, sample);
    }
}

// Every sample comes here. Mostly it is one of all bodies, which then are those from the first on.
void recorder_see(Recorder *recorder, const SolverPart *part, const Sample *sample)
{
    if (part == NULL) {
        see(recorder, NULL, sample);
    } else {
        see(recorder, part, sample);
    }
}

// The same, to be changed.
static Extreme *find_extreme(Trajectory *trajectory, RecorderSignal signal, size_t number,
                             double sign)
{
    BodyExtremes *body = &trajectory->bodies[number];
    switch (signal) {
    case RECORDER_OMEGA:
        return sign > 0.0 ? &body->omega_max : &body->omega_min;
    case RECORDER_ALPHA:
        return sign > 0.0 ? &body->alpha_max : &body->alpha_min;
    default:
        return &trajectory->joints[number].force_max;
    }
}

const Extreme *recorder_extreme(const Recorder *recorder, RecorderSignal signal, size_t number,
                                double sign)
{
    return find_extreme(recorder->trajectory, signal, number, sign);
}

void recorder_raise(Recorder *recorder, RecorderSignal signal, size_t number, double sign,
                    Extreme extreme)
{
    Trajectory *trajectory = recorder->trajectory;
    const bool is_force = signal == RECORDER_FORCE;
    const RangesOfBody of_body = signal == RECORDER_OMEGA ? RANGES_OMEGA : RANGES_ALPHA;
    if (trajectory->ranges.count > 0) {
        ranges_add(&trajectory->ranges,
                   is_force ? ranges_of_joint(&trajectory->ranges, number, RANGES_FORCE)
                            : ranges_of_body(number, of_body),
                   extreme.time_s, extreme.value);
    }
    Spike *spike = is_force && recorder->was_touching[number] ? &recorder->open[number] : NULL;
    if (spike != NULL && extreme.time_s >= spike->onset_s && extreme.value > spike->force_max) {
        spike->force_max = extreme.value;
        spike->peak_s = extreme.time_s;
    }
    if (is_force) {
        marking_raise(recorder->marking, number, extreme.value, extreme.time_s);
    }
    const bool is_beyond =
        sign * extreme.value > sign * find_extreme(trajectory, signal, number, sign)->value;
    if (is_beyond && extreme.time_s >= trajectory->report_from_s &&
        (is_force ? recorder->has_joint : recorder->has_body)[number]) {
        *find_extreme(trajectory, signal, number, sign) = extreme;
    }
}

static void set_crank(const Linkage *linkage, Extreme *extreme)
{
    extreme->crank_rad = linkage_crank_angle(linkage, extreme->time_s);
}

void recorder_finish(Recorder *recorder)
{
    Trajectory *trajectory = recorder->trajectory;
    const Linkage *linkage = &recorder->scenario->linkage;
    recorder_ranges_finish(&recorder->ranges);
    report_cut_finish(&recorder->cut);
    marking_finish(recorder->marking);
    for (size_t i = 0; i < trajectory->body_count; i++) {
#define SET_CRANK(name, ...) set_crank(linkage, &trajectory->bodies[i].name);
        BODY_EXTREMES_LIST(SET_CRANK)
    }
    for (size_t i = 0; i < trajectory->joint_count; i++) {
        if (recorder->was_touching[i]) {
            end_contact(recorder, i);
        }
        set_crank(linkage, &trajectory->joints[i].force_max);
        set_crank(linkage, &trajectory->joints[i].penetration_max);
        set_crank(linkage, &trajectory->joints[i].tilt_max);
        set_crank(linkage, &trajectory->joints[i].axial_max);
    }
    free(recorder->has_body);
    free(recorder->has_joint);
    free(recorder->was_touching);
    free(recorder->open);
}
