// Writes a mechanism as a world of SDF 1.6: links at their centres of mass, joints in the frame of
// their child, pins as cylinders, and their speeds at the start as the world's state.
//
// SDF has no hole: it is a ring of N boxes whose faces touch its circle. Between two of them the
// pin goes deeper by R (1 / cos(pi / N) - 1), which N keeps below a share of the play. A loop is a
// joint more; Gazebo classic closes it. Of the axes of a joint the frame is the joint's, that of
// its child, whose z is the world's.
#include "commands/tune/tune_sdf_model.h"

#include "base/zeroed.h"
#include "model/coordinate.h"
#include "model/joint_friction.h"
#include "model/joint_rows.h"
#include "write/number.h"
#include "write/xml.h"

#include <math.h>
#include <stdlib.h>

static const char WORLD_NAME[] = "jointplay";
static const char MODEL_NAME[] = "mechanism";

enum { STAVES_LEAST = 32, STAVES_MOST = 720 };

static const double SAGITTA = 0.05;  // 1, of the play: how much deeper a pin goes between two
static const double THICKNESS = 0.5; // 1, of the hole's radius

const char *tune_sdf_model_lacks(const Scenario *scenario)
{
    const Linkage *linkage = &scenario->linkage;
    for (size_t i = 0; i < linkage->joint_count; i++) {
        const Joint *joint = &linkage->joints[i];
        if (!joint_is_ideal(joint->kind) && !joint_has_hole(joint->kind)) {
            return "SDF has whole models of pivots, sliders and pins in holes alone";
        }
        if (joint->limits.kind != LIMIT_NONE) {
            return "limits of joints are elements to paste";
        }
    }
    return NULL;
}

static void append_name(const char *name, Text *text)
{
    text_append(text, "\"");
    xml_append(name, text);
    text_append(text, "\"");
}

static void append_pose(Vec2 at, double angle, Text *text)
{
    text_append(text, "<pose>%s %s 0 0 0 %s</pose>", number_shortest(at.x).text,
                number_shortest(at.y).text, number_shortest(angle).text);
}

static void append_value(const char *tag, double value, Text *text)
{
    text_append(text, "<%s>%s</%s>", tag, number_shortest(value).text, tag);
}

static void append_collision(const char *kind, size_t number, Vec2 at, double angle, Text *text)
{
    text_append(text, "      <collision name=\"%s_%zu\">\n        ", kind, number);
    append_pose(at, angle, text);
    text_append(text, "\n        <geometry>");
}

// m, of the pin along its axis.
static double width_of(const Joint *joint)
{
    const double width = joint->clearance.width;
    return width > 0.0 ? width : 2.0 * joint->clearance.hole_radius;
}

static void append_pin(const Joint *joint, size_t number, const char *surface, Text *text)
{
    append_collision("pin", number, joint->anchor_b, 0.0, text);
    text_append(text, "<cylinder>");
    append_value("radius", joint->clearance.pin_radius, text);
    append_value("length", 2.0 * width_of(joint), text);
    text_append(text, "</cylinder></geometry>\n%s      </collision>\n", surface);
}

static void append_hole(const Joint *joint, size_t number, const char *surface, Text *text)
{
    const double radius = joint->clearance.hole_radius;
    const double deeper = SAGITTA * linkage_radial_clearance(joint) / radius;
    const double wanted = ceil(M_PI / acos(1.0 / (1.0 + deeper)));
    const size_t count = (size_t)fmin(fmax(wanted, STAVES_LEAST), STAVES_MOST);
    const double thickness = THICKNESS * radius;
    for (size_t i = 0; i < count; i++) {
        const double angle = 2.0 * M_PI * (double)i / (double)count;
        const Vec2 middle = vec2_rotate(angle, (Vec2){radius + 0.5 * thickness, 0.0});
        char name[64];
        snprintf(name, sizeof name, "hole_%zu_stave", number);
        append_collision(name, i, vec2_add(joint->anchor_a, middle), angle, text);
        text_append(text, "<box><size>%s %s %s</size></box></geometry>\n%s      </collision>\n",
                    number_shortest(thickness).text,
                    number_shortest(2.0 * (radius + thickness) * tan(M_PI / (double)count)).text,
                    number_shortest(width_of(joint)).text, surface);
    }
}

static void append_link(const Linkage *linkage, int number, const char *surface, Text *text)
{
    const Body *body = &linkage->bodies[number];
    text_append(text, "    <link name=");
    append_name(body->name, text);
    text_append(text, ">\n      ");
    append_pose(body->start.position, body->start.angle, text);
    text_append(text, "\n      <inertial>");
    append_value("mass", body->mass, text);
    text_append(text, "<inertia>");
    append_value("ixx", body->inertia, text);
    append_value("iyy", body->inertia, text);
    append_value("izz", body->inertia, text);
    text_append(text, "<ixy>0</ixy><ixz>0</ixz><iyz>0</iyz></inertia></inertial>\n");
    for (size_t i = 0; i < linkage->joint_count; i++) {
        const Joint *joint = &linkage->joints[i];
        if (joint_has_hole(joint->kind) && joint->body_b == number) {
            append_pin(joint, i, surface, text);
        } else if (joint_has_hole(joint->kind) && joint->body_a == number) {
            append_hole(joint, i, surface, text);
        }
    }
    text_append(text, "    </link>\n");
}

// The pins and holes of the ground, on a link that the world holds.
static void append_ground(const Linkage *linkage, const char *surface, Text *text)
{
    bool is_any = false;
    for (size_t i = 0; i < linkage->joint_count; i++) {
        const Joint *joint = &linkage->joints[i];
        const bool is_on = joint->body_a == LINKAGE_GROUND || joint->body_b == LINKAGE_GROUND;
        if (!joint_has_hole(joint->kind) || !is_on) {
            continue;
        }
        text_append(text, "%s", is_any ? "" : "    <link name=\"jointplay_ground\">\n");
        is_any = true;
        (joint->body_a == LINKAGE_GROUND ? append_hole : append_pin)(joint, i, surface, text);
    }
    text_append(text, "%s",
                is_any ? "    </link>\n    <joint name=\"jointplay_held\" type=\"fixed\">"
                         "<parent>world</parent><child>jointplay_ground</child></joint>\n"
                       : "");
}

static bool holds_steadily(const Scenario *scenario, const Joint *joint)
{
    return joint->friction.steady > 0.0 &&
           joint_friction_whole(&scenario->contact, joint).law == BRISTLE_STICK;
}

// The torsion springs and dampers of a pivot, relaxed at an angle since the start; and a steady
// friction that holds, which Gazebo's is.
static void append_dynamics(const Scenario *scenario, int number, double start, Text *text)
{
    const Linkage *linkage = &scenario->linkage;
    const Joint *joint = &linkage->joints[number];
    double stiffness = 0.0;
    double pulled = 0.0;
    double damping = 0.0;
    for (size_t i = 0; i < linkage->torsion_count; i++) {
        const TorsionSpring *spring = &linkage->torsions[i];
        if (spring->joint == number) {
            stiffness += spring->stiffness;
            damping += spring->damping;
            pulled += spring->stiffness * (spring->angle - start);
        }
    }
    text_append(text, "<dynamics>");
    append_value("damping", damping, text);
    append_value("friction", holds_steadily(scenario, joint) ? joint->friction.steady : 0.0, text);
    append_value("spring_reference", stiffness > 0.0 ? pulled / stiffness : 0.0, text);
    append_value("spring_stiffness", stiffness, text);
    text_append(text, "</dynamics>");
}

static void append_joint(const Scenario *scenario, const Motion *motions, int number, Text *text)
{
    const Linkage *linkage = &scenario->linkage;
    const Joint *joint = &linkage->joints[number];
    const bool slides = joint_slides(joint->kind);
    int child;
    int parent;
    linkage_turning(linkage, number, &child, &parent);
    text_append(text, "    <joint name=");
    append_name(joint->name, text);
    text_append(text, " type=\"%s\">\n      ", slides ? "prismatic" : "revolute");
    append_pose(child == joint->body_b ? joint->anchor_b : joint->anchor_a, 0.0, text);
    text_append(text, "\n      <parent>");
    xml_append(parent == LINKAGE_GROUND ? "world" : linkage->bodies[parent].name, text);
    text_append(text, "</parent>\n      <child>");
    xml_append(linkage->bodies[child].name, text);
    text_append(text, "</child>\n      <axis><xyz>");
    if (slides) {
        const Vec2 along = vec2_rotate(
            -motions[child].angle,
            vec2_scale(coordinate_sense(joint), joint_rows_along(linkage, motions, number)));
        text_append(text, "%s %s 0", number_shortest(along.x).text, number_shortest(along.y).text);
    } else {
        text_append(text, "0 0 1");
    }
    text_append(text, "</xyz>");
    append_dynamics(scenario, number, coordinate_position(linkage, motions, number), text);
    text_append(text, "</axis>\n    </joint>\n");
}

// The state at the start, in which Gazebo has the speeds.
static void append_state(const Linkage *linkage, Text *text)
{
    text_append(text, "<state world_name=\"%s\">\n  <model name=\"%s\">\n", WORLD_NAME, MODEL_NAME);
    for (size_t i = 0; i < linkage->body_count; i++) {
        const Motion *start = &linkage->bodies[i].start;
        text_append(text, "    <link name=");
        append_name(linkage->bodies[i].name, text);
        text_append(text, ">");
        append_pose(start->position, start->angle, text);
        text_append(text, "<velocity>%s %s 0 0 0 %s</velocity></link>\n",
                    number_shortest(start->velocity.x).text,
                    number_shortest(start->velocity.y).text, number_shortest(start->omega).text);
    }
    text_append(text, "  </model>\n</state>\n");
}

// A comment, in which no two '-' may stand beside each other.
static void leave_out(const char *what, const char *name, Text *text)
{
    text_append(text, "<!-- left out: %s", what);
    for (const char *at = name; *at != '\0'; at++) {
        const bool is_second = at > name && at[0] == '-' && at[-1] == '-';
        text_append(text, "%c", is_second || (unsigned char)*at < ' ' ? '_' : *at);
    }
    text_append(text, " -->\n");
}

static void append_left_out(const Scenario *scenario, Text *text)
{
    const Linkage *linkage = &scenario->linkage;
    for (size_t i = 0; i < linkage_drive_count(linkage); i++) {
        leave_out("a plugin has to drive the joint ",
                  linkage->joints[linkage_drive(linkage, i)->joint].name, text);
    }
    if (linkage->torque.table.count > 0) {
        leave_out("a plugin has to turn the joint ", linkage->joints[linkage->torque.joint].name,
                  text);
    }
    for (size_t i = 0; i < linkage->spring_count; i++) {
        leave_out("SDF has no spring between two points, as ", linkage->springs[i].name, text);
    }
    for (size_t i = 0; i < linkage->bushing_count; i++) {
        leave_out("SDF has no bushing, as ", linkage->bushings[i].name, text);
    }
    for (size_t i = 0; i < linkage->load_count; i++) {
        leave_out("a plugin has to apply the load ", linkage->loads[i].name, text);
    }
    for (size_t i = 0; i < linkage->joint_count; i++) {
        const Joint *joint = &linkage->joints[i];
        if (joint_friction_is(joint) && !holds_steadily(scenario, joint)) {
            leave_out(joint->friction.steady > 0.0
                          ? "friction of SDF holds at rest, and that is regularized at joint "
                          : "friction of SDF grows with nothing, as it does at joint ",
                      joint->name, text);
        }
        if (joint->contact.gap_damping > 0.0) {
            leave_out("SDF has no damping in a gap, as of joint ", joint->name, text);
        }
    }
}

void tune_sdf_model_write(const Scenario *scenario, const char *surface, Text *text)
{
    const Linkage *linkage = &scenario->linkage;
    Motion *motions = zeroed(linkage->body_count, sizeof *motions);
    linkage_start(linkage, motions);
    append_left_out(scenario, text);
    text_append(text, "<gravity>%s %s 0</gravity>\n<model name=\"%s\">\n",
                number_shortest(0.0 + scenario->gravity.x).text,
                number_shortest(0.0 + scenario->gravity.y).text, MODEL_NAME);
    for (int i = 0; i < (int)linkage->body_count; i++) {
        append_link(linkage, i, surface, text);
    }
    append_ground(linkage, surface, text);
    for (int i = 0; i < (int)linkage->joint_count; i++) {
        if (joint_is_ideal(linkage->joints[i].kind)) {
            append_joint(scenario, motions, i, text);
        }
    }
    text_append(text, "</model>\n");
    append_state(linkage, text);
    free(motions);
}
