// A slider-crank whose slider a spring and a damper hold back, with play in the wrist: the pin
// never leaves its wall, and the motion settles slowly, each revolution to the other side of what
// it comes to.
#pragma once

#include "load_case.h"

enum { SPRUNG_SLIDER_PLAY = 2 }; // the joint with play

static inline Scenario sprung_slider(const char *const *overrides, size_t count)
{
    static const char TEXT[] =
        "bodies:\n"
        "  crank:  {mass: 0.3 kg, inertia: 100 kg mm^2, at: [20 mm, 0 mm]}\n"
        "  rod:    {mass: 0.4 kg, inertia: 800 kg mm^2, at: [100 mm, 0 mm]}\n"
        "  slider: {mass: 0.5 kg, inertia: 100 kg mm^2, at: [160 mm, 0 mm]}\n"
        "joints:\n"
        "  pivot: {between: [ground, crank], at: [0 mm, 0 mm]}\n"
        "  pin:   {between: [crank, rod], at: [40 mm, 0 mm]}\n"
        "  wrist: {between: [rod, slider], at: [160 mm, 0 mm], radial-clearance: 20 um, pin: 10 "
        "mm}\n"
        "  guide: {between: [ground, slider], at: [160 mm, 0 mm], along: 0 deg}\n"
        "springs:\n"
        "  gas: {between: [ground, slider], at-a: [300 mm, 0 mm], at-b: [160 mm, 0 mm],\n"
        "        stiffness: 20 kN/m, length: 100 mm, damping: 10 N s/m}\n"
        "drive: {joint: pivot, speed: 1500 rpm}\n"
        "run: {revolutions: 1, samples: 360}\n";
    Scenario scenario;
    Err err = {0};
    if (!casefile_load_text("sprung-slider.yaml", TEXT, sizeof TEXT - 1, overrides, count,
                            &scenario, &err)) {
        fail_msg("%s", err.text);
    }
    return kept_instead(&scenario);
}
