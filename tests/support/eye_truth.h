// The contact of a pin in the hole of an eye, solved by other means than contact/eye.c: a truth for
// it.
//
// What rings and pins do under a harmonic of pressure comes from integrating the equations of
// equilibrium over the radius; the contact from panels of constant pressure, of which those that
// would pull are left out until none does. Plane strain, all in the units of contact/eye.h.
#pragma once

#include "contact/eye.h"

#include <stddef.h>

// The force f at an approach, with panels up to an angle, rad, that is above that of the contact
// and so many of them; *touching becomes the angle up to which they press.
double eye_truth_force(const Eye *eye, double approach, double widest, size_t panels,
                       double *touching);

// How far a pressure cos(n t) moves a hole's wall out and a pin's surface in, over 1 / E* of that
// body alone.
double eye_truth_ring(size_t n, double poisson_ratio, double outer);
double eye_truth_pin(size_t n, double poisson_ratio);
