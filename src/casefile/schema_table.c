// Has every key of a case file, with its unit, range and meaning. Defaults stand in model/options.c
// and model/scenario.c; here only what a number cannot say about them.
#include "casefile/schema_needs.h"
#include "contact/facets.h"

#include <stddef.h>
#include <stdint.h>

static const char *const FOUR_BAR_LINKS[] = {"crank", "coupler", "follower", NULL};
static const char *const FOUR_BAR_PIVOTS[] = {
    "ground-crank", "crank-coupler", "coupler-follower", "follower-ground", NULL,
};
static const char *const SLIDER_CRANK_LINKS[] = {"crank", "rod", "slider", NULL};
static const char *const SLIDER_CRANK_PIVOTS[] = {
    "ground-crank", "crank-rod", "rod-slider", "slider-guide", NULL,
};

const SchemaFormRow SCHEMA_FORMS[] = {
    {SCHEMA_FOUR_BAR, "four-bar", FOUR_BAR_LINKS, FOUR_BAR_PIVOTS,
     "crank-coupler, coupler-follower, follower-ground"},
    {SCHEMA_SLIDER_CRANK, "slider-crank", SLIDER_CRANK_LINKS, SLIDER_CRANK_PIVOTS,
     "crank-rod, rod-slider, slider-guide"},
    {SCHEMA_LONG, "bodies", NULL, NULL, NULL},
};
static_assert(sizeof SCHEMA_FORMS / sizeof *SCHEMA_FORMS == SCHEMA_FORM_COUNT,
              "each form has its row");

const SchemaFamilyRow SCHEMA_FAMILIES[SCHEMA_FAMILY_COUNT] = {
    [SCHEMA_SINGLE] = {"", "", 1},
    [SCHEMA_BODY] = {"bodies", "body", SIZE_MAX},
    [SCHEMA_JOINT] = {"joints", "joint", SIZE_MAX},
    [SCHEMA_POINT] = {"points", "point", SCENARIO_POINT_MAX},
    [SCHEMA_SPRING] = {"springs", "spring", SIZE_MAX},
    [SCHEMA_TORSION_SPRING] = {"torsion-springs", "torsion spring", SIZE_MAX},
    [SCHEMA_BUSHING] = {"bushings", "bushing", SIZE_MAX},
    [SCHEMA_LOAD_FAMILY] = {"loads", "load", SIZE_MAX},
    [SCHEMA_DRIVE] = {"drives", "drive", SIZE_MAX},
    [SCHEMA_SIGNAL_FAMILY] = {"signals", "signal", SIZE_MAX},
};

static const char *const LOAD_FRAMES[] = {"world", "body", NULL};
static const char *const LOAD_OVERS[] = {"time", "crank-angle", "position", NULL};
static const char *const PROFILES[] = {"cycloid", "polynomial", "trapezoid", "spline", NULL};
static const char *const ASSEMBLIES[] = {"open", "crossed", NULL};
static const char *const SLIDER_SIDES[] = {"right", "left", NULL};

// clang-format off
#define FULL_TURN 6.2831853071795872
#define AT(field) .offset = offsetof(Scenario, field)
#define AT_BODY(number, field) \
    .holder = SCHEMA_BODY, .member = number, .offset = offsetof(Body, field)
#define AT_JOINT(field) .holder = SCHEMA_JOINT, .offset = offsetof(Joint, field)
#define MASS(body) \
    .dimension = DIMENSION_MASS, AT_BODY(body, mass), \
    .low = 1e-9, .high = 1e6, .is_required = true
#define INERTIA(body) \
    .dimension = DIMENSION_INERTIA, AT_BODY(body, own_inertia), \
    .low = 1e-18, .high = 1e9, .is_required = true
#define MOMENT(axis, member, own) \
    .dimension = DIMENSION_INERTIA, AT_BODY(member, space.inertia_##axis), \
    .low = 1e-18, .high = 1e9, .default_words = own, .doc = "about the body's " #axis \
    " axis"
#define PRODUCT(axes, member) \
    .dimension = DIMENSION_INERTIA, AT_BODY(member, space.product_##axes), \
    .low = -1e9, .high = 1e9, .doc = "product of inertia: sum of mass times " \
    "both coordinates from the centre of mass"
#define OFFSET(member) \
    .dimension = DIMENSION_LENGTH, AT_BODY(member, space.height), .low = -1e3, \
    .high = 1e3, .doc = "z of the centre of mass at time zero"
#define X_OWN "a hundredth of inertia"
#define Y_OWN "inertia"
#define LENGTH(link, words) \
    {.path = "four-bar." #link ".length", .type = SCHEMA_TOLERATED, .form = SCHEMA_FOUR_BAR, \
     .dimension = DIMENSION_LENGTH, AT(fourbar.link), .low = 1e-6, .high = 1e3, \
     .is_required = true, .doc = words}
#define LINK(link, body, words) \
    LENGTH(link, words), \
    {.path = "four-bar." #link ".mass", .form = SCHEMA_FOUR_BAR, MASS(body), \
     .doc = "mass of the link"}, \
    {.path = "four-bar." #link ".inertia", .form = SCHEMA_FOUR_BAR, INERTIA(body), \
     .doc = "about the centre of mass, at mid-link"}, \
    {.path = "four-bar." #link ".inertia-x", SPACE_LINK, MOMENT(x, body, X_OWN)}, \
    {.path = "four-bar." #link ".inertia-y", SPACE_LINK, MOMENT(y, body, Y_OWN)}, \
    {.path = "four-bar." #link ".product-xy", SPACE_LINK, PRODUCT(xy, body)}, \
    {.path = "four-bar." #link ".product-xz", SPACE_LINK, PRODUCT(xz, body)}, \
    {.path = "four-bar." #link ".product-yz", SPACE_LINK, PRODUCT(yz, body)}, \
    {.path = "four-bar." #link ".offset", SPACE_LINK, OFFSET(body)}
#define SPACE_LINK .form = SCHEMA_FOUR_BAR, .needs = SPATIAL
#define SLIDER_CRANK(field) .form = SCHEMA_SLIDER_CRANK, AT(slidercrank.field)
#define SLIDER_LINK(link, body, where) \
    {.path = "slider-crank." #link ".mass", .form = SCHEMA_SLIDER_CRANK, MASS(body), \
     .doc = "mass of the link"}, \
    {.path = "slider-crank." #link ".inertia", .form = SCHEMA_SLIDER_CRANK, INERTIA(body), \
     .doc = "about the centre of mass, " where}
#define BODY .family = SCHEMA_BODY, .form = SCHEMA_LONG
#define SPACE_BODY BODY, .needs = MEMBER | SPATIAL
#define JOINT(field) .family = SCHEMA_JOINT, AT_JOINT(field)
#define PIN(field) JOINT(clearance.field), .needs = MEMBER, .kinds = JOINTS_WITH_HOLE
#define PIN_MATERIAL(field) \
    JOINT(clearance.field), .needs = MEMBER | MATERIAL, .kinds = JOINTS_WITH_HOLE, \
    .default_words = "that of material"
#define GUIDE(field) \
    JOINT(guide.field), .form = SCHEMA_LONG | SCHEMA_SLIDER_CRANK, .dimension = DIMENSION_LENGTH, .low = 1e-6, \
    .high = 1e2, .is_required = true, .needs = MEMBER, .kinds = JOINTS_WITH_GUIDES
#define STOP .form = SCHEMA_LONG, .needs = MEMBER, .kinds = JOINTS_WITH_DISC
#define FRICTION_OF(field) JOINT(friction.field), .needs = MEMBER | VALUED
#define APART(field) \
    .type = SCHEMA_ANCHOR, .form = SCHEMA_LONG, JOINT(field), .flag = offsetof(Joint, is_apart), \
    .dimension = DIMENSION_LENGTH, .low = -1e3, .high = 1e3, .is_required = true, \
    .rivalry = SCHEMA_PLACING, .kinds = JOINTS_WITH_DISC | JOINTS_WITH_HOLE, .needs = MEMBER | OWN
#define LIMITED (JOINTS_WITH_ANGLE | JOINTS_WITH_POSITION)
#define SLIDING (JOINTS_WITH_HOLE | JOINTS_WITH_GUIDES | JOINTS_WITH_DISC | LIMITED)
#define TOUCHING (JOINTS_WITH_PLAY | JOINTS_WITH_COORDINATE)
#define SPRING(field) \
    .family = SCHEMA_SPRING, \
    .holder = SCHEMA_SPRING, .offset = offsetof(Spring, field), .needs = MEMBER
#define TORSION(field) \
    .family = SCHEMA_TORSION_SPRING, \
    .holder = SCHEMA_TORSION_SPRING, .offset = offsetof(TorsionSpring, field), .needs = MEMBER
#define BUSHING(field) \
    .family = SCHEMA_BUSHING, \
    .holder = SCHEMA_BUSHING, .offset = offsetof(Bushing, field), .needs = MEMBER
#define BUSHING_PLACE(field) \
    .type = SCHEMA_ANCHOR, BUSHING(field), .dimension = DIMENSION_LENGTH, .low = -1e3, \
    .high = 1e3, .is_required = true, .rivalry = SCHEMA_PLACING
#define LOAD(field) \
    .family = SCHEMA_LOAD_FAMILY, .holder = SCHEMA_LOAD_FAMILY, \
    .offset = offsetof(Load, field), .needs = MEMBER
#define FURTHER(field) \
    .family = SCHEMA_DRIVE, .form = SCHEMA_LONG, .holder = SCHEMA_DRIVE, \
    .offset = field, .needs = MEMBER
#define ANGLES_DOC \
    "angle by which the body has turned since the start, at points of time, the first 0; between " \
    "them it moves by the profile, before and after them it stands; or a sinusoid. A soft drive may " \
    "hold one angle, and begin with any"
#define PROFILE_DOC \
    "from one angle to the next: cycloid, polynomial (3-4-5) and trapezoid (of the speed, in " \
    "thirds) rest at each; a cubic spline goes through all"
#define ENGINE(id, word, ...) \
    {.path = "engines." word, .type = SCHEMA_CHOICE, AT(engines[id].way), \
     .words = OPTIONS_ENGINE_WAYS, .backends = SCHEMA_WITH(id), \
     .doc = "the way in which it runs the case, of those that its driver has; best takes the " \
            "first of the others that it has"},
#define POINT(field) \
    .family = SCHEMA_POINT, .holder = SCHEMA_POINT, .offset = offsetof(TracedPoint, field), .needs = MEMBER
#define DAMPING_DOC(name, word, words, factor) "; " word ": " words

const SchemaRow SCHEMA_ROWS[] = {
    {.path = "title", .type = SCHEMA_TEXT, AT(title), .default_words = "none",
     .doc = "one line that names the case in reports"},
    {.path = "space", .type = SCHEMA_CHOICE, AT(space), .words = SCENARIO_SPACES,
     .doc = "spatial: bodies move in space, and pins with play tilt and slide in holes of a width"},

    LENGTH(ground, "from the crank's ground pivot, the origin, to the follower's, along +x"),
    LINK(crank, 0, "from its ground pivot to the crank pin"),
    LINK(coupler, 1, "from the crank pin to the follower pin"),
    LINK(follower, 2, "from its ground pivot to the follower pin"),
    {.path = "four-bar.assembly", .type = SCHEMA_CHOICE, .form = SCHEMA_FOUR_BAR, AT(fourbar.assembly),
     .words = ASSEMBLIES,
     .doc = "open: the follower pin is left of the line from crank pin to the follower's ground "
            "pivot; crossed: right of it"},

    {.path = "slider-crank.crank.length", SLIDER_CRANK(crank), .dimension = DIMENSION_LENGTH,
     .low = 1e-6, .high = 1e3, .is_required = true,
     .doc = "from the ground pivot, the origin, to the crank pin"},
    SLIDER_LINK(crank, 0, "at mid-crank"),
    {.path = "slider-crank.rod.length", SLIDER_CRANK(rod), .dimension = DIMENSION_LENGTH,
     .low = 1e-6, .high = 1e3, .is_required = true,
     .doc = "from the crank pin to the pin in the slider"},
    SLIDER_LINK(rod, 1, "at mid-rod"),
    SLIDER_LINK(slider, 2, "at the pin, in the middle of a block"),
    {.path = "slider-crank.offset", SLIDER_CRANK(offset), .dimension = DIMENSION_LENGTH,
     .low = -1e3, .high = 1e3,
     .doc = "of the slider's line from the crank's ground pivot, to the left of its direction"},
    {.path = "slider-crank.angle", SLIDER_CRANK(line), .dimension = DIMENSION_ANGLE,
     .low = -FULL_TURN, .high = FULL_TURN,
     .doc = "direction of the slider's line, counter-clockwise from the world's x axis"},
    {.path = "slider-crank.assembly", .type = SCHEMA_CHOICE, SLIDER_CRANK(side),
     .words = SLIDER_SIDES,
     .doc = "right: the slider is ahead of the crank pin in the line's direction; left: behind it"},

    {.path = "bodies.*.mass", BODY, MASS(0), .needs = MEMBER, .doc = "mass of the body"},
    {.path = "bodies.*.inertia", BODY, INERTIA(0), .needs = MEMBER,
     .doc = "about the centre of mass"},
    {.path = "bodies.*.at", BODY, .type = SCHEMA_VECTOR, .dimension = DIMENSION_LENGTH,
     AT_BODY(0, start.position), .low = -1e3, .high = 1e3, .is_required = true,
     .needs = MEMBER, .doc = "position [x, y] of the centre of mass at time zero"},
    {.path = "bodies.*.angle", BODY, .dimension = DIMENSION_ANGLE,
     AT_BODY(0, start.angle), .low = -FULL_TURN, .high = FULL_TURN,
     .needs = MEMBER,
     .doc = "angle of the body's own x axis at time zero, counter-clockwise from the world's"},
    {.path = "bodies.*.inertia-x", SPACE_BODY, MOMENT(x, 0, X_OWN)},
    {.path = "bodies.*.inertia-y", SPACE_BODY, MOMENT(y, 0, Y_OWN)},
    {.path = "bodies.*.product-xy", SPACE_BODY, PRODUCT(xy, 0)},
    {.path = "bodies.*.product-xz", SPACE_BODY, PRODUCT(xz, 0)},
    {.path = "bodies.*.product-yz", SPACE_BODY, PRODUCT(yz, 0)},
    {.path = "bodies.*.offset", SPACE_BODY, OFFSET(0)},
    {.path = "bodies.*.velocity", BODY, .type = SCHEMA_VECTOR, .dimension = DIMENSION_SPEED,
     AT_BODY(0, start.velocity), .low = -1e4, .high = 1e4, .needs = MEMBER | FREE,
     .doc = "velocity of the centre of mass at time zero, where the drive does not determine it"},
    {.path = "bodies.*.spin", BODY, .dimension = DIMENSION_ANGULAR_SPEED,
     AT_BODY(0, start.omega), .low = -1e6, .high = 1e6, .needs = MEMBER | FREE,
     .doc = "angular velocity at time zero, likewise; counter-clockwise positive"},

    {.path = "bodies.*.velocity-z", BODY, .dimension = DIMENSION_SPEED,
     AT_BODY(0, space.velocity_z), .low = -1e4, .high = 1e4,
     .needs = MEMBER | FREE | SPATIAL,
     .doc = "velocity of the centre of mass along z at time zero"},
    {.path = "bodies.*.spin-x", BODY, .dimension = DIMENSION_ANGULAR_SPEED,
     AT_BODY(0, space.omega_x), .low = -1e6, .high = 1e6,
     .needs = MEMBER | FREE | SPATIAL,
     .doc = "angular velocity about the world's x axis at time zero"},
    {.path = "bodies.*.spin-y", BODY, .dimension = DIMENSION_ANGULAR_SPEED,
     AT_BODY(0, space.omega_y), .low = -1e6, .high = 1e6,
     .needs = MEMBER | FREE | SPATIAL,
     .doc = "angular velocity about the world's y axis at time zero"},

#include "casefile/schema_joints.inc"

    {.path = "springs.*.between", .type = SCHEMA_BETWEEN, SPRING(body_a), .is_required = true,
     .doc = "[body, body]: two bodies, or a body and ground"},
    {.path = "springs.*.at-a", .type = SCHEMA_ANCHOR, SPRING(anchor_a), .is_required = true,
     .dimension = DIMENSION_LENGTH, .low = -1e3, .high = 1e3, .side = 0,
     .doc = "position [x, y] in the world at time zero of the end on the first body"},
    {.path = "springs.*.at-b", .type = SCHEMA_ANCHOR, SPRING(anchor_b), .is_required = true,
     .dimension = DIMENSION_LENGTH, .low = -1e3, .high = 1e3, .side = 1,
     .doc = "likewise of the end on the second body"},
    {.path = "springs.*.stiffness", SPRING(stiffness), .dimension = DIMENSION_SPRING,
     .low = 0.0, .high = 1e12, .doc = "force over elongation"},
    {.path = "springs.*.length", SPRING(length), .dimension = DIMENSION_LENGTH, .low = 0.0,
     .high = 1e3, .default_words = "that at time zero", .doc = "length of the relaxed spring"},
    {.path = "springs.*.damping", SPRING(damping), .dimension = DIMENSION_DAMPING, .low = 0.0,
     .high = 1e12, .doc = "force over the rate of the length"},
    {.path = "torsion-springs.*.joint", .type = SCHEMA_JOINT_NAME, TORSION(joint),
     .is_required = true, .doc = "the joint whose two bodies it turns against each other"},
    {.path = "torsion-springs.*.stiffness", TORSION(stiffness),
     .dimension = DIMENSION_TORSION_SPRING, .low = 0.0, .high = 1e12, .doc = "torque over angle"},
    {.path = "torsion-springs.*.angle", TORSION(angle), .dimension = DIMENSION_ANGLE,
     .low = -1e4, .high = 1e4, .default_words = "that at time zero",
     .doc = "where it is relaxed: angle of the second body less that of the first (the ground "
            "counts as the first)"},
    {.path = "torsion-springs.*.damping", TORSION(damping),
     .dimension = DIMENSION_TORSION_DAMPING, .low = 0.0, .high = 1e12,
     .doc = "torque over angular velocity"},

    {.path = "bushings.*.between", .type = SCHEMA_BETWEEN, BUSHING(body_a), .is_required = true,
     .doc = "[body, body]: two bodies, or a body and ground; its axes turn with the first"},
    {.path = "bushings.*.at", BUSHING_PLACE(anchor_a), .side = SCHEMA_PLACE_OF_BOTH,
     .doc = "position [x, y] in the world at time zero, where it is relaxed"},
    {.path = "bushings.*.at-a", BUSHING_PLACE(anchor_a), .side = 0,
     .doc = "with at-b instead of at, of one that is deflected at time zero: position [x, y] then of "
            "its centre on the first body"},
    {.path = "bushings.*.at-b", BUSHING_PLACE(anchor_b), .side = 1,
     .doc = "likewise on the second body; it is relaxed where both are at one point"},
    {.path = "bushings.*.direction", .type = SCHEMA_HEADING, BUSHING(direction),
     .dimension = DIMENSION_ANGLE, .low = -FULL_TURN, .high = FULL_TURN,
     .doc = "of its x axis at time zero, counter-clockwise from the world's"},
    {.path = "bushings.*.stiffness", .type = SCHEMA_PAIR, BUSHING(stiffness),
     .dimension = DIMENSION_SPRING, .low = 0.0, .high = 1e12, .rivalry = SCHEMA_PULLING, .side = 0,
     .doc = "force over deflection along both axes, or along x and y"},
    {.path = "bushings.*.damping", .type = SCHEMA_PAIR, BUSHING(damping),
     .dimension = DIMENSION_DAMPING, .low = 0.0, .high = 1e12,
     .doc = "force over the rate of the deflection, likewise"},
    {.path = "bushings.*.torsional-stiffness", BUSHING(torsional_stiffness),
     .dimension = DIMENSION_TORSION_SPRING, .low = 0.0, .high = 1e12, .rivalry = SCHEMA_TWISTING,
     .side = 0, .doc = "torque over angle"},
    {.path = "bushings.*.torsional-damping", BUSHING(torsional_damping),
     .dimension = DIMENSION_TORSION_DAMPING, .low = 0.0, .high = 1e12,
     .doc = "torque over angular velocity"},
    {.path = "bushings.*.angle", BUSHING(angle), .dimension = DIMENSION_ANGLE, .low = -1e4,
     .high = 1e4, .default_words = "that at time zero",
     .doc = "where it has no torque: angle of the second body less that of the first"},
    {.path = "bushings.*.interpolation", .type = SCHEMA_CHOICE, BUSHING(interpolation),
     .words = FORCE_CURVE_SHAPES,
     .doc = "between points; smooth: a cubic that keeps to their range and has no kinks"},
    {.path = "bushings.*.force-x", .type = SCHEMA_CURVE, BUSHING(force_x),
     .dimension = DIMENSION_FORCE, .low = -1e9, .high = 1e9, .rivalry = SCHEMA_PULLING, .side = 1,
     .default_words = "none",
     .doc = "instead of stiffness: 2 to 64 points of the force that pulls it back over its "
            "deflection along x, of the sign of the deflection; beyond them it goes on straight"},
    {.path = "bushings.*.force-y", .type = SCHEMA_CURVE, BUSHING(force_y),
     .dimension = DIMENSION_FORCE, .low = -1e9, .high = 1e9, .rivalry = SCHEMA_PULLING, .side = 1,
     .default_words = "none", .doc = "likewise along y; an axis without points has no stiffness"},
    {.path = "bushings.*.torque", .type = SCHEMA_CURVE, BUSHING(torque),
     .dimension = DIMENSION_TORQUE, .low = -1e9, .high = 1e9, .rivalry = SCHEMA_TWISTING,
     .side = 1, .default_words = "none",
     .doc = "instead of torsional-stiffness: likewise over the angle from where it is relaxed"},

    {.path = "loads.*.joint", .type = SCHEMA_JOINT_NAME, LOAD(joint),
     .doc = "the joint along whose coordinate it acts, instead of body: a force along a slider's "
            "line or a torque at a pivot, on the second body (the first, where that is the "
            "ground), and the other way on the other"},
    {.path = "loads.*.body", .type = SCHEMA_BODY_NAME, LOAD(body),
     .doc = "the body that it acts on, instead of joint"},
    {.path = "loads.*.at", .type = SCHEMA_ANCHOR, LOAD(anchor), .dimension = DIMENSION_LENGTH,
     .low = -1e3, .high = 1e3, .default_words = "centred",
     .doc = "where a force acts on a body, in the world at time zero; centred: at the centre of "
            "mass"},
    {.path = "loads.*.direction", LOAD(direction), .dimension = DIMENSION_ANGLE,
     .low = -FULL_TURN, .high = FULL_TURN,
     .doc = "of a force on a body, counter-clockwise from the x axis of its frame"},
    {.path = "loads.*.frame", .type = SCHEMA_CHOICE, LOAD(frame), .words = LOAD_FRAMES,
     .doc = "world: the direction stays; body: it turns with the body, from whose x axis it "
            "counts"},
    {.path = "loads.*.over", .type = SCHEMA_CHOICE, LOAD(over), .words = LOAD_OVERS,
     .doc = "what points are over: time, the crank's angle (with drive.torque that of its joint), "
            "or the position of the load's joint"},
    {.path = "loads.*.interpolation", .type = SCHEMA_CHOICE, LOAD(table.shape),
     .words = LOAD_SHAPES,
     .doc = "between points; smooth: a cubic that keeps to their range; steps: the value of the "
            "point before"},
    {.path = "loads.*.period", .type = SCHEMA_LOAD_PERIOD, LOAD(table.period), .low = 0.0,
     .high = 1e6, .default_words = "a turn over crank-angle, else none",
     .doc = "after which points repeat; such as 720 deg for a four-stroke engine"},
    {.path = "loads.*.area", LOAD(area), .dimension = DIMENSION_AREA, .low = -1e3, .high = 1e3,
     .default_words = "none",
     .doc = "force is then a pressure on this area, such as a CSV column `pressure [bar]`; below 0: "
            "it acts against the coordinate"},
    {.path = "loads.*.force", .type = SCHEMA_LOAD, LOAD(table), .dimension = DIMENSION_FORCE,
     .low = -1e9, .high = 1e9,
     .doc = "constant, or up to 400 points, constant beyond the ends; a CSV file beside the case "
            "has heads with units, such as `crank angle [deg], force [kN]`"},
    {.path = "loads.*.torque", .type = SCHEMA_LOAD, LOAD(table), .dimension = DIMENSION_TORQUE,
     .low = -1e9, .high = 1e9, .doc = "likewise; counter-clockwise positive"},

    {.path = "signals.*", .type = SCHEMA_SIGNAL, .family = SCHEMA_SIGNAL_FAMILY, .is_required = true,
     .doc = "what a value of loads, drive.speed, angle, torque or force may be over time, for use by "
            "its name"},
    {.path = "drive.joint", .type = SCHEMA_JOINT_NAME, .form = SCHEMA_LONG,
     AT(linkage.driver.joint), .is_required = true, .needs = DRIVEN,
     .doc = "the ideal joint with the ground about which the drive turns a body; of a torque any "
            "ideal pivot, on whose second body it acts, and the other way on the first; of a "
            "force an ideal prismatic joint"},
    {.path = "drive.speed", .type = SCHEMA_SPEED, .dimension = DIMENSION_ANGULAR_SPEED,
     AT(linkage.driver), .low = -1e6, .high = 1e6, .is_required = true,
     .rivalry = SCHEMA_DRIVING, .side = 0, .needs = DRIVE,
     .doc = "angular velocity of the driven body, counter-clockwise positive: constant and not 0 (of "
            "a soft drive 0 holds it where it starts), or linear in time between up to 32 points, not "
            "all 0, with constant ends, or a sinusoid"},
    {.path = "drive.angle", .type = SCHEMA_ANGLES, .dimension = DIMENSION_ANGLE,
     AT(linkage.driver), .low = -1e6, .high = 1e6, .default_words = "none",
     .rivalry = SCHEMA_DRIVING, .side = 4, .needs = DRIVE, .doc = "instead of speed: " ANGLES_DOC},
    {.path = "drive.profile", .type = SCHEMA_CHOICE, AT(linkage.driver.profile),
     .words = PROFILES, .needs = DRIVE, .doc = "of drive.angle, " PROFILE_DOC},
    {.path = "drive.period", .dimension = DIMENSION_TIME, AT(linkage.driver.table.period_s),
     .low = 0.0, .high = 1e6, .low_is_open = true, .default_words = "none",
     .needs = DRIVEN | VALUED, .wants = UNSTEADY,
     .doc = "time after which a speed over time repeats: linear from its last point to the first "
            "of the next period, with whole turns in each; an angle over time likewise, from 0 s "
            "to the end of the period; a torque or force over time likewise, without turns"},
    {.path = "drive.torque", .type = SCHEMA_TORQUE, .form = SCHEMA_LONG,
     .dimension = DIMENSION_TORQUE, AT(linkage.torque.table), .low = -1e9, .high = 1e9,
     .rivalry = SCHEMA_DRIVING, .side = 1, .default_words = "none", .needs = TORQUE,
     .doc = "instead of speed: a torque, constant or over time as a speed"},
    {.path = "drive.force", .type = SCHEMA_TORQUE, .form = SCHEMA_LONG,
     .dimension = DIMENSION_FORCE, AT(linkage.torque.table), .low = -1e9, .high = 1e9,
     .rivalry = SCHEMA_DRIVING, .side = 2, .default_words = "none", .needs = FORCE,
     .doc = "instead of speed, at an ideal prismatic joint: a force along its line on the second "
            "body, and the other way on the first, likewise"},
    {.path = "drive.stall-torque", .form = SCHEMA_LONG, .dimension = DIMENSION_TORQUE,
     AT(linkage.torque.table.values[0]), .low = -1e9, .high = 1e9,
     .rivalry = SCHEMA_DRIVING, .side = 3, .default_words = "none", .needs = TORQUE,
     .doc = "instead of speed: a motor whose torque falls in a straight line from this at rest to "
            "0 at no-load-speed, and on beyond it"},
    {.path = "drive.no-load-speed", .form = SCHEMA_LONG, .dimension = DIMENSION_ANGULAR_SPEED,
     AT(linkage.torque.no_load), .low = -1e6, .high = 1e6, .default_words = "none",
     .needs = TORQUE,
     .doc = "of a motor: the speed without torque, of the sign of stall-torque"},
    {.path = "drive.rotor-inertia", .form = SCHEMA_LONG, .dimension = DIMENSION_INERTIA,
     AT(linkage.torque.inertia), .low = 0.0, .high = 1e9, .needs = TORQUE,
     .doc = "of a motor at a pivot with the ground: its rotor's, reduced to the shaft"},
    {.path = "drive.stiffness", .form = SCHEMA_LONG, .dimension = DIMENSION_TORSION_SPRING,
     AT(linkage.torque.stiffness), .low = 0.0, .high = 1e12, .default_words = "none",
     .needs = TORQUE,
     .doc = "of a soft drive, beside speed or angle: torque over the angle by which the body is "
            "behind what these prescribe, as of a belt or controller"},
    {.path = "drive.damping", .form = SCHEMA_LONG, .dimension = DIMENSION_TORSION_DAMPING,
     AT(linkage.torque.slope), .low = 0.0, .high = 1e12, .default_words = "none",
     .needs = TORQUE,
     .doc = "likewise, torque over the difference of the speeds"},
    {.path = "drive.torque-limit", .form = SCHEMA_LONG, .dimension = DIMENSION_TORQUE,
     AT(linkage.torque.limit), .low = 0.0, .high = 1e9, .low_is_open = true,
     .default_words = "none", .needs = TORQUE,
     .doc = "of a soft drive: the largest torque that stiffness and damping give, to either side"},
    {.path = "drives.*.speed", .type = SCHEMA_SPEED, .dimension = DIMENSION_ANGULAR_SPEED,
     FURTHER(0), .low = -1e6, .high = 1e6, .is_required = true, .rivalry = SCHEMA_DRIVING,
     .side = 0, .doc = "of the body that turns about that joint, as drive.speed; 0 rpm holds it"},
    {.path = "drives.*.angle", .type = SCHEMA_ANGLES, .dimension = DIMENSION_ANGLE, FURTHER(0),
     .low = -1e6, .high = 1e6, .default_words = "none", .rivalry = SCHEMA_DRIVING, .side = 4,
     .doc = "instead of speed, as drive.angle"},
    {.path = "drives.*.profile", .type = SCHEMA_CHOICE, FURTHER(offsetof(Driver, profile)),
     .words = PROFILES, .doc = "of angle, as drive.profile"},
    {.path = "drives.*.period", .dimension = DIMENSION_TIME,
     FURTHER(offsetof(Driver, table.period_s)) | VALUED, .low = 0.0, .high = 1e6,
     .low_is_open = true, .default_words = "none", .doc = "as drive.period"},
    {.path = "drive.start", .form = SCHEMA_SHORT, .dimension = DIMENSION_ANGLE,
     AT(linkage.driver.start), .low = -FULL_TURN, .high = FULL_TURN,
     .doc = "angle of the crank at time zero, counter-clockwise from the ground link, which is "
            "the world's x axis; bodies have their own"},
    {.path = "gravity", .type = SCHEMA_GRAVITY, .dimension = DIMENSION_ACCELERATION, AT(gravity),
     .low = -1e3, .high = 1e3,
     .doc = "acceleration of gravity: one number is downward, along -y; [x, y], or with space: "
            "spatial [x, y, z], in the world's axes: 9.81 m/s^2 is [0 m/s^2, -9.81 m/s^2]"},

    {.path = "material.youngs-modulus", .dimension = DIMENSION_PRESSURE,
     AT(material.youngs_modulus), .low = 1e3, .high = 1e13, .needs = MATERIAL,
     .doc = "Young's modulus of pin and hole"},
    {.path = "material.poisson-ratio", AT(material.poisson_ratio), .low = 0.0, .high = 0.5,
     .needs = MATERIAL, .doc = "Poisson's ratio of pin and hole"},

    {.path = "contact.model", .type = SCHEMA_CHOICE, AT(contact.model),
     .words = OPTIONS_CONTACT_MODELS, .needs = PLAY,
     .doc = "impact: a force from penetration and its rate; poisson: velocity-level penalty with "
            "restitution"},
    {.path = "contact.law", .type = SCHEMA_CHOICE, AT(contact.law), .words = OPTIONS_LAWS,
     .rivalry = SCHEMA_ELASTICITY, .side = 0, .needs = LAW,
     .doc = "elastic law of the impact model; instead of stiffness"},
    {.path = "contact.stiffness", .type = SCHEMA_STIFFNESS, .dimension = DIMENSION_STIFFNESS,
     AT(contact), .low = 0.0, .high = 1e24, .low_is_open = true,
     .rivalry = SCHEMA_ELASTICITY, .side = 1, .default_words = "from the law",
     .needs = STIFFNESS, .wants = COMMON_STIFFNESS,
     .doc = "K in F = K d^n, instead of a law; n follows from the unit: N/m^1.5, N/mm^1.5, N/m"},
    {.path = "contact.stiffness-for", .type = SCHEMA_STIFFNESS_FOR, AT(contact.for_depth),
     .rivalry = SCHEMA_ELASTICITY, .side = 2, .default_words = "none",
     .needs = STIFFNESS | VALUED, .wants = COMMON_STIFFNESS,
     .doc = "instead of law or stiffness: the depth at a force that it is for, 0.1 mm at 500 N; "
            "with exponent 1.5 behind it K d^1.5"},
    {.path = "contact.damping", .type = SCHEMA_CHOICE, AT(contact.damping),
     .words = OPTIONS_DAMPINGS, .needs = IMPACT, .wants = COMMON_DAMPING,
     .doc = "damping law of the impact model, by its hysteresis factor chi for a restitution e"
            OPTIONS_DAMPING_LIST(DAMPING_DOC)},
    {.path = "contact.restitution", AT(contact.restitution), .low = 0.0, .high = 1.0,
     .needs = PLAY, .wants = REBOUND | DERIVED, .doc = "ratio of the speeds after and before an impact"},
    {.path = "contact.viscous-coefficient", .dimension = DIMENSION_DAMPING,
     AT(contact.viscous_coefficient), .low = 0.0, .high = 1e12, .low_is_open = true,
     .default_words = "none", .needs = VISCOUS,
     .doc = "force over penetration rate"},
    {.path = "contact.full-damping-depth", .dimension = DIMENSION_LENGTH,
     AT(contact.full_damping_depth), .low = 1e-9, .high = 1e2, .default_words = "none",
     .needs = IMPACT | VALUED, .wants = GROWING | COMMON_DEPTH,
     .doc = "penetration from which on damping step has all of viscous-coefficient; before it "
            "x^2 (3 - 2 x) of that, x the share of this depth"},
    {.path = "contact.friction", AT(contact.friction), .low = 0.0, .high = 1.0,
     .needs = PLAY, .wants = COMMON_FRICTION, .doc = "Coulomb's friction coefficient"},
    {.path = "contact.friction-speed", .dimension = DIMENSION_SPEED, AT(contact.friction_speed),
     .low = 0.0, .high = 1e3, .low_is_open = true, .needs = FRICTION, .wants = SMOOTHED,
     .doc = "sliding speed over which friction sets in"},
    {.path = "contact.friction-law", .type = SCHEMA_CHOICE, AT(contact.friction_law),
     .words = OPTIONS_FRICTION_LAWS, .needs = FRICTION | IMPACT,
     .doc = "regularized: sets in over friction-speed, and creeps at rest; stick: holds at rest, by "
            "a bristle that bends up to presliding; lugre: the model of that name, of ideal joints"},
    {.path = "contact.breakaway-ratio", AT(contact.breakaway_ratio), .low = 1.0, .high = 1e2,
     .needs = FRICTION | IMPACT, .wants = BRISTLED,
     .doc = "of friction-law stick and lugre: static over sliding friction; it falls as "
            "exp(-(v / friction-speed)^2)"},
    {.path = "contact.presliding", .dimension = DIMENSION_LENGTH, AT(contact.presliding),
     .low = 0.0, .high = 1.0, .low_is_open = true, .needs = FRICTION | IMPACT, .wants = BRISTLED,
     .doc = "of friction-law stick and lugre: how far the bristle bends before it slides; 5 um is "
            "usual of steel"},
    {.path = "contact.presliding-damping", AT(contact.presliding_damping), .low = 0.0,
     .high = 1e3, .low_is_open = true, .needs = FRICTION | IMPACT, .wants = BRISTLED,
     .doc = "of friction-law stick and lugre: damping ratio of what moves on the bristle"},
    {.path = "contact.penalty", .dimension = DIMENSION_DAMPING, AT(contact.penalty),
     .low = 0.0, .high = 1e12, .low_is_open = true,
     .default_words = "the paper's Eq. (9) at the drive's speed", .needs = POISSON,
     .doc = "force over closing speed"},
    {.path = "contact.bounce-speed", .dimension = DIMENSION_SPEED, AT(contact.bounce_speed),
     .low = 0.0, .high = 1e3, .needs = POISSON,
     .doc = "impacts below this speed do not bounce"},
    {.path = "contact.impact-speed-floor", .dimension = DIMENSION_SPEED,
     AT(contact.impact_speed_floor), .low = 0.0, .high = 1e3, .low_is_open = true,
     .needs = IMPACT, .wants = REMEMBERED,
     .doc = "smallest impact speed by which the damping laws divide"},
    {.path = "contact.resting-speed", .dimension = DIMENSION_SPEED, AT(contact.resting_speed),
     .low = 0.0, .high = 1e3, .low_is_open = true, .zero_word = "none",
     .needs = IMPACT, .wants = REMEMBERED,
     .doc = "speed by which damping laws divide once a contact has outlasted its impact: it was "
            "compressed, released, and is compressed again"},
    {.path = "contact.dissipation", .dimension = DIMENSION_DISSIPATION, AT(contact.dissipation),
     .low = 0.0, .high = 1e6, .low_is_open = true,
     .default_words = "that which gives back restitution at restitution-speed",
     .needs = DISSIPATING, .wants = COMMON_DAMPING,
     .doc = "c in F = F_el (1 + c d'), a constant of the material; at small speeds v the "
            "restitution is 1 - 2 c v / 3"},
    {.path = "contact.restitution-speed", .dimension = DIMENSION_SPEED,
     AT(contact.restitution_speed), .low = 0.0, .high = 1e3, .low_is_open = true,
     .needs = DISSIPATING, .wants = COMMON_DAMPING | DERIVED,
     .doc = "impact speed with that restitution"},

    {.path = "run.revolutions", AT(run.revolutions), .low = 0.0, .high = 1e6,
     .low_is_open = true, .needs = TURNING,
     .doc = "length of the run; may be a fraction; loads of 720 deg, as of a four-stroke engine, "
            "take two to be shown whole"},
    {.path = "run.duration", .dimension = DIMENSION_TIME, AT(run.duration),
     .low = 0.0, .high = 1e6, .low_is_open = true, .needs = TIMED,
     .doc = "length of a run without a drive of constant speed, or with a soft one instead of "
            "revolutions"},
    {.path = "run.samples", .type = SCHEMA_INTEGER, AT(run.samples), .low = 1.0, .high = 1e7,
     .doc = "samples per revolution, or in the run where it has a duration"},
    {.path = "run.step", .dimension = DIMENSION_TIME, AT(run.step), .low = 0.0, .high = 1.0,
     .low_is_open = true, .zero_word = "auto", .backends = SCHEMA_STEPPED,
     .default_words = "auto; 1 us where ode.stepping, ode.map or a collider but pin-hole is given, "
                      "or the model is poisson",
     .doc = "step of ODE and other engines; auto: chosen for an error within the tolerance, of ODE with "
            "stepping staggered and map impulse, or extrapolated if all joints are ideal"},
    {.path = "run.budget", .dimension = DIMENSION_TIME, AT(run.budget), .low = 0.0, .high = 1e9,
     .low_is_open = true, .zero_word = "none", .backends = SCHEMA_STEPPED,
     .doc = "processor time of each engine in `run` for the trials of a step that is chosen and for "
            "starts beside this one, and of draws of the inputs; what is beyond it is said, and not run"},
    {.path = "run.tolerance", AT(run.tolerance), .low = 1e-9, .high = 0.1,
     .needs = CHOSEN_STEP, .backends = SCHEMA_STEPPED,
     .doc = "largest error of any velocity of bodies and of pins in their holes, over its own "
            "largest, up to the predictability horizon"},
    {.path = "run.tolerance-of", .type = SCHEMA_CHOICE, AT(run.tolerance_of),
     .words = OPTIONS_TOLERANCES_OF, .needs = CHOSEN_STEP, .backends = SCHEMA_STEPPED,
     .doc = "the error that is limited: of the motion, of contact forces, or of the peaks of "
            "contacts and angular accelerations"},
    {.path = "run.most-steps", .type = SCHEMA_INTEGER, AT(run.most_steps), .low = 1e3, .high = 1e12,
     .needs = CHOSEN_STEP, .backends = SCHEMA_STEPPED,
     .doc = "limit for the world steps of all trials together; if it is too low, the run reports "
            "up to when the tolerance is met"},
    {.path = "run.spike-threshold", AT(run.spike_threshold), .low = 1e-3, .high = 1e3,
     .needs = PLAY,
     .doc = "smallest height of a spike, over what ideal joints show: the range of the angular "
            "acceleration, the largest force; without a drive, over a tenth of the signal's range"},
    {.path = "run.report-from", .type = SCHEMA_SPAN, .dimension = DIMENSION_TIME,
     AT(run.report_from), .low = 0.0, .high = 1e6, .needs = VALUED,
     .doc = "extremes, contacts and spikes are reported from this time on, such as 1 revolution, "
            "and of a contact under way then the rest; errors, energy, series and picture cover "
            "the whole run"},
    {.path = "run.start", .type = SCHEMA_CHOICE, AT(run.start), .words = OPTIONS_RUN_STARTS,
     .needs = PLAY | REPEATING | IMPACT,
     .default_words = "settled; centred of a case that gives a joint's start, runs for less than "
                      "a revolution or a period, or has none",
     .doc = "settled: in the motion that the reference comes to from several starts, by periods "
            "that drive and loads have in common: a revolution or drive.period, a load's period "
            "or that of a torque, or whole numbers of these; centred: "
            "pins in the middle of their holes, or where the case puts them; pressed: on the wall "
            "of the hole where the reaction of an ideal joint would hold the pin"},
    {.path = "run.settle-starts", .type = SCHEMA_INTEGER, AT(run.settle_starts), .low = 1.0,
     .high = 1000.0, .needs = PLAY | REPEATING | IMPACT, .wants = SETTLED,
     .doc = "different starts from which it is looked for: as written, pressed, and others that the "
            "play allows; the run is in the motion that most come to"},
    {.path = "run.settle-least", .type = SCHEMA_INTEGER, AT(run.settle_least), .low = 2.0,
     .high = 1e6, .needs = PLAY | REPEATING | IMPACT, .wants = SETTLED,
     .doc = "revolutions, or periods of what drives it, for which a start is watched before it is "
            "said not to repeat"},
    {.path = "run.settle-most", .type = SCHEMA_INTEGER, AT(run.settle_most), .low = 2.0,
     .high = 1e6, .needs = PLAY | REPEATING | IMPACT, .wants = SETTLED,
     .doc = "of a motion that does not repeat: revolutions after which it is taken as it is"},
    {.path = "run.settle-to", AT(run.settle_to), .low = 0.0, .high = 1.0,
     .low_is_open = true, .needs = PLAY | REPEATING | IMPACT, .wants = SETTLED,
     .doc = "likewise: half the width of the 95 % confidence interval of each joint's largest "
            "force, over that force, until which it is watched; 1: whatever it is"},
    {.path = "run.settle-budget", .dimension = DIMENSION_TIME, AT(run.settle_budget), .low = 0.0,
     .high = 1e6, .low_is_open = true, .needs = PLAY | REPEATING | IMPACT, .wants = SETTLED,
     .doc = "processor time for it, after which the run is in what is found by then"},
    {.path = "run.backends", .type = SCHEMA_BACKENDS, AT(run.backends),
     .words = OPTIONS_BACKENDS,
     .doc = "the solvers to run, in this order; analytic, by default too, is for four-bars and "
            "slider-cranks only"},

    {.path = "reference.tolerance", AT(reference.tolerance), .low = 1e-14, .high = 1e-3,
     .needs = REFERENCE,
     .doc = "limit for each step's error, relative to each coordinate and velocity; a tighter one "
            "is taken where it costs less: above 3e-5, or of strongly damped contacts"},

    {.path = "ode.solver", .type = SCHEMA_CHOICE, AT(ode.solver), .words = OPTIONS_ODE_SOLVERS,
     .needs = ODE, .wants = ANY_ROWS, .doc = "direct: dWorldStep; quick: dWorldQuickStep"},
    {.path = "ode.stepping", .type = SCHEMA_CHOICE, AT(ode.stepping),
     .words = OPTIONS_ODE_STEPPINGS, .needs = ODE | GIVEN_STEP,
     .default_words = "staggered; plain with map textbook, corrected or exact, or model poisson",
     .doc = "plain: read at the end of each step; staggered: positions half a step behind the "
            "velocities, second order; extrapolated: several steps combined, for ideal joints "
            "only"},
    {.path = "ode.map", .type = SCHEMA_CHOICE, AT(ode.map), .words = OPTIONS_ODE_MAPS,
     .needs = ODE | IMPACT | GIVEN_STEP,
     .default_words = "impulse; textbook with stepping plain or model poisson; midpoint with any "
                      "collider but pin-hole",
     .doc = "how stiffness and damping become ERP and CFM; impulse: neither, the contact is "
            "integrated within the step, with staggered stepping only"},
    {.path = "ode.collider", .type = SCHEMA_CHOICE, AT(ode.collider),
     .words = OPTIONS_ODE_COLLIDERS, .needs = ODE | PLAY, .wants = PIN,
     .doc = "the hole is, pin-hole: a circle; staves: a ring of convex staves, by libccd's MPR; "
            "staves-gjk: the same by its GJK and EPA; ode-convex: the same through ODE; trimesh: "
            "a mesh of triangles. Only pin-hole goes with map impulse"},
    {.path = "ode.facets", .type = SCHEMA_INTEGER, AT(ode.facets), .low = FACETS_LEAST,
     .high = FACETS_MOST, .zero_word = "auto", .needs = ODE | PLAY | FACETED,
     .default_words = "auto",
     .doc = "sides of the polygon that stands for a hole; auto: the sagitta is a hundredth of the "
            "play or the depth to be expected"},
    {.path = "ode.polygon", .type = SCHEMA_CHOICE, AT(ode.polygon), .words = OPTIONS_ODE_POLYGONS,
     .needs = ODE | PLAY | FACETED,
     .doc = "circumscribed: sides touch the wall at their middles; inscribed: corners lie on the "
            "wall, as in a CAD mesh, and the sagitta is taken from the play"},
    {.path = "ode.erp", AT(ode.erp), .low = 0.0, .high = 1.0, .needs = ODE | PLAIN, .wants = HELD_ROWS,
     .doc = "error reduction of the ideal joints per step; with other stepping it is 1"},
    {.path = "ode.cfm", .plain_unit = "s/kg", AT(ode.cfm), .low = 0.0, .high = 1e6, .needs = ODE, .wants = HELD_ROWS,
     .doc = "constraint force mixing of the ideal joints, in s/kg = m/(N s), without the unit"},
    {.path = "ode.push-out", AT(ode.push_out), .low = 0.0, .high = 1.0,
     .needs = ODE | POISSON, .doc = "ERP of the contact"},
    {.path = "ode.iterations", .type = SCHEMA_INTEGER, AT(ode.iterations), .low = 1.0,
     .high = 1e6, .needs = ODE | QUICK, .doc = "iterations of the quick solver per step"},
    {.path = "ode.over-relaxation", AT(ode.over_relaxation), .low = 0.0, .high = 2.0,
     .low_is_open = true, .needs = ODE | QUICK, .doc = "over-relaxation of the quick solver"},
    {.path = "ode.seed", .type = SCHEMA_INTEGER, AT(ode.seed), .low = 0.0, .high = 4294967295.0,
     .needs = ODE | QUICK, .wants = SHUFFLED, .doc = "seed for the order in which the quick solver visits rows"},
    {.path = "ode.settle-steps", .type = SCHEMA_INTEGER, AT(ode.settle_steps), .low = 0.0,
     .high = 1e7, .needs = ODE | IDEAL | PLAIN, .wants = MOVED,
     .doc = "steps before time zero"},
    {.path = "ode.levels", .type = SCHEMA_INTEGER, AT(ode.levels), .low = 2.0, .high = 6.0,
     .needs = ODE | EXTRAPOLATED,
     .doc = "worlds side by side; the order is one more"},
    {.path = "ode.gear", .type = SCHEMA_INTEGER, AT(ode.gear), .low = 1.0, .high = 64.0,
     .needs = ODE | LOCAL | GIVEN_STEP,
     .doc = "steps are this many times finer while a pin touches or is about to"},
    {.path = "ode.contact-phase", AT(ode.contact_phase), .low = 0.0, .high = 0.5,
     .needs = ODE | LOCAL | GIVEN_STEP, .plain_unit = "rad",
     .doc = "0: a contact's own steps are as long as the accuracy of the step allows; else their "
            "error is that of a classical step of this many rad of its oscillation, without the "
            "unit"},

    OPTIONS_ENGINE_LIST(ENGINE)

    {.path = "points.*.body", .type = SCHEMA_BODY_NAME, POINT(body), .is_required = true,
     .doc = "the body to which the point belongs"},
    {.path = "points.*.along", .type = SCHEMA_ALONG, .dimension = DIMENSION_LENGTH,
     POINT(local.x), .low = -1e3, .high = 1e3, .is_required = true,
     .doc = "distance from the link's first joint towards its second; of bodies and sliders from "
            "the centre of mass along the x axis"},
    {.path = "points.*.offset", .dimension = DIMENSION_LENGTH, POINT(local.y), .low = -1e3,
     .high = 1e3, .doc = "distance to the left of that direction"},

    {.path = "expect", .type = SCHEMA_EXPECT, AT(expectations), .default_words = "none",
     .doc = "limits for the runs' numbers: below"},
};
// clang-format on
#undef AT

const size_t SCHEMA_ROW_COUNT = sizeof SCHEMA_ROWS / sizeof SCHEMA_ROWS[0];
