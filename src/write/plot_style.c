// Which kind of line, and which colour?
#include "write/plot.h"

enum { PALETTE_SIZE = 6, LINE_KINDS = 3 };

// Okabe and Ito's palette, distinguishable for the colour-blind too (its yellow is too pale for
// lines)
static const char *const PALETTE[PALETTE_SIZE] = {"#0072b2", "#d55e00", "#009e73",
                                                  "#cc79a7", "#56b4e9", "#e69f00"};

PlotStyle plot_style(size_t kind, size_t colour)
{
    static const PlotStyle KINDS[LINE_KINDS] = {
        {NULL, 5.0, 0.32, NULL}, {NULL, 1.3, 1.0, NULL}, {NULL, 1.3, 1.0, "5 3"}};
    PlotStyle style = KINDS[kind % LINE_KINDS];
    style.colour = PALETTE[colour % PALETTE_SIZE];
    return style;
}
