// Writes what of a run is best read as a table: its numbers, where its energy went, and how its
// motion repeats.
#include "commands/report/report_numbers.h"
#include "base/zeroed.h"
#include "commands/report/report_html.h"
#include "measure/section.h"
#include "measure/spectrum.h"
#include "write/units.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

// Numbers by member and run: those of model/number_list.h that have NUMBER_REPORT.

// A table of the members of an owner whose units are of a kind.
typedef struct NumberTable {
    const RunReport *report;
    const RunFloor *floors; // by run
    NumberOwner owner;
    NumberTurn turn;
    bool has_rows;
    bool is_shown[NUMBER_COUNT]; // what is known in some row
} NumberTable;

static bool is_reported(const Number *number, NumberOwner owner, const Linkage *linkage)
{
    return number->owner == owner && (number->places & NUMBER_REPORT) != 0 &&
           (number->traits & number_fields_lacked(linkage)) == 0;
}

static void append_head(const char *title, const char *unit, Text *html)
{
    Text words;
    text_init(&words);
    const bool has_unit = unit[0] != '\0' && strcmp(unit, "1") != 0;
    text_append(&words, "%s%s%s", title, has_unit ? ", " : "", has_unit ? unit : "");
    html_words("th scope=\"col\"", words.data, html);
    text_finish(&words);
}

static void append_heads(const NumberTable *table, Text *html)
{
    const bool has_crank = run_report_has_crank(table->report);
    const NumberMembers members = NUMBER_OWNERS[table->owner].members;
    if (members != NUMBER_OF_WHOLE) {
        append_head(members == NUMBER_OF_BODIES ? "body" : "joint", "", html);
    }
    append_head("run", "", html);
    for (NumberId id = 0; id < NUMBER_COUNT; id++) {
        if (table->is_shown[id]) {
            append_head(NUMBERS[id].titles[table->turn], NUMBERS[id].units[table->turn], html);
            if ((NUMBERS[id].traits & NUMBER_TIMED) != 0) {
                append_head(has_crank ? "at crank" : "at time", has_crank ? "deg" : "ms", html);
            }
        }
    }
}

static void append_cells(const NumberTable *table, const NumberRecord *record, Text *html)
{
    const RunReport *report = table->report;
    for (NumberId id = 0; id < NUMBER_COUNT; id++) {
        const Number *number = &NUMBERS[id];
        if (!table->is_shown[id]) {
            continue;
        }
        const Extreme *value = &record->values[id];
        const double per_si =
            number->kind == NUMBER_OF_MICROSECONDS ? 1.0 : units_per_si(number->units[table->turn]);
        html_cell_number(number_is_whole(number) ? "%.0f" : "%.5g", value->value * per_si, html);
        if ((number->traits & NUMBER_TIMED) != 0 && run_report_has_crank(report)) {
            html_cell_number("%.1f", value->crank_rad * UNITS_DEG, html);
        } else if ((number->traits & NUMBER_TIMED) != 0) {
            html_cell_number("%.4f", value->time_s * UNITS_MS, html);
        }
    }
}

// The numbers of a member of a run; false where a row of it would have nothing in it: nothing
// strikes a body, or it does not turn.
static bool find_row(const NumberTable *table, size_t member, size_t run, NumberRecord *record)
{
    const RunReport *report = table->report;
    if (!report->runs[run]->is_complete) {
        return false;
    }
    *record = run_floor_record(report, run, &table->floors[run], table->owner, member);
    bool has = false;
    for (NumberId id = 0; id < NUMBER_COUNT; id++) {
        const double value = record->values[id].value;
        has |= is_reported(&NUMBERS[id], table->owner, &report->scenario->linkage) &&
               isfinite(value) && (table->owner != NUMBER_OWNER_BODY || value != 0.0);
    }
    return has;
}

static bool is_row_of(const NumberTable *table, size_t member)
{
    const Linkage *linkage = &table->report->scenario->linkage;
    const bool is_driven = NUMBER_OWNERS[table->owner].members == NUMBER_OF_BODIES &&
                           linkage_is_driven(linkage, (int)member);
    return number_turn(table->owner, linkage, member) == table->turn && !is_driven;
}

// Finds whether the table has rows, and its columns.
static void find_columns(NumberTable *table)
{
    const RunReport *report = table->report;
    const Linkage *linkage = &report->scenario->linkage;
    for (size_t member = 0; member < number_member_count(table->owner, linkage); member++) {
        for (size_t i = 0; is_row_of(table, member) && i < report->run_count; i++) {
            NumberRecord record;
            if (!find_row(table, member, i, &record)) {
                continue;
            }
            table->has_rows = true;
            for (NumberId id = 0; id < NUMBER_COUNT; id++) {
                table->is_shown[id] |= is_reported(&NUMBERS[id], table->owner, linkage) &&
                                       isfinite(record.values[id].value);
            }
        }
    }
}

static void append_rows(const NumberTable *table, size_t member, Text *html)
{
    const RunReport *report = table->report;
    const bool has_name = NUMBER_OWNERS[table->owner].members != NUMBER_OF_WHOLE;
    for (size_t i = 0; i < report->run_count; i++) {
        NumberRecord record;
        if (!find_row(table, member, i, &record)) {
            continue;
        }
        text_append(html, "<tr>");
        if (has_name) {
            html_words("th scope=\"row\"",
                       number_member(table->owner, &report->scenario->linkage, member), html);
        }
        html_words(has_name ? "td class=\"run\"" : "th scope=\"row\"", report->runs[i]->backend,
                   html);
        append_cells(table, &record, html);
        text_append(html, "</tr>\n");
    }
}

// A table; none where it would have no rows.
static void append_numbers(NumberTable table, const char *caption, Text *html)
{
    find_columns(&table);
    if (!table.has_rows) {
        return;
    }
    text_append(html, HTML_WIDE "<table class=\"numbers\">\n<caption>%s</caption>\n<thead><tr>",
                caption);
    append_heads(&table, html);
    text_append(html, "</tr></thead>\n<tbody>\n");
    const size_t members = number_member_count(table.owner, &table.report->scenario->linkage);
    for (size_t member = 0; member < members; member++) {
        if (is_row_of(&table, member)) {
            append_rows(&table, member, html);
        }
    }
    text_append(html, "</tbody></table></div>\n");
}

static void append_all_numbers(const RunReport *report, Text *html)
{
    static const struct {
        NumberOwner owner;
        NumberTurn turn;
        const char *caption;
    } TABLES[] = {
        {NUMBER_OWNER_BODY, NUMBER_PUSHED, "Bodies"},
        {NUMBER_OWNER_BODY_SPIKE, NUMBER_SPED, "The strongest spike of each acceleration"},
        {NUMBER_OWNER_JOINT, NUMBER_PUSHED, "Joints with and without play"},
        {NUMBER_OWNER_JOINT, NUMBER_TURNED, "Joints whose limits turn them"},
        {NUMBER_OWNER_JOINT_WEAR, NUMBER_PUSHED,
         "What wears the pins: in a revolution, or in the run where nothing turns round"},
        {NUMBER_OWNER_RUN, NUMBER_PUSHED, "All bodies and joints together"},
        {NUMBER_OWNER_COST, NUMBER_PUSHED, "What the runs took"},
    };
    RunFloor *floors = run_floor_list(report);
    text_append(html, "<section id=\"numbers\">\n<h2>Numbers of the runs</h2>\n");
    for (size_t i = 0; i < sizeof TABLES / sizeof *TABLES; i++) {
        append_numbers((NumberTable){.report = report,
                                     .floors = floors,
                                     .owner = TABLES[i].owner,
                                     .turn = TABLES[i].turn},
                       TABLES[i].caption, html);
    }
    text_append(html, "</section>\n<section id=\"energy\">\n<h2>Where the energy went</h2>\n");
    append_numbers((NumberTable){.report = report,
                                 .floors = floors,
                                 .owner = NUMBER_OWNER_ENERGY,
                                 .turn = NUMBER_PUSHED},
                   "Over the whole run. The residual is what the balance leaves unexplained: the "
                   "solver's own error.",
                   html);
    text_append(html, "</section>\n");
    free(floors);
}

// How the motion repeats.

// 1: how far a section may be from one of a settled motion, over the largest angular velocity, to
// be that of the same motion: by what the error of a run moves it
static const double SAME_MOTION = 1e-3;

// How far the last section of a run is from the nearest of all settled motions, over the largest
// angular velocity there.
static double motion_distance(const Scenario *scenario, const Trajectory *run)
{
    const SettledStart *settled = &scenario->settled;
    const size_t bodies = scenario->linkage.body_count;
    double nearest = INFINITY;
    for (size_t m = 0; m < settled->motion_count; m++) {
        for (size_t k = 0; k < settled->motions[m].section_count; k++) {
            const double *section = settled->motions[m].sections + k * bodies;
            double apart = 0.0;
            double largest = 0.0;
            for (size_t i = 0; i < bodies; i++) {
                apart = fmax(apart, fabs(section_omega(run, i, 0) - section[i]));
                largest = fmax(largest, fabs(section[i]));
            }
            nearest = fmin(nearest, apart / largest);
        }
    }
    return nearest;
}

static void append_repeats(const Scenario *scenario, const Trajectory *run, Text *words)
{
    const Sections sections = section_find(run);
    if (!sections.is_period_known) {
        return;
    }
    text_append(words, "%s", run->backend);
    if (sections.period == 0) {
        text_append(words, " does not repeat in %zu revolutions", sections.count - 1);
    } else if (sections.period == 1) {
        text_append(words, " repeats every revolution");
    } else {
        text_append(words, " repeats every %zu revolutions", sections.period);
    }
    text_append(words, ": its sections differ by %.2g of the fastest point's speed.",
                sections.change);
    const double distance = motion_distance(scenario, run);
    if (scenario->settled.motion_count > 0 && distance > SAME_MOTION) {
        text_append(words,
                    " None of the %zu starts of the reference came to this motion: the nearest "
                    "differs by %.2g of the largest angular velocity.",
                    scenario->settled.starts, distance);
    }
    text_append(words, "\n");
}

// What becomes of small changes, in a sentence.
static void append_growth(const Scenario *scenario, Text *words)
{
    const SettledGrowth *growth = &scenario->settled.growth;
    if (!scenario->settled.has_growth || isnan(growth->factor)) {
        return;
    }
    if (growth->is_at_most) {
        text_append(words,
                    "A small change of the state dies out: after a revolution less than "
                    "%.2g of it is left.\n",
                    growth->factor);
    } else {
        text_append(words,
                    "A small change of the state becomes %.3g of itself in a revolution: "
                    "%s.\n",
                    growth->factor, growth->factor < 1.0 ? "it dies out" : "it grows");
    }
}

// The angular velocities that the motions which starts have come to have once a revolution.
static void append_motions(const Scenario *scenario, Text *html)
{
    const SettledStart *settled = &scenario->settled;
    const Linkage *linkage = &scenario->linkage;
    if (settled->motion_count == 0) {
        return;
    }
    text_append(html,
                HTML_WIDE "<table class=\"numbers\">\n<caption>Motions that the "
                          "starts settled at, and the angular velocity of each body, rad/s, at the "
                          "end of their revolutions</caption>\n<thead><tr><th scope=\"col\">motion"
                          "</th><th scope=\"col\">starts</th><th scope=\"col\">revolution</th>");
    for (size_t i = 0; i < linkage->body_count; i++) {
        html_words("th scope=\"col\"", linkage->bodies[i].name, html);
    }
    text_append(html, "</tr></thead>\n<tbody>\n");
    for (size_t m = 0; m < settled->motion_count; m++) {
        const SettledMotion *motion = &settled->motions[m];
        for (size_t k = 0; k < motion->section_count; k++) {
            text_append(html, "<tr><th scope=\"row\">%zu</th><td>%zu</td><td>%zu</td>", m + 1,
                        motion->starts, k + 1);
            for (size_t i = 0; i < linkage->body_count; i++) {
                html_cell_number("%.6g", motion->sections[k * linkage->body_count + i], html);
            }
            text_append(html, "</tr>\n");
        }
    }
    text_append(html, "</tbody></table></div>\n");
}

enum { ORDERS_SHOWN = 8 };

// The amplitudes of a body in a run at the first whole orders, rad/s, and what is between orders.
typedef struct Amplitudes {
    double orders[ORDERS_SHOWN];
    double between;
} Amplitudes;

// 1: of the largest value of a signal, what sums over its samples may leave by rounding
static const double ROUNDING = 1e-12;

static bool has_spectrum(const Trajectory *run)
{
    const Sections sections = section_find(run);
    return spectrum_orders(&sections).count > 0;
}

// False where there are none: of a driven body, of one that does not turn, of a run too short.
static bool find_amplitudes(const RunReport *report, size_t number, const RunFloor *floor,
                            size_t body, Amplitudes *found)
{
    const Trajectory *run = report->runs[number];
    const double scale = run->is_complete ? trajectory_omega_scale(run, body) : 0.0;
    if (linkage_is_driven(&report->scenario->linkage, (int)body) || !(scale > floor->turning) ||
        !has_spectrum(run)) {
        return false;
    }
    const double least = ROUNDING * scale;
    for (size_t order = 0; order < ORDERS_SHOWN; order++) {
        found->orders[order] = run_floor_cut(spectrum_body_order(run, body, order), least);
    }
    found->between = run_floor_cut(spectrum_body_between(run, body), least);
    return true;
}

static void begin_amplitudes(bool has_between, Text *html)
{
    text_append(html,
                HTML_WIDE "<table class=\"numbers\">\n<caption>Amplitudes of the angular "
                          "velocity, rad/s, at multiples of the speed of the drive%s</caption>\n"
                          "<thead><tr><th scope=\"col\">body</th><th scope=\"col\">run</th>",
                has_between ? ", and between them, for the motion does not repeat every revolution"
                            : "");
    for (size_t order = 0; order < ORDERS_SHOWN; order++) {
        text_append(html, "<th scope=\"col\">%zu%s</th>", order, order == 0 ? ", mean" : "");
    }
    text_append(html, "%s</tr></thead>\n<tbody>\n",
                has_between ? "<th scope=\"col\">between</th>" : "");
}

static void append_amplitudes(const RunReport *report, Text *html)
{
    const Linkage *linkage = &report->scenario->linkage;
    RunFloor *floors = run_floor_list(report);
    const size_t count = linkage->body_count * report->run_count;
    Amplitudes *all = zeroed(count, sizeof *all);
    bool *is_there = zeroed(count, sizeof *is_there);
    bool has_any = false;
    bool has_between = false;
    for (size_t at = 0; at < count; at++) {
        const size_t run = at % report->run_count;
        is_there[at] = find_amplitudes(report, run, &floors[run], at / report->run_count, &all[at]);
        has_any |= is_there[at];
        has_between |= is_there[at] && all[at].between > 0.0;
    }
    if (has_any) {
        begin_amplitudes(has_between, html);
    }
    for (size_t at = 0; at < count; at++) {
        if (!is_there[at]) {
            continue;
        }
        text_append(html, "<tr>");
        html_words("th scope=\"row\"", linkage->bodies[at / report->run_count].name, html);
        html_words("td class=\"run\"", report->runs[at % report->run_count]->backend, html);
        for (size_t order = 0; order < ORDERS_SHOWN; order++) {
            html_cell_number("%.4g", all[at].orders[order], html);
        }
        if (has_between) {
            html_cell_number("%.2g", all[at].between, html);
        }
        text_append(html, "</tr>\n");
    }
    text_append(html, "%s", has_any ? "</tbody></table></div>\n" : "");
    free(is_there);
    free(all);
    free(floors);
}

static void append_repeating(const RunReport *report, Text *html)
{
    bool is_there = report->scenario->settled.motion_count > 0;
    for (size_t i = 0; i < report->run_count; i++) {
        is_there = is_there || (report->runs[i]->is_complete && has_spectrum(report->runs[i]));
    }
    if (!is_there) {
        return;
    }
    Text words;
    text_init(&words);
    for (size_t i = 0; i < report->run_count; i++) {
        append_repeats(report->scenario, report->runs[i], &words);
    }
    append_growth(report->scenario, &words);
    text_append(html, "<section id=\"repeating\">\n<h2>How the motion repeats</h2>\n");
    html_list(words.data, html);
    append_motions(report->scenario, html);
    append_amplitudes(report, html);
    text_append(html, "</section>\n");
    text_finish(&words);
}

void report_numbers_write(const RunReport *report, Text *html)
{
    append_all_numbers(report, html);
    append_repeating(report, html);
}
