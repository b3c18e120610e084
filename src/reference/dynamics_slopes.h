// How the contacts' forces change the accelerations with the coordinates and their rates.
#pragma once

#include "reference/dynamics.h"

// Writes the derivatives of the accelerations at a state by the coordinates, 1/s^2, and by their
// rates, 1/s, as matrices of its coupling; only those that the forces of pressing contacts cause,
// with the geometry frozen. What is left out changes as slowly as the mechanism itself moves. NaN
// where the accelerations are not determined. The context is a Dynamics.
void dynamics_slopes(double since_s, const double *y, double *by_position, double *by_rate,
                     void *context);
