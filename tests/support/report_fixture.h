// A case with play and its runs, made by hand: one that is the truth, one that differs, one that
// failed.
#pragma once

#include "commands/run/run_report.h"
#include "write/units.h"

#include "close.h"
#include "kept.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { SAMPLES = 5, RUNS = 3 };

typedef struct Fixture {
    Scenario scenario;
    Trajectory *runs[RUNS];
    TrajectoryError errors[RUNS];
    AnalyticSummary summary;
    Stackup stackup;
    RunReport report;
} Fixture;

static inline void make_linkage(Scenario *scenario)
{
    static const char *const BODIES[3] = {"crank", "coupler", "follower"};
    static const char *const JOINTS[4] = {"ground-crank", "crank-coupler", "coupler-follower",
                                          "follower-ground"};
    Linkage *linkage = &scenario->linkage;
    linkage->body_count = 3;
    linkage->joint_count = 4;
    for (int i = 0; i < 3; i++) {
        strcpy(linkage->bodies[i].name, BODIES[i]);
        linkage->bodies[i].mass = 0.1 + 0.1 * i;
        linkage->bodies[i].inertia = 1e-3;
        linkage->bodies[i].start.position = (Vec2){0.1 * i, 0.05 * i * i};
    }
    for (int i = 0; i < 4; i++) {
        strcpy(linkage->joints[i].name, JOINTS[i]);
        linkage->joints[i].body_a = i == 0 ? LINKAGE_GROUND : i - 1;
        linkage->joints[i].body_b = i == 3 ? LINKAGE_GROUND : i;
        linkage->joints[i].anchor_a = (Vec2){0.05, 0.0};
        linkage->joints[i].anchor_b = (Vec2){-0.05, 0.01};
    }
    linkage->joints[1].kind = JOINT_CLEARANCE;
    linkage->joints[1].clearance =
        (Clearance){.hole_radius = 5.0075e-3, .pin_radius = 4.993e-3, .width = 13e-3};
    linkage->driver = (Driver){.is_present = true, .joint = 0, .speed = 100.0, .start = 0.5};
}

static inline Trajectory *make_run(const Scenario *scenario, const char *backend, double shift)
{
    Trajectory *run = trajectory_create(scenario, backend);
    for (size_t i = 0; i < run->sample_count; i++) {
        Sample sample = sample_create(&scenario->linkage);
        sample.time_s = scenario_sample_time(scenario, i);
        sample.crank_rad = linkage_crank_angle(&scenario->linkage, sample.time_s);
        for (size_t k = 0; k < run->body_count; k++) {
            sample.bodies[k].angle = 0.25 * (double)i;
            sample.bodies[k].omega = sin((double)(i + k)) + shift;
            sample.bodies[k].alpha = 1.0 / 3.0;
        }
        sample.joints[1].eccentricity = (Vec2){1e-6 * (double)i, -2e-6};
        sample.joints[1].gap = 1.25e-6;
        sample.joints[1].force = 10.0 * (double)i;
        trajectory_store(run, i, &sample);
        sample_free(&sample);
    }
    run->is_complete = true;
    run->duration_s = scenario_duration(scenario);
    run->steps = 2000;
    run->wall_s = 0.004;
    run->hash = 0x0123456789abcdefu;
    run->bodies[1].omega_max = (Extreme){42.2008, 0.01, 6.7};
    run->bodies[1].alpha_min = (Extreme){-11970.4, 0.02, -0.1};
    return run;
}

static inline void add_contacts(Trajectory *run)
{
    JointExtremes *extremes = &run->joints[1];
    extremes->impacts = 17;
    extremes->force_max = (Extreme){1234.5, 0.03, 3.0};
    extremes->penetration_max = (Extreme){2.5e-6, 0.03, 3.0};
    extremes->impulse = 0.75;
    extremes->contact_time = 0.25 * run->duration_s;
    extremes->spike_count = 7;
    for (size_t i = 0; i < extremes->spike_count; i++) {
        extremes->spikes[i] = (Spike){
            .onset_s = 0.030 + 1e-3 * (double)i,
            .crank_rad = 3.0 + 0.1 * (double)i,
            .duration_s = 5e-5,
            .force_max = 1234.5 - 100.0 * (double)i,
            .impulse = 0.01,
            .penetration_max = 2.5e-6,
            .approach_speed = 0.0312,
        };
    }
    run->step_s = 1e-6;
    run->constraint_rows = 8;
    run->contact_rows = 1;
}

// Spikes of the coupler and of no other body, in the second run; none of the joint with play.
static inline void add_spikes(Fixture *fixture)
{
    Trajectory *run = fixture->runs[1];
    run->alpha_spikes[1] = (SignalSpikes){
        .is_known = true, .threshold = 2e4, .resolution = 400.0, .count = 40, .kept = 1};
    run->alpha_spikes[1].spikes[0] = (SignalSpike){
        .onset_s = 0.01,
        .time_s = 0.011,
        .end_s = 0.012,
        .crank_rad = 3.0,
        .value = -91000.0,
        .prominence = 90000.0,
        .width_s = 4e-5,
        .impulse = -3.5,
        .joint = 1,
    };
    run->alpha_spikes[1].sectors[12] = (SignalSector){3, 50000.0};
    run->alpha_spikes[1].sectors[17] = (SignalSector){36, 91000.0};
    run->alpha_spikes[1].sectors[29] = (SignalSector){1, 60000.0};
    run->force_spikes[1] = (SignalSpikes){.is_known = true, .threshold = 1500.0};
}

static inline void make_summary(Fixture *fixture)
{
    fixture->summary = (AnalyticSummary){
        .grashof = GRASHOF_CRANK_ROCKER,
        .transmission_low = 30.74 / UNITS_DEG,
        .transmission_high = 82.32 / UNITS_DEG,
        .follower_low = 84.83 / UNITS_DEG,
        .follower_high = 142.02 / UNITS_DEG,
        .has_limits = true,
        .limit_extended = 0.7,
        .limit_folded = 3.9,
        .torque_max = {55.5, 0.0, 1.0},
        .torque_min = {-44.25, 0.0, 2.0},
    };
    fixture->summary.reaction_max[1] = (Extreme){1504.7, 0.0, 0.25};
    fixture->stackup.has_sources = true;
    fixture->stackup.is_source[2] = true;
    fixture->stackup.is_source[STACKUP_LENGTHS] = true;
    for (int i = 0; i < FOURBAR_QUANTITY_COUNT; i++) {
        StackupRow *row = &fixture->stackup.rows[i];
        row->nominal_low = -2.0;
        row->nominal_high = 4.0;
        row->low.value = -2.5;
        row->high.value = 5.0;
        row->low.combination.length_side[2] = 1;
        row->low.combination.play_link[0] = 2;
        row->low.combination.play_sign[0] = -1;
        row->high.combination.length_side[2] = -1;
        row->high.combination.play_link[0] = -1;
        row->high.alone[2] = 0.5;
    }
}

static inline int fixture_set_up(void **state)
{
    Fixture *fixture = calloc(1, sizeof *fixture);
    fixture->scenario = kept_default();
    Scenario *scenario = &fixture->scenario;
    strcpy(scenario->title, "A test & <nothing> else");
    kept_set_path(scenario, "cases/test.yaml");
    make_linkage(scenario);
    scenario->run.samples = SAMPLES - 1;
    scenario->point_count = 1;
    scenario->points[0] = (TracedPoint){.name = "tip", .body = 1, .local = {0.25, 0.0}};
    fixture->runs[0] = make_run(scenario, "analytic", 0.0);
    fixture->runs[1] = make_run(scenario, "ode", 0.125);
    add_contacts(fixture->runs[1]);
    fixture->runs[2] = trajectory_create(scenario, "broken");
    strcpy(fixture->runs[2]->message, "not finite at 1.25 ms");
    fixture->errors[1] = (TrajectoryError){
        .is_known = true,
        .against = "analytic",
        .max = 0.017,
        .in = "omega of coupler",
        .omega_max = 0.017,
        .omega_rms = 0.004,
    };
    make_summary(fixture);
    fixture->report = (RunReport){
        .scenario = scenario,
        .run_count = RUNS,
        .runs = fixture->runs,
        .errors = fixture->errors,
        .summary = &fixture->summary,
        .stackup = &fixture->stackup,
    };
    *state = fixture;
    return 0;
}

static inline int fixture_tear_down(void **state)
{
    Fixture *fixture = *state;
    for (int i = 0; i < RUNS; i++) {
        trajectory_destroy(fixture->runs[i]);
    }
    free(fixture);
    return 0;
}
