// Makes Bullet's world of a case, and reads and places its bodies.
#include "drivers/bullet/bullet_world.hpp"
#include "drivers/bullet/bullet_native.hpp"

extern "C" {
#include "drivers/common/trial.h"
}

// (m/s)/(N s): a billionth of what a kilogram gives way
static const double PLANE_CFM = 1e-9;

World::World(const DriverCase *given)
    : of(given), tree(tree_make(given)), is_staggered(driver_is_way(given, "staggered")),
      is_native(driver_is_way(given, "native")), joints(given->joint_count),
      centres(given->body_count), contacts(places_start(given)), now(given->body_count),
      before(given->body_count), forces(given->joint_count), actions(given->body_count),
      answer(driver_run_start(given))
{
    world.setGravity(to_vector(of->gravity));
    // joints that have opened are closed within the next step
    world.getSolverInfo().m_erp = 1.0;
    world.getSolverInfo().m_globalCfm = 0.0;
    world.setInternalTickCallback(
        [](btDynamicsWorld *own, btScalar) {
            World *self = static_cast<World *>(own->getWorldUserInfo());
            self->turn_driven();
            self->find_contacts();
        },
        this, true);
    for (size_t i = 0; i < of->body_count; i++) {
        add_body(i);
    }
    for (size_t i = 0; i < of->joint_count; i++) {
        add_joint(i);
    }
    read(now);
    before = now;
    if (is_native) {
        make_native();
    }
}

World::~World()
{
    for (const auto &constraint : constraints) {
        world.removeConstraint(constraint.get());
    }
    for (const auto &made : bodies) {
        world.removeRigidBody(made.get());
    }
}

void World::add_body(size_t i)
{
    const DriverBody &given = of->bodies[i];
    const DriverDrive *drive = driver_drive_of(of, static_cast<int>(i));
    const bool is_driven = drive != nullptr;
    Vec2 place = given.start.position;
    if (is_driven) {
        Vec2 on_body;
        place = driver_drive_pivot(of, drive, &on_body);
        centres[i] = vec2_scale(-1.0, on_body);
    }
    // a kinematic body whose inertia is not 0 would be turned by its joints
    const double inertia = is_driven ? 0.0 : given.inertia;
    btRigidBody::btRigidBodyConstructionInfo info(is_driven ? 0.0 : given.mass, nullptr, &shape,
                                                  btVector3(inertia, inertia, inertia));
    info.m_startWorldTransform = to_transform(place, given.start.angle);
    bodies.push_back(std::make_unique<btRigidBody>(info));
    btRigidBody &made = *bodies.back();
    made.setActivationState(DISABLE_DEACTIVATION);
    if (is_driven) {
        made.setCollisionFlags(made.getCollisionFlags() | btCollisionObject::CF_KINEMATIC_OBJECT);
    } else {
        made.setLinearFactor(btVector3(1.0, 1.0, 0.0));
        made.setAngularFactor(btVector3(0.0, 0.0, 1.0));
        made.setLinearVelocity(to_vector(given.start.velocity));
        made.setAngularVelocity(btVector3(0.0, 0.0, given.start.omega));
    }
    world.addRigidBody(&made, 0, 0);
    now[i].angle = given.start.angle;
}

// A joint's frame in a body, turned against the body's.
btTransform World::anchor(const DriverJoint &joint, int side, double turn) const
{
    const int number = joint.bodies[side];
    const Vec2 centre = number == DRIVER_GROUND ? Vec2{0.0, 0.0} : centres[number];
    return to_transform(vec2_add(joint.anchors[side], centre), turn);
}

void World::add_joint(size_t i)
{
    const DriverJoint &joint = of->joints[i];
    if (!driver_is_ideal(&joint) || driver_drive_at_joint(of, i) != nullptr ||
        trial_holds(&tree, i)) {
        return;
    }
    btRigidBody &a = body(joint.bodies[0]);
    btRigidBody &b = body(joint.bodies[1]);
    if (joint.kind == DRIVER_PRISMATIC) {
        const int numbers[2] = {joint.bodies[0], joint.bodies[1]};
        double angles[2];
        for (int side = 0; side < 2; side++) {
            angles[side] =
                numbers[side] == DRIVER_GROUND ? 0.0 : of->bodies[numbers[side]].start.angle;
        }
        auto slider = std::make_unique<btSliderConstraint>(
            a, b, anchor(joint, 0, joint.direction),
            anchor(joint, 1, joint.direction + angles[0] - angles[1]), true);
        slider->setLowerLinLimit(1.0); // above the upper: free
        slider->setUpperLinLimit(-1.0);
        slider->setLowerAngLimit(0.0);
        slider->setUpperAngLimit(0.0);
        constraints.push_back(std::move(slider));
    } else {
        constraints.push_back(std::make_unique<btPoint2PointConstraint>(
            a, b, anchor(joint, 0, 0.0).getOrigin(), anchor(joint, 1, 0.0).getOrigin()));
        constraints.back()->setParam(BT_CONSTRAINT_ERP, 1.0);
        // across the plane nothing moves, and its rows would be singular without it
        constraints.back()->setParam(BT_CONSTRAINT_CFM, PLANE_CFM);
    }
    joints[i] = constraints.back().get();
    world.addConstraint(joints[i], true);
}

// The motions of all bodies; angles go on from those that they had.
void World::read(std::vector<DriverMotion> &motions)
{
    for (size_t i = 0; i < bodies.size(); i++) {
        const btRigidBody &from = *bodies[i];
        const btQuaternion turn = from.getWorldTransform().getRotation();
        const btVector3 &place = from.getWorldTransform().getOrigin();
        const double angle = 2.0 * std::atan2(turn.z(), turn.w());
        DriverMotion &motion = motions[i];
        motion.angle = now[i].angle + std::remainder(angle - now[i].angle, 2.0 * M_PI);
        motion.omega = from.getAngularVelocity().z();
        motion.position = Vec2{place.x(), place.y()};
        motion.velocity = Vec2{from.getLinearVelocity().x(), from.getLinearVelocity().y()};
        const DriverDrive *drive = driver_drive_of(of, static_cast<int>(i));
        if (drive != nullptr) {
            motion.angle = drive_angle(&drive->law, now_s);
            motion.omega = drive_at(&drive->law, now_s).omega;
            const Vec2 arm = vec2_rotate(motion.angle, centres[i]);
            motion.position = vec2_add(motion.position, arm);
            motion.velocity = vec2_scale(motion.omega, vec2_perp(arm));
        }
    }
}

void World::place_driven(size_t i, double angle)
{
    btRigidBody &driven = *bodies[i];
    const btVector3 &place = driven.getWorldTransform().getOrigin();
    driven.setWorldTransform(to_transform(Vec2{place.x(), place.y()}, angle));
}

// Bullet finds the speed of a kinematic body from an arc cosine near 1, which is off by 1e-16 over
// the square of the turn of a step.
void World::turn_driven()
{
    for (size_t i = 0; i < bodies.size(); i++) {
        const DriverDrive *drive = driver_drive_of(of, static_cast<int>(i));
        if (drive != nullptr) {
            const double mean = driver_drive_mean(drive, now_s, now_s + of->step_s);
            bodies[i]->setAngularVelocity(btVector3(0.0, 0.0, mean));
        }
    }
}

// Puts driven bodies where they are at the present time.
void World::place_all_driven()
{
    for (size_t i = 0; i < bodies.size(); i++) {
        const DriverDrive *drive = driver_drive_of(of, static_cast<int>(i));
        if (drive != nullptr) {
            place_driven(i, drive_angle(&drive->law, now_s));
        }
    }
}
