// Finds and writes the friction of ideal joints for programs against libjointplay, which holds what
// sticks by a row of ODE and has no bristle.
#include "commands/tune/tune_rubs.h"

#include "commands/tune/tune_bodies.h"
#include "model/joint_friction.h"
#include "write/number.h"

static bool rubs(const Linkage *linkage, int joint)
{
    return linkage_is_ideal(linkage, (size_t)joint) && joint_friction_is(&linkage->joints[joint]);
}

bool tune_rubs_find(const Scenario *scenario, int joint, JpFriction *friction)
{
    const Joint *of = &scenario->linkage.joints[joint];
    if (!rubs(&scenario->linkage, joint)) {
        return false;
    }
    const BristlePair pair = joint_friction_pair(&scenario->contact, of);
    const bool is_steady = of->friction.steady > 0.0;
    *friction = jp_friction_default();
    friction->steady = of->friction.steady;
    friction->coefficient = is_steady ? 0.0 : of->contact.friction;
    friction->radius = is_steady || joint_slides(of->kind) ? 0.0 : joint_friction_radius(of);
    friction->law = pair.law == BRISTLE_REGULARIZED ? JP_FRICTION_REGULARIZED : JP_FRICTION_STICK;
    friction->speed = pair.speed;
    friction->breakaway_ratio = pair.law == BRISTLE_REGULARIZED ? 1.0 : pair.ratio;
    return true;
}

static void write_field(size_t number, const char *field, double value, const char *unit,
                        Text *text)
{
    text_append(text, "    friction_%zu.%s = %s;%s%s\n", number, field, number_shortest(value).text,
                unit[0] != '\0' ? " // " : "", unit);
}

static void write_one(const Linkage *linkage, int joint, const JpFriction *friction, size_t number,
                      Text *text)
{
    const bool slides = joint_slides(linkage->joints[joint].kind);
    text_append(text, "\n    JpFriction friction_%zu = jp_friction_default();\n", number);
    if (friction->law == JP_FRICTION_REGULARIZED) {
        text_append(text, "    friction_%zu.law = JP_FRICTION_REGULARIZED;\n", number);
    }
    if (friction->steady > 0.0) {
        write_field(number, "steady", friction->steady, slides ? "N" : "N m", text);
    } else {
        write_field(number, "coefficient", friction->coefficient, "", text);
    }
    if (friction->radius > 0.0) {
        write_field(number, "radius", friction->radius, "m", text);
    }
    write_field(number, "speed", friction->speed, slides ? "m/s" : "rad/s", text);
    if (friction->breakaway_ratio > 1.0) {
        write_field(number, "breakaway_ratio", friction->breakaway_ratio, "", text);
    }
    text_append(text, "    check(jp_friction_create(play, ");
    tune_bodies_joint_name(linkage, joint, text);
    text_append(text, ", &friction_%zu, &rubs[%zu], &error), &error);\n", number, number);
}

void tune_rubs_write(const Scenario *scenario, Text *text)
{
    const Linkage *linkage = &scenario->linkage;
    JpFriction friction;
    size_t count = 0;
    for (int i = 0; i < (int)linkage->joint_count; i++) {
        count += rubs(linkage, i) ? 1 : 0;
    }
    if (count > 0) {
        text_append(text, "    JpJoint *rubs[%zu];\n", count);
    }
    count = 0;
    for (int i = 0; i < (int)linkage->joint_count; i++) {
        if (tune_rubs_find(scenario, i, &friction)) {
            write_one(linkage, i, &friction, count++, text);
        }
    }
}

const char *tune_rubs_lack(const Scenario *scenario)
{
    const Linkage *linkage = &scenario->linkage;
    for (int i = 0; i < (int)linkage->joint_count; i++) {
        const Joint *joint = &linkage->joints[i];
        if (rubs(linkage, i) && joint->friction.length > 0.0) {
            return "libjointplay has no guide whose ends take a moment and rub (friction-length)";
        }
    }
    return NULL;
}
