// Simbody's system of a case, and the ways to step it: what the files of its driver share.
#pragma once

#include <cmath> // before what is in C
extern "C" {
#include "drivers/common/native.h"
#include "drivers/common/trial.h"
}

#include <Simbody.h>
#include <memory>
#include <vector>

using namespace SimTK;

class World
{
  public:
    explicit World(const DriverCase *of);
    void run();
    void run_trials();
    void accelerate(const double *q, const double *v, const DriverAction *given, double *a);
    void push(const State &state, Vector_<SpatialVec> &on_bodies);

    void add_body(size_t i);
    void add_loops();
    void add_drive(size_t i);
    double next_kink(double time_s) const;
    void pass_kink(RungeKuttaMersonIntegrator &integrator);
    void set_start(State &state);
    void read(const State &state, DriverMotion *motions);
    void follow(const DriverMotion *now, double step_s, ::Vec2 *on_joints);
    void stamp(const State &state);
    void sample(const State &state);
    void record(double start_s, double end_s, const DriverMotion *now);
    void run_adaptive(RungeKuttaMersonIntegrator &integrator);
    MobilizedBody &body(int number)
    {
        return number == DRIVER_GROUND ? matter.updGround() : bodies[number];
    }

    const DriverCase *of;
    Tree tree;
    MultibodySystem system;
    SimbodyMatterSubsystem matter{system};
    GeneralForceSubsystem forces{system};
    std::vector<MobilizedBody> bodies;
    DriverContact *contacts; // by place
    std::vector<DriverMotion> motions;
    std::vector<DriverAction> actions; // by body
    std::vector<double> coordinates;
    std::vector<double> rates;
    std::vector<::Vec2> forces_now; // by joint
    DriverRun answer;
    double piece_s = 0.0; // since when drives turn as in the step under way
    // of `native`: what touches (simbody_native.cpp)
    bool is_native;
    Native native{};
    std::vector<std::unique_ptr<Force::MobilityLinearStop>> stops; // by row; empty of teeth
    std::vector<double> pushes;                                    // by place
    double stiffness_most = 0.0;
    void make_native();
    void stop_at_ends(const NativeRow &row, size_t coordinate);
    void couple(const NativeRow &row);
    void set_stops(State &state);
    void tell_native();
    void read_native(const State &state, const DriverMotion *now, ::Vec2 *on_joints);
    // of trials
    State trial;
    bool is_trial = false;
    const DriverAction *tried = nullptr;
};
