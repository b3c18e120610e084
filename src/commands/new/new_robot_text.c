// Writes a robot as a commented case.
//
// A coordinate q of a joint is s phi, s = -1 where its axis points away from whoever looks at the
// plane. Springs of joints and servos at control 0 act together: K = sum k, relaxed where
// K q = sum k q_i. A spring along a slide is one between two points on its line, far apart. An
// armature a at a hinge with the ground is inertia of the body, a about the axis u: I + a u u'. Of
// a pair of gears the teeth are as hard as a resonance far above the motion says: k = m w^2, m = 1
// / (r_a^2/I_a + r_b^2/I_b).
#include "base/memory.h"
#include "base/printable.h"
#include "commands/new/new_robot.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

// m: what is less is a rounding of a place
static const double PLACE_LEAST = 1e-13;

// m: places of pins that are nearer to each other are one, which only roundings keep apart
static const double PLACE_ALIKE = 1e-9;

// m: of the spring that stands for one along a slide
static const double SLIDE_SPRING = 10.0;

// rad/s, and 1: of gears on their teeth, and their damping ratio
static const double TEETH_FREQUENCY = 2.0e4;
static const double TEETH_DAMPING = 0.5;

// 1: of the hinges in a loop
static const double LOOP_PARALLEL = 1e-6;

// 1: by which a ratio of teeth may miss the model's, and teeth up to which one is looked for
static const double RATIO_OFF = 1e-9;
enum { TEETH_MOST = 2000 };

// A number with its unit, 0 without a sign.
static void put(Text *text, double value, const char *unit)
{
    text_append(text, "%.15g %s", value + 0.0, unit);
}

static double clean(double place)
{
    return fabs(place) < PLACE_LEAST ? 0.0 : place;
}

static void put_place(const RobotCase *of, Vec3 place, Text *text)
{
    text_append(text, "[%.15g m, %.15g m]", clean(vec3_dot(place, of->right)),
                clean(vec3_dot(place, of->up)));
    if (!of->is_planar) {
        text_append(text, ", offset: %.15g m", clean(vec3_dot(place, of->normal)));
    }
}

static int parent_of(const RobotCase *of, const RobotJoint *joint)
{
    return robot_case_held(of, of->robot->bodies[joint->body].parent);
}

// Bodies.

// What armatures of a hinge with the ground add to its inertia; of others they are left out.
static void add_armature(RobotCase *of, const RobotJoint *joint, Mat3 *inertia)
{
    if (joint->kind != ROBOT_HINGE || parent_of(of, joint) != ROBOT_GROUND) {
        robot_case_note(of,
                        "the armature of joint '%s', %.6g %s, where what it moves has %.6g by "
                        "itself: only that of a hinge with the ground is carried",
                        robot_case_joint(of, joint), joint->armature,
                        joint->kind == ROBOT_HINGE ? "kg m^2" : "kg",
                        joint->kind == ROBOT_HINGE
                            ? vec3_dot(joint->axis, mat3_apply(inertia, joint->axis))
                            : of->robot->bodies[joint->body].mass);
        return;
    }
    inertia->row[0].x += joint->armature;
    inertia->row[1].y += joint->armature;
    inertia->row[2].z += joint->armature;
}

static void write_body(RobotCase *of, size_t number, Text *text)
{
    const RobotBody *body = &of->robot->bodies[number];
    Mat3 inertia = body->inertia;
    for (size_t i = 0; i < of->robot->joint_count; i++) {
        const RobotJoint *joint = &of->robot->joints[i];
        if (joint->body == (int)number && of->fates[i] == ROBOT_STAYS && joint->armature > 0.0) {
            add_armature(of, joint, &inertia);
        }
    }
    text_append(text, "  %s: {mass: %.15g kg, inertia: %.15g kg m^2, at: ", of->bodies[number],
                body->mass, vec3_dot(of->normal, mat3_apply(&inertia, of->normal)));
    put_place(of, body->centre, text);
    if (!of->is_planar) {
        text_append(text,
                    ",\n    inertia-x: %.15g kg m^2, inertia-y: %.15g kg m^2, product-xy: %.15g kg "
                    "m^2,\n    product-xz: %.15g kg m^2, product-yz: %.15g kg m^2",
                    inertia.row[0].x, inertia.row[1].y, 0.0 - inertia.row[0].y,
                    0.0 - inertia.row[0].z, 0.0 - inertia.row[1].z);
    }
    text_append(text, "}\n");
}

// Joints.

// Limits, which begin on their own side of the start.
static void write_limits(RobotCase *of, const RobotJoint *joint, double sign, Text *text)
{
    if (!joint->is_limited) {
        return;
    }
    const double *range = joint->range;
    if (!(range[0] <= 0.0 && range[1] >= 0.0 && range[0] < range[1])) {
        robot_case_note(of, "the limits of joint '%s', beyond which it starts",
                        robot_case_joint(of, joint));
        return;
    }
    const bool is_turn = joint->kind == ROBOT_HINGE;
    text_append(text, ",\n    low: ");
    put(text, sign > 0.0 ? range[0] : -range[1], is_turn ? "rad" : "m");
    text_append(text, ", high: ");
    put(text, sign > 0.0 ? range[1] : -range[0], is_turn ? "rad" : "m");
    text_append(text, ", stiffness: %.6g %s, viscous-coefficient: %.6g %s", joint->limit_stiffness,
                is_turn ? "N m/rad" : "N/m", joint->limit_damping, is_turn ? "N m s/rad" : "N s/m");
}

// Of a hinge in space, along +z where it is along z.
static double write_axis(const RobotJoint *joint, Text *text)
{
    Vec3 axis = joint->axis;
    const bool is_down = axis.z < 0.0 && hypot(axis.x, axis.y) < 1e-12;
    axis = is_down ? vec3_scale(-1.0, axis) : axis;
    text_append(text, ", axis: [%.15g, %.15g, %.15g]", clean(axis.x), clean(axis.y), clean(axis.z));
    return is_down ? -1.0 : 1.0;
}

// A place, or that of the first hinge which is there but for roundings.
static Vec3 alike(const RobotCase *of, Vec3 place)
{
    for (size_t i = 0; i < of->robot->joint_count; i++) {
        const RobotJoint *joint = &of->robot->joints[i];
        if (of->fates[i] == ROBOT_STAYS && joint->kind == ROBOT_HINGE &&
            vec3_length(vec3_sub(joint->place, place)) < PLACE_ALIKE) {
            return joint->place;
        }
    }
    return place;
}

// The place of a joint. A slide's may be anywhere on its body: where a pin of that is, which then
// is at no distance from it that only roundings make.
static Vec3 place_of(const RobotCase *of, const RobotJoint *joint)
{
    const Robot *robot = of->robot;
    if (joint->kind != ROBOT_SLIDE) {
        return alike(of, joint->place);
    }
    for (size_t i = 0; i < robot->loop_count; i++) {
        for (int side = 0; side < 2; side++) {
            if (robot_case_held(of, robot->loops[i].bodies[side]) == joint->body) {
                return alike(of, robot->loops[i].place);
            }
        }
    }
    for (size_t i = 0; i < robot->joint_count; i++) {
        if (of->fates[i] == ROBOT_STAYS && robot->joints[i].kind == ROBOT_HINGE &&
            parent_of(of, &robot->joints[i]) == joint->body) {
            return alike(of, robot->joints[i].place);
        }
    }
    return joint->place;
}

static void write_joint(RobotCase *of, size_t number, Text *text)
{
    const RobotJoint *joint = &of->robot->joints[number];
    double sign = joint->kind == ROBOT_HINGE ? robot_case_sign(of, joint) : 1.0;
    text_append(text, "  %s: {between: [%s, %s], at: ", of->joints[number],
                robot_case_body(of, parent_of(of, joint)), robot_case_body(of, joint->body));
    put_place(of, place_of(of, joint), text);
    if (joint->kind == ROBOT_SLIDE) {
        text_append(
            text, ", along: %.15g rad",
            atan2(clean(vec3_dot(joint->axis, of->up)), clean(vec3_dot(joint->axis, of->right))));
    } else if (!of->is_planar) {
        sign = write_axis(joint, text);
    }
    write_limits(of, joint, sign, text);
    if (joint->friction > 0.0 && of->is_planar) {
        text_append(text, ",\n    friction-law: stick, %s: %.15g %s",
                    joint->kind == ROBOT_HINGE ? "friction-torque" : "friction-force",
                    joint->friction, joint->kind == ROBOT_HINGE ? "N m" : "N");
    } else if (joint->friction > 0.0) {
        robot_case_note(of, "the friction of joint '%s': in space ideal joints have none",
                        robot_case_joint(of, joint));
    }
    text_append(text, "}\n");
}

// The joint that stays and carries a body; NULL: none.
static const RobotJoint *carrier_of(const RobotCase *of, int body)
{
    for (size_t i = 0; i < of->robot->joint_count; i++) {
        if (of->robot->joints[i].body == body && of->fates[i] == ROBOT_STAYS) {
            return &of->robot->joints[i];
        }
    }
    return NULL;
}

// Whether a body is another, or is carried by it.
static bool is_below(const RobotCase *of, int body, int other)
{
    while (body != other && body != ROBOT_GROUND) {
        body = robot_case_held(of, of->robot->bodies[body].parent);
    }
    return body == other;
}

// Whether all hinges from a body to what carries both of them have a direction, which is found
// where there is none yet.
static bool have_axis(const RobotCase *of, int body, int other, Vec3 *axis, bool *is_found)
{
    while (!is_below(of, other, body)) {
        const RobotJoint *joint = carrier_of(of, body);
        if (joint == NULL ||
            (*is_found && vec3_length(vec3_cross(*axis, joint->axis)) > LOOP_PARALLEL)) {
            return false;
        }
        *axis = joint->axis;
        *is_found = true;
        body = parent_of(of, joint);
    }
    return true;
}

static const char PLAY[] = "    # play in this pin, where the signs of comment are taken away:\n"
                           "    # hole: 10.05 mm\n"
                           "    # pin: 10 mm\n"
                           "    # width: 10 mm\n";

static bool write_loop(RobotCase *of, size_t number, Text *text)
{
    const RobotLoop *loop = &of->robot->loops[number];
    const int bodies[2] = {robot_case_held(of, loop->bodies[0]),
                           robot_case_held(of, loop->bodies[1])};
    RobotJoint hinge = {.axis = of->normal};
    bool is_found = false;
    if (bodies[0] == bodies[1]) {
        robot_case_note(of, "the loop '%s', which holds what is fixed", of->loops[number]);
        return false;
    }
    if (!of->is_planar && !(have_axis(of, bodies[0], bodies[1], &hinge.axis, &is_found) &&
                            have_axis(of, bodies[1], bodies[0], &hinge.axis, &is_found))) {
        robot_case_note(of, "the loop '%s', a ball joint: the hinges in it are not parallel",
                        of->loops[number]);
        return false;
    }
    text_append(text, "  %s:\n    between: [%s, %s]\n    at: ", of->loops[number],
                robot_case_body(of, bodies[0]), robot_case_body(of, bodies[1]));
    Text place;
    text_init(&place);
    put_place(of, alike(of, loop->place), &place);
    if (!of->is_planar) {
        write_axis(&hinge, &place);
    }
    // one key a line
    for (const char *at = place.data; *at != '\0'; at++) {
        const bool is_next = strncmp(at, ", offset", 8) == 0 || strncmp(at, ", axis", 6) == 0;
        text_append(text, is_next ? "\n    " : "%c", *at);
        at += is_next ? 1 : 0;
    }
    text_finish(&place);
    text_append(text, "\n%s", PLAY);
    return true;
}

// Gears.

// Teeth whose ratio is a number; false where there are none so few.
static bool find_teeth(double ratio, int teeth[2])
{
    for (int i = 1; i <= TEETH_MOST; i++) {
        const double other = round(ratio * i);
        if (other >= 1.0 && other <= TEETH_MOST && fabs(other / i - ratio) <= RATIO_OFF * ratio) {
            teeth[0] = i;
            teeth[1] = (int)other;
            return true;
        }
    }
    return false;
}

static const char *coupling_lacks(const RobotCase *of, const RobotCoupling *coupling)
{
    const RobotJoint *first = &of->robot->joints[coupling->joints[0]];
    const RobotJoint *second = &of->robot->joints[coupling->joints[1]];
    if (!of->is_planar) {
        return "in space";
    }
    if (!coupling->is_straight) {
        return "with an offset or a curve";
    }
    if (first->kind != ROBOT_HINGE || second->kind != ROBOT_HINGE) {
        return "not of two hinges";
    }
    if (of->fates[coupling->joints[0]] != ROBOT_STAYS ||
        of->fates[coupling->joints[1]] != ROBOT_STAYS) {
        return "of a joint that is none here";
    }
    return parent_of(of, first) != parent_of(of, second) ? "of joints on two bodies" : NULL;
}

static void write_coupling(RobotCase *of, size_t number, Text *text)
{
    const RobotCoupling *coupling = &of->robot->couplings[number];
    const RobotJoint *joints[2] = {&of->robot->joints[coupling->joints[0]],
                                   &of->robot->joints[coupling->joints[1]]};
    const char *lacks = coupling_lacks(of, coupling);
    const Vec3 across = vec3_across(vec3_sub(joints[1]->place, joints[0]->place), of->normal);
    const double distance = vec3_length(across);
    // phi_a = r phi_b, and of teeth n_a phi_a = -n_b phi_b
    const double ratio = coupling->ratio * robot_case_sign(of, joints[0]) * //
                         robot_case_sign(of, joints[1]);
    int teeth[2];
    if (lacks == NULL && (!(distance > 1e-9) || ratio == 1.0)) {
        lacks = "that no pair of gears has";
    }
    if (lacks == NULL && !find_teeth(fabs(ratio), teeth)) {
        lacks = "whose ratio is none of teeth";
    }
    if (lacks != NULL) {
        robot_case_note(of, "the coupling of joint '%s' with '%s', %s",
                        robot_case_joint(of, joints[0]), robot_case_joint(of, joints[1]), lacks);
        return;
    }
    if (ratio > 0.0) {
        teeth[teeth[1] > teeth[0] ? 1 : 0] *= -1; // the larger one is internal
    }
    double yielding = 0.0;
    for (int i = 0; i < 2; i++) {
        const double radius = distance * teeth[i] / (teeth[0] + teeth[1]);
        const Mat3 *inertia = &of->robot->bodies[joints[i]->body].inertia;
        yielding += radius * radius / vec3_dot(of->normal, mat3_apply(inertia, of->normal));
    }
    text_append(text,
                "  %s: {gears: [%s, %s], teeth: [%d, %d], backlash: 0 mm, stiffness: %.2g N/m,\n"
                "    viscous-coefficient: %.2g N s/m}   # teeth of the ratio of the model, hard\n",
                of->couplings[number], of->joints[coupling->joints[0]],
                of->joints[coupling->joints[1]], teeth[0], teeth[1],
                TEETH_FREQUENCY * TEETH_FREQUENCY / yielding,
                2.0 * TEETH_DAMPING * TEETH_FREQUENCY / yielding);
}

// Where a joint could close a chain that is open: between an end and the ground, and between ends.
static void write_ends(const RobotCase *of, Text *text)
{
    const Robot *robot = of->robot;
    bool *carries = memory_zeroed(robot->body_count, sizeof *carries);
    int last = ROBOT_GROUND;
    for (size_t i = 0; i < robot->body_count; i++) {
        const int parent = robot_case_held(of, robot->bodies[i].parent);
        if (of->held[i] == (int)i && parent != ROBOT_GROUND) {
            carries[parent] = true;
        }
    }
    text_append(text,
                "  # The chain of the model is open. Where yours closes a loop, which a tree of "
                "bodies cannot say, add a\n  # joint at the point that both bodies share, "
                "ideal or with hole and pin:\n");
    for (size_t i = 0; i < robot->body_count; i++) {
        if (of->held[i] != (int)i || carries[i]) {
            continue;
        }
        const Vec3 own = robot->bodies[i].centre;
        const Vec3 other = last != ROBOT_GROUND ? robot->bodies[last].centre : own;
        text_append(text, "  # closing-%s: {between: [%s, %s], at: ", of->bodies[i], of->bodies[i],
                    robot_case_body(of, last));
        put_place(of, vec3_scale(0.5, vec3_add(own, other)), text);
        text_append(text, "}\n");
        last = (int)i;
    }
    free(carries);
}

// Bodies that are all free have none.
static void write_joints(RobotCase *of, Text *text)
{
    const Robot *robot = of->robot;
    bool has_loop = false;
    Text joints;
    text_init(&joints);
    for (size_t i = 0; i < robot->joint_count; i++) {
        if (of->fates[i] == ROBOT_STAYS) {
            write_joint(of, i, &joints);
        }
    }
    for (size_t i = 0; i < robot->loop_count; i++) {
        has_loop = write_loop(of, i, &joints) || has_loop;
    }
    for (size_t i = 0; i < robot->coupling_count; i++) {
        write_coupling(of, i, &joints);
    }
    if (joints.length > 0 && !has_loop) {
        write_ends(of, &joints);
    }
    text_append(text, "%s", joints.length > 0 ? "\njoints:\n" : "");
    text_append_bytes(text, joints.data, joints.length);
    text_finish(&joints);
}

// Springs, dampers and servos.

typedef struct Soft {
    double stiffness;
    double moment; // of it: where it is relaxed times that
    double damping;
} Soft;

static Soft soft_of(RobotCase *of, size_t number)
{
    const RobotJoint *joint = &of->robot->joints[number];
    Soft soft = {joint->stiffness, joint->stiffness * joint->relaxed, joint->damping};
    for (size_t i = 0; i < of->robot->actuator_count; i++) {
        const RobotActuator *actuator = &of->robot->actuators[i];
        if (actuator->joint != (int)number) {
            continue;
        }
        if (!(actuator->stiffness >= 0.0) || !(actuator->damping >= 0.0) ||
            (actuator->stiffness == 0.0 && actuator->constant != 0.0)) {
            robot_case_note(of, "what actuator '%s' does at control 0", actuator->name);
            continue;
        }
        soft.stiffness += actuator->stiffness;
        soft.moment += actuator->constant - actuator->stiffness * joint->zero;
        soft.damping += actuator->damping;
    }
    return soft;
}

static void write_torsion(const RobotCase *of, size_t number, const Soft *soft, Text *text)
{
    text_append(text, "  %s: {joint: %s", of->joints[number], of->joints[number]);
    if (soft->stiffness > 0.0) {
        text_append(text, ", stiffness: %.15g N m/rad, angle: %.15g rad", soft->stiffness,
                    robot_case_sign(of, &of->robot->joints[number]) * soft->moment /
                        soft->stiffness);
    }
    if (soft->damping > 0.0) {
        text_append(text, ", damping: %.15g N m s/rad", soft->damping);
    }
    text_append(text, "}\n");
}

static void write_spring(const RobotCase *of, size_t number, const Soft *soft, Text *text)
{
    const RobotJoint *joint = &of->robot->joints[number];
    const Vec3 behind = vec3_sub(joint->place, vec3_scale(SLIDE_SPRING, joint->axis));
    text_append(text, "  %s: {between: [%s, %s], at-a: ", of->joints[number],
                robot_case_body(of, parent_of(of, joint)), robot_case_body(of, joint->body));
    put_place(of, behind, text);
    text_append(text, ", at-b: ");
    put_place(of, joint->place, text);
    if (soft->stiffness > 0.0) {
        text_append(text, ",\n    stiffness: %.15g N/m, length: %.15g m", soft->stiffness,
                    SLIDE_SPRING + soft->moment / soft->stiffness);
    }
    if (soft->damping > 0.0) {
        text_append(text, ", damping: %.15g N s/m", soft->damping);
    }
    text_append(text, "}\n");
}

// Those of hinges or those of slides.
static void write_springs(RobotCase *of, RobotJointKind kind, Text *text)
{
    bool is_first = true;
    for (size_t i = 0; i < of->robot->joint_count; i++) {
        const RobotJoint *joint = &of->robot->joints[i];
        if (joint->kind != kind || of->fates[i] != ROBOT_STAYS) {
            continue;
        }
        const Soft soft = soft_of(of, i);
        if (soft.stiffness == 0.0 && soft.damping == 0.0) {
            continue;
        }
        if (!of->is_planar) {
            robot_case_note(of, "spring and damper of joint '%s': a case in space has none",
                            robot_case_joint(of, joint));
            continue;
        }
        if (is_first) {
            text_append(text,
                        kind == ROBOT_HINGE
                            ? "\n# Springs, dampers and servos of the hinges.\n"
                              "torsion-springs:\n"
                            : "\n# The same of the slides, between two points on their lines, "
                              "of which one is far.\nsprings:\n");
            is_first = false;
        }
        (kind == ROBOT_HINGE ? write_torsion : write_spring)(of, i, &soft, text);
    }
}

static void write_actuators(const RobotCase *of, Text *text)
{
    const Robot *robot = of->robot;
    bool is_first = true;
    for (size_t i = 0; i < robot->actuator_count; i++) {
        const RobotActuator *actuator = &robot->actuators[i];
        const bool is_turn = robot->joints[actuator->joint].kind == ROBOT_HINGE;
        if (of->fates[actuator->joint] != ROBOT_STAYS || actuator->gain == 0.0) {
            continue;
        }
        const double sign = is_turn ? robot_case_sign(of, &robot->joints[actuator->joint]) : 1.0;
        text_append(text, "%s# drive: {joint: %s, %s: %.15g %s}   # actuator ",
                    is_first
                        ? "\n# Actuators, which do nothing at control 0 but what springs above "
                          "do; one of them as a drive at control 1:\n"
                        : "",
                    of->joints[actuator->joint], is_turn ? "torque" : "force",
                    sign * actuator->gain, is_turn ? "N m" : "N");
        is_first = false;
        if (actuator->name[0] != '\0') {
            text_append_shown(text, actuator->name);
        } else {
            text_append(text, "%zu", i + 1);
        }
        if (actuator->is_limited) {
            text_append(text, ", control %.6g to %.6g", actuator->control[0], actuator->control[1]);
        }
        text_append(text, "\n");
    }
}

static void write_gravity(RobotCase *of, Text *text)
{
    const Vec3 pull = of->robot->gravity;
    const double across = vec3_dot(pull, of->normal);
    text_append(text, "\ngravity: [%.15g m/s^2, %.15g m/s^2", clean(vec3_dot(pull, of->right)),
                clean(vec3_dot(pull, of->up)));
    if (!of->is_planar) {
        text_append(text, ", %.15g m/s^2", across);
    } else if (fabs(across) > PLACE_LEAST) {
        robot_case_note(of, "gravity across the plane, %.6g m/s^2, which the joints bear", across);
    }
    text_append(text, "]\n");
}

static const char *axis_word(Vec3 axis, char room[64])
{
    const Vec3 of[3] = {{1.0, 0.0, 0.0}, {0.0, 1.0, 0.0}, {0.0, 0.0, 1.0}};
    static const char *const WORDS[2][3] = {{"x", "y", "z"}, {"-x", "-y", "-z"}};
    for (int i = 0; i < 3; i++) {
        const double along = vec3_dot(of[i], axis);
        if (fabs(along) > 1.0 - 1e-12) {
            return WORDS[along < 0.0 ? 1 : 0][i];
        }
    }
    snprintf(room, 64, "[%.6g, %.6g, %.6g]", axis.x, axis.y, axis.z);
    return room;
}

// What stands above: where it comes from, its axes, and what it has not.
static void write_head(const RobotCase *of, const char *file, Text *text)
{
    char rooms[2][64];
    text_append(text, "# Written by 'jointplay new --from ");
    text_append_shown(text, file);
    text_append(text,
                "': the bodies of a model in %s, as MuJoCo reads it, in the\n"
                "# posture of the file, at rest. It runs as it is; put your own numbers in. "
                "All keys: 'jointplay help case'.\n",
                of->robot->format);
    if (of->is_planar) {
        text_append(text, "# x of the case is %s of the file, y %s.\n",
                    axis_word(of->right, rooms[0]), axis_word(of->up, rooms[1]));
    }
    for (size_t i = 0; i < of->note_count; i++) {
        text_append(text, "# left out: %s\n", of->notes[i]);
    }
    text_append(text, "title: From ");
    for (const char *at = file; *at != '\0'; at++) {
        const bool is_plain = (*at >= '0' && *at <= '9') || (*at >= 'A' && *at <= 'Z') ||
                              (*at >= 'a' && *at <= 'z') || *at == '.' || *at == '_';
        text_append(text, "%c", is_plain ? *at : '-');
    }
    text_append(text, "\n%s", of->is_planar ? "" : "space: spatial\n");
}

void robot_case_write(RobotCase *of, const char *file, Text *text)
{
    Text below;
    text_init(&below);
    text_append(&below, "\nbodies:\n");
    for (size_t i = 0; i < of->robot->body_count; i++) {
        if (of->held[i] == (int)i) {
            write_body(of, i, &below);
        }
    }
    write_joints(of, &below);
    write_springs(of, ROBOT_HINGE, &below);
    write_springs(of, ROBOT_SLIDE, &below);
    write_actuators(of, &below);
    write_gravity(of, &below);
    text_append(&below, "run: {duration: 1 s, samples: 1000, backends: [reference%s]}\n",
                of->has_between ? "" : ", ode");
    // what is left out is known by now
    write_head(of, file, text);
    text_append_bytes(text, below.data, below.length);
    text_finish(&below);
}
