// A world's state as bytes: what a step leaves behind for the next one, and nothing else.
//
// A head, then each body in the order in which the world knows them, then each joint. Numbers stand
// as they are in memory: they are for the same library on the same machine, and come back exactly.
#include "world/found.h"
#include "world/play.h"
#include "world/step.h"

#include <stdlib.h>
#include <string.h>

static const char MAGIC[16] = "jointplay world";

typedef struct SavedHead {
    char magic[sizeof MAGIC];
    size_t size; // of all
    size_t body_count;
    size_t joint_count;
    JpStepping stepping;
    double last_step;
    JpWorldStats stats;
    WorldPace pace;
} SavedHead;

typedef struct SavedBody {
    BodyMoment moment;
    dVector3 last_omega;
    dVector3 last_alpha;
    bool has_last;
    double opening[6];
} SavedBody;

typedef struct SavedJoint {
    PlayKind kind;
    size_t place_count;
    JointFound carried;
} SavedJoint;

static size_t count_joints(const JpWorld *world)
{
    size_t count = 0;
    for (const JpJoint *joint = world->joints; joint != NULL; joint = joint->next) {
        count++;
    }
    return count;
}

static size_t saved_size(size_t bodies, size_t joints)
{
    return sizeof(SavedHead) + bodies * sizeof(SavedBody) + joints * sizeof(SavedJoint);
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

// Writes the world behind the head. What is found there is that of a step that would begin now.
static void write_world(JpWorld *world, char *at)
{
    for (size_t i = 0; i < world->bodies.count; i++) {
        const BodyRecord *record = &world->bodies.records[i];
        SavedBody saved;
        memset(&saved, 0, sizeof saved); // its gaps, too
        saved.moment = record->found;
        memcpy(saved.last_omega, record->last_omega, sizeof saved.last_omega);
        memcpy(saved.last_alpha, record->last_alpha, sizeof saved.last_alpha);
        saved.has_last = record->has_last;
        memcpy(saved.opening, record->opening, sizeof saved.opening);
        memcpy(at, &saved, sizeof saved);
        at += sizeof saved;
    }
    for (const JpJoint *joint = world->joints; joint != NULL; joint = joint->next) {
        SavedJoint saved;
        memset(&saved, 0, sizeof saved);
        saved.kind = joint->kind;
        saved.place_count = joint->place_count;
        saved.carried = joint->found;
        memcpy(at, &saved, sizeof saved);
        at += sizeof saved;
    }
}

// What a joint carries, as if a step had found it so. The laws and where sides are stay its own.
static void find_joint(const JointFound *carried, JpJoint *joint)
{
    joint->found = *carried;
    for (size_t i = 0; i < joint->place_count; i++) {
        for (size_t k = 0; k < SIDE_COUNT; k++) {
            const Side *own = &joint->places[i].sides[k];
            Side *found = &joint->found.places[i].sides[k];
            found->law = own->law;
            found->sign = own->sign;
            found->limit = own->limit;
        }
    }
}

static void find_body(const SavedBody *saved, BodyRecord *record)
{
    record->found = saved->moment;
    memcpy(record->last_omega, saved->last_omega, sizeof record->last_omega);
    memcpy(record->last_alpha, saved->last_alpha, sizeof record->last_alpha);
    record->has_last = saved->has_last;
    memcpy(record->opening, saved->opening, sizeof record->opening);
}

// Puts back what is found, with a kernel that begins at a pace.
static void go_on_from_found(JpWorld *world, WorldPace pace)
{
    WorldResponse none = {0};
    world->found.pause = (CachePause){0};
    found_put_back(world, &none);
    world->pace = pace;
}

JpStatus jp_world_save(JpWorld *world, void *state, size_t room, size_t *size, JpError *error)
{
    REFUSAL_TRY(refusal_of_null(world, "the world", error));
    REFUSAL_TRY(refusal_of_null(size, "the size", error));
    REFUSAL_TRY(step_know_bodies(world, error));
    *size = saved_size(world->bodies.count, count_joints(world));
    if (state == NULL) {
        return refusal_none(error);
    }
    if (room < *size) {
        return refusal(error, JP_ERROR_ARGUMENT,
                       "the state takes %zu bytes, and there is room for %zu", *size, room);
    }
    found_keep(world);
    SavedHead head;
    memset(&head, 0, sizeof head);
    memcpy(head.magic, MAGIC, sizeof MAGIC);
    head.size = *size;
    head.body_count = world->bodies.count;
    head.joint_count = count_joints(world);
    head.stepping = world->options.stepping;
    head.last_step = world->last_step;
    head.stats = world->stats;
    head.pace = pace_of(world);
    memcpy(state, &head, sizeof head);
    write_world(world, (char *)state + sizeof head);
    // as the world that is resumed does
    go_on_from_found(world, head.pace);
    return refusal_none(error);
}

// Whether the joints are of the same kinds, with as many places.
static bool has_joints(const JpWorld *world, const char *at)
{
    for (const JpJoint *joint = world->joints; joint != NULL; joint = joint->next) {
        SavedJoint saved;
        memcpy(&saved, at, sizeof saved);
        if (saved.kind != joint->kind || saved.place_count != joint->place_count) {
            return false;
        }
        at += sizeof saved;
    }
    return true;
}

static void resume_world(JpWorld *world, const SavedHead *head, const char *bodies,
                         const char *joints)
{
    found_keep(world); // what is no part of the state, such as gravity
    world->found.last_step = head->last_step;
    world->found.stats = head->stats;
    for (size_t i = 0; i < head->body_count; i++) {
        SavedBody saved;
        memcpy(&saved, bodies + i * sizeof saved, sizeof saved);
        find_body(&saved, &world->bodies.records[i]);
    }
    for (JpJoint *joint = world->joints; joint != NULL; joint = joint->next) {
        SavedJoint saved;
        memcpy(&saved, joints, sizeof saved);
        find_joint(&saved.carried, joint);
        joints += sizeof saved;
    }
    go_on_from_found(world, head->pace);
}

JpStatus jp_world_resume(JpWorld *world, const void *state, size_t size, JpError *error)
{
    REFUSAL_TRY(refusal_of_null(world, "the world", error));
    REFUSAL_TRY(refusal_of_null(state, "the state", error));
    REFUSAL_TRY(step_know_bodies(world, error));
    SavedHead head;
    if (size < sizeof head) {
        return refusal(error, JP_ERROR_ARGUMENT, "the state has %zu bytes, fewer than any", size);
    }
    memcpy(&head, state, sizeof head);
    if (memcmp(head.magic, MAGIC, sizeof MAGIC) != 0 || head.size != size) {
        return refusal(error, JP_ERROR_ARGUMENT, "these bytes are not a state that was saved");
    }
    const size_t joints = count_joints(world);
    const char *bodies = (const char *)state + sizeof head;
    const char *behind = bodies + head.body_count * sizeof(SavedBody);
    if (head.body_count != world->bodies.count || head.joint_count != joints ||
        size != saved_size(head.body_count, head.joint_count) ||
        head.stepping != world->options.stepping || !has_joints(world, behind)) {
        return refusal(
            error, JP_ERROR_ARGUMENT,
            "the state is of a world with %zu bodies and %zu joints, made in another way "
            "than this one with %zu and %zu",
            head.body_count, head.joint_count, world->bodies.count, joints);
    }
    resume_world(world, &head, bodies, behind);
    return refusal_none(error);
}
