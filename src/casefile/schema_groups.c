// Says what each group of keys is for.
#include "casefile/schema.h"

// clang-format off
const SchemaGroup SCHEMA_GROUPS[] = {
    {"", "Keys outside any group."},
    {"four-bar", "The links of a four-bar. A length may have a tolerance: 108 +- 0.3 mm, "
                 "108 +0.1/-0.2 mm."},
    {"slider-crank", "The links of a slider-crank, instead of four-bar. The crank turns about the "
                     "origin; the rod joins its end to the slider, which slides along a straight "
                     "line. The rod is longer than crank and offset together where the crank is "
                     "to turn fully. In the plane only."},
    {"bodies", "Any linkage, instead of four-bar: any number of rigid bodies, "
               "with names of letters, digits, - and _."},
    {"joints", "With four-bar, the joints with play, by name: crank-coupler, coupler-follower, "
               "follower-ground; a joint that is not named is ideal, and the drive joint "
               "ground-crank always is. With slider-crank likewise: crank-rod and rod-slider, pins "
               "with play, and slider-guide, with guide, block and length; without them the slider "
               "stays on its line. With bodies, every joint, with any name. Its keys "
               "make its kind: without sizes it is an ideal pivot; with hole and pin, or "
               "radial-clearance, a pin with play; with along an ideal prismatic joint; with guide, "
               "block and length as well a block with play between guides, or a sleeve round a "
               "rod; with at-a and at-b a stop, where two bodies touch that are not joined; with gears and teeth a "
               "pair of gears. An ideal pivot or prismatic joint with backlash, or with low and high, has flanks "
               "or stops at the ends of its own coordinate. All but pivots and pins are for the plane."},
    {"springs", "Springs with dampers along the line between two points, with names of letters, "
                "digits, - and _. In the plane only."},
    {"torsion-springs", "Springs with dampers that turn the two bodies of a joint against each "
                        "other. In the plane only."},
    {"loads", "Forces and torques from outside, by name: on a body, or along the coordinate of a "
              "joint, such as a gas force on a piston; constant, or over time, the crank's angle or "
              "the joint's position. In the plane only."},
    {"drive", "How the crank turns; optional with bodies. At a constant speed, or over time, or with bodies by a "
              "torque, a force or a motor, or softly after a speed: they then start with their own speeds, at rest by default, and the run has "
              "a duration."},
    {"drives", "Further drives beside `drive`, each named by the joint that it turns a body about, "
               "with bodies: a five-bar has two. Angles of the crank are those of `drive`. The run "
               "has a duration. In the plane only."},
    {"material", "Material of pins and holes; steel by default."},
    {"contact", "The contact between pin and hole."},
    {"run", "Duration, samples, step and solvers."},
    {"reference", "Accuracy of the reference."},
    {"ode", "How the Open Dynamics Engine is used."},
    {"engines", "How other engines run the case, where they are among run.backends; driver is the "
                "one that --driver names."},
    {"points", "Points of bodies whose paths are written, at most 4, with names of letters, "
               "digits, - and _."},
};
// clang-format on

const size_t SCHEMA_GROUP_COUNT = sizeof SCHEMA_GROUPS / sizeof SCHEMA_GROUPS[0];
