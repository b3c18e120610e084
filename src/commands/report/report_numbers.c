// Writes what of a run is best read as a table: its numbers, where its energy went, and how its
// motion repeats.
#include "commands/report/report_numbers.h"
#include "commands/report/report_html.h"
#include "measure/section.h"
#include "measure/spectrum.h"
#include "write/units.h"

#include <math.h>
#include <stdlib.h>

// Numbers by member and run: those of model/number_list.h that have NUMBER_REPORT.

static bool is_reported(const Number *number, NumberOwner owner, const Linkage *linkage)
{
    return number->owner == owner && (number->places & NUMBER_REPORT) != 0 &&
           (number->traits & number_fields_lacked(linkage)) == 0;
}

static void append_head(const char *title, const char *unit, Text *html)
{
    Text words;
    text_init(&words);
    text_append(&words, "%s%s%s", title, unit[0] != '\0' ? ", " : "", unit);
    html_words("th scope=\"col\"", words.data, html);
    text_finish(&words);
}

static void append_heads(const RunReport *report, NumberOwner owner, NumberTurn turn, Text *html)
{
    const bool has_crank = run_report_has_crank(report);
    if (NUMBER_OWNERS[owner].members != NUMBER_OF_WHOLE) {
        append_head(NUMBER_OWNERS[owner].members == NUMBER_OF_BODIES ? "body" : "joint", "", html);
    }
    append_head("run", "", html);
    for (NumberId id = 0; id < NUMBER_COUNT; id++) {
        if (is_reported(&NUMBERS[id], owner, &report->scenario->linkage)) {
            append_head(NUMBERS[id].titles[turn], NUMBERS[id].units[turn], html);
            if ((NUMBERS[id].traits & NUMBER_TIMED) != 0) {
                append_head(has_crank ? "at crank" : "at time", has_crank ? "deg" : "ms", html);
            }
        }
    }
}

static void append_cells(const RunReport *report, NumberOwner owner, NumberTurn turn,
                         const NumberRecord *record, Text *html)
{
    for (NumberId id = 0; id < NUMBER_COUNT; id++) {
        const Number *number = &NUMBERS[id];
        if (!is_reported(number, owner, &report->scenario->linkage)) {
            continue;
        }
        const Extreme *value = &record->values[id];
        const double per_si =
            number->kind == NUMBER_OF_MICROSECONDS ? 1.0 : units_per_si(number->units[turn]);
        html_cell_number(number_is_whole(number) ? "%.0f" : "%.5g", value->value * per_si, html);
        if ((number->traits & NUMBER_TIMED) != 0 && run_report_has_crank(report)) {
            html_cell_number("%.1f", value->crank_rad * UNITS_DEG, html);
        } else if ((number->traits & NUMBER_TIMED) != 0) {
            html_cell_number("%.4f", value->time_s * UNITS_MS, html);
        }
    }
}

// Whether a row of it would have anything in it: a body that nothing strikes has no spike.
static bool has_cells(const RunReport *report, NumberOwner owner, const NumberRecord *record)
{
    bool has = false;
    for (NumberId id = 0; id < NUMBER_COUNT; id++) {
        has |= is_reported(&NUMBERS[id], owner, &report->scenario->linkage) &&
               isfinite(record->values[id].value);
    }
    return has;
}

// A table of the members of an owner whose units are of a kind; none where there is none.
static void append_numbers(const RunReport *report, const RunFloor *floors, NumberOwner owner,
                           NumberTurn turn, const char *caption, Text *html)
{
    const Linkage *linkage = &report->scenario->linkage;
    const NumberMembers members = NUMBER_OWNERS[owner].members;
    bool is_begun = false;
    for (size_t member = 0; member < number_member_count(owner, linkage); member++) {
        const bool is_its =
            number_turn(owner, linkage, member) == turn &&
            !(members == NUMBER_OF_BODIES && linkage_is_driven(linkage, (int)member));
        for (size_t i = 0; is_its && i < report->run_count; i++) {
            if (!report->runs[i]->is_complete) {
                continue;
            }
            const NumberRecord shown = run_floor_record(report, i, &floors[i], owner, member);
            if (!has_cells(report, owner, &shown)) {
                continue;
            }
            if (!is_begun) {
                text_append(html,
                            HTML_WIDE "<table class=\"numbers\">\n<caption>%s</caption>"
                                      "\n<thead><tr>",
                            caption);
                append_heads(report, owner, turn, html);
                text_append(html, "</tr></thead>\n<tbody>\n");
                is_begun = true;
            }
            text_append(html, "<tr>");
            if (members != NUMBER_OF_WHOLE) {
                html_words("th scope=\"row\"", number_member(owner, linkage, member), html);
            }
            html_words(members != NUMBER_OF_WHOLE ? "td class=\"run\"" : "th scope=\"row\"",
                       report->runs[i]->backend, html);
            append_cells(report, owner, turn, &shown, html);
            text_append(html, "</tr>\n");
        }
    }
    text_append(html, "%s", is_begun ? "</tbody></table></div>\n" : "");
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
        {NUMBER_OWNER_JOINT, NUMBER_PUSHED, "Joints, those without play too"},
        {NUMBER_OWNER_JOINT, NUMBER_TURNED, "Joints whose limits turn them"},
        {NUMBER_OWNER_JOINT_WEAR, NUMBER_PUSHED,
         "What wears the pins, a revolution or, without one, in the run"},
        {NUMBER_OWNER_RUN, NUMBER_PUSHED, "All bodies and joints together"},
        {NUMBER_OWNER_COST, NUMBER_PUSHED, "What the runs took"},
    };
    RunFloor *floors = run_floor_list(report);
    text_append(html, "<section id=\"numbers\">\n<h2>Numbers of the runs</h2>\n");
    for (size_t i = 0; i < sizeof TABLES / sizeof *TABLES; i++) {
        append_numbers(report, floors, TABLES[i].owner, TABLES[i].turn, TABLES[i].caption, html);
    }
    text_append(html, "</section>\n<section id=\"energy\">\n<h2>Where the energy went</h2>\n");
    append_numbers(report, floors, NUMBER_OWNER_ENERGY, NUMBER_PUSHED,
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
                    "A small change of the state becomes %.3g times itself in a revolution: "
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

// 1: of the largest value of a signal, what sums over its samples may leave by rounding
static const double ROUNDING = 1e-12;

static bool has_spectrum(const Trajectory *run)
{
    const Sections sections = section_find(run);
    return spectrum_orders(&sections).count > 0;
}

// The amplitudes of each body at the first whole orders.
static void append_amplitudes(const RunReport *report, Text *html)
{
    const Linkage *linkage = &report->scenario->linkage;
    text_append(html,
                HTML_WIDE "<table class=\"numbers\">\n<caption>Amplitudes of the "
                          "angular velocity, rad/s, by order: multiples of the speed of the drive; "
                          "between them only where the motion does not repeat every revolution"
                          "</caption>\n<thead><tr><th scope=\"col\">body</th><th scope=\"col\">run"
                          "</th>");
    for (size_t order = 0; order < ORDERS_SHOWN; order++) {
        text_append(html, "<th scope=\"col\">%s%zu</th>", order == 0 ? "mean, " : "", order);
    }
    text_append(html, "<th scope=\"col\">between</th></tr></thead>\n<tbody>\n");
    for (size_t i = 0; i < linkage->body_count; i++) {
        for (size_t k = 0; k < report->run_count; k++) {
            const Trajectory *run = report->runs[k];
            if (!run->is_complete || linkage_is_driven(linkage, (int)i) || !has_spectrum(run)) {
                continue;
            }
            text_append(html, "<tr>");
            html_words("th scope=\"row\"", linkage->bodies[i].name, html);
            html_words("td", run->backend, html);
            const double floor = ROUNDING * trajectory_omega_scale(run, i);
            for (size_t order = 0; order < ORDERS_SHOWN; order++) {
                html_cell_number("%.4g", run_floor_cut(spectrum_body_order(run, i, order), floor),
                                 html);
            }
            html_cell_number("%.2g", run_floor_cut(spectrum_body_between(run, i), floor), html);
            text_append(html, "</tr>\n");
        }
    }
    text_append(html, "</tbody></table></div>\n");
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
