// How do springs, dampers and drives act in a world of ODE that libjointplay steps?
//
// A body that is driven at constant speed has no dynamics in ODE. A drive at a speed over time is a
// hinge's motor without a bound, at the speed at the step's end. A damper
// acts on the mean of the speeds before and after the step, -c (r + r') / 2, as a row
//     r' + (2/c) f = -r
// of a hinge's motor or, along a line, of a distance joint, whose right-hand side is ERP/h (wanted
// distance - distance). Springs and a torque push at mid-step, where the world calls `collide`.
#include "commands/tune/tune_world_forces.h"

#include "commands/tune/tune_world_joints.h"
#include "model/forces.h"
#include "write/number.h"

bool tune_world_has_effect(const Linkage *linkage, const TorsionSpring *spring)
{
    return !linkage->driver.is_present || linkage->driver.joint != spring->joint;
}

bool tune_world_pushes(const Linkage *linkage)
{
    bool is_any = linkage->spring_count > 0 || linkage->torque.table.count > 0;
    for (size_t i = 0; i < linkage->torsion_count; i++) {
        const TorsionSpring *spring = &linkage->torsions[i];
        is_any = is_any || (tune_world_has_effect(linkage, spring) && spring->stiffness > 0.0);
    }
    return is_any;
}

static void write_table(const char *name, const TimeTable *table, const char *unit, Text *text)
{
    text_append(text, "\nstatic const double %s[][2] = { // s, %s\n   ", name, unit);
    for (size_t i = 0; i < table->count; i++) {
        text_append(text, " {%s, %s},", number_shortest(table->times[i]).text,
                    number_shortest(table->values[i]).text);
    }
    text_append(text, "\n};\n");
}

static const char AT[] =
    "\n// linear between the points of a table\n"
    "static double at(const double (*points)[2], size_t count, double time)\n{\n"
    "    size_t i = 1;\n"
    "    while (i + 1 < count && time > points[i][0]) {\n        i++;\n    }\n"
    "    if (count == 1 || time <= points[0][0] || time >= points[i][0]) {\n"
    "        return points[count == 1 || time <= points[0][0] ? 0 : i][1];\n    }\n"
    "    const double share = (time - points[i - 1][0]) / (points[i][0] - points[i - 1][0]);\n"
    "    return (1 - share) * points[i - 1][1] + share * points[i][1];\n}\n";

static const char SPRING[] =
    "\n// A spring with a damper between two points: N/m, m, N s/m. The row is a distance joint.\n"
    "static void pull(dJointID row, dBodyID a, double xa, double ya, dBodyID b, double xb, "
    "double yb,\n"
    "                 double stiffness, double length, double damping)\n{\n"
    "    dVector3 from = {xa, ya}, to = {xb, yb}, v = {0}, w = {0};\n"
    "    if (a != NULL) {\n"
    "        dBodyGetRelPointPos(a, xa, ya, 0, from);\n"
    "        dBodyGetRelPointVel(a, xa, ya, 0, v);\n    }\n"
    "    if (b != NULL) {\n"
    "        dBodyGetRelPointPos(b, xb, yb, 0, to);\n"
    "        dBodyGetRelPointVel(b, xb, yb, 0, w);\n    }\n"
    "    const double distance = hypot(to[0] - from[0], to[1] - from[1]);\n"
    "    const double x = (to[0] - from[0]) / distance, y = (to[1] - from[1]) / distance;\n"
    "    const double force = stiffness * (distance - length);\n"
    "    if (a != NULL) {\n"
    "        dBodyAddForceAtPos(a, force * x, force * y, 0, from[0], from[1], 0);\n    }\n"
    "    if (b != NULL) {\n"
    "        dBodyAddForceAtPos(b, -force * x, -force * y, 0, to[0], to[1], 0);\n    }\n"
    "    if (row != NULL) {\n"
    "        const double rate = x * (w[0] - v[0]) + y * (w[1] - v[1]);\n"
    "        const double gain = fmax(1, 2 * fabs(rate) / distance);\n"
    "        dJointSetDBallParam(row, dParamERP, gain * STEP);\n"
    "        dJointSetDBallParam(row, dParamCFM, 2 / damping);\n"
    "        dJointSetDBallDistance(row, distance - rate / gain);\n    }\n}\n";

static void write_point(const Linkage *linkage, int body, Vec2 at, Text *text)
{
    const Vec2 local = tune_world_local(linkage, body, at);
    tune_world_body(linkage, body, text);
    text_append(text, ", %s, %s, ", number_shortest(local.x).text, number_shortest(local.y).text);
}

static void write_springs(const Linkage *linkage, Text *text)
{
    for (size_t i = 0; i < linkage->spring_count; i++) {
        const Spring *spring = &linkage->springs[i];
        if (spring->damping > 0.0) {
            text_append(text, "    pull(damper_%zu, ", i);
        } else {
            text_append(text, "    pull(NULL, ");
        }
        write_point(linkage, spring->body_a, spring->anchor_a, text);
        write_point(linkage, spring->body_b, spring->anchor_b, text);
        text_append(text, "%s, %s, %s);\n", number_shortest(spring->stiffness).text,
                    number_shortest(spring->length).text, number_shortest(spring->damping).text);
    }
}

double tune_world_angle_at_start(const Linkage *linkage, int joint)
{
    int turned;
    int against;
    linkage_turning(linkage, joint, &turned, &against);
    const double other = against == LINKAGE_GROUND ? 0.0 : linkage->bodies[against].start.angle;
    return linkage->bodies[turned].start.angle - other;
}

static void write_torsions(const Linkage *linkage, Text *text)
{
    for (size_t i = 0; i < linkage->torsion_count; i++) {
        const TorsionSpring *spring = &linkage->torsions[i];
        if (!tune_world_has_effect(linkage, spring) || !(spring->stiffness > 0.0)) {
            continue;
        }
        text_append(text, "    dJointAddHingeTorque(");
        tune_world_joint(linkage, spring->joint, text);
        text_append(
            text, ", %s * (%s - dJointGetHingeAngle(", number_shortest(spring->stiffness).text,
            number_shortest(spring->angle - tune_world_angle_at_start(linkage, spring->joint))
                .text);
        tune_world_joint(linkage, spring->joint, text);
        text_append(text, "))); // within half a turn\n");
    }
}

static void write_torque(const Linkage *linkage, Text *text)
{
    const Torque *torque = &linkage->torque;
    if (torque->table.count == 0) {
        return;
    }
    const bool is_hinge = linkage->joints[torque->joint].kind == JOINT_REVOLUTE;
    text_append(text, "    %s(", is_hinge ? "dJointAddHingeTorque" : "dJointAddSliderForce");
    tune_world_joint(linkage, torque->joint, text);
    text_append(text, ", at(DRIVE, sizeof DRIVE / sizeof *DRIVE, middle));\n");
}

void tune_world_push(const Linkage *linkage, Text *text)
{
    const TimeTable *speeds = &linkage->driver.speeds;
    const TimeTable *torques = &linkage->torque.table;
    if (speeds->count > 0) {
        write_table("DRIVE", speeds, "rad/s", text);
    }
    if (torques->count > 0) {
        const bool is_hinge = linkage->joints[linkage->torque.joint].kind == JOINT_REVOLUTE;
        write_table("DRIVE", torques, is_hinge ? "N m" : "N", text);
        text_append(text, "static double middle; // s, of the step under way\n");
    }
    text_append(text, "%s", speeds->count + torques->count > 0 ? AT : "");
    text_append(text, "%s", linkage->spring_count > 0 ? SPRING : "");
    for (size_t i = 0; i < linkage->spring_count; i++) {
        if (linkage->springs[i].damping > 0.0) {
            text_append(text, "\nstatic dJointID damper_%zu;\n", i);
        }
    }
    if (tune_world_pushes(linkage)) {
        text_append(text, "\n// where the step evaluates forces\n"
                          "static void push(dWorldID pushed, void *data)\n{\n"
                          "    (void)pushed;\n    (void)data;\n");
        write_springs(linkage, text);
        write_torsions(linkage, text);
        write_torque(linkage, text);
        text_append(text, "}\n");
    }
}

static void write_param(const Linkage *linkage, int joint, const char *param, const char *value,
                        Text *text)
{
    text_append(text, "    dJointSetHingeParam(");
    tune_world_joint(linkage, joint, text);
    text_append(text, ", %s, %s);\n", param, value);
}

// The distance joint of a damper, whose first body is not the world.
static void write_damper(const Linkage *linkage, size_t number, Text *text)
{
    const Spring *spring = &linkage->springs[number];
    const int bodies[2] = {spring->body_a, spring->body_b};
    const Vec2 ends[2] = {spring->anchor_a, spring->anchor_b};
    const int first = spring->body_a == LINKAGE_GROUND ? 1 : 0;
    text_append(text,
                "    damper_%zu = dJointCreateDBall(world, 0);\n    dJointAttach(damper_%zu, ",
                number, number);
    tune_world_body(linkage, bodies[first], text);
    text_append(text, ", ");
    tune_world_body(linkage, bodies[1 - first], text);
    text_append(text, ");\n");
    for (int i = 0; i < 2; i++) {
        const int side = i == 0 ? first : 1 - first;
        const Vec2 local = ends[side];
        const Vec2 at =
            bodies[side] == LINKAGE_GROUND
                ? local
                : vec2_add(linkage->bodies[bodies[side]].start.position,
                           vec2_rotate(linkage->bodies[bodies[side]].start.angle, local));
        text_append(text, "    dJointSetDBallAnchor%d(damper_%zu, %s, %s, 0);\n", i + 1, number,
                    number_shortest(at.x).text, number_shortest(at.y).text);
    }
}

void tune_world_motors(const Linkage *linkage, Text *text)
{
    const Driver *driver = &linkage->driver;
    const int driven = linkage_driven_body(linkage);
    if (tune_world_is_led(linkage, driven)) {
        text_append(text, "    dBodySetKinematic(");
        tune_world_body(linkage, driven, text);
        text_append(text, "); // at its pivot, and at constant speed\n");
    } else if (driver->is_present) {
        write_param(linkage, driver->joint, "dParamFMax", "dInfinity", text);
    }
    for (size_t i = 0; i < linkage->torsion_count; i++) {
        const TorsionSpring *spring = &linkage->torsions[i];
        if (tune_world_has_effect(linkage, spring) && spring->damping > 0.0) {
            write_param(linkage, spring->joint, "dParamFMax", "dInfinity", text);
            write_param(linkage, spring->joint, "dParamCFM",
                        number_shortest(2.0 / spring->damping).text, text);
        }
    }
    for (size_t i = 0; i < linkage->spring_count; i++) {
        if (linkage->springs[i].damping > 0.0) {
            write_damper(linkage, i, text);
        }
    }
}

void tune_world_drive(const Linkage *linkage, Text *text)
{
    if (linkage->driver.speeds.count > 0) {
        text_append(text, "    ");
        write_param(linkage, linkage->driver.joint, "dParamVel",
                    "at(DRIVE, sizeof DRIVE / sizeof *DRIVE, (i + 1) * STEP)", text);
    }
    if (linkage->torque.table.count > 0) {
        text_append(text, "        middle = (i + 0.5) * STEP;\n");
    }
    for (size_t i = 0; i < linkage->torsion_count; i++) {
        const TorsionSpring *spring = &linkage->torsions[i];
        if (tune_world_has_effect(linkage, spring) && spring->damping > 0.0) {
            Text rate;
            text_init(&rate);
            text_append(&rate, "-dJointGetHingeAngleRate(");
            tune_world_joint(linkage, spring->joint, &rate);
            text_append(&rate, ")");
            text_append(text, "    ");
            write_param(linkage, spring->joint, "dParamVel", rate.data, text);
            text_finish(&rate);
        }
    }
}
