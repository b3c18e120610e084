// Which constants are best at a step that cannot be changed, and what are they worth?
#include "commands/map/mapping_report.h"
#include "write/units.h"

#include <math.h>
#include <stdio.h>

enum { HEADING_SIZE = 64, SHARE_SIZE = 64 };

static double share_of(const ImpactSpread *spread, double asked)
{
    return spread->mean / asked;
}

static void setting_row(const MappingContact *contact, const HeldSetting *setting, Table *table)
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

static void write_table(const MappingContact *contact, const Style *style, Text *text)
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
    for (int i = 0; i < HELD_MAP_COUNT; i++) {
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
static void write_worth(const MappingContact *contact, const HeldSetting *setting,
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
    const Held *held = contact->held;
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

void mapping_held_text(const MappingContact *contact, const Style *style, Text *text)
{
    const HeldSetting *pair = &contact->held->settings[0];
    const HeldSetting *row = &contact->held->settings[1];
    const JointUnits *units = mapping_report_units(contact);
    char values[HEADING_SIZE];
    write_table(contact, style, text);
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
    for (int i = 0; i < HELD_MAP_COUNT; i++) {
        const HeldSetting *setting = &contact->held->settings[i];
        if (!setting->delivered.is_measured) {
            text_append(text, "  not run in ODE: %s: %s\n", OPTIONS_ODE_MAPS[setting->map],
                        setting->delivered.message);
        }
    }
}
