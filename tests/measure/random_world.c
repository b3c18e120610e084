// Makes worlds of the library from a seed: islands of bodies that hang on each other by ODE's
// joints, or by pins of the library, with stops and backlash on their hinges and sliders; or bodies
// in a plane that hang on each other by pins without a width.
#include "random_world.h"

#include "base/lcg.h"

#include <float.h>
#include <math.h>
#include <string.h>

static const double STEEL_STEP = 1e-4; // s
static const double PI = 3.14159265358979323846;

// In [0, 1).
static double share(RandomWorld *made)
{
    return 0.5 + 0.5 * lcg_draw(&made->random);
}

static size_t pick(RandomWorld *made, size_t count)
{
    return (size_t)(share(made) * (double)count);
}

static double between(RandomWorld *made, double least, double most)
{
    return least + (most - least) * share(made);
}

// Of a size that is as likely in each decade.
static double size_between(RandomWorld *made, double least, double most)
{
    return least * pow(most / least, share(made));
}

static void direction(RandomWorld *made, double length, double out[3])
{
    double sum = 0.0;
    for (int k = 0; k < 3; k++) {
        out[k] = between(made, -1.0, 1.0);
        sum += out[k] * out[k];
    }
    for (int k = 0; k < 3; k++) {
        out[k] *= length / sqrt(sum + DBL_MIN);
    }
}

static dBodyID add_body(RandomWorld *made, const double at[3], bool is_flat)
{
    dMass mass;
    const double kilograms =
        made->is_wild ? size_between(made, 1e-6, 1e6) : size_between(made, 0.05, 5.0);
    const dBodyID body = dBodyCreate(made->world);
    dMassSetBoxTotal(&mass, kilograms, size_between(made, 0.03, 0.3), size_between(made, 0.03, 0.3),
                     size_between(made, 0.03, 0.3));
    dBodySetMass(body, &mass);
    dBodySetPosition(body, at[0], at[1], at[2]);
    double velocity[3];
    double spin[3];
    const double fastest = made->is_wild && pick(made, 3) == 0 ? 300.0 : 2.0;
    direction(made, fastest * share(made), velocity);
    direction(made, fastest * share(made), spin);
    dBodySetLinearVel(body, velocity[0], velocity[1], is_flat ? 0.0 : velocity[2]);
    dBodySetAngularVel(body, is_flat ? 0.0 : spin[0], is_flat ? 0.0 : spin[1], spin[2]);
    made->bodies[made->body_count++] = body;
    return body;
}

// A law that rings at some frequency on the lightest that it may push, and at some depth if it is
// no straight line.
static JpContact contact_of(RandomWorld *made, double mass, double depth)
{
    JpContact contact = jp_contact_default();
    const double rate =
        2.0 * PI *
        (made->is_wild ? size_between(made, 0.1, 1e5) : size_between(made, 20.0, 1000.0)); // rad/s
    contact.stiffness = mass * rate * rate;
    if (pick(made, 2) == 0) {
        contact.exponent = 1.5;
        contact.stiffness /= sqrt(depth);
    }
    contact.damping = pick(made, 3) == 0 ? JP_DAMPING_NONE : (JpDamping)pick(made, 8);
    contact.restitution = between(made, 0.2, 1.0);
    contact.damper = mass * rate * size_between(made, 0.01, 0.5);
    return contact;
}

// What rows need: steps in an undamped contact that closes at that speed. The library asks for 3
// (STEPS_TO_A_CONTACT); one more is left for contacts that close faster, which last shorter by
// v^(-1/5) on Hertz's law.
static const double STEPS_TO_A_CONTACT = 4.0;
static const double CLOSING = 4.0; // m/s or rad/s: twice the fastest body

// kg or kg m^2: at least as light as what a push at a reach from a body's centre meets.
static double lightness(dBodyID body, double reach, bool is_turn)
{
    dMass mass;
    if (body == NULL) {
        return 0.0;
    }
    dBodyGetMass(body, &mass);
    const double least = fmin(mass.I[0], fmin(mass.I[5], mass.I[10]));
    return is_turn ? 1.0 / least : 1.0 / mass.mass + reach * reach / least;
}

// Shortens the step that rows can be stepped with: bodies are taken as free, so that their
// contacts last as short as they can; and nothing is to cross its play within a step.
static void resolve(RandomWorld *made, const JpContact *contact, double mobility, double play)
{
    JpContact undamped = *contact;
    JpImpact impact = {.duration = 0.0};
    undamped.damping = JP_DAMPING_NONE;
    jp_impact_of_law(&undamped, 1.0 / mobility, CLOSING, &impact, NULL);
    made->resolved =
        fmin(made->resolved, fmin(impact.duration / STEPS_TO_A_CONTACT, play / CLOSING));
}

// The same of a play on a joint of ODE.
static void resolve_joint(RandomWorld *made, dJointID on, const RandomPlay *of, double play)
{
    double mobility = of->rotor_inertia > 0.0 ? 1.0 / of->rotor_inertia : 0.0;
    for (int i = 0; i < 2; i++) {
        mobility += lightness(dJointGetBody(on, i), 0.0, dJointGetType(on) == dJointTypeHinge);
    }
    resolve(made, &of->contact, mobility, play);
}

static void add_play(RandomWorld *made, const RandomPlay *of)
{
    made->plays[made->play_count++] = *of;
}

static void add_stops(RandomWorld *made, dJointID on, double mass)
{
    JpStops stops = jp_stops_default();
    stops.low = -size_between(made, 0.003, 0.3);
    stops.high = pick(made, 4) == 0 ? INFINITY : size_between(made, 0.003, 0.3);
    stops.low += made->is_wild && pick(made, 4) == 0 ? 0.01 : 0.0;
    stops.contact = contact_of(made, mass, 1e-3);
    RandomPlay of = {.contact = stops.contact};
    if (jp_stops_create(made->play, on, &stops, &of.joint, NULL) == JP_OK) {
        resolve_joint(made, on, &of, stops.high - stops.low);
        add_play(made, &of);
    }
}

static void add_backlash(RandomWorld *made, dJointID on, double mass)
{
    JpBacklash backlash = jp_backlash_default();
    backlash.gap = size_between(made, 1e-4, 0.05);
    backlash.rotor_inertia = pick(made, 2) == 0 ? 0.0 : mass * size_between(made, 0.1, 10.0);
    const bool is_light = backlash.rotor_inertia > 0.0 && backlash.rotor_inertia < mass;
    backlash.tooth = contact_of(made, is_light ? backlash.rotor_inertia : mass, 1e-4);
    RandomPlay of = {.contact = backlash.tooth,
                     .rotor_inertia = backlash.rotor_inertia,
                     .is_driven = !made->is_passive && backlash.rotor_inertia > 0.0};
    if (jp_backlash_create(made->play, on, &backlash, &of.joint, NULL) == JP_OK) {
        resolve_joint(made, on, &of, backlash.gap);
        add_play(made, &of);
    }
}

static double lighter(dBodyID one, dBodyID other)
{
    dMass mass;
    double least = INFINITY;
    for (int i = 0; i < 2; i++) {
        if ((i == 0 ? one : other) != NULL) {
            dBodyGetMass(i == 0 ? one : other, &mass);
            least = fmin(least, mass.mass);
        }
    }
    return least;
}

// Something like the moment of inertia that a hinge sees.
static double inertia_of(dBodyID one, dBodyID other)
{
    return 0.02 * lighter(one, other);
}

static void play_on(RandomWorld *made, dJointID on, double mass)
{
    if (pick(made, 3) > 0) {
        add_stops(made, on, mass);
    }
    if (pick(made, 2) == 0) {
        add_backlash(made, on, mass);
    }
}

// Every second joint of a world that rubs has a steady friction, the others one of what presses.
static void rub(RandomWorld *made, dJointID on, double mass)
{
    JpFriction friction = jp_friction_default();
    JpJoint *joint = NULL;
    if (!made->is_rubbing) {
        return;
    }
    if (made->rub_count++ % 2 == 0) {
        friction.steady = 5.0 * mass;
    } else {
        friction.coefficient = 0.2;
        friction.radius = 0.01;
    }
    jp_friction_create(made->play, on, &friction, &joint, NULL);
}

static void in_frame(dBodyID body, const double at[3], double local[3])
{
    dVector3 found = {at[0], at[1], at[2]};
    if (body != NULL) {
        dBodyGetPosRelPoint(body, at[0], at[1], at[2], found);
    }
    memcpy(local, found, 3 * sizeof(double));
}

static void resolve_pin(RandomWorld *made, const RandomPlay *of, const JpPinInHole *pin)
{
    const double play = 2.0 * fmin(pin->hole_radius - pin->pin_radius, pin->axial_play);
    const double *points[2] = {pin->hole, pin->pin};
    double mobility = 0.0;
    for (int i = 0; i < 2; i++) {
        const double *at = points[i];
        const double arm = sqrt(at[0] * at[0] + at[1] * at[1] + at[2] * at[2]);
        mobility += lightness(of->bodies[i], arm + 0.5 * pin->width, false);
    }
    resolve(made, &of->contact, mobility, play);
}

static void add_pin(RandomWorld *made, dBodyID hole, dBodyID body, const double at[3], bool is_flat)
{
    JpPinInHole pin = jp_pin_default();
    const double clearance = size_between(made, 5e-6, 5e-4);
    pin.hole_radius = size_between(made, 3e-3, 3e-2);
    pin.pin_radius = pin.hole_radius - clearance;
    pin.width = is_flat ? 0.0 : between(made, 1.0, 4.0) * pin.hole_radius;
    pin.axial_play = is_flat || pick(made, 4) == 0 ? INFINITY : size_between(made, 1e-5, 1e-3);
    in_frame(hole, at, pin.hole);
    in_frame(body, at, pin.pin);
    if (!is_flat) {
        direction(made, 1.0, pin.axis);
    }
    pin.contact = contact_of(made, lighter(hole, body), 1e-5);
    if (pick(made, 3) == 0) {
        // steel: its contacts are shorter, and so is the step that anybody would take
        made->step = made->is_wild ? made->step : fmin(made->step, STEEL_STEP);
        const JpPin sizes = {.hole_radius = pin.hole_radius,
                             .pin_radius = pin.pin_radius,
                             .width = 2.0 * pin.hole_radius,
                             .youngs_modulus = 2e11,
                             .poisson_ratio = 0.3};
        jp_contact_of_pin((JpPinLaw)pick(made, 6), &sizes, &pin.contact, NULL);
    }
    pin.friction = made->is_passive || pick(made, 2) == 0 ? 0.0 : between(made, 0.05, 0.5);
    pin.friction_law = made->is_sticking && is_flat ? JP_FRICTION_STICK : JP_FRICTION_REGULARIZED;
    RandomPlay of = {
        .contact = pin.contact, .is_pin = true, .bodies = {hole, body}, .width = pin.width};
    memcpy(of.point, pin.pin, sizeof of.point);
    if (jp_pin_create(made->play, hole, body, &pin, &of.joint, NULL) == JP_OK) {
        resolve_pin(made, &of, &pin);
        add_play(made, &of);
    }
}

static void add_hinge(RandomWorld *made, dBodyID before, dBodyID body, const double at[3],
                      const double axis[3])
{
    const dJointID joint = dJointCreateHinge(made->world, 0);
    dJointAttach(joint, body, before);
    dJointSetHingeAnchor(joint, at[0], at[1], at[2]);
    dJointSetHingeAxis(joint, axis[0], axis[1], axis[2]);
    if (!made->is_passive && pick(made, 4) == 0) {
        dJointSetHingeParam(joint, dParamFMax,
                            inertia_of(before, body) * size_between(made, 1, 50));
        dJointSetHingeParam(joint, dParamVel, between(made, -1, 1));
    }
    play_on(made, joint, inertia_of(before, body));
    rub(made, joint, inertia_of(before, body));
}

static void add_slider(RandomWorld *made, dBodyID before, dBodyID body, const double axis[3])
{
    const dJointID joint = dJointCreateSlider(made->world, 0);
    dJointAttach(joint, body, before);
    dJointSetSliderAxis(joint, axis[0], axis[1], axis[2]);
    play_on(made, joint, lighter(before, body));
    rub(made, joint, lighter(before, body));
}

static void add_universal(RandomWorld *made, dBodyID before, dBodyID body, const double at[3],
                          const double axis[3])
{
    const dJointID joint = dJointCreateUniversal(made->world, 0);
    const double across[3] = {fabs(axis[0]) < 0.5, fabs(axis[0]) >= 0.5, 0.0};
    const double along = across[0] * axis[0] + across[1] * axis[1];
    dJointAttach(joint, body, before);
    dJointSetUniversalAnchor(joint, at[0], at[1], at[2]);
    dJointSetUniversalAxis1(joint, axis[0], axis[1], axis[2]);
    dJointSetUniversalAxis2(joint, across[0] - along * axis[0], across[1] - along * axis[1],
                            -along * axis[2]);
}

static void add_ball_or_fixed(RandomWorld *made, dBodyID before, dBodyID body, const double at[3],
                              bool is_ball)
{
    const dJointID joint =
        is_ball ? dJointCreateBall(made->world, 0) : dJointCreateFixed(made->world, 0);
    dJointAttach(joint, body, before);
    if (is_ball) {
        dJointSetBallAnchor(joint, at[0], at[1], at[2]);
    } else {
        dJointSetFixed(joint);
    }
}

static void link_bodies(RandomWorld *made, dBodyID before, dBodyID body, const double at[3])
{
    double axis[3];
    direction(made, 1.0, axis);
    switch (pick(made, 10)) {
    case 0:
    case 1:
    case 2:
        add_hinge(made, before, body, at, axis);
        break;
    case 3:
    case 4:
        add_slider(made, before, body, axis);
        break;
    case 5:
        add_universal(made, before, body, at, axis);
        break;
    case 6:
        add_ball_or_fixed(made, before, body, at, true);
        break;
    case 7:
        add_ball_or_fixed(made, before, body, at, false);
        break;
    default:
        add_pin(made, before, body, at, false);
        break;
    }
}

static void add_island(RandomWorld *made, size_t number, bool is_flat)
{
    const size_t first = made->body_count;
    const size_t count = 1 + pick(made, 4);
    for (size_t i = 0; i < count; i++) {
        const dBodyID before = i == 0 ? NULL : made->bodies[first + pick(made, i)];
        const dReal *origin = before == NULL ? NULL : dBodyGetPosition(before);
        double at[3] = {10.0 * (double)number, 0.0, 0.0};
        double arm[3];
        double joint[3];
        direction(made, size_between(made, 0.05, 0.5), arm);
        arm[2] = is_flat ? 0.0 : arm[2];
        for (int k = 0; k < 3; k++) {
            at[k] = (origin == NULL ? at[k] : origin[k]) + arm[k];
            joint[k] = at[k] - (before == NULL ? 1.0 : 0.5) * arm[k];
        }
        const dBodyID body = add_body(made, at, is_flat);
        if (is_flat) {
            dJointAttach(dJointCreatePlane2D(made->world, 0), body, 0);
            add_pin(made, before, body, joint, true);
        } else if (before != NULL || pick(made, 4) > 0) {
            link_bodies(made, before, body, joint);
        }
    }
}

// Makes the speeds of bodies those that joints allow, with the pins' middles at rest in their
// holes: by a step of ODE alone that moves nothing.
static void project_speeds(RandomWorld *made)
{
    static const double INSTANT = 1e-9;   // s
    static const double SOFTNESS = 1e-12; // m/(N s): little, where planes hold what balls hold, too
    enum { STEPS = 60 }; // balls and fixed joints close by a fifth a step, to a millionth
    const double softness = dWorldGetCFM(made->world);
    const double correction = dWorldGetERP(made->world);
    dWorldSetCFM(made->world, SOFTNESS);
    dWorldSetERP(made->world, 0.0);
    const dJointGroupID group = dJointGroupCreate(0);
    for (size_t i = 0; i < made->play_count; i++) {
        const RandomPlay *of = &made->plays[i];
        if (of->is_pin) {
            dVector3 at;
            const dJointID ball = dJointCreateBall(made->world, group);
            dBodyGetRelPointPos(of->bodies[1], of->point[0], of->point[1], of->point[2], at);
            dJointAttach(ball, of->bodies[1], of->bodies[0]);
            dJointSetBallAnchor(ball, at[0], at[1], at[2]);
        }
    }
    for (int i = 0; i < STEPS; i++) {
        dWorldStep(made->world, INSTANT);
    }
    dWorldSetCFM(made->world, softness);
    dWorldSetERP(made->world, correction);
    dJointGroupDestroy(group);
}

RandomWorld random_world(unsigned number, JpStepping stepping)
{
    RandomWorld made = {.world = dWorldCreate(),
                        .resolved = INFINITY,
                        .random = lcg_stirred(number),
                        .is_passive = number % 3 == 0,
                        .is_wild = number % 5 == 0,
                        .is_rubbing = number % 4 == 1 && number % 3 != 0,
                        .is_sticking = number % 2 == 0 && stepping == JP_STEPPING_IMPULSE};
    made.step = made.is_wild ? size_between(&made, 1e-8, 1.0) : size_between(&made, 1e-5, 1e-3);
    JpWorldOptions options = jp_world_options_default();
    options.stepping = stepping;
    const bool is_quick = pick(&made, 8) == 0;
    options.is_quick = is_quick && !made.is_passive && stepping != JP_STEPPING_IMPULSE;
    jp_world_create(made.world, &options, &made.play, NULL);
    const bool is_flat = pick(&made, 4) == 0;
    double down[3] = {0.0, 0.0, 0.0};
    if (pick(&made, 4) > 0) {
        direction(&made, 9.81, down);
    }
    dWorldSetGravity(made.world, down[0], down[1], is_flat ? 0.0 : down[2]);
    const size_t islands = 1 + pick(&made, 3);
    for (size_t i = 0; i < islands; i++) {
        add_island(&made, i, is_flat);
    }
    if (!made.is_wild) {
        project_speeds(&made);
    }
    const bool has_rows = stepping != JP_STEPPING_IMPULSE;
    if (has_rows && !made.is_wild && number % 4 != 0) {
        made.step = fmin(made.step, made.resolved);
    }
    made.is_plain = !made.is_wild && (!has_rows || made.step <= made.resolved);
    if (jp_world_add_all(made.play, NULL) != JP_OK) {
        for (size_t i = 0; i < made.body_count; i++) {
            jp_world_add_body(made.play, made.bodies[i], NULL);
        }
    }
    return made;
}

void random_world_finish(RandomWorld *made)
{
    jp_world_destroy(made->play);
    dWorldDestroy(made->world);
}

void random_world_drive(RandomWorld *made)
{
    for (size_t i = 0; i < made->play_count; i++) {
        const RandomPlay *of = &made->plays[i];
        if (of->is_driven && pick(made, 50) == 0) {
            jp_backlash_drive(of->joint, of->rotor_inertia * between(made, -100.0, 100.0), NULL);
        } else if (of->is_driven && pick(made, 400) == 0) {
            jp_backlash_hold(of->joint, between(made, -0.1, 0.1), of->rotor_inertia * 1e4,
                             of->rotor_inertia * 1e2, NULL);
        }
    }
}

static double kinetic_of(dBodyID body)
{
    dMass mass;
    dVector3 spin;
    dVector3 turned;
    dBodyGetMass(body, &mass);
    const dReal *v = dBodyGetLinearVel(body);
    const dReal *w = dBodyGetAngularVel(body);
    dBodyVectorFromWorld(body, w[0], w[1], w[2], spin);
    dMultiply0_331(turned, mass.I, spin);
    return 0.5 * mass.mass * dCalcVectorDot3(v, v) + 0.5 * dCalcVectorDot3(spin, turned);
}

double random_world_kinetic(const RandomWorld *made)
{
    double sum = 0.0;
    for (size_t i = 0; i < made->body_count; i++) {
        sum += kinetic_of(made->bodies[i]);
    }
    for (size_t i = 0; i < made->play_count; i++) {
        JpJointState state;
        const RandomPlay *of = &made->plays[i];
        if (of->rotor_inertia > 0.0 && jp_joint_state(of->joint, &state, NULL) == JP_OK) {
            sum += 0.5 * of->rotor_inertia * state.rotor_speed * state.rotor_speed;
        }
    }
    return sum;
}

double random_world_stored(const RandomWorld *made)
{
    double sum = 0.0;
    for (size_t i = 0; i < made->play_count; i++) {
        JpSide sides[RANDOM_SIDES];
        double closing = 0.0;
        const size_t count = random_world_sides(&made->plays[i], sides, &closing);
        for (size_t k = 0; k < count; k++) {
            sum += sides[k].stored;
        }
    }
    return sum;
}

double random_world_energy(const RandomWorld *made)
{
    dVector3 down;
    double sum = random_world_kinetic(made) + random_world_stored(made);
    dWorldGetGravity(made->world, down);
    for (size_t i = 0; i < made->body_count; i++) {
        dMass mass;
        dBodyGetMass(made->bodies[i], &mass);
        sum -= mass.mass * dCalcVectorDot3(down, dBodyGetPosition(made->bodies[i]));
    }
    return sum;
}

static size_t pin_sides(const RandomPlay *of, const JpPinState *state, JpSide sides[RANDOM_SIDES])
{
    size_t count = 0;
    for (size_t k = 0; k < state->end_count; k++) {
        sides[count++] = state->ends[k];
    }
    for (size_t k = 0; k < 2 && of->width > 0.0; k++) {
        sides[count++] = state->collars[k];
    }
    return count;
}

// How fast an end of the pin's axis goes in its hole, at most.
static double pin_closing(const RandomPlay *of)
{
    dVector3 at;
    dVector3 velocities[2] = {{0.0}};
    const dReal *spins[2] = {NULL, NULL};
    dBodyGetRelPointPos(of->bodies[1], of->point[0], of->point[1], of->point[2], at);
    for (int i = 0; i < 2; i++) {
        if (of->bodies[i] != NULL) {
            dBodyGetPointVel(of->bodies[i], at[0], at[1], at[2], velocities[i]);
            spins[i] = dBodyGetAngularVel(of->bodies[i]);
        }
    }
    double sliding = 0.0;
    double turning = 0.0;
    for (int k = 0; k < 3; k++) {
        sliding += pow(velocities[1][k] - velocities[0][k], 2.0);
        turning += pow(spins[1][k] - (spins[0] == NULL ? 0.0 : spins[0][k]), 2.0);
    }
    return sqrt(sliding) + 0.5 * of->width * sqrt(turning);
}

double random_world_share(const RandomPlay *of, size_t side)
{
    return of->is_pin && of->width > 0.0 && side < 2 ? 0.5 : 1.0;
}

size_t random_world_sides(const RandomPlay *of, JpSide sides[RANDOM_SIDES], double *closing)
{
    JpJointState state;
    JpPinState pin;
    if (of->is_pin) {
        *closing = pin_closing(of);
        return jp_pin_state(of->joint, &pin, NULL) == JP_OK ? pin_sides(of, &pin, sides) : 0;
    }
    if (jp_joint_state(of->joint, &state, NULL) != JP_OK) {
        return 0;
    }
    *closing = fabs(state.speed - (of->rotor_inertia > 0.0 ? state.rotor_speed : 0.0));
    sides[0] = state.low;
    sides[1] = state.high;
    return 2;
}
