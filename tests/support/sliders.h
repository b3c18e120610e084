// Mechanisms with prismatic joints whose motion has a closed form, written out here by itself.
#pragma once

#include "model/scenario.h"

enum { SLIDERS_BODY_MAX = 3 };

typedef struct Sliders {
    Scenario scenario;
    // the motion of all bodies at a time
    void (*motion)(const Scenario *scenario, double time_s, Motion *motions);
} Sliders;

// A slider-crank at 5000 rpm: crank 50 mm, rod 120 mm, gravity across the guide. Its guide is seen
// from the slider's corner, beside its centre, so that the joint has a couple. Bodies: crank, rod,
// slider; joints: ground-crank, crank-rod, rod-slider, slider-ground, whose body a is the ground,
// or else the slider.
Sliders sliders_crank(bool guide_is_ground);

// Force on the slider in its joint with the ground, N, along the ground's y axis, and couple about
// the anchor on the joint's body b, N m, at a time.
void sliders_crank_guide(const Scenario *scenario, double time_s, double *force, double *couple);

// A scotch yoke: a driven crank, a block on its pin, and a yoke that slides on the ground and holds
// the block in its slot. Two prismatic joints in one loop with the driven body.
Sliders sliders_yoke(void);

// A quick-return mechanism: a driven crank, a block on its pin, and a rocker on which the block
// slides.
Sliders sliders_quick_return(void);

// A bead on a driven arm, pushed outwards as it turns: r = r0 cosh(w t). No gravity.
Sliders sliders_bead(void);

// Elliptic trammel: a rod between two equal sliders on crossing lines, without drive or gravity. It
// turns steadily: the sum of the sliders' energies is the same at every angle.
Sliders sliders_trammel(void);
