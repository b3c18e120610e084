// Which lines make a loop of one's own do what the setting does?
//
// The row that ODE makes of a contact, at the depth d found before the step:
//     k = F(d) / d,  c = chi F(d) / v0 (or the constant damper)
// and from them soft_erp and soft_cfm by the map of the setting, as contact/map.c.
#include "commands/tune/tune_export.h"

#include "contact/law.h"
#include "write/number.h"

#include <string.h>

static void write_elastic(const ForceLaw *law, Text *text)
{
    if (law->family == FORCE_LAW_POWER && law->exponent == 1.0) {
        text_append(text, "    const double k = %s; // N/m\n",
                    number_shortest(law->stiffness).text);
    } else if (law->family == FORCE_LAW_POWER) {
        text_append(text, "    const double k = %s * pow(depth, %s); // F(depth) / depth, N/m\n",
                    number_shortest(law->stiffness).text,
                    number_shortest(law->exponent - 1.0).text);
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

static void write_damping(const ForceLaw *law, Text *text)
{
    if (law->hysteresis > 0.0) {
        text_append(text,
                    "    // N s/m; v0: closing speed when this contact began, m/s, which you keep\n"
                    "    const double c =\n        %s * k * depth / fmax(v0, %s);\n",
                    number_shortest(law->hysteresis).text,
                    number_shortest(law->impact_speed_floor).text);
    } else {
        text_append(text, "    const double c = %s; // N s/m\n    (void)v0;\n",
                    number_shortest(law->viscous).text);
    }
}

static void write_map(const ForceLaw *law, OdeMap map, Text *text)
{
    const bool has_damper = law->hysteresis > 0.0 || law->viscous > 0.0;
    if (map == ODE_MAP_TEXTBOOK) {
        text_append(text, "    surface->soft_erp = H * k / (H * k + c);\n"
                          "    surface->soft_cfm = 1.0 / (H * k + c);\n");
    } else if (has_damper) {
        text_append(text,
                    "    // stable for H < 2 / sqrt(slope / m), m the mass met, slope dF/ddepth\n"
                    "    surface->soft_erp = H * k / c; // may exceed 1\n"
                    "    surface->soft_cfm = 1.0 / c;\n");
    } else {
        text_append(text, "    // without a damper a tiny one stands in\n"
                          "    surface->soft_erp = 1e10;\n"
                          "    surface->soft_cfm = 1e10 / (H * k);\n");
    }
}

static void write_surface(const Joint *joint, const ForceLaw *law, const Scenario *scenario,
                          OdeMap map, Text *text)
{
    text_append(text, "// %s: depth > 0 in metres, as dContactGeom has it\n", joint->name);
    text_append(text, "static void set_surface_");
    for (const char *letter = joint->name; *letter != '\0'; letter++) {
        const bool is_plain = (*letter >= 'a' && *letter <= 'z') ||
                              (*letter >= 'A' && *letter <= 'Z') ||
                              (*letter >= '0' && *letter <= '9');
        text_append(text, "%c", is_plain ? *letter : '_');
    }
    text_append(text, "(\n    dSurfaceParameters *surface, double depth, double v0)\n{\n");
    write_elastic(law, text);
    write_damping(law, text);
    if (scenario->contact.friction > 0.0) {
        text_append(text,
                    "    surface->mode = dContactSoftERP | dContactSoftCFM | dContactApprox1;\n"
                    "    surface->mu = %s;\n",
                    number_shortest(scenario->contact.friction).text);
    } else {
        text_append(text, "    surface->mode = dContactSoftERP | dContactSoftCFM;\n"
                          "    surface->mu = 0.0; // one row, along the normal\n");
    }
    write_map(law, map, text);
    text_append(text, "}\n\n");
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
                      "// calls set_surface_..., one point a joint\n"
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
            write_surface(&linkage->joints[i], &law, scenario, map, &lines);
        }
    }
    if (fits) {
        write_loop(scenario, &lines);
        text_append(text, "%s", lines.data);
    }
    text_finish(&lines);
    return fits;
}
