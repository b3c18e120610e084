// Random joints with play to hold the verdicts of a mapping against: what is predicted, what the
// engine delivers, and the same joint at another mass, length and time.
#pragma once

#include "measure/mapping.h"

typedef struct RandomJoint {
    MappingContact contact;
    double step_s;
} RandomJoint;

// Draws a joint: 1e-6 to 1e3 kg, 1e-4 to 10 m/s, 0.6 to 150 steps to the contact's length, on
// both sides of every map's limit of stability. By its number it has a linear spring with a viscous
// damper, a Hertzian contact with a hysteretic one, another exponent, or a cylinder in a hole. Some
// pins are so small beside the depth that coarse steps take them past the end of the law.
RandomJoint random_joint_draw(unsigned short state[3], int number);

// The same joint with every mass, length and time so many times what it was; the floor of the
// impact speed goes along.
RandomJoint random_joint_scaled(const RandomJoint *joint, double mass, double length, double time);

// The verdict of the prediction.
VerdictKind random_joint_predict(const RandomJoint *joint, OdeMap map, ImpactFigures *predicted);

// The verdict of what the engine delivers; VERDICT_COUNT, with its words, where it says nothing of
// one impact.
VerdictKind random_joint_deliver(const RandomJoint *joint, OdeMap map,
                                 const ImpactFigures *predicted, ImpactDelivered *delivered);

// The largest difference of restitution, peak force and depth, relative, means over the phases.
double random_joint_difference(const ImpactFigures *a, const ImpactFigures *b);
