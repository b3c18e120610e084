// Marks the instants of contacts that a picture must not miss.
//
// A contact may be shorter than the distance of two samples, and its largest force then lies
// between them. Each contact is followed from step to step: its onset and its end, where force and
// depth are 0, the largest force, the deepest point, and of the states between as many as there is
// room for, about evenly spread over the steps. Of each joint the strongest contacts are kept, and
// the one that goes deepest.
#include "run/marking.h"
#include "base/memory.h"
#include "base/zeroed.h"

#include <math.h>
#include <stdlib.h>

enum {
    MARKING_KEYS = 4, // onset, peak, deepest, end
    BETWEEN_MOST = MARKS_MOST - MARKING_KEYS,
    CONTACTS_MOST = 2048, // of all joints together
    CONTACTS_LEAST = 16,  // of one
};

// A contact under way.
typedef struct Track {
    bool is_open;
    bool has_onset;
    MarkedContact contact; // without marks so far
    ContactMark onset;
    ContactMark peak;
    ContactMark deepest;
    ContactMark last;
    size_t between_count;
    size_t stride; // of the states seen every so many-th is kept
    size_t seen;
    ContactMark between[BETWEEN_MOST];
} Track;

// The contacts of a joint that are kept: twice as many as wanted at most, before the weak are left.
typedef struct MarkedJoint {
    size_t count;
    MarkedContact *contacts; // owned
} MarkedJoint;

struct Marking {
    const Scenario *scenario;
    Trajectory *trajectory;
    size_t most;         // contacts of a joint
    Track *tracks;       // by joint; owned, like the next
    MarkedJoint *joints; // by joint
};

static size_t count_with_play(const Linkage *linkage)
{
    size_t count = 0;
    for (size_t i = 0; i < linkage->joint_count; i++) {
        count += linkage_has_play(&linkage->joints[i]) ? 1 : 0;
    }
    return count;
}

Marking *marking_start(const Scenario *scenario, Trajectory *trajectory)
{
    const Linkage *linkage = &scenario->linkage;
    const size_t count = count_with_play(linkage);
    if (!scenario->run.keeps_marks || count == 0) {
        return NULL;
    }
    Marking *marking = zeroed(1, sizeof *marking);
    const size_t share = CONTACTS_MOST / count;
    *marking = (Marking){
        .scenario = scenario,
        .trajectory = trajectory,
        .most = share > CONTACTS_LEAST ? share : CONTACTS_LEAST,
        .tracks = zeroed(linkage->joint_count, sizeof *marking->tracks),
        .joints = zeroed(linkage->joint_count, sizeof *marking->joints),
    };
    return marking;
}

// The contacts of a joint that are kept.

static int by_strength(const void *a, const void *b)
{
    const MarkedContact *first = a;
    const MarkedContact *second = b;
    if (first->is_reported != second->is_reported) {
        return first->is_reported ? -1 : 1;
    }
    return (first->force_max < second->force_max) - (first->force_max > second->force_max);
}

// Leaves the strongest, with the deepest among them.
static void keep_strongest(MarkedJoint *joint, size_t most)
{
    if (joint->count <= most) {
        return;
    }
    qsort(joint->contacts, joint->count, sizeof *joint->contacts, by_strength);
    size_t deepest = 0;
    for (size_t i = 1; i < joint->count; i++) {
        const MarkedContact *one = &joint->contacts[i];
        const MarkedContact *best = &joint->contacts[deepest];
        deepest =
            one->is_reported == best->is_reported && one->depth_max > best->depth_max ? i : deepest;
    }
    if (deepest >= most) {
        joint->contacts[most - 1] = joint->contacts[deepest];
    }
    joint->count = most;
}

static int by_time(const void *a, const void *b)
{
    const ContactMark *first = a;
    const ContactMark *second = b;
    if (first->time_s != second->time_s) {
        return first->time_s < second->time_s ? -1 : 1;
    }
    return (first->kind > second->kind) - (first->kind < second->kind);
}

static void put_mark(MarkedContact *contact, const ContactMark *mark)
{
    for (size_t i = 0; mark->kind == CONTACT_MARK_BETWEEN && i < contact->count; i++) {
        if (contact->marks[i].time_s == mark->time_s) {
            return; // it is one of the others
        }
    }
    contact->marks[contact->count++] = *mark;
}

// The joint where it begins or ceases to be pressed, at that time.
static ContactMark at_border(const Joint *joint, const ContactMark *near, ContactMarkKind kind,
                             double time_s)
{
    ContactMark mark = *near;
    mark.kind = kind;
    mark.time_s = time_s;
    mark.force = 0.0;
    mark.force_on_b = (Vec2){0.0, 0.0};
    mark.gap = 0.0;
    mark.alpha_a = mark.alpha_b = NAN;
    const double far = vec2_length(near->eccentricity);
    if (joint_has_hole(joint->kind) && isfinite(near->gap) && far > 0.0) {
        mark.eccentricity = vec2_scale((far + near->gap) / far, near->eccentricity);
    }
    return mark;
}

// Ends a contact at a time; without an end mark where it goes on.
static void close_track(Marking *marking, size_t joint, double time_s, bool has_end)
{
    Track *track = &marking->tracks[joint];
    MarkedContact *contact = &track->contact;
    if (track->has_onset) {
        put_mark(contact, &track->onset);
    }
    put_mark(contact, &track->peak);
    put_mark(contact, &track->deepest);
    if (has_end) {
        const ContactMark end = at_border(&marking->scenario->linkage.joints[joint], &track->last,
                                          CONTACT_MARK_END, fmax(time_s, track->last.time_s));
        put_mark(contact, &end);
    }
    for (size_t i = 0; i < track->between_count; i++) {
        put_mark(contact, &track->between[i]);
    }
    qsort(contact->marks, contact->count, sizeof *contact->marks, by_time);
    MarkedJoint *kept = &marking->joints[joint];
    kept->contacts = memory_grown(kept->contacts, kept->count + 1, sizeof *kept->contacts);
    kept->contacts[kept->count++] = *contact;
    if (kept->count >= 2 * marking->most) {
        keep_strongest(kept, marking->most);
    }
    track->is_open = false;
}

// Following a contact.

// Every other one of those between makes room.
static void add_between(Track *track, const ContactMark *mark)
{
    if (track->seen++ % track->stride != 0) {
        return;
    }
    if (track->between_count == BETWEEN_MOST) {
        for (size_t i = 0; 2 * i < BETWEEN_MOST; i++) {
            track->between[i] = track->between[2 * i];
        }
        track->between_count = BETWEEN_MOST / 2;
        track->stride *= 2;
    }
    track->between[track->between_count] = *mark;
    track->between[track->between_count++].kind = CONTACT_MARK_BETWEEN;
}

static void open_track(Marking *marking, size_t joint, const ContactMark *mark, double onset_s,
                       bool has_onset)
{
    Track *track = &marking->tracks[joint];
    *track = (Track){
        .is_open = true,
        .has_onset = has_onset,
        .contact = {.joint = joint,
                    .is_reported = mark->time_s >= marking->trajectory->report_from_s},
        .peak = *mark,
        .deepest = *mark,
        .stride = 1,
    };
    track->peak.kind = CONTACT_MARK_PEAK;
    track->deepest.kind = CONTACT_MARK_DEEPEST;
    if (has_onset) {
        track->onset =
            at_border(&marking->scenario->linkage.joints[joint], mark, CONTACT_MARK_ONSET, onset_s);
    }
}

// Takes an instant into the contact that is under way, or into the part of it that is reported.
static void follow(Marking *marking, size_t joint, const ContactMark *mark)
{
    Track *track = &marking->tracks[joint];
    const double from_s = marking->trajectory->report_from_s;
    if (!track->contact.is_reported && mark->time_s >= from_s) {
        close_track(marking, joint, mark->time_s, false);
        open_track(marking, joint, mark, mark->time_s, false);
    }
    MarkedContact *contact = &track->contact;
    if (mark->force > contact->force_max) {
        contact->force_max = mark->force;
        track->peak = *mark;
        track->peak.kind = CONTACT_MARK_PEAK;
    }
    if (-mark->gap > contact->depth_max) {
        contact->depth_max = -mark->gap;
        track->deepest = *mark;
        track->deepest.kind = CONTACT_MARK_DEEPEST;
    }
    track->last = *mark;
}

static ContactMark mark_of(const JointState *state, double time_s)
{
    return (ContactMark){
        .time_s = time_s,
        .eccentricity = state->eccentricity,
        .force_on_b = state->force_on_b,
        .force = state->force,
        .gap = state->gap,
        .alpha_a = NAN,
        .alpha_b = NAN,
    };
}

// The same place, pressed by another force and, in a hole in the plane, another depth.
static ContactMark pressed_to(const Marking *marking, size_t joint, const ContactMark *near,
                              double force, double depth)
{
    const Linkage *linkage = &marking->scenario->linkage;
    ContactMark mark = *near;
    const double size = vec2_length(near->force_on_b);
    const double far = vec2_length(near->eccentricity);
    const Vec2 out = far > 0.0 ? vec2_scale(1.0 / far, near->eccentricity) : (Vec2){0.0, 0.0};
    mark.force = force;
    mark.force_on_b =
        size > 0.0 ? vec2_scale(force / near->force, near->force_on_b) : vec2_scale(-force, out);
    mark.gap = -depth;
    if (joint_has_hole(linkage->joints[joint].kind) && !linkage->is_spatial) {
        mark.eccentricity =
            vec2_scale(linkage_radial_clearance(&linkage->joints[joint]) + depth, out);
    }
    return mark;
}

// What a step shows of a contact beside its own instant: where one of a few microseconds lies in
// the step, that is all of it.
static void follow_top(Marking *marking, const StepRecord *step, size_t joint,
                       const ContactMark *own, const JointPeak *top)
{
    if (top->depth > -own->gap) {
        ContactMark deepest = pressed_to(marking, joint, own, own->force, top->depth);
        deepest.time_s = top->depth_s;
        follow(marking, joint, &deepest);
    }
    if (top->force > own->force) {
        ContactMark peak = pressed_to(marking, joint, own, top->force, fmax(top->depth, 0.0));
        peak.time_s = top->force_s;
        peak.alpha_a = peak.alpha_b = NAN;
        // how deep it is then is known where both are at one time
        peak.gap = top->force_s == top->depth_s ? peak.gap : NAN;
        follow(marking, joint, &peak);
    }
    marking->tracks[joint].last.time_s = step->end_s;
}

static double alpha_of(const double *alpha, int body)
{
    return body == LINKAGE_GROUND ? NAN : alpha[body];
}

void marking_add(Marking *marking, const StepRecord *step, size_t index, const JointPeak *top)
{
    if (marking == NULL) {
        return;
    }
    const size_t joint = solver_joint(step->part, index);
    const Joint *of = &marking->scenario->linkage.joints[joint];
    const JointState *state = &step->joints[index];
    Track *track = &marking->tracks[joint];
    if (!state->is_touching) {
        if (track->is_open) {
            close_track(marking, joint, step->start_s, true);
        }
        return;
    }
    ContactMark own = mark_of(state, step->joint_s);
    if (step->part == NULL) {
        own.alpha_a = alpha_of(step->alpha, of->body_a);
        own.alpha_b = alpha_of(step->alpha, of->body_b);
    }
    if (!track->is_open) {
        open_track(marking, joint, &own, step->start_s, step->start_s > 0.0);
    }
    follow(marking, joint, &own);
    if (!step->is_mean) {
        add_between(track, &own);
    }
    follow_top(marking, step, joint, &own, top);
}

void marking_see(Marking *marking, const SolverPart *part, size_t joint, const Sample *sample)
{
    if (marking == NULL || !marking->tracks[joint].is_open) {
        return;
    }
    const Joint *of = &marking->scenario->linkage.joints[joint];
    Track *track = &marking->tracks[joint];
    ContactMark mark = mark_of(&sample->joints[joint], sample->time_s);
    if (!sample->joints[joint].is_touching ||
        (track->has_onset && sample->time_s < track->onset.time_s)) {
        return;
    }
    if (part == NULL) {
        mark.alpha_a = of->body_a == LINKAGE_GROUND ? NAN : sample->bodies[of->body_a].alpha;
        mark.alpha_b = of->body_b == LINKAGE_GROUND ? NAN : sample->bodies[of->body_b].alpha;
    }
    const double last_s = track->last.time_s;
    follow(marking, joint, &mark);
    track->last.time_s = fmax(last_s, mark.time_s);
}

void marking_raise(Marking *marking, size_t joint, double force, double time_s)
{
    if (marking == NULL || !marking->tracks[joint].is_open) {
        return;
    }
    const Track *track = &marking->tracks[joint];
    const bool is_peak_near = fabs(track->peak.time_s - time_s) < fabs(track->last.time_s - time_s);
    const ContactMark *near = is_peak_near ? &track->peak : &track->last;
    const double depth = isfinite(near->gap) ? fmax(-near->gap, 0.0) : 0.0;
    if (force > track->contact.force_max && near->force > 0.0 &&
        !(track->has_onset && time_s < track->onset.time_s)) {
        ContactMark mark = pressed_to(marking, joint, near, force, depth);
        mark.time_s = time_s;
        mark.gap = NAN;
        mark.alpha_a = mark.alpha_b = NAN;
        const ContactMark last = track->last;
        follow(marking, joint, &mark);
        marking->tracks[joint].last = last;
    }
}

static int by_start(const void *a, const void *b)
{
    const double first = ((const MarkedContact *)a)->marks[0].time_s;
    const double second = ((const MarkedContact *)b)->marks[0].time_s;
    return (first > second) - (first < second);
}

void marking_finish(Marking *marking)
{
    if (marking == NULL) {
        return;
    }
    Trajectory *trajectory = marking->trajectory;
    for (size_t i = 0; i < trajectory->joint_count; i++) {
        if (marking->tracks[i].is_open) {
            close_track(marking, i, marking->tracks[i].last.time_s, false);
        }
        MarkedJoint *joint = &marking->joints[i];
        keep_strongest(joint, marking->most);
        if (joint->count > 0) {
            qsort(joint->contacts, joint->count, sizeof *joint->contacts, by_start);
        }
        for (size_t k = 0; k < joint->count; k++) {
            trajectory->marked = memory_grown(trajectory->marked, trajectory->marked_count + 1,
                                              sizeof *trajectory->marked);
            trajectory->marked[trajectory->marked_count++] = joint->contacts[k];
        }
        free(joint->contacts);
    }
    free(marking->tracks);
    free(marking->joints);
    free(marking);
}
