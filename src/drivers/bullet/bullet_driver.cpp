// Runs a case in Bullet, in double precision, in the ways that its users have.
//
//     force      the contact's law is a force on the bodies, set before each step
//     staggered  the same, with the velocities read as what they are in that order
//     kernel     the contacts integrated within the step, by trial steps (drivers/common/trial.c)
//
// A step of Bullet changes the velocities by the forces and constraints at x(n), then moves the
// bodies, x(n+1) = x(n) + h v: so v is the mean velocity of [n, n+1]. Read as that at n + 1/2, and
// started half a step before, the steps are a leapfrog. The driven body is kinematic, about its
// pivot. Bullet has no joint that is limited to a circle: those of its 6-dof joints are a box.
#include <cmath> // before what is in C
extern "C" {
#include "drivers/common/trial.h"
}

#include <BulletDynamics/MLCPSolvers/btDantzigSolver.h>
#include <BulletDynamics/MLCPSolvers/btMLCPSolver.h>
#include <algorithm>
#include <btBulletDynamicsCommon.h>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <memory>
#include <vector>

static_assert(sizeof(btScalar) == sizeof(double), "Bullet in double precision is what is wanted");

namespace
{

// (m/s)/(N s): a billionth of what a kilogram gives way
const double PLANE_CFM = 1e-9;

class World
{
  public:
    explicit World(const DriverCase *of);
    ~World();
    void run();
    void run_trials();
    void accelerate(const double *q, const double *v, const DriverAction *given, double *a);

  private:
    void add_body(size_t i);
    void add_joint(size_t i);
    btTransform anchor(const DriverJoint &joint, int side, double turn) const;
    btRigidBody &body(int number)
    {
        return number == DRIVER_GROUND ? ground : *bodies[number];
    }
    void read(std::vector<DriverMotion> &motions);
    double driven_angle() const;
    void place_driven(double angle);
    void turn_driven();
    void place(size_t i, const DriverMotion &motion);
    void push();
    void act(const DriverAction *given);
    void stamp(double velocity_s);
    void start_staggered();

    const DriverCase *of;
    Tree tree;
    bool is_staggered;
    btDefaultCollisionConfiguration configuration;
    btCollisionDispatcher dispatcher{&configuration};
    btDbvtBroadphase broadphase;
    btDantzigSolver dantzig;
    btMLCPSolver solver{&dantzig};
    btDiscreteDynamicsWorld world{&dispatcher, &broadphase, &solver, &configuration};
    btSphereShape shape{0.01}; // nothing collides
    btRigidBody ground{btRigidBody::btRigidBodyConstructionInfo(0.0, nullptr, &shape)};
    std::vector<std::unique_ptr<btRigidBody>> bodies;
    std::vector<std::unique_ptr<btTypedConstraint>> constraints;
    std::vector<Vec2> centres; // of each body's frame, where the centre of mass is
    DriverContact *contacts;   // by place
    std::vector<DriverMotion> now;
    std::vector<DriverMotion> before; // velocities of the step before
    std::vector<Vec2> forces;
    std::vector<DriverAction> actions; // by body
    double now_s = 0.0;
    double lag_s = 0.0; // of velocities behind positions
    DriverRun answer;
    // of trials
    double trial_s = 0.0;
    std::vector<DriverMotion> tried;
};

btVector3 to_vector(Vec2 a)
{
    return btVector3(a.x, a.y, 0.0);
}

btTransform to_transform(Vec2 place, double angle)
{
    return btTransform(btQuaternion(btVector3(0.0, 0.0, 1.0), angle), to_vector(place));
}

World::World(const DriverCase *given)
    : of(given), tree(tree_make(given)), is_staggered(driver_is_way(given, "staggered")),
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
            static_cast<World *>(own->getWorldUserInfo())->turn_driven();
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
    const bool is_driven = of->has_drive && of->driven_body == static_cast<int>(i);
    Vec2 place = given.start.position;
    if (is_driven) {
        const DriverJoint &joint = of->joints[of->drive_joint];
        const int own = joint.bodies[1] == static_cast<int>(i) ? 1 : 0;
        if (joint.bodies[1 - own] != DRIVER_GROUND || joint.kind != DRIVER_REVOLUTE) {
            driver_refuse("a drive that does not turn a body about the ground");
        }
        place = joint.anchors[1 - own];
        centres[i] = vec2_scale(-1.0, joint.anchors[own]);
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
    if (!driver_is_ideal(&joint) || (of->has_drive && of->drive_joint == int(i)) ||
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
    world.addConstraint(constraints.back().get(), true);
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
        if (of->has_drive && of->driven_body == static_cast<int>(i)) {
            motion.angle = driven_angle();
            motion.omega = of->drive_speed;
            const Vec2 arm = vec2_rotate(motion.angle, centres[i]);
            motion.position = vec2_add(motion.position, arm);
            motion.velocity = vec2_scale(motion.omega, vec2_perp(arm));
        }
    }
}

// That of the driven body at the present time, rad.
double World::driven_angle() const
{
    return of->bodies[of->driven_body].start.angle + of->drive_speed * now_s;
}

void World::place_driven(double angle)
{
    btRigidBody &driven = *bodies[of->driven_body];
    const btVector3 &place = driven.getWorldTransform().getOrigin();
    driven.setWorldTransform(to_transform(Vec2{place.x(), place.y()}, angle));
}

// Bullet finds the speed of a kinematic body from an arc cosine near 1, which is off by 1e-16 over
// the square of the turn of a step.
void World::turn_driven()
{
    if (of->has_drive) {
        bodies[of->driven_body]->setAngularVelocity(btVector3(0.0, 0.0, of->drive_speed));
    }
}

// Follows the contacts, and lets their laws, springs and loads act in the step to come.
void World::push()
{
    std::vector<DriverMotion> felt(now);
    const double share = lag_s / of->step_s;
    for (size_t i = 0; i < felt.size(); i++) {
        felt[i].velocity = vec2_add(
            felt[i].velocity, vec2_scale(share, vec2_sub(now[i].velocity, before[i].velocity)));
        felt[i].omega += share * (now[i].omega - before[i].omega);
        if (of->has_drive && of->driven_body == static_cast<int>(i)) {
            felt[i] = now[i];
        }
    }
    before = now;
    const double from_s = now_s - lag_s;
    actions_find(of, felt.data(), from_s, from_s + of->step_s, actions.data());
    places_follow(of, felt.data(), contacts, answer.totals);
    places_press(of, contacts, felt.data(), actions.data(), forces.data(), &answer, of->step_s);
    act(actions.data());
}

// Lets forces and moments act on the bodies in the step to come.
void World::act(const DriverAction *given)
{
    for (size_t i = 0; i < bodies.size(); i++) {
        if (!of->has_drive || of->driven_body != static_cast<int>(i)) {
            bodies[i]->applyCentralForce(to_vector(given[i].force));
            bodies[i]->applyTorque(btVector3(0.0, 0.0, given[i].moment));
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
    if (of->has_drive) {
        // the driven body's velocity is known at any time
        DriverMotion &driven = made->motions[of->driven_body];
        const double angle = driven.angle + driven.omega * (velocity_s - now_s);
        driven.velocity =
            vec2_scale(driven.omega, vec2_perp(vec2_rotate(angle, centres[of->driven_body])));
    }
    driver_run_stamped(&answer);
}

// Sets the velocities half a step back, by the accelerations of a first step that is undone.
void World::start_staggered()
{
    const std::vector<DriverMotion> start(now);
    if (of->has_drive) {
        place_driven(driven_angle());
    }
    world.stepSimulation(of->step_s, 0);
    lag_s = 0.5 * of->step_s;
    for (size_t i = 0; i < bodies.size(); i++) {
        btRigidBody &made = *bodies[i];
        const Vec2 gained = vec2_sub(Vec2{made.getLinearVelocity().x(), //
                                          made.getLinearVelocity().y()},
                                     start[i].velocity);
        const double turned = made.getAngularVelocity().z() - start[i].omega;
        if (of->has_drive && of->driven_body == static_cast<int>(i)) {
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

// Puts a body where a trial has it; the driven one stands about its pivot.
void World::place(size_t i, const DriverMotion &motion)
{
    btRigidBody &made = *bodies[i];
    if (of->has_drive && of->driven_body == static_cast<int>(i)) {
        place_driven(motion.angle);
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
        if (!of->has_drive || of->driven_body != static_cast<int>(i)) {
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

void World::run()
{
    std::snprintf(answer.settings, sizeof answer.settings,
                  "btMLCPSolver with btDantzigSolver, ERP 1, CFM 0, driven body kinematic, bodies "
                  "kept in the plane");
    driver_run_begin(&answer);
    push();
    stamp(0.0);
    if (is_staggered) {
        start_staggered();
        push();
    }
    while (!driver_run_is_full(&answer)) {
        if (of->has_drive) {
            place_driven(driven_angle());
        }
        world.stepSimulation(of->step_s, 0);
        now_s = of->step_s * static_cast<double>(++answer.steps);
        read(now);
        push();
        // joints that have not opened yet have the directions of a step's start, and not its mean
        if (!is_staggered || answer.steps > 1) {
            stamp(now_s - lag_s);
        }
    }
    driver_run_write(&answer);
}

} // namespace

int main()
{
    static const char *const WAYS[] = {"force", "staggered", "kernel", nullptr};
    char version[32];
    std::snprintf(version, sizeof version, "%d.%02d", btGetVersion() / 100, btGetVersion() % 100);
    const DriverIdentity identity = {"Bullet", version, "double", WAYS};
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
