// How are joints of a case written as joints of ODE and of libjointplay?
//
// A revolute joint is ODE's hinge about z at its pivot, turned body first, so that ODE's angle is
// the joint's coordinate less what that is at the start (model/coordinate.h); a prismatic joint is
// ODE's slider along its line, with the same sign.
#include "commands/tune/tune_world_joints.h"

#include "base/zeroed.h"
#include "commands/tune/tune_code_text.h"
#include "contact/law.h"
#include "model/coordinate.h"
#include "write/number.h"

#include <math.h>
#include <string.h>

static void write_plain(const char *name, Text *text)
{
    for (const char *letter = name; *letter != '\0'; letter++) {
        const bool is_plain = (*letter >= 'a' && *letter <= 'z') ||
                              (*letter >= 'A' && *letter <= 'Z') ||
                              (*letter >= '0' && *letter <= '9');
        text_append(text, "%c", is_plain ? *letter : '_');
    }
}

// Whether two names are one where all but letters and digits is one sign.
static bool are_alike(const char *a, const char *b)
{
    Text first;
    Text second;
    text_init(&first);
    text_init(&second);
    write_plain(a, &first);
    write_plain(b, &second);
    const bool is_same =
        first.length == second.length && strncmp(first.data, second.data, first.length) == 0;
    text_finish(&first);
    text_finish(&second);
    return is_same;
}

typedef enum Named { BODIES, JOINTS } Named;

static const char *name_of(const Linkage *linkage, Named named, int number)
{
    return named == BODIES ? linkage->bodies[number].name : linkage->joints[number].name;
}

// The name in letters and digits, with the number behind it where another would be the same.
static void write_unique(const Linkage *linkage, Named named, int number, Text *text)
{
    const size_t count = named == BODIES ? linkage->body_count : linkage->joint_count;
    const char *name = name_of(linkage, named, number);
    write_plain(name, text);
    for (int i = 0; i < (int)count; i++) {
        if (i != number && are_alike(name_of(linkage, named, i), name)) {
            text_append(text, "_%d", number);
            return;
        }
    }
}

void tune_world_body(const Linkage *linkage, int body, Text *text)
{
    if (body == LINKAGE_GROUND) {
        text_append(text, "NULL");
        return;
    }
    text_append(text, "body_");
    write_unique(linkage, BODIES, body, text);
}

void tune_world_joint(const Linkage *linkage, int joint, Text *text)
{
    text_append(text, "joint_");
    write_unique(linkage, JOINTS, joint, text);
}

size_t tune_world_number(const Linkage *linkage, int joint)
{
    size_t number = 0;
    for (int i = 0; i < joint; i++) {
        number += linkage_has_play(&linkage->joints[i]) ? 1 : 0;
    }
    return number;
}

bool tune_world_is_led(const Linkage *linkage, int body)
{
    return body != LINKAGE_GROUND && body == linkage_driven_body(linkage) &&
           drive_is_steady(&linkage->driver);
}

Vec2 tune_world_local(const Linkage *linkage, int body, Vec2 local)
{
    const int joint = linkage->driver.joint;
    return tune_world_is_led(linkage, body)
               ? vec2_sub(local, linkage_end(&linkage->joints[joint], 1).anchor)
               : local;
}

bool tune_world_is_ideal(const Linkage *linkage, int joint)
{
    const bool is_led = linkage->driver.is_present && drive_is_steady(&linkage->driver) &&
                        linkage->driver.joint == joint;
    return linkage_kind_is_ideal(linkage->joints[joint].kind) && !is_led;
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
    tune_world_body(linkage, bodies[0], text);
    text_append(text, ", ");
    tune_world_body(linkage, bodies[1], text);
    text_append(text, ", %s, %s);\n", number_shortest(at.x).text, number_shortest(at.y).text);
}

void tune_world_ideal(const Linkage *linkage, int number, Text *text)
{
    const Joint *joint = &linkage->joints[number];
    if (!tune_world_is_ideal(linkage, number)) {
        return;
    }
    int bodies[2];
    linkage_turning(linkage, number, &bodies[0], &bodies[1]);
    Motion *motions = motions_of(linkage);
    text_append(text, "    ");
    tune_world_joint(linkage, number, text);
    text_append(text, " = ");
    if (joint->kind == JOINT_PRISMATIC) {
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
static void write_point(const char *name, const char *field, Vec2 at, Text *text)
{
    const double numbers[2] = {at.x, at.y};
    for (int i = 0; i < 2; i++) {
        if (numbers[i] != 0.0) {
            text_append(text, "    %s.%s[%d] = %s; // m, in the frame of its body\n", name, field,
                        i, number_shortest(numbers[i]).text);
        }
    }
}

// The contact of a struct of which `name` is a member that is a contact.
static bool write_contact(const Scenario *scenario, const Joint *joint, const char *name,
                          Text *text, Err *err)
{
#define WRITTEN_DAMPING(name, word, factor) "JP_DAMPING_" #name,
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
    } else {
        write_field(name, "compliance", law.compliance, "m/N: depth = A F (B - ln F)", text);
        write_field(name, "offset", law.offset, "", text);
    }
    text_append(text, "    %s.damping = %s;\n", name, DAMPINGS[own.damping]);
    if (own.damping == DAMPING_VISCOUS) {
        write_field(name, "damper", law.viscous, is_turn ? "N m s/rad" : "N s/m", text);
    } else if (own.damping != DAMPING_NONE) {
        write_field(name, "restitution", own.restitution, "", text);
    }
    write_field(name, "speed_floor", law.impact_speed_floor, is_turn ? "rad/s" : "m/s", text);
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

// Ends with the call that makes the joint.
static void end_made(Made *made, const Linkage *linkage, int joint, const char *what, Text *text)
{
    text_append(text, "    check(jp_%s_create(play, %s, &%s, &plays[%zu], &error), &error);\n",
                what, made->on.data, made->options.data, tune_world_number(linkage, joint));
    text_finish(&made->options);
    text_finish(&made->contact);
    text_finish(&made->on);
}

static bool write_pin(const Scenario *scenario, int number, Text *text, Err *err)
{
    const Linkage *linkage = &scenario->linkage;
    const Joint *joint = &linkage->joints[number];
    const ContactOptions contact = law_options(&scenario->contact, joint);
    Made made = begin_made(linkage, number, "JpPinInHole", "pin", "contact", text);
    const char *pin = made.options.data;
    write_field(pin, "hole_radius", joint->clearance.hole_radius, "m", text);
    write_field(pin, "pin_radius", joint->clearance.pin_radius, "m", text);
    write_point(pin, "hole", tune_world_local(linkage, joint->body_a, joint->anchor_a), text);
    write_point(pin, "pin", tune_world_local(linkage, joint->body_b, joint->anchor_b), text);
    const bool is_done = write_contact(scenario, joint, made.contact.data, text, err);
    if (contact.friction > 0.0) {
        write_field(pin, "friction", contact.friction, "", text);
        write_field(pin, "friction_speed", contact.friction_speed, "m/s", text);
    }
    tune_world_body(linkage, joint->body_a, &made.on);
    text_append(&made.on, ", ");
    tune_world_body(linkage, joint->body_b, &made.on);
    end_made(&made, linkage, number, "pin", text);
    return is_done;
}

// Flanks with a gap, or stops, on an ideal joint of ODE.
static bool write_limits(const Scenario *scenario, int number, Text *text, Err *err)
{
    const Linkage *linkage = &scenario->linkage;
    const Joint *joint = &linkage->joints[number];
    const bool is_backlash = joint->limits.kind == LIMIT_BACKLASH;
    const char *what = is_backlash ? "backlash" : "stops";
    const char *unit = joint->kind == JOINT_REVOLUTE ? "rad" : "m";
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
    const bool is_done = write_contact(scenario, joint, made.contact.data, text, err);
    tune_world_joint(linkage, number, &made.on);
    end_made(&made, linkage, number, what, text);
    return is_done;
}

bool tune_world_play(const Scenario *scenario, int joint, Text *text, Err *err)
{
    const Joint *of = &scenario->linkage.joints[joint];
    if (of->kind == JOINT_CLEARANCE) {
        return write_pin(scenario, joint, text, err);
    }
    return of->limits.kind == LIMIT_NONE || write_limits(scenario, joint, text, err);
}
