// Chooses colours and dashes of schemes and ways.
#include "commands/compare/compare_style.h"

#include <string.h>

static const char *engine_colour(const char *name)
{
    static const char *const COLOURS[][2] = {{"mujoco", "#d9541e"},
                                             {"chipmunk", "#8e44ad"},
                                             {"bullet", "#8a6d3b"},
                                             {"simbody", "#c2185b"}};
    for (size_t i = 0; i < sizeof COLOURS / sizeof *COLOURS; i++) {
        if (strcmp(COLOURS[i][0], name) == 0) {
            return COLOURS[i][1];
        }
    }
    return "#5b6b1f";
}

PlotStyle compare_style_of_engine(const char *engine, size_t way, size_t way_count)
{
    static const char *const DASHES[] = {"2 4", "8 4", "8 3 2 3"};
    const bool is_last = way + 1 == way_count;
    return (PlotStyle){.colour = engine_colour(engine),
                       .width = is_last ? 2.6 : 1.4,
                       .opacity = 1.0,
                       .dash = is_last ? NULL : DASHES[way % 3]};
}

PlotStyle compare_style_of_ode(const char *scheme, OdeSolver solver, OdeStepping stepping,
                               OdeMap map)
{
    const bool has_map = strchr(scheme, '/') != strrchr(scheme, '/');
    PlotStyle style = plot_style(1, has_map ? (size_t)map : (size_t)stepping);
    style.width = stepping == ODE_PLAIN ? 1.2 : 2.2;
    style.dash = solver == ODE_DIRECT ? NULL : "6 4";
    return style;
}

PlotStyle compare_style_of_others(void)
{
    PlotStyle style = plot_style(1, 0);
    style.colour = "#333333";
    return style;
}
