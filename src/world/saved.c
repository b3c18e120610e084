// A world's state as bytes: what a step leaves behind for the next one, and nothing else.
//
// Words of 8 bytes: a head, then each body in the order in which the world knows them, then each
// joint, then a checksum of all words before it. Numbers stand as they are in memory: they are for
// the same library on the same machine, and come back exactly.
//
// One walk over the fields counts, writes, checks and reads the words, so that none is forgotten in
// one of these. Bytes are checked before anything is read, also those whose checksum is right.
// Laws, limits and the numbers of rows and contacts are the joints' own and no part of the state:
// nothing in it is an index.
#include "base/hash.h"
#include "world/found.h"
#include "world/play.h"
#include "world/step.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

static const char MAGIC[16] = "jointplay state";

// Counts up where the words of a state or their meaning change.
static const uint64_t FORMAT = 3;

enum { WORD = 8 };

_Static_assert(sizeof(double) == WORD && sizeof(size_t) == WORD, "numbers and counts are words");

typedef enum WalkAim {
    WALK_COUNT, // the words
    WALK_WRITE, // the fields as words
    WALK_CHECK, // words, and change nothing
    WALK_READ,  // words into the fields
} WalkAim;

typedef struct Walk {
    WalkAim aim;
    char *to;         // of WALK_WRITE: where the state begins
    const char *from; // of WALK_CHECK and WALK_READ
    size_t count;     // words so far
    // of WALK_CHECK
    bool is_other;    // whether the state is of a world made in another way
    const char *name; // of the first number that no world has; NULL: none
    size_t word;      // where that is
    double value;
} Walk;

// What a number may be.
typedef struct Range {
    double least;
    double most;
} Range;

static const Range FINITE = {-DBL_MAX, DBL_MAX};
static const Range SIZE = {0.0, DBL_MAX};
static const Range SIZE_OR_NONE = {0.0, INFINITY};
static const Range OF_BODY = {-BODIES_LARGEST, BODIES_LARGEST};

// How far the square of a quaternion's length is from 1 at most: ODE keeps it to rounding.
static const double TURN_OFF = 1e-9;

// The next word: written from a field, or what stands there.
static uint64_t next_word(Walk *walk, uint64_t field)
{
    uint64_t word = field;
    if (walk->aim == WALK_WRITE) {
        memcpy(walk->to + WORD * walk->count, &word, WORD);
    } else if (walk->aim != WALK_COUNT) {
        memcpy(&word, walk->from + WORD * walk->count, WORD);
    }
    walk->count++;
    return word;
}

static void note_wrong(Walk *walk, const char *name, double value)
{
    if (walk->name == NULL) {
        walk->name = name;
        walk->word = walk->count - 1;
        walk->value = value;
    }
}

static void walk_number(Walk *walk, double *field, Range range, const char *name)
{
    uint64_t word;
    double value;
    memcpy(&word, field, WORD);
    word = next_word(walk, word);
    memcpy(&value, &word, WORD);
    if (walk->aim == WALK_READ) {
        *field = value;
    } else if (walk->aim == WALK_CHECK && !(value >= range.least && value <= range.most)) {
        note_wrong(walk, name, value);
    }
}

static void walk_numbers(Walk *walk, double *fields, size_t count, Range range, const char *name)
{
    for (size_t i = 0; i < count; i++) {
        walk_number(walk, &fields[i], range, name);
    }
}

static void walk_vec3(Walk *walk, Vec3 *field, const char *name)
{
    walk_number(walk, &field->x, FINITE, name);
    walk_number(walk, &field->y, FINITE, name);
    walk_number(walk, &field->z, FINITE, name);
}

static void walk_flag(Walk *walk, bool *field, const char *name)
{
    const uint64_t word = next_word(walk, *field ? 1 : 0);
    if (walk->aim == WALK_READ) {
        *field = word != 0;
    } else if (walk->aim == WALK_CHECK && word > 1) {
        note_wrong(walk, name, (double)word);
    }
}

static void walk_count(Walk *walk, size_t *field)
{
    const uint64_t word = next_word(walk, *field);
    if (walk->aim == WALK_READ) {
        *field = word;
    }
}

// A word that has to be this world's own.
static void walk_own(Walk *walk, uint64_t own)
{
    walk->is_other = next_word(walk, own) != own || walk->is_other;
}

static void walk_turn(Walk *walk, dQuaternion turn)
{
    const size_t first = walk->count;
    walk_numbers(walk, turn, 4, OF_BODY, "a body's orientation");
    if (walk->aim == WALK_CHECK) {
        dQuaternion found;
        memcpy(found, walk->from + WORD * first, sizeof found);
        const double square =
            found[0] * found[0] + found[1] * found[1] + found[2] * found[2] + found[3] * found[3];
        if (!(fabs(square - 1.0) <= TURN_OFF)) {
            note_wrong(walk, "the square of the length of a body's quaternion", square);
        }
    }
}

static void walk_body(Walk *walk, BodyRecord *record)
{
    BodyMoment *moment = &record->found;
    walk_numbers(walk, moment->position, 3, OF_BODY, "a body's position");
    walk_turn(walk, moment->turn);
    walk_numbers(walk, moment->velocity, 3, OF_BODY, "a body's velocity");
    walk_numbers(walk, moment->omega, 3, OF_BODY, "a body's angular velocity");
    walk_numbers(walk, moment->force, 3, OF_BODY, "a force on a body");
    walk_numbers(walk, moment->torque, 3, OF_BODY, "a torque on a body");
    walk_flag(walk, &moment->is_enabled, "whether a body is enabled");
    walk_numbers(walk, record->last_omega, 3, FINITE, "a body's angular velocity before");
    walk_numbers(walk, record->last_alpha, 3, FINITE, "a body's angular acceleration before");
    walk_flag(walk, &record->has_last, "whether a body was stepped before");
    walk_numbers(walk, record->opening, 6, FINITE, "how far ODE's joints moved a body");
    walk_flag(walk, &record->found_past.is_closed, "whether a body's joints are closed");
    walk_flag(walk, &record->found_past.has_speeds, "whether a body was stepped before");
    walk_numbers(walk, record->found_past.speeds, BODY_NUMBERS, OF_BODY, "a body's speeds before");
}

static void walk_mode(Walk *walk, BristleMode *field)
{
    const uint64_t word = next_word(walk, *field);
    if (walk->aim == WALK_READ) {
        *field = (BristleMode)word;
    } else if (walk->aim == WALK_CHECK && word > BRISTLE_SLIDING_BACK) {
        note_wrong(walk, "the mode of a contact's bristle", (double)word);
    }
}

static void walk_state(Walk *walk, ContactState *state)
{
    walk_flag(walk, &state->is_touching, "whether a contact touches");
    walk_flag(walk, &state->is_slack, "whether a contact is slack");
    walk_flag(walk, &state->is_released, "whether a contact was released");
    walk_flag(walk, &state->is_resting, "whether a contact's impact is over");
    walk_number(walk, &state->impact_speed, SIZE, "a contact's impact speed");
    walk_number(walk, &state->damping_speed, SIZE, "the speed in a contact's damping");
    walk_number(walk, &state->age_s, SIZE, "a contact's age");
    walk_number(walk, &state->bend, FINITE, "the bend of a contact's bristle");
    walk_mode(walk, &state->bristle);
}

static void walk_peaks(Walk *walk, ContactPeaks *peaks)
{
    walk_number(walk, &peaks->force, FINITE, "a contact's largest force");
    walk_number(walk, &peaks->depth, FINITE, "a contact's largest depth");
    walk_numbers(walk, peaks->forces, 2, FINITE, "a contact's force in a step before");
    walk_numbers(walk, peaks->depths, 2, FINITE, "a contact's depth in a step before");
    walk_flag(walk, &peaks->has_series, "whether a contact has lasted for a step");
    walk_number(walk, &peaks->since, FINITE, "the time between a contact's steps");
}

// Not what each step finds anew before it looks at it.
static void walk_side(Walk *walk, Side *side)
{
    walk_state(walk, &side->state);
    walk_number(walk, &side->age, SIZE, "a contact's age");
    walk_number(walk, &side->lasts, SIZE_OR_NONE, "how long a contact lasts");
    walk_number(walk, &side->tried, FINITE, "a contact's mobility");
    walk_number(walk, &side->inside, SIZE, "a contact's depth");
    walk_number(walk, &side->last_closing, FINITE, "a contact's closing speed before");
    walk_number(walk, &side->last_step, SIZE, "the step before");
    walk_number(walk, &side->mobility, FINITE, "a contact's mobility");
    walk_number(walk, &side->force, FINITE, "a contact's force");
    walk_peaks(walk, &side->peaks);
    walk_number(walk, &side->force_max, FINITE, "the largest force of a side");
    walk_number(walk, &side->depth_max, FINITE, "the largest depth of a side");
    walk_number(walk, &side->impulse, FINITE, "the impulse of a side");
    walk_number(walk, &side->work, FINITE, "the work of a side");
    walk_count(walk, &side->impacts);
}

// What steps with contacts inside them have left for the next one.
static void walk_inside(Walk *walk, KernelContact *contact)
{
    walk_state(walk, &contact->state);
    walk_number(walk, &contact->frequency, SIZE, "a contact's frequency");
    walk_number(walk, &contact->force_per_speed, SIZE, "a contact's force per speed");
    walk_number(walk, &contact->tolerance, SIZE, "a contact's tolerance");
    walk_number(walk, &contact->first_width_s, SIZE, "a contact's first local step");
    walk_numbers(walk, contact->mobility_before, 3, FINITE, "a contact's mobility before");
    walk_flag(walk, &contact->is_overdamped, "whether a contact is overdamped");
}

// A rotor that is driven has the inertia that its joint was made with; one that is led has none.
static void walk_rotor(Walk *walk, const JpJoint *joint, Rotor *rotor)
{
    bool is_driven = isfinite(rotor->inertia);
    walk_flag(walk, &is_driven, "whether a rotor is driven");
    if (walk->aim == WALK_READ) {
        rotor->inertia = is_driven && joint->rotor_inertia > 0.0 ? joint->rotor_inertia : INFINITY;
    }
    walk_number(walk, &rotor->position, FINITE, "a rotor's position");
    walk_number(walk, &rotor->speed, FINITE, "a rotor's speed");
    walk_number(walk, &rotor->drive, FINITE, "a rotor's drive");
}

static void walk_rub(Walk *walk, RubFound *rub)
{
    size_t known = (size_t)rub->row.known;
    walk_numbers(walk, rub->row.pressing, 2, SIZE, "what pressed on a joint");
    walk_count(walk, &known);
    if (walk->aim == WALK_READ) {
        rub->row.known = known > 2 ? 2 : (int)known; // more are not told apart
    }
    walk_number(walk, &rub->row.gained, FINITE, "what a joint's speed gained");
    walk_number(walk, &rub->row.late, FINITE, "the friction that a joint is owed");
    walk_number(walk, &rub->row.torque, SIZE, "the friction that a joint can hold");
    walk_number(walk, &rub->force, FINITE, "the friction of a joint");
    walk_number(walk, &rub->slid, FINITE, "the energy that friction has taken");
    walk_flag(walk, &rub->is_sticking, "whether a joint's friction sticks");
}

static void walk_joint(Walk *walk, JpJoint *joint)
{
    JointFound *found = &joint->found;
    walk_own(walk, joint->kind);
    walk_own(walk, joint->place_count);
    walk_own(walk, joint->rotor_inertia > 0.0 ? 1 : 0);
    walk_rotor(walk, joint, &found->rotor);
    walk_vec3(walk, &found->force, "a joint's force");
    walk_number(walk, &found->last, FINITE, "a joint's angle");
    if (joint->kind == PLAY_FRICTION) {
        walk_rub(walk, &found->rub);
    }
    for (size_t i = 0; i < joint->place_count; i++) {
        for (size_t k = 0; k < SIDE_COUNT; k++) {
            walk_side(walk, &found->places[i].sides[k]);
            walk_inside(walk, &found->places[i].inside[k]);
        }
        walk_number(walk, &found->places[i].slid, FINITE, "the energy that friction has taken");
    }
}

static void walk_stats(Walk *walk, JpWorldStats *stats)
{
    walk_count(walk, &stats->steps);
    walk_count(walk, &stats->world_steps);
    walk_count(walk, &stats->rows);
    walk_count(walk, &stats->fallbacks);
    walk_count(walk, &stats->coarse);
}

static void walk_pace(Walk *walk, WorldPace *pace)
{
    walk_flag(walk, &pace->is_set, "whether local steps were made");
    walk_numbers(walk, pace->longest_s, 2, SIZE_OR_NONE, "the next local step");
    walk_number(walk, &pace->duration_before_s, SIZE, "the step before");
    walk_number(walk, &pace->stiff_width_s, SIZE_OR_NONE, "the next implicit local step");
}

static size_t count_joints(const JpWorld *world)
{
    size_t count = 0;
    for (const JpJoint *joint = world->joints; joint != NULL; joint = joint->next) {
        count++;
    }
    return count;
}

// The words in front, by which bytes are known to be a state of this library: MAGIC, FORMAT, and
// how many bytes there are in all.
enum { FRONT_WORDS = 4 };

// All words but these and the checksum.
static void walk_world(Walk *walk, JpWorld *world)
{
    walk->count = FRONT_WORDS;
    walk_own(walk, world->bodies.count);
    walk_own(walk, count_joints(world));
    walk_own(walk, world->options.stepping);
    walk_number(walk, &world->found.last_step, SIZE, "the step before");
    walk_count(walk, &world->found.flown);
    walk_stats(walk, &world->found.stats);
    walk_pace(walk, &world->pace);
    for (size_t i = 0; i < world->bodies.count; i++) {
        walk_body(walk, &world->bodies.records[i]);
    }
    for (JpJoint *joint = world->joints; joint != NULL; joint = joint->next) {
        walk_joint(walk, joint);
    }
}

static size_t saved_size(JpWorld *world)
{
    Walk walk = {.aim = WALK_COUNT};
    walk_world(&walk, world);
    return WORD * (walk.count + 1);
}

// Of all words but the last: one that is changed always changes it.
static uint64_t checksum(const char *state, size_t size)
{
    uint64_t hash = HASH_START;
    for (size_t at = 0; at + WORD < size; at += WORD) {
        uint64_t word;
        memcpy(&word, state + at, WORD);
        hash = hash_word(hash, word);
    }
    return hash;
}

static WorldPace pace_of(const JpWorld *world)
{
    const Kernel *kernel = world->kernel;
    if (kernel == NULL || kernel->contact_count == 0) {
        return world->pace;
    }
    return (WorldPace){
        .is_set = true,
        .longest_s = {kernel->longest_s[0], kernel->longest_s[1]},
        .duration_before_s = kernel->duration_before_s,
        .stiff_width_s = kernel->stiff_width_s,
    };
}

// Puts back what is found, with a kernel that begins anew.
static void go_on_from_found(JpWorld *world)
{
    WorldResponse none = {0};
    world->found.pause = (CachePause){0};
    found_put_back(world, &none);
}

// What a step that failed has left of a body may be no number, and is of no use.
static void forget_lost_body(BodyRecord *record)
{
    double sum = 0.0;
    for (int k = 0; k < 3; k++) {
        sum += record->last_omega[k] + record->last_alpha[k];
        sum += record->opening[k] + record->opening[k + 3];
    }
    if (!isfinite(sum)) {
        memset(record->last_omega, 0, sizeof record->last_omega);
        memset(record->last_alpha, 0, sizeof record->last_alpha);
        memset(record->opening, 0, sizeof record->opening);
        record->has_last = false;
    }
}

// A contact of which nothing can be expected is as one that has not been looked at yet.
static void forget_lost_contact(KernelContact *contact)
{
    const double *before = contact->mobility_before;
    const double sum = contact->frequency + contact->force_per_speed + contact->first_width_s +
                       before[0] + before[1] + before[2];
    if (!isfinite(sum)) {
        contact->frequency = contact->force_per_speed = contact->first_width_s = 0.0;
        memset(contact->mobility_before, 0, sizeof contact->mobility_before);
    }
}

static void forget_lost(JpWorld *world)
{
    for (size_t i = 0; i < world->bodies.count; i++) {
        forget_lost_body(&world->bodies.records[i]);
    }
    for (JpJoint *joint = world->joints; joint != NULL; joint = joint->next) {
        for (size_t i = 0; i < joint->place_count; i++) {
            forget_lost_contact(&joint->found.places[i].inside[0]);
            forget_lost_contact(&joint->found.places[i].inside[1]);
        }
    }
}

static void write_state(JpWorld *world, char *state, uint64_t size)
{
    forget_lost(world);
    memcpy(state, MAGIC, sizeof MAGIC);
    memcpy(state + sizeof MAGIC, &FORMAT, WORD);
    memcpy(state + sizeof MAGIC + WORD, &size, WORD);
    Walk walk = {.aim = WALK_WRITE, .to = state};
    walk_world(&walk, world);
    const uint64_t sum = checksum(state, size);
    memcpy(state + size - WORD, &sum, WORD);
}

// Fails with a status where a number is none that a world can go on with.
static JpStatus check_numbers(const Walk *walk, JpStatus status, JpError *error)
{
    return walk->name == NULL ? JP_OK
                              : refusal(error, status,
                                        "word %zu of the state, %s, is %g: no world goes on "
                                        "with that",
                                        walk->word, walk->name, walk->value);
}

JpStatus jp_world_save(JpWorld *world, void *state, size_t room, size_t *size, JpError *error)
{
    REFUSAL_TRY(refusal_of_null(world, "the world", error));
    REFUSAL_TRY(refusal_of_null(size, "the size", error));
    REFUSAL_TRY(step_know_bodies(world, error));
    *size = saved_size(world);
    if (state == NULL) {
        return refusal_none(error);
    }
    if (room < *size) {
        return refusal(error, JP_ERROR_ARGUMENT,
                       "the state takes %zu bytes, and there is room for %zu", *size, room);
    }
    found_keep(world);
    world->pace = pace_of(world);
    write_state(world, state, *size);
    // as the world that is resumed does
    go_on_from_found(world);
    Walk walk = {.aim = WALK_CHECK, .from = state};
    walk_world(&walk, world);
    REFUSAL_TRY(check_numbers(&walk, JP_ERROR_WORLD, error));
    return refusal_none(error);
}

// Whether these bytes are whole, and a state that this library has written.
static JpStatus check_front(const char *state, size_t size, JpError *error)
{
    if (size < WORD * (FRONT_WORDS + 1)) {
        return refusal(error, JP_ERROR_ARGUMENT, "the state has %zu bytes, fewer than any", size);
    }
    if (memcmp(state, MAGIC, sizeof MAGIC) != 0) {
        return refusal(error, JP_ERROR_ARGUMENT, "these bytes are not a state that was saved");
    }
    uint64_t format;
    uint64_t written;
    uint64_t sum;
    memcpy(&format, state + sizeof MAGIC, WORD);
    memcpy(&written, state + sizeof MAGIC + WORD, WORD);
    if (format != FORMAT) {
        return refusal(error, JP_ERROR_ARGUMENT,
                       "the state is of format %llu; this version of the library reads format %llu",
                       (unsigned long long)format, (unsigned long long)FORMAT);
    }
    if (written != size) {
        return refusal(error, JP_ERROR_ARGUMENT, "the state has %zu bytes of the %llu saved", size,
                       (unsigned long long)written);
    }
    memcpy(&sum, state + size - WORD, WORD);
    return size % WORD == 0 && sum == checksum(state, size)
               ? JP_OK
               : refusal(error, JP_ERROR_ARGUMENT,
                         "the state is damaged: its checksum is not that of its bytes");
}

static JpStatus check_world(JpWorld *world, const char *state, size_t size, JpError *error)
{
    Walk walk = {.aim = WALK_CHECK, .from = state};
    if (size == saved_size(world)) {
        walk_world(&walk, world);
    }
    if (size != saved_size(world) || walk.is_other) {
        return refusal(error, JP_ERROR_ARGUMENT,
                       "the state is of a world made in another way than this one with %zu bodies "
                       "and %zu joints: with others, in another order, or with another stepping",
                       world->bodies.count, count_joints(world));
    }
    return check_numbers(&walk, JP_ERROR_ARGUMENT, error);
}

JpStatus jp_world_resume(JpWorld *world, const void *state, size_t size, JpError *error)
{
    REFUSAL_TRY(refusal_of_null(world, "the world", error));
    REFUSAL_TRY(refusal_of_null(state, "the state", error));
    REFUSAL_TRY(check_front(state, size, error));
    REFUSAL_TRY(step_know_bodies(world, error));
    REFUSAL_TRY(check_world(world, state, size, error));
    found_keep(world); // what is no part of the state, such as gravity
    Walk walk = {.aim = WALK_READ, .from = state};
    walk_world(&walk, world);
    go_on_from_found(world);
    return refusal_none(error);
}
