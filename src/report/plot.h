// Panels with axes and lines, written as SVG.
#pragma once

#include "base/text.h"
#include "report/axis.h"

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

// Begins and ends a picture of so many pixels.
void plot_begin(Text *svg, double width, double height, const char *title);
void plot_end(Text *svg);

// Text at a place of the picture; the anchor is "start", "middle" or "end".
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
void plot_leave(const PlotPanel *panel);

// A line through points. What cannot be seen at half a pixel is left out.
void plot_line(const PlotPanel *panel, size_t count, const double *x, const double *y,
               PlotStyle style);

// A line from the lower edge up to the point, with a dot on it.
void plot_stem(const PlotPanel *panel, double x, double y, PlotStyle style);

// A circle about the origin, in units of the axes.
void plot_circle(const PlotPanel *panel, double radius, PlotStyle style);
