// Rounds every number of a scenario once more.
//
// Each number x becomes x - ulp, x or x + ulp with equal chance. Where a length stands twice in a
// scenario, as that of a link does in the four-bar and in its anchors, the two are moved apart: by
// what rounding does when one is worked out from the other.
#include "model/shake.h"

#include "base/lcg.h"

#include <math.h>

static void shake(double *value, uint64_t *seed)
{
    const double drawn = lcg_draw(seed);
    if (*value != 0.0 && fabs(drawn) > 1.0 / 3.0) {
        *value = nextafter(*value, copysign(INFINITY, drawn));
    }
}

static void shake_vector(Vec2 *vector, uint64_t *seed)
{
    shake(&vector->x, seed);
    shake(&vector->y, seed);
}

static void shake_body_space(BodySpace *space, uint64_t *seed)
{
    shake(&space->inertia_x, seed);
    shake(&space->inertia_y, seed);
    shake(&space->product_xy, seed);
    shake(&space->product_xz, seed);
    shake(&space->product_yz, seed);
    shake(&space->height, seed);
    shake(&space->velocity_z, seed);
    shake(&space->omega_x, seed);
    shake(&space->omega_y, seed);
}

static void shake_joint_space(JointSpace *space, uint64_t *seed)
{
    shake(&space->height, seed);
    shake(&space->axis.x, seed);
    shake(&space->axis.y, seed);
    shake(&space->axial_clearance, seed);
}

static void shake_body(Body *body, uint64_t *seed)
{
    shake(&body->mass, seed);
    shake(&body->inertia, seed);
    shake_vector(&body->start.position, seed);
    shake(&body->start.angle, seed);
    shake_vector(&body->start.velocity, seed);
    shake(&body->start.omega, seed);
}

// What a joint has beside where it slides or stops, or has a contact of its own, with a stiffness
// that counts.
static void shake_sliding(Joint *joint, bool has_own, uint64_t *seed)
{
    if (!joint_pivots(joint->kind)) {
        shake(&joint->direction, seed);
        shake(&joint->held_angle, seed);
        shake(&joint->guide.opening, seed);
        shake(&joint->guide.height, seed);
        shake(&joint->guide.length, seed);
        shake_vector(&joint->guide.start, seed);
        shake(&joint->stop.radius_a, seed);
        shake(&joint->stop.radius_b, seed);
        if (joint->stop.slot > 0.0) {
            shake(&joint->stop.slot, seed);
        }
    }
    if (joint->contact.stiffness > 0.0 && (has_own || linkage_is_torsional(joint))) {
        shake(&joint->contact.stiffness, seed);
    }
    shake(&joint->contact.viscous, seed);
    if (joint->contact.gap_damping > 0.0) {
        shake(&joint->contact.gap_damping, seed);
    }
    if (joint->contact.full_depth > 0.0) {
        shake(&joint->contact.full_depth, seed);
    }
    if (joint->contact.dissipation > 0.0) {
        shake(&joint->contact.dissipation, seed);
    }
    if (joint->contact.has_restitution) {
        shake(&joint->contact.restitution, seed);
        joint->contact.restitution = fmin(joint->contact.restitution, 1.0);
    }
    if (joint->contact.has_friction) {
        shake(&joint->contact.friction, seed);
    }
}

// The ends of a limited coordinate, and what a pair of gears is made of. The teeth's ratio and the
// distance of the pivots stay: they say where the pitch circles are.
static void shake_limits(Joint *joint, uint64_t *seed)
{
    Limits *limits = &joint->limits;
    if (joint->gear.pressure_angle > 0.0) {
        shake(&joint->gear.pressure_angle, seed);
    }
    if (limits->kind == LIMIT_BACKLASH) {
        shake(&limits->backlash, seed);
        shake(&limits->middle, seed);
    } else if (limits->kind == LIMIT_STOPS) {
        double *const ends[2] = {&limits->low, &limits->high};
        for (int i = 0; i < 2; i++) {
            if (isfinite(*ends[i])) {
                shake(ends[i], seed);
            }
        }
    }
}

// What most pins do not say of their eye; then nothing is drawn for it.
static void shake_eye(Clearance *clearance, uint64_t *seed)
{
    double *const numbers[] = {&clearance->eye_radius, &clearance->modulus[0],
                               &clearance->modulus[1], &clearance->poisson[0],
                               &clearance->poisson[1]};
    for (size_t i = 0; i < sizeof numbers / sizeof *numbers; i++) {
        if (*numbers[i] > 0.0) {
            shake(numbers[i], seed);
        }
    }
}

// What an ideal joint says of its friction.
static void shake_friction(JointFriction *friction, uint64_t *seed)
{
    double *const numbers[] = {&friction->steady, &friction->radius,     &friction->length,
                               &friction->speed,  &friction->presliding, &friction->damping};
    for (size_t i = 0; i < sizeof numbers / sizeof *numbers; i++) {
        if (*numbers[i] > 0.0) {
            shake(numbers[i], seed);
        }
    }
    if (friction->ratio > 0.0) {
        shake(&friction->ratio, seed);
        friction->ratio = fmax(friction->ratio, 1.0);
    }
}

static void shake_joint(Joint *joint, bool has_own, uint64_t *seed)
{
    shake_vector(&joint->anchor_a, seed);
    shake_vector(&joint->anchor_b, seed);
    shake(&joint->clearance.hole_radius, seed);
    shake(&joint->clearance.pin_radius, seed);
    shake(&joint->clearance.width, seed);
    shake_eye(&joint->clearance, seed);
    shake_vector(&joint->clearance.start, seed);
    shake_sliding(joint, has_own, seed);
    shake_limits(joint, seed);
    shake_friction(&joint->friction, seed);
}

// The amplitude of a sinusoid; most cases have none, and nothing is drawn for it. Its frequency
// says what period a motion has, and is exact.
static void shake_wave(Wave *wave, uint64_t *seed)
{
    if (wave_exists(wave)) {
        shake(&wave->amplitude, seed);
    }
}

static void shake_torque(Torque *torque, uint64_t *seed)
{
    shake(&torque->table.values[0], seed); // of a motor the torque at rest
    for (size_t i = 1; i < torque->table.count; i++) {
        shake(&torque->table.values[i], seed);
    }
    shake_wave(&torque->table.wave, seed);
    shake(&torque->no_load, seed);
    shake(&torque->inertia, seed);
    shake(&torque->stiffness, seed);
    shake(&torque->slope, seed);
    if (torque->limit > 0.0) {
        shake(&torque->limit, seed);
    }
    if (torque->no_load != 0.0) {
        torque->slope = torque->table.values[0] / torque->no_load;
    }
}

// The values of a table; angles that turn it by whole turns still do.
static void shake_drive(Driver *driver, uint64_t *seed)
{
    for (size_t i = 0; i < driver->table.count; i++) {
        shake(&driver->table.values[i], seed);
    }
    shake_wave(&driver->table.wave, seed);
    drive_complete(driver);
}

// The points' values; where a bushing has none of a number nothing is drawn for it.
static void shake_curve(ForceCurve *curve, ForceCurveShape shape, uint64_t *seed)
{
    for (size_t i = 0; i < curve->count; i++) {
        shake(&curve->values[i], seed);
    }
    force_curve_settle(curve, shape);
}

static void shake_bushing(Bushing *bushing, uint64_t *seed)
{
    double *const numbers[] = {
        &bushing->direction,           &bushing->angle,
        &bushing->stiffness.x,         &bushing->stiffness.y,
        &bushing->damping.x,           &bushing->damping.y,
        &bushing->torsional_stiffness, &bushing->torsional_damping,
    };
    shake_vector(&bushing->anchor_a, seed);
    shake_vector(&bushing->anchor_b, seed);
    for (size_t i = 0; i < sizeof numbers / sizeof *numbers; i++) {
        if (*numbers[i] != 0.0) {
            shake(numbers[i], seed);
        }
    }
    shake_curve(&bushing->force_x, bushing->interpolation, seed);
    shake_curve(&bushing->force_y, bushing->interpolation, seed);
    shake_curve(&bushing->torque, bushing->interpolation, seed);
}

static void shake_forces(Linkage *linkage, uint64_t *seed)
{
    for (size_t i = 0; i < linkage->spring_count; i++) {
        Spring *spring = &linkage->springs[i];
        shake_vector(&spring->anchor_a, seed);
        shake_vector(&spring->anchor_b, seed);
        shake(&spring->stiffness, seed);
        shake(&spring->length, seed);
        shake(&spring->damping, seed);
    }
    for (size_t i = 0; i < linkage->torsion_count; i++) {
        shake(&linkage->torsions[i].stiffness, seed);
        shake(&linkage->torsions[i].angle, seed);
        shake(&linkage->torsions[i].damping, seed);
    }
    for (size_t i = 0; i < linkage->bushing_count; i++) {
        shake_bushing(&linkage->bushings[i], seed);
    }
    shake_torque(&linkage->torque, seed);
    for (size_t i = 0; i < linkage->load_count; i++) {
        LoadTable *table = &linkage->loads[i].table;
        // its area is in the values already
        for (size_t k = 0; k < table->count; k++) {
            shake(&table->values[k], seed);
        }
        shake_wave(&table->wave, seed);
        load_table_settle(table);
    }
    shake_drive(&linkage->driver, seed);
    for (size_t i = 0; i < linkage->further_count; i++) {
        shake(&linkage->further[i].speed, seed);
        shake(&linkage->further[i].start, seed);
        shake_drive(&linkage->further[i], seed);
    }
}

static void shake_world(Scenario *scenario, uint64_t *seed)
{
    double downward = 0.0 - scenario->gravity.y; // as the case file has it
    double *const values[] = {
        &scenario->fourbar.ground.nominal,
        &scenario->fourbar.crank.nominal,
        &scenario->fourbar.coupler.nominal,
        &scenario->fourbar.follower.nominal,
        &scenario->linkage.driver.speed,
        &scenario->linkage.driver.start,
        &downward,
        &scenario->material.youngs_modulus,
        &scenario->material.poisson_ratio,
        &scenario->contact.stiffness,
        &scenario->contact.viscous_coefficient,
        &scenario->contact.restitution,
        &scenario->contact.friction,
        &scenario->contact.friction_speed,
        &scenario->contact.impact_speed_floor,
        &scenario->contact.resting_speed,
        &scenario->contact.dissipation,
        &scenario->contact.restitution_speed,
        &scenario->contact.penalty,
        &scenario->contact.bounce_speed,
        &scenario->run.step,
        &scenario->ode.erp,
        &scenario->ode.cfm,
        &scenario->ode.push_out,
        &scenario->ode.over_relaxation,
        &scenario->ode.contact_phase,
        &scenario->slidercrank.crank,
        &scenario->slidercrank.rod,
        &scenario->slidercrank.offset,
        &scenario->slidercrank.line,
        &scenario->gravity.x,
        &scenario->gravity.z,
    };
    for (size_t i = 0; i < sizeof values / sizeof values[0]; i++) {
        shake(values[i], seed);
    }
    if (scenario->contact.full_damping_depth > 0.0) {
        shake(&scenario->contact.full_damping_depth, seed);
    }
    if (scenario->contact.friction_law != BRISTLE_REGULARIZED) {
        shake(&scenario->contact.breakaway_ratio, seed);
        scenario->contact.breakaway_ratio = fmax(scenario->contact.breakaway_ratio, 1.0);
        shake(&scenario->contact.presliding, seed);
        shake(&scenario->contact.presliding_damping, seed);
    }
    scenario->gravity.y = -downward;
    // more than everything no contact gives back
    scenario->contact.restitution = fmin(scenario->contact.restitution, 1.0);
}

// The curve goes through the points as they are then.
static void shake_profile(Profile *profile, uint64_t *seed)
{
    Err unused;
    for (size_t i = 0; i < profile->count; i++) {
        shake(&profile->radii[i], seed);
    }
    profile_settle(profile, &unused);
}

void shake_inputs(Scenario *scenario, unsigned seed)
{
    uint64_t drawn = lcg_stirred(seed);
    for (size_t i = 0; i < scenario->linkage.body_count; i++) {
        shake_body(&scenario->linkage.bodies[i], &drawn);
        if (scenario->linkage.is_spatial) {
            shake_body_space(&scenario->linkage.bodies[i].space, &drawn);
        }
    }
    for (size_t i = 0; i < scenario->linkage.joint_count; i++) {
        shake_joint(&scenario->linkage.joints[i], !scenario->contact.is_for_all, &drawn);
        if (scenario->linkage.is_spatial) {
            shake_joint_space(&scenario->linkage.joints[i].space, &drawn);
        }
    }
    shake_forces(&scenario->linkage, &drawn);
    shake_world(scenario, &drawn);
    for (size_t i = 0; i < scenario->linkage.profile_count; i++) {
        shake_profile(&scenario->linkage.profiles[i], &drawn);
    }
}
