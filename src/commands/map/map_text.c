// Writes the text of a mapping: the settings of each contact and what they deliver.
#include "commands/map/map.h"
#include "contact/damping.h"
#include "contact/law.h"
#include "write/settled.h"
#include "write/units.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

// The settings of a contact, what is wrong with them, and what they deliver.

enum { FAULT_KEY_SIZE = 64 };

static void write_settings(const MappingContact *contact, const MappingRow *rows,
                           const Style *style, Text *text)
{
    const ForceLaw *law = &contact->impact.law;
    mapping_rows_write_table(rows, contact->row_count, style, text);
    if (!mapping_contact_is_poisson(contact)) {
        text_append(text, "  ERP and CFM at the law's deepest point%s\n",
                    force_law_is_linear(law)
                        ? "; of a linear spring and damper they hold at any depth, but for the "
                          "midpoint's ERP."
                        : "; the engine gets them recomputed at the depth of each step.");
    }
}

// What is wrong with each setting that is not valid, and what would be right.
static void write_faults(const MappingContact *contact, const MappingRow *rows, const Style *style,
                         Text *text)
{
    bool is_begun = false;
    for (size_t i = 0; i < contact->row_count; i++) {
        if (rows[i].verdict == VERDICT_VALID) {
            continue;
        }
        if (!is_begun) {
            text_append(text, "\n%sWhat is wrong, and what would be right%s\n\n", style->heading,
                        style->end);
            is_begun = true;
        }
        char key[FAULT_KEY_SIZE];
        snprintf(key, sizeof key, "%s, %.4g us", rows[i].map_name, rows[i].step_s * UNITS_US);
        text_append(text, "  %s: %s\n", key, rows[i].words);
    }
}

// Two cells: predicted, and delivered where it was measured.
static void pair_cells(Table *table, const MappingRow *row, const ImpactSpread *predicted,
                       const ImpactSpread *delivered, double unit)
{
    section_finite(table, "%.4g", row->predicted.is_ended ? unit * predicted->mean : NAN);
    section_finite(table, "%.4g", row->delivered.is_measured ? unit * delivered->mean : NAN);
}

static void write_figures(const MappingContact *contact, const MappingRow *rows, const Style *style,
                          Text *text)
{
    // the length of the contact is in the JSON and the CSV: 80 columns have no room for it
    const JointUnits *units = mapping_report_units(contact);
    const double depth_scale = units_per_si(units->length);
    char peak[32];
    char depth[32];
    snprintf(peak, sizeof peak, "peak, %s", units->force);
    snprintf(depth, sizeof depth, "depth, %s", units->length);
    const SectionHead heads[] = {
        {"map", "", TABLE_LEFT},
        {"step", "us", TABLE_RIGHT | TABLE_KEY},
        {"restitution", "predicted", TABLE_RIGHT},
        {"", "in ODE", TABLE_RIGHT},
        {peak, "predicted", TABLE_RIGHT},
        {"", "in ODE", TABLE_RIGHT},
        {depth, "predicted", TABLE_RIGHT},
        {"", "in ODE", TABLE_RIGHT},
    };
    Table *table = section_begin("Predicted and delivered", 8, heads, style, text);
    if (!mapping_contact_is_poisson(contact)) {
        const MapImpact *asked = &contact->asked;
        const double values[] = {asked->restitution, asked->force_max,
                                 asked->penetration_max * depth_scale};
        table_cell(table, "asked");
        table_cell(table, "-");
        for (int i = 0; i < 3; i++) {
            table_cell(table, "%.4g", values[i]);
            table_cell(table, "%s", "");
        }
        table_rule(table);
    }
    for (size_t i = 0; i < contact->row_count; i++) {
        const ImpactFigures *predicted = &rows[i].predicted;
        const ImpactFigures *delivered = &rows[i].delivered.figures;
        mapping_rows_begin(rows, i, table);
        pair_cells(table, &rows[i], &predicted->restitution, &delivered->restitution, 1.0);
        pair_cells(table, &rows[i], &predicted->force_max, &delivered->force_max, 1.0);
        pair_cells(table, &rows[i], &predicted->penetration_max, &delivered->penetration_max,
                   depth_scale);
    }
    section_end(table, text);
}

// Why rows could not be run; the same reason of neighbours is given once.
static void write_unmeasured(const MappingContact *contact, const MappingRow *rows, Text *text)
{
    const char *last = "";
    for (size_t i = 0; i < contact->row_count; i++) {
        const MappingRow *row = &rows[i];
        if (!row->delivered.is_measured && strcmp(row->delivered.message, last) != 0) {
            text_append(text, "  not run in ODE: %s at %.4g us: %s\n", row->map_name,
                        row->step_s * UNITS_US, row->delivered.message);
        }
        last = row->delivered.is_measured ? "" : row->delivered.message;
    }
}

static void mapping_settings_text_write(const MappingReport *report, const MappingContact *contact,
                                        const Style *style, Text *text)
{
    const MappingRow *rows = &report->mapping->rows[contact->first_row];
    write_settings(contact, rows, style, text);
    write_faults(contact, rows, style, text);
    write_figures(contact, rows, style, text);
    write_unmeasured(contact, rows, text);
}

// The best constants at a step that cannot be changed.

enum { HEADING_SIZE = 64, SHARE_SIZE = 64 };

static double share_of(const ImpactSpread *spread, double asked)
{
    return spread->mean / asked;
}

static void setting_row(const MappingContact *contact, const ConstantsSetting *setting,
                        Table *table)
{
    const ImpactFigures *predicted = &setting->predicted;
    const bool is_ended = predicted->is_ended;
    const bool is_run = setting->delivered.is_measured;
    table_cell(table, "%s", OPTIONS_ODE_MAPS[setting->map]);
    section_finite(table, "%.4g", setting->row.erp);
    section_finite(table, "%.4g", setting->row.cfm);
    section_finite(table, "%.4g", setting->stiffness);
    section_finite(table, "%.4g", setting->damping);
    section_finite(table, "%.3f", is_run ? setting->delivered.figures.restitution.mean : NAN);
    section_finite(table, "%.3g",
                   is_ended ? share_of(&predicted->force_max, contact->asked.force_max) : NAN);
    section_finite(table, "%.3g",
                   is_ended ? share_of(&predicted->penetration_max, contact->asked.penetration_max)
                            : NAN);
}

static void map_text_write_table(const MappingContact *contact, const Style *style, Text *text)
{
    const JointUnits *units = mapping_report_units(contact);
    char cfm[32];
    snprintf(cfm, sizeof cfm, "1/(%s)", units->damping);
    const SectionHead heads[] = {
        {"map", "", TABLE_LEFT},
        {"ERP", "1", TABLE_RIGHT},
        {"CFM", cfm, TABLE_RIGHT},
        {"spring", units->stiffness, TABLE_RIGHT},
        {"damper", units->damping, TABLE_RIGHT},
        {"restit.", "in ODE", TABLE_RIGHT},
        {"peak", "of law", TABLE_RIGHT},
        {"depth", "of law", TABLE_RIGHT},
    };
    char heading[HEADING_SIZE];
    snprintf(heading, sizeof heading, "Best constants at %.4g us",
             contact->held->step_s * UNITS_US);
    Table *table = section_begin(heading, 8, heads, style, text);
    for (int i = 0; i < CONSTANTS_MAP_COUNT; i++) {
        setting_row(contact, &contact->held->settings[i], table);
    }
    section_end(table, text);
    text_append(text, "  textbook: ERP at most 1, Gazebo's kp and kd; corrected: any ERP and CFM; "
                      "midpoint: with staggered stepping, its ERP follows the closing speed.\n");
}

// A number beside the one asked for: within the share that is valid it is right.
static void share_words(double share, const char *name, char words[SHARE_SIZE])
{
    if (fabs(share - 1.0) <= MAPPING_VALID_SHARE) {
        snprintf(words, SHARE_SIZE, "%s right", name);
    } else {
        snprintf(words, SHARE_SIZE, "%s %.3g times the law's", name, share);
    }
}

// What a setting is worth, and by how much it is off.
static void write_worth(const MappingContact *contact, const ConstantsSetting *setting,
                        const char *constants, const char *values, Text *text)
{
    const MapImpact *asked = &contact->asked;
    const ImpactFigures *predicted = &setting->predicted;
    const double step_us = contact->held->step_s * UNITS_US;
    if (setting->verdict == VERDICT_VALID) {
        text_append(text,
                    "  %s: %s is right at %.4g us: restitution %.3g to %.3g where %.3g is asked, "
                    "peak and depth within %.0f %%.\n",
                    constants, values, step_us, predicted->restitution.least,
                    predicted->restitution.most, asked->restitution,
                    MAPPING_VALID_SHARE * UNITS_PERCENT);
        return;
    }
    char peak[SHARE_SIZE];
    char depth[SHARE_SIZE];
    share_words(share_of(&predicted->force_max, asked->force_max), "the peak", peak);
    share_words(share_of(&predicted->penetration_max, asked->penetration_max), "the depth", depth);
    text_append(
        text,
        "  %s: nothing is right at %.4g us, where the contact lasts %.3g us, %.3g steps. The best, "
        "%s, gives restitution %.3g to %.3g where %.3g is asked (%s), %s and %s.\n",
        constants, step_us, asked->duration * UNITS_US, asked->duration / contact->held->step_s,
        values, predicted->restitution.least, predicted->restitution.most, asked->restitution,
        setting->is_restitution_met ? "right" : "off", peak, depth);
}

// What else there is to know: the way to the wall, and what is right.
static void write_beside(const MappingContact *contact, Text *text)
{
    const Constants *held = contact->held;
    const JointUnits *units = mapping_report_units(contact);
    const double length = units_per_si(units->length);
    const double step_us = held->step_s * UNITS_US;
    if (held->flight > held->play) {
        text_append(text,
                    "  In a step of %.4g us the pin flies %.3g %s and has %.3g %s from wall to "
                    "wall: whatever the constants, it can pass through the wall undetected.\n",
                    step_us, held->flight * length, units->length, held->play * length,
                    units->length);
    }
    Text maps;
    text_init(&maps);
    for (int i = ODE_MAP_TEXTBOOK; i <= ODE_MAP_IMPULSE; i++) {
        if (held->step_s <= contact->largest_s[i]) {
            text_append(&maps, "%s%s", maps.length > 0 ? ", " : "", OPTIONS_ODE_MAPS[i]);
        }
    }
    if (maps.length > 0) {
        text_append(text, "  With constants recomputed at each depth it is right by: %s.\n",
                    maps.data);
    }
    text_finish(&maps);
}

static void mapping_constants_text(const MappingContact *contact, const Style *style, Text *text)
{
    const ConstantsSetting *pair = &contact->held->settings[0];
    const ConstantsSetting *row = &contact->held->settings[1];
    const JointUnits *units = mapping_report_units(contact);
    char values[HEADING_SIZE];
    map_text_write_table(contact, style, text);
    text_append(text, "\n");
    snprintf(values, sizeof values, "kp = %.5g %s, kd = %.4g %s", pair->stiffness, units->stiffness,
             pair->damping, units->damping);
    write_worth(contact, pair, "Gazebo", values, text);
    snprintf(values, sizeof values, "ERP = %.5g, CFM = %.5g %s", row->row.erp, row->row.cfm,
             units->cfm);
    write_worth(contact, row, "ERP and CFM", values, text);
    if (!linkage_is_torsional(mapping_report_joint(contact))) {
        text_append(
            text,
            "  Of two equal surfaces in Gazebo each has 2 kp = %.5g N/m and kd / 2 = %.4g N s/m.\n",
            2.0 * pair->stiffness, 0.5 * pair->damping);
    }
    write_beside(contact, text);
    for (int i = 0; i < CONSTANTS_MAP_COUNT; i++) {
        const ConstantsSetting *setting = &contact->held->settings[i];
        if (!setting->delivered.is_measured) {
            text_append(text, "  not run in ODE: %s: %s\n", OPTIONS_ODE_MAPS[setting->map],
                        setting->delivered.message);
        }
    }
}

// ERP, CFM and step for each contact, and what they deliver.

enum { LAW_DAMPING_SIZE = 64, STABLE_SIZE = 192 };

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
        if (linkage_has_play(joint) && !joint_has_hole(joint->kind)) {
            return true;
        }
    }
    return false;
}

static void map_text_write_head(const MappingReport *report, const Style *style, Text *text)
{
    const Scenario *scenario = report->scenario;
    section_title(scenario->title, scenario_path(scenario), style, text);
    settled_text(scenario, text);
    text_append(
        text,
        "  valid       restitution%s within %.0f %% of what is asked, wherever the steps fall\n",
        mapping_report_is_poisson(report) ? "" : ", peak force and depth each",
        MAPPING_VALID_SHARE * UNITS_PERCENT);
    text_append(
        text,
        "  delivered   by ODE: a single pin of the joint's effective mass in its hole, means "
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
    return joint_has_guides(joint->kind) ? " and all corners"
           : joint_has_hole(joint->kind) ? " and all directions"
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
        text_append(&words, "%s %zu contact%s of the reference's run, %s %.4g %s",
                    LINKS[contact->speed_source], joint->onsets, joint->onsets == 1 ? "" : "s",
                    is_most ? "whose median is" : "at most",
                    is_most ? joint->speed_median : joint->speed_most, units->rate);
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
    if (damping_restores(options->damping)) {
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

// The square of how fast a contact swings alone at the run's depth, for the least mass, 1/s^2; 0
// where the run does not press it.
static double alone_squared(const MappingContact *contact)
{
    const MappingJoint *joint = &contact->joint;
    const double tangent = joint->penetration_max > 0.0
                               ? force_law_tangent(&contact->impact.law, joint->penetration_max)
                               : 0.0;
    return isfinite(tangent) ? tangent / joint->mass_least : 0.0;
}

// The pins between the bodies of a contact's, under its law: several press at once, and their
// stiffness adds up. Each is a row n of one freedom with k n n', so that the fastest swing of all
// is at most the root of the sum of their squares.
typedef struct Together {
    size_t count;  // of the pins that the run presses
    double square; // 1/s^2, of the fastest swing, at most
} Together;

static Together find_together(const MappingReport *report, const MappingContact *contact)
{
    const Joint *joints = report->scenario->linkage.joints;
    Together found = {.count = 0};
    for (size_t i = 0; i < report->mapping->contact_count; i++) {
        const MappingContact *other = &report->mapping->contacts[i];
        const bool is_pressed = other->lack[0] == '\0' && alone_squared(other) > 0.0;
        if (is_pressed && strcmp(other->law_name, contact->law_name) == 0 &&
            linkage_shares_bodies(&joints[contact->joint.joint], &joints[other->joint.joint])) {
            found.count++;
            found.square += alone_squared(other);
        }
    }
    return found;
}

// How much harder the linkage's own load presses, and what that does to stability.
static void write_run(const MappingReport *report, const MappingContact *contact, Text *text)
{
    const MappingJoint *joint = &contact->joint;
    if (!(joint->penetration_max > 0.0)) {
        return;
    }
    char stable[STABLE_SIZE] = "";
    const JointUnits *units = mapping_report_units(contact);
    const double square = alone_squared(contact);
    const Together together = find_together(report, contact);
    if (square > 0.0) {
        int length = snprintf(stable, sizeof stable,
                              "; omega h = 2 there at h = %.3g us, for the least mass",
                              2.0 / sqrt(square) * UNITS_US);
        if (together.count > 1) {
            snprintf(stable + length, sizeof stable - (size_t)length,
                     ", and of the %zu pins between its bodies together not below %.3g us",
                     together.count, 2.0 / sqrt(together.square) * UNITS_US);
        }
    }
    text_append(
        text,
        "  the run     %.4g %s and %.4g %s at most: these include the linkage's load, which "
        "the impact does not%s\n",
        joint->force_max, units->force, joint->penetration_max * units_per_si(units->length),
        units->length, stable);
}

// The longest valid step of a map, us; infinite: any, 0: none.
static void longest_cell(Table *table, double step_s)
{
    if (isinf(step_s) || step_s == 0.0) {
        table_cell(table, "%s", isinf(step_s) ? "any" : "none");
    } else {
        section_finite(table, "%.3g", step_s * UNITS_US);
    }
}

static void map_text_write_longest(const MappingReport *report, const MappingContact *contact,
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
        longest_cell(table, step_s);
        section_finite(table, "%.3g",
                       step_s == 0.0 || isinf(step_s) ? NAN : contact->half_period_s / step_s);
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
    map_text_write_head(report, style, text);
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
            write_run(report, contact, text);
            map_text_write_longest(report, contact, style, text);
        }
        mapping_settings_text_write(report, contact, style, text);
        if (contact->held != NULL) {
            mapping_constants_text(contact, style, text);
        }
    }
    if (report->penalty != NULL) {
        mapping_penalty_text_write(report->penalty, style, text);
    }
}

// The first screen: of each contact the longest valid step of each map.

enum { SCREEN_CONTACTS = 8, SCREEN_NAME = 20 };

// How many of the contacts shown turn their bodies: their speeds are rad/s.
static size_t count_turning(const MappingReport *report)
{
    size_t turning = 0;
    for (size_t i = 0; i < report->mapping->contact_count && i < SCREEN_CONTACTS; i++) {
        const Joint *joint = mapping_report_joint(&report->mapping->contacts[i]);
        turning += linkage_is_torsional(joint) ? 1 : 0;
    }
    return turning;
}

static void map_screen_row(const MappingReport *report, const MappingContact *contact,
                           bool is_in_rad, Table *table)
{
    const MappingSettings *settings = &report->mapping->settings;
    Text words;
    text_init(&words);
    text_append_shown(&words, mapping_report_joint(contact)->name);
    table_cell(table, "%.*s", SCREEN_NAME, words.data);
    text_finish(&words);
    const bool is_turning = linkage_is_torsional(mapping_report_joint(contact));
    section_finite(table, is_turning && !is_in_rad ? "%.3g rad/s" : "%.3g", contact->impact.speed);
    for (size_t i = 0; i < settings->map_count; i++) {
        longest_cell(table, contact->largest_s[settings->maps[i]]);
    }
}

static void map_screen_table(const MappingReport *report, Text *text)
{
    const MappingSettings *settings = &report->mapping->settings;
    const size_t count = report->mapping->contact_count;
    Table *table = table_create(2 + settings->map_count);
    table_head(table, 0, "joint", "", TABLE_LEFT | TABLE_KEY);
    // of both kinds the column is in m/s, and what turns has its unit beside it
    const bool is_in_rad =
        count_turning(report) == (count < SCREEN_CONTACTS ? count : SCREEN_CONTACTS);
    table_head(table, 1, "impact", is_in_rad ? "rad/s" : "m/s", TABLE_RIGHT);
    for (size_t i = 0; i < settings->map_count; i++) {
        table_head(table, 2 + i, OPTIONS_ODE_MAPS[settings->maps[i]], "us", TABLE_RIGHT);
    }
    for (size_t i = 0; i < count && i < SCREEN_CONTACTS; i++) {
        map_screen_row(report, &report->mapping->contacts[i], is_in_rad, table);
    }
    table_write(table, text);
    table_destroy(table);
    if (count > SCREEN_CONTACTS) {
        text_append(text, "  And %zu more contacts: --full shows them.\n", count - SCREEN_CONTACTS);
    }
}

// What the steps of single pins leave out where several are between two bodies, of the first such.
static void write_together(const MappingReport *report, Text *text)
{
    const Linkage *linkage = &report->scenario->linkage;
    for (size_t i = 0; i < report->mapping->contact_count; i++) {
        const MappingContact *contact = &report->mapping->contacts[i];
        const Together together = find_together(report, contact);
        const double square = contact->lack[0] == '\0' ? alone_squared(contact) : 0.0;
        if (together.count > 1 && square > 0.0) {
            const Joint *joint = &linkage->joints[contact->joint.joint];
            Text own;
            text_init(&own);
            text_append(&own,
                        "  Each pin alone: the %zu between %s and %s, pressed together, swing up "
                        "to %.2g times as fast.",
                        together.count, linkage_body_name(linkage, joint->body_a),
                        linkage_body_name(linkage, joint->body_b), sqrt(together.square / square));
            screen_sentence(&own, text);
            return;
        }
    }
}

void mapping_screen_write(const void *of, const Style *style, Text *text)
{
    const MappingReport *report = of;
    const Scenario *scenario = report->scenario;
    if (report->penalty != NULL) {
        mapping_text_write(of, style, text); // the table that was asked for is a long one
        return;
    }
    section_title(scenario->title, scenario_path(scenario), style, text);
    const Mapping *mapping = report->mapping;
    const MappingContact *first = &mapping->contacts[0];
    if (mapping->settings.is_held && first->held != NULL) {
        mapping_constants_text(first, style, text);
    } else if (mapping_report_is_poisson(report)) {
        // a row has no spring: what a step gives back is all there is to say
        write_figures(first, &mapping->rows[first->first_row], style, text);
    } else {
        text_append(
            text, "\n  Longest step of each map at which ODE's impact is the law's to %.0f %%\n\n",
            MAPPING_VALID_SHARE * UNITS_PERCENT);
        map_screen_table(report, text);
        text_append(text, "  any: the map impulse integrates the contact within the step.\n");
        write_together(report, text);
    }
    settled_lines(scenario, text);
    text_append(text, "  --full: ERP and CFM of each step, and what ODE delivers with them\n");
}
