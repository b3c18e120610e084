// Mechanisms with something that slides, built from the model's data alone.
#pragma once

#include "model/trajectory.h"

// Bodies 0 crank, 1 rod, 2 slider; joints in the order of the enumeration, all ideal. The slider
// goes along the ground's x axis through the crank's pivot, its centre of mass is the rod's pin.
typedef struct SliderSizes {
    double crank; // m
    double rod;
    double masses[3];   // kg
    double inertias[3]; // kg m^2, of crank and rod about their middles, where their centres are
} SliderSizes;

enum { SLIDER_CRANK, SLIDER_PIN, SLIDER_WRIST, SLIDER_GUIDE };

// Flores, Leine and Glocker 2010: the benchmark of a slider with play in its guides.
extern const SliderSizes SLIDER_FLORES;

// The field's usual slider-crank with play in the pin of the slider, at 5000 rpm.
extern const SliderSizes SLIDER_USUAL;

// Without a drive: crank and rod level, the speeds those of the mechanism at a crank's, rad/s.
Scenario slider_crank(const SliderSizes *sizes, double crank_omega);

// With the crank driven, from level.
Scenario slider_driven(const SliderSizes *sizes, double speed);

// Gives the guides of the slider play: a block of a length and a height, m, in an opening.
void slider_loosen_guide(Scenario *scenario, double opening, double height, double length);

// The benchmark of Flores, Leine and Glocker with its guides and restitution, its impacts those of
// a linear spring of a stiffness, N/m, with exact damping.
Scenario slider_flores_loose(double stiffness);

// Gives the pin of rod and slider a radial play, m, in a hole of a radius, m.
void slider_loosen_wrist(Scenario *scenario, double hole_radius, double play);

// A driven crank of 0.1 m about (0.25, 0) whose pin carries a block that slides on a lever about
// the origin; bodies crank, lever, block; joints crank, lever, pin, slide. The crank starts level.
Scenario slider_lever(double speed);

// The largest force and moment, N and N m, that is missing in the equations of motion of a body
// that no drive moves: m a = F + m g, I al = M, with the joints' forces as the sample has them.
double slider_unbalanced(const Scenario *scenario, const Motion *motions, const JointState *states);
