// What does a run look like?
#include "commands/run/plot_look.h"

#include <math.h>
#include <stdbool.h>
#include <stdio.h>
#include <string.h>

static const double PICTURE_WIDTH = 1000.0; // pixels, as all that follow
static const double PICTURE_HEIGHT = 880.0;
static const double ROW_HEIGHT = 384.0; // of every row of panels after the second
static const double PANEL_WIDTH = 390.0;
static const double PANEL_HEIGHT = 290.0;
static const double PANEL_LEFT[2] = {84.0, 584.0};
static const double PANEL_TOP = 146.0; // of the first row
static const double LEGEND_TOP = 62.0;
static const double LEGEND_ROW = 22.0;
static const double LEGEND_END = 106.0; // the last row that leaves the panels where they are

// The part of a picture that is drawn below its legend.
typedef struct Sheet {
    Text *svg;
    double top; // of the first row of panels
} Sheet;

static PlotPanel place_panel(const PlotView *view, Sheet sheet, int row, int column,
                             const char *title)
{
    return (PlotPanel){
        .svg = sheet.svg,
        .title = title,
        .left = PANEL_LEFT[column],
        .top = sheet.top + row * ROW_HEIGHT,
        .width = PANEL_WIDTH,
        .height = PANEL_HEIGHT,
        .x = plot_look_x_axis(view),
    };
}

// Where the next entry of the legend begins.
typedef struct Legend {
    Text *svg;
    double x;
    double y;
} Legend;

static void add_entry(Legend *legend, PlotStyle style, const char *words)
{
    // a character of this font takes some 7 pixels
    const double width = 37.0 + 7.2 * (double)strlen(words) + 22.0;
    if (legend->x + width > PICTURE_WIDTH) {
        legend->x = PANEL_LEFT[0];
        legend->y += LEGEND_ROW;
    }
    plot_sample(legend->svg, legend->x, legend->y - 4.0, style);
    plot_text(legend->svg, legend->x + 37.0, legend->y, "start", "", words);
    legend->x += width;
}

// the label, with the backend before it where the label does not begin with it
static void name_run(const Trajectory *run, char *words, size_t size)
{
    const bool is_named = strncmp(run->label, run->backend, strlen(run->backend)) == 0;
    snprintf(words, size, "%s%s%s%s", is_named ? "" : run->backend, is_named ? "" : ": ",
             run->label, run->is_complete ? "" : " (failed)");
}

static void add_marks(Legend *legend, const Trajectory *run)
{
    char words[LINKAGE_NAME_SIZE + 64];
    snprintf(words, sizeof words, "spikes of the table, %s", run->backend);
    add_entry(legend, (PlotStyle){"#333333", 0.0, 0.0, NULL}, words);
    const double width = 37.0 + 7.2 * (double)strlen(words) + 22.0;
    plot_mark_sample(legend->svg, legend->x - width + 20.0, legend->y,
                     (PlotStyle){"#333333", 1.0, 1.0, NULL});
}

// The colour of a body or joint that a panel draws.
static void add_colour(Legend *legend, const PlotView *view, bool is_joint, size_t index,
                       const char *what, const char *name)
{
    if (plot_view_set(view, is_joint)->is_named[index]) {
        PlotStyle style = plot_style(1, plot_look_colour(view, is_joint, index));
        style.width = 3.0;
        char words[LINKAGE_NAME_SIZE + 16];
        snprintf(words, sizeof words, "%s%s", what, name);
        add_entry(legend, style, words);
    }
}

// Says how many of a set are drawn, and which.
static void add_left_out(Legend *legend, const PlotSet *set, const char *what, const char *by)
{
    if (set->left_out > 0) {
        char words[128];
        snprintf(words, sizeof words,
                 "%zu of %zu %s are drawn, those of the largest %s; grey: the range of the others",
                 set->drawn, set->drawn + set->left_out, what, by);
        legend->y += LEGEND_ROW;
        plot_text(legend->svg, PANEL_LEFT[0], legend->y, "start", "note", words);
    }
}

// Returns where its last row stands.
static double draw_legend(const PlotView *view, Text *svg)
{
    const RunReport *report = view->report;
    Legend legend = {svg, PANEL_LEFT[0], LEGEND_TOP};
    for (size_t i = 0; i < report->run_count; i++) {
        const Trajectory *run = report->runs[i];
        PlotStyle style = plot_style(i, 0);
        style.colour = "#333333";
        char words[TRAJECTORY_LABEL_SIZE + LINKAGE_NAME_SIZE + 16];
        name_run(run, words, sizeof words);
        add_entry(&legend, style, words);
    }
    legend.x = PANEL_LEFT[0];
    legend.y += LEGEND_ROW;
    const Linkage *linkage = &report->scenario->linkage;
    for (size_t i = 0; i < linkage->body_count; i++) {
        add_colour(&legend, view, false, i, "", linkage->bodies[i].name);
    }
    for (size_t i = 0; i < linkage->joint_count; i++) {
        add_colour(&legend, view, true, i, "joint ", linkage->joints[i].name);
    }
    const Trajectory *spiky = plot_look_spike_run(view);
    if (spiky != NULL) {
        add_marks(&legend, spiky);
    }
    add_left_out(&legend, &view->bodies, "bodies", "accelerations");
    add_left_out(&legend, &view->joints, "joints", "forces");
    return legend.y;
}

// What is drawn from the second panel of the second row on.
typedef void (*DrawPanel)(const PlotView *view, PlotPanel panel);

enum { PANEL_MAX = 17 };

static bool has_joint(const RunReport *report, JointKind kind)
{
    const Linkage *linkage = &report->scenario->linkage;
    for (size_t i = 0; i < linkage->joint_count; i++) {
        if (linkage->joints[i].kind == kind) {
            return true;
        }
    }
    return false;
}

// The panels of the joints that the mechanism has.
static size_t choose_panels(const PlotView *view, DrawPanel panels[PANEL_MAX])
{
    const RunReport *report = view->report;
    size_t count = 0;
    if (!scenario_has_clearance(report->scenario)) {
        panels[count++] = plot_joints_errors;
    }
    if (has_joint(report, JOINT_CLEARANCE)) {
        panels[count++] = plot_joints_paths;
    }
    if (has_joint(report, JOINT_CLEARANCE) && report->scenario->linkage.is_spatial) {
        panels[count++] = plot_pins_tilts;
        panels[count++] = plot_pins_ends;
    }
    if (has_joint(report, JOINT_GUIDE)) {
        panels[count++] = plot_slides_paths;
        panels[count++] = plot_slides_offsets;
        panels[count++] = plot_slides_tilts;
    }
    if (has_joint(report, JOINT_GUIDE) || has_joint(report, JOINT_PRISMATIC)) {
        panels[count++] = plot_slides_accelerations;
    }
    if (has_joint(report, JOINT_STOP)) {
        panels[count++] = plot_slides_stops;
    }
    static const struct {
        bool is_angle;
        LimitKind kind;
        DrawPanel draw;
    } LIMITED[] = {
        {true, LIMIT_BACKLASH, plot_limits_angle_gaps},
        {true, LIMIT_STOPS, plot_limits_angles},
        {false, LIMIT_BACKLASH, plot_limits_length_gaps},
        {false, LIMIT_STOPS, plot_limits_lengths},
    };
    for (size_t i = 0; i < sizeof LIMITED / sizeof *LIMITED; i++) {
        if (plot_limits_any(&report->scenario->linkage, LIMITED[i].is_angle, LIMITED[i].kind)) {
            panels[count++] = LIMITED[i].draw;
        }
    }
    if (plot_limits_has_loop(&report->scenario->linkage)) {
        panels[count++] = plot_limits_loop;
    }
    if (view->bodies.left_out > 0) {
        panels[count++] = plot_overview_bodies;
    }
    if (view->joints.left_out > 0) {
        panels[count++] = plot_overview_joints;
    }
    return count;
}

void plot_run_write(const void *of, Text *svg)
{
    const RunReport *report = of;
    const char *title = report->scenario->title;
    PlotView view = plot_view_begin(report);
    DrawPanel panels[PANEL_MAX];
    const size_t count = choose_panels(&view, panels);
    const int more_rows = (int)count / 2;
    Text legend;
    text_init(&legend);
    const double pushed = fmax(0.0, draw_legend(&view, &legend) - LEGEND_END);
    const Sheet sheet = {svg, PANEL_TOP + pushed};
    plot_begin(svg, PICTURE_WIDTH, PICTURE_HEIGHT + pushed + more_rows * ROW_HEIGHT, title);
    plot_text(svg, PANEL_LEFT[0], 34.0, "start", "title", title);
    text_append(svg, "%s", legend.data);
    text_finish(&legend);
    for (int i = 0; i < 2; i++) {
        plot_motions_draw(&view, i, place_panel(&view, sheet, 0, i, ""));
    }
    plot_joints_forces(&view, place_panel(&view, sheet, 1, 0, "Force in the joint"));
    for (size_t i = 0; i < count; i++) {
        // the first stands beside the forces
        const int place = (int)i + 1;
        panels[i](&view, place_panel(&view, sheet, 1 + place / 2, place % 2, ""));
    }
    plot_end(svg);
    plot_view_finish(&view);
}
