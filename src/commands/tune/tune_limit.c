// How do Gazebo and MuJoCo have a joint with stops or backlash?
//
// Both have limits of a joint, counted from where its bodies stand at the start. Gazebo classic
// reads `stiffness` and `dissipation` of a limit for Simbody; with ODE it hands cfm and erp of
// physics/ode/limit to dParamStopCFM and dParamStopERP (ODEJoint::Load), the row of a stop:
//     erp = h k / (h k + c),  cfm = 1 / (h k + c)
// The row of a limit of MuJoCo is that of a contact (tune_mujoco.c), where A is the joint's
// dof_invweight0: the mobility of its coordinate, of a tree of joints at qpos0.
#include "commands/tune/tune_limit.h"

#include "contact/law.h"
#include "contact/touch.h"
#include "model/coordinate.h"
#include "write/joint_units.h"
#include "write/number.h"
#include "write/xml.h"

#include <assert.h>
#include <math.h>
#include <stdlib.h>

// where there is no stop: MuJoCo's range has two ends, and nothing gets that far
static const double FAR = 1e10;

bool tune_limit_alone(const Linkage *linkage, size_t *joint)
{
    size_t count = 0;
    for (size_t i = 0; i < linkage->joint_count; i++) {
        if (linkage_has_play(&linkage->joints[i])) {
            *joint = i;
            count++;
        }
    }
    return count == 1 && linkage_kind_is_ideal(linkage->joints[*joint].kind);
}

// Of the coordinate as the bodies stand at the start.
typedef struct Ends {
    double low;
    double high;
} Ends;

static Ends range_of(const Linkage *linkage, size_t number)
{
    const Joint *joint = &linkage->joints[number];
    Motion *motions = calloc(linkage->body_count + 1, sizeof *motions);
    assert(motions != NULL);
    linkage_start(linkage, motions);
    const double start = coordinate_position(linkage, motions, (int)number);
    free(motions);
    return (Ends){coordinate_low(joint) - start, coordinate_high(joint) - start};
}

const char *tune_limit_lacks(const Scenario *scenario, size_t number)
{
    const Joint *joint = &scenario->linkage.joints[number];
    const Ends range = range_of(&scenario->linkage, number);
    ForceLaw law;
    Err ignored = {ERR_NONE, ""};
    if (!law_of_joint(scenario, joint, &law, &ignored) || law.family != FORCE_LAW_POWER ||
        law.exponent != 1.0) {
        return "limits of Gazebo and MuJoCo have a linear spring, and this joint's has another "
               "exponent";
    }
    const bool is_beyond =
        (isfinite(range.low) && range.low < -M_PI) || (isfinite(range.high) && range.high > M_PI);
    return joint->kind == JOINT_REVOLUTE && is_beyond
               ? "ODE's hinge has its stops within half a turn of where it starts"
               : NULL;
}

const char *tune_limit_lacks_range(const Scenario *scenario, size_t number)
{
    const Ends range = range_of(&scenario->linkage, number);
    return range.low < range.high
               ? NULL
               : "MuJoCo has no range of length 0, which backlash of 0 would be: give the joint a "
                 "spring there";
}

double tune_limit_mass(const Scenario *scenario, const Motion *motions)
{
    Touch *places;
    size_t count;
    Response response;
    Err ignored = {ERR_NONE, ""};
    double mass = NAN;
    if (!touch_list(scenario, &places, &count, &ignored)) {
        return mass;
    }
    touch_response(&scenario->linkage, places, count, false, &response);
    if (response_place(&response, motions)) {
        mass = response_mass(&response, response_first_row(&response, 0), (Vec2){1.0, 0.0});
    }
    response_finish(&response);
    free(places);
    return mass;
}

// The joint of the report, and its constants.
typedef struct Limited {
    const Linkage *linkage;
    const Joint *joint;
    const JointUnits *units;
    const TuneLinear *linear;
    Ends range;
    int bodies[2]; // the one that its coordinate moves, and the other
} Limited;

static Limited limited_of(const TuneReport *report)
{
    const Tune *tune = report->tune;
    const size_t number = tune->contact.joint;
    Limited made = {
        .linkage = &report->scenario->linkage,
        .joint = &report->scenario->linkage.joints[number],
        .units = joint_units(&report->scenario->linkage.joints[number]),
        .linear = &tune->linears[tune->linear],
        .range = range_of(&report->scenario->linkage, number),
    };
    linkage_turning(made.linkage, (int)number, &made.bodies[0], &made.bodies[1]);
    return made;
}

static void write_body(const Linkage *linkage, const char *tag, int body, Text *text)
{
    text_append(text, "  <%s>", tag);
    xml_append(body == LINKAGE_GROUND ? "world" : linkage->bodies[body].name, text);
    text_append(text, "</%s>\n", tag);
}

// In the world as the bodies stand at the start.
static Vec2 axis_of(const Limited *limited, size_t number)
{
    Motion *motions = calloc(limited->linkage->body_count + 1, sizeof *motions);
    assert(motions != NULL);
    linkage_start(limited->linkage, motions);
    const Vec2 along = joint_rows_along(limited->linkage, motions, (int)number);
    free(motions);
    return vec2_scale(coordinate_sense(limited->joint), along);
}

static void write_axis(const Limited *limited, size_t number, Text *text)
{
    const Vec2 along =
        limited->joint->kind == JOINT_PRISMATIC ? axis_of(limited, number) : (Vec2){0.0, 0.0};
    text_append(text, "%s %s %d", number_shortest(along.x).text, number_shortest(along.y).text,
                limited->joint->kind == JOINT_PRISMATIC ? 0 : 1);
}

void tune_limit_sdf(const TuneReport *report, ErpCfm row, Text *text)
{
    const Limited limited = limited_of(report);
    text_append(text, "<joint name=\"");
    xml_append(limited.joint->name, text);
    text_append(text, "\" type=\"%s\">\n",
                limited.joint->kind == JOINT_PRISMATIC ? "prismatic" : "revolute");
    write_body(limited.linkage, "parent", limited.bodies[1], text);
    write_body(limited.linkage, "child", limited.bodies[0], text);
    text_append(text, "  <axis>\n    <xyz expressed_in=\"__model__\">");
    write_axis(&limited, report->tune->contact.joint, text);
    text_append(text, "</xyz>\n    <limit>\n");
    if (isfinite(limited.range.low)) {
        text_append(text, "      <lower>%s</lower>\n", number_shortest(limited.range.low).text);
    }
    if (isfinite(limited.range.high)) {
        text_append(text, "      <upper>%s</upper>\n", number_shortest(limited.range.high).text);
    }
    text_append(text,
                "      <stiffness>%s</stiffness> <!-- %s; not read with ODE -->\n"
                "      <dissipation>%s</dissipation> <!-- %s; not read with ODE -->\n"
                "    </limit>\n  </axis>\n"
                "  <physics>\n    <ode>\n      <limit>\n"
                "        <cfm>%s</cfm> <!-- of spring and damper at this step -->\n"
                "        <erp>%s</erp>\n"
                "      </limit>\n    </ode>\n  </physics>\n</joint>\n",
                number_shortest(limited.linear->stiffness).text, limited.units->stiffness,
                number_shortest(limited.linear->damping).text, limited.units->damping,
                number_shortest(row.cfm).text, number_shortest(row.erp).text);
}

static const char *end_of(double value, NumberText *shortest)
{
    *shortest = number_shortest(isfinite(value) ? value : copysign(FAR, value));
    return shortest->text;
}

void tune_limit_mjcf(const TuneReport *report, const double solref[2], double impedance, Text *text)
{
    const Limited limited = limited_of(report);
    NumberText low;
    NumberText high;
    text_append(text, "<joint name=\"");
    xml_append(limited.joint->name, text);
    text_append(text, "\" type=\"%s\" axis=\"",
                limited.joint->kind == JOINT_PRISMATIC ? "slide" : "hinge");
    write_axis(&limited, report->tune->contact.joint, text);
    text_append(text,
                "\" limited=\"true\" margin=\"0\"\n"
                "       range=\"%s %s\"\n"
                "       solreflimit=\"%s %s\"\n"
                "       solimplimit=\"%s %s 1 0.5 1\"/>\n",
                end_of(limited.range.low, &low), end_of(limited.range.high, &high),
                number_shortest(solref[0]).text, number_shortest(solref[1]).text,
                number_shortest(impedance).text, number_shortest(impedance).text);
}
