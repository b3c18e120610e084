// How accelerations in space change with coordinates and rates, for the implicit integrator.
#pragma once

#include "reference/space_dynamics.h"

// Derivatives of the coordinates' second rates by the coordinates and by their rates, as matrices
// of the coupling: of the forces where pins press, with the geometry frozen. NaN where they are not
// determined. The context is a SpaceDynamics.
void space_slopes(double since_s, const double *y, double *by_position, double *by_rate,
                  void *context);
