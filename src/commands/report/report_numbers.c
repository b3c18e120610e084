// Writes what of a run is best read as a table: where its energy went, and how its motion repeats.
#include "commands/report/report_numbers.h"
#include "commands/report/report_html.h"
#include "measure/section.h"
#include "measure/spectrum.h"
#include "write/units.h"

#include <math.h>
#include <stdlib.h>

// Where the energy went.

static void energy_row(const Trajectory *run, const RunFloor *floor, bool has_loads, Text *html)
{
    const Energy shown = run_floor_energy(&run->energy, floor);
    const Energy *energy = &shown;
    const double largest = fmax(fmax(fabs(energy->drive_work), fabs(energy->load_work)),
                                fmax(fabs(energy->dissipated), fabs(energy->change)));
    text_append(html, "<tr>");
    html_words("th scope=\"row\"", run->backend, html);
    html_cell_units(energy->drive_work, "J", html);
    if (has_loads) {
        html_cell_units(energy->load_work, "J", html);
    }
    html_cell_units(energy->dissipated, "J", html);
    html_cell_units(energy->friction, "J", html);
    html_cell_units(energy->change, "J", html);
    html_cell_units(energy->residual, "J", html);
    html_cell_number("%.2g", largest > 0.0 ? fabs(energy->residual) / largest : NAN, html);
    text_append(html, "</tr>\n");
}

static void append_energy(const RunReport *report, Text *html)
{
    const bool has_loads = report->scenario->linkage.load_count > 0;
    text_append(html,
                "<section id=\"energy\">\n<h2>Where the energy went</h2>\n<div class=\"wide\">"
                "<table class=\"numbers\">\n<caption>Over the whole run. The residual is what the "
                "balance leaves unexplained: the solver's own error.</caption>\n<thead><tr>"
                "<th scope=\"col\">run</th><th scope=\"col\">work of the drive</th>%s"
                "<th scope=\"col\">lost in damping</th><th scope=\"col\">in friction</th>"
                "<th scope=\"col\">stored</th><th scope=\"col\">residual</th>"
                "<th scope=\"col\">of the largest</th></tr></thead>\n<tbody>\n",
                has_loads ? "<th scope=\"col\">of the loads</th>" : "");
    RunFloor *floors = run_floor_list(report);
    for (size_t i = 0; i < report->run_count; i++) {
        if (report->runs[i]->is_complete) {
            energy_row(report->runs[i], &floors[i], has_loads, html);
        }
    }
    free(floors);
    text_append(html, "</tbody></table></div>\n</section>\n");
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
    text_append(html, "<div class=\"wide\"><table class=\"numbers\">\n<caption>Motions that the "
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
static void append_orders(const RunReport *report, Text *html)
{
    const Linkage *linkage = &report->scenario->linkage;
    text_append(html, "<div class=\"wide\"><table class=\"numbers\">\n<caption>Amplitudes of the "
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
    append_orders(report, html);
    text_append(html, "</section>\n");
    text_finish(&words);
}

void report_numbers_write(const RunReport *report, Text *html)
{
    append_energy(report, html);
    append_repeating(report, html);
}
