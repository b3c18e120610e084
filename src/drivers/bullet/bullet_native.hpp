// What Bullet has for what touches.
#pragma once

#include "drivers/bullet/bullet_world.hpp"

// A row of `native`, and the constraint that is it.
struct Limit {
    size_t row;
    btTypedConstraint *constraint; // NULL of teeth, whose forces are not known
    btJointFeedback feedback;
};

// The shapes of a face, on the bodies of its place, and the points at which they touch.
struct Face {
    size_t face;
    std::unique_ptr<btCollisionShape> on_a;
    std::unique_ptr<btCollisionShape> on_b;
    btTransform at_a; // in the frames of the bodies
    btTransform at_b;
    btPersistentManifold *points;
    btCollisionAlgorithm *algorithm;
};
