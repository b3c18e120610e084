// Writes a setting for use elsewhere: C code, a loop of the user's own, Gazebo, MuJoCo.
#include "commands/tune/tune_export.h"
#include "commands/tune/tune.h"
#include "commands/tune/tune_linear.h"
#include "commands/tune/tune_model.h"
#include "commands/tune/tune_sdf_model.h"
#include "commands/tune/tune_world.h"
#include "contact/law.h"
#include "contact/map.h"
#include "kernel/conforming.h"
#include "measure/chosen_run.h"
#include "write/number.h"
#include "write/table.h"
#include "write/units.h"
#include "write/xml.h"

#include <assert.h>
#include <float.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

// kp and kd with which Gazebo makes the linear contact.
//
// Gazebo classic, ODEPhysics::Collide, of two surfaces 1 and 2 at step h:
//     kp = 1 / (1/kp1 + 1/kp2),  kd = kd1 + kd2
//     soft_erp = h kp / (h kp + kd),  soft_cfm = 1 / (h kp + kd)          (the textbook map)
// so that each of two equal surfaces has 2 kp and kd / 2. The soft_erp and soft_cfm of a surface
// are read and not used. The stop of a joint is one row by itself (tune_linear.c). max_vel bounds
// the speed at which a contact pushes apart, 0.01 m/s unless said otherwise; min_depth is the
// overlap that is left alone.

// m/s: far above any speed at which a pin leaves its wall, so that it bounds nothing
static const double MAX_VEL = 1e6;

bool tune_gazebo_find(const Tune *tune, TuneGazebo *gazebo)
{
    if (tune->linear == TUNE_NONE) {
        return false;
    }
    const TuneLinear *linear = &tune->linears[tune->linear];
    const bool is_limit = tune->contact.is_limit;
    const double sum = linear->step_s * linear->stiffness + linear->damping;
    *gazebo = (TuneGazebo){
        .kp = is_limit ? linear->stiffness : 2.0 * linear->stiffness,
        .kd = is_limit ? linear->damping : 0.5 * linear->damping,
        .soft_erp = linear->step_s * linear->stiffness / sum,
        .soft_cfm = 1.0 / sum,
        .max_vel = MAX_VEL,
        .step_s = linear->step_s,
        .error = linear->error,
    };
    return true;
}

static void tune_gazebo_write_surface(const TuneReport *report, const TuneGazebo *gazebo,
                                      Text *text)
{
    const TuneLinear *linear = &report->tune->linears[report->tune->linear];
    const Scenario *scenario = report->scenario;
    const Joint *joint = &scenario->linkage.joints[report->tune->contact.joint];
    const double friction = scenario_friction(scenario, joint);
    text_append(text,
                "<surface>\n"
                "  <contact>\n"
                "    <ode>\n"
                "      <soft_erp>%s</soft_erp> <!-- not used -->\n"
                "      <soft_cfm>%s</soft_cfm>\n"
                "      <kp>%s</kp> <!-- two in a row make %.4g N/m -->\n"
                "      <kd>%s</kd> <!-- two together make %.4g N s/m -->\n"
                "      <min_depth>%s</min_depth>\n"
                "      <max_vel>%s</max_vel>\n"
                "    </ode>\n"
                "  </contact>\n"
                "  <friction><ode><mu>%s</mu><mu2>%s</mu2></ode></friction>\n"
                "</surface>\n",
                number_shortest(gazebo->soft_erp).text, number_shortest(gazebo->soft_cfm).text,
                number_shortest(gazebo->kp).text, linear->stiffness,
                number_shortest(gazebo->kd).text, linear->damping,
                number_shortest(gazebo->min_depth).text, number_shortest(gazebo->max_vel).text,
                number_shortest(friction).text, number_shortest(friction).text);
}

// The words above a document, with the error of its constants.
static void write_measured(const TuneReport *report, const TuneGazebo *gazebo, Text *text)
{
    const TuneLinear *linear = &report->tune->linears[report->tune->linear];
    Text source;
    text_init(&source);
    tune_held_text_source(report, linear, &source);
    text_append(text,
                "<!-- error with these constants, measured: %.2g;\n"
                "     best for: %s -->\n",
                gazebo->error, source.data);
    text_finish(&source);
}

static void write_physics(const TuneReport *report, const TuneGazebo *gazebo, Text *text)
{
    text_append(text,
                "<physics type=\"ode\">\n"
                "  <max_step_size>%s</max_step_size>\n"
                "  <ode>\n"
                "    <solver><type>world</type></solver>\n"
                "    <constraints>\n"
                "      <cfm>0</cfm>\n"
                "      <erp>%s</erp>\n"
                "      <contact_max_correcting_vel>%s</contact_max_correcting_vel>\n"
                "      <contact_surface_layer>0</contact_surface_layer>\n"
                "    </constraints>\n"
                "  </ode>\n"
                "</physics>\n",
                number_shortest(gazebo->step_s).text,
                number_shortest(report->scenario->ode.erp).text,
                number_shortest(gazebo->max_vel).text);
}

static const char FOR_GAZEBO[] =
    "<!-- for Gazebo classic with ODE: of a contact DART, the engine of the current\n"
    "     Gazebo, reads friction and restitution alone, and no kp and kd -->\n";

void tune_gazebo_write(const TuneReport *report, Text *text)
{
    TuneGazebo gazebo;
    if (!tune_gazebo_find(report->tune, &gazebo)) {
        return;
    }
    Text parts;
    text_init(&parts);
    write_measured(report, &gazebo, text);
    write_physics(report, &gazebo, &parts);
    if (report->tune->contact.is_limit) {
        tune_limit_sdf(report, (ErpCfm){.erp = gazebo.soft_erp, .cfm = gazebo.soft_cfm}, &parts);
    } else {
        text_append(&parts, "<!-- in the collision of the pin, and the same in that of the hole "
                            "-->\n");
        tune_gazebo_write_surface(report, &gazebo, &parts);
    }
    text_append(text, "%s<!-- physics belongs into the world%s -->\n", FOR_GAZEBO,
                report->tune->contact.is_limit ? ", joint into the model" : "");
    xml_append_element("sdf version=\"1.6\"", parts.data, text);
    text_finish(&parts);
}

void tune_gazebo_write_world(const TuneReport *report, Text *text)
{
    TuneGazebo gazebo;
    const char *lacks = tune_sdf_model_lacks(report->scenario);
    if (lacks != NULL || !tune_gazebo_find(report->tune, &gazebo)) {
        tune_gazebo_write(report, text);
        text_append(text, "%s%s%s", text->length > 0 ? "<!-- elements to paste: " : "",
                    text->length > 0 ? lacks : "", text->length > 0 ? " -->\n" : "");
        return;
    }
    Text parts;
    Text surface;
    Text world;
    text_init(&parts);
    text_init(&surface);
    text_init(&world);
    write_measured(report, &gazebo, text);
    text_append(text,
                "%s<!-- the whole mechanism; that error was measured in ODE with round holes and "
                "the\n     steps of Gazebo, which has not run this -->\n",
                FOR_GAZEBO);
    tune_gazebo_write_surface(report, &gazebo, &surface);
    write_physics(report, &gazebo, &parts);
    tune_sdf_model_write(report->scenario, surface.data, &parts);
    xml_append_element("world name=\"jointplay\"", parts.data, &world);
    xml_append_element("sdf version=\"1.6\"", world.data, text);
    text_finish(&parts);
    text_finish(&surface);
    text_finish(&world);
}

// solref and solimp with which MuJoCo makes the linear contact.
//
// One row of MuJoCo, r < 0 the gap, v its rate, a0 its acceleration without the force, W the true
// and A the approximate inverse mass of the row (documentation, "Computation" and "Modeling"):
//     f = (a_ref - a0) / (W + R) >= 0,  R = A (1 - d) / d,  a_ref = -b v - k r
//     direct format, d constant: solref = (-s, -c'), b = c' / d, k = s / d
// For d -> 0, R outweighs W and   f = (d / A) (-b v - k r - a0) = -(s r + c' v) / A  - d a0 / A:
// a spring s / A and a damper c' / A, whatever the mass that is met, but for a share d of a0. So
//     s = A K,  c' = A C,  d as small as is allowed, 1e-4
// A is what the compiler of MuJoCo finds at qpos0: the sum of both bodies' body_invweight0, 1/m of
// a body with a free joint and 0 of one that is welded to the world or moved as mocap. f and the
// forces here: N; K N/m; C N s/m.
//
// r and v are those before the step: the spring is explicit, where the textbook's row in ODE is
// implicit and stable at any step. So omega h and C h / m, m the effective mass, stay below a
// tenth.

enum { FRICTION_SIZE = 128 };

static const double LEAST_IMPEDANCE = 1e-4; // mjMINIMP

// of the explicit limit 2 for the effective mass at the deepest contact: the lightest that a pin of
// a linkage meets was seen to be a sixth of that, where omega h is then 0.25
static const double STEP_SHARE = 0.1;

static double inverse_mass(const Linkage *linkage, int body)
{
    return body == LINKAGE_GROUND || linkage_is_driven(linkage, body)
               ? 0.0
               : 1.0 / linkage->bodies[body].mass;
}

bool tune_mujoco_find(const TuneReport *report, TuneMujoco *mujoco)
{
    const Tune *tune = report->tune;
    if (tune->linear == TUNE_NONE ||
        (tune->contact.is_limit &&
         tune_limit_lacks_range(report->scenario, tune->contact.joint) != NULL)) {
        return false;
    }
    const Linkage *linkage = &report->scenario->linkage;
    const Joint *joint = &linkage->joints[tune->contact.joint];
    const TuneLinear *linear = &tune->linears[tune->linear];
    const double weight = tune->contact.is_limit ? 1.0 / tune->contact.mass
                                                 : inverse_mass(linkage, joint->body_a) +
                                                       inverse_mass(linkage, joint->body_b);
    *mujoco = (TuneMujoco){
        .weight = weight,
        .impedance = LEAST_IMPEDANCE,
        .solref = {-weight * linear->stiffness, -weight * linear->damping},
        .stiffness = linear->stiffness,
        .damping = linear->damping,
        .step_s = fmin(linear->step_s,
                       STEP_SHARE * fmin(sqrt(tune->contact.mass / linear->stiffness),
                                         tune->contact.mass / fmax(linear->damping, DBL_MIN))),
    };
    return weight > 0.0;
}

bool tune_mujoco_is_finer(const TuneReport *report, const TuneMujoco *mujoco)
{
    return mujoco->step_s < report->tune->held_s;
}

// Appends the words above the document to `text`, and its elements to `parts`.
static void write_pair(const TuneReport *report, const TuneMujoco *mujoco, Text *text, Text *parts)
{
    const Scenario *scenario = report->scenario;
    const Joint *joint = &scenario->linkage.joints[report->tune->contact.joint];
    const double friction = scenario_friction(scenario, joint);
    char slides[FRICTION_SIZE] = "";
    if (friction > 0.0) {
        // both directions of sliding; MuJoCo's own numbers for torsion and rolling, which a planar
        // pin does not do
        snprintf(slides, sizeof slides, "\n        friction=\"%s %s 0.005 0.0001 0.0001\"",
                 number_shortest(friction).text, number_shortest(friction).text);
    }
    text_append(text,
                "<!-- spring %.4g N/m, damper %.4g N s/m, not run here; for bodies\n"
                "     with free joints, held by connect equalities: A = %.6g 1/kg. In any\n"
                "     other model multiply solref by (invweight0 of both bodies) / A. -->\n",
                mujoco->stiffness, mujoco->damping, mujoco->weight);
    text_append(parts,
                "<option timestep=\"%s\"\n        integrator=\"Euler\" cone=\"elliptic\"/>\n"
                "<contact>\n"
                "  <pair geom1=\"pin\" geom2=\"hole\" condim=\"%d\" margin=\"0\" gap=\"0\"%s\n"
                "        solref=\"%s %s\"\n"
                "        solimp=\"%s %s 1 0.5 1\"/>\n"
                "</contact>\n",
                number_shortest(mujoco->step_s).text, friction > 0.0 ? 3 : 1, slides,
                number_shortest(mujoco->solref[0]).text, number_shortest(mujoco->solref[1]).text,
                number_shortest(mujoco->impedance).text, number_shortest(mujoco->impedance).text);
}

// The limit of a joint, in radians or metres.
static void write_limit(const TuneReport *report, const TuneMujoco *mujoco, Text *text, Text *parts)
{
    const Joint *joint = &report->scenario->linkage.joints[report->tune->contact.joint];
    const JointUnits *units = joint_units(joint);
    text_append(text,
                "<!-- spring %.4g %s, damper %.4g %s, not run here; for bodies\n"
                "     in a tree of joints: A = %.6g 1/(%s). In any other model multiply\n"
                "     solreflimit by the joint's dof_invweight0 / A. -->\n",
                mujoco->stiffness, units->stiffness, mujoco->damping, units->damping,
                mujoco->weight, units->mass);
    text_append(parts,
                "<compiler angle=\"radian\"/>\n"
                "<option timestep=\"%s\" integrator=\"Euler\"/>\n",
                number_shortest(mujoco->step_s).text);
    tune_limit_mjcf(report, mujoco->solref, mujoco->impedance, parts);
}

void tune_mujoco_write(const TuneReport *report, Text *text)
{
    TuneMujoco mujoco;
    if (tune_model_write(report->tune, text) || !tune_mujoco_find(report, &mujoco)) {
        return;
    }
    Text parts;
    text_init(&parts);
    if (report->tune->contact.is_limit) {
        write_limit(report, &mujoco, text, &parts);
    } else {
        write_pair(report, &mujoco, text, &parts);
    }
    xml_append_element("mujoco", parts.data, text);
    text_finish(&parts);
}

// Lines for a loop of the user's own that do what the setting does.
//
// The row that ODE makes of a contact, at the depth d found before the step:
//     k = F(d) / d,  c = chi F(d) / v0 (or the damper at that depth)
// and from them soft_erp and soft_cfm by the map of the setting, as contact/map.c.

static void write_conforming(const ForceLaw *law, Text *text)
{
    text_append(text, "    static const double w[] = {");
    for (size_t i = 0; i < CONFORMING_TERMS; i++) {
        text_append(text, "%s%s", i % 4 == 0 ? "\n        " : " ",
                    number_shortest(law->conforming.series[i]).text);
        text_append(text, ",");
    }
    text_append(text,
                "\n    }; // F(depth) = %s depth / W, N: a pin in an eye, by elasticity\n"
                "    const double z = log1p(%s / depth);\n"
                "    const double x = fmin(%s * log1p(z) - %s, 1.0);\n"
                "    double width = 0.0;\n"
                "    for (int i = %d; i >= 0; i--) {\n"
                "        width = width * x + w[i];\n"
                "    }\n"
                "    const double k = %s / width; // N/m\n",
                number_shortest(law->conforming.stiffness).text,
                number_shortest(law->conforming.play).text, number_shortest(CONFORMING_SCALE).text,
                number_shortest(CONFORMING_SHIFT).text, CONFORMING_TERMS - 1,
                number_shortest(law->conforming.stiffness).text);
}

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
    } else if (law->family == FORCE_LAW_CONFORMING) {
        write_conforming(law, text);
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

static void tune_export_write_damping(const ForceLaw *law, bool is_angle, Text *text)
{
    const char *unit = is_angle ? "N m s/rad" : "N s/m";
    if (law->hysteresis > 0.0) {
        text_append(text,
                    "    // %s; v0: closing speed when this contact began, %s, which you keep\n"
                    "    const double c =\n        %s * k * depth / fmax(v0, %s);\n",
                    unit, is_angle ? "rad/s" : "m/s", number_shortest(law->hysteresis).text,
                    number_shortest(law->impact_speed_floor).text);
    } else if (law->full_damping_depth > 0.0) {
        text_append(text,
                    "    const double share = fmin(depth / %s, 1.0); // %s, of full damping\n"
                    "    const double c = %s * share * share * (3.0 - 2.0 * share); // %s\n"
                    "    (void)v0;\n",
                    number_shortest(law->full_damping_depth).text, is_angle ? "rad" : "m",
                    number_shortest(law->viscous).text, unit);
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
static void tune_export_write_stop(const Joint *joint, const ForceLaw *law, OdeMap map, Text *text)
{
    static const RowLines HINGE = {"dJointSetHingeParam(hinge, dParamStopERP, ",
                                   "dJointSetHingeParam(hinge, dParamStopCFM, ", ")"};
    static const RowLines SLIDER = {"dJointSetSliderParam(slider, dParamStopERP, ",
                                    "dJointSetSliderParam(slider, dParamStopCFM, ", ")"};
    const bool is_hinge = joint_has_angle(joint->kind);
    const char *name = is_hinge ? "hinge" : "slider";
    text_append(text,
                "// %s: between dParamLoStop and dParamHiStop of ODE's %s;\n"
                "// depth > 0 beyond one of them, in %s\nstatic void set_stop_",
                joint->name, name, is_hinge ? "rad" : "metres");
    write_name(joint, text);
    text_append(text, "(dJointID %s, double depth, double v0)\n{\n", name);
    write_elastic(law, is_hinge, text);
    tune_export_write_damping(law, is_hinge, text);
    write_map(law, map, is_hinge ? HINGE : SLIDER, text);
    text_append(text, "}\n\n");
}

static void tune_snippet_write_surface(const Joint *joint, const ForceLaw *law, OdeMap map,
                                       Text *text)
{
    static const RowLines SURFACE = {"surface->soft_erp = ", "surface->soft_cfm = ", ""};
    if (joint_has_teeth(joint->kind)) {
        text_append(text,
                    "// %s: a contact of yours where the %s, along %s;\n"
                    "// depth > 0 in metres there beyond the backlash\n",
                    joint->name,
                    joint_has_rack(joint->kind) ? "pitch circle meets the pitch line"
                                                : "pitch circles touch",
                    joint_has_rack(joint->kind) ? "that line" : "their tangent");
    } else {
        text_append(text, "// %s: depth > 0 in metres, as dContactGeom has it\n", joint->name);
    }
    text_append(text, "static void set_surface_");
    write_name(joint, text);
    text_append(text, "(\n    dSurfaceParameters *surface, double depth, double v0)\n{\n");
    write_elastic(law, false, text);
    tune_export_write_damping(law, false, text);
    if (law->friction > 0.0 && !joint_has_teeth(joint->kind)) {
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
    return joint_is_ideal(joint->kind) && joint->limits.kind != LIMIT_NONE;
}

static void tune_snippet_write_loop(const Scenario *scenario, Text *text)
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
                tune_export_write_stop(&linkage->joints[i], &law, map, &lines);
            } else {
                tune_snippet_write_surface(&linkage->joints[i], &law, map, &lines);
            }
        }
    }
    if (fits) {
        tune_snippet_write_loop(scenario, &lines);
        text_append(text, "%s", lines.data);
    }
    text_finish(&lines);
    return fits;
}

const TuneTrial *tune_export_trial(const TuneReport *report)
{
    const Tune *tune = report->tune;
    if (tune->held_s > 0.0) {
        return tune->held != TUNE_NONE ? &tune->trials[tune->held] : NULL;
    }
    if (tune_report_is_met(report)) {
        return tune_best(tune, tune->winner);
    }
    if (tune_report_has_limit(report) && tune->within != TUNE_NONE) {
        return &tune->trials[tune->within];
    }
    const TuneTrial *best = tune_best(tune, tune->winner);
    return best != NULL || tune->within == TUNE_NONE ? best : &tune->trials[tune->within];
}

// The code makes no trials: it gets the step that they choose.
static bool tune_export_choose_step(Scenario *scenario, Err *err)
{
    Trajectory *run = backend_run(scenario, BACKEND_ODE, NULL, (ChosenWatch){.begin = NULL}, NULL);
    const bool is_chosen = run->is_complete || err_set(err, ERR_SOLVER, "%s", run->message);
    if (is_chosen) {
        *scenario = chosen_run_scenario(scenario, run->step_s);
    }
    trajectory_destroy(run);
    return is_chosen;
}

const char *tune_export_lacks_case(const Scenario *scenario)
{
    const Torque *torque = &scenario->linkage.torque;
    if (scenario->linkage.load_count > 0 || torque->slope > 0.0 || torque->stiffness > 0.0) {
        return "programs have no loads, motors or soft drives";
    }
    const Driver *driver = &scenario->linkage.driver;
    if (wave_exists(&torque->table.wave) ||
        (driver->table.count > 0 && wave_exists(&driver->table.wave))) {
        return "programs have no sinusoids";
    }
    const bool has_one = scenario->linkage.further_count == 0;
    return has_one && !scenario->linkage.driver.has_angles ? NULL
                                                           : "programs have one drive, of a speed";
}

// Whether the library steps as the setting of a trial does; in words why it does not.
static const char *lacks_of(const TuneReport *report, const TuneTrial *trial)
{
    const char *lacks = tune_export_lacks_case(report->scenario);
    if (lacks != NULL) {
        return lacks;
    }
    Scenario scenario = *report->scenario;
    tune_apply(&report->tune->schemes[trial->scheme], trial->value, &scenario);
    if (scenario.run.step == 0.0) {
        // the way of stepping that a step chosen for a tolerance is for
        scenario = scenario_with_step(&scenario, scenario.run.step);
    }
    return tune_world_lacks(&scenario);
}

const char *tune_export_lacks(const TuneReport *report)
{
    const TuneTrial *trial = tune_export_trial(report);
    return trial != NULL ? lacks_of(report, trial) : NULL;
}

bool tune_export_is_writable(const TuneReport *report)
{
    return !report->scenario->linkage.is_spatial && tune_export_trial(report) != NULL &&
           tune_export_lacks(report) == NULL;
}

// In order of cost, before the place of the first that costs more.
static size_t insert_by_cost(const Tune *tune, int trial, int *trials, size_t count)
{
    size_t at = count;
    while (at > 0 && tune_trial_cost(tune, &tune->trials[trials[at - 1]]) >
                         tune_trial_cost(tune, &tune->trials[trial])) {
        trials[at] = trials[at - 1];
        at--;
    }
    trials[at] = trial;
    return count + 1;
}

size_t tune_export_trials(const TuneReport *report, int trials[SCHEME_MAX])
{
    const Tune *tune = report->tune;
    const TuneTrial *found = tune_export_trial(report);
    size_t count = 0;
    if (found == NULL) {
        return 0;
    }
    if (!tune_report_is_met(report) || tune->held_s > 0.0) {
        trials[0] = (int)(found - tune->trials);
        return lacks_of(report, found) == NULL ? 1 : 0;
    }
    for (size_t i = 0; i < tune->scheme_count; i++) {
        const TuneTrial *best = tune_best(tune, (int)i);
        if (best != NULL && tune_is_within(tune, best) && lacks_of(report, best) == NULL) {
            count = insert_by_cost(tune, (int)(best - tune->trials), trials, count);
        }
    }
    return count;
}

bool tune_export_scenario(const TuneReport *report, int number, Scenario *scenario, Err *err)
{
    const TuneTrial *trial = &report->tune->trials[number];
    *scenario = *report->scenario;
    tune_apply(&report->tune->schemes[trial->scheme], trial->value, scenario);
    return scenario->run.step > 0.0 || tune_export_choose_step(scenario, err);
}

// The scenario of a program that was run already: its step is known.
static void take_program(const TuneReport *report, Scenario *scenario)
{
    const TuneTrial *trial = &report->tune->trials[report->tune->program.trial];
    *scenario = *report->scenario;
    tune_apply(&report->tune->schemes[trial->scheme], trial->value, scenario);
    if (scenario->run.step == 0.0) {
        *scenario = chosen_run_scenario(scenario, report->tune->program.step_s);
    }
    scenario->run.step = report->tune->program.step_s;
}

bool tune_export_code(const TuneReport *report, Text *text, Err *err)
{
    const TuneProgram *program = &report->tune->program;
    // the setting with the program's own step
    TuneTrial trial = report->tune->trials[program->trial];
    if (scheme_has_step(&report->tune->schemes[trial.scheme].scheme)) {
        trial.value = program->step_s;
    }
    Scenario *scenario = malloc(sizeof *scenario);
    assert(scenario != NULL);
    take_program(report, scenario);
    Text words;
    Text command;
    text_init(&words);
    text_init(&command);
    tune_setting_words(report, &trial, &words);
    tune_setting_command(report, &trial, " ", &command);
    const TuneCode code = {.scenario = scenario,
                           .words = words.data,
                           .command = command.data,
                           .error = program->error,
                           .target = report->tune->target,
                           .step_first_s = program->step_first_s,
                           .error_first = program->error_first};
    const bool is_written = tune_world_write(&code, text, err);
    text_finish(&words);
    text_finish(&command);
    free(scenario);
    return is_written;
}

// Text, each line moved in by four spaces.
static void append_indented(const char *lines, Text *text)
{
    while (*lines != '\0') {
        const size_t length = strcspn(lines, "\n");
        text_append(text, "%s%.*s\n", length > 0 ? "    " : "", (int)length, lines);
        lines += length + (lines[length] == '\n' ? 1 : 0);
    }
}

// What the program of --code is worth.
static void write_program(const TuneProgram *program, Text *text)
{
    if (isnan(program->error)) {
        text_append(text, "  Run with libjointplay, the setting has no error: %s.\n",
                    program->reason);
        return;
    }
    text_append(text,
                "  Run with libjointplay, at steps of %.3g ms, the setting has an error of "
                "%.3g at the times that the program of --code prints.",
                program->step_s * UNITS_MS, program->error);
    if (program->step_s < program->step_first_s) {
        text_append(text, " At the %.3g ms found above it would be %.3g, so the step is shorter.",
                    program->step_first_s * UNITS_MS, program->error_first);
    }
    text_append(text, " Compile it with: cc FILE.c -o run $(pkg-config --cflags --libs jointplay) "
                      "-lm\n");
}

static void tune_export_write_code(const TuneReport *report, const Style *style, Text *text)
{
    text_append(text, "\n%sAs ODE C code%s\n\n", style->heading, style->end);
    if (tune_export_trial(report) == NULL) {
        text_append(text, "  There is no setting to write.\n");
        return;
    }
    const TuneProgram *program = &report->tune->program;
    const char *lacks = tune_export_lacks(report);
    if (program->is_run) {
        write_program(program, text);
    } else if (report->scenario->linkage.is_spatial) {
        text_append(text, "  There is none: programs are written for cases in the plane alone.\n");
    } else if (lacks != NULL) {
        text_append(text, "  There is none: %s.\n", lacks);
    } else {
        text_append(text, "  --code FILE.c writes the setting as a short program against "
                          "libjointplay, for worlds of your own: cc FILE.c -o run $(pkg-config "
                          "--cflags --libs jointplay) -lm\n");
    }
}

const TuneTrial *tune_export_plain(const Tune *tune)
{
    if (tune->held_s > 0.0) {
        return tune->held_plain != TUNE_NONE ? &tune->trials[tune->held_plain] : NULL;
    }
    return tune_best(tune, tune->plain);
}

// The best setting for a loop that cannot be changed, and what it costs.
static void tune_export_write_loop(const TuneReport *report, const Style *style, Text *text)
{
    const Tune *tune = report->tune;
    const TuneTrial *plain = tune_export_plain(tune);
    const TuneTrial *winner = tune_best(tune, tune->winner);
    if (!scenario_has_clearance(report->scenario)) {
        return;
    }
    text_append(text, "\n%sIn a loop of your own%s\n\n", style->heading, style->end);
    if (tune->held_s > 0.0) {
        tune_held_text_row(tune, text);
        text_append(text, "\n");
    }
    if (plain == NULL) {
        if (tune->held_s > 0.0) {
            text_append(text, "  No plain step with ERP and CFM alone has a meaningful error at "
                              "this step.\n");
            return;
        }
        text_append(text, "  No plain step with ERP and CFM alone that was tried meets the error; "
                          "the schemes above say how far each came.\n");
        return;
    }
    text_append(text, "  ERP and CFM alone, in a loop that steps as ODE's manual says: ");
    tune_setting_words(report, plain, text);
    text_append(text, ", error %.3g", plain->error);
    if (winner != NULL && tune->plain != tune->winner && tune->held_s == 0.0) {
        const double ratio = tune_trial_cost(tune, plain) / tune_trial_cost(tune, winner);
        text_append(text, "; %.3g times the %s of the cheapest", ratio,
                    tune->cost == TUNE_STEPS ? "world steps" : "time");
    }
    text_append(text, ".\n\n");
    Text lines;
    text_init(&lines);
    if (tune_snippet_write(report, plain, &lines)) {
        append_indented(lines.data, text);
    } else {
        text_append(text, "  The map needs more than a few lines%s.\n",
                    tune_export_is_writable(report)
                        ? "; --schemes direct/plain/corrected --code FILE.c has them all"
                        : "");
    }
    text_finish(&lines);
}

static void write_linears(const TuneReport *report, const Style *style, Text *text)
{
    const Tune *tune = report->tune;
    const JointUnits *units = joint_units(&report->scenario->linkage.joints[tune->contact.joint]);
    const SectionHead heads[] = {
        {"spring at", units->length, TABLE_RIGHT},
        {"spring", units->stiffness, TABLE_RIGHT},
        {"damper", units->damping, TABLE_RIGHT},
        {"step", "us", TABLE_RIGHT},
        {"error", "1", TABLE_RIGHT},
        {"", "", TABLE_WRAP},
    };
    Table *table = section_begin("A contact with constants", 6, heads, style, text);
    for (size_t i = 0; i < tune->linear_count; i++) {
        const TuneLinear *linear = &tune->linears[i];
        table_cell(table, "%.3g", linear->depth * units_per_si(units->length));
        table_cell(table, "%.4g", linear->stiffness);
        table_cell(table, "%.4g", linear->damping);
        table_cell(table, "%.4g", linear->step_s * UNITS_US);
        section_finite(table, "%.2e", linear->error);
        table_cell(table, "%s",
                   (int)i == tune->linear                                    ? "taken"
                   : linear->error + tune->truth.uncertainty <= tune->target ? "met in this run"
                                                                             : linear->reason);
    }
    section_end(table, text);
}

static void write_gazebo(const TuneReport *report, const Style *style, Text *text)
{
    const Tune *tune = report->tune;
    if (tune->linear_count == 0) {
        if (scenario_has_clearance(report->scenario)) {
            text_append(text, "\n%sAs Gazebo SDF and MuJoCo MJCF%s\n\n  There is none: %s.\n",
                        style->heading, style->end, tune_linear_lacks(report->scenario, tune));
        }
        return;
    }
    const JointUnits *units = joint_units(&report->scenario->linkage.joints[tune->contact.joint]);
    if (tune->held_s > 0.0) {
        tune_held_text_constants(report, style, text);
    } else {
        write_linears(report, style, text);
    }
    text_append(text,
                "  Gazebo and MuJoCo have a constant spring and damper a contact, and plain steps. "
                "These were run in ODE with the textbook map, against the law itself; the damper "
                "%sgives an impact on %.4g %s the law's own restitution.\n",
                tune->held_s > 0.0 ? "beside the law's spring " : "", tune->contact.mass,
                units->mass);
    if (tune->held_s > 0.0) {
        text_append(text, "  Those for an impact are the best for a lone one at this step, as by "
                          "`map --at-step`; a row without kp and kd has no such pair.\n");
    }
    TuneGazebo gazebo;
    text_append(text, "\n%sAs Gazebo SDF%s\n\n", style->heading, style->end);
    if (!tune_gazebo_find(tune, &gazebo)) {
        text_append(text, "  There is none: %s.\n", tune_linear_lacks(report->scenario, tune));
        return;
    }
    if (!isfinite(tune->target)) {
        text_append(text, "  At a step of %.4g us the error of the whole motion is %.2g.\n\n",
                    gazebo.step_s * UNITS_US, gazebo.error);
    } else if (gazebo.error + tune->truth.uncertainty <= tune->target) {
        text_append(text, "  Meets the error with a step of %.4g us: %.2g.\n\n",
                    gazebo.step_s * UNITS_US, gazebo.error);
    } else {
        text_append(
            text,
            "  Gazebo's constants do not reach %.3g here: of those in the table the best is %.2g "
            "off, at a step of %.4g us.\n\n",
            tune->target, gazebo.error, gazebo.step_s * UNITS_US);
    }
    Text lines;
    text_init(&lines);
    tune_gazebo_write(report, &lines);
    append_indented(lines.data, text);
    text_finish(&lines);
}

static void write_mujoco(const TuneReport *report, const Style *style, Text *text)
{
    TuneMujoco mujoco;
    if (!tune_mujoco_find(report, &mujoco)) {
        return;
    }
    text_append(text, "\n%sAs MuJoCo MJCF%s\n\n", style->heading, style->end);
    const TuneModel *model = &report->tune->model;
    if (model->text != NULL) {
        text_append(
            text,
            "  The whole mechanism, with the same spring and damper: run in %s with steps of "
            "%.3g us it has an error of %.2g. --mjcf FILE.xml writes it.\n",
            model->engine, model->step_s * UNITS_US, model->error);
        return;
    }
    if (model->reason[0] != '\0') {
        text_append(text, "  There is no whole model: %s.\n\n", model->reason);
    }
    text_append(
        text,
        "  The same spring and damper. Not run here. What does not carry over: the exponent "
        "of the law, damping that grows with depth, and a share %.1g of the acceleration "
        "without contact.\n\n",
        mujoco.impedance);
    if (tune_mujoco_is_finer(report, &mujoco)) {
        text_append(
            text,
            "  MuJoCo's spring is explicit and needs a shorter step than the one asked for: "
            "the timestep here is %.3g us.\n\n",
            mujoco.step_s * UNITS_US);
    }
    Text lines;
    text_init(&lines);
    tune_mujoco_write(report, &lines);
    append_indented(lines.data, text);
    text_finish(&lines);
}

void tune_export_write(const TuneReport *report, const Style *style, Text *text)
{
    tune_export_write_code(report, style, text);
    tune_export_write_loop(report, style, text);
    write_gazebo(report, style, text);
    write_mujoco(report, style, text);
}
