// Pictures of a page of results: lines with a dot at each point, on linear or logarithmic axes.
#pragma once

#include "base/text.h"
#include "write/plot.h"

typedef struct DrawPoint {
    double x;
    double y;
} DrawPoint;

// What stands at the points of a line, so that lines of one colour can be told apart.
typedef enum DrawShape {
    DRAW_DOT,
    DRAW_SQUARE,
    DRAW_DIAMOND,
    DRAW_TRIANGLE,
    DRAW_WEDGE, // a triangle on its tip
    DRAW_RING,
} DrawShape;

typedef struct DrawLine {
    const char *name; // in the legend
    PlotStyle style;
    DrawShape shape;
    bool is_bare; // without dots
    bool is_dots; // without a line
    size_t count;
    DrawPoint *points; // owned
} DrawLine;

typedef struct Drawing {
    const char *title;
    const char *x_title; // with its unit
    const char *y_title;
    bool is_x_log;
    bool is_y_log;
    double level;           // a horizontal line, NaN: none
    const char *level_name; // in the legend
    size_t count;
    DrawLine *lines; // owned
} Drawing;

// Adds a line without points, which is valid until the next is added; and a point of it. What is
// not finite, or not above 0 on a logarithmic axis, is left out.
DrawLine *draw_add(Drawing *drawing, const char *name, PlotStyle style);
void draw_point(const Drawing *drawing, DrawLine *line, double x, double y);

// Appends the picture, and nothing without points. Frees what the drawing owns.
void draw_end(Drawing *drawing, Text *html);
