// Draws panels with axes and lines as SVG.
#include "write/plot.h"
#include "write/xml.h"

#include <float.h>
#include <math.h>
#include <stdbool.h>
#include <stdio.h>

// The place of a value on an axis, and its ticks.

enum { AXIS_TICKS_WANTED = 6, AXIS_DECADE_LABELS = 7 };

// A value on its axis's own scale, on which distances are pixels.
static double plot_scaled(const Axis *axis, double value)
{
    switch (axis->scale) {
    case AXIS_LOG:
        return log10(fmax(value, axis->low));
    case AXIS_SYMLOG: {
        const double ratio = fabs(value) / axis->threshold;
        return copysign(ratio <= 1.0 ? ratio : 1.0 + log10(ratio), value);
    }
    default:
        return value;
    }
}

// Where a value stands between the two edges, 0 to 1; outside of them beyond that.
static double axis_share(const Axis *axis, double value)
{
    const double low = plot_scaled(axis, axis->low);
    return (plot_scaled(axis, value) - low) / (plot_scaled(axis, axis->high) - low);
}

double axis_step(double span, int wanted)
{
    const double raw = span / wanted;
    const double power = pow(10.0, floor(log10(raw)));
    const double lead = raw / power;
    return power * (lead < 1.5 ? 1.0 : lead < 3.5 ? 2.0 : lead < 7.5 ? 5.0 : 10.0);
}

void axis_round(double *low, double *high)
{
    // a constant gets a range about itself
    if (!(*high - *low > 1e-9 * fmax(fabs(*low), fabs(*high)))) {
        const double margin = fmax(0.1 * fabs(*high), DBL_MIN * 1e6);
        *low -= margin;
        *high += margin;
    }
    const double margin = 0.02 * (*high - *low);
    const double tick = axis_step(*high - *low, AXIS_TICKS_WANTED);
    *low = tick * floor((*low - margin) / tick);
    *high = tick * ceil((*high + margin) / tick);
}

// Farther from 0 than this many times its own width, a range stands by itself: with 0 more than
// half of the axis would be empty.
static const double AXIS_FAR = 1.0;

void axis_fit(double *low, double *high)
{
    if (!(*low <= *high)) {
        *low = 0.0;
        *high = 0.0;
    }
    const double nearest = *low > 0.0 ? *low : *high < 0.0 ? -*high : 0.0;
    const bool has_zero = nearest <= AXIS_FAR * (*high - *low);
    const bool is_size = has_zero && *low >= 0.0;
    *low = has_zero ? fmin(*low, 0.0) : *low;
    *high = has_zero ? fmax(*high, 0.0) : *high;
    axis_round(low, high);
    // what is never below 0 needs no room there
    *low = is_size ? 0.0 : *low;
}

// The nearest of 1, 2 and 5 times a power of ten below, or with `up` above.
static double round_to_125(double value, bool up)
{
    static const double LEADS[] = {0.5, 1.0, 2.0, 5.0, 10.0};
    const double power = pow(10.0, floor(log10(value)));
    for (int i = 0; i < 5; i++) {
        const int k = up ? i : 4 - i;
        if (up ? LEADS[k] * power >= value : LEADS[k] * power <= value) {
            return LEADS[k] * power;
        }
    }
    return value;
}

void axis_round_log(double *low, double *high)
{
    *low = round_to_125(*low / 1.3, false);
    *high = round_to_125(*high * 1.2, true);
    if (floor(log10(*high) + 1e-9) - ceil(log10(*low) - 1e-9) < 1.0) {
        *low = pow(10.0, floor(log10(*low) + 1e-9));
        *high = pow(10.0, ceil(log10(*high) - 1e-9));
    }
}

// The ticks of a logarithmic side of an axis: powers of ten, thinned out where they are many.
static size_t decade_ticks(double low, double high, double sign, double *ticks)
{
    const int first = (int)ceil(log10(low) - 1e-9);
    const int last = (int)floor(log10(high) + 1e-9);
    const int stride = 1 + (last - first) / AXIS_DECADE_LABELS;
    size_t count = 0;
    for (int power = first; power <= last && count < AXIS_TICK_MAX / 2; power += stride) {
        ticks[count++] = sign * pow(10.0, power);
    }
    return count;
}

// The values of at most AXIS_TICK_MAX ticks; their count.
static size_t axis_ticks(const Axis *axis, double *ticks)
{
    size_t count = 0;
    if (axis->scale == AXIS_LOG) {
        return decade_ticks(axis->low, axis->high, 1.0, ticks);
    }
    if (axis->scale == AXIS_SYMLOG) {
        count = axis->low < -axis->threshold
                    ? decade_ticks(axis->threshold, -axis->low, -1.0, ticks)
                    : 0;
        ticks[count++] = 0.0;
        if (axis->high > axis->threshold) {
            count += decade_ticks(axis->threshold, axis->high, 1.0, ticks + count);
        }
        return count;
    }
    const double wanted = axis->tick;
    const double tick =
        wanted > 0.0 ? wanted : axis_step(axis->high - axis->low, AXIS_TICKS_WANTED);
    const double first = ceil(axis->low / tick - 1e-9);
    const double last = floor(axis->high / tick + 1e-9);
    for (double i = first; i <= last && count < AXIS_TICK_MAX; i += 1.0) {
        ticks[count++] = i == 0.0 ? 0.0 : i * tick;
    }
    return count;
}

static const double TICK_LENGTH = 5.0; // pixels, as everything about the look of the picture
static const double COLUMN = 0.5;      // what is nearer than this cannot be distinguished

static const double LEAST_STROKE = 0.1; // a shorter one is a point
static const double MARK_SIZE = 7.0;

static const char STYLE_SHEET[] =
    "text{font-family:'DejaVu Sans','Liberation Sans',Arial,sans-serif;font-size:12px;"
    "fill:#222}"
    ".title{font-size:17px;font-weight:bold}.panel{font-size:14px;font-weight:bold}"
    ".note{fill:#555}.grid{stroke:#e4e4e4}.zero{stroke:#b0b0b0}.frame{stroke:#444;fill:none}"
    ".line{fill:none;stroke-linejoin:round}"
    ".halo{fill:#555;paint-order:stroke;stroke:#fff;stroke-width:3px}";

enum { PALETTE_SIZE = 10, LINE_KINDS = 3 };

// Okabe and Ito's palette, distinguishable for the colour-blind too (its yellow is too pale for
// lines), and behind it four darker colours for what more there is
static const char *const PALETTE[PALETTE_SIZE] = {"#0072b2", "#d55e00", "#009e73", "#cc79a7",
                                                  "#56b4e9", "#e69f00", "#5e3c99", "#8c510a",
                                                  "#b2182b", "#4d6b1e"};

PlotStyle plot_style(size_t kind, size_t colour)
{
    static const PlotStyle KINDS[LINE_KINDS] = {
        {NULL, 5.0, 0.32, NULL}, {NULL, 1.3, 1.0, NULL}, {NULL, 1.3, 1.0, "5 3"}};
    PlotStyle style = KINDS[kind % LINE_KINDS];
    style.colour = PALETTE[colour % PALETTE_SIZE];
    return style;
}

PlotStyle plot_style_dark(size_t colour)
{
    static const char *const DARK[PALETTE_SIZE] = {"#003350", "#602a00", "#004734", "#5c364b",
                                                   "#275169", "#684800", "#2a1b45", "#3f2405",
                                                   "#500b13", "#23300e"};
    return (PlotStyle){DARK[colour % PALETTE_SIZE], 0.9, 1.0, NULL};
}

void plot_begin(Text *svg, double width, double height, const char *title)
{
    text_append(svg,
                "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"%g\" height=\"%g\" "
                "viewBox=\"0 0 %g %g\">\n<title>",
                width, height, width, height);
    xml_append(title, svg);
    text_append(svg, "</title>\n<style>%s</style>\n", STYLE_SHEET);
    text_append(svg, "<rect width=\"100%%\" height=\"100%%\" fill=\"#fff\"/>\n");
}

void plot_end(Text *svg)
{
    text_append(svg, "</svg>\n");
}

void plot_text(Text *svg, double x, double y, const char *anchor, const char *css_class,
               const char *text)
{
    text_append(svg, "<text x=\"%.1f\" y=\"%.1f\" text-anchor=\"%s\" class=\"%s\">", x, y, anchor,
                css_class);
    xml_append(text, svg);
    text_append(svg, "</text>\n");
}

static void append_stroke(Text *svg, PlotStyle style)
{
    text_append(svg, "stroke=\"%s\" stroke-width=\"%g\" stroke-opacity=\"%g\"", style.colour,
                style.width, style.opacity);
    if (style.dash != NULL) {
        text_append(svg, " stroke-dasharray=\"%s\"", style.dash);
    }
}

void plot_sample(Text *svg, double x, double y, PlotStyle style)
{
    text_append(svg, "<path class=\"line\" d=\"M%.1f %.1fh30\" ", x, y);
    append_stroke(svg, style);
    text_append(svg, "/>\n");
}

double plot_x(const PlotPanel *panel, double x)
{
    return panel->left + panel->width * axis_share(&panel->x, x);
}

double plot_y(const PlotPanel *panel, double y)
{
    return panel->top + panel->height * (1.0 - axis_share(&panel->y, y));
}

static const double AXIS_PLAIN_MOST = 1e5; // longer numbers would run into the axis' title

// Of a linear axis of very small or large numbers the power of ten that all of its labels have;
// else 0.
static int power_of(const Axis *axis)
{
    const double largest = fmax(fabs(axis->low), fabs(axis->high));
    const bool is_plain =
        axis->scale != AXIS_LINEAR || (largest >= 1e-3 && largest < AXIS_PLAIN_MOST);
    return is_plain || !(largest > 0.0) ? 0 : (int)floor(log10(largest));
}

// An axis of many decades is labelled in powers of ten, any other in plain numbers.
static void append_tick_label(Text *svg, double value, const Axis *axis)
{
    const bool has_powers = axis->scale == AXIS_SYMLOG ||
                            (axis->scale == AXIS_LOG && (axis->low < 0.009 || axis->high > 2e4));
    if (has_powers && value != 0.0) {
        text_append(svg, "%s10<tspan dy=\"-5\" font-size=\"9\">%.0f</tspan>",
                    value < 0.0 ? "-" : "", round(log10(fabs(value))));
    } else if (power_of(axis) != 0 && value != 0.0) {
        text_append(svg, "%.6ge%d", value / pow(10.0, power_of(axis)), power_of(axis));
    } else {
        text_append(svg, fabs(value) < 1e6 ? "%.6g" : "%.3g", value);
    }
}

static void draw_x_axis(const PlotPanel *panel)
{
    Text *svg = panel->svg;
    double ticks[AXIS_TICK_MAX];
    const size_t count = axis_ticks(&panel->x, ticks);
    const double bottom = panel->top + panel->height;
    for (size_t i = 0; i < count; i++) {
        const double x = plot_x(panel, ticks[i]);
        text_append(svg, "<path class=\"%s\" d=\"M%.1f %.1fV%.1f\"/>",
                    ticks[i] == 0.0 && panel->x.low < 0.0 ? "zero" : "grid", x, panel->top, bottom);
        text_append(svg, "<path class=\"frame\" d=\"M%.1f %.1fv%g\"/>", x, bottom, TICK_LENGTH);
        text_append(svg, "<text x=\"%.1f\" y=\"%.1f\" text-anchor=\"middle\">", x,
                    bottom + TICK_LENGTH + 13.0);
        append_tick_label(svg, ticks[i], &panel->x);
        text_append(svg, "</text>\n");
    }
}

static void draw_y_axis(const PlotPanel *panel)
{
    Text *svg = panel->svg;
    double ticks[AXIS_TICK_MAX];
    const size_t count = axis_ticks(&panel->y, ticks);
    for (size_t i = 0; i < count; i++) {
        const double y = plot_y(panel, ticks[i]);
        text_append(svg, "<path class=\"%s\" d=\"M%.1f %.1fh%.1f\"/>",
                    ticks[i] == 0.0 ? "zero" : "grid", panel->left, y, panel->width);
        text_append(svg, "<path class=\"frame\" d=\"M%.1f %.1fh%g\"/>", panel->left, y,
                    -TICK_LENGTH);
        text_append(svg, "<text x=\"%.1f\" y=\"%.1f\" text-anchor=\"end\">",
                    panel->left - TICK_LENGTH - 3.0, y + 4.0);
        append_tick_label(svg, ticks[i], &panel->y);
        text_append(svg, "</text>\n");
    }
}

static void draw_titles(const PlotPanel *panel)
{
    Text *svg = panel->svg;
    const double bottom = panel->top + panel->height;
    const double x = panel->left - 58.0;
    const double y = panel->top + 0.5 * panel->height;
    plot_text(svg, panel->left + 0.5 * panel->width, bottom + 37.0, "middle", "", panel->x.title);
    if (panel->y.title != NULL) {
        text_append(svg, "<g transform=\"rotate(-90 %.1f %.1f)\">", x, y);
        plot_text(svg, x, y, "middle", "", panel->y.title);
        text_append(svg, "</g>\n");
    }
    plot_text(svg, panel->left, panel->top - 10.0, "start", "panel", panel->title);
}

// Where the fine lines of an axis stand; nothing of an axis that is not logarithmic.
static void append_fine_lines(const PlotPanel *panel, const Axis *axis, bool is_x)
{
    if (axis->scale != AXIS_LOG) {
        return;
    }
    for (double power = pow(10.0, floor(log10(axis->low))); power < axis->high; power *= 10.0) {
        for (int i = 2; i < 10; i++) {
            const double value = i * power;
            if (value > axis->low && value < axis->high && is_x) {
                text_append(panel->svg, "M%.1f %.1fv%.1f", plot_x(panel, value), panel->top,
                            panel->height);
            } else if (value > axis->low && value < axis->high) {
                text_append(panel->svg, "M%.1f %.1fh%.1f", panel->left, plot_y(panel, value),
                            panel->width);
            }
        }
    }
}

void plot_fine_grid(const PlotPanel *panel)
{
    text_append(panel->svg, "<path stroke=\"#f2f2f2\" fill=\"none\" d=\"");
    append_fine_lines(panel, &panel->x, true);
    append_fine_lines(panel, &panel->y, false);
    text_append(panel->svg, "\"/>\n");
}

void plot_enter(const PlotPanel *panel)
{
    draw_x_axis(panel);
    draw_y_axis(panel);
    plot_enter_bare(panel);
}

void plot_enter_bare(const PlotPanel *panel)
{
    Text *svg = panel->svg;
    draw_titles(panel);
    // a picture in the picture cuts off what is beyond it, and needs no name that a page with many
    // pictures would have twice
    text_append(svg, "<svg x=\"%g\" y=\"%g\" width=\"%g\" height=\"%g\" viewBox=\"%g %g %g %g\">\n",
                panel->left, panel->top, panel->width, panel->height, panel->left, panel->top,
                panel->width, panel->height);
}

void plot_leave(const PlotPanel *panel)
{
    text_append(panel->svg,
                "</svg>\n<rect class=\"frame\" x=\"%g\" y=\"%g\" width=\"%g\" height=\"%g\"/>\n",
                panel->left, panel->top, panel->width, panel->height);
}

// Points that fall into one column of the picture, drawn together: a line through the first, the
// lowest, the highest and the last of them looks the same as one through all.
typedef struct Pile {
    double column;
    size_t count;
    double low;
    double high;
    double last;
} Pile;

static void append_pile(Text *svg, const Pile *pile)
{
    if (pile->count > 2 && pile->high - pile->low > COLUMN) {
        text_append(svg, "V%.1fV%.1f", pile->low, pile->high);
    }
    if (pile->count > 1) {
        text_append(svg, "V%.1f", pile->last);
    }
}

void plot_line(const PlotPanel *panel, size_t count, const double *x, const double *y,
               PlotStyle style)
{
    Text *svg = panel->svg;
    text_append(svg, "<path class=\"line\" d=\"");
    Pile pile = {0};
    for (size_t i = 0; i < count; i++) {
        const double at_x = plot_x(panel, x[i]);
        const double at_y = plot_y(panel, y[i]);
        if (pile.count > 0 && floor(at_x / COLUMN) == pile.column) {
            pile.count++;
            pile.low = fmin(pile.low, at_y);
            pile.high = fmax(pile.high, at_y);
            pile.last = at_y;
            continue;
        }
        append_pile(svg, &pile);
        text_append(svg, "%c%.1f %.1f", i == 0 ? 'M' : 'L', at_x, at_y);
        pile = (Pile){floor(at_x / COLUMN), 1, at_y, at_y, at_y};
    }
    append_pile(svg, &pile);
    text_append(svg, "\" ");
    append_stroke(svg, style);
    text_append(svg, "/>\n");
}

static void append_title(Text *svg, const char *title)
{
    text_append(svg, "><title>");
    xml_append(title, svg);
    text_append(svg, "</title></path>\n");
}

// One column of a band, from the end that is nearer to where the line is.
static double append_column(Text *svg, bool is_first, double x, double low, double high, double at)
{
    const double near = fabs(at - low) <= fabs(at - high) ? low : high;
    const double far = near == low ? high : low;
    text_append(svg, "%c%.1f %.1f", is_first ? 'M' : 'L', x, near);
    if (fabs(far - near) >= LEAST_STROKE) {
        text_append(svg, "V%.1f", far);
        return far;
    }
    return near;
}

void plot_band(const PlotPanel *panel, size_t count, const double *x, const double *least,
               const double *most, const char *title, PlotStyle style)
{
    Text *svg = panel->svg;
    text_append(svg, "<path class=\"line\" d=\"");
    double at = 0.0;
    bool is_first = true;
    for (size_t i = 0; i < count;) {
        const double at_x = plot_x(panel, x[i]);
        const double column = floor(at_x / COLUMN);
        double low = plot_y(panel, least[i]);
        double high = plot_y(panel, most[i]);
        for (i++; i < count && floor(plot_x(panel, x[i]) / COLUMN) == column; i++) {
            low = fmax(low, plot_y(panel, least[i]));
            high = fmin(high, plot_y(panel, most[i]));
        }
        at = append_column(svg, is_first, at_x, low, high, is_first ? low : at);
        is_first = false;
    }
    text_append(svg, "\" ");
    append_stroke(svg, style);
    append_title(svg, title);
}

void plot_below(const PlotPanel *panel, double top, const char *colour)
{
    text_append(panel->svg,
                "<rect x=\"%.1f\" y=\"%.1f\" width=\"%.1f\" height=\"%.1f\" fill=\"%s\" "
                "fill-opacity=\"0.18\"/>\n",
                panel->left, top, panel->width, panel->top + panel->height - top, colour);
}

void plot_spot(Text *svg, double x, double y, double radius, const char *colour, const char *rim,
               double rim_width)
{
    text_append(svg,
                "<circle cx=\"%.1f\" cy=\"%.1f\" r=\"%.1f\" fill=\"%s\" stroke=\"%s\" "
                "stroke-width=\"%g\"/>\n",
                x, y, radius, colour, rim, rim_width);
}

void plot_dot(const PlotPanel *panel, double x, double y, PlotStyle style)
{
    text_append(panel->svg, "<circle cx=\"%.2f\" cy=\"%.2f\" r=\"2.5\" fill=\"%s\"/>\n",
                plot_x(panel, x), plot_y(panel, y), style.colour);
}

static void append_triangle(Text *svg, double x, double y, double height, PlotStyle style)
{
    text_append(svg,
                "<path class=\"mark\" d=\"M%.1f %.1fl%.1f %.1fh%.1fz\" fill=\"#fff\" "
                "stroke=\"%s\"",
                x, y, -0.5 * MARK_SIZE, -height, MARK_SIZE, style.colour);
}

void plot_mark(const PlotPanel *panel, double x, double y, bool is_below, const char *title,
               PlotStyle style)
{
    append_triangle(panel->svg, plot_x(panel, x), plot_y(panel, y),
                    is_below ? -MARK_SIZE : MARK_SIZE, style);
    append_title(panel->svg, title);
}

void plot_mark_sample(Text *svg, double x, double y, PlotStyle style)
{
    append_triangle(svg, x, y, MARK_SIZE, style);
    text_append(svg, "/>\n");
}

void plot_shade(const PlotPanel *panel, double from, double to)
{
    text_append(panel->svg,
                "<rect class=\"shade\" x=\"%.1f\" y=\"%.1f\" width=\"%.1f\" "
                "height=\"%.1f\" fill=\"#888\" fill-opacity=\"0.18\"/>\n",
                plot_x(panel, from), panel->top, plot_x(panel, to) - plot_x(panel, from),
                panel->height);
}

void plot_circle(const PlotPanel *panel, double radius, PlotStyle style)
{
    Text *svg = panel->svg;
    text_append(svg, "<ellipse class=\"line\" cx=\"%.2f\" cy=\"%.2f\" rx=\"%.2f\" ry=\"%.2f\" ",
                plot_x(panel, 0.0), plot_y(panel, 0.0), plot_x(panel, radius) - plot_x(panel, 0.0),
                plot_y(panel, 0.0) - plot_y(panel, radius));
    append_stroke(svg, style);
    text_append(svg, "/>\n");
}
