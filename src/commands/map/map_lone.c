// Which scenario is a contact of which only stiffness, mass and step are known?
#include "commands/map/map_options.h"

#include "casefile/casefile.h"
#include "casefile/quantity.h"
#include "cli/option_values.h"
#include "contact/law.h"
#include "contact/map_impact.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

enum { OVERRIDE_SIZE = 128, OWN_MOST = 4 };

// of the longer of a step and the contact's depth at its speed: room for flight, contact and flight
static const double ROOM_STEPS = 20.0;
static const double ROOM_DEPTHS = 100.0;

// m/s, where no speed is given: a pin of an ordinary mechanism
static const double USUAL_SPEED = 0.1;

// of the play: no depth is too deep for a contact that has no size
static const double PIN_PLAYS = 10.0;

static const char CASE[] = "title: A lone contact\n"
                           "bodies:\n"
                           "  pin: {mass: 1 kg, inertia: 1 kg m^2, at: [0 mm, 0 mm]}\n"
                           "joints:\n"
                           "  contact: {between: [ground, pin], at: [0 mm, 0 mm], hole: 2 m, "
                           "pin: 1 m, width: 1 m}\n"
                           "contact: {stiffness: 1 N/m, damping: lankarani-nikravesh, "
                           "restitution: 0.9}\n"
                           "run: {duration: 1 s, samples: 2, step: 1 us}\n";

typedef struct Overrides {
    char own[OWN_MOST][OVERRIDE_SIZE];
    const char *list[OPTION_SETTING_MAX + OWN_MOST];
    size_t count;
} Overrides;

static void add_own(Overrides *overrides, const char *key, const char *value)
{
    if (value != NULL) {
        char *own = overrides->own[overrides->count];
        snprintf(own, OVERRIDE_SIZE, "%s=%s", key, value);
        overrides->list[overrides->count++] = own;
    }
}

static bool is_word(const char *text, const char *const *words)
{
    for (size_t i = 0; words[i] != NULL; i++) {
        if (strcmp(text, words[i]) == 0) {
            return true;
        }
    }
    return false;
}

// The options in the words of a case file; --set comes behind them.
static void list_overrides(const MapOptions *options, Overrides *overrides)
{
    add_own(overrides, "contact.stiffness", options->stiffness);
    add_own(overrides, "contact.restitution", options->restitution);
    if (options->damping != NULL && !is_word(options->damping, OPTIONS_DAMPINGS)) {
        add_own(overrides, "contact.damping", "viscous");
        add_own(overrides, "contact.viscous-coefficient", options->damping);
    } else {
        add_own(overrides, "contact.damping", options->damping);
    }
    for (size_t i = 0; i < options->common.override_count; i++) {
        overrides->list[overrides->count++] = options->common.overrides[i];
    }
}

// A hole about the pin: as wide as it was given, else as flight and contact need.
static bool fit_hole(const MapOptions *options, const MappingSettings *settings, Scenario *scenario,
                     Err *err)
{
    Joint *joint = &scenario->linkage.joints[0];
    MapImpactCase impact = {.mass = settings->mass, .speed = settings->speed};
    if (!law_of_joint(scenario, joint, &impact.law, err)) {
        return false;
    }
    // the steps are sorted, the longest first
    const double room = ROOM_STEPS * settings->speed * settings->steps[0] +
                        ROOM_DEPTHS * map_impact_depth(&impact); // m
    double play = room;
    if (options->clearance != NULL && !option_values_read_quantity("clearance", options->clearance,
                                                                   DIMENSION_LENGTH, &play, err)) {
        return false;
    }
    joint->clearance.pin_radius = PIN_PLAYS * fmax(play, room);
    joint->clearance.hole_radius = joint->clearance.pin_radius + play;
    return isfinite(room) || err_set(err, ERR_USAGE,
                                     "--stiffness, --mass, --speed and the steps make a contact "
                                     "whose depth is no finite number");
}

bool map_lone_make(const MapOptions *options, Scenario *scenario, MappingSettings *settings,
                   Err *err)
{
    Overrides overrides = {.count = 0};
    list_overrides(options, &overrides);
    if (!casefile_load_text("a lone contact", CASE, sizeof CASE - 1, overrides.list,
                            overrides.count, scenario, err)) {
        return false;
    }
    scenario_set_path(scenario, ""); // there is no file
    scenario->run.step = 0.0;        // nor a step but those of the options
    if (!map_options_settings(options, scenario, settings, err)) {
        return false;
    }
    if (settings->mass_source != MAPPING_GIVEN ||
        (options->speed != NULL && settings->speed_source != MAPPING_GIVEN)) {
        return err_set(err, ERR_USAGE,
                       "a contact without a case has no run to take the %s from; give a quantity, "
                       "such as --%s",
                       settings->mass_source != MAPPING_GIVEN ? "mass" : "speed",
                       settings->mass_source != MAPPING_GIVEN ? "mass '0.1 kg'"
                                                              : "speed '0.1 m/s'");
    }
    if (options->speed == NULL) {
        settings->speed = USUAL_SPEED;
        settings->speed_source = MAPPING_USUAL;
    }
    return fit_hole(options, settings, scenario, err);
}
