// Writes the text of a run: the model, the closed form, and what came out.
#include "analytic/closed_form.h"
#include "base/zeroed.h"
#include "commands/run/run_loads.h"
#include "commands/run/run_overview.h"
#include "commands/run/run_report.h"
#include "contact/law.h"
#include "contact/penalty.h"
#include "model/kinematics.h"
#include "model/loads.h"
#include "model/space_rows.h"
#include "write/alike.h"
#include "write/settled.h"
#include "write/table.h"
#include "write/units.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

// The closed form of the mechanism, before any solver has taken a step.

static void write_follower(const AnalyticSummary *summary, Text *text)
{
    if (!summary->has_limits) {
        text_append(text, "  follower             turns fully\n");
        return;
    }
    text_append(text, "  follower             %.6g to %.6g deg, a swing of %.6g deg\n",
                summary->follower_low * UNITS_DEG, summary->follower_high * UNITS_DEG,
                (summary->follower_high - summary->follower_low) * UNITS_DEG);
    text_append(text,
                "  limits of the swing  at crank %.1f deg (crank and coupler stretched) and "
                "%.1f deg (folded)\n",
                units_wrapped_deg(summary->limit_extended),
                units_wrapped_deg(summary->limit_folded));
}

// One quantity of the slider over a turn, with the digits that a comparison needs.
static void write_slide(const char *name, const char *unit, CurveExtreme extreme, double per_si,
                        Text *text)
{
    text_append(text, "  %-19s  %.9g to %.9g %s (crank %.3f and %.3f deg)\n", name,
                extreme.low * per_si, extreme.high * per_si, unit,
                units_wrapped_deg(extreme.low_angle), units_wrapped_deg(extreme.high_angle));
}

static void write_slider(const AnalyticSummary *summary, Text *text)
{
    text_append(text,
                "  stroke               %.6g mm, its ends at crank %.1f deg (stretched) and "
                "%.1f deg (folded)\n",
                (summary->slide.high - summary->slide.low) * UNITS_MM,
                units_wrapped_deg(summary->limit_extended),
                units_wrapped_deg(summary->limit_folded));
    write_slide("slider position", "mm", summary->slide, UNITS_MM, text);
    write_slide("slider velocity", "m/s", summary->velocity, 1.0, text);
    write_slide("slider acceleration", "m/s^2", summary->acceleration, 1.0, text);
}

static void analytic_text_kinematics(const RunReport *report, const Style *style, Text *text)
{
    const AnalyticSummary *summary = report->summary;
    const Scenario *scenario = report->scenario;
    if (report->no_summary != NULL) {
        text_append(text, "\n  no kinematics of the ideal %s: %s\n", closed_form_name(scenario),
                    report->no_summary);
    }
    if (summary == NULL) {
        return;
    }
    text_append(text, "\n%sKinematics of the ideal %s%s\n\n", style->heading,
                closed_form_name(scenario), style->end);
    if (!scenario->has_slidercrank) {
        text_append(text, "  class                %s\n", FOURBAR_GRASHOF_NAMES[summary->grashof]);
    }
    text_append(text, "  transmission angle   %.6g deg (crank %.1f) to %.6g deg (crank %.1f)\n",
                summary->transmission_low * UNITS_DEG,
                units_wrapped_deg(summary->transmission_low_crank),
                summary->transmission_high * UNITS_DEG,
                units_wrapped_deg(summary->transmission_high_crank));
    if (scenario->has_slidercrank) {
        write_slider(summary, text);
    } else {
        write_follower(summary, text);
    }
}

static void force_row(Table *table, const char *name, const char *unit, Extreme high, Extreme low)
{
    table_cell(table, "%s", name);
    table_cell(table, "%s", unit);
    table_cell(table, "%.6g", high.value);
    table_cell(table, "%.1f", units_wrapped_deg(high.crank_rad));
    table_cell(table, "%.6g", low.value);
    table_cell(table, "%.1f", units_wrapped_deg(low.crank_rad));
}

static void analytic_text_forces(const RunReport *report, const Style *style, Text *text)
{
    static const SectionHead HEADS[] = {
        {"quantity", "", TABLE_LEFT}, {"unit", "", TABLE_LEFT},
        {"max", "", TABLE_RIGHT},     {"at crank", "deg", TABLE_RIGHT},
        {"min", "", TABLE_RIGHT},     {"at crank", "deg", TABLE_RIGHT},
    };
    const AnalyticSummary *summary = report->summary;
    if (summary == NULL) {
        return;
    }
    Table *table = section_begin("Inverse dynamics, every joint ideal", 6, HEADS, style, text);
    force_row(table, "drive torque", "N m", summary->torque_max, summary->torque_min);
    const Linkage *linkage = &report->scenario->linkage;
    for (size_t i = 0; i < linkage->joint_count; i++) {
        char name[LINKAGE_NAME_SIZE + 16];
        snprintf(name, sizeof name, "reaction %s", linkage->joints[i].name);
        force_row(table, name, "N", summary->reaction_max[i], summary->reaction_min[i]);
    }
    section_end(table, text);
    text_append(text,
                "  power balance: drive power and rate of energy differ by %.1e of the largest\n",
                summary->power_residual);
}

// The unit in which people read a quantity, and how many of it make one of SI.
static const char *quantity_unit(int quantity, double *per_si)
{
    *per_si = 1.0;
    switch (quantity) {
    case FOURBAR_COUPLER_OMEGA:
    case FOURBAR_FOLLOWER_OMEGA:
        return "rad/s";
    case FOURBAR_COUPLER_ALPHA:
    case FOURBAR_FOLLOWER_ALPHA:
        return "rad/s^2";
    default:
        *per_si = UNITS_DEG;
        return "deg";
    }
}

// The combination in words: "coupler +, crank -, play crank-coupler shortens coupler".
static void describe_combination(const Stackup *stackup, const StackupCombination *combination,
                                 char *words, size_t size)
{
    size_t used = 0;
    words[0] = '\0';
    for (int i = 0; i < STACKUP_LENGTHS && used < size; i++) {
        if (stackup->is_source[i] && combination->length_side[i] != 0) {
            used += (size_t)snprintf(words + used, size - used, "%s%s %s", used > 0 ? ", " : "",
                                     STACKUP_LENGTH_NAMES[i],
                                     combination->length_side[i] > 0 ? "+" : "-");
        }
    }
    for (int i = 0; i < STACKUP_PLAYS && used < size; i++) {
        if (stackup->is_source[STACKUP_LENGTHS + i] && combination->play_link[i] >= 0) {
            used += (size_t)snprintf(words + used, size - used, "%s%s %s %s", used > 0 ? ", " : "",
                                     STACKUP_SOURCE_NAMES[STACKUP_LENGTHS + i],
                                     combination->play_sign[i] > 0 ? "stretches" : "shortens",
                                     STACKUP_LENGTH_NAMES[combination->play_link[i]]);
        }
    }
}

// A change: of an angle in degrees, for a share of an angle means nothing; else in percent.
static void change_cell(Table *table, int quantity, double change, double nominal)
{
    const bool is_angle = quantity == FOURBAR_FOLLOWER_ANGLE || quantity == FOURBAR_TRANSMISSION;
    if (is_angle) {
        table_cell(table, "%+.3f deg", change * UNITS_DEG);
    } else {
        table_cell(table, "%+.3g %%", change / fabs(nominal) * UNITS_PERCENT);
    }
}

// The swing of a follower that turns fully has no ends.
static bool has_row(const RunReport *report, int quantity)
{
    return quantity != FOURBAR_FOLLOWER_ANGLE || report->summary == NULL ||
           report->summary->has_limits;
}

static void bound_row(Table *table, const Stackup *stackup, int quantity, bool is_high)
{
    const StackupRow *row = &stackup->rows[quantity];
    const StackupBound *bound = is_high ? &row->high : &row->low;
    double per_si;
    const char *unit = quantity_unit(quantity, &per_si);
    const double nominal = is_high ? row->nominal_high : row->nominal_low;
    char words[256];
    describe_combination(stackup, &bound->combination, words, sizeof words);
    table_cell(table, "%s", STACKUP_QUANTITY_NAMES[quantity]);
    table_cell(table, "%s", is_high ? "max" : "min");
    table_cell(table, "%s", unit);
    table_cell(table, "%.6g", nominal * per_si);
    table_cell(table, "%.6g", bound->value * per_si);
    change_cell(table, quantity, bound->value - nominal, nominal);
    table_cell(table, "%s", words);
}

// What each source does alone.
static void write_shares(const RunReport *report, const Style *style, Text *text)
{
    const Stackup *stackup = report->stackup;
    size_t sources = 0;
    for (int i = 0; i < STACKUP_SOURCES; i++) {
        sources += stackup->is_source[i] ? 1 : 0;
    }
    Table *table = table_create(2 + sources);
    table_fit(table, style->width);
    table_head(table, 0, "each alone", "", TABLE_LEFT);
    table_head(table, 1, "", "", TABLE_LEFT);
    size_t column = 2;
    for (int i = 0; i < STACKUP_SOURCES; i++) {
        if (stackup->is_source[i]) {
            table_head(table, column++, STACKUP_SOURCE_NAMES[i], "", TABLE_RIGHT);
        }
    }
    for (int cell = 0; cell < 2 * FOURBAR_QUANTITY_COUNT; cell++) {
        const StackupRow *row = &stackup->rows[cell / 2];
        const StackupBound *bound = cell % 2 == 0 ? &row->high : &row->low;
        const double nominal = cell % 2 == 0 ? row->nominal_high : row->nominal_low;
        if (!has_row(report, cell / 2)) {
            continue;
        }
        table_cell(table, "%s", STACKUP_QUANTITY_NAMES[cell / 2]);
        table_cell(table, "%s", cell % 2 == 0 ? "max" : "min");
        for (int i = 0; i < STACKUP_SOURCES; i++) {
            if (stackup->is_source[i]) {
                change_cell(table, cell / 2, bound->alone[i], nominal);
            }
        }
    }
    section_end(table, text);
}

// What the closed form says of a four-bar: kinematics, forces, tolerance stack-up.
static void analytic_text_stackup(const RunReport *report, const Style *style, Text *text)
{
    static const SectionHead HEADS[] = {
        {"quantity", "", TABLE_LEFT},
        {"", "", TABLE_LEFT},
        {"unit", "", TABLE_LEFT},
        {"nominal", "", TABLE_RIGHT},
        {"worst case", "", TABLE_RIGHT},
        {"change", "", TABLE_RIGHT},
        {"where", "", TABLE_LEFT | TABLE_DETAIL},
    };
    const Stackup *stackup = report->stackup;
    if (report->no_stackup != NULL) {
        text_append(text, "\n  no tolerance stack-up: %s\n", report->no_stackup);
    }
    if (stackup == NULL || !stackup->has_sources) {
        return;
    }
    Table *table = section_begin("Tolerance stack-up, worst case", 7, HEADS, style, text);
    for (int quantity = 0; quantity < FOURBAR_QUANTITY_COUNT; quantity++) {
        if (has_row(report, quantity)) {
            bound_row(table, stackup, quantity, true);
            bound_row(table, stackup, quantity, false);
        }
    }
    section_end(table, text);
    text_append(text, "\n");
    write_shares(report, style, text);
    text_append(text,
                "  Play counts as a link of its radial clearance; impacts are not part of it.\n");
}

static size_t mobility(const Linkage *linkage, bool ideal_only)
{
    if (linkage->is_spatial) {
        SpaceMotion *motions = zeroed(linkage->body_count, sizeof *motions);
        space_start(linkage, motions);
        const size_t freedoms = space_rows_mobility(linkage, motions, ideal_only);
        free(motions);
        return freedoms;
    }
    Motion *motions = zeroed(linkage->body_count, sizeof *motions);
    linkage_start(linkage, motions);
    const size_t freedoms = kinematics_mobility(linkage, motions, ideal_only);
    free(motions);
    return freedoms;
}

static void write_freedoms(const Linkage *linkage, bool has_play, Text *text)
{
    const size_t closed = mobility(linkage, false);
    const size_t open = has_play ? mobility(linkage, true) : closed;
    text_append(text, "  mechanism   %zu %s%s, %zu joint%s, mobility %zu", linkage->body_count,
                linkage->body_count == 1 ? "body" : "bodies",
                linkage->is_spatial ? " in space" : "", linkage->joint_count,
                linkage->joint_count == 1 ? "" : "s", closed);
    if (open != closed) {
        text_append(text, " (%zu with the play open)", open);
    }
}

// How far a pin in space can tilt and slide.
static void write_room(const Joint *joint, Text *text)
{
    const double limit =
        asin(fmin(1.0, 2.0 * linkage_radial_clearance(joint) / joint->clearance.width));
    text_append(text, "\n              width %.7g mm: tilts up to %.4g mrad, ",
                joint->clearance.width * UNITS_MM, limit * UNITS_MRAD);
    if (joint->space.axial_clearance > 0.0) {
        text_append(text, "slides up to %.4g um each way", joint->space.axial_clearance * UNITS_UM);
    } else {
        text_append(text, "slides freely");
    }
}

static void run_text_write_pin(const Joint *joint, bool is_spatial, Text *text)
{
    text_append(text, "hole %.7g mm, pin %.7g mm, radial clearance %.4g um",
                2.0 * joint->clearance.hole_radius * UNITS_MM,
                2.0 * joint->clearance.pin_radius * UNITS_MM,
                linkage_radial_clearance(joint) * UNITS_UM);
    if (is_spatial) {
        write_room(joint, text);
    }
}

static void write_guide(const Joint *joint, Text *text)
{
    const Guide *guide = &joint->guide;
    const bool is_sleeve = guide->height > guide->opening;
    text_append(text, "%s %.7g mm, length %.7g mm, %s %.7g mm:\n", is_sleeve ? "sleeve" : "block",
                guide->height * UNITS_MM, guide->length * UNITS_MM, is_sleeve ? "rod" : "guide",
                guide->opening * UNITS_MM);
    text_append(text, "              %.4g um either way, tilts up to %.4g mrad",
                linkage_radial_clearance(joint) * UNITS_UM, linkage_guide_tilt(guide) * UNITS_MRAD);
}

static void run_text_write_stop(const Joint *joint, Text *text)
{
    const Stop *stop = &joint->stop;
    if (stop->radius_b > 0.0) {
        text_append(text, "%s of %.7g mm",
                    stop->cam > 0      ? "roller"
                    : stop->slot > 0.0 ? "pin"
                                       : "disc",
                    2.0 * stop->radius_b * UNITS_MM);
    } else {
        text_append(text, stop->is_flat ? "flat" : stop->cam > 0 ? "knife edge" : "point");
    }
    if (stop->cam > 0) {
        text_append(text, " on a cam that reaches %.7g mm", stop->radius_a * UNITS_MM);
    } else if (stop->slot > 0.0) {
        text_append(text, " in a slot of %.7g mm,\n", 2.0 * stop->radius_a * UNITS_MM);
        text_append(text, "              %.7g mm between its ends' centres, play %.4g um",
                    stop->slot * UNITS_MM, (stop->radius_a - stop->radius_b) * UNITS_UM);
    } else if (stop->is_disc) {
        text_append(text, " against a disc of %.7g mm", 2.0 * stop->radius_a * UNITS_MM);
    } else {
        text_append(text, " against a line");
    }
}

// That between teeth, also as the angle of what turns.
static void write_backlash(const Joint *joint, const char *turned, Text *text)
{
    const double backlash = joint->limits.backlash;
    text_append(text, "backlash %.4g um, %.4g deg of the %s", backlash * UNITS_UM,
                backlash / fabs(joint->gear.radius_b) * UNITS_DEG, turned);
}

// How far a table of gears reaches to either side, one of the linkage's profiles.
static void write_table(const Linkage *linkage, size_t number, const char *what, Text *text)
{
    if (number > 0) {
        const Profile *table = &linkage->profiles[number - 1];
        text_append(text, ",\n              %s from %.4g to %.4g um", what, table->least * UNITS_UM,
                    table->reach * UNITS_UM);
    }
}

static void write_teeth(const Linkage *linkage, const Joint *joint, Text *text)
{
    const Gear *gear = &joint->gear;
    text_append(text, "%.6g and %.6g teeth, pitch radii %.6g and %.6g mm,\n", joint->gear.teeth[0],
                joint->gear.teeth[1], joint->gear.radius_a * UNITS_MM,
                joint->gear.radius_b * UNITS_MM);
    text_append(text, "              ");
    write_backlash(joint, "second", text);
    if (gear->pressure_angle > 0.0) {
        text_append(text, ",\n              pressure angle %.6g deg",
                    gear->pressure_angle * UNITS_DEG);
    }
    write_table(linkage, gear->error, "transmission error", text);
    write_table(linkage, gear->relief, "relief", text);
    if (linkage_has_teeth_tables(joint)) {
        text_append(text, ", %zu times a turn of the first", gear->repeats);
    }
}

static void write_rack(const Joint *joint, Text *text)
{
    text_append(text, "pitch radius %.6g mm, ", fabs(joint->gear.radius_b) * UNITS_MM);
    write_backlash(joint, "pinion", text);
}

static void write_ends(const Limits *limits, double scale, const char *unit, Text *text)
{
    if (limits->kind == LIMIT_BACKLASH) {
        text_append(text, "%.6g %s", limits->backlash * scale, unit);
        return;
    }
    if (isfinite(limits->low)) {
        text_append(text, "low %.6g %s%s", limits->low * scale, unit,
                    isfinite(limits->high) ? ", " : "");
    }
    if (isfinite(limits->high)) {
        text_append(text, "high %.6g %s", limits->high * scale, unit);
    }
}

// What limits a coordinate: in degrees of a pivot, mm of a slider, and um of teeth.
static void run_text_write_limits(const Linkage *linkage, const Joint *joint, Text *text)
{
    switch (joint_coordinate(joint->kind)) {
    case JOINT_COORDINATE_ANGLE:
        write_ends(&joint->limits, UNITS_DEG, "deg", text);
        break;
    case JOINT_COORDINATE_POSITION:
        write_ends(&joint->limits, UNITS_MM, "mm", text);
        break;
    case JOINT_COORDINATE_TEETH:
        write_teeth(linkage, joint, text);
        break;
    case JOINT_COORDINATE_RACK:
        write_rack(joint, text);
        break;
    case JOINT_COORDINATE_NONE:
        break;
    }
}

// By what play joints stand together, in this order; what they are called there.
#define PLAY_LIST(play)                                                                            \
    play(IN_JOINT, "play") play(GEARS, "gears") play(RACK, "rack") play(BACKLASH, "backlash")      \
        play(STOPS, "stops") play(STOP, "stop")
#define PLAY_ID(id, word) PLAY_##id,
typedef enum Play { PLAY_LIST(PLAY_ID) PLAY_NONE } Play;

static Play play_at_limits(const Joint *joint)
{
    switch (joint_coordinate(joint->kind)) {
    case JOINT_COORDINATE_TEETH:
        return PLAY_GEARS;
    case JOINT_COORDINATE_RACK:
        return PLAY_RACK;
    case JOINT_COORDINATE_NONE:
    case JOINT_COORDINATE_ANGLE:
    case JOINT_COORDINATE_POSITION:
        break;
    }
    return joint->limits.kind == LIMIT_BACKLASH ? PLAY_BACKLASH : PLAY_STOPS;
}

static Play play_of(const Joint *joint)
{
    if (joint->limits.kind != LIMIT_NONE) {
        return play_at_limits(joint);
    }
    switch (joint_touches(joint->kind)) {
    case JOINT_TOUCHES_HOLE:
    case JOINT_TOUCHES_GUIDES:
        return PLAY_IN_JOINT;
    case JOINT_TOUCHES_DISC:
        return PLAY_STOP;
    case JOINT_TOUCHES_NOTHING:
    case JOINT_TOUCHES_TEETH:
        break;
    }
    return PLAY_NONE;
}

// What play it is, of a joint that has some.
static void run_text_write_joint(const Linkage *linkage, const Joint *joint, Text *text)
{
    if (joint->limits.kind != LIMIT_NONE) {
        run_text_write_limits(linkage, joint, text);
        return;
    }
    switch (joint_touches(joint->kind)) {
    case JOINT_TOUCHES_HOLE:
        run_text_write_pin(joint, linkage->is_spatial, text);
        break;
    case JOINT_TOUCHES_GUIDES:
        write_guide(joint, text);
        break;
    case JOINT_TOUCHES_DISC:
        run_text_write_stop(joint, text);
        break;
    case JOINT_TOUCHES_NOTHING:
    case JOINT_TOUCHES_TEETH: // at its limits alone
        break;
    }
}

// The play of all joints that stand together.
static void run_text_write_play(const Linkage *linkage, Play play, size_t width, Text *text)
{
#define PLAY_WORD(id, word) word,
    static const char *const WORDS[] = {PLAY_LIST(PLAY_WORD)};
    char lead[32];
    snprintf(lead, sizeof lead, "  %-12s", WORDS[play]);
    Alike *alike = alike_start();
    for (size_t i = 0; i < linkage->joint_count; i++) {
        if (play_of(&linkage->joints[i]) != play) {
            continue;
        }
        Text said;
        text_init(&said);
        run_text_write_joint(linkage, &linkage->joints[i], &said);
        alike_add(alike, linkage->joints[i].name, said.data);
        text_finish(&said);
    }
    alike_end(alike, lead, ": ", width, text);
}

static void write_mechanism(const RunReport *report, size_t width, Text *text)
{
    const Scenario *scenario = report->scenario;
    write_freedoms(&scenario->linkage, scenario_has_clearance(scenario), text);
    if (scenario->has_fourbar) {
        text_append(text, ", %s", FOURBAR_GRASHOF_NAMES[fourbar_grashof(&scenario->fourbar)]);
    }
    if (scenario->has_slidercrank) {
        text_append(text, ", slider-crank");
    }
    if (report->summary != NULL) {
        text_append(text, ", transmission angle %.4g to %.4g deg",
                    report->summary->transmission_low * UNITS_DEG,
                    report->summary->transmission_high * UNITS_DEG);
    }
    text_append(text, "\n");
    for (Play play = 0; play < PLAY_NONE; play++) {
        run_text_write_play(&scenario->linkage, play, width, text);
    }
}

static void write_table_of(const Driver *driver, Text *text)
{
    static const char *const PROFILES[] = {"cycloids", "polynomials", "trapezoids", "a spline"};
    const TimeTable *table = &driver->table;
    const size_t last = table->count - 1;
    if (wave_exists(&table->wave)) {
        run_loads_write_wave(driver->has_angles ? 0.0 : table->values[0], &table->wave,
                             driver->has_angles ? UNITS_DEG : UNITS_RPM,
                             driver->has_angles ? "deg" : "rpm", text);
        text_append(text, "\n");
    } else if (driver->has_angles) {
        const DriveExtent extent =
            drive_extent(driver, table->period_s > 0.0 ? table->period_s : table->times[last]);
        text_append(text, "by %.4g to %.4g deg over time in %s, %zu points\n",
                    extent.back * UNITS_DEG, extent.forth * UNITS_DEG, PROFILES[driver->profile],
                    table->count);
    } else {
        text_append(text, "from %.6g rpm to %.6g rpm by %zu points over time\n",
                    table->values[0] * UNITS_RPM, table->values[last] * UNITS_RPM, table->count);
    }
    text_append(text, "              largest %.6g rpm, %.6g rad/s, from %.4g deg\n",
                driver->speed * UNITS_RPM, driver->speed, driver->start * UNITS_DEG);
}

static void write_driver(const Driver *driver, Text *text)
{
    if (driver->table.count > 0) {
        write_table_of(driver, text);
    } else {
        text_append(text, "%.6g rpm %s, %.6g rad/s, from %.4g deg\n",
                    fabs(driver->speed) * UNITS_RPM,
                    driver->speed < 0.0 ? "clockwise" : "counter-clockwise", fabs(driver->speed),
                    driver->start * UNITS_DEG);
    }
}

static void write_drive(const Scenario *scenario, Text *text)
{
    const Linkage *linkage = &scenario->linkage;
    for (size_t i = 0; i < linkage_drive_count(linkage); i++) {
        const Driver *driver = linkage_drive(linkage, i);
        text_append(text, i == 0 ? "  drive       " : "              ");
        if (linkage->further_count > 0) {
            text_append_shown(text, linkage->joints[driver->joint].name);
            text_append(text, ": ");
        }
        write_driver(driver, text);
    }
    text_append(text, "  run         ");
    if (drive_is_steady(&linkage->driver)) {
        text_append(text, "%.6g revolution%s, ", scenario->run.revolutions,
                    scenario->run.revolutions == 1.0 ? "" : "s");
    }
    text_append(text, "%.6g ms, %zu samples\n", scenario_duration(scenario) * UNITS_MS,
                scenario_sample_count(scenario));
    if (scenario->run.report_from > 0.0) {
        text_append(text, "  reported    extremes, contacts and spikes from %.6g ms on\n",
                    scenario_report_from(scenario) * UNITS_MS);
    }
}

// The restitution depends on the speed of the impact: what it is at some.
static void run_text_write_dissipation(const ForceLaw *law, bool is_turning, Text *text)
{
    static const double SPEEDS[] = {0.1, 0.3, 1.0}; // m/s, rad/s
    text_append(text, " %.4g %s, which gives back", law_dissipation(law),
                is_turning ? "s/rad" : "s/m");
    for (size_t i = 0; i < sizeof SPEEDS / sizeof *SPEEDS; i++) {
        text_append(text, "%s %.3g at %.3g %s", i > 0 ? "," : "", law_restitution(law, SPEEDS[i]),
                    SPEEDS[i], is_turning ? "rad/s" : "m/s");
    }
}

// `law` is what the options make, NULL where that fails.
static void run_text_write_damping(const ContactOptions *contact, const ForceLaw *law,
                                   bool is_turning, Text *text)
{
    text_append(text, ", damping %s", OPTIONS_DAMPINGS[contact->damping]);
    if (contact->damping == DAMPING_VISCOUS || contact->damping == DAMPING_STEP) {
        text_append(text, " %s%.4g %s", contact->damping == DAMPING_STEP ? "to " : "",
                    contact->viscous_coefficient, is_turning ? "N m s/rad" : "N s/m");
        if (contact->damping == DAMPING_STEP) {
            text_append(text, " at a depth of %.4g %s",
                        is_turning ? contact->full_damping_depth
                                   : contact->full_damping_depth * UNITS_MM,
                        is_turning ? "rad" : "mm");
        }
    } else if (contact->damping == DAMPING_DISSIPATION) {
        if (law != NULL) {
            run_text_write_dissipation(law, is_turning, text);
        }
    } else if (contact->damping != DAMPING_NONE) {
        text_append(text, ", restitution %.4g", contact->restitution);
        if (contact->resting_speed > 0.0) {
            text_append(text, ", resting speed %.4g %s", contact->resting_speed,
                        is_turning ? "rad/s" : "m/s");
        }
    }
}

static void write_eye(const Clearance *clearance, Text *text)
{
    const bool is_given = clearance->eye_radius > 0.0;
    text_append(text, ", in an eye of %.4g times its hole",
                law_eye_ratio(clearance->eye_radius, clearance->hole_radius));
    text_append(text, "%s", is_given ? "" : " (assumed)");
}

static void write_impact_law(const Scenario *scenario, const Joint *joint, Text *text)
{
    const ContactOptions own = law_options(&scenario->contact, joint);
    const bool is_turning = linkage_is_torsional(joint);
    ForceLaw law;
    Err err = {0};
    text_append(text, "%s", own.stiffness > 0.0 ? "given stiffness" : OPTIONS_LAWS[own.law]);
    const bool is_built = law_build(&own, &scenario->material, &joint->clearance,
                                    scenario->linkage.driver.speed, &law, &err);
    if (!is_built) {
        text_append(text, " (%s)", err.text);
    } else if (law.family == FORCE_LAW_POWER) {
        text_append(text, ", K = %.4g %s", law.stiffness, is_turning ? "N m/rad" : "N/m");
        if (law.exponent != 1.0) {
            text_append(text, "^%.4g", law.exponent);
        }
    } else if (law.family == FORCE_LAW_LOGARITHMIC) {
        text_append(text, ", d = A F (B - ln F) with A = %.4g m/N, B = %.4g", law.compliance,
                    law.offset);
    } else {
        write_eye(&joint->clearance, text);
    }
    run_text_write_damping(&own, is_built ? &law : NULL, is_turning, text);
    if (joint->contact.gap_damping > 0.0) {
        text_append(text, ", in the gap %.4g %s", joint->contact.gap_damping,
                    is_turning ? "N m s/rad" : "N s/m");
    }
}

static void write_penalty(const Scenario *scenario, const Joint *joint, Text *text)
{
    const bool is_given = scenario->contact.penalty > 0.0;
    text_append(text, "poisson, p = %.4g N s/m (%s), restitution %.4g",
                is_given ? scenario->contact.penalty
                         : penalty_estimate(scenario->linkage.driver.speed, &scenario->material),
                is_given ? "given" : "the paper's estimate", scenario_restitution(scenario, joint));
}

// The coefficient of all joints with play, or of each where one has its own.
static void write_friction(const Scenario *scenario, size_t width, Text *text)
{
    const Linkage *linkage = &scenario->linkage;
    bool has_own = false;
    for (size_t i = 0; i < linkage->joint_count; i++) {
        has_own = has_own || linkage->joints[i].contact.has_friction;
    }
    if (!law_has_friction(scenario)) {
        return;
    }
    if (!has_own) {
        text_append(text, "  friction    coefficient %.4g\n", scenario->contact.friction);
        return;
    }
    Alike *alike = alike_start();
    for (size_t i = 0; i < linkage->joint_count; i++) {
        const Joint *joint = &linkage->joints[i];
        if (linkage_has_play(joint) && !linkage_is_torsional(joint)) {
            char said[40];
            snprintf(said, sizeof said, "coefficient %.4g", scenario_friction(scenario, joint));
            alike_add(alike, joint->name, said);
        }
    }
    alike_end(alike, "  friction    ", ": ", width, text);
}

static void run_text_write_contact(const Scenario *scenario, size_t width, Text *text)
{
    Alike *alike = alike_start();
    for (size_t i = 0; i < scenario->linkage.joint_count; i++) {
        const Joint *joint = &scenario->linkage.joints[i];
        if (!linkage_has_play(joint)) {
            continue;
        }
        Text said;
        text_init(&said);
        if (scenario->contact.model == CONTACT_IMPACT) {
            write_impact_law(scenario, joint, &said);
        } else {
            write_penalty(scenario, joint, &said);
        }
        alike_add(alike, joint->name, said.data);
        text_finish(&said);
    }
    alike_end(alike, "  contact     ", ": ", width, text);
    write_friction(scenario, width, text);
}

// Why the tolerance asked for is not held to the end.
static const char *why_held_only_so_far(const RunReport *report, const Trajectory *run)
{
    if (!run->is_short) {
        return "the reference is too uncertain";
    }
    return run_report_leaves_branch(report, run) ? "its joints pass a change point there"
           : run->wanted_s > 0.0                 ? "run.budget is too small"
                                                 : "run.most-steps is too small";
}

// What does not hold that a reader of the run would take for granted.
static void write_doubts(const RunReport *report, size_t number, const Style *style, Text *text)
{
    const Trajectory *run = report->runs[number];
    const TrajectoryError *error = &report->errors[number];
    if (!run->is_complete) {
        return;
    }
    if (run->trials > 0 && (run->is_short || run->estimate_is_cut)) {
        text_append(text, "              %sheld up to %.4g of %.4g ms only: %s%s\n", style->failure,
                    run->estimate_s * UNITS_MS, run->duration_s * UNITS_MS,
                    why_held_only_so_far(report, run), style->end);
    }
    const bool has_truth = run_report_has_truth(report);
    const double said = error_of_run(error, has_truth && report->truth->is_limited);
    const double uncertainty = has_truth ? report->truth->uncertainty : 0.0;
    // of a solver whose steps are all there is to its error; energy goes with the square of speed,
    // and is off by twice as much
    if (run->step_s > 0.0 && error->is_known && error->energy_lost > 2.0 * (said + uncertainty)) {
        text_append(
            text, "              %sits energy is off by %.2g of the largest, its speed by %.2g%s\n",
            style->failure, error->energy_lost, said, style->end);
    }
}

static void write_models(const RunReport *report, const Style *style, Text *text)
{
    for (size_t i = 0; i < report->run_count; i++) {
        const Trajectory *run = report->runs[i];
        text_append(text, "  %-10s  %s", run->backend, run->label);
        if (run->step_s > 0.0) {
            text_append(text, ", step %.6g us", run->step_s * UNITS_US);
        }
        if (run->constraint_rows > 0) {
            text_append(text, ", %zu constraint rows", run->constraint_rows);
        }
        if (run->contact_rows > 0) {
            text_append(text, ", at most %zu contact row%s", run->contact_rows,
                        run->contact_rows == 1 ? "" : "s");
        }
        if (!run->is_complete) {
            text_append(text, ", %sFAILED%s: %s", style->failure, style->end, run->message);
        }
        text_append(text, "\n");
        write_doubts(report, i, style, text);
    }
}

void run_text_write(const void *of, const Style *style, Text *text)
{
    const RunReport *report = of;
    const Scenario *scenario = report->scenario;
    section_title(scenario->title, scenario_path(scenario), style, text);
    run_overview_write(report, style->width, false, text);
    text_append(text, "\n");
    write_mechanism(report, style->width, text);
    run_loads_write(&report->scenario->linkage, style->width, text);
    write_drive(scenario, text);
    settled_text(scenario, text);
    run_text_write_contact(scenario, style->width, text);
    write_models(report, style, text);
    // what was asked comes first, how far it can be believed beside it, and theory last
    run_truth_errors(report, style, text);
    run_tables_extremes(report, style, text);
    run_turns_write(report, style, text);
    run_slides_motion(report, style, text);
    run_tables_forces(report, style, text);
    run_tables_contacts(report, style, text);
    run_tables_wear(report, style, text);
    run_tables_pins(report, style, text);
    run_slides_blocks(report, style, text);
    run_tables_spikes(report, RUN_TEXT_SPIKES, style, text);
    spike_tables_write(report, RUN_TEXT_SPIKES, style, text);
    run_tables_whole(report, style, text);
    run_truth_matches(report, style, text);
    run_truth_ensembles(report, style, text);
    run_truth_energy(report, style, text);
    run_tables_cost(report, style, text);
    analytic_text_kinematics(report, style, text);
    analytic_text_forces(report, style, text);
    analytic_text_stackup(report, style, text);
}
