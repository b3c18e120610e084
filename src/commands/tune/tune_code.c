// How is a setting written as a C program that needs ODE alone?
//
// One file: the sources that this way of stepping is made of, the laws of the joints and the
// scenario as data, and a main that runs it. Laws are worked out here, so that no root finder
// is needed. Numbers are written so that they read back to the last bit.
#include "commands/tune/tune_code.h"

#include "commands/tune/tune_code_forces.h"
#include "commands/tune/tune_code_text.h"
#include "commands/tune/tune_sources.h"
#include "contact/law.h"
#include "contact/penalty.h"
#include "write/number.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

enum { FILE_NAME_SIZE = 64 };

#define IDENTIFIER(id, ...) #id,

#define TABLE(id, word, solver) #solver,

// A way of stepping: the file it is in, without its ending, and its table of functions.
typedef struct Stepping {
    const char *file;
    const char *table;
} Stepping;

static Stepping stepping_of(const Scenario *scenario)
{
    static const char *const TABLES[] = {OPTIONS_ODE_STEPPING_LIST(TABLE)};
    const OdeStepping stepping = scenario->ode.stepping;
    return scenario_integrates_contacts(scenario)
               ? (Stepping){"impulse", "STEPPING_IMPULSE"}
               : (Stepping){OPTIONS_ODE_STEPPINGS[stepping], TABLES[stepping]};
}

// The collider's table of functions, which has the name of its file. Contacts that are integrated
// within the step ask none, yet the world has one.
static const char *collider_of(const Scenario *scenario)
{
    static const char *const TABLES[] = {OPTIONS_ODE_COLLIDER_LIST(TABLE)};
    return TABLES[scenario->ode.collider];
}

static bool asks_libccd(const Scenario *scenario)
{
    return scenario->ode.collider == ODE_COLLIDER_STAVES ||
           scenario->ode.collider == ODE_COLLIDER_STAVES_GJK;
}

static void write_vec2(const char *name, Vec2 value, Text *text)
{
    text_append(text, "%s{%s, %s}", name, number_shortest(value.x).text,
                number_shortest(value.y).text);
}

static void write_body(const Body *body, Text *text)
{
    text_append(text, "        {.name = ");
    tune_code_string(body->name, text);
    text_append(text, ",\n         .mass = %s, // kg\n         .inertia = %s, // kg m^2\n",
                number_shortest(body->mass).text, number_shortest(body->inertia).text);
    write_vec2("         .start = {.position = ", body->start.position, text);
    text_append(text, ",\n                   .angle = %s,\n",
                number_shortest(body->start.angle).text);
    write_vec2("                   .velocity = ", body->start.velocity, text);
    text_append(text, ",\n                   .omega = %s,\n",
                number_shortest(body->start.omega).text);
    write_vec2("                   .acceleration = ", body->start.acceleration, text);
    text_append(text, ",\n                   .alpha = %s}},\n",
                number_shortest(body->start.alpha).text);
}

// What a joint that slides or stops has beside.
static void write_sliding(const Joint *joint, Text *text)
{
    const Guide *guide = &joint->guide;
    const Stop *stop = &joint->stop;
    text_append(text, "         .direction = %s, // rad\n         .held_angle = %s,\n",
                number_shortest(joint->direction).text, number_shortest(joint->held_angle).text);
    text_append(text,
                "         .guide = {.opening = %s, // m\n                   .height = %s,\n"
                "                   .length = %s,\n",
                number_shortest(guide->opening).text, number_shortest(guide->height).text,
                number_shortest(guide->length).text);
    write_vec2("                   .start = ", guide->start, text);
    text_append(text,
                "},\n         .stop = {.is_disc = %s,\n                  .radius_a = %s, // m\n"
                "                  .radius_b = %s},\n",
                stop->is_disc ? "true" : "false", number_shortest(stop->radius_a).text,
                number_shortest(stop->radius_b).text);
}

static void write_joint(const Joint *joint, Text *text)
{
    static const char *const KINDS[] = {
        [JOINT_REVOLUTE] = "JOINT_REVOLUTE",   [JOINT_CLEARANCE] = "JOINT_CLEARANCE",
        [JOINT_PRISMATIC] = "JOINT_PRISMATIC", [JOINT_GUIDE] = "JOINT_GUIDE",
        [JOINT_STOP] = "JOINT_STOP",           [JOINT_GEAR] = "JOINT_GEAR",
    };
    const Clearance *clearance = &joint->clearance;
    text_append(text, "        {.name = ");
    tune_code_string(joint->name, text);
    text_append(text, ",\n         .kind = %s,\n         .body_a = %d,\n         .body_b = %d,\n",
                KINDS[joint->kind], joint->body_a, joint->body_b);
    write_vec2("         .anchor_a = ", joint->anchor_a, text);
    write_vec2(",\n         .anchor_b = ", joint->anchor_b, text);
    text_append(text, ",\n");
    if (joint->kind != JOINT_REVOLUTE && joint->kind != JOINT_CLEARANCE) {
        write_sliding(joint, text);
    }
    tune_code_limits(joint, text);
    if (joint->contact.has_restitution) {
        text_append(text, "         .contact = {.has_restitution = true, .restitution = %s},\n",
                    number_shortest(joint->contact.restitution).text);
    }
    text_append(text,
                "         .clearance = {.hole_radius = %s, // m\n"
                "                       .pin_radius = %s,\n"
                "                       .width = %s,\n",
                number_shortest(clearance->hole_radius).text,
                number_shortest(clearance->pin_radius).text,
                number_shortest(clearance->width).text);
    write_vec2("                       .start = ", clearance->start, text);
    text_append(text, "}},\n");
}

static void write_linkage(const Linkage *linkage, Text *text)
{
    text_append(text, "    .linkage.body_count = %zu,\n    .linkage.bodies = (Body[]){\n",
                linkage->body_count);
    for (size_t i = 0; i < linkage->body_count; i++) {
        write_body(&linkage->bodies[i], text);
    }
    text_append(text, "    },\n    .linkage.joint_count = %zu,\n    .linkage.joints = (Joint[]){\n",
                linkage->joint_count);
    for (size_t i = 0; i < linkage->joint_count; i++) {
        write_joint(&linkage->joints[i], text);
    }
    text_append(text, "    },\n");
    const Driver *driver = &linkage->driver;
    if (driver->is_present) {
        text_append(text,
                    "    .linkage.driver = {.is_present = true,\n"
                    "                       .joint = %d,\n"
                    "                       .speed = %s, // rad/s\n"
                    "                       .start = %s}, // rad\n",
                    driver->joint, number_shortest(driver->speed).text,
                    number_shortest(driver->start).text);
    }
    if (driver->speeds.count > 0) {
        tune_code_table("linkage.driver.speeds", &driver->speeds, "rad/s", text);
    }
}

static void write_points(const Scenario *scenario, Text *text)
{
    text_append(text, "    .point_count = %zu,\n", scenario->point_count);
    for (size_t i = 0; i < scenario->point_count; i++) {
        const TracedPoint *point = &scenario->points[i];
        text_append(text, "    .points[%zu] = {.name = ", i);
        tune_code_string(point->name, text);
        text_append(text, ", .body = %d, ", point->body);
        write_vec2(".local = ", point->local, text);
        text_append(text, "},\n");
    }
}

static void write_contact(const Scenario *scenario, Text *text)
{
    const ContactOptions *contact = &scenario->contact;
    const double penalty = contact->penalty > 0.0 ? contact->penalty
                                                  : penalty_estimate(scenario->linkage.driver.speed,
                                                                     &scenario->material);
    text_append(text, "    .gravity = %s, // m/s^2, along -y\n",
                number_shortest(scenario->gravity).text);
    text_append(text, "    .material = {.youngs_modulus = %s, .poisson_ratio = %s},\n",
                number_shortest(scenario->material.youngs_modulus).text,
                number_shortest(scenario->material.poisson_ratio).text);
    text_append(text,
                "    .contact = {.model = %s,\n"
                "                .restitution = %s,\n"
                "                .friction = %s,\n"
                "                .friction_speed = %s, // m/s\n"
                "                .impact_speed_floor = %s,\n"
                "                .penalty = %s, // N s/m\n"
                "                .bounce_speed = %s}, // m/s\n",
                contact->model == CONTACT_IMPACT ? "CONTACT_IMPACT" : "CONTACT_POISSON",
                number_shortest(contact->restitution).text, number_shortest(contact->friction).text,
                number_shortest(contact->friction_speed).text,
                number_shortest(contact->impact_speed_floor).text, number_shortest(penalty).text,
                number_shortest(contact->bounce_speed).text);
}

static void write_run(const Scenario *scenario, Text *text)
{
    const RunOptions *run = &scenario->run;
    const OdeOptions *ode = &scenario->ode;
    static const char *const SOLVERS[] = {"ODE_DIRECT", "ODE_QUICK"};
    static const char *const STEPPINGS[] = {OPTIONS_ODE_STEPPING_LIST(IDENTIFIER)};
    static const char *const MAPS[] = {OPTIONS_ODE_MAP_LIST(IDENTIFIER)};
    static const char *const COLLIDERS[] = {OPTIONS_ODE_COLLIDER_LIST(IDENTIFIER)};
    static const char *const POLYGONS[] = {"ODE_CIRCUMSCRIBED", "ODE_INSCRIBED"};
    text_append(text,
                "    .run = {.revolutions = %s,\n"
                "            .duration = %s, // s, without a drive\n"
                "            .samples = %zu,\n"
                "            .step = %s, // s\n"
                "            .tolerance = %s},\n",
                number_shortest(run->revolutions).text, number_shortest(run->duration).text,
                run->samples, number_shortest(run->step).text,
                number_shortest(run->tolerance).text);
    text_append(text, "    .reference = {.tolerance = %s},\n",
                number_shortest(scenario->reference.tolerance).text);
    text_append(text,
                "    .ode = {.solver = %s,\n"
                "            .stepping = %s,\n"
                "            .map = %s,\n"
                "            .collider = %s,\n"
                "            .polygon = %s,\n            .facets = %zu,\n"
                "            .erp = %s,\n            .cfm = %s,\n"
                "            .push_out = %s,\n"
                "            .iterations = %zu,\n            .over_relaxation = %s,\n"
                "            .seed = %zu,\n            .settle_steps = %zu,\n"
                "            .levels = %zu,\n            .gear = %zu,\n"
                "            .contact_phase = %s},\n",
                SOLVERS[ode->solver], STEPPINGS[ode->stepping], MAPS[ode->map],
                COLLIDERS[ode->collider], POLYGONS[ode->polygon], ode->facets,
                number_shortest(ode->erp).text, number_shortest(ode->cfm).text,
                number_shortest(ode->push_out).text, ode->iterations,
                number_shortest(ode->over_relaxation).text, ode->seed, ode->settle_steps,
                ode->levels, ode->gear, number_shortest(ode->contact_phase).text);
}

static void write_scenario(const Scenario *scenario, Text *text)
{
    text_append(text, "\n// ---- the scenario: SI and radians ----\n\n"
                      "static const Scenario SCENARIO = {\n    .title = ");
    tune_code_string(scenario->title, text);
    text_append(text, ",\n");
    write_linkage(&scenario->linkage, text);
    tune_code_forces(&scenario->linkage, text);
    write_points(scenario, text);
    write_contact(scenario, text);
    write_run(scenario, text);
    text_append(text, "};\n");
}

// The laws, worked out: what the sources that are not here would have found.
static bool write_laws(const Scenario *scenario, Text *text, Err *err)
{
    const Linkage *linkage = &scenario->linkage;
    text_append(text, "\n// ---- the contact laws, by joint ----\n\n"
                      "static const ForceLaw JOINT_LAWS[] = {\n");
    if (!scenario_has_clearance(scenario)) {
        text_append(text, "    {0}, // no joint has play\n");
    }
    for (size_t i = 0; i < linkage->joint_count; i++) {
        ForceLaw law;
        if (!linkage_has_play(&linkage->joints[i])) {
            continue;
        }
        if (!law_of_joint(scenario, &linkage->joints[i], &law, err)) {
            return false;
        }
        text_append(text,
                    "    [%zu] = {.family = %s,\n"
                    "           .stiffness = %s, // K, N/m^n\n"
                    "           .exponent = %s, // n\n"
                    "           .compliance = %s,\n           .offset = %s,\n"
                    "           .log_scale = %s,\n"
                    "           .hysteresis = %s, // chi\n"
                    "           .viscous = %s, // c, N s/m\n"
                    "           .impact_speed_floor = %s}, // m/s\n",
                    i, law.family == FORCE_LAW_POWER ? "FORCE_LAW_POWER" : "FORCE_LAW_LOGARITHMIC",
                    number_shortest(law.stiffness).text, number_shortest(law.exponent).text,
                    number_shortest(law.compliance).text, number_shortest(law.offset).text,
                    number_shortest(law.log_scale).text, number_shortest(law.hysteresis).text,
                    number_shortest(law.viscous).text,
                    number_shortest(law.impact_speed_floor).text);
    }
    text_append(text, "};\n\n"
                      "bool law_of_joint(const Scenario *scenario, const Joint *joint, ForceLaw "
                      "*law, Err *err)\n{\n    (void)err;\n"
                      "    *law = JOINT_LAWS[joint - scenario->linkage.joints];\n"
                      "    return true;\n}\n");
    return true;
}

static void write_head(const TuneCode *code, Text *text)
{
    tune_code_head(code, "", asks_libccd(code->scenario) ? "-lode -lccd -lm" : "-lode -lm", text);
    text_append(
        text, "//\n// The numbers of this mechanism stand at the end: the scenario, its contact "
              "laws, main.\n// What comes before them is jointplay's own way of stepping, joined "
              "from its sources:\n// Copyright (c) 2026, the jointplay authors. BSD 3-Clause "
              "License: redistribution and use, with\n// or without modification, are permitted "
              "with this notice; there is no warranty of any kind.\n"
              "// SPDX-License-Identifier: BSD-3-Clause\n\n"
              "#ifndef _GNU_SOURCE\n#define _GNU_SOURCE // M_PI, whatever the standard asked "
              "for\n#endif\n\n"
              "// the same numbers with and without fused multiply-add\n"
              "#if defined(__clang__)\n#pragma STDC FP_CONTRACT OFF\n"
              "#elif defined(__GNUC__)\n#pragma GCC optimize(\"fp-contract=off\")\n#endif\n"
              "// headers have constants and functions that this run makes no use of\n"
              "#if defined(__GNUC__)\n#pragma GCC diagnostic ignored \"-Wunused-const-variable\"\n"
              "#pragma GCC diagnostic ignored \"-Wunused-function\"\n"
              "#endif\n");
}

// What stands for the list of all colliders.
static void write_collider(const char *table, Text *text)
{
    text_append(text,
                "\n// ---- the collider ----\n\n"
                "const Collider *collider_get(OdeCollider kind)\n{\n    (void)kind;\n"
                "    return &%s;\n}\n",
                table);
}

static void write_main(const Stepping *stepping, Text *text)
{
    text_append(text,
                "\n// ---- main ----\n\n"
                "// run_scenario opens the solver, steps it, looks at every step and at every "
                "sample, and closes it.\n"
                "int main(void)\n{\n"
                "    const RunWatch nobody = {NULL, NULL};\n"
                "    Trajectory *run = run_scenario(&SCENARIO, &%s, nobody);\n"
                "    if (!run->is_complete) {\n"
                "        fprintf(stderr, \"%%s\\n\", run->message);\n"
                "        return 4;\n"
                "    }\n"
                "    series_rows_write(&SCENARIO, run, stdout);\n"
                "    fprintf(stderr, \"%%s: %%zu world steps in %%.4g ms, hash %%016llx\\n\", "
                "run->label, run->steps,\n"
                "            1e3 * run->wall_s, (unsigned long long)run->hash);\n"
                "    trajectory_destroy(run);\n"
                "    return fflush(stdout) == 0 ? 0 : 5;\n}\n",
                stepping->table);
}

bool tune_code_write(const TuneCode *code, Text *text, Err *err)
{
    const Stepping stepping = stepping_of(code->scenario);
    const char *collider = collider_of(code->scenario);
    char taking_steps[FILE_NAME_SIZE];
    char finding_contacts[FILE_NAME_SIZE];
    snprintf(taking_steps, sizeof taking_steps, "ode/%s.c", stepping.file);
    snprintf(finding_contacts, sizeof finding_contacts, "ode/%s.c", collider);
    const char *files[] = {"run/run.c", "write/series_rows.c", taking_steps, finding_contacts};
    write_head(code, text);
    if (!tune_sources_write(files, sizeof files / sizeof files[0], text, err)) {
        return false;
    }
    // without contacts no law is needed
    const bool has_laws = strstr(text->data, "---- contact/law.h ----") != NULL;
    if (has_laws && !write_laws(code->scenario, text, err)) {
        return false;
    }
    write_collider(collider, text);
    write_scenario(code->scenario, text);
    write_main(&stepping, text);
    return true;
}
