// Panels with axes and lines, written as SVG.
#pragma once

#include "base/text.h"

#include <stdbool.h>
#include <stddef.h>

// An axis: a range of values on a linear or logarithmic scale, and its ticks.

enum { AXIS_TICK_MAX = 64 };

typedef enum AxisScale {
    AXIS_LINEAR,
    AXIS_LOG,    // what is not positive lies on the lower edge
    AXIS_SYMLOG, // linear up to the threshold, a decade a tick beyond it, on both sides of zero
} AxisScale;

typedef struct Axis {
    const char *title; // with its unit
    AxisScale scale;
    double low; // at the left or lower edge
    double high;
    double threshold; // of AXIS_SYMLOG
    double tick;      // of AXIS_LINEAR: distance of the ticks; 0: chosen
} Axis;

// The spacing of about so many ticks over a span: 1, 2 or 5 times a power of ten.
double axis_step(double span, int wanted);

// Widens a range to whole ticks, so that nothing touches the edges.
void axis_round(double *low, double *high);

// Widens a range to 0 and then to whole ticks; not to 0 where that would leave most of the axis
// empty. An empty range, of which low is above high, becomes one about 0.
void axis_fit(double *low, double *high);

// Widens a range of a logarithmic axis to 1, 2 or 5 times powers of ten, and so far that at least
// two powers of ten stand in it.
void axis_round_log(double *low, double *high);

// A rectangle of the picture, in pixels, with the axes it shows.
typedef struct PlotPanel {
    Text *svg; // written to; not owned
    const char *title;
    double left;
    double top;
    double width;
    double height;
    Axis x;
    Axis y;
} PlotPanel;

typedef struct PlotStyle {
    const char *colour;
    double width; // pixels
    double opacity;
    const char *dash; // as SVG writes it; NULL: a whole line
} PlotStyle;

// The line of a kind (0: wide and pale, 1: thin, 2: thin and broken) in the colour of that number;
// both repeat after the last.
PlotStyle plot_style(size_t kind, size_t colour);

// A very thin line in a dark shade of the colour of that number, which shows on lines of the colour
// itself.
PlotStyle plot_style_dark(size_t colour);

// Begins and ends a picture of that size in pixels.
void plot_begin(Text *svg, double width, double height, const char *title);
void plot_end(Text *svg);

// Text at a position of the picture; the anchor is "start", "middle" or "end".
void plot_text(Text *svg, double x, double y, const char *anchor, const char *css_class,
               const char *text);

// A short piece of line, for a legend.
void plot_sample(Text *svg, double x, double y, PlotStyle style);

// Where a value of an axis stands in the picture, pixels.
double plot_x(const PlotPanel *panel, double x);
double plot_y(const PlotPanel *panel, double y);

// Thin lines at 2 .. 9 times the powers of ten of logarithmic axes; drawn before plot_enter.
void plot_fine_grid(const PlotPanel *panel);

// The grid, the ticks, the titles. What is drawn next in the panel is cut at its edges, up to
// plot_leave.
void plot_enter(const PlotPanel *panel);

// The same without ticks and lines of its own: the titles alone.
void plot_enter_bare(const PlotPanel *panel);

void plot_leave(const PlotPanel *panel);

// A line through points. What cannot be seen at half a pixel is left out.
void plot_line(const PlotPanel *panel, size_t count, const double *x, const double *y,
               PlotStyle style);

// A band from the least to the largest value at each x, drawn for each half pixel column as a
// stroke, the strokes joined to a line. Every value shows; the size is bounded by the pixels. The
// title is what a viewer shows of it.
void plot_band(const PlotPanel *panel, size_t count, const double *x, const double *least,
               const double *most, const char *title, PlotStyle style);

// The part of the panel below a height of the picture in a pale colour.
void plot_below(const PlotPanel *panel, double top, const char *colour);

// A dot with a rim at a position of the picture, pixels.
void plot_spot(Text *svg, double x, double y, double radius, const char *colour, const char *rim,
               double rim_width);

// A dot at a point.
void plot_dot(const PlotPanel *panel, double x, double y, PlotStyle style);

// A triangle whose tip is at a point: above it, or below where `is_below`.
void plot_mark(const PlotPanel *panel, double x, double y, bool is_below, const char *title,
               PlotStyle style);

// The same for a legend, with its tip at a position of the picture.
void plot_mark_sample(Text *svg, double x, double y, PlotStyle style);

// A grey ground from one x to another.
void plot_shade(const PlotPanel *panel, double from, double to);

// A circle about the origin, in units of the axes.
void plot_circle(const PlotPanel *panel, double radius, PlotStyle style);
