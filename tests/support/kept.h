// Scenarios and linkages that a test builds. They live until its process ends, and have room for
// bodies and joints that the test adds.
#pragma once

#include "model/scenario.h"

#include <assert.h>
#include <stdlib.h>
#include <string.h>

// What is kept is reached from here: a leak is something else.
typedef struct Kept {
    Linkage linkage;
    struct Kept *before;
} Kept;

static inline Linkage kept_linkage(void)
{
    static Kept *last;
    Kept *kept = malloc(sizeof *kept);
    assert(kept != NULL);
    *kept = (Kept){
        .linkage = linkage_create((LinkageRoom){.bodies = 64,
                                                .joints = 96,
                                                .springs = 32,
                                                .torsions = 32,
                                                .bushings = 32,
                                                .loads = 8,
                                                .further = LINKAGE_DRIVE_MAX,
                                                .profiles = 4}),
        .before = last,
    };
    last = kept;
    return kept->linkage;
}

static inline void kept_hold(void *memory)
{
    static struct Constants {
        void *memory;
        struct Constants *before;
    } * last;
    struct Constants *held = malloc(sizeof *held);
    assert(held != NULL);
    *held = (struct Constants){memory, last};
    last = held;
}

static inline Linkage kept_linkage_copy(const Linkage *linkage)
{
    const Linkage own = kept_linkage();
    Linkage copy = *linkage;
    copy.bodies = memcpy(own.bodies, linkage->bodies, copy.body_count * sizeof *own.bodies);
    copy.joints = memcpy(own.joints, linkage->joints, copy.joint_count * sizeof *own.joints);
    copy.springs = memcpy(own.springs, linkage->springs, copy.spring_count * sizeof *own.springs);
    copy.torsions =
        memcpy(own.torsions, linkage->torsions, copy.torsion_count * sizeof *own.torsions);
    copy.bushings =
        memcpy(own.bushings, linkage->bushings, copy.bushing_count * sizeof *own.bushings);
    copy.loads = memcpy(own.loads, linkage->loads, copy.load_count * sizeof *own.loads);
    copy.further = memcpy(own.further, linkage->further, copy.further_count * sizeof *own.further);
    copy.profiles =
        memcpy(own.profiles, linkage->profiles, copy.profile_count * sizeof *own.profiles);
    return copy;
}

// With the start and the law of tests/support/load_case.h.
static inline Scenario kept_default(void)
{
    Scenario scenario = scenario_default();
    scenario.linkage = kept_linkage();
    scenario.run.start = START_CENTRED;
    scenario.contact.resting_speed = 0.0;
    scenario.contact.damping = DAMPING_LANKARANI_NIKRAVESH;
    return scenario;
}

static inline Scenario kept_copy(const Scenario *scenario)
{
    Scenario copy = *scenario;
    copy.linkage = kept_linkage_copy(&scenario->linkage);
    return copy;
}

// What settling has found belongs to the scenario, as does the linkage of a start that is pressed.
static inline void kept_settled(const Scenario *scenario)
{
    kept_hold(scenario->linkage.bodies);
    kept_hold(scenario->linkage.joints);
    kept_hold(scenario->linkage.springs);
    kept_hold(scenario->linkage.torsions);
    kept_hold(scenario->linkage.bushings);
    kept_hold(scenario->linkage.loads);
    kept_hold(scenario->linkage.further);
    kept_hold(scenario->settled.first);
    kept_hold(scenario->settled.motions);
    kept_hold(scenario->settled.others);
}

// One that was read or built otherwise: it is freed.
static inline Scenario kept_instead(Scenario *scenario)
{
    const Scenario copy = kept_copy(scenario);
    kept_hold(copy.path);
    kept_hold(copy.expectations);
    kept_hold(copy.outcomes);
    kept_hold(copy.keys);
    kept_hold(copy.tolerances);
    kept_settled(&copy);
    linkage_free(&scenario->linkage);
    return copy;
}

static inline void kept_set_path(Scenario *scenario, const char *path)
{
    scenario_set_path(scenario, path);
    kept_hold(scenario->path);
}
