// Says what each group of keys is for.
#include "casefile/schema.h"

// clang-format off
const SchemaGroup SCHEMA_GROUPS[] = {
    {"", "title, plane or space, gravity",
     "Keys outside any group."},
    {"four-bar", "links of a four-bar",
     "The links of a four-bar, whose closed form stacks up the tolerances of lengths."},
    {"slider-crank", "links of a slider-crank",
     "The links of a slider-crank, instead of four-bar, in the plane. The crank turns "
                     "about the origin; the rod joins its end to the slider. The rod is longer than "
                     "crank and offset together where the crank is to turn fully."},
    {"bodies", "bodies of any linkage: mass, inertia, place",
     "Any linkage, instead of four-bar: any number of rigid bodies, "
               "with names of letters, digits, - and _."},
    {"joints", "pins, guides, stops, gears: sizes, play, friction",
     "With four-bar the joints with play, by name: crank-coupler, coupler-follower, "
               "follower-ground; others are ideal, and ground-crank, which the drive turns, always is. "
               "With slider-crank likewise: crank-rod, rod-slider and slider-guide. With bodies every "
               "joint, with any name. The keys make the kind: no sizes an ideal pivot; hole and pin, or "
               "radial-clearance, a pin with play; along an ideal prismatic joint, with guide, block "
               "and length as well a block with play between guides, or a sleeve round a rod; normal, "
               "slot, discs or profile a stop, where two bodies touch that are not joined; gears and teeth a "
               "pair of gears; rack a rack and pinion. An ideal pivot or prismatic joint with "
               "backlash, or with low and high, has "
               "flanks or stops at the ends of its coordinate. With space: spatial there are only pins, "
               "and pivots with or without limits."},
    {"springs", "springs and dampers between two points",
     "Springs with dampers along the line between two points, in the plane."},
    {"torsion-springs", "springs and dampers about a joint",
     "Springs with dampers that turn the two bodies of a joint against each "
                        "other, in the plane."},
    {"bushings", "rubber mounts in place of pins",
     "Rubber bushings and other mounts, in the plane: each holds two bodies at a point by "
                 "springs and dampers along two axes and by angle, instead of a pin."},
    {"loads", "forces and torques from outside",
     "Forces and torques from outside, in the plane: on a body, or along the coordinate of a "
              "joint, such as a gas force on a piston; constant, or over time, the crank's angle or "
              "the joint's position."},
    {"signals", "values over time, for loads and drives",
     "Values over time under names of their own, each for any number of loads and drives: "
                "`loads.left.force: gust`. A sinusoid is mean + amplitude sin(2 pi frequency t + phase), "
                "written {mean: 1 N, amplitude: 3 N, frequency: 50 Hz, phase: 30 deg}; mean is 0 by "
                "default, of an angle what lets it begin with 0, and phase 0 deg. Parts of one have paths, "
                "for --set and studies: `signals.gust.amplitude`, and without a name "
                "`loads.left.force.amplitude`."},
    {"drive", "what turns the crank, and how",
     "How the crank turns; optional with bodies. At a constant speed, or over time; with bodies "
              "also by a torque, a force or a motor: they then start with their own speeds, at rest by "
              "default, and the run has a duration. A soft drive (stiffness, damping) follows a speed "
              "or an angle, or holds one angle: it starts with the speed that it follows, and a run "
              "after a constant speed has revolutions or a duration."},
    {"drives", "further drives",
     "Further drives beside `drive`, each named by the joint about which it turns a body, in "
               "the plane: a five-bar has two. Angles of the crank are those of `drive`. The run "
               "has a duration."},
    {"material", "elasticity of pins and holes",
     "Material of pins and holes; steel by default."},
    {"contact", "contact law, damping, restitution, friction",
     "The contact between pin and hole, of joints with play that have no values of their own."},
    {"run", "duration, samples, step, solvers, what is reported",
     "Duration, samples, step and solvers."},
    {"reference", "accuracy of the reference",
     "Accuracy of the reference."},
    {"ode", "how ODE is used",
     "How the Open Dynamics Engine is used, where ode is among run.backends."},
    {"engines", "how other engines are used",
     "How other engines run the case, where they are among run.backends; driver is the "
                "one that --driver names."},
    {"points", "points whose paths are written",
     "Points of bodies whose paths are written, at most 4."},
};
// clang-format on

const size_t SCHEMA_GROUP_COUNT = sizeof SCHEMA_GROUPS / sizeof SCHEMA_GROUPS[0];
