// Writes bushings into a program against libjointplay, and makes them in the world that is
// measured.
//
// Its forces are those of mid-step, where the world calls `collide`, and its dampers rows of
// distance joints that are placed there: from the point B on the second body to B - l e on the
// first, with the right-hand side -r of a damper that acts on the mean of the rates before and
// after the step. The program and tune_bushing_push do the same in the same order.
#include "commands/tune/tune_bushings.h"

#include "commands/tune/tune_bodies.h"
#include "model/bushing.h"
#include "write/number.h"

#include <math.h>
#include <string.h>

// m: least length of a row's line, as in the program
static const double TUNE_BUSHING_LINE = 0.01;

const char *tune_bushings_lack(const Linkage *linkage)
{
    for (size_t i = 0; i < linkage->bushing_count; i++) {
        const Bushing *bushing = &linkage->bushings[i];
        if (bushing->torsional_damping > 0.0) {
            return "the program has no bushing with a torsional damping";
        }
        for (size_t row = 0; row < BUSHING_ROWS; row++) {
            const ForceCurve *curve = bushing_curve(bushing, row);
            if (curve->count > 0 && curve->is_smooth) {
                return "the program has no bushing with a smooth curve";
            }
        }
    }
    return NULL;
}

static const char FUNCTIONS[] =
    "\n// A bushing: anchors and direction in the bodies' frames, stiffnesses along its axes, N/m, "
    "and\n"
    "// by angle, N m/rad, or points in their place, and dampings along its axes, N s/m.\n"
    "typedef struct Bushing {\n"
    "    double xa, ya, xb, yb, direction, angle, stiffness[3], damping[2];\n"
    "    const double (*points[3])[2];\n"
    "    size_t counts[3];\n"
    "    dBodyID a, b;\n"
    "    dJointID rows[2];\n"
    "} Bushing;\n"
    "\n// linear between the points of a curve, and straight on beyond them\n"
    "static double bend(const double (*points)[2], size_t count, double u)\n{\n"
    "    size_t i = 1;\n"
    "    while (i + 1 < count && u > points[i][0]) {\n        i++;\n    }\n"
    "    const double slope = (points[i][1] - points[i - 1][1]) / (points[i][0] - points[i - "
    "1][0]);\n"
    "    return points[i - 1][1] + (u - points[i - 1][0]) * slope;\n}\n"
    "\nstatic void make_bushing(Bushing *of, dBodyID a, dBodyID b)\n{\n"
    "    of->a = a;\n    of->b = b;\n"
    "    for (int i = 0; i < 2; i++) {\n"
    "        if (of->damping[i] > 0) {\n"
    "            of->rows[i] = dJointCreateDBall(world, 0);\n"
    "            dJointAttach(of->rows[i], a != NULL ? a : b, a != NULL ? b : NULL);\n"
    "            dJointSetDBallParam(of->rows[i], dParamCFM, 2 / of->damping[i]);\n"
    "        }\n    }\n}\n"
    "\nstatic void hold(const Bushing *of)\n{\n"
    "    dVector3 from = {of->xa, of->ya}, to = {of->xb, of->yb}, v = {0}, w = {0};\n"
    "    double turned_a = 0, turned_b = 0, omega = 0;\n"
    "    if (of->a != NULL) {\n"
    "        dBodyGetRelPointPos(of->a, of->xa, of->ya, 0, from);\n"
    "        dBodyGetRelPointVel(of->a, of->xa, of->ya, 0, v);\n"
    "        turned_a = atan2(dBodyGetRotation(of->a)[4], dBodyGetRotation(of->a)[0]);\n"
    "        omega = dBodyGetAngularVel(of->a)[2];\n    }\n"
    "    if (of->b != NULL) {\n"
    "        dBodyGetRelPointPos(of->b, of->xb, of->yb, 0, to);\n"
    "        dBodyGetRelPointVel(of->b, of->xb, of->yb, 0, w);\n"
    "        turned_b = atan2(dBodyGetRotation(of->b)[4], dBodyGetRotation(of->b)[0]);\n    }\n"
    "    const double c = cos(turned_a + of->direction), s = sin(turned_a + of->direction);\n"
    "    const double axes[2][2] = {{c, s}, {-s, c}};\n"
    "    const double d[2] = {to[0] - from[0], to[1] - from[1]};\n"
    "    const double g[2] = {w[0] - v[0] + omega * d[1], w[1] - v[1] - omega * d[0]};\n"
    "    for (int i = 0; i < 3; i++) {\n"
    "        const double x = i < 2 ? axes[i][0] : 0, y = i < 2 ? axes[i][1] : 0;\n"
    "        const double u = i < 2 ? x * d[0] + y * d[1]\n"
    "                               : remainder(turned_b - turned_a - of->angle, 2 * M_PI);\n"
    "        const double pull = of->counts[i] > 0 ? bend(of->points[i], of->counts[i], u)\n"
    "                                              : of->stiffness[i] * u;\n"
    "        if (of->a != NULL) {\n"
    "            dBodyAddForceAtPos(of->a, pull * x, pull * y, 0, to[0], to[1], 0);\n"
    "            dBodyAddTorque(of->a, 0, 0, i < 2 ? 0 : pull);\n        }\n"
    "        if (of->b != NULL) {\n"
    "            dBodyAddForceAtPos(of->b, -pull * x, -pull * y, 0, to[0], to[1], 0);\n"
    "            dBodyAddTorque(of->b, 0, 0, i < 2 ? 0 : -pull);\n        }\n"
    "        if (i < 2 && of->rows[i] != NULL) { // on the mean of the rates before and after\n"
    "            const double rate = x * g[0] + y * g[1];\n"
    "            const double length = fmax(0.01, fabs(rate));\n"
    "            const double gain = fmax(1, 2 * fabs(rate) / length);\n"
    "            const double far[2] = {to[0] - length * x, to[1] - length * y};\n"
    "            const double *one = of->a != NULL ? far : to, *two = of->a != NULL ? to : far;\n"
    "            dJointSetDBallAnchor1(of->rows[i], one[0], one[1], 0);\n"
    "            dJointSetDBallAnchor2(of->rows[i], two[0], two[1], 0);\n"
    "            dJointSetDBallParam(of->rows[i], dParamERP, gain * STEP);\n"
    "            dJointSetDBallDistance(of->rows[i], length - rate / gain);\n"
    "        }\n    }\n}\n";

static void write_curve(size_t number, size_t row, const ForceCurve *curve, Text *text)
{
    if (curve->count == 0) {
        return;
    }
    text_append(text, "\nstatic const double CURVE_%zu_%zu[][2] = { // %s\n   ", number, row,
                row == 2 ? "rad, N m" : "m, N");
    for (size_t i = 0; i < curve->count; i++) {
        text_append(text, " {%s, %s},", number_shortest(curve->at[i]).text,
                    number_shortest(curve->values[i]).text);
    }
    text_append(text, "\n};\n");
}

static void write_bushing(const Linkage *linkage, size_t number, Text *text)
{
    const Bushing *of = &linkage->bushings[number];
    const Vec2 a = tune_bodies_local(linkage, of->body_a, of->anchor_a);
    const Vec2 b = tune_bodies_local(linkage, of->body_b, of->anchor_b);
    for (size_t row = 0; row < BUSHING_ROWS; row++) {
        write_curve(number, row, bushing_curve(of, row), text);
    }
    text_append(text, "\nstatic Bushing bushing_%zu = {\n    .xa = %s, .ya = %s,", number,
                number_shortest(a.x).text, number_shortest(a.y).text);
    text_append(text, " .xb = %s, .yb = %s,\n", number_shortest(b.x).text,
                number_shortest(b.y).text);
    text_append(text, "    .direction = %s, .angle = %s,\n", number_shortest(of->direction).text,
                number_shortest(of->angle).text);
    text_append(text, "    .stiffness = {%s, %s,", number_shortest(of->stiffness.x).text,
                number_shortest(of->stiffness.y).text);
    text_append(text, " %s},\n", number_shortest(of->torsional_stiffness).text);
    text_append(text, "    .damping = {%s, %s},\n", number_shortest(of->damping.x).text,
                number_shortest(of->damping.y).text);
    for (size_t row = 0; row < BUSHING_ROWS; row++) {
        const size_t count = bushing_curve(of, row)->count;
        if (count > 0) {
            text_append(text, "    .points[%zu] = CURVE_%zu_%zu, .counts[%zu] = %zu,\n", row,
                        number, row, row, count);
        }
    }
    text_append(text, "};\n");
}

void tune_bushings_write_functions(const Linkage *linkage, Text *text)
{
    text_append(text, "%s", linkage->bushing_count > 0 ? FUNCTIONS : "");
    for (size_t i = 0; i < linkage->bushing_count; i++) {
        write_bushing(linkage, i, text);
    }
}

void tune_bushings_write_making(const Linkage *linkage, Text *text)
{
    for (size_t i = 0; i < linkage->bushing_count; i++) {
        text_append(text, "    make_bushing(&bushing_%zu, ", i);
        tune_bodies_name(linkage, linkage->bushings[i].body_a, text);
        text_append(text, ", ");
        tune_bodies_name(linkage, linkage->bushings[i].body_b, text);
        text_append(text, ");\n");
    }
}

void tune_bushings_write_pushing(const Linkage *linkage, Text *text)
{
    for (size_t i = 0; i < linkage->bushing_count; i++) {
        text_append(text, "    hold(&bushing_%zu);\n", i);
    }
}

TuneBushing tune_bushing_make(dWorldID world, const Bushing *bushing, dBodyID a, dBodyID b)
{
    TuneBushing made = {{NULL, NULL}, a, b};
    for (size_t row = 0; row < 2; row++) {
        const double damping = bushing_damping(bushing, row);
        if (damping > 0.0) {
            made.rows[row] = dJointCreateDBall(world, 0);
            dJointAttach(made.rows[row], a != NULL ? a : b, a != NULL ? b : NULL);
            dJointSetDBallParam(made.rows[row], dParamCFM, 2.0 / damping);
        }
    }
    return made;
}

// A body, NULL being the world, as a motion whose origin is that of ODE.
static Motion motion_of(dBodyID body)
{
    if (body == NULL) {
        return (Motion){.angle = 0.0};
    }
    const dReal *position = dBodyGetPosition(body);
    const dReal *rotation = dBodyGetRotation(body);
    const dReal *velocity = dBodyGetLinearVel(body);
    return (Motion){.position = {position[0], position[1]},
                    .angle = atan2(rotation[4], rotation[0]),
                    .velocity = {velocity[0], velocity[1]},
                    .omega = dBodyGetAngularVel(body)[2]};
}

// Puts a damper's row on its line; see the program.
static void place_row(const TuneBushing *made, dJointID row, const BushingPose *pose, size_t axis,
                      double step_s)
{
    const double rate = pose->rate[axis];
    const double length = fmax(TUNE_BUSHING_LINE, fabs(rate));
    const double gain = fmax(1.0, 2.0 * fabs(rate) / length);
    const Vec2 far = vec2_sub(pose->point, vec2_scale(length, pose->axes[axis]));
    const Vec2 one = made->a != NULL ? far : pose->point;
    const Vec2 two = made->a != NULL ? pose->point : far;
    dJointSetDBallAnchor1(row, one.x, one.y, 0);
    dJointSetDBallAnchor2(row, two.x, two.y, 0);
    dJointSetDBallParam(row, dParamERP, gain * step_s);
    dJointSetDBallDistance(row, length - rate / gain);
}

void tune_bushing_push(const Linkage *linkage, const Bushing *bushing, const TuneBushing *made,
                       double step_s)
{
    const Motion motions[2] = {motion_of(made->a), motion_of(made->b)};
    Bushing own = *bushing;
    own.anchor_a = tune_bodies_local(linkage, bushing->body_a, bushing->anchor_a);
    own.anchor_b = tune_bodies_local(linkage, bushing->body_b, bushing->anchor_b);
    own.body_a = made->a != NULL ? 0 : LINKAGE_GROUND;
    own.body_b = made->b != NULL ? 1 : LINKAGE_GROUND;
    BushingPose pose = bushing_pose(&own, motions);
    pose.deflection[2] = remainder(pose.deflection[2], 2.0 * M_PI);
    for (size_t row = 0; row < BUSHING_ROWS; row++) {
        const double pull = bushing_pull(&own, &pose, row);
        const Vec2 force = row < 2 ? vec2_scale(pull, pose.axes[row]) : (Vec2){0.0, 0.0};
        const double moment = row < 2 ? 0.0 : pull;
        if (made->a != NULL) {
            dBodyAddForceAtPos(made->a, force.x, force.y, 0, pose.point.x, pose.point.y, 0);
            dBodyAddTorque(made->a, 0, 0, moment);
        }
        if (made->b != NULL) {
            dBodyAddForceAtPos(made->b, -force.x, -force.y, 0, pose.point.x, pose.point.y, 0);
            dBodyAddTorque(made->b, 0, 0, -moment);
        }
        if (row < 2 && made->rows[row] != NULL) {
            place_row(made, made->rows[row], &pose, row, step_s);
        }
    }
}
