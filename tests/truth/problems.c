// Which mechanisms are worth a truth?
#include "problems.h"

#include "mechanism.h"

const ProblemChoice PROBLEMS[PROBLEM_COUNT] = {
    // clang-format off
    {"one joint, one turn",     {"crank-coupler"},                                        14.5e-6, 0.0, 60e-3},
    {"two joints",              {"crank-coupler", "coupler-follower"},                    14.5e-6, 0.0, 60e-3},
    {"three joints",            {"crank-coupler", "coupler-follower", "follower-ground"}, 14.5e-6, 0.0, 60e-3},
    {"friction in one joint",   {"crank-coupler"},                                        14.5e-6, 0.1, 60e-3},
    {"0.5 mm of play",          {"crank-coupler"},                                        0.5e-3,  0.0, 10e-3},
    {"friction that turns back", {"coupler-follower"},                                    14.5e-6, 0.1, 60e-3},
    // clang-format on
};

Scenario problem_scenario(const ProblemChoice *choice)
{
    Scenario scenario = mechanism_paper();
    scenario.contact.stiffness = 6.6e10;
    scenario.contact.damping = DAMPING_LANKARANI_NIKRAVESH;
    scenario.contact.restitution = 0.9;
    scenario.contact.impact_speed_floor = 1e-3;
    scenario.contact.friction = choice->friction;
    scenario.contact.friction_speed = 1e-2;
    for (size_t i = 0; choice->joints[i] != NULL; i++) {
        mechanism_loosen(&scenario, choice->joints[i]);
    }
    for (size_t i = 0; i < scenario.linkage.joint_count; i++) {
        Clearance *clearance = &scenario.linkage.joints[i].clearance;
        if (choice->clearance != 14.5e-6 && scenario.linkage.joints[i].kind == JOINT_CLEARANCE) {
            clearance->hole_radius = clearance->pin_radius + choice->clearance;
        }
    }
    return scenario;
}
