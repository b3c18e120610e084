// What touches, by Bullet's own means.
//
//     limits of a pivot     a 6-dof joint that has no rows but that of the angle at an end
//     limits of a slider    those of the slider constraint
//     teeth                 a gear constraint, which has no play: it holds the ratio of speeds
//     a stop, a guide       spheres, and static planes whose side is the line
//     a pin in its hole     none: limits of joints are those of a box
//
// Pairs of shapes are asked one by one, by Bullet's own algorithms, so that others do not touch.
// Bullet looks ahead by a share of a shape's size: a pair comes to a stop where it touches, and
// nothing bounces.
#include "drivers/bullet/bullet_native.hpp"

#include <BulletCollision/CollisionDispatch/btSimulationIslandManager.h>
#include <algorithm>
#include <cmath>

static const NativeMeans MEANS = {.engine = "Bullet",
                                  .has_holes = false,
                                  .has_faces = true,
                                  .teeth = NATIVE_RIGID_TEETH,
                                  .couples_any = false};

// Share of an overlap that is removed in a step. A lever that a torque presses against its stop,
// after an impact at 12.8 rad/s, comes back with 0.7 rad/s for 0.1, 1.5 for 0.2, 3.9 for 0.5 and 8
// for 1, which is that of joints; 0.2 is Bullet's own for contacts.
static const double OVERLAP_ERP = 0.2;

// rad, beyond which Bullet's angles begin again
static const double TURN_MOST = 3.1;

void World::limit_slider(const NativeRow &row, btSliderConstraint &slider)
{
    const DriverPlace &place = of->places[row.places[0]];
    const DriverJoint &joint = of->joints[place.joint];
    const double sign = std::cos(place.direction - joint.direction) > 0.0 ? 1.0 : -1.0;
    const Vec2 apart = vec2_sub(driver_point(now.data(), joint.bodies[1], joint.anchors[1]),
                                driver_point(now.data(), joint.bodies[0], joint.anchors[0]));
    const double turned = joint.bodies[0] == DRIVER_GROUND ? 0.0 : now[joint.bodies[0]].angle;
    const double at = vec2_dot(apart, vec2_rotate(turned + joint.direction, Vec2{1.0, 0.0}));
    slider.setLowerLinLimit(at + (sign > 0.0 ? row.low : -row.high));
    slider.setUpperLinLimit(at + (sign > 0.0 ? row.high : -row.low));
    slider.setParam(BT_CONSTRAINT_STOP_ERP, OVERLAP_ERP, 0);
}

void World::limit_pivot(const NativeRow &row)
{
    const DriverPlace &place = of->places[row.places[0]];
    const DriverJoint &joint = of->joints[place.joint];
    const bool is_along = native_turn_sign(&native, &row) > 0.0;
    const double low = is_along ? row.low : -row.high;
    const double high = is_along ? row.high : -row.low;
    if (low < -TURN_MOST || high > TURN_MOST) {
        driver_refuse("limits of '%s' more than half a turn from its start, for Bullet's angles "
                      "begin again there",
                      joint.name);
    }
    double angles[2];
    for (int side = 0; side < 2; side++) {
        const int number = joint.bodies[side];
        angles[side] = number == DRIVER_GROUND ? 0.0 : of->bodies[number].start.angle;
    }
    auto made = std::make_unique<btGeneric6DofConstraint>(
        body(joint.bodies[0]), body(joint.bodies[1]), anchor(joint, 0, 0.0),
        anchor(joint, 1, angles[0] - angles[1]), true);
    made->setLinearLowerLimit(btVector3(1.0, 1.0, 1.0)); // above the upper: free
    made->setLinearUpperLimit(btVector3(-1.0, -1.0, -1.0));
    // Bullet counts this angle the other way round
    made->setAngularLowerLimit(btVector3(1.0, 1.0, -high));
    made->setAngularUpperLimit(btVector3(-1.0, -1.0, -low));
    made->setParam(BT_CONSTRAINT_STOP_ERP, OVERLAP_ERP, 5);
    constraints.push_back(std::move(made));
    world.addConstraint(constraints.back().get(), true);
}

void World::couple(const NativeRow &row)
{
    const DriverPlace &place = of->places[row.places[0]];
    const double ratio = row.shares[tree.bodies[place.bodies[1]].first] /
                         row.shares[tree.bodies[place.bodies[0]].first];
    const btVector3 axis(0.0, 0.0, 1.0);
    constraints.push_back(std::make_unique<btGearConstraint>(
        body(place.bodies[0]), body(place.bodies[1]), axis, axis, ratio));
    world.addConstraint(constraints.back().get(), true);
}

// The shapes of a face and Bullet's algorithm for them.
static std::unique_ptr<Face> make_face(const NativeFace &face, const DriverPlace &place, size_t i)
{
    auto made = std::make_unique<Face>();
    made->face = i;
    made->on_b = std::make_unique<btSphereShape>(face.radius);
    if (face.is_line) {
        const Vec2 normal = vec2_rotate(place.direction, Vec2{1.0, 0.0});
        made->on_a = std::make_unique<btStaticPlaneShape>(to_vector(normal), face.distance);
    } else {
        made->on_a = std::make_unique<btSphereShape>(face.distance);
    }
    return made;
}

void World::make_native()
{
    native = native_make(&tree, &MEANS);
    pushes.resize(of->place_count);
    world.getSolverInfo().m_erp2 = OVERLAP_ERP;
    for (size_t i = 0; i < native.row_count; i++) {
        const NativeRow &row = native.rows[i];
        const DriverPlace &place = of->places[row.places[0]];
        limits.push_back(std::make_unique<Limit>(Limit{i, nullptr, {}}));
        Limit &limit = *limits.back();
        if (row.has_teeth) {
            couple(row);
            continue;
        }
        if (place.shape == DRIVER_TURN) {
            limit_pivot(row);
            limit.constraint = constraints.back().get();
        } else {
            limit.constraint = joints[place.joint];
            limit_slider(row, *static_cast<btSliderConstraint *>(limit.constraint));
        }
        limit.constraint->setJointFeedback(&limit.feedback);
    }
    for (size_t i = 0; i < native.face_count; i++) {
        const NativeFace &face = native.faces[i];
        const DriverPlace &place = of->places[face.place];
        faces.push_back(make_face(face, place, i));
        Face &made = *faces.back();
        btTransform *const at[2] = {&made.at_a, &made.at_b};
        for (int side = 0; side < 2; side++) {
            const int number = place.bodies[side];
            const Vec2 centre = number == DRIVER_GROUND ? Vec2{0.0, 0.0} : centres[number];
            *at[side] = to_transform(vec2_add(place.anchors[side], centre), 0.0);
        }
        made.points = dispatcher.getNewManifold(&body(place.bodies[1]), &body(place.bodies[0]));
        made.algorithm = nullptr;
    }
    if (!faces.empty()) {
        world.getSimulationIslandManager()->setSplitIslands(false);
    }
}

// Finds where shapes touch at the start of a step.
void World::find_contacts()
{
    for (const auto &face : faces) {
        const NativeFace &given = native.faces[face->face];
        const DriverPlace &place = of->places[given.place];
        btRigidBody &a = body(place.bodies[0]);
        btRigidBody &b = body(place.bodies[1]);
        // which the wrappers refer to
        const btTransform at_a = a.getWorldTransform() * face->at_a;
        const btTransform at_b = b.getWorldTransform() * face->at_b;
        const btCollisionObjectWrapper on_a(nullptr, face->on_a.get(), &a, at_a, -1, -1);
        const btCollisionObjectWrapper on_b(nullptr, face->on_b.get(), &b, at_b, -1, -1);
        if (face->algorithm == nullptr) {
            face->algorithm =
                dispatcher.findAlgorithm(&on_b, &on_a, face->points, BT_CONTACT_POINT_ALGORITHMS);
        }
        // Bullet's is the product of both bodies'
        a.setFriction(std::sqrt(given.friction));
        b.setFriction(std::sqrt(given.friction));
        face->points->clearManifold();
        btManifoldResult result(&on_b, &on_a);
        face->algorithm->processCollision(&on_b, &on_a, world.getDispatchInfo(), &result);
        for (int i = 0; i < face->points->getNumContacts(); i++) {
            face->points->getContactPoint(i).m_combinedRestitution = 0.0;
        }
    }
}

void World::read_native()
{
    std::fill(pushes.begin(), pushes.end(), 0.0);
    for (const auto &limit : limits) {
        if (limit->constraint == nullptr) {
            continue; // which flank a gear constraint stands for cannot be known
        }
        const NativeRow &row = native.rows[limit->row];
        const DriverPlace &place = of->places[row.places[0]];
        const double turned = place.bodies[0] == DRIVER_GROUND ? 0.0 : now[place.bodies[0]].angle;
        const Vec2 along = vec2_rotate(turned + place.direction, Vec2{1.0, 0.0});
        const double push = place.shape == DRIVER_TURN
                                ? limit->feedback.m_appliedTorqueBodyB.z()
                                : to_vector(along).dot(limit->feedback.m_appliedForceBodyB);
        pushes[native_pushing(&native, &row, now.data())] = std::fabs(push);
    }
    for (const auto &face : faces) {
        double impulse = 0.0;
        for (int i = 0; i < face->points->getNumContacts(); i++) {
            impulse += face->points->getContactPoint(i).getAppliedImpulse();
        }
        pushes[native.faces[face->face].place] = impulse / of->step_s;
    }
    native_follow(&native, now.data(), pushes.data(), contacts, &answer, forces.data());
}
