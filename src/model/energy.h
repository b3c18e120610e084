// The mechanical energy of the bodies of a linkage.
#pragma once

#include "model/linkage.h"

// Kinetic energy of all bodies, J.
double energy_kinetic(const Linkage *linkage, const Motion *motions);

// Potential energy of all bodies in gravity along -y, m/s^2, J, zero at the ground frame's origin.
double energy_potential(const Linkage *linkage, const Motion *motions, double gravity);
