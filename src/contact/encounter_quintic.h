// One row between two nodes of an encounter: Hermite's quintic for the integral of its impulse,
// whose derivatives are impulse and force (contact/encounter_nodes.c).
#pragma once

#include <stdbool.h>

// of the step of the world: nodes nearer to each other have a force that is linear between them
static const double ENCOUNTER_NARROW = 1e-7;

// A row at a node.
typedef struct EncounterNodeRow {
    double impulse;
    double moment;
    double force;
    double second; // the moment's integral, where it is asked for
} EncounterNodeRow;

// The row at a share `s` of the width, s, between two nodes.
static inline EncounterNodeRow encounter_quintic(EncounterNodeRow first, EncounterNodeRow last,
                                                 double width, double s, bool is_short)
{
    const double p0 = width * first.impulse;
    const double p1 = width * last.impulse;
    const double f0 = width * width * first.force;
    const double f1 = width * width * last.force;
    const double rise = last.moment - first.moment - p0 - 0.5 * f0;
    const double slope = p1 - p0 - f0;
    const double bend = f1 - f0;
    const double a = 10.0 * rise - 4.0 * slope + 0.5 * bend;
    const double b = -15.0 * rise + 7.0 * slope - bend;
    const double c = 6.0 * rise - 3.0 * slope + 0.5 * bend;
    const double impulse = p0 + s * (f0 + s * (3.0 * a + s * (4.0 * b + s * 5.0 * c)));
    const double force = f0 + s * (6.0 * a + s * (12.0 * b + s * 20.0 * c));
    return (EncounterNodeRow){
        .impulse = width > 0.0 ? impulse / width : first.impulse,
        .moment = first.moment + s * (p0 + s * (0.5 * f0 + s * (a + s * (b + s * c)))),
        .second =
            first.second +
            width * s *
                (first.moment +
                 s * (p0 / 2.0 + s * (f0 / 6.0 + s * (a / 4.0 + s * (b / 5.0 + s * c / 6.0))))),
        .force = is_short || width == 0.0 ? first.force + s * (last.force - first.force)
                                          : force / (width * width),
    };
}
