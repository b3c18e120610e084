// How lines of speed against error look, in the picture of compare and in the report of its
// results.
#pragma once

#include "model/options.h"
#include "write/plot.h"

// Of a way of another engine, by its number among the engine's ways: the engine has a colour, which
// does not depend on what else is compared, its last way a thick line.
PlotStyle compare_style_of_engine(const char *engine, size_t way, size_t way_count);

// Of a scheme of ODE, SOLVER/STEPPING or with play SOLVER/STEPPING/MAP: with play the map has the
// colour, else the stepping, which is then all there is; the quick solver is dashed.
PlotStyle compare_style_of_ode(const char *scheme, OdeSolver solver, OdeStepping stepping,
                               OdeMap map);

// The same by the name alone; of a name that is none of a scheme that of what chooses its own
// steps.
PlotStyle compare_style_of_scheme(const char *scheme);

// Of what chooses its own steps.
PlotStyle compare_style_of_others(void);
