// Loads on the bodies that do not come of springs: a force at a point of a body, a torque on it, or
// what acts along the coordinate of a joint, such as a gas force on a piston.
#pragma once

#include "model/forces.h"

// Whether a load is a force, N; else it is a torque, N m.
bool load_is_force(const Linkage *linkage, const Load *load);

// Whether the value of a load is known from the time alone: it is constant, over time, or over the
// angle of a crank that turns at a constant speed.
bool load_is_timed(const Linkage *linkage, const Load *load);

// Whether it is one that jumps from point to point.
bool load_jumps(const Linkage *linkage, const Load *load);

// The value of a load, N or N m, at a time: over time and a steady crank's angle that of the piece
// which holds from a time on that is no later, so that it is smooth in between.
double load_value(const Linkage *linkage, const Load *load, const Motion *motions, double time_s,
                  double from_s);

// Its mean from one time to another; where it is not known from these that about the motions given,
// which are of a time in between: over what they pass in that time at their speeds.
double load_mean(const Linkage *linkage, const Load *load, const Motion *motions, double from_s,
                 double to_s);

// Adds the load of so many N or N m to those of the bodies.
void load_add(const Linkage *linkage, const Load *load, double value, const Motion *motions,
              BodyLoad *loads);

// How fast what it pushes goes along it, m/s or rad/s: its power is the value times this.
double load_rate(const Linkage *linkage, const Load *load, const Motion *motions);

// Adds all loads at a time, and their power then, W; see load_value.
void loads_add(const Linkage *linkage, const Motion *motions, double time_s, double from_s,
               BodyLoad *loads);
double loads_power(const Linkage *linkage, const Motion *motions, double time_s, double from_s);

// Writes the loads of all that acts at a time: springs, dampers, a torque and these.
void loads_of_all(const Linkage *linkage, const Motion *motions, double time_s, double from_s,
                  BodyLoad *loads);

// What loads of so much each, by load, do from one motion of the bodies to another, J.
double loads_work(const Linkage *linkage, const double *values, const Motion *from,
                  const Motion *middle, const Motion *to);

// The first time after one at which a load bends or jumps, s, as far as that is known from the time
// alone; INFINITY where none does.
double loads_next_bend(const Linkage *linkage, double time_s);

// Likewise of those that jump alone.
double loads_next_jump(const Linkage *linkage, double time_s);

// The shortest period of a load that is a sinusoid, s; INFINITY where none is.
double loads_shortest_wave(const Linkage *linkage);
