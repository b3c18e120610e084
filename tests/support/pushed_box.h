// A box that rests on a floor, held by one contact of ODE's with friction, and is pushed along it
// by a force from a time on: by ODE alone.
#pragma once

// How far it is off after .1 s, m, in steps of dWorldStep whose positions are moved by the mean of
// the speeds before and after. The box weighs 1 kg, friction is .1 and the force 5 N; a step in
// which it sets in gets its mean. With ODE ready.
double pushed_box_error(double step, double onset);
