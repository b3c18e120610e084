// The closed-form motion of a slider-crank with ideal joints.
#pragma once

#include "analytic/curve.h"
#include "model/linkage.h"
#include "model/slidercrank.h"

// The motion of the three bodies crank, rod, slider at one crank angle, for a crank turning at
// constant speed, rad/s: centres of mass at mid-link, that of the slider at its pin. Returns false,
// motions untouched, where the loop does not close there or is at a dead centre.
bool slidercrank_motion_bodies(const SliderCrank *mechanism, double speed, double crank_angle,
                               Motion motions[3]);

// What can be extreme over a turn.
typedef enum SliderCrankQuantity {
    SLIDERCRANK_ROD_OMEGA,
    SLIDERCRANK_ROD_ALPHA,
    SLIDERCRANK_POSITION,     // m, of the slider along its line
    SLIDERCRANK_VELOCITY,     // m/s, likewise
    SLIDERCRANK_ACCELERATION, // m/s^2
    SLIDERCRANK_TRANSMISSION, // rad, the acute angle between rod and the line's normal
    SLIDERCRANK_QUANTITY_COUNT,
} SliderCrankQuantity;

double slidercrank_motion_quantity(const SliderCrank *mechanism, double speed,
                                   SliderCrankQuantity quantity, double crank_angle);

// The extremes of one quantity for crank angles from first to last: curve_extreme.
CurveExtreme slidercrank_motion_extreme(const SliderCrank *mechanism, double speed,
                                        SliderCrankQuantity quantity, double first_angle,
                                        double last_angle);
