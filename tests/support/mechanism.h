// Mechanisms that the tests share, built from the model's data alone, without a case file.
#pragma once

#include "model/scenario.h"

// The defaults with ODE as its manual has it, at a given step: plain stepping, the textbook's map,
// 1 us, on analytic and ode. Tests of one solver say what differs from here.
Scenario mechanism_default(void);

// The paper's crank-rocker at 1000 rpm, counter-clockwise, crank at 0 deg: nominal lengths with
// the tolerances of its Table IV, defaults else. All joints ideal.
Scenario mechanism_paper(void);

// Gives the joint of that name the paper's play: hole 10.015 mm, pin 9.986 mm, width 13 mm.
void mechanism_loosen(Scenario *scenario, const char *joint);

// The paper's crank-rocker with its play in so many joints, the crank's first, and the stiffness of
// the field's benchmarks, 6.6e10 N/m^1.5. A fifth of a turn: it holds the hardest impacts and the
// largest errors, and is not chaotic yet.
Scenario mechanism_loose(size_t joints);

// One body, a pin of radius 5 mm in a hole of the ground about the origin, with a radial clearance,
// m, no gravity, no driver. The body starts concentric and at rest; its mass in kg.
Scenario mechanism_pin(double mass, double radial_clearance);

// A parallelogram with three parallel cranks, one of which is redundant; upright, driven.
Scenario mechanism_parallelogram(void);

// A slider-crank: crank 50 mm, rod 120 mm, 5000 rpm, every joint ideal; with the slider's line and
// side as given, m and rad.
Scenario mechanism_slidercrank(double offset, double line, SliderSide side);

// Links of a length, m, and a mass, kg, in a row along x from the origin, level and at rest, each
// pinned to the one before it and the first to the ground: link-0 by pin-0 and so on. All joints
// ideal, about z. To be freed by linkage_free.
Linkage mechanism_chain(size_t count, double length, double mass);
