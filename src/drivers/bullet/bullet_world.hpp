// Bullet's world of a case, and the ways to step it: what the files of its driver share.
#pragma once

#include <cmath> // before what is in C
extern "C" {
#include "drivers/common/native.h"
}

#include <BulletDynamics/MLCPSolvers/btDantzigSolver.h>
#include <BulletDynamics/MLCPSolvers/btMLCPSolver.h>
#include <btBulletDynamicsCommon.h>
#include <memory>
#include <vector>

static_assert(sizeof(btScalar) == sizeof(double), "Bullet in double precision is what is wanted");

// An end of a coordinate, and a pair of shapes.
struct Limit;
struct Face;

class World
{
  public:
    explicit World(const DriverCase *of);
    ~World();
    void run();
    void run_trials();
    void accelerate(const double *q, const double *v, const DriverAction *given, double *a);

    void add_body(size_t i);
    void add_joint(size_t i);
    btTransform anchor(const DriverJoint &joint, int side, double turn) const;
    btRigidBody &body(int number)
    {
        return number == DRIVER_GROUND ? ground : *bodies[number];
    }
    void read(std::vector<DriverMotion> &motions);
    // A driven body at a time; and the mean speeds of driven bodies in the step to come.
    void place_driven(size_t i, double angle);
    void place_all_driven();
    void turn_driven();
    void place(size_t i, const DriverMotion &motion);
    void push();
    void act(const DriverAction *given);
    void stamp(double velocity_s);
    void set_driven(double time_s, DriverMotion *motions) const;
    void tell_settings();
    void start_staggered();

    const DriverCase *of;
    Tree tree;
    bool is_staggered;
    bool is_native;
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
    std::vector<btTypedConstraint *> joints; // by joint; NULL where it is none of Bullet's
    std::vector<Vec2> centres;               // of each body's frame, where the centre of mass is
    DriverContact *contacts;                 // by place
    std::vector<DriverMotion> now;
    std::vector<DriverMotion> before; // velocities of the step before
    std::vector<Vec2> forces;
    std::vector<DriverAction> actions; // by body
    double now_s = 0.0;
    double lag_s = 0.0; // of velocities behind positions
    DriverRun answer;
    // of `native`: what touches (bullet_native.cpp)
    Native native{};
    std::vector<std::unique_ptr<Limit>> limits;
    std::vector<std::unique_ptr<Face>> faces;
    std::vector<double> pushes; // by place: of the last step
    void make_native();
    void limit_slider(const NativeRow &row, btSliderConstraint &slider);
    void limit_pivot(const NativeRow &row);
    void couple(const NativeRow &row);
    void find_contacts();
    void read_native();
    // of trials
    double trial_s = 0.0;
    std::vector<DriverMotion> tried;
};

inline btVector3 to_vector(Vec2 a)
{
    return btVector3(a.x, a.y, 0.0);
}

inline btTransform to_transform(Vec2 place, double angle)
{
    return btTransform(btQuaternion(btVector3(0.0, 0.0, 1.0), angle), to_vector(place));
}
