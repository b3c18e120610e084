// Finds how far the drive can turn a linkage before its loops can no longer be closed.
//
// The positions that the ideal joints allow make a path. Along it the crank turns on, until it has
// to turn back: there the rate of its angle by arc length passes zero, the loops can be closed at
// no angle beyond, and the mechanism locks. Where the rate jumps, two paths cross: that is a change
// point, which can be passed. There the determinant of a group of bodies that follow from the drive
// together changes sign; group by group, so that two that cross at one angle are found as well.
#include "model/lock.h"

#include "base/dense.h"
#include "model/closed_path.h"
#include "model/joint_rows.h"
#include "model/nearest.h"
#include "model/space.h"

#include <stdio.h>
#include <string.h>

enum { WALK_STEPS_MAX = 20000, LOCATE_MAX = 80 };

static const double DETERMINED_PIVOT = 1e-9; // of the largest pivot, as in model/kinematics.c

// turns after which nothing new is to be expected: a linkage comes back to its start in one or two
static const double TURNS_MAX = 8.0;

// rate of the crank at a turning point that is located; its angle is right to the square of that
static const double STANDS = 1e-5;

// how far from the angle of a lock a run fails of it, rad: forces grow without bound before it, and
// play takes the crank beyond
static const double NEAR_LOCK = 10.0 * M_PI / 180.0;

// The linkage with the joints that count, all ideal; for linkage_free.
static Linkage idealised(const Linkage *linkage, LockJoints joints)
{
    Linkage ideal = linkage_copy(linkage);
    ideal.joint_count = 0;
    for (size_t i = 0; i < linkage->joint_count; i++) {
        const Joint *joint = &linkage->joints[i];
        const bool is_ideal = joint_is_ideal(joint->kind);
        if (joint_rows_count(joint->kind) == 0 || (!is_ideal && joints == LOCK_IDEAL_ONLY)) {
            continue;
        }
        if ((int)i == linkage->driver.joint) {
            ideal.driver.joint = (int)ideal.joint_count;
        }
        Joint *kept = &ideal.joints[ideal.joint_count++];
        *kept = *joint;
        kept->kind = joint_without_play(joint->kind);
        kept->clearance = (Clearance){0};
    }
    return ideal;
}

// The rank of the joints' and the driver's rows, with one body held fast or none (-1).
static size_t rank_with(const Linkage *linkage, const Motion *motions, int body)
{
    enum { ROWS = KINEMATICS_ROW_MAX + 3 };
    double rows[ROWS * KINEMATICS_COLUMN_MAX] = {0.0};
    Jacobian jacobian;
    kinematics_jacobian(linkage, motions, NULL, true, &jacobian);
    memcpy(rows, jacobian.entries, jacobian.rows * jacobian.columns * sizeof *rows);
    size_t count = jacobian.rows;
    for (size_t i = 0; body >= 0 && i < 3; i++) {
        rows[count++ * jacobian.columns + 3 * (size_t)body + i] = 1.0;
    }
    return dense_rank(count, jacobian.columns, rows, DETERMINED_PIVOT);
}

// The number that each body has in the part that the driver determines, -1 outside it. Returns how
// many there are.
static size_t number_determined(const Linkage *linkage, const Motion *motions, int *numbers)
{
    const size_t rank = rank_with(linkage, motions, -1);
    size_t count = 0;
    for (int i = 0; i < (int)linkage->body_count; i++) {
        numbers[i] = rank_with(linkage, motions, i) == rank ? (int)count++ : -1;
    }
    return count;
}

// Counts the anchors of a body or the ground from a point of it.
static void move_anchors(Linkage *part, int body, Vec2 origin)
{
    for (size_t i = 0; i < part->joint_count; i++) {
        Joint *joint = &part->joints[i];
        if (joint->body_a == body) {
            joint->anchor_a = vec2_sub(joint->anchor_a, origin);
        }
        if (joint->body_b == body) {
            joint->anchor_b = vec2_sub(joint->anchor_b, origin);
        }
    }
}

// Counts a body's angles and lengths from its first joint, so that it does not matter where its
// frame lies.
static void move_frame(Linkage *part, int body, Motion *motion)
{
    for (size_t i = 0; i < 2 * part->joint_count; i++) {
        const JointEnd end = linkage_end(&part->joints[i / 2], i % 2);
        if (end.body == body) {
            move_anchors(part, body, end.anchor);
            motion->position = vec2_add(motion->position, vec2_rotate(motion->angle, end.anchor));
            return;
        }
    }
}

// Puts the world's origin into the driver's pivot.
static void move_origin(Linkage *part, Motion *motions)
{
    const Vec2 pivot = part->joints[part->driver.joint].anchor_a;
    for (size_t i = 0; i < part->body_count; i++) {
        motions[i].position = vec2_sub(motions[i].position, pivot);
    }
    move_anchors(part, LINKAGE_GROUND, pivot);
}

// Takes out of the linkage what the driver determines, for linkage_free. Returns whether that is
// more than the driven body.
static bool cut_out_part(const Linkage *linkage, const Motion *motions, Linkage *part,
                         Motion *start)
{
    int numbers[KINEMATICS_BODY_MAX];
    *part = linkage_create(
        (LinkageRoom){.bodies = linkage->body_count, .joints = linkage->joint_count});
    part->driver = linkage->driver;
    part->body_count = number_determined(linkage, motions, numbers);
    for (size_t i = 0; i < linkage->body_count; i++) {
        if (numbers[i] >= 0) {
            part->bodies[numbers[i]] = linkage->bodies[i];
            start[numbers[i]] = motions[i];
        }
    }
    for (size_t i = 0; i < linkage->joint_count; i++) {
        Joint joint = linkage->joints[i];
        const bool is_inside = (joint.body_a == LINKAGE_GROUND || numbers[joint.body_a] >= 0) &&
                               (joint.body_b == LINKAGE_GROUND || numbers[joint.body_b] >= 0);
        if (is_inside) {
            joint.body_a = joint.body_a == LINKAGE_GROUND ? LINKAGE_GROUND : numbers[joint.body_a];
            joint.body_b = joint.body_b == LINKAGE_GROUND ? LINKAGE_GROUND : numbers[joint.body_b];
            if ((int)i == linkage->driver.joint) {
                part->driver.joint = (int)part->joint_count;
            }
            part->joints[part->joint_count++] = joint;
        }
    }
    for (int i = 0; i < (int)part->body_count; i++) {
        move_frame(part, i, &start[i]);
    }
    move_origin(part, start);
    return part->body_count > 1;
}

// Halves a step in which the crank turns back, down to where it does. False where its rate jumps
// instead of passing zero: the step went over to another path.
static bool locate(const ClosedPath *path, double length, double *crank_angle)
{
    double low = 0.0;
    double high = length;
    ClosedPath middle = *path;
    for (int i = 0; i < LOCATE_MAX; i++) {
        const double at = 0.5 * (low + high);
        if (!closed_path_step(path, at, &middle)) {
            return false;
        }
        const double rate = closed_path_crank_rate(&middle);
        if (fabs(rate) <= STANDS) {
            *crank_angle = closed_path_crank(&middle);
            return true;
        }
        *(rate > 0.0 ? &low : &high) = at;
    }
    return false;
}

// One step along the path of about a length. Next to a crossing, where nothing shorter is found
// either, it leaps over. Returns its length, or 0 where none is possible.
static double find_next(const ClosedPath *path, double length, ClosedPath *next)
{
    static const double TRIED[] = {1.0, 0.5, 0.25, 2.0, 4.0, 8.0, 0.1, 0.01, 1e-3};
    for (size_t i = 0; i < sizeof TRIED / sizeof *TRIED; i++) {
        if (closed_path_step(path, TRIED[i] * length, next)) {
            return TRIED[i] * length;
        }
    }
    return 0.0;
}

// What a step along the path shows.
typedef enum Passage {
    PASSAGE_OPEN,    // the crank goes on turning
    PASSAGE_LOCKED,  // it has to turn back
    PASSAGE_UNKNOWN, // no next position is found
} Passage;

// Goes on by one step, or to where the crank has to turn back.
static Passage pass(ClosedPath *path, double *crank_angle)
{
    double length = closed_path_reach(path);
    for (int i = 0; i < LOCATE_MAX; i++) {
        ClosedPath next;
        length = find_next(path, length, &next);
        if (length == 0.0) {
            return PASSAGE_UNKNOWN;
        }
        if (closed_path_crank_rate(&next) > 0.0) {
            *path = next;
            *crank_angle = closed_path_crank(path);
            return PASSAGE_OPEN;
        }
        if (locate(path, length, crank_angle)) {
            return PASSAGE_LOCKED;
        }
        length *= 0.5; // it went over to another path
    }
    return PASSAGE_UNKNOWN;
}

// The determinants of the groups at a position of the crank.
typedef struct Signs {
    double crank_angle;
    double determinants[KINEMATICS_BODY_MAX / 2];
} Signs;

static Signs find_signs(const ClosedPath *path, const Groups *groups)
{
    Signs signs = {.crank_angle = closed_path_crank(path)};
    for (size_t i = 0; i < groups->count; i++) {
        signs.determinants[i] = closed_path_determinant(path, &groups->groups[i]);
    }
    return signs;
}

// Notes the first change point between two positions: a determinant is almost straight there.
static void note_crossing(const Signs *before, const Signs *after, size_t count, Lock *lock)
{
    double least = 1.0; // share of the way
    for (size_t i = 0; i < count; i++) {
        const double first = before->determinants[i];
        const double last = after->determinants[i];
        if (first * last < 0.0 && first / (first - last) <= least) {
            least = first / (first - last);
            lock->crossing =
                before->crank_angle + (after->crank_angle - before->crank_angle) * least;
            lock->has_crossing = true;
        }
    }
}

static Lock walk(ClosedPath *path, double turn)
{
    const double start = closed_path_crank(path);
    Lock lock = {LOCK_NONE, start, false, start};
    Groups groups;
    groups_find(path->linkage, &groups);
    Signs before = find_signs(path, &groups);
    for (int i = 0; i < WALK_STEPS_MAX && fabs(lock.crank_angle - start) < turn; i++) {
        const Passage passage = pass(path, &lock.crank_angle);
        if (passage == PASSAGE_OPEN && !lock.has_crossing) {
            const Signs after = find_signs(path, &groups);
            note_crossing(&before, &after, groups.count, &lock);
            before = after;
        }
        if (passage != PASSAGE_OPEN) {
            const bool is_inside = fabs(lock.crank_angle - start) <= turn;
            lock.state = passage == PASSAGE_UNKNOWN ? LOCK_UNKNOWN
                         : is_inside                ? LOCK_FOUND
                                                    : LOCK_NONE;
            return lock;
        }
    }
    lock.state = fabs(lock.crank_angle - start) >= turn ? LOCK_NONE : LOCK_UNKNOWN;
    return lock;
}

Lock lock_find(const Linkage *linkage, LockJoints joints, double turn)
{
    const double start_angle = linkage->driver.start;
    const Lock unknown = {LOCK_UNKNOWN, start_angle, false, start_angle};
    if (!linkage->driver.is_present || linkage->further_count > 0 || !space_has_plane(linkage) ||
        !kinematics_is_small(linkage)) {
        return unknown;
    }
    Linkage ideal = idealised(linkage, joints);
    Motion motions[KINEMATICS_BODY_MAX];
    Motion start[KINEMATICS_BODY_MAX];
    Linkage part = {.body_count = 0};
    ClosedPath path;
    linkage_start(&ideal, motions);
    const bool is_open = nearest_positions(&ideal, motions) &&
                         cut_out_part(&ideal, motions, &part, start) &&
                         closed_path_start(&part, start, &path);
    const Lock lock = is_open ? walk(&path, fmin(turn, TURNS_MAX * 2.0 * M_PI)) : unknown;
    linkage_free(&part);
    linkage_free(&ideal);
    return lock;
}

Lock lock_find_between(const Linkage *linkage, LockJoints joints, DriveExtent extent)
{
    Linkage one_way = *linkage;
    one_way.driver.table.count = 0;
    one_way.driver.speed = -fabs(linkage->driver.speed);
    Lock back = {.state = LOCK_NONE};
    if (extent.back < 0.0) {
        back = lock_find(&one_way, joints, -extent.back);
    }
    if (back.state == LOCK_FOUND || !(extent.forth > 0.0)) {
        return back;
    }
    one_way.driver.speed = fabs(linkage->driver.speed);
    const Lock forth = lock_find(&one_way, joints, extent.forth);
    return forth.state != LOCK_FOUND && back.has_crossing ? back : forth;
}

Lock lock_met(const Scenario *scenario, double time_s)
{
    const Linkage *linkage = &scenario->linkage;
    if (linkage->driver.table.count == 0) {
        const double turned = fabs(linkage->driver.speed) * time_s + NEAR_LOCK;
        return lock_find(linkage, LOCK_ALL_AS_IDEAL, turned);
    }
    DriveExtent extent = drive_extent(&linkage->driver, time_s);
    extent.back -= NEAR_LOCK;
    extent.forth += NEAR_LOCK;
    return lock_find_between(linkage, LOCK_ALL_AS_IDEAL, extent);
}

void lock_explain(const Scenario *scenario, double time_s, Err *err)
{
    if (err->kind != ERR_SOLVER) {
        return;
    }
    const Lock lock = lock_met(scenario, time_s);
    const size_t length = strlen(err->text);
    if (lock.state == LOCK_FOUND) {
        snprintf(err->text + length, sizeof err->text - length,
                 "; with ideal joints the mechanism locks at a crank angle of %.6g deg: the drive "
                 "cannot turn further; run fewer revolutions or change the lengths",
                 lock.crank_angle * 180.0 / M_PI);
    }
}
