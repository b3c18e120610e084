// The case of report_fixture.h with a certified reference, matched contacts and ensembles.
#pragma once

#include "report_fixture.h"

typedef struct TruthFixture {
    Fixture *fixture;
    Truth truth;
    SpikeMatch found[RUNS][4]; // of the four joints
    RunMatches matches[RUNS];
    Ensemble ensembles[RUNS];
} TruthFixture;

static inline Ensemble make_ensemble(size_t failed)
{
    Ensemble ensemble = {.members = ENSEMBLE_MEMBERS - failed, .failed = failed};
    strcpy(ensemble.message, failed > 0 ? "a member broke" : "");
    for (int i = 0; i < ENSEMBLE_METRIC_COUNT; i++) {
        ensemble.joints[1][i] = (Distribution){0.25, 0.5, 0.75, 0.5625, 0.03125};
    }
    return ensemble;
}

// The run that was the closed form becomes the reference's; the horizon ends at a third.
static inline int truth_fixture_set_up(void **state)
{
    if (fixture_set_up(state) != 0) {
        return -1;
    }
    TruthFixture *own = calloc(1, sizeof *own);
    own->fixture = *state;
    Fixture *fixture = own->fixture;
    RunReport *report = &fixture->report;
    strcpy(fixture->runs[0]->backend, "reference");
    add_contacts(fixture->runs[0]);
    fixture->runs[0]->evaluations = 54321;
    fixture->runs[1]->energy = (Energy){.drive_work = 2.0,
                                        .dissipated = 0.5,
                                        .friction = 0.125,
                                        .change = 1.25,
                                        .residual = 0.0625};
    fixture->errors[1].against = "reference";
    fixture->errors[1].max_in_horizon = 3e-9;
    own->truth = (Truth){
        .trajectory = fixture->runs[0],
        .uncertainty = 4e-10,
        .horizon_s = 0.02,
        .growth = 3.5e7,
        .is_limited = true,
    };
    for (int i = 0; i < RUNS; i++) {
        own->matches[i].joints = own->found[i];
    }
    own->matches[1].joints[1] = (SpikeMatch){
        .pair_count = 1,
        .pairs = {{0, 0, 2.5e-6, -0.125, 0.0625}},
        .missed = 4,
        .extra = 5,
    };
    own->ensembles[0] = make_ensemble(0);
    own->ensembles[1] = make_ensemble(2);
    report->truth = &own->truth;
    report->matches = own->matches;
    report->ensembles = own->ensembles;
    *state = own;
    return 0;
}

static inline int truth_fixture_tear_down(void **state)
{
    TruthFixture *own = *state;
    void *fixture = own->fixture;
    free(own);
    return fixture_tear_down(&fixture);
}
