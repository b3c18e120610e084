// Which mechanisms of a linkage share nothing but the ground?
//
// Those whose bodies no joint and no spring connects, not by way of the driven body either.
#include "model/members.h"

#include "base/leaders.h"
#include "base/zeroed.h"

// The first body of those that a body is known to be connected with.
static void connect(size_t *leaders, int a, int b)
{
    if (a != LINKAGE_GROUND && b != LINKAGE_GROUND) {
        leaders_join(leaders, (size_t)a, (size_t)b);
    }
}

// Numbers the mechanisms: by body which one it belongs to. Returns how many there are.
static size_t number_members(const Linkage *linkage, size_t *member_of)
{
    size_t *leaders = zeroed(linkage->body_count, sizeof *leaders);
    size_t count = 0;
    leaders_start(leaders, linkage->body_count);
    for (size_t i = 0; i < linkage->joint_count; i++) {
        connect(leaders, linkage->joints[i].body_a, linkage->joints[i].body_b);
    }
    for (size_t i = 0; i < linkage->spring_count; i++) {
        connect(leaders, linkage->springs[i].body_a, linkage->springs[i].body_b);
    }
    for (size_t i = 0; i < linkage->body_count; i++) {
        const size_t leader = leaders_find(leaders, i);
        member_of[i] = leader == i ? count++ : member_of[leader];
    }
    free(leaders);
    return count;
}

static size_t member_of_pair(const size_t *member_of, int a, int b)
{
    return member_of[a != LINKAGE_GROUND ? a : b];
}

static int renumber(const int *own, int body)
{
    return body == LINKAGE_GROUND ? LINKAGE_GROUND : own[body];
}

// Gives a member's gears the numbers that their carriers and pivots have there.
static void renumber_gears(const int *own_body, const int *own_joint, Linkage *linkage)
{
    for (size_t i = 0; i < linkage->joint_count; i++) {
        Gear *gear = &linkage->joints[i].gear;
        if (linkage->joints[i].kind == JOINT_GEAR) {
            gear->carrier = renumber(own_body, gear->carrier);
            gear->pivots[0] = own_joint[gear->pivots[0]];
            gear->pivots[1] = own_joint[gear->pivots[1]];
        }
    }
}

// What the linkage has more than bodies: by member, then with their numbers there.
static void share_out(const Linkage *whole, const size_t *member_of, Member *members, size_t count)
{
    int *own_body = zeroed(whole->body_count, sizeof *own_body);
    int *own_joint = zeroed(whole->joint_count, sizeof *own_joint);
    for (size_t i = 0; i < whole->body_count; i++) {
        Member *member = &members[member_of[i]];
        Linkage *linkage = &member->scenario->linkage;
        own_body[i] = (int)linkage->body_count;
        member->bodies[linkage->body_count] = (int)i;
        linkage->bodies[linkage->body_count++] = whole->bodies[i];
    }
    for (size_t i = 0; i < whole->joint_count; i++) {
        Joint joint = whole->joints[i];
        Member *member = &members[member_of_pair(member_of, joint.body_a, joint.body_b)];
        Linkage *linkage = &member->scenario->linkage;
        joint.body_a = renumber(own_body, joint.body_a);
        joint.body_b = renumber(own_body, joint.body_b);
        own_joint[i] = (int)linkage->joint_count;
        member->joints[linkage->joint_count] = (int)i;
        linkage->joints[linkage->joint_count++] = joint;
        if (whole->driver.is_present && whole->driver.joint == (int)i) {
            linkage->driver = whole->driver;
            linkage->driver.joint = own_joint[i];
        }
        if (whole->torque.table.count > 0 && whole->torque.joint == (int)i) {
            linkage->torque = whole->torque;
            linkage->torque.joint = own_joint[i];
        }
    }
    for (size_t i = 0; i < whole->spring_count; i++) {
        Spring spring = whole->springs[i];
        const size_t number = member_of_pair(member_of, spring.body_a, spring.body_b);
        Linkage *linkage = &members[number].scenario->linkage;
        spring.body_a = renumber(own_body, spring.body_a);
        spring.body_b = renumber(own_body, spring.body_b);
        linkage->springs[linkage->spring_count++] = spring;
    }
    for (size_t i = 0; i < whole->torsion_count; i++) {
        TorsionSpring torsion = whole->torsions[i];
        const Joint *joint = &whole->joints[torsion.joint];
        const size_t number = member_of_pair(member_of, joint->body_a, joint->body_b);
        Linkage *linkage = &members[number].scenario->linkage;
        torsion.joint = own_joint[torsion.joint];
        linkage->torsions[linkage->torsion_count++] = torsion;
    }
    for (size_t i = 0; i < count; i++) {
        renumber_gears(own_body, own_joint, &members[i].scenario->linkage);
    }
    free(own_body);
    free(own_joint);
}

// Counts what each member has.
static LinkageRoom *count_rooms(const Linkage *whole, const size_t *member_of, size_t count)
{
    LinkageRoom *rooms = zeroed(count, sizeof *rooms);
    for (size_t i = 0; i < whole->body_count; i++) {
        rooms[member_of[i]].bodies++;
    }
    for (size_t i = 0; i < whole->joint_count; i++) {
        const Joint *joint = &whole->joints[i];
        rooms[member_of_pair(member_of, joint->body_a, joint->body_b)].joints++;
    }
    for (size_t i = 0; i < whole->spring_count; i++) {
        const Spring *spring = &whole->springs[i];
        rooms[member_of_pair(member_of, spring->body_a, spring->body_b)].springs++;
    }
    for (size_t i = 0; i < whole->torsion_count; i++) {
        const Joint *joint = &whole->joints[whole->torsions[i].joint];
        rooms[member_of_pair(member_of, joint->body_a, joint->body_b)].torsions++;
    }
    return rooms;
}

size_t members_count(const Linkage *linkage)
{
    size_t *member_of = zeroed(linkage->body_count, sizeof *member_of);
    const size_t count = number_members(linkage, member_of);
    free(member_of);
    return count;
}

Member *members_make(const Scenario *scenario, size_t *count)
{
    const Linkage *whole = &scenario->linkage;
    size_t *member_of = zeroed(whole->body_count, sizeof *member_of);
    *count = number_members(whole, member_of);
    Member *members = zeroed(*count, sizeof *members);
    LinkageRoom *rooms = count_rooms(whole, member_of, *count);
    for (size_t i = 0; i < *count; i++) {
        Member *member = &members[i];
        member->scenario = zeroed(1, sizeof *member->scenario);
        *member->scenario = scenario_around(scenario, linkage_create(rooms[i]));
        member->scenario->linkage.is_spatial = whole->is_spatial;
        // one without the driver has no revolutions
        member->scenario->run.duration = scenario_duration(scenario);
        member->bodies = zeroed(rooms[i].bodies, sizeof *member->bodies);
        member->joints = zeroed(rooms[i].joints, sizeof *member->joints);
    }
    share_out(whole, member_of, members, *count);
    for (size_t i = 0; i < *count; i++) {
        Member *member = &members[i];
        const Linkage *linkage = &member->scenario->linkage;
        member->sample = sample_create(linkage);
        member->part = (SolverPart){.number = i,
                                    .body_count = linkage->body_count,
                                    .joint_count = linkage->joint_count,
                                    .bodies = member->bodies,
                                    .joints = member->joints};
    }
    free(rooms);
    free(member_of);
    return members;
}

void members_free(Member *members, size_t count, const Solver *solver)
{
    for (size_t i = 0; i < count; i++) {
        if (members[i].state != NULL) {
            solver->close(members[i].state);
        }
        scenario_destroy(members[i].scenario);
        sample_free(&members[i].sample);
        free(members[i].bodies);
        free(members[i].joints);
    }
    free(members);
}

void member_show_bodies(const Member *member, Sample *sample)
{
    const bool is_spatial = member->scenario->linkage.is_spatial;
    for (size_t k = 0; k < member->part.body_count; k++) {
        const int body = member->bodies[k];
        sample->bodies[body] = member->sample.bodies[k];
        if (is_spatial) {
            sample->space_bodies[body] = member->sample.space_bodies[k];
        }
    }
}

void member_show(const Member *member, Sample *sample)
{
    const bool is_spatial = member->scenario->linkage.is_spatial;
    member_show_bodies(member, sample);
    for (size_t k = 0; k < member->part.joint_count; k++) {
        const int joint = member->joints[k];
        sample->joints[joint] = member->sample.joints[k];
        if (is_spatial) {
            sample->space_joints[joint] = member->sample.space_joints[k];
        }
    }
}
