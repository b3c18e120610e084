// Writes a setting as a short program against libjointplay.
//
// Bodies, hinges, sliders, motors and forces are ODE's; what has play is a joint of the library,
// and jp_world_step steps them. A body that is driven at a speed has a motor without a bound.
// Springs, and a torque over time, push where the step evaluates forces.
#include "commands/tune/tune_world.h"
#include "base/shell.h"
#include "base/zeroed.h"
#include "commands/tune/tune_bodies.h"
#include "commands/tune/tune_bushings.h"
#include "commands/tune/tune_rubs.h"
#include "contact/damping.h"
#include "contact/law.h"
#include "model/coordinate.h"
#include "model/forces.h"
#include "version.h"
#include "write/number.h"

#include <math.h>
#include <string.h>

// The head of every program, and its strings.

// Appends a string constant; what is not plain ASCII is written by its octal number.
static void tune_code_string(const char *string, Text *text)
{
    text_append(text, "\"");
    for (; *string != '\0'; string++) {
        const unsigned char letter = (unsigned char)*string;
        if (letter == '"' || letter == '\\' || letter == '?') {
            text_append(text, "\\%c", letter);
        } else if (letter < 0x20 || letter > 0x7e) {
            text_append(text, "\\%03o", letter);
        } else {
            text_append(text, "%c", letter);
        }
    }
    text_append(text, "\"");
}

// Appends the comment in front: what this is, how it is compiled (as a shell takes it), of which
// case, setting and error, and the command that does the same.
static void tune_code_head(const TuneCode *code, const char *what, const char *compile, Text *text)
{
    text_append(text,
                "// A mechanism with play in its joints in the Open Dynamics Engine, with the "
                "setting that\n// `jointplay tune` found%s. Written by jointplay %s (ODE %s).\n//\n"
                "//   cc THIS_FILE.c -o run %s && ./run > series.csv\n//\n// case     ",
                what, JOINTPLAY_VERSION, JOINTPLAY_ODE_VERSION, compile);
    // as in the command below: a name never ends the comment, nor joins the next line to it
    shell_append_word(text, scenario_path(code->scenario));
    text_append(text, "\n// setting  %s\n// error    %.3g measured", code->words, code->error);
    if (isfinite(code->target)) {
        text_append(text, ", %.3g asked for", code->target);
    }
    text_append(text, "\n// cost     %zu steps", tune_world_steps(code->scenario));
    text_append(text, "\n// same as  %s\n", code->command);
}

// The joints of a case as joints of ODE and of libjointplay.
//
// A revolute joint is ODE's hinge about z at its pivot, turned body first, so that ODE's angle is
// the joint's coordinate less what that is at the start (model/coordinate.h); a prismatic joint is
// ODE's slider along its line, with the same sign.

// The number of a joint with play among those that have some.
static size_t tune_world_number(const Linkage *linkage, int joint)
{
    size_t number = 0;
    for (int i = 0; i < joint; i++) {
        number += linkage_has_play(&linkage->joints[i]) ? 1 : 0;
    }
    return number;
}

bool tune_world_is_ideal(const Linkage *linkage, int joint)
{
    const bool is_led = linkage->driver.is_present && drive_is_steady(&linkage->driver) &&
                        linkage->driver.joint == joint;
    return joint_is_ideal(linkage->joints[joint].kind) && !is_led;
}

// The positions at the start.
static Motion *motions_of(const Linkage *linkage)
{
    Motion *motions = zeroed(linkage->body_count, sizeof *motions);
    linkage_start(linkage, motions);
    return motions;
}

// Both bodies and two numbers.
static void write_call(const Linkage *linkage, const char *name, const int bodies[2], Vec2 at,
                       Text *text)
{
    text_append(text, "%s(", name);
    tune_bodies_name(linkage, bodies[0], text);
    text_append(text, ", ");
    tune_bodies_name(linkage, bodies[1], text);
    text_append(text, ", %s, %s);\n", number_shortest(at.x).text, number_shortest(at.y).text);
}

// Appends what makes an ideal joint of ODE; nothing of a joint that is none, or that a body that is
// led turns about.
static void tune_world_ideal(const Linkage *linkage, int number, Text *text)
{
    const Joint *joint = &linkage->joints[number];
    if (!tune_world_is_ideal(linkage, number)) {
        return;
    }
    int bodies[2];
    linkage_turning(linkage, number, &bodies[0], &bodies[1]);
    Motion *motions = motions_of(linkage);
    text_append(text, "    ");
    tune_bodies_joint_name(linkage, number, text);
    text_append(text, " = ");
    if (joint_slides(joint->kind)) {
        const Vec2 along = joint_rows_along(linkage, motions, number);
        write_call(linkage, "make_slider", bodies, vec2_scale(coordinate_sense(joint), along),
                   text);
    } else {
        write_call(linkage, "make_hinge", bodies,
                   linkage_point(motions, joint->body_a, joint->anchor_a), text);
    }
    free(motions);
}

// One field of a struct that is filled in.
static void write_field(const char *name, const char *field, double value, const char *unit,
                        Text *text)
{
    text_append(text, "    %s.%s = %s;%s%s\n", name, field,
                isfinite(value) ? number_shortest(value).text
                : value < 0.0   ? "-INFINITY"
                                : "INFINITY",
                unit[0] != '\0' ? " // " : "", unit);
}

// A point in the frame of its body, where it is not at the centre.
static void tune_bodies_joint_names_write_point(const char *name, const char *field, Vec2 at,
                                                Text *text)
{
    const double numbers[2] = {at.x, at.y};
    for (int i = 0; i < 2; i++) {
        if (numbers[i] != 0.0) {
            text_append(text, "    %s.%s[%d] = %s; // m, in the frame of its body\n", name, field,
                        i, number_shortest(numbers[i]).text);
        }
    }
}

static void write_series(const char *name, const double *series, Text *text)
{
    text_append(text, "    memcpy(%s.series, (const double[]){", name);
    for (size_t i = 0; i < CONFORMING_TERMS; i++) {
        text_append(text, "%s%s,", i % 4 == 0 ? "\n        " : " ",
                    number_shortest(series[i]).text);
    }
    text_append(text, "\n    }, sizeof %s.series);\n", name);
}

// The contact of a struct of which `name` is a member that is a contact.
static bool tune_world_write_contact(const Scenario *scenario, const Joint *joint, const char *name,
                                     Text *text, Err *err)
{
#define WRITTEN_DAMPING(name, ...) "JP_DAMPING_" #name,
    static const char *const DAMPINGS[] = {OPTIONS_DAMPING_LIST(WRITTEN_DAMPING)};
    const ContactOptions own = law_options(&scenario->contact, joint);
    const bool is_turn = linkage_is_torsional(joint);
    ForceLaw law;
    if (!law_of_joint(scenario, joint, &law, err)) {
        return false;
    }
    if (law.family == FORCE_LAW_POWER) {
        const bool is_linear = law.exponent == 1.0;
        write_field(name, "stiffness", law.stiffness,
                    !is_linear ? "N/m^exponent"
                    : is_turn  ? "N m/rad"
                               : "N/m",
                    text);
        if (!is_linear) {
            write_field(name, "exponent", law.exponent, "", text);
        }
    } else if (law.family == FORCE_LAW_LOGARITHMIC) {
        write_field(name, "compliance", law.compliance, "m/N: depth = A F (B - ln F)", text);
        write_field(name, "offset", law.offset, "", text);
    } else {
        write_field(name, "stiffness", law.conforming.stiffness, "N/m: force = k depth / W", text);
        write_field(name, "play", law.conforming.play, "m", text);
        write_series(name, law.conforming.series, text);
    }
    text_append(text, "    %s.damping = %s;\n", name, DAMPINGS[own.damping]);
    if (law.viscous > 0.0) {
        write_field(name, "damper", law.viscous, is_turn ? "N m s/rad" : "N s/m", text);
    }
    if (own.damping == DAMPING_STEP) {
        write_field(name, "full_damping_depth", law.full_damping_depth, is_turn ? "rad" : "m",
                    text);
    } else if (own.damping == DAMPING_DISSIPATION) {
        write_field(name, "dissipation", law_dissipation(&law), is_turn ? "s/rad" : "s/m", text);
        return true;
    } else if (damping_restores(own.damping)) {
        write_field(name, "restitution", own.restitution, "", text);
    }
    write_field(name, "speed_floor", law.impact_speed_floor, is_turn ? "rad/s" : "m/s", text);
    if (law.resting_speed > 0.0) {
        write_field(name, "resting_speed", law.resting_speed, is_turn ? "rad/s" : "m/s", text);
    }
    return true;
}

// What a joint of the library is made from: the name of its options, of the contact in these, and
// what it is made on.
typedef struct Made {
    Text options;
    Text contact;
    Text on;
} Made;

// Begins with the joint's name and "    JpStops stops_0 = jp_stops_default();".
static Made begin_made(const Linkage *linkage, int joint, const char *type, const char *what,
                       const char *contact, Text *text)
{
    Made made;
    text_init(&made.options);
    text_init(&made.contact);
    text_init(&made.on);
    text_append(&made.options, "%s_%zu", what, tune_world_number(linkage, joint));
    text_append(&made.contact, "%s.%s", made.options.data, contact);
    text_append(text, "\n    // ");
    tune_code_string(linkage->joints[joint].name, text);
    text_append(text, "\n    %s %s = jp_%s_default();\n", type, made.options.data, what);
    return made;
}

// What the contacts of a joint bring along at the start.
static void write_begun(const Linkage *linkage, int joint, Text *text)
{
    const Joint *of = &linkage->joints[joint];
    const char *unit = linkage_is_torsional(of) ? "rad/s" : "m/s";
    for (size_t i = 0; i < JOINT_PLACES; i++) {
        const ContactState *state = &of->contacts[i];
        if (state->is_touching) {
            text_append(text,
                        "    const JpBegun begun_%zu_%zu = {\n"
                        "        .impact_speed = %s, // %s\n        .age = %s, // s\n"
                        "        .is_released = %s,\n        .is_resting = %s,\n    };\n",
                        tune_world_number(linkage, joint), i,
                        number_shortest(state->impact_speed).text, unit,
                        number_shortest(state->age_s).text, state->is_released ? "true" : "false",
                        state->is_resting ? "true" : "false");
            text_append(text,
                        "    check(jp_joint_begun(plays[%zu], %zu, &begun_%zu_%zu, &error), "
                        "&error);\n",
                        tune_world_number(linkage, joint), i, tune_world_number(linkage, joint), i);
        }
    }
}

// Ends with the call that makes the joint.
static void end_made(Made *made, const Linkage *linkage, int joint, const char *what, Text *text)
{
    text_append(text, "    check(jp_%s_create(play, %s, &%s, &plays[%zu], &error), &error);\n",
                what, made->on.data, made->options.data, tune_world_number(linkage, joint));
    write_begun(linkage, joint, text);
    text_finish(&made->options);
    text_finish(&made->contact);
    text_finish(&made->on);
}

// Friction that sticks.
static void write_bristle(const Linkage *linkage, const Joint *joint, const ContactOptions *contact,
                          const char *pin, Text *text)
{
    if (contact->friction_law != BRISTLE_STICK) {
        return;
    }
    const double mass = tune_bodies_bristle_mass(linkage, joint);
    text_append(text, "    %s.friction_law = JP_FRICTION_STICK;\n", pin);
    write_field(pin, "presliding", contact->presliding, "m", text);
    write_field(pin, "breakaway_ratio", contact->breakaway_ratio, "", text);
    write_field(pin, "presliding_damping", contact->presliding_damping, "", text);
    if (mass > 0.0) {
        write_field(pin, "presliding_mass", mass, "kg", text);
    }
}

static bool tune_world_write_pin(const Scenario *scenario, int number, Text *text, Err *err)
{
    const Linkage *linkage = &scenario->linkage;
    const Joint *joint = &linkage->joints[number];
    const ContactOptions contact = law_options(&scenario->contact, joint);
    Made made = begin_made(linkage, number, "JpPinInHole", "pin", "contact", text);
    const char *pin = made.options.data;
    write_field(pin, "hole_radius", joint->clearance.hole_radius, "m", text);
    write_field(pin, "pin_radius", joint->clearance.pin_radius, "m", text);
    tune_bodies_joint_names_write_point(
        pin, "hole", tune_bodies_local(linkage, joint->body_a, joint->anchor_a), text);
    tune_bodies_joint_names_write_point(
        pin, "pin", tune_bodies_local(linkage, joint->body_b, joint->anchor_b), text);
    const bool is_done = tune_world_write_contact(scenario, joint, made.contact.data, text, err);
    if (contact.friction > 0.0) {
        write_field(pin, "friction", contact.friction, "", text);
        write_field(pin, "friction_speed", contact.friction_speed, "m/s", text);
        write_bristle(linkage, joint, &contact, pin, text);
    }
    tune_bodies_name(linkage, joint->body_a, &made.on);
    text_append(&made.on, ", ");
    tune_bodies_name(linkage, joint->body_b, &made.on);
    end_made(&made, linkage, number, "pin", text);
    return is_done;
}

// Flanks with a gap, or stops, on an ideal joint of ODE.
static bool tune_world_write_limits(const Scenario *scenario, int number, Text *text, Err *err)
{
    const Linkage *linkage = &scenario->linkage;
    const Joint *joint = &linkage->joints[number];
    const bool is_backlash = joint->limits.kind == LIMIT_BACKLASH;
    const char *what = is_backlash ? "backlash" : "stops";
    const char *unit = joint_has_angle(joint->kind) ? "rad" : "m";
    Motion *motions = motions_of(linkage);
    const double start = coordinate_position(linkage, motions, number);
    free(motions);
    Made made = begin_made(linkage, number, is_backlash ? "JpBacklash" : "JpStops", what,
                           is_backlash ? "tooth" : "contact", text);
    const char *limits = made.options.data;
    if (is_backlash) {
        write_field(limits, "gap", joint->limits.backlash, unit, text);
        write_field(limits, "offset", joint->limits.middle - start, unit, text);
    } else {
        write_field(limits, "low", joint->limits.low - start, unit, text);
        write_field(limits, "high", joint->limits.high - start, unit, text);
    }
    const bool is_done = tune_world_write_contact(scenario, joint, made.contact.data, text, err);
    tune_bodies_joint_name(linkage, number, &made.on);
    end_made(&made, linkage, number, what, text);
    return is_done;
}

// Appends what makes a joint of the library of one with play; nothing of others. Fails with
// ERR_CASE where a law does not fit its joint.
static bool tune_world_play(const Scenario *scenario, int joint, Text *text, Err *err)
{
    const Joint *of = &scenario->linkage.joints[joint];
    if (joint_has_hole(of->kind)) {
        return tune_world_write_pin(scenario, joint, text, err);
    }
    return of->limits.kind == LIMIT_NONE || tune_world_write_limits(scenario, joint, text, err);
}

// Springs, dampers and drives in a world of ODE that libjointplay steps.
//
// A body that is driven at constant speed has no dynamics in ODE. A drive at a speed over time is a
// hinge's motor without a bound, at the speed at the step's end. A damper
// acts on the mean of the speeds before and after the step, -c (r + r') / 2, as a row
//     r' + (2/c) f = -r
// of a hinge's motor or, along a line, of a distance joint, whose right-hand side is ERP/h (wanted
// distance - distance). Springs and a torque push at mid-step, where the world calls `collide`.

bool tune_world_has_effect(const Linkage *linkage, const TorsionSpring *spring)
{
    return !linkage->driver.is_present || linkage->driver.joint != spring->joint;
}

bool tune_world_pushes(const Linkage *linkage)
{
    bool is_any =
        linkage->spring_count > 0 || linkage->bushing_count > 0 || linkage->torque.table.count > 0;
    for (size_t i = 0; i < linkage->torsion_count; i++) {
        const TorsionSpring *spring = &linkage->torsions[i];
        is_any = is_any || (tune_world_has_effect(linkage, spring) && spring->stiffness > 0.0);
    }
    return is_any;
}

static void write_point(double time_s, double value, Text *text)
{
    text_append(text, " {%s, %s},", number_shortest(time_s).text, number_shortest(value).text);
}

// Of a table that repeats the points of one period from time zero on.
static void tune_world_write_table(const char *name, const TimeTable *table, const char *unit,
                                   Text *text)
{
    text_append(text, "\nstatic const double %s[][2] = { // s, %s\n   ", name, unit);
    const bool repeats = table->period_s > 0.0;
    if (repeats && table->times[0] > 0.0) {
        write_point(0.0, time_table_at(table, 0.0), text);
    }
    for (size_t i = 0; i < table->count; i++) {
        write_point(table->times[i], table->values[i], text);
    }
    if (repeats) {
        write_point(table->period_s, time_table_at(table, 0.0), text);
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

static void tune_world_forces_write_point(const Linkage *linkage, int body, Vec2 at, Text *text)
{
    const Vec2 local = tune_bodies_local(linkage, body, at);
    tune_bodies_name(linkage, body, text);
    text_append(text, ", %s, %s, ", number_shortest(local.x).text, number_shortest(local.y).text);
}

static void tune_world_write_springs(const Linkage *linkage, Text *text)
{
    for (size_t i = 0; i < linkage->spring_count; i++) {
        const Spring *spring = &linkage->springs[i];
        if (spring->damping > 0.0) {
            text_append(text, "    pull(damper_%zu, ", i);
        } else {
            text_append(text, "    pull(NULL, ");
        }
        tune_world_forces_write_point(linkage, spring->body_a, spring->anchor_a, text);
        tune_world_forces_write_point(linkage, spring->body_b, spring->anchor_b, text);
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
        tune_bodies_joint_name(linkage, spring->joint, text);
        text_append(
            text, ", %s * (%s - dJointGetHingeAngle(", number_shortest(spring->stiffness).text,
            number_shortest(spring->angle - tune_world_angle_at_start(linkage, spring->joint))
                .text);
        tune_bodies_joint_name(linkage, spring->joint, text);
        text_append(text, "))); // within half a turn\n");
    }
}

static void tune_world_write_torque(const Linkage *linkage, Text *text)
{
    const Torque *torque = &linkage->torque;
    if (torque->table.count == 0) {
        return;
    }
    const bool is_hinge = joint_has_angle(linkage->joints[torque->joint].kind);
    text_append(text, "    %s(", is_hinge ? "dJointAddHingeTorque" : "dJointAddSliderForce");
    tune_bodies_joint_name(linkage, torque->joint, text);
    text_append(text, ", at(DRIVE, sizeof DRIVE / sizeof *DRIVE, middle));\n");
}

// Appends the function that pushes there, with what it needs; and the tables over time.
static void tune_world_push(const Linkage *linkage, Text *text)
{
    const TimeTable *speeds = &linkage->driver.table;
    const TimeTable *torques = &linkage->torque.table;
    if (speeds->count > 0) {
        tune_world_write_table("DRIVE", speeds, "rad/s", text);
    }
    if (torques->count > 0) {
        const bool is_hinge = joint_has_angle(linkage->joints[linkage->torque.joint].kind);
        tune_world_write_table("DRIVE", torques, is_hinge ? "N m" : "N", text);
        text_append(text, "static double middle; // s, of the step under way\n");
    }
    text_append(text, "%s", speeds->count + torques->count > 0 ? AT : "");
    text_append(text, "%s", linkage->spring_count > 0 ? SPRING : "");
    for (size_t i = 0; i < linkage->spring_count; i++) {
        if (linkage->springs[i].damping > 0.0) {
            text_append(text, "\nstatic dJointID damper_%zu;\n", i);
        }
    }
    tune_bushings_write_functions(linkage, text);
    if (tune_world_pushes(linkage)) {
        text_append(text, "\n// where the step evaluates forces\n"
                          "static void push(dWorldID pushed, void *data)\n{\n"
                          "    (void)pushed;\n    (void)data;\n");
        tune_world_write_springs(linkage, text);
        tune_bushings_write_pushing(linkage, text);
        write_torsions(linkage, text);
        tune_world_write_torque(linkage, text);
        text_append(text, "}\n");
    }
}

static void write_param(const Linkage *linkage, int joint, const char *param, const char *value,
                        Text *text)
{
    text_append(text, "    dJointSetHingeParam(");
    tune_bodies_joint_name(linkage, joint, text);
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
    tune_bodies_name(linkage, bodies[first], text);
    text_append(text, ", ");
    tune_bodies_name(linkage, bodies[1 - first], text);
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

// Appends what is set once, when bodies and hinges are made.
static void tune_world_motors(const Linkage *linkage, Text *text)
{
    const Driver *driver = &linkage->driver;
    const int driven = linkage_driven_body(linkage);
    if (tune_bodies_is_led(linkage, driven)) {
        text_append(text, "    dBodySetKinematic(");
        tune_bodies_name(linkage, driven, text);
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
    tune_bushings_write_making(linkage, text);
}

// Appends what is set before each step.
static void tune_world_drive(const Linkage *linkage, Text *text)
{
    if (linkage->driver.table.count > 0) {
        const double period_s = linkage->driver.table.period_s;
        Text speed;
        text_init(&speed);
        text_append(&speed, "at(DRIVE, sizeof DRIVE / sizeof *DRIVE, ");
        if (period_s > 0.0) {
            text_append(&speed, "fmod((i + 1) * STEP, %s))", number_shortest(period_s).text);
        } else {
            text_append(&speed, "(i + 1) * STEP)");
        }
        text_append(text, "    ");
        write_param(linkage, linkage->driver.joint, "dParamVel", speed.data, text);
        text_finish(&speed);
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
            tune_bodies_joint_name(linkage, spring->joint, &rate);
            text_append(&rate, ")");
            text_append(text, "    ");
            write_param(linkage, spring->joint, "dParamVel", rate.data, text);
            text_finish(&rate);
        }
    }
}

double tune_world_every(const Scenario *scenario)
{
    return fmax(1.0, round(scenario_sample_time(scenario, 1) / scenario->run.step));
}

static void write_includes(const Scenario *scenario, Text *text)
{
    const double step_s = scenario->run.step;
    const double every = tune_world_every(scenario);
    text_append(text,
                "\n#include <jointplay/jointplay.h>\n#include <math.h>\n#include <stdio.h>\n"
                "#include <stdlib.h>\n"
                "#include <string.h>\n\n"
                "static const double STEP = %s; // s\n"
                "static const int STEPS = %zu, EVERY = %.0f; // from line to line\n\n"
                "static dWorldID world;\n",
                number_shortest(step_s).text, tune_world_steps(scenario), every);
}

// The bodies and joints, which main makes.
static void tune_world_write_names(const Linkage *linkage, Text *text)
{
    text_append(text, "static dBodyID ");
    for (int i = 0; i < (int)linkage->body_count; i++) {
        text_append(text, "%s", i > 0 ? ", " : "");
        tune_bodies_name(linkage, i, text);
    }
    text_append(text, ";\n");
    bool is_first = true;
    for (int i = 0; i < (int)linkage->joint_count; i++) {
        if (tune_world_is_ideal(linkage, i)) {
            text_append(text, "%s", is_first ? "static dJointID " : ", ");
            tune_bodies_joint_name(linkage, i, text);
            is_first = false;
        }
    }
    text_append(text, "%s", is_first ? "" : ";\n");
}

// Whether the program makes a joint of ODE of one of some kinds.
static bool makes(const Linkage *linkage, JointKinds kinds)
{
    for (int i = 0; i < (int)linkage->joint_count; i++) {
        if (joint_is_among(linkage->joints[i].kind, kinds) && tune_world_is_ideal(linkage, i)) {
            return true;
        }
    }
    return false;
}

static const char MAKE_BODY[] =
    "\n// kg, kg m^2; m, rad; m/s, rad/s\n"
    "static dBodyID make_body(double mass, double inertia, double x, double y, double angle,\n"
    "                         double vx, double vy, double omega)\n{\n"
    "    const dBodyID body = dBodyCreate(world);\n"
    "    dMass in_plane;\n"
    "    dMassSetParameters(&in_plane, mass, 0, 0, 0, inertia, inertia, inertia, 0, 0, 0);\n"
    "    dBodySetMass(body, &in_plane);\n"
    "    dBodySetPosition(body, x, y, 0);\n"
    "    dBodySetQuaternion(body, (dQuaternion){cos(0.5 * angle), 0, 0, sin(0.5 * angle)});\n"
    "    dBodySetLinearVel(body, vx, vy, 0);\n"
    "    dBodySetAngularVel(body, 0, 0, omega);\n"
    "    dBodySetFiniteRotationMode(body, 1); // plain steps would turn it by their first order\n"
    "    return body;\n}\n";

static const char MAKE_HINGE[] =
    "\n// about z, at a point; NULL is the world\n"
    "static dJointID make_hinge(dBodyID first, dBodyID second, double x, double y)\n{\n"
    "    const dJointID hinge = dJointCreateHinge(world, 0);\n"
    "    dJointAttach(hinge, first, second);\n"
    "    dJointSetHingeAnchor(hinge, x, y, 0);\n"
    "    dJointSetHingeAxis(hinge, 0, 0, 1);\n"
    "    return hinge;\n}\n";

static const char MAKE_SLIDER[] =
    "\n// along a direction; NULL is the world\n"
    "static dJointID make_slider(dBodyID first, dBodyID second, double x, double y)\n{\n"
    "    const dJointID slider = dJointCreateSlider(world, 0);\n"
    "    dJointAttach(slider, first, second);\n"
    "    dJointSetSliderAxis(slider, x, y, 0);\n"
    "    return slider;\n}\n";

static const char CHECK[] = "\nstatic void check(JpStatus status, const JpError *error)\n{\n"
                            "    if (status > JP_OK) { // JP_COARSE is counted below\n"
                            "        fprintf(stderr, \"%s\\n\", error->text);\n"
                            "        exit(4);\n    }\n}\n";

static const char PRINT_ROW[] =
    "\nstatic void print_row(double time, const dBodyID *bodies, int count)\n{\n"
    "    printf(\"%.17g\", time);\n"
    "    for (int i = 0; i < count; i++) {\n"
    "        const dReal *at = dBodyGetPosition(bodies[i]);\n"
    "        const dReal *v = dBodyGetLinearVel(bodies[i]);\n"
    "        const dReal *turn = dBodyGetQuaternion(bodies[i]);\n"
    "        printf(\",%.17g,%.17g,%.17g\", at[0], at[1], 2 * atan2(turn[3], turn[0]));\n"
    "        printf(\",%.17g,%.17g,%.17g\", v[0], v[1], dBodyGetAngularVel(bodies[i])[2]);\n"
    "    }\n    putchar('\\n');\n}\n";

static void write_functions(const Scenario *scenario, Text *text)
{
    const Linkage *linkage = &scenario->linkage;
    text_append(text, "%s", MAKE_BODY);
    text_append(text, "%s", makes(linkage, JOINTS_THAT_PIVOT) ? MAKE_HINGE : "");
    text_append(text, "%s", makes(linkage, JOINTS_THAT_SLIDE) ? MAKE_SLIDER : "");
    tune_world_push(linkage, text);
    text_append(text, "%s%s", CHECK, PRINT_ROW);
}

static void tune_world_write_body(const Linkage *linkage, int number, Text *text)
{
    const Body *body = &linkage->bodies[number];
    const bool is_led = tune_bodies_is_led(linkage, number);
    const Motion *start = &body->start;
    const Vec2 at = is_led ? linkage->joints[linkage->driver.joint].anchor_a : start->position;
    const Vec2 speed = is_led ? (Vec2){0.0, 0.0} : start->velocity;
    const double numbers[] = {body->mass,   body->inertia, at.x,    at.y,
                              start->angle, speed.x,       speed.y, start->omega};
    text_append(text, "    ");
    tune_bodies_name(linkage, number, text);
    text_append(text, " = make_body(");
    for (size_t i = 0; i < sizeof numbers / sizeof *numbers; i++) {
        text_append(text, "%s%s",
                    i == 0   ? ""
                    : i == 2 ? ",\n        "
                             : ", ",
                    number_shortest(numbers[i]).text);
    }
    text_append(text, ");\n");
}

static void write_world(const Scenario *scenario, Text *text)
{
    const Linkage *linkage = &scenario->linkage;
    const bool is_plain = scenario->ode.stepping == ODE_PLAIN;
    text_append(text,
                "\nint main(void)\n{\n    dInitODE2(0);\n    world = dWorldCreate();\n"
                "    dWorldSetGravity(world, %s, %s, 0);\n"
                "    dWorldSetERP(world, %s); // of ODE's joints\n",
                number_shortest(0.0 + scenario->gravity.x).text,
                number_shortest(0.0 + scenario->gravity.y).text,
                number_shortest(is_plain ? scenario->ode.erp : TUNE_WORLD_ERP).text);
    for (int i = 0; i < (int)linkage->body_count; i++) {
        tune_world_write_body(linkage, i, text);
    }
    for (int i = 0; i < (int)linkage->joint_count; i++) {
        tune_world_ideal(linkage, i, text);
    }
    tune_world_motors(linkage, text);
}

static bool tune_world_write_play(const Scenario *scenario, Text *text, Err *err)
{
    const Linkage *linkage = &scenario->linkage;
    const OdeOptions *ode = &scenario->ode;
    const bool is_impulse = scenario_integrates_contacts(scenario);
    text_append(text,
                "\n    JpError error;\n    JpWorld *play;\n"
                "    JpWorldOptions options = jp_world_options_default();\n"
                "    options.stepping = %s;\n",
                is_impulse                   ? "JP_STEPPING_IMPULSE"
                : ode->stepping == ODE_PLAIN ? "JP_STEPPING_PLAIN"
                                             : "JP_STEPPING_STAGGERED");
    if (ode->solver == ODE_QUICK && !is_impulse) {
        text_append(text,
                    "    options.is_quick = true;\n"
                    "    dWorldSetQuickStepNumIterations(world, %zu);\n"
                    "    dWorldSetQuickStepW(world, %s);\n",
                    ode->iterations, number_shortest(ode->over_relaxation).text);
    }
    if (tune_world_pushes(linkage)) {
        text_append(text, "    options.collide = push;\n");
    }
    text_append(text, "    check(jp_world_create(world, &options, &play, &error), &error);\n");
    if (scenario_has_clearance(scenario)) {
        text_append(text, "    JpJoint *plays[%zu];\n",
                    tune_world_number(linkage, (int)linkage->joint_count));
    }
    for (int i = 0; i < (int)linkage->joint_count; i++) {
        if (!tune_world_play(scenario, i, text, err)) {
            return false;
        }
    }
    tune_rubs_write(scenario, text);
    return true;
}

// The bodies as a list, all of them known to the library, and the head of the table.
static void write_list(const Linkage *linkage, Text *text)
{
    text_append(text, "\n    const dBodyID bodies[] = {");
    for (int i = 0; i < (int)linkage->body_count; i++) {
        text_append(text, "%s", i > 0 ? ", " : "");
        tune_bodies_name(linkage, i, text);
    }
    text_append(text, "};\n    const int count = sizeof bodies / sizeof *bodies;\n"
                      "    for (int i = 0; i < count; i++) {\n"
                      "        check(jp_world_add_body(play, bodies[i], &error), &error);\n    }\n"
                      "    puts(\"time_s\"");
    for (size_t i = 0; i < linkage->body_count; i++) {
        Text head;
        text_init(&head);
        const char *name = linkage->bodies[i].name;
        // a body that is led stands at its pivot
        const char *of = tune_bodies_is_led(linkage, (int)i) ? "_pivot" : "";
        text_append(&head, ",%s%s_x_m,%s%s_y_m,%s_angle_rad,%s%s_vx_m_s,%s%s_vy_m_s,", name, of,
                    name, of, name, name, of, name, of);
        text_append(&head, "%s_omega_rad_s", name);
        text_append(text, "\n         ");
        tune_code_string(head.data, text);
        text_finish(&head);
    }
    text_append(text, ");\n");
}

static void write_loop(const Linkage *linkage, Text *text)
{
    text_append(text, "    print_row(0, bodies, count);\n"
                      "    for (int i = 0; i < STEPS; i++) {\n");
    tune_world_drive(linkage, text);
    text_append(text, "        check(jp_world_step(play, STEP, &error), &error);\n"
                      "        if ((i + 1) %% EVERY == 0) {\n"
                      "            print_row((i + 1) * STEP, bodies, count);\n        }\n    }\n");
}

// What a joint with play has seen, on the error stream.
static void write_state(const Linkage *linkage, int number, Text *text)
{
    const Joint *joint = &linkage->joints[number];
    const bool is_pin = joint_has_hole(joint->kind);
    const size_t play = tune_world_number(linkage, number);
    text_append(text, "    %s state_%zu;\n    check(%s(plays[%zu], &state_%zu, &error), &error);\n",
                is_pin ? "JpPinState" : "JpJointState", play,
                is_pin ? "jp_pin_state" : "jp_joint_state", play, play);
    text_append(text, "    fprintf(stderr, \"%%s: %%zu impacts, up to %%.4g %s\\n\", ",
                linkage_is_torsional(joint) ? "N m" : "N");
    tune_code_string(joint->name, text);
    if (is_pin) {
        text_append(text,
                    ", state_%zu.ends[0].impacts,\n            state_%zu.ends[0].force_max);\n",
                    play, play);
    } else {
        text_append(text,
                    ",\n            state_%zu.low.impacts + state_%zu.high.impacts,\n"
                    "            fmax(state_%zu.low.force_max, state_%zu.high.force_max));\n",
                    play, play, play, play);
    }
}

static void write_end(const Linkage *linkage, Text *text)
{
    for (int i = 0; i < (int)linkage->joint_count; i++) {
        if (linkage_has_play(&linkage->joints[i])) {
            write_state(linkage, i, text);
        }
    }
    text_append(text, "    JpWorldStats stats;\n    check(jp_world_stats(play, &stats, &error), "
                      "&error);\n    fprintf(stderr, \"%%zu steps, %%zu of ODE, %%zu "
                      "fallbacks, %%zu coarse\\n\", stats.steps, stats.world_steps,\n"
                      "            stats.fallbacks, stats.coarse);\n"
                      "    jp_world_destroy(play);\n    dWorldDestroy(world);\n    dCloseODE();\n"
                      "    return fflush(stdout) == 0 ? 0 : 5;\n}\n");
}

bool tune_world_write(const TuneCode *code, Text *text, Err *err)
{
    const Scenario *scenario = code->scenario;
    const Linkage *linkage = &scenario->linkage;
    tune_code_head(code, ", as a world of libjointplay",
                   "$(pkg-config --cflags --libs jointplay) -lm", text);
    text_append(text, "//\n// The error is this program's own, of all bodies and joints at the "
                      "times that it prints, against\n// jointplay's reference.");
    if (scenario->run.step < code->step_first_s) {
        text_append(text,
                    " With the setting's step of %s s it is %.3g:\n"
                    "// the step was shortened to %s s.",
                    number_shortest(code->step_first_s).text, code->error_first,
                    number_shortest(scenario->run.step).text);
    }
    text_append(text, "\n");
    write_includes(scenario, text);
    tune_world_write_names(linkage, text);
    write_functions(scenario, text);
    write_world(scenario, text);
    if (!tune_world_write_play(scenario, text, err)) {
        return false;
    }
    write_list(linkage, text);
    write_loop(linkage, text);
    write_end(linkage, text);
    return true;
}
