// Which lines make a loop of one's own do what the setting does?
//
// The row that ODE makes of a contact, at the depth d found before the step:
//     k = F(d) / d,  c = chi F(d) / v0 (or the constant damper)
// and from them soft_erp and soft_cfm by the map of the setting, as contact/map.c.
#include "commands/tune/tune_export.h"

#include "contact/law.h"
#include "write/number.h"

#include <string.h>

static void write_elastic(const ForceLaw *law, bool is_angle, Text *text)
{
    const char *unit = is_angle ? "N m/rad" : "N/m";
    if (law->family == FORCE_LAW_POWER && law->exponent == 1.0) {
        text_append(text, "    const double k = %s; // %s\n", number_shortest(law->stiffness).text,
                    unit);
    } else if (law->family == FORCE_LAW_POWER) {
        text_append(text, "    const double k = %s * pow(depth, %s); // F(depth) / depth, %s\n",
                    number_shortest(law->stiffness).text, number_shortest(law->exponent - 1.0).text,
                    unit);
    } else {
        text_append(text,
                    "    double force = depth / %s; // N: depth = A F (B - ln F)\n"
                    "    for (int i = 0; i < 60; i++) {\n"
                    "        force = depth / (%s * (%s - log(force)));\n"
                    "    }\n"
                    "    const double k = force / depth; // N/m\n",
                    number_shortest(law->compliance * (law->offset > 1.0 ? law->offset : 1.0)).text,
                    number_shortest(law->compliance).text, number_shortest(law->offset).text);
    }
}

static void write_damping(const ForceLaw *law, bool is_angle, Text *text)
{
    const char *unit = is_angle ? "N m s/rad" : "N s/m";
    if (law->hysteresis > 0.0) {
        text_append(text,
                    "    // %s; v0: closing speed when this contact began, %s, which you keep\n"
                    "    const double c =\n        %s * k * depth / fmax(v0, %s);\n",
                    unit, is_angle ? "rad/s" : "m/s", number_shortest(law->hysteresis).text,
                    number_shortest(law->impact_speed_floor).text);
    } else {
        text_append(text, "    const double c = %s; // %s\n    (void)v0;\n",
                    number_shortest(law->viscous).text, unit);
    }
}

// ERP and CFM of the row, as two lines that end each in its own way.
typedef struct RowLines {
    const char *erp;
    const char *cfm;
    const char *end;
} RowLines;

static void write_map(const ForceLaw *law, OdeMap map, RowLines lines, Text *text)
{
    const bool has_damper = law->hysteresis > 0.0 || law->viscous > 0.0;
    const char *erp = "H * k / c";
    const char *cfm = "1.0 / c";
    if (map == ODE_MAP_TEXTBOOK) {
        erp = "H * k / (H * k + c)";
        cfm = "1.0 / (H * k + c)";
    } else if (has_damper) {
        text_append(text, "    // stable for H < 2 / sqrt(slope / m), m the mass met, slope "
                          "dF/ddepth\n    // ERP may exceed 1\n");
    } else {
        text_append(text, "    // without a damper a tiny one stands in\n");
        erp = "1e10";
        cfm = "1e10 / (H * k)";
    }
    text_append(text, "    %s%s%s;\n    %s%s%s;\n", lines.erp, erp, lines.end, lines.cfm, cfm,
                lines.end);
}

// The name of a joint as a part of that of a function.
static void write_name(const Joint *joint, Text *text)
{
    for (const char *letter = joint->name; *letter != '\0'; letter++) {
        const bool is_plain = (*letter >= 'a' && *letter <= 'z') ||
                              (*letter >= 'A' && *letter <= 'Z') ||
                              (*letter >= '0' && *letter <= '9');
        text_append(text, "%c", is_plain ? *letter : '_');
    }
}

// The stop of ODE's own hinge or slider is the same row.
static void write_stop(const Joint *joint, const ForceLaw *law, OdeMap map, Text *text)
{
    static const RowLines HINGE = {"dJointSetHingeParam(hinge, dParamStopERP, ",
                                   "dJointSetHingeParam(hinge, dParamStopCFM, ", ")"};
    static const RowLines SLIDER = {"dJointSetSliderParam(slider, dParamStopERP, ",
                                    "dJointSetSliderParam(slider, dParamStopCFM, ", ")"};
    const bool is_hinge = joint->kind == JOINT_REVOLUTE;
    const char *name = is_hinge ? "hinge" : "slider";
    text_append(text,
                "// %s: between dParamLoStop and dParamHiStop of ODE's %s;\n"
                "// depth > 0 beyond one of them, in %s\nstatic void set_stop_",
                joint->name, name, is_hinge ? "rad" : "metres");
    write_name(joint, text);
    text_append(text, "(dJointID %s, double depth, double v0)\n{\n", name);
    write_elastic(law, is_hinge, text);
    write_damping(law, is_hinge, text);
    write_map(law, map, is_hinge ? HINGE : SLIDER, text);
    text_append(text, "}\n\n");
}

static void write_surface(const Joint *joint, const ForceLaw *law, OdeMap map, Text *text)
{
    static const RowLines SURFACE = {"surface->soft_erp = ", "surface->soft_cfm = ", ""};
    if (joint->kind == JOINT_GEAR) {
        text_append(
            text,
            "// %s: a contact of yours where the pitch circles touch, along their tangent;\n"
            "// depth > 0 in metres of the pitch circles beyond the backlash\n",
            joint->name);
    } else {
        text_append(text, "// %s: depth > 0 in metres, as dContactGeom has it\n", joint->name);
    }
    text_append(text, "static void set_surface_");
    write_name(joint, text);
    text_append(text, "(\n    dSurfaceParameters *surface, double depth, double v0)\n{\n");
    write_elastic(law, false, text);
    write_damping(law, false, text);
    if (law->friction > 0.0 && joint->kind != JOINT_GEAR) {
        text_append(text,
                    "    surface->mode = dContactSoftERP | dContactSoftCFM | dContactApprox1;\n"
                    "    surface->mu = %s;\n",
                    number_shortest(law->friction).text);
    } else {
        text_append(text, "    surface->mode = dContactSoftERP | dContactSoftCFM;\n"
                          "    surface->mu = 0.0; // one row, along the normal\n");
    }
    write_map(law, map, SURFACE, text);
    text_append(text, "}\n\n");
}

// Whether the ends of a joint are stops of ODE's own hinge or slider.
static bool has_stops(const Joint *joint)
{
    return linkage_kind_is_ideal(joint->kind) && joint->limits.kind != LIMIT_NONE;
}

static void write_loop(const Scenario *scenario, Text *text)
{
    text_append(text, "// once\n");
    text_append(text, "dWorldSetERP(world, %s); // of the ideal joints\n",
                number_shortest(scenario->ode.erp).text);
    text_append(text, "dWorldSetCFM(world, %s);\n", number_shortest(scenario->ode.cfm).text);
    text_append(text, "dWorldSetContactSurfaceLayer(world, 0.0);\n"
                      "dWorldSetContactMaxCorrectingVel(world, dInfinity);\n"
                      "// of each body\ndBodySetFiniteRotationMode(body, 1);\n"
                      "// each step; a driven body is kinematic and put on its path first\n"
                      "// calls set_surface_..., one point a joint; set_stop_... beyond a stop\n"
                      "dSpaceCollide(space, NULL, near_callback);\n"
                      "dWorldStep(world, H);\n"
                      "dJointGroupEmpty(contacts);\n");
}

bool tune_snippet_write(const TuneReport *report, const TuneTrial *trial, Text *text)
{
    const Scenario *scenario = report->scenario;
    const Linkage *linkage = &scenario->linkage;
    const OdeMap map = report->tune->schemes[trial->scheme].scheme.map;
    Text lines;
    text_init(&lines);
    text_append(&lines, "static const double H = %s; // step, s\n\n",
                number_shortest(trial->value).text);
    bool fits = map == ODE_MAP_TEXTBOOK || map == ODE_MAP_CORRECTED;
    for (size_t i = 0; i < linkage->joint_count && fits; i++) {
        ForceLaw law;
        Err unused = {ERR_NONE, ""};
        if (linkage_has_play(&linkage->joints[i])) {
            fits = law_of_joint(scenario, &linkage->joints[i], &law, &unused);
            if (has_stops(&linkage->joints[i])) {
                write_stop(&linkage->joints[i], &law, map, &lines);
            } else {
                write_surface(&linkage->joints[i], &law, map, &lines);
            }
        }
    }
    if (fits) {
        write_loop(scenario, &lines);
        text_append(text, "%s", lines.data);
    }
    text_finish(&lines);
    return fits;
}
