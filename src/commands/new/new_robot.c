// Finds how a robot's model is carried by a case.
//
// In the plane where all hinges are parallel and all slides lie across them, or along them: what a
// slide moves out of the plane is fixed, for it does not change the motion in the plane. Three
// joints that let a body move freely in the plane are none. In space there are hinges alone, and
// bodies without a joint.
#include "commands/new/new_robot.h"

#include "base/memory.h"
#include "base/printable.h"

#include <ctype.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

// 1: of directions that were written with six digits or turned by MuJoCo
static const double PARALLEL = 1e-6;

void robot_case_note(RobotCase *of, const char *format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    char *sentence = printable_format(format, arguments);
    va_end(arguments);
    of->notes = memory_grown(of->notes, of->note_count + 1, sizeof *of->notes);
    of->notes[of->note_count++] = sentence;
}

const char *robot_case_body(const RobotCase *of, int body)
{
    return body == ROBOT_GROUND ? "ground" : of->bodies[body];
}

// Names: letters, digits, - and _, each once.

static bool is_taken(CaseName *names, size_t count, const char *name)
{
    bool is_any = strcmp(name, "ground") == 0;
    for (size_t i = 0; i < count; i++) {
        is_any = is_any || strcmp(names[i], name) == 0;
    }
    return is_any;
}

// The name of the one behind so many others, as like its own as can be; else by its own number.
static void make_name(RobotCase *of, const char *what, size_t number, const char *own,
                      CaseName *names, size_t count)
{
    char base[LINKAGE_NAME_SIZE - 8];
    size_t length = 0;
    for (const char *at = own; *at != '\0' && length + 1 < sizeof base; at++) {
        const bool is_kept = isalnum((unsigned char)*at) || *at == '-' || *at == '_';
        base[length++] = is_kept && (unsigned char)*at < 128 ? *at : '-';
    }
    base[length] = '\0';
    if (base[strspn(base, "-_")] == '\0') {
        snprintf(base, sizeof base, "%s-%zu", what, number + 1);
    }
    snprintf(names[count], sizeof *names, "%s", base);
    for (size_t i = 2; is_taken(names, count, names[count]); i++) {
        snprintf(names[count], sizeof *names, "%.*s-%zu", (int)sizeof base - 1, base, i);
    }
    if (own[0] != '\0' && strcmp(own, names[count]) != 0) {
        robot_case_note(of, "the name of %s '%s', which is %s here", what, own, names[count]);
    }
}

static void make_names(RobotCase *of)
{
    const Robot *robot = of->robot;
    of->bodies = memory_zeroed(robot->body_count, sizeof *of->bodies);
    // joints, loops and couplings are all joints of the case
    const size_t all = robot->joint_count + robot->loop_count + robot->coupling_count;
    of->joints = memory_zeroed(all, sizeof *of->joints);
    of->loops = of->joints + robot->joint_count;
    of->couplings = of->loops + robot->loop_count;
    for (size_t i = 0; i < robot->body_count; i++) {
        make_name(of, "body", i, robot->bodies[i].name, of->bodies, i);
    }
    size_t count = 0;
    for (size_t i = 0; i < robot->joint_count; i++) {
        make_name(of, "joint", i, robot->joints[i].name, of->joints, count++);
    }
    for (size_t i = 0; i < robot->loop_count; i++) {
        make_name(of, "loop", i, robot->loops[i].name, of->joints, count++);
    }
    for (size_t i = 0; i < robot->coupling_count; i++) {
        make_name(of, "gear", i, robot->couplings[i].name, of->joints, count++);
    }
}

// The plane.

static bool are_parallel(Vec3 a, Vec3 b)
{
    return vec3_length(vec3_cross(a, b)) < PARALLEL;
}

static bool are_across(Vec3 a, Vec3 b)
{
    return fabs(vec3_dot(a, b)) < PARALLEL;
}

// The direction that hinges have, or one across all slides; false where there is none.
static bool find_normal(const Robot *robot, Vec3 *normal)
{
    Vec3 first = {0.0, 0.0, 0.0};
    bool has_slide = false;
    for (size_t i = 0; i < robot->joint_count; i++) {
        const RobotJoint *joint = &robot->joints[i];
        if (joint->kind == ROBOT_HINGE) {
            *normal = joint->axis;
            return true;
        }
        if (joint->kind != ROBOT_SLIDE) {
            return false;
        }
        const Vec3 across = vec3_cross(first, joint->axis);
        if (has_slide && vec3_length(across) > PARALLEL) {
            *normal = vec3_scale(1.0 / vec3_length(across), across);
            return true;
        }
        first = joint->axis;
        has_slide = true;
    }
    *normal = has_slide ? vec3_normal_to(first) : (Vec3){0.0, 0.0, 1.0};
    return true;
}

static bool is_planar(const Robot *robot, Vec3 normal)
{
    for (size_t i = 0; i < robot->joint_count; i++) {
        const RobotJoint *joint = &robot->joints[i];
        const bool fits = joint->kind == ROBOT_HINGE ? are_parallel(joint->axis, normal)
                          : joint->kind == ROBOT_SLIDE
                              ? are_parallel(joint->axis, normal) || are_across(joint->axis, normal)
                              : false;
        if (!fits) {
            return false;
        }
    }
    return true;
}

// The axes of the plane: y upward in the file's world, or x and y as they are where z is its
// normal; so that the normal points to whoever looks at it.
static void set_plane(RobotCase *of, Vec3 normal)
{
    const Vec3 up = {0.0, 0.0, 1.0};
    of->right = (Vec3){1.0, 0.0, 0.0};
    of->up = (Vec3){0.0, 1.0, 0.0};
    of->normal = up;
    if (!of->is_planar || are_parallel(normal, up)) {
        return;
    }
    const bool is_back = fabs(normal.y) > fabs(normal.x) ? normal.y > 0.0 : normal.x < 0.0;
    of->normal = is_back ? vec3_scale(-1.0, normal) : normal;
    const Vec3 upward = vec3_across(up, of->normal);
    of->up = vec3_scale(1.0 / vec3_length(upward), upward);
    of->right = vec3_cross(of->up, of->normal);
}

// Joints.

// The slides that leave the plane fix what they carry, as far as nothing else moves it.
static void fix_what_leaves(RobotCase *of)
{
    Robot *robot = of->robot;
    bool *moves = memory_zeroed(robot->body_count, sizeof *moves);
    for (size_t i = 0; i < robot->joint_count; i++) {
        const RobotJoint *joint = &robot->joints[i];
        if (of->is_planar && joint->kind == ROBOT_SLIDE && are_parallel(joint->axis, of->normal)) {
            of->fates[i] = ROBOT_FIXED;
            robot_case_note(of, "joint '%s', which slides out of the plane",
                            robot_case_joint(of, joint));
        } else {
            moves[joint->body] = true;
        }
    }
    for (size_t i = 0; i < robot->body_count; i++) {
        const int parent = robot->bodies[i].parent;
        of->held[i] = moves[i] ? (int)i : robot_case_held(of, parent);
    }
    free(moves);
}

// Adds a body to what it is fixed to.
static void take_in(RobotBody *into, const RobotBody *from)
{
    const double mass = into->mass + from->mass;
    const Vec3 apart = vec3_sub(from->centre, into->centre);
    const double reduced = into->mass * from->mass / mass;
    double *to = &into->inertia.row[0].x;
    const double *own = &from->inertia.row[0].x;
    const double arm[3] = {apart.x, apart.y, apart.z};
    for (int i = 0; i < 3; i++) {
        for (int k = 0; k < 3; k++) {
            to[3 * i + k] += own[3 * i + k] - reduced * arm[i] * arm[k];
        }
        to[4 * i] += reduced * vec3_dot(apart, apart);
    }
    into->centre = vec3_add(into->centre, vec3_scale(from->mass / mass, apart));
    into->mass = mass;
}

static void take_in_what_is_fixed(RobotCase *of)
{
    Robot *robot = of->robot;
    for (size_t i = 0; i < robot->body_count; i++) {
        if (of->held[i] != (int)i && of->held[i] != ROBOT_GROUND) {
            take_in(&robot->bodies[of->held[i]], &robot->bodies[i]);
        }
    }
}

static bool is_bare(const RobotJoint *joint)
{
    return !joint->is_limited && joint->stiffness == 0.0 && joint->damping == 0.0 &&
           joint->friction == 0.0 && joint->armature == 0.0;
}

// Whether joints, the first of so many of one body, let it move freely in the plane.
static bool are_free(const RobotJoint *joints, size_t count)
{
    size_t hinges = 0;
    const RobotJoint *slides[3];
    size_t slide_count = 0;
    for (size_t i = 0; i < count && count == 3; i++) {
        hinges += joints[i].kind == ROBOT_HINGE ? 1 : 0;
        if (joints[i].kind == ROBOT_SLIDE) {
            slides[slide_count++] = &joints[i];
        }
    }
    return hinges == 1 && slide_count == 2 && !are_parallel(slides[0]->axis, slides[1]->axis);
}

// The joints of one body that stay, in order.
static size_t joints_of(const RobotCase *of, int body, size_t numbers[], size_t most)
{
    size_t count = 0;
    for (size_t i = 0; i < of->robot->joint_count; i++) {
        if (of->robot->joints[i].body == body && of->fates[i] == ROBOT_STAYS) {
            numbers[count < most ? count : most - 1] = i;
            count++;
        }
    }
    return count;
}

// One joint at most holds a body.
static bool check_body(RobotCase *of, int body, Err *err)
{
    enum { MOST = 4 };
    size_t numbers[MOST];
    RobotJoint own[MOST];
    const size_t count = joints_of(of, body, numbers, MOST);
    const char *name = of->bodies[body];
    for (size_t i = 0; i < count && i < MOST; i++) {
        own[i] = of->robot->joints[numbers[i]];
    }
    const bool is_free = count == 1 ? own[0].kind == ROBOT_FREE
                                    : of->is_planar && count == 3 && are_free(own, count);
    for (size_t i = 0; is_free && i < count; i++) {
        of->fates[numbers[i]] = ROBOT_LOOSE;
        if (!is_bare(&own[i])) {
            robot_case_note(of, "damping, limits and the like of joint '%s', for its body is free",
                            of->joints[numbers[i]]);
        }
    }
    if (is_free) {
        return true;
    }
    if (count > 1) {
        return err_set(
            err, ERR_CASE,
            "body '%s' has %zu joints, and a case has one between two bodies: put a body "
            "between them",
            name, count);
    }
    if (count == 1 && own[0].kind == ROBOT_BALL) {
        return err_set(err, ERR_CASE,
                       "body '%s' has a ball joint, and a case has pivots and sliders alone", name);
    }
    return of->is_planar || count == 0 || own[0].kind == ROBOT_HINGE ||
           err_set(err, ERR_CASE,
                   "body '%s' slides, and its hinges are not all parallel: a case in space has "
                   "pivots alone",
                   name);
}

bool robot_case_make(Robot *robot, RobotCase *of, Err *err)
{
    *of = (RobotCase){.robot = robot,
                      .held = memory_zeroed(robot->body_count, sizeof *of->held),
                      .fates = memory_zeroed(robot->joint_count, sizeof *of->fates)};
    Vec3 normal = {0.0, 0.0, 1.0};
    of->is_planar = find_normal(robot, &normal) && is_planar(robot, normal);
    set_plane(of, normal);
    make_names(of);
    for (size_t i = 0; i < robot->left_out_count; i++) {
        robot_case_note(of, "%s", robot->left_out[i]);
    }
    if (robot->body_count == 0) {
        return err_set(err, ERR_CASE, "nothing moves in the model: none of its bodies has a joint");
    }
    fix_what_leaves(of);
    take_in_what_is_fixed(of);
    bool is_any = false;
    for (size_t i = 0; i < robot->body_count; i++) {
        is_any = is_any || of->held[i] == (int)i;
        if (of->held[i] == (int)i && !check_body(of, (int)i, err)) {
            return false;
        }
    }
    return is_any || err_set(err, ERR_CASE, "nothing moves in a plane of the model");
}

void robot_case_finish(RobotCase *of)
{
    for (size_t i = 0; i < of->note_count; i++) {
        free(of->notes[i]);
    }
    free(of->notes);
    free(of->joints);
    free(of->bodies);
    free(of->fates);
    free(of->held);
    *of = (RobotCase){.note_count = 0};
}
