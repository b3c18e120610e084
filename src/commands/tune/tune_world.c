// How is a setting written as a program against libjointplay, as short as a user would write it?
//
// Bodies, hinges, sliders, motors and forces are ODE's; what has play is a joint of the library,
// and jp_world_step steps them. A body that is driven at a speed has a motor without a bound.
// Springs, and a torque over time, push where the step evaluates forces.
#include "commands/tune/tune_world.h"

#include "base/zeroed.h"
#include "commands/tune/tune_code_text.h"
#include "commands/tune/tune_world_forces.h"
#include "commands/tune/tune_world_joints.h"
#include "write/number.h"

#include <math.h>

static const char *lacks_setting(const Scenario *scenario)
{
    const bool has_rows =
        scenario_has_clearance(scenario) && !scenario_integrates_contacts(scenario);
    if (scenario->ode.stepping == ODE_EXTRAPOLATED) {
        return "libjointplay does not extrapolate from several worlds; --schemes direct/staggered "
               "has a setting for it";
    }
    if (has_rows && scenario->ode.collider != ODE_COLLIDER_PIN_HOLE) {
        return "libjointplay has round holes and no polygons in their place";
    }
    return NULL;
}

static const char *lacks_joint(const Scenario *scenario, const Joint *joint)
{
    switch (joint->kind) {
    case JOINT_GUIDE:
        return "libjointplay has no block between guides";
    case JOINT_STOP:
        return "libjointplay has no disc that meets a wall or another disc";
    case JOINT_GEAR:
        return "libjointplay has no pair of gears";
    default:
        break;
    }
    return linkage_has_play(joint) && scenario->contact.damping == DAMPING_EXACT &&
                   scenario_restitution(scenario, joint) == 0.0 && !(joint->contact.viscous > 0.0)
               ? "libjointplay has damping exact for restitutions above 0 alone"
               : NULL;
}

const char *tune_world_lacks(const Scenario *scenario)
{
    const Linkage *linkage = &scenario->linkage;
    const char *lacks = lacks_setting(scenario);
    for (size_t i = 0; i < linkage->joint_count && lacks == NULL; i++) {
        lacks = lacks_joint(scenario, &linkage->joints[i]);
    }
    for (size_t i = 0; i < linkage->torsion_count && lacks == NULL; i++) {
        if (linkage->joints[linkage->torsions[i].joint].kind != JOINT_REVOLUTE) {
            lacks = "the program has springs that turn the two sides of a hinge alone";
        }
    }
    return lacks;
}

double tune_world_every(const Scenario *scenario)
{
    return fmax(1.0, round(scenario_sample_time(scenario, 1) / scenario->run.step));
}

static void write_includes(const Scenario *scenario, Text *text)
{
    const double step_s = scenario->run.step;
    const double every = tune_world_every(scenario);
    // what is left of the last step is rounding
    const double steps = ceil(scenario_duration(scenario) / step_s - 1e-6);
    text_append(text,
                "\n#include <jointplay/jointplay.h>\n#include <math.h>\n#include <stdio.h>\n"
                "#include <stdlib.h>\n\n"
                "static const double STEP = %s; // s\n"
                "static const int STEPS = %.0f, EVERY = %.0f; // from line to line\n\n"
                "static dWorldID world;\n",
                number_shortest(step_s).text, steps, every);
}

// The bodies and joints, which main makes.
static void write_names(const Linkage *linkage, Text *text)
{
    text_append(text, "static dBodyID ");
    for (int i = 0; i < (int)linkage->body_count; i++) {
        text_append(text, "%s", i > 0 ? ", " : "");
        tune_world_body(linkage, i, text);
    }
    text_append(text, ";\n");
    bool is_first = true;
    for (int i = 0; i < (int)linkage->joint_count; i++) {
        if (tune_world_is_ideal(linkage, i)) {
            text_append(text, "%s", is_first ? "static dJointID " : ", ");
            tune_world_joint(linkage, i, text);
            is_first = false;
        }
    }
    text_append(text, "%s", is_first ? "" : ";\n");
}

// Whether the program makes a joint of ODE of a kind.
static bool makes(const Linkage *linkage, JointKind kind)
{
    for (int i = 0; i < (int)linkage->joint_count; i++) {
        if (linkage->joints[i].kind == kind && tune_world_is_ideal(linkage, i)) {
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
    text_append(text, "%s", makes(linkage, JOINT_REVOLUTE) ? MAKE_HINGE : "");
    text_append(text, "%s", makes(linkage, JOINT_PRISMATIC) ? MAKE_SLIDER : "");
    tune_world_push(linkage, text);
    text_append(text, "%s%s", CHECK, PRINT_ROW);
}

static void write_body(const Linkage *linkage, int number, Text *text)
{
    const Body *body = &linkage->bodies[number];
    const bool is_led = tune_world_is_led(linkage, number);
    const Motion *start = &body->start;
    const Vec2 at = is_led ? linkage->joints[linkage->driver.joint].anchor_a : start->position;
    const Vec2 speed = is_led ? (Vec2){0.0, 0.0} : start->velocity;
    const double numbers[] = {body->mass,   body->inertia, at.x,    at.y,
                              start->angle, speed.x,       speed.y, start->omega};
    text_append(text, "    ");
    tune_world_body(linkage, number, text);
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
                "    dWorldSetGravity(world, 0, %s, 0);\n"
                "    dWorldSetERP(world, %s); // of ODE's joints\n",
                number_shortest(0.0 - scenario->gravity).text,
                number_shortest(is_plain ? scenario->ode.erp : TUNE_WORLD_ERP).text);
    for (int i = 0; i < (int)linkage->body_count; i++) {
        write_body(linkage, i, text);
    }
    for (int i = 0; i < (int)linkage->joint_count; i++) {
        tune_world_ideal(linkage, i, text);
    }
    tune_world_motors(linkage, text);
}

static bool write_play(const Scenario *scenario, Text *text, Err *err)
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
    return true;
}

// The bodies as a list, all of them known to the library, and the head of the table.
static void write_list(const Linkage *linkage, Text *text)
{
    text_append(text, "\n    const dBodyID bodies[] = {");
    for (int i = 0; i < (int)linkage->body_count; i++) {
        text_append(text, "%s", i > 0 ? ", " : "");
        tune_world_body(linkage, i, text);
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
        const char *of = tune_world_is_led(linkage, (int)i) ? "_pivot" : "";
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
    const bool is_pin = joint->kind == JOINT_CLEARANCE;
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
    write_names(linkage, text);
    write_functions(scenario, text);
    write_world(scenario, text);
    if (!write_play(scenario, text, err)) {
        return false;
    }
    write_list(linkage, text);
    write_loop(linkage, text);
    write_end(linkage, text);
    return true;
}
