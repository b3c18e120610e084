// Finds the numbers of model/number_list.h in a run.
#include "measure/number_values.h"

#include "measure/creep.h"
#include "measure/section.h"
#include "measure/spectrum.h"
#include "measure/wear.h"

#include <math.h>

static Extreme number_is(Extreme extreme)
{
    return extreme;
}

static Extreme number_only(double value)
{
    return (Extreme){value, NAN, NAN};
}

// A value of the list, which is a number or an Extreme.
#define AS_EXTREME(value) _Generic((value), Extreme : number_is, default : number_only)(value)

// What the values of the list are made of.

static double spikes_counted(const SignalSpikes *found, const NumberSource *of)
{
    return found->is_known && !of->is_at_samples ? (double)found->count : NAN;
}

// Widths and impulses come from a history that is thinned where it is nearly straight: rounding now
// and then moves them by what the thinning allows, and sizes not.
static double spikes_mean(const SignalSpikes *found, const NumberSource *of)
{
    double sum = 0.0;
    for (size_t i = 0; i < found->kept; i++) {
        sum += fabs(found->spikes[i].value) / (double)found->kept;
    }
    return found->is_known && !of->is_at_samples ? sum : NAN;
}

// At the samples only of a joint without play: a solver looks for the peak of a contact between its
// steps.
static Extreme force_max(const NumberSource *of, size_t joint)
{
    const Trajectory *run = of->run;
    if (!of->is_at_samples || linkage_has_play(&run->linkage.joints[joint])) {
        return run->joints[joint].force_max;
    }
    Extreme most = {0.0, NAN, NAN};
    for (size_t k = 0; k < run->sample_count; k++) {
        const double force = trajectory_state(run, k, joint)->force;
        if (force > most.value) {
            most = (Extreme){force, run->times[k], run->crank_angles[k]};
        }
    }
    return most;
}

// NAN where the solver let no play happen.
static double impacts_of_all(const Trajectory *run)
{
    double impacts = NAN;
    for (size_t i = 0; i < run->joint_count; i++) {
        if (trajectory_feels_play(run, &run->linkage.joints[i])) {
            impacts = (isnan(impacts) ? 0.0 : impacts) + (double)run->joints[i].impacts;
        }
    }
    return impacts;
}

static BodyExtremes extremes_of(const NumberSource *of, size_t body)
{
    return of->is_at_samples ? number_extremes_at_samples(of->run, body) : of->run->bodies[body];
}

static double alpha_peak(const NumberSource *of)
{
    double peak = 0.0;
    for (size_t i = 0; i < of->run->body_count; i++) {
        const BodyExtremes extremes = extremes_of(of, i);
        if (!linkage_is_driven(&of->run->linkage, (int)i)) {
            peak = fmax(peak, fmax(extremes.alpha_max.value, -extremes.alpha_min.value));
        }
    }
    return peak;
}

static double residual_share(const Trajectory *run)
{
    const double scale = error_energy(run);
    return scale > 0.0 ? fabs(run->energy.residual) / scale : NAN;
}

// What an extreme is moved by, as in every step.
#define SAMPLES_raise_to fmax
#define SAMPLES_lower_to fmin

BodyExtremes number_extremes_at_samples(const Trajectory *run, size_t body)
{
    BodyExtremes extremes = {0};
    for (size_t k = 0; k < run->sample_count; k++) {
        const Motion *motion = trajectory_motion(run, k, body);
        const double omega = motion->omega;
        const double alpha = motion->alpha;
#define MOVE_EXTREME(name, signal, how)                                                            \
    extremes.name = number_only(k == 0 ? signal : SAMPLES_##how(extremes.name.value, signal));
        BODY_EXTREMES_LIST(MOVE_EXTREME)
    }
    return extremes;
}

static const SignalSpike *strongest_spike(const NumberSource *of, const SignalSpikes *found)
{
    if (of->spike != NULL) {
        return of->spike;
    }
    return found->is_known && found->kept > 0 && !of->is_at_samples ? &found->spikes[0] : NULL;
}

static const Spike *strongest_contact(const NumberSource *of, size_t joint)
{
    if (of->contact != NULL) {
        return of->contact;
    }
    const JointExtremes *extremes = &of->run->joints[joint];
    const bool has_any = extremes->spike_count > 0 &&
                         trajectory_feels_play(of->run, &of->run->linkage.joints[joint]);
    return has_any && !of->is_at_samples ? &extremes->spikes[0] : NULL;
}

// Whether there is anything of an owner to take numbers from.
static bool has_owner(NumberOwner owner, const NumberSource *of, size_t member)
{
    const bool has_run = of->run != NULL && of->run->is_complete;
    const bool has_settled = of->scenario != NULL && of->scenario->settled.motion_count > 0;
    const bool has_numbers = has_settled && !of->scenario->settled.is_brief;
    const bool has_error = of->error != NULL && of->error->is_known;
    switch (owner) {
    case NUMBER_OWNER_BODY:
    case NUMBER_OWNER_JOINT:
    case NUMBER_OWNER_RUN:
    case NUMBER_OWNER_ENERGY:
    case NUMBER_OWNER_COST:
    case NUMBER_OWNER_SECTION:
        return has_run;
    case NUMBER_OWNER_BODY_SPIKE:
        return has_run && strongest_spike(of, &of->run->alpha_spikes[member]) != NULL;
    case NUMBER_OWNER_JOINT_SPIKE:
        return has_run && strongest_spike(of, &of->run->force_spikes[member]) != NULL;
    case NUMBER_OWNER_JOINT_CONTACT:
        return has_run && strongest_contact(of, member) != NULL;
    case NUMBER_OWNER_JOINT_WEAR:
        return has_run && trajectory_feels_play(of->run, &of->run->linkage.joints[member]) &&
               wear_has(&of->run->linkage.joints[member]);
    case NUMBER_OWNER_SETTLED:
        return has_settled;
    case NUMBER_OWNER_SETTLED_BODY:
        return has_numbers;
    case NUMBER_OWNER_SETTLED_JOINT:
        return has_numbers && linkage_has_play(&of->scenario->linkage.joints[member]);
    case NUMBER_OWNER_ERROR:
        return has_error;
    case NUMBER_OWNER_TRUTH:
        return has_error && of->truth != NULL;
    case NUMBER_OWNER_COUNT:
        break;
    }
    return false;
}

// What the values of an owner may name, of which each has_owner.
// clang-format off
#define LOCALS_BODY \
    const Trajectory *run = of->run; \
    const BodyExtremes found = extremes_of(of, member); \
    const BodyExtremes *extremes = &found; \
    (void)run, (void)extremes;
#define LOCALS_BODY_SPIKE \
    const SignalSpike *spike = strongest_spike(of, &of->run->alpha_spikes[member]); \
    (void)spike;
#define LOCALS_JOINT \
    const Trajectory *run = of->run; \
    const JointExtremes *extremes = &run->joints[member]; \
    (void)run, (void)extremes;
#define LOCALS_JOINT_SPIKE \
    const SignalSpike *spike = strongest_spike(of, &of->run->force_spikes[member]); \
    (void)spike;
#define LOCALS_JOINT_CONTACT \
    const Spike *contact = strongest_contact(of, member); \
    (void)contact;
#define LOCALS_JOINT_WEAR \
    const Wear wear = of->wear != NULL ? *of->wear : wear_of(of->run, member); \
    (void)wear;
#define LOCALS_RUN \
    const Trajectory *run = of->run; \
    (void)run;
#define LOCALS_ENERGY \
    const Energy *energy = &of->run->energy; \
    (void)energy;
#define LOCALS_COST LOCALS_RUN
#define LOCALS_SECTION LOCALS_RUN
#define LOCALS_SETTLED \
    const SettledStart *settled = &of->scenario->settled; \
    const SettledMotion *motion = &settled->motions[0]; \
    (void)settled, (void)motion;
#define LOCALS_SETTLED_JOINT \
    const SettledJoint *did = &of->scenario->settled.motions[0].joints[member]; \
    (void)did;
#define LOCALS_SETTLED_BODY \
    const SettledNumber *alpha = &of->scenario->settled.motions[0].alpha[member]; \
    (void)alpha;
#define LOCALS_ERROR \
    const TrajectoryError *error = of->error; \
    (void)error;
#define LOCALS_TRUTH \
    const Truth *truth = of->truth; \
    (void)truth;

#define VALUE_BODY(value)          value
#define VALUE_BODY_SPIKE(value)    value
#define VALUE_JOINT(value)         value
#define VALUE_JOINT_SPIKE(value)   value
#define VALUE_JOINT_CONTACT(value) value
#define VALUE_JOINT_WEAR(value)    value
#define VALUE_RUN(value)           value
#define VALUE_ENERGY(value)        value
#define VALUE_COST(value)          value
#define VALUE_SECTION(value)       value
#define VALUE_SETTLED(value)       value
#define VALUE_SETTLED_JOINT(value) value
#define VALUE_SETTLED_BODY(value)  value
#define VALUE_ERROR(member)        error->member
#define VALUE_TRUTH(value)         value

#define FINDER(owner, id, name, kind, title, turned, format, places, traits, value, ...) \
    static Extreme find_##owner##_##id(const NumberSource *of, size_t member) \
    { \
        LOCALS_##owner \
        (void)of, (void)member; \
        return AS_EXTREME(VALUE_##owner(value)); \
    }
// clang-format on
NUMBER_LIST(FINDER)

typedef Extreme (*Finder)(const NumberSource *of, size_t member);

#define ROW_FINDER(owner, id, ...) [NUMBER_##owner##_##id] = find_##owner##_##id,
static const Finder FINDERS[NUMBER_COUNT] = {NUMBER_LIST(ROW_FINDER)};

Extreme number_find(NumberId id, const NumberSource *of, size_t member)
{
    const Number *number = &NUMBERS[id];
    const bool is_of_play =
        number->owner == NUMBER_OWNER_JOINT && (number->traits & NUMBER_PLAY) != 0;
    if (!has_owner(number->owner, of, member) ||
        (is_of_play && !trajectory_feels_play(of->run, &of->run->linkage.joints[member]))) {
        return number_only(NAN);
    }
    return FINDERS[id](of, member);
}

bool number_is_of(const Number *number, const Linkage *linkage, size_t member)
{
    const unsigned traits = number->traits;
    const NumberMembers members = number_members(number);
    if ((traits & NUMBER_LOADED) != 0 && linkage->load_count == 0) {
        return false;
    }
    if ((traits & NUMBER_SPATIAL) != 0 && !linkage->is_spatial) {
        return false;
    }
    if (number->owner == NUMBER_OWNER_JOINT_WEAR) {
        return wear_has(&linkage->joints[member]);
    }
    if (members == NUMBER_OF_JOINTS) {
        return !number_needs_play(number) || linkage_has_play(&linkage->joints[member]);
    }
    if (members == NUMBER_OF_BODIES) {
        const bool slides = section_slider(linkage, member) >= 0;
        return !linkage_is_driven(linkage, (int)member) &&
               !((traits & NUMBER_TURNS) != 0 && slides) &&
               !((traits & NUMBER_SLIDES) != 0 && !slides);
    }
    return true;
}

NumberTurn number_turn(NumberOwner owner, const Linkage *linkage, size_t member)
{
    if (owner == NUMBER_OWNER_BODY_SPIKE) {
        return NUMBER_SPED;
    }
    return NUMBER_OWNERS[owner].members == NUMBER_OF_JOINTS &&
                   linkage_is_torsional(&linkage->joints[member])
               ? NUMBER_TURNED
               : NUMBER_PUSHED;
}

size_t number_member_count(NumberOwner owner, const Linkage *linkage)
{
    switch (NUMBER_OWNERS[owner].members) {
    case NUMBER_OF_BODIES:
        return linkage->body_count;
    case NUMBER_OF_JOINTS:
        return linkage->joint_count;
    case NUMBER_OF_WHOLE:
        break;
    }
    return 1;
}

const char *number_member(NumberOwner owner, const Linkage *linkage, size_t member)
{
    switch (NUMBER_OWNERS[owner].members) {
    case NUMBER_OF_BODIES:
        return linkage->bodies[member].name;
    case NUMBER_OF_JOINTS:
        return linkage->joints[member].name;
    case NUMBER_OF_WHOLE:
        break;
    }
    return "";
}
