// Which ERP, CFM and step for this joint, and what do they deliver?
#include "commands/map/mapping_report.h"
#include "contact/law.h"
#include "write/units.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

enum { LAW_DAMPING_SIZE = 64, STABLE_SIZE = 96 };

void mapping_report_law(const MappingContact *contact, char law[MAPPING_REPORT_LAW_SIZE])
{
    const ForceLaw *built = &contact->impact.law;
    const char *unit = mapping_report_units(contact)->stiffness;
    if (strcmp(contact->law_name, "stiffness") == 0 && !(built->stiffness > 0.0)) {
        snprintf(law, MAPPING_REPORT_LAW_SIZE, "given stiffness");
    } else if (strcmp(contact->law_name, "stiffness") == 0 && built->exponent == 1.0) {
        snprintf(law, MAPPING_REPORT_LAW_SIZE, "K = %.4g %s", built->stiffness, unit);
    } else if (strcmp(contact->law_name, "stiffness") == 0) {
        snprintf(law, MAPPING_REPORT_LAW_SIZE, "K = %.4g %s^%.3g", built->stiffness, unit,
                 built->exponent);
    } else {
        snprintf(law, MAPPING_REPORT_LAW_SIZE, "%s", contact->law_name);
    }
}

// Whether a joint with play is no pin in its hole.
static bool has_lines(const Linkage *linkage)
{
    for (size_t i = 0; i < linkage->joint_count; i++) {
        const Joint *joint = &linkage->joints[i];
        if (linkage_has_play(joint) && joint->kind != JOINT_CLEARANCE) {
            return true;
        }
    }
    return false;
}

static void write_head(const MappingReport *report, const Style *style, Text *text)
{
    const Scenario *scenario = report->scenario;
    section_title(scenario->title, scenario_path(scenario), style, text);
    text_append(
        text,
        "  valid       restitution%s within %.0f %% of what is asked, wherever the steps fall\n",
        mapping_report_is_poisson(report) ? "" : ", peak force and depth each",
        MAPPING_VALID_SHARE * UNITS_PERCENT);
    text_append(text,
                "  delivered   by ODE: a lone pin of the joint's effective mass in its hole, means "
                "over %d phases; other joints that are hit or hold meanwhile are left out\n",
                MAP_IMPACT_PHASES);
    if (has_lines(&scenario->linkage)) {
        text_append(text,
                    "  at a line   the corner of a block, a stop, or an end of a coordinate is run "
                    "as a disc against a line; a block's other corners are left out\n");
    }
    if (scenario->linkage.is_spatial) {
        text_append(text, "  in space    the pin is taken to stand straight: both ends of its hole "
                          "together. An end that it hits alone has half of the stiffness and the "
                          "damping, and the pin gives way to it by tilting\n");
    }
}

// Where else than in one position a joint's mass was looked up.
static const char *mass_words(const Joint *joint)
{
    return joint->kind == JOINT_GUIDE       ? " and all corners"
           : joint->kind == JOINT_CLEARANCE ? " and all directions"
                                            : "";
}

static const char *source_words(MappingSource source)
{
    static const char *const WORDS[] = {
        [MAPPING_MEDIAN] = "the median",
        [MAPPING_MOST] = "the largest",
        [MAPPING_GIVEN] = "as given",
        [MAPPING_USUAL] = "where none is given",
        [MAPPING_FLOOR] = "the floor of the damping laws",
    };
    return WORDS[source];
}

static void write_sources(const MappingReport *report, const MappingContact *contact, Text *text)
{
    const MappingSettings *settings = &report->mapping->settings;
    const MappingJoint *joint = &contact->joint;
    const JointUnits *units = mapping_report_units(contact);
    Text words;
    text_init(&words);
    if (joint->mass_most > 0.0) {
        text_append(&words, "%s %.4g to %.4g %s over the run%s",
                    settings->mass_source == MAPPING_GIVEN ? "; the joint's is" : " of",
                    joint->mass_least, joint->mass_most, units->mass,
                    mass_words(&report->scenario->linkage.joints[joint->joint]));
    }
    text_append(text, "  mass        %.4g %s, %s%s\n", contact->impact.mass, units->mass,
                source_words(settings->mass_source), words.data);
    text_finish(&words);
    text_init(&words);
    if (joint->onsets > 0) {
        static const char *const LINKS[] = {
            [MAPPING_MEDIAN] = " of",        [MAPPING_MOST] = " of",
            [MAPPING_GIVEN] = "; beside it", [MAPPING_USUAL] = "; beside it",
            [MAPPING_FLOOR] = ":",
        };
        const bool is_most = contact->speed_source == MAPPING_MOST;
        text_append(&words, "%s %zu contact%s of the reference's run, %.4g %s %s",
                    LINKS[contact->speed_source], joint->onsets, joint->onsets == 1 ? "" : "s",
                    is_most ? joint->speed_median : joint->speed_most, units->rate,
                    is_most ? "in the median" : "at most");
    }
    text_append(text, "  speed       %.4g %s, %s%s\n", contact->impact.speed, units->rate,
                source_words(contact->speed_source), words.data);
    text_finish(&words);
}

static void write_law(const MappingReport *report, const MappingContact *contact, Text *text)
{
    const ContactOptions own =
        law_options(&contact->scenario.contact, mapping_report_joint(contact));
    const ContactOptions *options = &own;
    const MapImpact *asked = &contact->asked;
    if (mapping_report_is_poisson(report)) {
        text_append(text,
                    "  asks        restitution %.4g; F = p d' with p = %.4g N s/mm: no spring, so "
                    "force and depth are the step's\n",
                    asked->restitution, options->penalty / 1e3);
        return;
    }
    char damping[LAW_DAMPING_SIZE] = "";
    if (options->damping != DAMPING_VISCOUS && options->damping != DAMPING_NONE) {
        snprintf(damping, sizeof damping, " (%s for %.4g)", OPTIONS_DAMPINGS[options->damping],
                 options->restitution);
    }
    const JointUnits *units = mapping_report_units(contact);
    text_append(
        text, "  asks        restitution %.4g, peak %.4g %s, depth %.4g %s, %.4g us of contact%s\n",
        asked->restitution, asked->force_max, units->force,
        asked->penetration_max * units_per_si(units->length), units->length,
        asked->duration * UNITS_US, damping);
    text_append(text,
                "  stiffness   k = %.4g %s at that depth (secant; tangent %.4g), Tc = %.4g us "
                "without damping\n",
                contact->secant, units->stiffness, contact->tangent,
                contact->half_period_s * UNITS_US);
    text_append(text,
                "  damping     c = %.4g %s at that depth; a viscous damper of %.4g beside "
                "that k loses as much\n",
                contact->damping, units->damping, contact->equivalent);
}

// How much harder the linkage's own load presses, and what that does to stability.
static void write_run(const MappingContact *contact, Text *text)
{
    const MappingJoint *joint = &contact->joint;
    if (!(joint->penetration_max > 0.0)) {
        return;
    }
    char stable[STABLE_SIZE] = "";
    const JointUnits *units = mapping_report_units(contact);
    const double tangent = force_law_tangent(&contact->impact.law, joint->penetration_max);
    if (isfinite(tangent) && tangent > 0.0) {
        snprintf(stable, sizeof stable, "; omega h = 2 there at h = %.3g us, for the least mass",
                 2.0 * sqrt(joint->mass_least / tangent) * UNITS_US);
    }
    text_append(
        text,
        "  the run     %.4g %s and %.4g %s at most: these include the linkage's load, which "
        "the impact does not%s\n",
        joint->force_max, units->force, joint->penetration_max * units_per_si(units->length),
        units->length, stable);
}

static void write_longest(const MappingReport *report, const MappingContact *contact,
                          const Style *style, Text *text)
{
    static const SectionHead HEADS[] = {
        {"map", "", TABLE_LEFT},
        {"step", "us", TABLE_RIGHT},
        {"Tc / h", "1", TABLE_RIGHT},
        {"hardest", "us", TABLE_RIGHT},
    };
    const MappingSettings *settings = &report->mapping->settings;
    const MappingJoint *joint = &contact->joint;
    Table *table = section_begin("Longest valid step", 4, HEADS, style, text);
    for (size_t i = 0; i < settings->map_count; i++) {
        const double step_s = contact->largest_s[settings->maps[i]];
        const double hardest_s = contact->hardest_s[settings->maps[i]];
        table_cell(table, "%s", OPTIONS_ODE_MAPS[settings->maps[i]]);
        if (isinf(step_s) || step_s == 0.0) {
            table_cell(table, "%s", isinf(step_s) ? "any" : "none");
            table_cell(table, "-");
        } else {
            section_finite(table, "%.3g", step_s * UNITS_US);
            section_finite(table, "%.3g", contact->half_period_s / step_s);
        }
        section_finite(table, "%.3g", hardest_s > 0.0 ? hardest_s * UNITS_US : NAN);
    }
    section_end(table, text);
    if (joint->onsets > 0) {
        text_append(text,
                    "  hardest: %.4g %s at %.4g %s, the lightest mass and the fastest contact of "
                    "the run, together.\n",
                    joint->mass_least, mapping_report_units(contact)->mass,
                    fmax(joint->speed_most, contact->impact.law.impact_speed_floor),
                    mapping_report_units(contact)->rate);
    }
}

void mapping_text_write(const void *of, const Style *style, Text *text)
{
    const MappingReport *report = of;
    write_head(report, style, text);
    for (size_t i = 0; i < report->mapping->contact_count; i++) {
        const MappingContact *contact = &report->mapping->contacts[i];
        char law[MAPPING_REPORT_LAW_SIZE];
        mapping_report_law(contact, law);
        text_append(text, "\n%s%s, %s%s\n\n", style->heading, mapping_report_joint(contact)->name,
                    law, style->end);
        if (contact->impact.speed > 0.0) {
            write_sources(report, contact, text);
        }
        if (contact->lack[0] != '\0') {
            text_append(text, "  not mapped  %s\n", contact->lack);
            continue;
        }
        write_law(report, contact, text);
        if (!mapping_report_is_poisson(report)) {
            write_run(contact, text);
            write_longest(report, contact, style, text);
        }
        mapping_settings_text_write(report, contact, style, text);
        if (contact->held != NULL) {
            mapping_held_text(contact, style, text);
        }
    }
    if (report->penalty != NULL) {
        mapping_penalty_text_write(report->penalty, style, text);
    }
}
