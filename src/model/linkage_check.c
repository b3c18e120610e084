// Checks that what a linkage is made of is a linkage.
#include "model/bushing.h"
#include "model/coordinate.h"

#include <assert.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

static bool check_bodies(const Linkage *linkage, Err *err)
{
    for (size_t i = 0; i < linkage->body_count; i++) {
        const Body *body = &linkage->bodies[i];
        if (!(body->mass > 0.0) || !isfinite(body->mass)) {
            return err_set(err, ERR_CASE, "body '%s': mass %g kg, allowed: above 0", body->name,
                           body->mass);
        }
        if (!(body->inertia > 0.0) || !isfinite(body->inertia)) {
            return err_set(err, ERR_CASE, "body '%s': inertia %g kg m^2, allowed: above 0",
                           body->name, body->inertia);
        }
    }
    return true;
}

static bool check_pin(const Joint *joint, Err *err)
{
    const Clearance *clearance = &joint->clearance;
    if (!(clearance->pin_radius > 0.0) || !(clearance->hole_radius > clearance->pin_radius)) {
        return err_set(err, ERR_CASE,
                       "joint '%s': pin radius %.9g m and hole radius %.9g m, allowed: a pin above "
                       "0 and smaller than its hole",
                       joint->name, clearance->pin_radius, clearance->hole_radius);
    }
    if (!linkage_starts_touching(joint) &&
        !(vec2_length(clearance->start) <= linkage_radial_clearance(joint))) {
        return err_set(err, ERR_CASE,
                       "joint '%s': start eccentricity %.9g m, allowed: up to the radial "
                       "clearance %.9g m",
                       joint->name, vec2_length(clearance->start), linkage_radial_clearance(joint));
    }
    return true;
}

static bool check_guide(const Joint *joint, Err *err)
{
    const Guide *guide = &joint->guide;
    if (!(guide->opening > 0.0) || !(guide->height > 0.0) || guide->opening == guide->height ||
        !(guide->length > 0.0) || !isfinite(guide->opening + guide->height + guide->length)) {
        return err_set(err, ERR_CASE,
                       "joint '%s': guide %.9g m, block %.9g m and its length %.9g m, allowed: all "
                       "above 0, and a block that is not as high as the guide is wide",
                       joint->name, guide->opening, guide->height, guide->length);
    }
    const double gap = linkage_guide_gap(guide, guide->start.x, guide->start.y);
    if (!linkage_starts_touching(joint) &&
        !(gap >= -LINKAGE_SEATED * linkage_radial_clearance(joint))) {
        return err_set(err, ERR_CASE, "joint '%s': the block starts %.9g m inside the metal",
                       joint->name, -gap);
    }
    return true;
}

static bool check_cam(const Linkage *linkage, const Joint *joint, Err *err)
{
    const Stop *stop = &joint->stop;
    if (stop->cam > linkage->profile_count) {
        return err_set(err, ERR_CASE, "joint '%s': the profile of its cam does not exist",
                       joint->name);
    }
    const double hollow = linkage_profile(linkage, joint)->least_hollow;
    return (stop->radius_b >= 0.0 && (stop->is_flat ? stop->radius_b == 0.0 && !isfinite(hollow)
                                                    : stop->radius_b < hollow)) ||
           err_set(
               err, ERR_CASE,
               "joint '%s': a roller of %.9g m on a profile whose hollow has %.9g m, allowed: a "
               "smaller one, and a flat on a convex profile",
               joint->name, stop->radius_b, hollow);
}

static bool check_slot(const Joint *joint, Err *err)
{
    const Stop *stop = &joint->stop;
    return (isfinite(stop->slot) && stop->radius_b >= 0.0 && stop->radius_a > stop->radius_b &&
            isfinite(stop->radius_a)) ||
           err_set(err, ERR_CASE,
                   "joint '%s': pin radius %.9g m in a slot of width %.9g m, allowed: a pin that "
                   "is narrower than its slot",
                   joint->name, stop->radius_b, 2.0 * stop->radius_a);
}

static bool check_stop(const Linkage *linkage, const Joint *joint, Err *err)
{
    const Stop *stop = &joint->stop;
    if (stop->cam > 0) {
        return check_cam(linkage, joint, err);
    }
    if (stop->slot > 0.0) {
        return check_slot(joint, err);
    }
    const double size = stop->radius_b + (stop->is_disc ? stop->radius_a : 0.0);
    return (stop->radius_a >= 0.0 && stop->radius_b >= 0.0 && isfinite(size) &&
            (!stop->is_disc || size > 0.0)) ||
           err_set(err, ERR_CASE,
                   "joint '%s': discs of radius %.9g m and %.9g m, allowed: 0 or more, and one of "
                   "two discs above 0",
                   joint->name, stop->radius_a, stop->radius_b);
}

static bool check_own_contact(const Joint *joint, Err *err)
{
    const JointContact *own = &joint->contact;
    const bool is_stiffness =
        own->stiffness == 0.0 || (own->stiffness > 0.0 && own->exponent > 0.0);
    return (is_stiffness && own->restitution >= 0.0 && own->restitution <= 1.0) ||
           err_set(err, ERR_CASE,
                   "joint '%s': stiffness %g and restitution %g of its own, allowed: above 0, and "
                   "0 to 1",
                   joint->name, own->stiffness, own->restitution);
}

static bool check_limits(const Linkage *linkage, const Joint *joint, Err *err)
{
    const Limits *limits = &joint->limits;
    if (limits->kind == LIMIT_NONE) {
        return true;
    }
    if (linkage->is_spatial && !joint_is_spatial(joint->kind)) {
        return err_set(err, ERR_CASE,
                       "joint '%s': backlash and stops of sliders, and gears, are for the plane",
                       joint->name);
    }
    const double low = coordinate_low(joint);
    const double high = coordinate_high(joint);
    if (!(low <= high) || !(isfinite(low) || isfinite(high))) {
        return err_set(err, ERR_CASE,
                       "joint '%s': limits %.9g and %.9g, allowed: one that is finite, and the "
                       "first no higher than the second",
                       joint->name, low, high);
    }
    return joint->contact.stiffness > 0.0 || !joint_has_angle(joint->kind) ||
           err_set(err, ERR_CASE, "joint '%s': its limits need a torsional stiffness", joint->name);
}

// A joint that says where teeth are; NULL where there is none of the number.
static const Joint *guide_of_teeth(const Linkage *linkage, const Joint *joint, int side)
{
    const int number = joint->gear.pivots[side];
    return number < 0 || number >= (int)linkage->joint_count ? NULL : &linkage->joints[number];
}

static bool check_rack(const Linkage *linkage, const Joint *joint, Err *err)
{
    const Joint *guide = guide_of_teeth(linkage, joint, 0);
    const Joint *pivot = guide_of_teeth(linkage, joint, 1);
    const double radius = joint->gear.radius_b;
    if (guide == NULL || pivot == NULL || !joint_slides(guide->kind) ||
        !joint_pivots(pivot->kind)) {
        return err_set(err, ERR_CASE, "joint '%s': a rack slides, and its pinion turns on a pivot",
                       joint->name);
    }
    return (radius != 0.0 && isfinite(radius)) ||
           err_set(err, ERR_CASE, "joint '%s': pitch radius %.9g m, allowed: any but 0",
                   joint->name, radius);
}

static bool check_gear(const Linkage *linkage, const Joint *joint, Err *err)
{
    const Gear *gear = &joint->gear;
    if (joint_has_rack(joint->kind)) {
        return check_rack(linkage, joint, err);
    }
    for (int i = 0; i < 2; i++) {
        const Joint *pivot = guide_of_teeth(linkage, joint, i);
        if (pivot == NULL || !joint_pivots(pivot->kind)) {
            return err_set(err, ERR_CASE, "joint '%s': its gears need pivots", joint->name);
        }
        if (!joint_is_ideal(pivot->kind) && gear->pressure_angle == 0.0) {
            return err_set(err, ERR_CASE,
                           "joint '%s': gears whose pivots have play need a pressure angle",
                           joint->name);
        }
    }
    if (!(gear->pressure_angle >= 0.0 && gear->pressure_angle < 0.5 * M_PI)) {
        return err_set(err, ERR_CASE,
                       "joint '%s': pressure angle %.9g rad, allowed: 0 to below 1.57", joint->name,
                       gear->pressure_angle);
    }
    const double distance = gear->radius_a + gear->radius_b;
    return (distance > 0.0 && isfinite(distance)) ||
           err_set(err, ERR_CASE,
                   "joint '%s': pitch radii %.9g m and %.9g m, allowed: together above 0",
                   joint->name, gear->radius_a, gear->radius_b);
}

static bool check_joint(const Linkage *linkage, size_t number, Err *err)
{
    const Joint *joint = &linkage->joints[number];
    const int count = (int)linkage->body_count;
    if (joint->body_a < LINKAGE_GROUND || joint->body_a >= count ||
        joint->body_b < LINKAGE_GROUND || joint->body_b >= count ||
        joint->body_a == joint->body_b) {
        return err_set(err, ERR_CASE, "joint '%s' must join two different bodies of the linkage",
                       joint->name);
    }
    if (!isfinite(joint->direction + joint->held_angle)) {
        return err_set(err, ERR_CASE, "joint '%s': its direction is no number", joint->name);
    }
    if (linkage->is_spatial && !joint_is_spatial(joint->kind)) {
        return err_set(err, ERR_CASE, "joint '%s': guides, stops and gears are for the plane",
                       joint->name);
    }
    if (!check_limits(linkage, joint, err)) {
        return false;
    }
    switch (joint_touches(joint->kind)) {
    case JOINT_TOUCHES_HOLE:
        return check_pin(joint, err) && check_own_contact(joint, err);
    case JOINT_TOUCHES_GUIDES:
        return check_guide(joint, err) && check_own_contact(joint, err);
    case JOINT_TOUCHES_DISC:
        return check_stop(linkage, joint, err) && check_own_contact(joint, err);
    case JOINT_TOUCHES_TEETH:
        return check_gear(linkage, joint, err) && check_own_contact(joint, err);
    case JOINT_TOUCHES_NOTHING:
        break;
    }
    return joint->limits.kind == LIMIT_NONE || check_own_contact(joint, err);
}

static bool check_driver(const Linkage *linkage, size_t number, Err *err)
{
    const Driver *driver = linkage_drive(linkage, number);
    if (driver->joint < 0 || driver->joint >= (int)linkage->joint_count) {
        return err_set(err, ERR_CASE, "the driver's joint does not exist");
    }
    const Joint *joint = &linkage->joints[driver->joint];
    if (!joint_has_angle(joint->kind) || joint->body_a != LINKAGE_GROUND) {
        return err_set(err, ERR_CASE,
                       "the driver turns a body about joint '%s', which must be an ideal joint "
                       "with the ground",
                       joint->name);
    }
    if (linkage_drive_of_body(linkage, joint->body_b) != (int)number) {
        return err_set(err, ERR_CASE, "two drives turn one body, at joint '%s'", joint->name);
    }
    const bool may_stand = number > 0 || drive_is_held(driver);
    if ((!may_stand && !(driver->speed != 0.0)) || !isfinite(driver->speed) ||
        !isfinite(driver->start)) {
        return err_set(err, ERR_CASE, "drive speed %g rad/s, allowed: any speed but 0",
                       driver->speed);
    }
    Driver completed = *driver;
    drive_complete(&completed);
    if (driver->speed != completed.speed) {
        return err_set(err, ERR_CASE, "drive speed %g rad/s is not the largest of its table",
                       driver->speed);
    }
    return time_table_is_ordered(&driver->table) ||
           err_set(err, ERR_CASE, "the times of a speed must increase, within its period");
}

static bool check_drivers(const Linkage *linkage, Err *err)
{
    const size_t count = linkage_drive_count(linkage);
    if (count > LINKAGE_DRIVE_MAX) {
        return err_set(err, ERR_CASE, "%zu drives, allowed: at most %d", count, LINKAGE_DRIVE_MAX);
    }
    for (size_t i = 0; i < count; i++) {
        if (!check_driver(linkage, i, err)) {
            return false;
        }
    }
    return true;
}

static bool check_springs(const Linkage *linkage, Err *err)
{
    const int count = (int)linkage->body_count;
    for (size_t i = 0; i < linkage->spring_count; i++) {
        const Spring *spring = &linkage->springs[i];
        if (spring->body_a < LINKAGE_GROUND || spring->body_a >= count ||
            spring->body_b < LINKAGE_GROUND || spring->body_b >= count ||
            spring->body_a == spring->body_b) {
            return err_set(err, ERR_CASE,
                           "spring '%s' must join two different bodies of the linkage",
                           spring->name);
        }
        if (!isfinite(spring->stiffness + spring->length) || !(spring->damping >= 0.0)) {
            return err_set(err, ERR_CASE, "spring '%s' has a number that is out of range",
                           spring->name);
        }
    }
    for (size_t i = 0; i < linkage->torsion_count; i++) {
        const TorsionSpring *spring = &linkage->torsions[i];
        if (spring->joint < 0 || spring->joint >= (int)linkage->joint_count ||
            !isfinite(spring->stiffness + spring->angle) || !(spring->damping >= 0.0)) {
            return err_set(err, ERR_CASE, "torsion spring '%s' needs a joint and finite numbers",
                           spring->name);
        }
    }
    return true;
}

static bool check_bushing(const Linkage *linkage, const Bushing *bushing, Err *err)
{
    const int count = (int)linkage->body_count;
    if (bushing->body_a < LINKAGE_GROUND || bushing->body_a >= count ||
        bushing->body_b < LINKAGE_GROUND || bushing->body_b >= count ||
        bushing->body_a == bushing->body_b) {
        return err_set(err, ERR_CASE, "bushing '%s' must join two different bodies of the linkage",
                       bushing->name);
    }
    bool is_good = isfinite(bushing->stiffness.x + bushing->stiffness.y + bushing->direction +
                            bushing->torsional_stiffness + bushing->angle);
    for (size_t row = 0; row < BUSHING_ROWS; row++) {
        const ForceCurve *curve = bushing_curve(bushing, row);
        is_good = is_good && bushing_damping(bushing, row) >= 0.0 && curve->count != 1 &&
                  isfinite(force_curve_steepest(curve));
    }
    return is_good ||
           err_set(err, ERR_CASE, "bushing '%s' has a number that is out of range", bushing->name);
}

static bool check_bushings(const Linkage *linkage, Err *err)
{
    bool is_good = true;
    for (size_t i = 0; is_good && i < linkage->bushing_count; i++) {
        is_good = check_bushing(linkage, &linkage->bushings[i], err);
    }
    return is_good;
}

static bool check_loads(const Linkage *linkage, Err *err)
{
    for (size_t i = 0; i < linkage->load_count; i++) {
        const Load *load = &linkage->loads[i];
        const bool is_along = load->kind == LOAD_ALONG;
        const int number = is_along ? load->joint : load->body;
        const size_t count = is_along ? linkage->joint_count : linkage->body_count;
        if (number < 0 || number >= (int)count || load->table.count == 0 ||
            !load_table_is_ordered(&load->table)) {
            return err_set(err, ERR_CASE, "load '%s' needs a body or joint, and points in order",
                           load->name);
        }
    }
    return true;
}

static bool check_torque(const Linkage *linkage, Err *err)
{
    const Torque *torque = &linkage->torque;
    if (torque->table.count > 0 &&
        (torque->joint < 0 || torque->joint >= (int)linkage->joint_count)) {
        return err_set(err, ERR_CASE, "the joint of the torque does not exist");
    }
    return time_table_is_ordered(&torque->table) ||
           err_set(err, ERR_CASE, "the times of a torque must increase");
}

static int compare_names(const void *a, const void *b)
{
    return strcmp(*(const char *const *)a, *(const char *const *)b);
}

// Whether every name, of so many that stand so many bytes apart, is another one.
static bool check_names(const char *first, size_t count, size_t apart, const char *what, Err *err)
{
    const char **names = malloc((count + 1) * sizeof *names);
    assert(names != NULL);
    for (size_t i = 0; i < count; i++) {
        names[i] = first + i * apart;
    }
    qsort(names, count, sizeof *names, compare_names);
    const char *doubled = NULL;
    for (size_t i = 1; i < count && doubled == NULL; i++) {
        doubled = strcmp(names[i - 1], names[i]) == 0 ? names[i] : NULL;
    }
    free(names);
    return doubled == NULL || err_set(err, ERR_CASE, "two %s are named '%s'", what, doubled);
}

bool linkage_check(const Linkage *linkage, Err *err)
{
    if (linkage->body_count == 0) {
        return err_set(err, ERR_CASE, "no bodies, allowed: 1 or more");
    }
    if (!check_bodies(linkage, err) ||
        !check_names(linkage->bodies[0].name, linkage->body_count, sizeof *linkage->bodies,
                     "bodies", err) ||
        (linkage->joint_count > 0 && !check_names(linkage->joints[0].name, linkage->joint_count,
                                                  sizeof *linkage->joints, "joints", err))) {
        return false;
    }
    for (size_t i = 0; i < linkage->joint_count; i++) {
        if (!check_joint(linkage, i, err)) {
            return false;
        }
    }
    return check_springs(linkage, err) && check_bushings(linkage, err) &&
           check_drivers(linkage, err) && check_torque(linkage, err) && check_loads(linkage, err);
}
