// Which ERP, CFM and step for this joint, and what do they deliver?
#include "report/mapping_text.h"

#include "report/mapping_penalty_text.h"
#include "report/run_section.h"
#include "report/units.h"

#include <math.h>
#include <string.h>

static void write_head(const MappingReport *report, const Style *style, Text *text)
{
    const Scenario *scenario = report->scenario;
    const char *title = scenario->title[0] != '\0' ? scenario->title : "A case without a title";
    text_append(text, "%s%s%s\n\n", style->heading, title, style->end);
    text_append(text, "  case        %s\n", scenario->path);
    text_append(text,
                "  valid       restitution%s within %.0f %% of what is asked, wherever the steps "
                "fall\n",
                mapping_report_is_poisson(report) ? "" : ", peak force and depth each",
                MAPPING_VALID_SHARE * UNITS_PERCENT);
    text_append(text,
                "  delivered   by ODE: a lone pin of the joint's effective mass in its hole, "
                "means over %d phases;\n              other joints that are hit or hold "
                "meanwhile are left out\n",
                MAP_IMPACT_PHASES);
}

static const char *source_words(MappingSource source)
{
    static const char *const WORDS[] = {
        [MAPPING_MEDIAN] = "the median",
        [MAPPING_MOST] = "the largest",
        [MAPPING_GIVEN] = "as given",
        [MAPPING_FLOOR] = "the floor of the damping laws",
    };
    return WORDS[source];
}

static void write_sources(const MappingReport *report, const MappingContact *contact, Text *text)
{
    const MappingSettings *settings = &report->mapping->settings;
    const MappingJoint *joint = &contact->joint;
    text_append(text, "  mass        %.4g kg, %s", contact->impact.mass,
                source_words(settings->mass_source));
    if (joint->mass_most > 0.0) {
        text_append(text, "%s %.4g to %.4g kg over the run and all directions",
                    settings->mass_source == MAPPING_GIVEN ? "; the joint's is" : " of",
                    joint->mass_least, joint->mass_most);
    }
    text_append(text, "\n  speed       %.4g m/s, %s", contact->impact.speed,
                source_words(contact->speed_source));
    if (joint->onsets > 0) {
        static const char *const LINKS[] = {
            [MAPPING_MEDIAN] = " of",
            [MAPPING_MOST] = " of",
            [MAPPING_GIVEN] = "; beside it",
            [MAPPING_FLOOR] = ":",
        };
        const bool is_most = contact->speed_source == MAPPING_MOST;
        text_append(text, "%s %zu contact%s of the reference's run, %.4g m/s %s",
                    LINKS[contact->speed_source], joint->onsets, joint->onsets == 1 ? "" : "s",
                    is_most ? joint->speed_median : joint->speed_most,
                    is_most ? "in the median" : "at most");
    }
    text_append(text, "\n");
}

static void write_law(const MappingReport *report, const MappingContact *contact, Text *text)
{
    const ContactOptions *options = &contact->scenario.contact;
    const MapImpact *asked = &contact->asked;
    if (mapping_report_is_poisson(report)) {
        text_append(text,
                    "  asks        restitution %.4g; F = p d' with p = %.4g N s/mm: no spring, so "
                    "force and depth are the step's\n",
                    asked->restitution, options->penalty / 1e3);
        return;
    }
    text_append(text,
                "  asks        restitution %.4g, peak %.4g N, depth %.4g um, %.4g us of contact",
                asked->restitution, asked->force_max, asked->penetration_max * UNITS_UM,
                asked->duration * UNITS_US);
    if (options->damping != DAMPING_VISCOUS && options->damping != DAMPING_NONE) {
        text_append(text, " (%s for %.4g)", OPTIONS_DAMPINGS[options->damping],
                    options->restitution);
    }
    text_append(text,
                "\n  stiffness   k = %.4g N/m at that depth (secant; tangent %.4g), Tc = %.4g us "
                "without damping\n",
                contact->secant, contact->tangent, contact->half_period_s * UNITS_US);
    text_append(text,
                "  damping     c = %.4g N s/m at that depth; as much is lost to a viscous one of "
                "%.4g beside that k\n",
                contact->damping, contact->equivalent);
}

// How much harder the linkage's own load presses, and what that does to stability.
static void write_run(const MappingContact *contact, Text *text)
{
    const MappingJoint *joint = &contact->joint;
    if (!(joint->penetration_max > 0.0)) {
        return;
    }
    const double tangent = force_law_tangent(&contact->impact.law, joint->penetration_max);
    text_append(
        text,
        "  the run     %.4g N and %.4g um at most: the linkage's load is in these and not in "
        "the impact;\n              omega h = 2 there at h = %.3g us, for the least mass\n",
        joint->force_max, joint->penetration_max * UNITS_UM,
        2.0 * sqrt(joint->mass_least / tangent) * UNITS_US);
}

static void write_longest(const MappingReport *report, const MappingContact *contact,
                          const Style *style, Text *text)
{
    static const RunSectionHead HEADS[] = {
        {"map", "", TABLE_LEFT},
        {"step", "us", TABLE_RIGHT},
        {"Tc / h", "1", TABLE_RIGHT},
        {"hardest", "us", TABLE_RIGHT},
    };
    const MappingSettings *settings = &report->mapping->settings;
    const MappingJoint *joint = &contact->joint;
    Table *table = run_section_begin("Longest valid step", 4, HEADS, style, text);
    for (size_t i = 0; i < settings->map_count; i++) {
        const double step_s = contact->largest_s[settings->maps[i]];
        const double hardest_s = contact->hardest_s[settings->maps[i]];
        table_cell(table, "%s", OPTIONS_ODE_MAPS[settings->maps[i]]);
        if (isinf(step_s) || step_s == 0.0) {
            table_cell(table, "%s", isinf(step_s) ? "any" : "none");
            table_cell(table, "-");
        } else {
            run_section_finite(table, "%.3g", step_s * UNITS_US);
            run_section_finite(table, "%.3g", contact->half_period_s / step_s);
        }
        run_section_finite(table, "%.3g", hardest_s > 0.0 ? hardest_s * UNITS_US : NAN);
    }
    run_section_end(table, text);
    if (joint->onsets > 0) {
        text_append(text,
                    "  hardest: %.4g kg at %.4g m/s, the lightest mass and the fastest contact of "
                    "the run, together.\n",
                    joint->mass_least,
                    fmax(joint->speed_most, contact->impact.law.impact_speed_floor));
    }
}

static bool is_first_of_map(const MappingRow *rows, size_t index)
{
    return index == 0 || rows[index].map != rows[index - 1].map;
}

static void begin_row(const MappingReport *report, const MappingRow *rows, size_t index,
                      Table *table)
{
    const bool is_first = is_first_of_map(rows, index);
    if (is_first && index > 0) {
        table_rule(table);
    }
    table_cell(table, "%s", is_first ? mapping_report_map(report, &rows[index]) : "");
    table_cell(table, "%.4g", rows[index].step_s * UNITS_US);
}

static void write_settings(const MappingReport *report, const MappingContact *contact,
                           const Style *style, Text *text)
{
    static const RunSectionHead HEADS[] = {
        {"map", "", TABLE_LEFT},      {"step", "us", TABLE_RIGHT},
        {"Tc / h", "1", TABLE_RIGHT}, {"omega h", "1", TABLE_RIGHT},
        {"ERP", "1", TABLE_RIGHT},    {"CFM", "1/(N s/m)", TABLE_RIGHT},
        {"verdict", "", TABLE_LEFT},
    };
    const bool is_poisson = mapping_report_is_poisson(report);
    const MappingRow *rows = &report->mapping->rows[contact->first_row];
    Table *table = run_section_begin("Settings", 7, HEADS, style, text);
    for (size_t i = 0; i < contact->row_count; i++) {
        const bool has_row = rows[i].map != ODE_MAP_IMPULSE;
        begin_row(report, rows, i, table);
        run_section_finite(table, "%.3g", is_poisson ? NAN : rows[i].steps_a_contact);
        run_section_finite(table, "%.3g", is_poisson ? NAN : rows[i].omega_h);
        run_section_finite(table, "%.6g", has_row ? rows[i].soft.erp : NAN);
        run_section_finite(table, "%.6g", has_row ? rows[i].soft.cfm : NAN);
        table_cell(table, "%s", rows[i].words);
    }
    run_section_end(table, text);
    if (!is_poisson) {
        text_append(text, "  ERP and CFM at the law's deepest point");
        text_append(text,
                    contact->impact.law.family == FORCE_LAW_POWER &&
                            contact->impact.law.exponent == 1.0 &&
                            contact->impact.law.hysteresis == 0.0
                        ? "; of a linear spring and damper they hold at any depth, but for the "
                          "midpoint's ERP.\n"
                        : "; the engine is given them anew at the depth of each step.\n");
    }
}

// Two cells: predicted, and delivered where it was measured.
static void pair_cells(Table *table, const MappingRow *row, const ImpactSpread *predicted,
                       const ImpactSpread *delivered, double unit)
{
    run_section_finite(table, "%.4g", row->predicted.is_ended ? unit * predicted->mean : NAN);
    run_section_finite(table, "%.4g", row->delivered.is_measured ? unit * delivered->mean : NAN);
}

static void write_figures(const MappingReport *report, const MappingContact *contact,
                          const Style *style, Text *text)
{
    static const RunSectionHead HEADS[] = {
        {"map", "", TABLE_LEFT},
        {"step", "us", TABLE_RIGHT},
        {"restitution", "predicted", TABLE_RIGHT},
        {"", "delivered", TABLE_RIGHT},
        {"peak, N", "predicted", TABLE_RIGHT},
        {"", "delivered", TABLE_RIGHT},
        {"depth, um", "predicted", TABLE_RIGHT},
        {"", "delivered", TABLE_RIGHT},
        {"contact, us", "predicted", TABLE_RIGHT},
        {"", "delivered", TABLE_RIGHT},
    };
    const MappingRow *rows = &report->mapping->rows[contact->first_row];
    Table *table = run_section_begin("Predicted and delivered", 10, HEADS, style, text);
    if (!mapping_report_is_poisson(report)) {
        const MapImpact *asked = &contact->asked;
        const double values[] = {asked->restitution, asked->force_max,
                                 asked->penetration_max * UNITS_UM, asked->duration * UNITS_US};
        table_cell(table, "asked");
        table_cell(table, "-");
        for (int i = 0; i < 4; i++) {
            table_cell(table, "%.4g", values[i]);
            table_cell(table, "%s", "");
        }
        table_rule(table);
    }
    for (size_t i = 0; i < contact->row_count; i++) {
        const ImpactFigures *predicted = &rows[i].predicted;
        const ImpactFigures *delivered = &rows[i].delivered.figures;
        begin_row(report, rows, i, table);
        pair_cells(table, &rows[i], &predicted->restitution, &delivered->restitution, 1.0);
        pair_cells(table, &rows[i], &predicted->force_max, &delivered->force_max, 1.0);
        pair_cells(table, &rows[i], &predicted->penetration_max, &delivered->penetration_max,
                   UNITS_UM);
        pair_cells(table, &rows[i], &predicted->duration, &delivered->duration, UNITS_US);
    }
    run_section_end(table, text);
}

// Why rows could not be run; neighbours alike are told once.
static void write_unmeasured(const MappingReport *report, const MappingContact *contact, Text *text)
{
    const char *last = "";
    for (size_t i = 0; i < contact->row_count; i++) {
        const MappingRow *row = &report->mapping->rows[contact->first_row + i];
        if (!row->delivered.is_measured && strcmp(row->delivered.message, last) != 0) {
            text_append(text, "  not run: %s at %.4g us: %s\n", mapping_report_map(report, row),
                        row->step_s * UNITS_US, row->delivered.message);
        }
        last = row->delivered.is_measured ? "" : row->delivered.message;
    }
}

void mapping_text_write(const MappingReport *report, const Style *style, Text *text)
{
    write_head(report, style, text);
    for (size_t i = 0; i < report->mapping->contact_count; i++) {
        const MappingContact *contact = &report->mapping->contacts[i];
        char law[MAPPING_REPORT_LAW_SIZE];
        mapping_report_law(contact, law);
        text_append(text, "\n%s%s, %s%s\n\n", style->heading,
                    mapping_report_joint(report, contact)->name, law, style->end);
        write_sources(report, contact, text);
        write_law(report, contact, text);
        if (!mapping_report_is_poisson(report)) {
            write_run(contact, text);
            write_longest(report, contact, style, text);
        }
        write_settings(report, contact, style, text);
        write_figures(report, contact, style, text);
        write_unmeasured(report, contact, text);
    }
    if (report->penalty != NULL) {
        mapping_penalty_text_write(report, style, text);
    }
}
