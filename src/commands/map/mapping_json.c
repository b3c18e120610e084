// What do other programs read of a mapping?
#include "commands/map/mapping_json.h"

#include "commands/map/mapping_held.h"
#include "write/json_value.h"
#include "write/settings_json.h"

static const char *const SOURCES[] = {
    [MAPPING_MEDIAN] = "median", [MAPPING_MOST] = "most",   [MAPPING_GIVEN] = "given",
    [MAPPING_USUAL] = "usual",   [MAPPING_FLOOR] = "floor",
};

json_t *mapping_spread_object(const ImpactSpread *spread)
{
    json_t *object = json_object();
    json_value_set(object, "mean", spread->mean);
    json_value_set(object, "least", spread->least);
    json_value_set(object, "most", spread->most);
    return object;
}

static void set_figures(json_t *object, const ImpactFigures *figures)
{
    json_object_set_new(object, "restitution", mapping_spread_object(&figures->restitution));
    json_object_set_new(object, "force_max_N", mapping_spread_object(&figures->force_max));
    json_object_set_new(object, "penetration_max_m",
                        mapping_spread_object(&figures->penetration_max));
    json_object_set_new(object, "duration_s", mapping_spread_object(&figures->duration));
    json_object_set_new(object, "fallback_rows", json_integer((json_int_t)figures->fallbacks));
}

static json_t *predicted_object(const ImpactFigures *figures)
{
    json_t *object = json_object();
    json_object_set_new(object, "status",
                        json_string(figures->is_ended      ? "ok"
                                    : figures->is_past_end ? "past-end"
                                    : figures->is_too_fine ? "too-fine"
                                                           : "sticks"));
    if (figures->is_ended) {
        set_figures(object, figures);
    }
    return object;
}

static json_t *delivered_object(const ImpactDelivered *delivered)
{
    json_t *object = json_object();
    json_object_set_new(object, "status", json_string(delivered->is_measured ? "ok" : "not run"));
    json_object_set_new(object, "message", json_value_text(delivered->message));
    if (delivered->is_measured) {
        set_figures(object, &delivered->figures);
    }
    return object;
}

static json_t *row_object(const MappingReport *report, const MappingContact *contact,
                          const MappingRow *row)
{
    const bool is_poisson = mapping_report_is_poisson(report);
    const bool has_row = row->map != ODE_MAP_IMPULSE;
    const Scenario ready = mapping_scenario(contact, row->map, row->step_s);
    json_t *object = json_object();
    json_object_set_new(object, "map", json_string(mapping_report_map(report, row)));
    json_object_set_new(object, "stepping", json_string(OPTIONS_ODE_STEPPINGS[ready.ode.stepping]));
    json_value_set(object, "step_s", row->step_s);
    json_value_set(object, "steps_a_contact", is_poisson ? NAN : row->steps_a_contact);
    json_value_set(object, "omega_h", is_poisson ? NAN : row->omega_h);
    json_value_set(object, "stability_limit",
                   has_row && !is_poisson ? map_get(row->map)->stability_limit : NAN);
    json_value_set(object, "erp", has_row ? row->soft.erp : NAN);
    json_value_set(object, "cfm_m_N_s", has_row ? row->soft.cfm : NAN);
    json_object_set_new(object, "verdict", json_string(VERDICT_NAMES[row->verdict]));
    json_object_set_new(object, "words", json_string(row->words));
    json_object_set_new(object, "predicted", predicted_object(&row->predicted));
    json_object_set_new(object, "delivered", delivered_object(&row->delivered));
    return object;
}

// Of POISSON contacts only the restitution is asked for.
static json_t *asked_object(const MappingReport *report, const MapImpact *asked)
{
    const bool is_poisson = mapping_report_is_poisson(report);
    json_t *object = json_object();
    json_value_set(object, "restitution", asked->restitution);
    json_value_set(object, "force_max_N", is_poisson ? NAN : asked->force_max);
    json_value_set(object, "penetration_max_m", is_poisson ? NAN : asked->penetration_max);
    json_value_set(object, "duration_s", is_poisson ? NAN : asked->duration);
    return object;
}

static json_t *longest_object(const double *steps)
{
    json_t *object = json_object();
    for (int map = ODE_MAP_TEXTBOOK; map < ODE_MAP_IMPULSE; map++) {
        const double step_s = steps[map];
        json_value_set(object, OPTIONS_ODE_MAPS[map], step_s > 0.0 ? step_s : NAN);
    }
    return object;
}

static void set_law(const MappingReport *report, const MappingContact *contact, json_t *object)
{
    json_object_set_new(object, "asked", asked_object(report, &contact->asked));
    if (mapping_report_is_poisson(report)) {
        json_value_set(object, "penalty_N_s_m", contact->scenario.contact.penalty);
        return;
    }
    json_value_set(object, "half_period_s", contact->half_period_s);
    json_value_set(object, "stiffness_secant_N_m", contact->secant);
    json_value_set(object, "stiffness_tangent_N_m", contact->tangent);
    json_value_set(object, "damping_N_s_m", contact->damping);
    json_value_set(object, "damping_equivalent_N_s_m", contact->equivalent);
    json_object_set_new(object, "longest_valid_step_s", longest_object(contact->largest_s));
    json_object_set_new(object, "longest_valid_step_hardest_s", longest_object(contact->hardest_s));
}

static json_t *contact_object(const MappingReport *report, const MappingContact *contact)
{
    const MappingSettings *settings = &report->mapping->settings;
    const MappingJoint *joint = &contact->joint;
    const bool is_run = joint->mass_most > 0.0;
    json_t *object = json_object();
    json_object_set_new(object, "joint", json_string(mapping_report_joint(report, contact)->name));
    json_object_set_new(object, "law", json_string(contact->law_name));
    const bool is_mapped = contact->lack[0] == '\0';
    json_object_set_new(object, "status", json_string(is_mapped ? "ok" : "not mapped"));
    json_object_set_new(object, "message", json_value_text(contact->lack));
    json_value_set(object, "mass_kg", contact->impact.mass);
    json_object_set_new(object, "mass_from", json_string(SOURCES[settings->mass_source]));
    json_value_set(object, "mass_least_kg", is_run ? joint->mass_least : NAN);
    json_value_set(object, "mass_median_kg", is_run ? joint->mass_median : NAN);
    json_value_set(object, "mass_most_kg", is_run ? joint->mass_most : NAN);
    json_value_set(object, "speed_m_s", contact->impact.speed);
    json_object_set_new(object, "speed_from", json_string(SOURCES[contact->speed_source]));
    json_object_set_new(object, "contacts", json_integer((json_int_t)joint->onsets));
    json_value_set(object, "speed_median_m_s", joint->onsets > 0 ? joint->speed_median : NAN);
    json_value_set(object, "speed_most_m_s", joint->onsets > 0 ? joint->speed_most : NAN);
    json_value_set(object, "run_force_max_N", joint->onsets > 0 ? joint->force_max : NAN);
    json_value_set(object, "run_penetration_max_m",
                   joint->onsets > 0 ? joint->penetration_max : NAN);
    if (is_mapped) {
        set_law(report, contact, object);
    }
    json_t *rows = json_array();
    for (size_t i = 0; i < contact->row_count; i++) {
        const MappingRow *row = &report->mapping->rows[contact->first_row + i];
        json_array_append_new(rows, row_object(report, contact, row));
    }
    json_object_set_new(object, "rows", rows);
    if (contact->held != NULL) {
        json_object_set_new(object, "best_constants", mapping_held_json(contact));
    }
    return object;
}

static json_t *penalty_row(const PenaltyMap *map, const PenaltyMapRow *row)
{
    const bool has_row = map->map != ODE_MAP_IMPULSE;
    json_t *object = json_object();
    json_value_set(object, "speed_rpm", row->rpm);
    json_value_set(object, "force_N", row->force);
    json_value_set(object, "penalty_printed_N", row->printed);
    json_value_set(object, "approach_m", row->approach);
    json_value_set(object, "mass_kg", row->mass);
    json_value_set(object, "speed_m_s", row->speed);
    json_value_set(object, "stiffness_N_m", row->stiffness.secant);
    json_value_set(object, "damping_N_s_m", row->stiffness.damping);
    json_value_set(object, "erp", has_row ? row->soft.erp : NAN);
    json_value_set(object, "cfm_m_N_s", has_row ? row->soft.cfm : NAN);
    json_value_set(object, "rest_depth_m", row->rest_depth);
    json_object_set_new(object, "asked",
                        json_pack("{s:f, s:f, s:f, s:f}", "restitution",
                                  row->stiffness.asked.restitution, "force_max_N",
                                  row->stiffness.asked.force_max, "penetration_max_m",
                                  row->stiffness.asked.penetration_max, "duration_s",
                                  row->stiffness.asked.duration));
    json_object_set_new(object, "delivered_as_stiffness", delivered_object(&row->by_spring));
    json_value_set(object, "penalty_cfm_m_N_s", row->cfm);
    json_object_set_new(object, "delivered_as_penalty", delivered_object(&row->by_penalty));
    return object;
}

static json_t *penalty_object(const PenaltyMap *map)
{
    json_t *object = json_object();
    json_object_set_new(object, "joint", json_string(PRINTED_PIN_NAMES[map->pin]));
    json_object_set_new(object, "map", json_string(OPTIONS_ODE_MAPS[map->map]));
    json_value_set(object, "step_s", map->step_s);
    json_t *rows = json_array();
    for (int i = 0; i < PRINTED_SPEED_COUNT; i++) {
        json_array_append_new(rows, penalty_row(map, &map->rows[i]));
    }
    json_object_set_new(object, "rows", rows);
    return object;
}

json_t *mapping_json_build(const MappingReport *report)
{
    json_t *object = json_object();
    json_object_set_new(object, "tool", settings_json_tool());
    json_object_set_new(object, "case", json_value_text(report->scenario->path));
    json_object_set_new(object, "title", json_value_text(report->scenario->title));
    settings_json_set(object, report->scenario);
    json_value_set(object, "valid_share", MAPPING_VALID_SHARE);
    json_object_set_new(object, "phases", json_integer(MAP_IMPACT_PHASES));
    json_t *contacts = json_array();
    for (size_t i = 0; i < report->mapping->contact_count; i++) {
        json_array_append_new(contacts, contact_object(report, &report->mapping->contacts[i]));
    }
    json_object_set_new(object, "contacts", contacts);
    if (report->penalty != NULL) {
        json_object_set_new(object, "penalty", penalty_object(report->penalty));
    }
    return object;
}
