// Runs a case in Simbody, in the ways that its users have.
//
//     native     what touches is stops and couplers of Simbody's own (simbody_native.cpp)
//     force      the contact's law is a force; RungeKuttaMerson, of order 4, at the step h given
//     adaptive   the same with steps of its own, for an accuracy of .01 (h / 100 us)^2
//     kernel     the contacts integrated within the step, by trials (drivers/common/trial.c)
//
// Coordinates are those of the joints: the tree has no constraints, the drive is prescribed
// (Motion::Steady), and loops of ideal joints that are left over are points held in two planes.
#include "drivers/simbody/simbody_world.hpp"

#include <algorithm>
#include <cstdio>

namespace
{

// 1, for a step of 100 us; and the tightest that still ends
const double ACCURACY = 1e-2;
const double ACCURACY_LEAST = 1e-13;
const double ACCURACY_STEP = 1e-4; // s

// 1: errors that a step of a given length may have: the loosest that there is
const double ACCURACY_NONE = 0.999;

class Law : public Force::Custom::Implementation
{
  public:
    explicit Law(World *world) : world(world)
    {
    }
    void calcForce(const State &state, Vector_<SpatialVec> &on_bodies, Vector_<Vec3> &,
                   Vector &) const override
    {
        world->push(state, on_bodies);
    }
    Real calcPotentialEnergy(const State &) const override
    {
        return 0.0;
    }

  private:
    World *world;
};

// A drive that is prescribed, whatever its speed: at a kink a step has it as before it.
class Turning : public Motion::Custom::Implementation
{
  public:
    Turning(const DriverDrive *drive, double start, const double *piece_s)
        : drive(drive), start(start), piece_s(piece_s)
    {
    }
    Implementation *clone() const override
    {
        return new Turning(*this);
    }
    Motion::Level getLevel(const State &) const override
    {
        return Motion::Position;
    }
    void calcPrescribedPosition(const State &state, int, Real *q) const override
    {
        q[0] = drive_angle(&drive->law, state.getTime()) - start;
    }
    void calcPrescribedPositionDot(const State &state, int, Real *rate) const override
    {
        rate[0] = drive_since(&drive->law, *piece_s, state.getTime()).omega;
    }
    void calcPrescribedPositionDotDot(const State &state, int, Real *rate) const override
    {
        rate[0] = drive_since(&drive->law, *piece_s, state.getTime()).alpha;
    }

  private:
    const DriverDrive *drive;
    double start;
    const double *piece_s;
};

Vec3 to_vec(::Vec2 a)
{
    return Vec3(a.x, a.y, 0.0);
}

Transform to_transform(double angle, ::Vec2 place)
{
    return Transform(Rotation(angle, ZAxis), to_vec(place));
}

} // namespace

World::World(const DriverCase *given)
    : of(given), tree(tree_make(given)), bodies(given->body_count), contacts(places_start(given)),
      motions(given->body_count), actions(given->body_count), coordinates(tree.coordinates),
      rates(tree.coordinates), forces_now(given->joint_count), answer(driver_run_start(given)),
      is_native(driver_is_way(given, "native"))
{
    Force::UniformGravity(forces, matter, to_vec(of->gravity));
    Force::Custom(forces, new Law(this)); // which it owns
    for (size_t i = 0; i < of->body_count; i++) {
        add_body(tree.order[i]);
    }
    add_loops();
    tree_check_drives(&tree);
    for (size_t i = 0; i < of->body_count; i++) {
        add_drive(i);
    }
    if (is_native) {
        make_native();
    }
}

void World::add_drive(size_t i)
{
    const DriverDrive *drive = driver_drive_of(of, static_cast<int>(i));
    if (drive == nullptr) {
        return;
    }
    if (drive_is_steady(&drive->law)) {
        Motion::Steady(bodies[i], drive->law.speed);
    } else {
        Motion::Custom(bodies[i], new Turning(drive, of->bodies[i].start.angle, &piece_s));
    }
}

// The first time after one at which the acceleration of a drive jumps.
double World::next_kink(double time_s) const
{
    double next_s = Infinity;
    for (size_t i = 0; i < of->drive_count; i++) {
        next_s = std::min(next_s, drive_next_kink(&of->drives[i].law, time_s));
    }
    return next_s;
}

void World::add_body(size_t i)
{
    const DriverBody &given = of->bodies[i];
    const TreeBody &hung = tree.bodies[i];
    const Inertia inertia(given.inertia, given.inertia, given.inertia);
    const Body::Rigid rigid(MassProperties(given.mass, Vec3(0.0), inertia));
    MobilizedBody &parent = body(hung.parent);
    if (hung.kind == TREE_TURNS) {
        bodies[i] = MobilizedBody::Pin(parent, to_transform(hung.turn, hung.offset), rigid,
                                       to_transform(0.0, hung.anchor));
    } else if (hung.kind == TREE_SLIDES) {
        const double along = std::atan2(hung.axis.y, hung.axis.x);
        bodies[i] = MobilizedBody::Slider(parent, to_transform(hung.turn + along, hung.offset),
                                          rigid, to_transform(along, ::Vec2{0.0, 0.0}));
    } else {
        bodies[i] = MobilizedBody::Planar(parent, Transform(), rigid, Transform());
    }
}

void World::add_loops()
{
    for (size_t i = 0; i < of->joint_count; i++) {
        if (!tree.is_left[i] || trial_holds(&tree, i)) {
            continue;
        }
        const DriverJoint &joint = of->joints[i];
        const ::Vec2 at = joint.anchors[0];
        Constraint::PointInPlane(body(joint.bodies[0]), UnitVec3(XAxis), at.x,
                                 body(joint.bodies[1]), to_vec(joint.anchors[1]));
        Constraint::PointInPlane(body(joint.bodies[0]), UnitVec3(YAxis), at.y,
                                 body(joint.bodies[1]), to_vec(joint.anchors[1]));
    }
}

// The coordinates of the tree are 0 at the start, as Simbody's are but of free bodies.
void World::set_start(State &state)
{
    tree_start(&tree, rates.data());
    for (size_t i = 0; i < of->body_count; i++) {
        const double *rate = rates.data() + tree.bodies[i].first;
        if (tree.bodies[i].kind == TREE_FREE) {
            const DriverMotion &start = of->bodies[i].start;
            bodies[i].setQFromVector(state,
                                     Vector(Vec3(start.angle, start.position.x, start.position.y)));
            bodies[i].setUFromVector(state, Vector(Vec3(rate[2], rate[0], rate[1])));
        } else {
            bodies[i].setOneU(state, 0, rate[0]);
        }
    }
}

void World::read(const State &state, DriverMotion *to)
{
    for (size_t i = 0; i < of->body_count; i++) {
        double *at = coordinates.data() + tree.bodies[i].first;
        double *going = rates.data() + tree.bodies[i].first;
        if (tree.bodies[i].kind == TREE_FREE) {
            const DriverMotion &start = of->bodies[i].start;
            at[0] = bodies[i].getOneQ(state, 1) - start.position.x;
            at[1] = bodies[i].getOneQ(state, 2) - start.position.y;
            at[2] = bodies[i].getOneQ(state, 0) - start.angle;
            for (int k = 0; k < 3; k++) {
                going[k] = bodies[i].getOneU(state, (k + 1) % 3);
            }
        } else {
            at[0] = bodies[i].getOneQ(state, 0);
            going[0] = bodies[i].getOneU(state, 0);
        }
    }
    tree_motions(&tree, coordinates.data(), rates.data(), to);
}

void World::push(const State &state, Vector_<SpatialVec> &on_bodies)
{
    const DriverAction *acting = tried;
    if (!is_trial) {
        const double now_s = state.getTime();
        read(state, motions.data());
        actions_find(of, motions.data(), now_s, now_s, actions.data());
        if (!is_native) {
            places_press(of, contacts, motions.data(), actions.data(), forces_now.data(), nullptr,
                         0.0);
        }
        acting = actions.data();
    }
    for (size_t i = 0; acting != nullptr && i < of->body_count; i++) {
        const SpatialVec all(Vec3(0.0, 0.0, acting[i].moment), to_vec(acting[i].force));
        bodies[i].applyBodyForce(state, all, on_bodies);
    }
}

// Follows the contacts to the end of a step, and finds their forces.
void World::follow(const DriverMotion *now, double step_s, ::Vec2 *on_joints)
{
    places_follow(of, now, contacts, answer.totals);
    places_press(of, contacts, now, nullptr, on_joints, &answer, step_s);
}

void World::stamp(const State &state)
{
    DriverStamp *now = driver_run_stamp(&answer);
    now->position_s = now->velocity_s = state.getTime();
    read(state, now->motions);
    if (is_native) {
        read_native(state, now->motions, now->forces);
    } else {
        follow(now->motions, of->step_s, now->forces);
    }
    driver_run_stamped(&answer);
}

// A sample within a step, which Simbody has interpolated.
void World::sample(const State &state)
{
    DriverMotion *at = driver_run_motions(&answer);
    read(state, at);
    places_press(of, contacts, at, nullptr, driver_run_forces(&answer), nullptr, 0.0);
    driver_run_sampled(&answer);
}

// What the joints do at a step's end stands for all of it.
void World::record(double start_s, double end_s, const DriverMotion *now)
{
    std::vector<DriverTouch> touches(of->joint_count);
    places_touches(&answer, now, forces_now.data(), touches.data());
    driver_run_record(&answer, start_s, end_s, now, touches.data());
}

// Lets drives go on as they do behind a kink.
void World::pass_kink(RungeKuttaMersonIntegrator &integrator)
{
    piece_s = integrator.getAdvancedTime();
    integrator.updAdvancedState().invalidateAllCacheAtOrAbove(Stage::Time);
    integrator.reinitialize(Stage::Time, false);
}

// Long steps: what is between them only Simbody knows.
void World::run_adaptive(RungeKuttaMersonIntegrator &integrator)
{
    std::vector<DriverMotion> now(of->body_count);
    double followed_s = -1.0;
    while (!driver_run_is_full(&answer)) {
        // all samples within a step come before its end is said to be reached
        const double kink_s = next_kink(integrator.getAdvancedTime());
        const auto reached = integrator.stepTo(driver_run_next(&answer), kink_s);
        if (reached == Integrator::ReachedReportTime) {
            sample(integrator.getState());
        } else if (integrator.getAdvancedTime() > followed_s) {
            const double before_s = std::max(followed_s, 0.0);
            followed_s = integrator.getAdvancedTime();
            read(integrator.getAdvancedState(), now.data());
            follow(now.data(), followed_s - before_s, forces_now.data());
            record(before_s, followed_s, now.data());
        }
        if (followed_s >= kink_s) {
            pass_kink(integrator);
        }
    }
    const double sampled_s = of->sample_times[of->sample_count - 1];
    if (sampled_s > followed_s) {
        record(std::max(followed_s, 0.0), sampled_s,
               &answer.motions[(of->sample_count - 1) * of->body_count]);
    }
    answer.steps = static_cast<size_t>(integrator.getNumStepsTaken());
}

// The contacts within the step: Simbody tells accelerations at any state.
void World::accelerate(const double *q, const double *v, const DriverAction *given, double *a)
{
    tried = given;
    for (size_t i = 0; i < of->body_count; i++) {
        const double *at = q + tree.bodies[i].first;
        const double *going = v + tree.bodies[i].first;
        if (tree.bodies[i].kind == TREE_FREE) {
            const DriverMotion &start = of->bodies[i].start;
            bodies[i].setQFromVector(trial,
                                     Vector(Vec3(start.angle + at[2], start.position.x + at[0],
                                                 start.position.y + at[1])));
            bodies[i].setUFromVector(trial, Vector(Vec3(going[2], going[0], going[1])));
        } else {
            bodies[i].setOneQ(trial, 0, at[0]);
            bodies[i].setOneU(trial, 0, going[0]);
        }
    }
    system.realize(trial, Stage::Acceleration);
    for (size_t i = 0; i < of->body_count; i++) {
        double *own = a + tree.bodies[i].first;
        for (size_t k = 0; k < tree.bodies[i].count; k++) {
            own[k] = bodies[i].getOneUDot(trial, tree.bodies[i].count == 1 ? 0 : (k + 1) % 3);
        }
    }
}

void World::run_trials()
{
    is_trial = true;
    trial = system.realizeTopology();
    std::snprintf(answer.settings, sizeof answer.settings, "none: no integrator of Simbody's");
    const TrialEngine engine = {
        [](void *own, const double *q, const double *v, const DriverAction *given, double *a) {
            static_cast<World *>(own)->accelerate(q, v, given, a);
        },
        nullptr, this};
    trial_run(&tree, &engine, &answer);
}

void World::run()
{
    const bool is_adaptive = driver_is_way(of, "adaptive");
    const double share = of->step_s / ACCURACY_STEP;
    const double accuracy = std::max(ACCURACY * share * share, ACCURACY_LEAST);
    State state = system.realizeTopology();
    set_start(state);
    system.realize(state, Stage::Velocity);
    if (is_native) {
        set_stops(state);
        answer.is_linear = true;
    }
    RungeKuttaMersonIntegrator integrator(system);
    integrator.setConstraintTolerance(std::min(1e-8, accuracy));
    integrator.setReturnEveryInternalStep(true);
    if (is_adaptive) {
        integrator.setAccuracy(accuracy);
        std::snprintf(answer.settings, sizeof answer.settings, "RungeKuttaMerson, accuracy %.3g",
                      accuracy);
    } else {
        integrator.setAccuracy(ACCURACY_NONE);
        integrator.setFixedStepSize(of->step_s);
        std::snprintf(answer.settings, sizeof answer.settings,
                      "RungeKuttaMerson with setFixedStepSize");
    }
    tell_native();
    const double end_s = 2.0 * of->duration_s;
    integrator.setFinalTime(end_s);
    integrator.initialize(state);
    driver_run_begin(&answer);
    if (is_adaptive) {
        run_adaptive(integrator);
        driver_run_write(&answer);
    }
    stamp(integrator.getAdvancedState());
    while (!driver_run_is_full(&answer)) {
        const double before_s = integrator.getAdvancedTime();
        const double kink_s = next_kink(before_s);
        integrator.stepTo(end_s, kink_s);
        if (integrator.getAdvancedTime() > before_s) {
            answer.steps++;
            stamp(integrator.getAdvancedState());
        }
        if (integrator.getAdvancedTime() >= kink_s) {
            pass_kink(integrator);
        }
    }
    driver_run_write(&answer);
}

int main()
{
    static const char *const WAYS[] = {"native", "force", "adaptive", "kernel", nullptr};
    static const char *const NATIVE[] = {"limits", "gears", "racks", "drives",
                                         "servos", "waves", "drags", nullptr};
    int major, minor, build;
    SimTK_version_simbody(&major, &minor, &build);
    char version[32];
    std::snprintf(version, sizeof version, "%d.%d.%d", major, minor, build);
    const DriverIdentity identity = {"Simbody", version, "double", WAYS, NATIVE};
    int status;
    const DriverCase *of = driver_read(&identity, &status);
    if (of == nullptr) {
        return status;
    }
    try {
        World world(of);
        if (driver_is_way(of, "kernel")) {
            world.run_trials();
        }
        world.run();
    } catch (const std::exception &problem) {
        driver_fail("Simbody: %s", problem.what());
    }
    return 0;
}
