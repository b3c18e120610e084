// The contacts within the step: the world is asked for accelerations, and moves nothing itself.
#include "drivers/bullet/bullet_world.hpp"

extern "C" {
#include "drivers/common/trial.h"
}

#include <cstdio>

// Puts a body where a trial has it; the driven one stands about its pivot.
void World::place(size_t i, const DriverMotion &motion)
{
    btRigidBody &made = *bodies[i];
    if (driver_drive_of(of, static_cast<int>(i)) != nullptr) {
        place_driven(i, motion.angle);
        return;
    }
    made.setWorldTransform(to_transform(motion.position, motion.angle));
    made.setInterpolationWorldTransform(made.getWorldTransform());
    made.setLinearVelocity(to_vector(motion.velocity));
    made.setAngularVelocity(btVector3(0.0, 0.0, motion.omega));
}

// The contacts within the step: the world is asked for accelerations, and moves nothing itself.
void World::accelerate(const double *q, const double *v, const DriverAction *given, double *a)
{
    trial_place(&tree, q, v, given, tried.data(), actions.data());
    for (size_t i = 0; i < bodies.size(); i++) {
        place(i, tried[i]);
    }
    act(actions.data());
    world.stepSimulation(trial_s, 0);
    for (size_t i = 0; i < bodies.size(); i++) {
        now[i] = tried[i];
        if (driver_drive_of(of, static_cast<int>(i)) == nullptr) {
            const btVector3 &velocity = bodies[i]->getLinearVelocity();
            now[i].velocity = Vec2{velocity.x(), velocity.y()};
            now[i].omega = bodies[i]->getAngularVelocity().z();
        }
    }
    trial_read(&tree, tried.data(), now.data(), trial_s, a);
}

void World::run_trials()
{
    trial_s = trial_step(of);
    tried.resize(bodies.size());
    std::snprintf(answer.settings, sizeof answer.settings,
                  "btMLCPSolver with btDantzigSolver, ERP 1, CFM 0, driven body kinematic, bodies "
                  "kept in the plane, trials of %.3g s",
                  trial_s);
    const TrialEngine engine = {
        [](void *own, const double *q, const double *v, const DriverAction *given, double *a) {
            static_cast<World *>(own)->accelerate(q, v, given, a);
        },
        nullptr, this};
    trial_run(&tree, &engine, &answer);
}
