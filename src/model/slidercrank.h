// The dimensions of a slider-crank as a case file's short form gives them, and what they make
// possible.
//
// The crank turns about the origin; the rod joins its end to the slider, whose centre stays on a
// straight line of the ground. Along the line's direction t and its normal n (t turned by a quarter
// turn counter-clockwise) the slider stands at x t + offset n.
#pragma once

#include <stdbool.h>

typedef enum SliderSide {
    SLIDER_RIGHT, // the slider lies ahead of the crank pin, along the line's direction
    SLIDER_LEFT,  // behind it
} SliderSide;

typedef struct SliderCrank {
    double crank;  // m
    double rod;    // m
    double offset; // m, of the line from the crank's pivot, along its normal
    double line;   // rad, angle of the line's direction
    SliderSide side;
} SliderCrank;

// How far across the line the rod reaches from crank pin to slider, m. The loop closes at a crank
// angle where this is no longer than the rod; where they are equal it is at a dead centre.
double slidercrank_rise(const SliderCrank *mechanism, double crank_angle);

// Whether the crank can turn through every angle: crank and offset together shorter than the rod.
bool slidercrank_turns(const SliderCrank *mechanism);

// How far the crank turns from an angle in a direction, 1 or -1, until the rise equals a reach, m,
// as the rod has it and play may make it longer: up to 2 pi, or infinite where it never does.
double slidercrank_travel(const SliderCrank *mechanism, double reach, double start,
                          double direction);
