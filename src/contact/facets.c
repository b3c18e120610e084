// Says how many flat sides stand for a round hole, and what is then wrong.
//
// Hole of radius R, pin of radius r, play c = R - r, eccentricity e, N sides. A side at distance a
// from the centre, its normal n at an angle t to e, overlaps the pin by
//     d = |e| cos t - (a - r),    |t| <= pi/N of the deepest side
// The circle's depth is |e| - c. Circumscribed (a = R) the polygon's error is |e| (1 - cos t), at
// most |e| (pi/N)^2 / 2: small, because |e| is about c and not R. Inscribed (a = R cos(pi/N)) the
// whole sagitta R (pi/N)^2 / 2 is taken from the play besides. Either way the normal is off by t,
// up to pi/N = sqrt(2 sagitta / R). The rule for N: sagitta <= SHARE min(c, depth expected).
#include "contact/facets.h"

#include "base/root.h"
#include "base/zeroed.h"
#include "contact/law.h"
#include "model/response.h"

#include <math.h>
#include <stdlib.h>

// sagitta over the smaller of play and depth: a hundredth, which inscribed polygons get wrong
static const double SHARE = 0.01;

// what is to be seen, over what a collider is sure to notice: depths are then right to a fifth
static const double RESOLVED = 5.0;

// of R: libccd asked by ode/plane/collider_staves.c, in units of R / 5000 with a tolerance of 1e-6
// of them. Portal refinement keeps to 1e-10, GJK and EPA to 1.1e-7 of R
static const double STAVES_SHARE = 2e-9;
static const double GJK_SHARE = 4e-7;

// vertices of a mesh are single precision inside ODE: half a unit in the last place, 2^-24 of a
// coordinate, two coordinates, and the same again for the pin's position
static const double TRIMESH_SHARE = 0x1p-22;

// m, the tolerance with which ODE calls libccd, whatever the size of the bodies
static const double ODE_TOLERANCE = 1e-6;

Facets facets_polygon(OdePolygon polygon, size_t count, double hole_radius)
{
    const double half = M_PI / (double)count;
    const double short_of = 2.0 * sin(0.5 * half) * sin(0.5 * half); // 1 - cos
    const bool is_inscribed = polygon == ODE_INSCRIBED;
    return (Facets){
        .count = count,
        .pitch = 2.0 * half,
        .inradius = is_inscribed ? hole_radius * cos(half) : hole_radius,
        .sagitta = hole_radius * short_of / (is_inscribed ? 1.0 : cos(half)),
    };
}

size_t facets_needed(double hole_radius, double sagitta)
{
    // sagitta = R (1 - cos(pi/N)) = 2 R sin^2(pi/2N)
    const double half = asin(fmin(1.0, sqrt(0.5 * sagitta / hole_radius)));
    const double count = ceil(0.5 * M_PI / half);
    return count <= FACETS_LEAST ? FACETS_LEAST : count < 1e9 ? (size_t)count : (size_t)1000000000;
}

double facets_resolution(OdeCollider collider, double hole_radius)
{
    switch (collider) {
    case ODE_COLLIDER_STAVES:
        return STAVES_SHARE * hole_radius;
    case ODE_COLLIDER_STAVES_GJK:
        return GJK_SHARE * hole_radius;
    case ODE_COLLIDER_CONVEX:
        return ODE_TOLERANCE;
    case ODE_COLLIDER_TRIMESH:
        return TRIMESH_SHARE * hole_radius;
    case ODE_COLLIDER_PIN_HOLE:
    case ODE_COLLIDER_COUNT:
        break;
    }
    return 0.0; // it is exact
}

typedef struct Impact {
    const ForceLaw *law;
    double energy; // J
} Impact;

static double energy_left(double depth, void *context)
{
    const Impact *impact = context;
    return impact->energy - force_law_energy(impact->law, depth);
}

// The least effective mass of a joint along x and y, kg; 0 where the linkage has none.
static double effective_mass(const Linkage *linkage, const Motion *motions, int joint)
{
    Response response;
    response_init(linkage, false, &response);
    if (!response_place(&response, motions)) {
        response_finish(&response);
        return 0.0;
    }
    size_t row = 0;
    while (row < response_play_rows(&response) && response_joint(&response, row) != joint) {
        row += 2;
    }
    const double least = fmin(response_mass(&response, row, (Vec2){1.0, 0.0}),
                              response_mass(&response, row, (Vec2){0.0, 1.0}));
    response_finish(&response);
    return least;
}

static const double DEPTH_FIRST_M = 1e-4; // doubled until it holds the energy

double facets_expected_depth(const Scenario *scenario, int joint)
{
    const Linkage *linkage = &scenario->linkage;
    const Joint *data = &linkage->joints[joint];
    ForceLaw law;
    Err unused = {ERR_NONE, ""};
    if (scenario->contact.model != CONTACT_IMPACT || !law_of_joint(scenario, data, &law, &unused)) {
        return 0.0;
    }
    Motion *motions = zeroed(linkage->body_count, sizeof *motions);
    linkage_start(linkage, motions);
    // the pin falls under gravity and what a point that the drive turns feels
    double pull = vec3_length(scenario->gravity);
    if (linkage->driver.is_present) {
        const Joint *driven = &linkage->joints[linkage->driver.joint];
        const Vec2 axis = linkage_point(motions, driven->body_a, driven->anchor_a);
        const Vec2 there = linkage_point(motions, data->body_a, data->anchor_a);
        const double speed = linkage->driver.speed;
        pull += speed * speed * vec2_length(vec2_sub(there, axis));
    }
    const double start = vec2_length(linkage_joint_gap(linkage, motions, joint).velocity);
    const double square = start * start + 4.0 * pull * linkage_radial_clearance(data);
    Impact impact = {&law, 0.5 * effective_mass(linkage, motions, joint) * square};
    free(motions);
    double depth = law_depth_max(&law, data);
    if (isinf(depth)) {
        for (depth = DEPTH_FIRST_M; energy_left(depth, &impact) > 0.0; depth *= 2.0) {
        }
    }
    root_find(energy_left, &impact, 0.0, depth, 1e-6 * depth, &depth);
    return impact.energy > 0.0 ? depth : 0.0;
}

// The smaller of a joint's play and the depth to be expected, m.
static double least_length(const Scenario *scenario, int joint, bool *is_depth)
{
    const double play = linkage_radial_clearance(&scenario->linkage.joints[joint]);
    const double depth = facets_expected_depth(scenario, joint);
    *is_depth = depth > 0.0 && depth < play;
    return *is_depth ? depth : play;
}

Facets facets_of_joint(const Scenario *scenario, int joint)
{
    const OdeOptions *ode = &scenario->ode;
    const double radius = scenario->linkage.joints[joint].clearance.hole_radius;
    bool is_depth;
    const size_t count =
        ode->facets > 0 ? ode->facets
                        : facets_needed(radius, SHARE * least_length(scenario, joint, &is_depth));
    return facets_polygon(ode->polygon, count, radius);
}

bool facets_check(const Scenario *scenario, int joint, Err *err)
{
    const OdeOptions *ode = &scenario->ode;
    const Joint *data = &scenario->linkage.joints[joint];
    const char *word = OPTIONS_ODE_COLLIDERS[ode->collider];
    if (ode->collider == ODE_COLLIDER_PIN_HOLE) {
        return true;
    }
    bool is_depth;
    const double least = least_length(scenario, joint, &is_depth);
    const char *what = is_depth ? "depths" : "a radial play";
    const double resolution = facets_resolution(ode->collider, data->clearance.hole_radius);
    if (!(least >= RESOLVED * resolution)) {
        return err_set(err, ERR_CASE,
                       "collider %s resolves %.3g um; joint %s, with %s of %.3g um, needs %.3g um",
                       word, 1e6 * resolution, data->name, what, 1e6 * least,
                       1e6 * least / RESOLVED);
    }
    const Facets facets = facets_of_joint(scenario, joint);
    if (facets.count > FACETS_MOST) {
        return err_set(err, ERR_CASE,
                       "collider %s needs %zu facets for joint %s, with %s of %.3g um; it has at "
                       "most %d",
                       word, facets.count, data->name, what, 1e6 * least, FACETS_MOST);
    }
    return facets.inradius > data->clearance.pin_radius ||
           err_set(err, ERR_CASE,
                   "the pin of joint %s does not fit into an inscribed polygon of %zu facets, "
                   "which takes %.3g um of the %.3g um of play",
                   data->name, facets.count, 1e6 * facets.sagitta,
                   1e6 * linkage_radial_clearance(data));
}
