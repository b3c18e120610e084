// Makes a linkage that moves at time zero of the lengths of a slider-crank.
//
// Frames: origin at mid-link, which is the centre of mass; x along the link from its first joint to
// its second. Crank: ground pivot to crank pin. Rod: crank pin to slider. The slider's frame is at
// its pin, with x along its line.
#include "casefile/slider.h"

#include "casefile/build.h"

#include <math.h>

typedef enum BodyNumber { CRANK, ROD, SLIDER } BodyNumber;

// Relative: as close as this to a dead centre, the accelerations are those of rounding errors.
static const double MARGIN = 1e-9;

static const double DEGREE = M_PI / 180.0;

// Where a message points: at the first of these that overrides the case, else at the first given.
#define BLAMED "slider-crank.rod.length slider-crank.crank.length slider-crank.offset"

double slider_centre(const SliderCrank *mechanism, int body)
{
    return body == CRANK ? 0.5 * mechanism->crank : body == ROD ? 0.5 * mechanism->rod : 0.0;
}

// What all joints together give way, m.
static double total_play(const Linkage *linkage)
{
    double play = 0.0;
    for (size_t i = 0; i < linkage->joint_count; i++) {
        play += linkage_radial_clearance(&linkage->joints[i]);
    }
    return play;
}

static bool check_start(const Entries *entries, const Scenario *scenario, Err *err)
{
    const SliderCrank *mechanism = &scenario->slidercrank;
    const double start = scenario->linkage.driver.start;
    const double rise = slidercrank_rise(mechanism, start);
    return rise < mechanism->rod * (1.0 - MARGIN) ||
           entries_refuse(entries_blame(entries, BLAMED, 0), err,
                          "the mechanism does not close at the start, %.4g deg: the crank pin is "
                          "%.6g mm from the slider's line, and the rod %.6g mm long\nallowed: a "
                          "rod above %.6g mm, or another start",
                          start / DEGREE, 1e3 * rise, 1e3 * mechanism->rod, 1e3 * rise);
}

bool slider_check(const Entries *entries, const Scenario *scenario, Err *err)
{
    const SliderCrank *mechanism = &scenario->slidercrank;
    const Driver *driver = &scenario->linkage.driver;
    if (!check_start(entries, scenario, err)) {
        return false;
    }
    const double direction = driver->speed < 0.0 ? -1.0 : 1.0;
    const double turns = scenario->run.revolutions;
    // play may be enough to let the crank pass: then the run shows whether it does
    const double reach = mechanism->rod + total_play(&scenario->linkage);
    if (!(slidercrank_travel(mechanism, reach, driver->start, direction) <= 2.0 * M_PI * turns)) {
        return true;
    }
    const double travel = slidercrank_travel(mechanism, mechanism->rod, driver->start, direction);
    return entries_refuse(
        entries_blame(entries, BLAMED " run.revolutions", 0), err,
        "the crank cannot turn through the run: from %.4g deg it reaches a dead centre at %.4g "
        "deg, where the rod stands across the slider's line\nallowed: less than %.4g revolutions, "
        "or a rod longer than crank and offset together, %.6g mm",
        driver->start / DEGREE, (driver->start + direction * travel) / DEGREE,
        travel / (2.0 * M_PI), 1e3 * (mechanism->crank + fabs(mechanism->offset)));
}

static void place_joints(const SliderCrank *mechanism, Linkage *linkage)
{
    const Vec2 across = vec2_perp(vec2_rotate(mechanism->line, (Vec2){1.0, 0.0}));
    const Vec2 crank = {slider_centre(mechanism, CRANK), 0.0};
    const Vec2 rod = {slider_centre(mechanism, ROD), 0.0};
    const Vec2 middle = {0.0, 0.0};
    Joint *joints = linkage->joints;
    build_place_joint(&joints[0], LINKAGE_GROUND, middle, CRANK, vec2_scale(-1.0, crank));
    build_place_joint(&joints[1], CRANK, crank, ROD, vec2_scale(-1.0, rod));
    build_place_joint(&joints[2], ROD, rod, SLIDER, middle);
    build_place_joint(&joints[3], LINKAGE_GROUND, vec2_scale(mechanism->offset, across), SLIDER,
                      middle);
    joints[3].direction = mechanism->line;
    joints[3].held_angle = mechanism->line;
    linkage->driver.joint = 0;
}

// Where the bodies are with every joint centred: the start itself, or a guess of it.
static void guess_positions(const SliderCrank *mechanism, double crank_angle, Motion *motions)
{
    const Vec2 along = vec2_rotate(mechanism->line, (Vec2){1.0, 0.0});
    const Vec2 pin = vec2_rotate(crank_angle, (Vec2){mechanism->crank, 0.0});
    const double rise = mechanism->offset - vec2_dot(vec2_perp(along), pin);
    const double reach = sqrt((mechanism->rod - rise) * (mechanism->rod + rise));
    const double ahead = mechanism->side == SLIDER_RIGHT ? reach : -reach;
    const Vec2 rod = vec2_add(vec2_scale(ahead, along), vec2_scale(rise, vec2_perp(along)));
    motions[CRANK] = (Motion){.position = vec2_scale(0.5, pin), .angle = crank_angle};
    motions[ROD] =
        (Motion){.position = vec2_add(pin, vec2_scale(0.5, rod)), .angle = atan2(rod.y, rod.x)};
    motions[SLIDER] = (Motion){.position = vec2_add(pin, rod), .angle = mechanism->line};
}

bool slider_build(Scenario *scenario, Err *err)
{
    const SliderCrank *mechanism = &scenario->slidercrank;
    Linkage *linkage = &scenario->linkage;
    place_joints(mechanism, linkage);
    scenario->has_slidercrank = true;
    for (size_t i = 0; i < scenario->point_count; i++) {
        TracedPoint *point = &scenario->points[i];
        point->local.x -= slider_centre(mechanism, point->body);
    }
    Motion motions[SLIDER + 1] = {0};
    guess_positions(mechanism, linkage->driver.start, motions);
    return build_start(linkage, motions, err);
}
