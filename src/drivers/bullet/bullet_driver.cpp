// Runs a case in Bullet, in double precision, in the ways that its users have.
//
//     native     what touches is constraints and shapes of Bullet's own (bullet_native.cpp)
//     force      the contact's law is a force on the bodies, set before each step
//     staggered  the same, with the velocities read as what they are in that order
//     kernel     the contacts integrated within the step, by trial steps (drivers/common/trial.c)
//
// A step of Bullet changes the velocities by the forces and constraints at x(n), then moves the
// bodies, x(n+1) = x(n) + h v: so v is the mean velocity of [n, n+1]. Read as that at n + 1/2, and
// started half a step before, the steps are a leapfrog. The driven body is kinematic, about its
// pivot.
#include "drivers/bullet/bullet_native.hpp"
#include "drivers/bullet/bullet_world.hpp"

#include <algorithm>
#include <cstdio>

// Follows the contacts, and lets their laws, springs and loads act in the step to come.
void World::push()
{
    std::vector<DriverMotion> felt(now);
    const double share = lag_s / of->step_s;
    for (size_t i = 0; i < felt.size(); i++) {
        felt[i].velocity = vec2_add(
            felt[i].velocity, vec2_scale(share, vec2_sub(now[i].velocity, before[i].velocity)));
        felt[i].omega += share * (now[i].omega - before[i].omega);
        if (driver_drive_of(of, static_cast<int>(i)) != nullptr) {
            felt[i] = now[i];
        }
    }
    before = now;
    const double from_s = now_s - lag_s;
    actions_find(of, felt.data(), from_s, from_s + of->step_s, actions.data());
    if (!is_native) {
        places_follow(of, felt.data(), contacts, answer.totals);
        places_press(of, contacts, felt.data(), actions.data(), forces.data(), &answer, of->step_s);
    }
    act(actions.data());
}

// Lets forces and moments act on the bodies in the step to come.
void World::act(const DriverAction *given)
{
    for (size_t i = 0; i < bodies.size(); i++) {
        if (driver_drive_of(of, static_cast<int>(i)) == nullptr) {
            bodies[i]->applyCentralForce(to_vector(given[i].force));
            bodies[i]->applyTorque(btVector3(0.0, 0.0, given[i].moment));
        }
    }
}

// The velocities of driven bodies are known at any time.
void World::set_driven(double time_s, DriverMotion *motions) const
{
    for (size_t i = 0; i < of->body_count; i++) {
        const DriverDrive *drive = driver_drive_of(of, static_cast<int>(i));
        if (drive != nullptr) {
            const DriveState at = drive_at(&drive->law, time_s);
            motions[i].omega = at.omega;
            motions[i].velocity =
                vec2_scale(at.omega, vec2_perp(vec2_rotate(at.angle, centres[i])));
        }
    }
}

void World::stamp(double velocity_s)
{
    DriverStamp *made = driver_run_stamp(&answer);
    made->position_s = now_s;
    made->velocity_s = velocity_s;
    std::copy(now.begin(), now.end(), made->motions);
    std::copy(forces.begin(), forces.end(), made->forces);
    set_driven(velocity_s, made->motions);
    driver_run_stamped(&answer);
}

// Sets the velocities half a step back, by the accelerations of a first step that is undone.
void World::start_staggered()
{
    const std::vector<DriverMotion> start(now);
    place_all_driven();
    world.stepSimulation(of->step_s, 0);
    lag_s = 0.5 * of->step_s;
    for (size_t i = 0; i < bodies.size(); i++) {
        btRigidBody &made = *bodies[i];
        const Vec2 gained = vec2_sub(Vec2{made.getLinearVelocity().x(), //
                                          made.getLinearVelocity().y()},
                                     start[i].velocity);
        const double turned = made.getAngularVelocity().z() - start[i].omega;
        if (driver_drive_of(of, static_cast<int>(i)) != nullptr) {
            continue;
        }
        made.setWorldTransform(to_transform(start[i].position, start[i].angle));
        made.setInterpolationWorldTransform(made.getWorldTransform());
        made.setLinearVelocity(to_vector(vec2_sub(start[i].velocity, vec2_scale(0.5, gained))));
        made.setAngularVelocity(btVector3(0.0, 0.0, start[i].omega - 0.5 * turned));
    }
    for (size_t i = 0; i < of->place_count; i++) {
        contacts[i].state = of->places[i].contact;
        answer.totals[of->places[i].joint] = DriverTotals{};
    }
    now = start;
    read(now);
    // accelerations that are to be expected are those of the start
    for (size_t i = 0; i < before.size(); i++) {
        before[i] = now[i];
        before[i].velocity = vec2_sub(
            now[i].velocity, vec2_scale(2.0, vec2_sub(start[i].velocity, now[i].velocity)));
        before[i].omega = now[i].omega - 2.0 * (start[i].omega - now[i].omega);
    }
}

void World::tell_settings()
{
    std::snprintf(answer.settings, sizeof answer.settings,
                  "btMLCPSolver with btDantzigSolver, ERP 1, CFM 0, driven body kinematic, bodies "
                  "kept in the plane");
    if (is_native) {
        native_tell(&answer, ", of limits and overlaps ERP .2");
    }
    if (native.has_rigid_teeth) {
        native_tell(&answer, ", gears by btGearConstraint, without play");
    }
}

void World::run()
{
    tell_settings();
    answer.is_linear = is_native;
    driver_run_begin(&answer);
    push();
    stamp(0.0);
    if (is_staggered) {
        start_staggered();
        push();
    }
    while (!driver_run_is_full(&answer)) {
        place_all_driven();
        world.stepSimulation(of->step_s, 0);
        now_s = of->step_s * static_cast<double>(++answer.steps);
        read(now);
        if (is_native) {
            read_native();
        }
        push();
        // joints that have not opened yet have the directions of a step's start, and not its mean
        if (!is_staggered || answer.steps > 1) {
            stamp(now_s - lag_s);
        }
    }
    driver_run_write(&answer);
}

int main()
{
    static const char *const WAYS[] = {"native", "force", "staggered", "kernel", nullptr};
    static const char *const NATIVE[] = {"limits", "stops", "guides", "gears", "drives",
                                         "servos", "waves", "drags",  nullptr};
    char version[32];
    std::snprintf(version, sizeof version, "%d.%02d", btGetVersion() / 100, btGetVersion() % 100);
    const DriverIdentity identity = {"Bullet", version, "double", WAYS, NATIVE};
    int status;
    const DriverCase *of = driver_read(&identity, &status);
    if (of == nullptr) {
        return status;
    }
    World world(of);
    if (driver_is_way(of, "kernel")) {
        world.run_trials();
    }
    world.run();
    return 0;
}
