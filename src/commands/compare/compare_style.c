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

// The number of the word that a text has between two slashes, in a list that ends in NULL; -1 where
// it is none of them.
static int number_of(const char *text, size_t word, const char *const *list)
{
    for (; word > 0 && text != NULL; word--) {
        text = strchr(text, '/');
        text = text != NULL ? text + 1 : NULL;
    }
    const size_t length = text != NULL ? strcspn(text, "/") : 0;
    for (int i = 0; list[i] != NULL; i++) {
        if (length > 0 && strlen(list[i]) == length && strncmp(list[i], text, length) == 0) {
            return i;
        }
    }
    return -1;
}

PlotStyle compare_style_of_scheme(const char *scheme)
{
    const int solver = number_of(scheme, 0, OPTIONS_ODE_SOLVERS);
    const int stepping = number_of(scheme, 1, OPTIONS_ODE_STEPPINGS);
    const int map = number_of(scheme, 2, OPTIONS_ODE_MAPS);
    if (solver < 0 || stepping < 0) {
        return compare_style_of_others();
    }
    return compare_style_of_ode(scheme, (OdeSolver)solver, (OdeStepping)stepping,
                                map >= 0 ? (OdeMap)map : (OdeMap)0);
}

PlotStyle compare_style_of_others(void)
{
    PlotStyle style = plot_style(1, 0);
    style.colour = "#333333";
    return style;
}
