// What may a case file say? Every key, with its unit, range and meaning. Defaults stand in
// model/options.c and model/scenario.c; here only what a number cannot say about them.
#include "casefile/schema.h"

#include <stddef.h>

const char *const SCHEMA_BODY_NAMES[] = {"crank", "coupler", "follower", NULL};
const char *const SCHEMA_JOINT_NAMES[SCHEMA_JOINT_COUNT] = {
    "crank-coupler",
    "coupler-follower",
    "follower-ground",
};

static const char *const ASSEMBLIES[] = {"open", "crossed", NULL};

static bool has_play(const Scenario *scenario, size_t index)
{
    (void)index;
    return scenario_has_clearance(scenario);
}

static bool joint_has_play(const Scenario *scenario, size_t index)
{
    return scenario->linkage.joints[index + 1].kind == JOINT_CLEARANCE;
}

static bool uses_impact(const Scenario *scenario, size_t index)
{
    return has_play(scenario, index) && scenario->contact.model == CONTACT_IMPACT;
}

static bool uses_poisson(const Scenario *scenario, size_t index)
{
    return has_play(scenario, index) && scenario->contact.model == CONTACT_POISSON;
}

static bool uses_law(const Scenario *scenario, size_t index)
{
    return uses_impact(scenario, index) && scenario->contact.stiffness == 0.0;
}

static bool uses_stiffness(const Scenario *scenario, size_t index)
{
    return uses_impact(scenario, index) && scenario->contact.stiffness > 0.0;
}

// The paper's Eq. (9) for the penalty needs the material as well.
static bool uses_material(const Scenario *scenario, size_t index)
{
    return uses_law(scenario, index) ||
           (uses_poisson(scenario, index) && scenario->contact.penalty == 0.0);
}

static bool uses_viscous(const Scenario *scenario, size_t index)
{
    return uses_impact(scenario, index) && scenario->contact.damping == DAMPING_VISCOUS;
}

static bool uses_ode(const Scenario *scenario, size_t index)
{
    (void)index;
    for (size_t i = 0; i < scenario->run.backend_count; i++) {
        if (scenario->run.backends[i] == BACKEND_ODE) {
            return true;
        }
    }
    return false;
}

static bool uses_ode_impact(const Scenario *scenario, size_t index)
{
    return uses_ode(scenario, index) && uses_impact(scenario, index);
}

static bool uses_ode_poisson(const Scenario *scenario, size_t index)
{
    return uses_ode(scenario, index) && uses_poisson(scenario, index);
}

static bool uses_ode_play(const Scenario *scenario, size_t index)
{
    return uses_ode(scenario, index) && has_play(scenario, index);
}

static bool uses_ode_quick(const Scenario *scenario, size_t index)
{
    return uses_ode(scenario, index) && scenario->ode.solver == ODE_QUICK;
}

static bool uses_ode_ideal(const Scenario *scenario, size_t index)
{
    return uses_ode(scenario, index) && !has_play(scenario, index);
}

static bool point_is_present(const Scenario *scenario, size_t index)
{
    return index < scenario->point_count;
}

// clang-format off
#define AT(field) .offset = offsetof(Scenario, field)
#define LINK_LENGTH(link) \
    .type = SCHEMA_TOLERATED, .dimension = DIMENSION_LENGTH, AT(fourbar.link), \
    .low = 1e-6, .high = 1e3, .is_required = true
#define LINK_MASS(body) \
    .dimension = DIMENSION_MASS, AT(linkage.bodies[body].mass), \
    .low = 1e-9, .high = 1e6, .is_required = true
#define LINK_INERTIA(body) \
    .dimension = DIMENSION_INERTIA, AT(linkage.bodies[body].inertia), \
    .low = 1e-18, .high = 1e9, .is_required = true
#define JOINT(field) \
    .family = SCHEMA_JOINT, AT(linkage.joints[1].clearance.field), .applies = joint_has_play
#define POINT(field) \
    .family = SCHEMA_POINT, AT(points[0].field), .applies = point_is_present

const SchemaRow SCHEMA_ROWS[] = {
    {.path = "title", .type = SCHEMA_TEXT, AT(title), .default_words = "none",
     .doc = "one line that names the case in reports"},

    {.path = "four-bar.ground.length", LINK_LENGTH(ground),
     .doc = "from the crank's ground pivot, the origin, to the follower's, along +x"},
    {.path = "four-bar.crank.length", LINK_LENGTH(crank),
     .doc = "from its ground pivot to the crank pin"},
    {.path = "four-bar.crank.mass", LINK_MASS(0), .doc = "of the crank"},
    {.path = "four-bar.crank.inertia", LINK_INERTIA(0),
     .doc = "about the centre of mass, which is at mid-link"},
    {.path = "four-bar.coupler.length", LINK_LENGTH(coupler),
     .doc = "from the crank pin to the follower pin"},
    {.path = "four-bar.coupler.mass", LINK_MASS(1), .doc = "of the coupler"},
    {.path = "four-bar.coupler.inertia", LINK_INERTIA(1),
     .doc = "about the centre of mass, which is at mid-link"},
    {.path = "four-bar.follower.length", LINK_LENGTH(follower),
     .doc = "from its ground pivot to the follower pin"},
    {.path = "four-bar.follower.mass", LINK_MASS(2), .doc = "of the follower"},
    {.path = "four-bar.follower.inertia", LINK_INERTIA(2),
     .doc = "about the centre of mass, which is at mid-link"},
    {.path = "four-bar.assembly", .type = SCHEMA_CHOICE, AT(fourbar.assembly),
     .words = ASSEMBLIES,
     .doc = "open: the follower pin lies to the left of the line from crank pin to the follower's "
            "ground pivot; crossed: to the right"},

    {.path = "joints.*.hole", .type = SCHEMA_DIAMETER, .dimension = DIMENSION_LENGTH,
     JOINT(hole_radius), .low = 1e-6, .high = 1e2, .is_required = true,
     .rivalry = SCHEMA_SIZES, .side = 0,
     .doc = "diameter of the hole, without tolerance; in place of radial-clearance"},
    {.path = "joints.*.pin", .type = SCHEMA_DIAMETER, .dimension = DIMENSION_LENGTH,
     JOINT(pin_radius), .low = 1e-6, .high = 1e2, .is_required = true,
     .rivalry = SCHEMA_SIZES, .side = 0,
     .doc = "diameter of the pin, smaller than the hole; in place of radial-clearance"},
    {.path = "joints.*.radial-clearance", .type = SCHEMA_RADIAL_CLEARANCE,
     .dimension = DIMENSION_LENGTH, .family = SCHEMA_JOINT,
     AT(linkage.joints[1].clearance), .low = 1e-9, .high = 0.1, .applies = joint_has_play,
     .rivalry = SCHEMA_SIZES, .side = 1, .default_words = "from hole and pin",
     .doc = "hole radius less pin radius, in place of hole and pin; the pin is then 10 mm in "
            "diameter and the hole larger by twice this"},
    {.path = "joints.*.width", .dimension = DIMENSION_LENGTH, JOINT(width),
     .low = 1e-6, .high = 1e2, .default_words = "none",
     .doc = "length over which pin and hole touch; needed by the laws of cylinders"},
    {.path = "joints.*.start", .type = SCHEMA_ECCENTRICITY, .dimension = DIMENSION_LENGTH,
     JOINT(start), .low = -0.1, .high = 0.1, .default_words = "centred",
     .doc = "pin centre less hole centre at time zero: centred, or [x, y], no longer than the "
            "radial clearance"},

    {.path = "drive.speed", .dimension = DIMENSION_ANGULAR_SPEED, AT(linkage.driver.speed),
     .low = -1e6, .high = 1e6, .is_required = true,
     .doc = "of the crank, constant, counter-clockwise positive; not 0"},
    {.path = "drive.start", .dimension = DIMENSION_ANGLE, AT(linkage.driver.start),
     .low = -6.2831853071795872, .high = 6.2831853071795872,
     .doc = "angle of the crank at time zero, counter-clockwise from the ground link"},
    {.path = "gravity", .dimension = DIMENSION_ACCELERATION, AT(gravity),
     .low = -1e3, .high = 1e3, .doc = "downward, along -y; 0 m/s^2 for none"},

    {.path = "material.youngs-modulus", .dimension = DIMENSION_PRESSURE,
     AT(material.youngs_modulus), .low = 1e3, .high = 1e13, .applies = uses_material,
     .doc = "of pin and hole alike"},
    {.path = "material.poisson-ratio", AT(material.poisson_ratio), .low = 0.0, .high = 0.5,
     .applies = uses_material, .doc = "of pin and hole alike"},

    {.path = "contact.model", .type = SCHEMA_CHOICE, AT(contact.model),
     .words = OPTIONS_CONTACT_MODELS, .applies = has_play,
     .doc = "impact: a force from penetration and its rate; poisson: a velocity-level penalty "
            "with restitution"},
    {.path = "contact.law", .type = SCHEMA_CHOICE, AT(contact.law), .words = OPTIONS_LAWS,
     .rivalry = SCHEMA_ELASTICITY, .side = 0, .applies = uses_law,
     .doc = "elastic law of the impact model; in place of stiffness"},
    {.path = "contact.stiffness", .type = SCHEMA_STIFFNESS, .dimension = DIMENSION_STIFFNESS,
     AT(contact), .low = 0.0, .high = 1e24, .low_is_open = true,
     .rivalry = SCHEMA_ELASTICITY, .side = 1, .default_words = "from the law",
     .applies = uses_stiffness,
     .doc = "K in F = K d^n, in place of a law; the unit gives n: N/m^1.5, N/mm^1.5, N/m"},
    {.path = "contact.damping", .type = SCHEMA_CHOICE, AT(contact.damping),
     .words = OPTIONS_DAMPINGS, .applies = uses_impact,
     .doc = "where the impact model loses energy"},
    {.path = "contact.restitution", AT(contact.restitution), .low = 0.0, .high = 1.0,
     .applies = has_play, .doc = "speed after an impact over speed before it, asked for"},
    {.path = "contact.viscous-coefficient", .dimension = DIMENSION_DAMPING,
     AT(contact.viscous_coefficient), .low = 0.0, .high = 1e12, .low_is_open = true,
     .default_words = "none", .applies = uses_viscous,
     .doc = "force over penetration rate; needed by damping: viscous"},
    {.path = "contact.friction", AT(contact.friction), .low = 0.0, .high = 0.0,
     .applies = has_play, .doc = "coefficient of friction; this version has no friction"},
    {.path = "contact.penalty", .dimension = DIMENSION_DAMPING, AT(contact.penalty),
     .low = 0.0, .high = 1e12, .low_is_open = true,
     .default_words = "the paper's Eq. (9) at the drive's speed", .applies = uses_poisson,
     .doc = "force over closing speed in the poisson model"},
    {.path = "contact.bounce-speed", .dimension = DIMENSION_SPEED, AT(contact.bounce_speed),
     .low = 0.0, .high = 1e3, .applies = uses_poisson,
     .doc = "poisson model: slower impacts do not bounce"},
    {.path = "contact.impact-speed-floor", .dimension = DIMENSION_SPEED,
     AT(contact.impact_speed_floor), .low = 0.0, .high = 1e3, .low_is_open = true,
     .applies = uses_impact, .doc = "smallest impact speed the damping laws divide by"},

    {.path = "run.revolutions", AT(run.revolutions), .low = 0.0, .high = 1e6,
     .low_is_open = true, .doc = "of the crank; may be a fraction"},
    {.path = "run.samples", .type = SCHEMA_INTEGER, AT(run.samples), .low = 1.0, .high = 1e7,
     .doc = "written per revolution"},
    {.path = "run.step", .dimension = DIMENSION_TIME, AT(run.step), .low = 0.0, .high = 1.0,
     .low_is_open = true, .doc = "of solvers with a fixed step"},
    {.path = "run.backends", .type = SCHEMA_BACKENDS, AT(run.backends),
     .words = OPTIONS_BACKENDS, .doc = "the solvers to run, in this order: a word or a list"},

    {.path = "ode.solver", .type = SCHEMA_CHOICE, AT(ode.solver), .words = OPTIONS_ODE_SOLVERS,
     .applies = uses_ode, .doc = "direct: dWorldStep; quick: dWorldQuickStep"},
    {.path = "ode.stepping", .type = SCHEMA_CHOICE, AT(ode.stepping),
     .words = OPTIONS_ODE_STEPPINGS, .applies = uses_ode, .doc = "plain: as ODE steps by itself"},
    {.path = "ode.map", .type = SCHEMA_CHOICE, AT(ode.map), .words = OPTIONS_ODE_MAPS,
     .applies = uses_ode_impact, .doc = "how stiffness and damping become ERP and CFM"},
    {.path = "ode.collider", .type = SCHEMA_CHOICE, AT(ode.collider),
     .words = OPTIONS_ODE_COLLIDERS, .applies = uses_ode_play,
     .doc = "what finds the contact of pin and hole"},
    {.path = "ode.erp", AT(ode.erp), .low = 0.0, .high = 1.0, .applies = uses_ode,
     .doc = "error reduction of the ideal joints, per step"},
    {.path = "ode.cfm", AT(ode.cfm), .low = 0.0, .high = 1e6, .applies = uses_ode,
     .doc = "constraint force mixing of the ideal joints, in ODE's unit 1/kg"},
    {.path = "ode.push-out", AT(ode.push_out), .low = 0.0, .high = 1.0,
     .applies = uses_ode_poisson, .doc = "ERP of the contact in the poisson model"},
    {.path = "ode.iterations", .type = SCHEMA_INTEGER, AT(ode.iterations), .low = 1.0,
     .high = 1e6, .applies = uses_ode_quick, .doc = "of the quick solver, per step"},
    {.path = "ode.over-relaxation", AT(ode.over_relaxation), .low = 0.0, .high = 2.0,
     .low_is_open = true, .applies = uses_ode_quick, .doc = "of the quick solver"},
    {.path = "ode.seed", .type = SCHEMA_INTEGER, AT(ode.seed), .low = 0.0, .high = 4294967295.0,
     .applies = uses_ode_quick, .doc = "of the order in which the quick solver visits rows"},
    {.path = "ode.settle-steps", .type = SCHEMA_INTEGER, AT(ode.settle_steps), .low = 0.0,
     .high = 1e7, .applies = uses_ode_ideal,
     .doc = "run before time zero where every joint is ideal"},

    {.path = "points.*.body", .type = SCHEMA_CHOICE, POINT(body), .words = SCHEMA_BODY_NAMES,
     .is_required = true, .doc = "the link that carries the point"},
    {.path = "points.*.along", .type = SCHEMA_ALONG, .dimension = DIMENSION_LENGTH,
     POINT(local.x), .low = -1e3, .high = 1e3, .is_required = true,
     .doc = "from the link's first joint towards its second"},
    {.path = "points.*.offset", .dimension = DIMENSION_LENGTH, POINT(local.y), .low = -1e3,
     .high = 1e3, .doc = "to the left of that direction"},
};

const SchemaGroup SCHEMA_GROUPS[] = {
    {"", "Keys that stand in no group."},
    {"four-bar", "The links. A length may carry a tolerance: 108 +- 0.3 mm, 108 +0.1/-0.2 mm."},
    {"joints", "Joints with play, by name: crank-coupler, coupler-follower, follower-ground. A "
               "joint not named is ideal; the drive joint ground-crank always is."},
    {"drive", "How the crank turns."},
    {"material", "Of pins and holes; steel where nothing is said."},
    {"contact", "What happens where pin and hole meet."},
    {"run", "How long, how fine, and on which solvers."},
    {"ode", "How the Open Dynamics Engine is used."},
    {"points", "Points of links whose path is written out, at most 4, by names of letters, "
               "digits, - and _."},
};
// clang-format on

const size_t SCHEMA_ROW_COUNT = sizeof SCHEMA_ROWS / sizeof SCHEMA_ROWS[0];
const size_t SCHEMA_GROUP_COUNT = sizeof SCHEMA_GROUPS / sizeof SCHEMA_GROUPS[0];
