// Finds where a pin is in its hole, and in which directions it can touch.
//
// As contact/pin_space.h has it: with O the centre of the hole, or of one of its ends, a the pin's
// axis, M its middle and B = M - O,
//     P = M - (B . a) a,   e = P - O,   gap = c - |e|,   force on the pin along -e / |e|
//     e' = r - (a . r + e . a') a,   r = v_pin(P) - v_hole(O),   a' = omega_pin x a
// The force acts on the line through O and P. Along the hole's axis u, with C its middle, the pin
// is at u . (M - C) between its collars, at a rate of u . (v_pin(M) - v_hole(M)).
#include "world/pin.h"

#include "contact/pin_axis.h"
#include "world/contact.h"
#include "world/fault.h"

#include <math.h>

enum { PIN, HOLE }; // of a joint's bodies

JpPinInHole jp_pin_default(void)
{
    return (JpPinInHole){
        .axis = {0.0, 0.0, 1.0},
        .axial_play = INFINITY,
        .contact = jp_contact_default(),
        .friction_speed = 1e-3,
        .presliding = 5e-6,
        .breakaway_ratio = 1.0,
        .presliding_damping = 1.0,
    };
}

static Vec3 vec3_of(const dReal *v)
{
    return (Vec3){v[0], v[1], v[2]};
}

static Vec3 point_of(dBodyID body, Vec3 local)
{
    dVector3 point;
    if (body == NULL) {
        return local;
    }
    dBodyGetRelPointPos(body, local.x, local.y, local.z, point);
    return vec3_of(point);
}

static Vec3 axis_of(dBodyID body, Vec3 local)
{
    dVector3 axis;
    if (body == NULL) {
        return local;
    }
    dBodyVectorToWorld(body, local.x, local.y, local.z, axis);
    return vec3_of(axis);
}

static Vec3 omega_of(dBodyID body)
{
    return body == NULL ? (Vec3){0.0, 0.0, 0.0} : vec3_of(dBodyGetAngularVel(body));
}

static Vec3 velocity_at(dBodyID body, Vec3 point)
{
    if (body == NULL) {
        return (Vec3){0.0, 0.0, 0.0};
    }
    const Vec3 arm = vec3_sub(point, vec3_of(dBodyGetPosition(body)));
    return vec3_add(vec3_of(dBodyGetLinearVel(body)), vec3_cross(omega_of(body), arm));
}

static Direction along(const JpJoint *joint, Vec3 axis, Vec3 at_pin, Vec3 at_hole)
{
    return direction_along(joint->bodies, (dVector3){axis.x, axis.y, axis.z},
                           (dVector3){at_pin.x, at_pin.y, at_pin.z},
                           (dVector3){at_hole.x, at_hole.y, at_hole.z});
}

// The pin against the hole, or one end of it.
typedef struct End {
    Vec3 axis; // of the pin
    Vec3 at_pin;
    Vec3 at_hole;
    Vec3 offset;   // e
    Vec3 velocity; // e'
    Vec3 sliding;  // r
} End;

static End end_of(const JpJoint *joint, Vec3 hole)
{
    const Vec3 axis = axis_of(joint->bodies[PIN], joint->pin.axes[PIN]);
    const Vec3 at_hole = point_of(joint->bodies[HOLE], hole);
    const Vec3 middle = point_of(joint->bodies[PIN], joint->pin.pin);
    const Vec3 offset = pin_axis_offset(at_hole, middle, axis);
    const Vec3 at_pin = vec3_add(at_hole, offset);
    const Vec3 sliding = vec3_sub(velocity_at(joint->bodies[PIN], at_pin),
                                  velocity_at(joint->bodies[HOLE], at_hole));
    const Vec3 turning = vec3_cross(omega_of(joint->bodies[PIN]), axis);
    const double lengthwise = vec3_dot(axis, sliding) + vec3_dot(offset, turning);
    return (End){
        .axis = axis,
        .at_pin = at_pin,
        .at_hole = at_hole,
        .offset = offset,
        .velocity = vec3_sub(sliding, vec3_scale(lengthwise, axis)),
        .sliding = sliding,
    };
}

// Its direction, and where it is along the hole's axis.
static Direction between_collars(const JpJoint *joint, double *position)
{
    const Vec3 axis = axis_of(joint->bodies[HOLE], joint->pin.axes[HOLE]);
    const Vec3 pin = point_of(joint->bodies[PIN], joint->pin.pin);
    const Vec3 hole = point_of(joint->bodies[HOLE], joint->pin.middle);
    *position = vec3_dot(axis, vec3_sub(pin, hole));
    return along(joint, axis, pin, pin);
}

void pin_start(JpJoint *joint)
{
    for (size_t i = 0; i < joint->place_count; i++) {
        Place *place = &joint->places[i];
        if (place->shape == PLACE_HOLE) {
            const End end = end_of(joint, joint->pin.holes[i]);
            place->offset = end.offset;
            place->velocity = end.velocity;
            place->sliding = end.sliding;
        } else {
            const Direction direction = between_collars(joint, &place->line_before);
            place->rate_before = direction_rate(&direction);
        }
    }
}

// A row in which one of the bodies turns.
static void add_turn(const JpJoint *joint, int body, Vec3 axis, Place *place)
{
    const dBodyID bodies[2] = {joint->bodies[body], NULL};
    const Direction row = direction_about(bodies, (dVector3){axis.x, axis.y, axis.z});
    place->start_rate[place->row_count] = direction_rate(&row);
    place->rows[place->row_count++] = row;
}

// The rows in which friction acts besides, in the order of kernel/force.c.
static void find_friction_rows(const JpJoint *joint, const End *end, const Vec3 across[2],
                               Place *place)
{
    add_turn(joint, HOLE, end->axis, place);
    add_turn(joint, PIN, end->axis, place);
    if (!place->slides_along) {
        return;
    }
    place->start_rate[place->row_count] = vec3_dot(end->axis, place->sliding);
    place->rows[place->row_count++] = along(joint, end->axis, end->at_pin, end->at_hole);
    for (int i = 0; i < 2; i++) {
        add_turn(joint, HOLE, across[i], place);
    }
    for (int i = 0; i < 2; i++) {
        add_turn(joint, PIN, across[i], place);
    }
}

// The directions in which the pin slides at the wall.
static void find_slide(const JpJoint *joint, const End *end, Vec3 normal, Place *place)
{
    const Vec3 round = vec3_cross(end->axis, normal);
    place->slide[0] = along(joint, round, place->point, place->point);
    place->slide[1] = along(joint, end->axis, place->point, place->point);
}

// The rows across the pin's axis, and where the pin was and how fast it went in them.
static void find_rows(const JpJoint *joint, const End *end, Place *place)
{
    Vec3 across[PLACE_ROWS_PLANE];
    pin_axis_across(end->axis, across);
    place->row_count = PLACE_ROWS_PLANE;
    for (size_t i = 0; i < PLACE_ROWS_PLANE; i++) {
        place->rows[i] = along(joint, across[i], end->at_pin, end->at_hole);
        place->start[i] = vec3_dot(across[i], place->offset);
        place->start_rate[i] = vec3_dot(across[i], place->velocity);
    }
    if (place->friction > 0.0) {
        find_friction_rows(joint, end, across, place);
    }
}

void pin_now(const JpJoint *joint, const Place *place, double at[2], double rate[2])
{
    if (place->shape != PLACE_HOLE) {
        const Direction direction = between_collars(joint, &at[0]);
        rate[0] = direction_rate(&direction);
        return;
    }
    const End end = end_of(joint, joint->pin.holes[place - joint->places]);
    for (size_t i = 0; i < PLACE_ROWS_PLANE; i++) {
        const Vec3 across = vec3_of(place->rows[i].axis);
        at[i] = vec3_dot(across, end.offset);
        rate[i] = vec3_dot(across, end.velocity);
    }
}

// Towards the hole's centre; of a centred pin against the way that it goes.
static Vec3 inwards(const End *end)
{
    const Vec3 out = vec3_length(end->offset) > 0.0 ? end->offset : end->velocity;
    const double size = vec3_length(out);
    return size > 0.0 ? vec3_scale(-1.0 / size, out) : vec3_normal_to(end->axis);
}

void pin_find(JpJoint *joint, bool has_rows)
{
    for (size_t i = 0; i < joint->place_count; i++) {
        Place *place = &joint->places[i];
        if (place->shape != PLACE_HOLE) {
            place->along = between_collars(joint, &place->position);
            place->point = point_of(joint->bodies[PIN], joint->pin.pin);
            continue;
        }
        const End end = end_of(joint, joint->pin.holes[i]);
        const Vec3 normal = inwards(&end);
        place->position = place->clearance - vec3_length(end.offset);
        place->along = along(joint, normal, end.at_pin, end.at_hole);
        place->point = vec3_sub(end.at_hole, vec3_scale(place->hole_radius, normal));
        if (place->friction > 0.0) {
            find_slide(joint, &end, normal, place);
        }
        if (has_rows) {
            find_rows(joint, &end, place);
        }
    }
}

// How deep a pin may be in the wall, of its radius, or of its play where that is more: a stiffness
// holds at any depth, but a pin that is deeper than its diameter has left its hole, and one with
// more play than that has crossed it ten times over.
static const double DEPTH_OF_RADIUS = 2.0;
static const double DEPTH_OF_PLAY = 10.0;

static double pin_depth(const JpJoint *joint, size_t number)
{
    const Place *place = &joint->places[number];
    if (place->shape == PLACE_HOLE) {
        return vec3_length(end_of(joint, joint->pin.holes[number]).offset) - place->clearance;
    }
    double position;
    between_collars(joint, &position);
    return fabs(position) - place->sides[1].limit;
}

JpStatus pin_check_inside(const JpJoint *joint, PinMoment moment, JpError *error)
{
    const Place *hole = &joint->places[0];
    const double radius = hole->hole_radius - hole->clearance;
    for (size_t i = 0; i < joint->place_count; i++) {
        const Place *place = &joint->places[i];
        const double play = place->shape == PLACE_HOLE ? place->clearance : place->sides[1].limit;
        const double most = fmax(DEPTH_OF_PLAY * play, DEPTH_OF_RADIUS * radius);
        const double depth = pin_depth(joint, i);
        static const char *const WHEN[] = {
            [PIN_MADE] = "is",
            [PIN_FOUND] = "is",
            [PIN_STEPPED] = "would be after a step as long as this",
        };
        if (!(depth <= most)) {
            return refusal(
                error, JP_ERROR_OUTSIDE,
                "the pin of %g m radius, joint %zu, %s %g m beyond %s with play of %g m; "
                "at most %g m are allowed",
                radius, joint->number, WHEN[moment], depth,
                place->shape == PLACE_HOLE ? "the wall of its hole" : "a collar", play, most);
        }
    }
    return JP_OK;
}

static JpStatus check_bodies(const JpWorld *world, dBodyID hole, dBodyID pin, JpError *error)
{
    REFUSAL_TRY(refusal_of_null(world, "the world", error));
    if (hole == pin) {
        return refusal(error, JP_ERROR_ARGUMENT,
                       "hole and pin are on the same body; one of them may be on the world, NULL");
    }
    const dBodyID bodies[] = {hole, pin};
    for (int i = 0; i < 2; i++) {
        if (bodies[i] != NULL && dBodyGetWorld(bodies[i]) != world->id) {
            return refusal(error, JP_ERROR_ARGUMENT, "the %s's body is in another world",
                           i == 0 ? "hole" : "pin");
        }
    }
    return JP_OK;
}

static JpStatus check_sizes(const JpPinInHole *pin, JpError *error)
{
    REFUSAL_TRY(refusal_of_positive(pin->hole_radius, "the hole's radius", error));
    REFUSAL_TRY(refusal_of_positive(pin->pin_radius, "the pin's radius", error));
    REFUSAL_TRY(refusal_of_negative(pin->width, "the hole's width", error));
    if (!(pin->pin_radius < pin->hole_radius)) {
        return refusal(error, JP_ERROR_ARGUMENT,
                       "the pin's radius is %g and the hole's %g; the pin must be smaller",
                       pin->pin_radius, pin->hole_radius);
    }
    return pin->axial_play == INFINITY
               ? JP_OK
               : refusal_of_negative(pin->axial_play, "the axial play", error);
}

// Friction that sticks, of what the rows of such a pin have it for.
static JpStatus check_stick(const JpWorld *world, const JpPinInHole *pin, JpError *error)
{
    REFUSAL_TRY(refusal_of_positive(pin->presliding, "the presliding", error));
    REFUSAL_TRY(refusal_of_positive(pin->presliding_damping, "the presliding's damping", error));
    REFUSAL_TRY(refusal_of_negative(pin->presliding_mass, "the presliding's mass", error));
    REFUSAL_TRY(refusal_of_finite(pin->breakaway_ratio, "the breakaway ratio", error));
    if (!(pin->breakaway_ratio >= 1.0)) {
        return refusal(error, JP_ERROR_ARGUMENT,
                       "the breakaway ratio is %g; it must not be below 1", pin->breakaway_ratio);
    }
    if (world->options.stepping != JP_STEPPING_IMPULSE) {
        return refusal(error, JP_ERROR_ARGUMENT,
                       "JP_FRICTION_STICK is of worlds with JP_STEPPING_IMPULSE; with rows the "
                       "friction of a pin is JP_FRICTION_REGULARIZED");
    }
    return pin->width == 0.0
               ? JP_OK
               : refusal(error, JP_ERROR_ARGUMENT,
                         "JP_FRICTION_STICK is of pins that touch at their hole's centre, and this "
                         "one has a width of %g; take a width of 0, or JP_FRICTION_REGULARIZED",
                         pin->width);
}

static JpStatus check_friction(const JpWorld *world, const JpPinInHole *pin, JpError *error)
{
    REFUSAL_TRY(refusal_of_negative(pin->friction, "the pin's friction", error));
    REFUSAL_TRY(refusal_of_positive(pin->friction_speed, "the friction speed", error));
    switch (pin->friction_law) {
    case JP_FRICTION_REGULARIZED:
        return JP_OK;
    case JP_FRICTION_STICK:
        return check_stick(world, pin, error);
    }
    return refusal(error, JP_ERROR_ARGUMENT, "the law of friction is %d, which is no JpFrictionLaw",
                   (int)pin->friction_law);
}

static JpStatus check_vectors(const JpPinInHole *pin, JpError *error)
{
    double size = 0.0;
    for (int i = 0; i < 3; i++) {
        REFUSAL_TRY(refusal_of_finite(pin->hole[i], "a coordinate of the hole", error));
        REFUSAL_TRY(refusal_of_finite(pin->pin[i], "a coordinate of the pin", error));
        REFUSAL_TRY(refusal_of_finite(pin->axis[i], "a coordinate of the axis", error));
        size = hypot(size, pin->axis[i]);
    }
    return refusal_of_positive(size, "the length of the axis", error);
}

static Vec3 into_body(dBodyID body, Vec3 axis)
{
    dVector3 local;
    if (body == NULL) {
        return axis;
    }
    dBodyVectorFromWorld(body, axis.x, axis.y, axis.z, local);
    return vec3_of(local);
}

// Where hole and pin are in their bodies.
static Pin place_pin(const dBodyID bodies[2], const JpPinInHole *given)
{
    const Vec3 asked = vec3_of(given->axis);
    // also of one whose square, or whose inverse, no double holds
    const double size = hypot(hypot(asked.x, asked.y), asked.z);
    const Vec3 axis = {asked.x / size, asked.y / size, asked.z / size};
    Pin pin = {
        .hole_count = given->width > 0.0 ? PIN_ENDS : 1,
        .middle = vec3_of(given->hole),
        .pin = vec3_of(given->pin),
        .axes = {into_body(bodies[PIN], axis), into_body(bodies[HOLE], axis)},
    };
    const Vec3 half = vec3_scale(0.5 * given->width, pin.axes[HOLE]);
    pin.holes[0] = vec3_sub(pin.middle, half);
    pin.holes[1] = vec3_add(pin.middle, half);
    return pin;
}

static BristlePair bristle_of(const JpPinInHole *given)
{
    if (given->friction_law != JP_FRICTION_STICK) {
        return (BristlePair){.law = BRISTLE_REGULARIZED};
    }
    return (BristlePair){
        .law = BRISTLE_STICK,
        .ratio = given->breakaway_ratio,
        .limit = given->presliding,
        .speed = given->friction_speed,
        .zeta = given->presliding_damping,
        .mass = given->presliding_mass,
    };
}

static void make_places(JpJoint *joint, const JpPinInHole *given, const ForceLaw *law)
{
    const size_t holes = joint->pin.hole_count;
    const ForceLaw share = force_law_share(law, 1.0 / (double)holes);
    for (size_t i = 0; i < holes; i++) {
        joint->places[joint->place_count++] = (Place){
            .shape = PLACE_HOLE,
            .clearance = given->hole_radius - given->pin_radius,
            .hole_radius = given->hole_radius,
            .friction = given->friction,
            .friction_speed = given->friction_speed,
            .bristle = bristle_of(given),
            .slides_along = given->width > 0.0,
            .sides = {{.law = holes > 1 ? share : *law, .sign = 1.0}},
        };
    }
    if (isfinite(given->axial_play)) {
        Place *collars = &joint->places[joint->place_count++];
        collars->shape = PLACE_LINE;
        for (int i = 0; i < SIDE_COUNT; i++) {
            const double sign = i == 0 ? 1.0 : -1.0;
            collars->sides[i] =
                (Side){.law = *law, .sign = sign, .limit = -sign * given->axial_play};
        }
    }
}

// A pin is no joint of ODE's, which would lose its bodies. Returns false where ODE has no memory.
static bool watch_bodies(JpJoint *joint)
{
    Fault fault;
    fault_begin(&fault);
    if (setjmp(fault.left) == 0) {
        for (int i = 0; i < 2; i++) {
            if (joint->bodies[i] != NULL) {
                joint->watches[i] = dJointCreateNull(joint->world->id, 0);
                dJointAttach(joint->watches[i], joint->bodies[i], NULL);
            }
        }
        fault_end(&fault);
        return true;
    }
    fault_end(&fault);
    return false;
}

JpStatus jp_pin_create(JpWorld *world, dBodyID hole, dBodyID pin, const JpPinInHole *given,
                       JpJoint **created, JpError *error)
{
    ForceLaw law;
    REFUSAL_TRY(refusal_of_null(created, "the pointer for the joint", error));
    REFUSAL_TRY(refusal_of_null(given, "the pin", error));
    REFUSAL_TRY(check_bodies(world, hole, pin, error));
    REFUSAL_TRY(check_sizes(given, error));
    REFUSAL_TRY(check_friction(world, given, error));
    REFUSAL_TRY(check_vectors(given, error));
    REFUSAL_TRY(contact_law(&given->contact, &law, error));
    const dBodyID bodies[2] = {[PIN] = pin, [HOLE] = hole};
    JpJoint *joint = play_add(world, PLAY_PIN, bodies);
    if (joint == NULL) {
        return refusal(error, JP_ERROR_MEMORY, "there is no memory for a joint");
    }
    if (!watch_bodies(joint)) {
        jp_joint_destroy(joint);
        return refusal(error, JP_ERROR_MEMORY, "ODE has no memory for the joint's watches");
    }
    joint->pin = place_pin(bodies, given);
    make_places(joint, given, &law);
    const JpStatus status = pin_check_inside(joint, PIN_MADE, error);
    if (status != JP_OK) {
        jp_joint_destroy(joint);
        return status;
    }
    *created = joint;
    return refusal_none(error);
}

static JpStatus check_pin(const JpJoint *joint, JpError *error)
{
    REFUSAL_TRY(refusal_of_null(joint, "the joint", error));
    return joint->kind == PLAY_PIN
               ? JP_OK
               : refusal(error, JP_ERROR_ARGUMENT,
                         "the joint is no pin in a hole; read it with jp_joint_state");
}

static void write_vector(Vec3 from, double to[3])
{
    to[0] = from.x;
    to[1] = from.y;
    to[2] = from.z;
}

JpStatus jp_pin_state(const JpJoint *joint, JpPinState *state, JpError *error)
{
    REFUSAL_TRY(check_pin(joint, error));
    REFUSAL_TRY(refusal_of_null(state, "the state", error));
    REFUSAL_TRY(play_check_bodies(joint, error));
    const Vec3 axis = axis_of(joint->bodies[HOLE], joint->pin.axes[HOLE]);
    const End middle = end_of(joint, joint->pin.middle);
    JpPinState found = {
        .gap = INFINITY,
        .end_count = joint->pin.hole_count,
        .bend = place_bend(&joint->places[0]),
    };
    write_vector(middle.offset, found.eccentricity);
    write_vector(joint->force, found.force);
    const Vec3 askew = vec3_cross(axis, middle.axis);
    found.tilt = atan2(vec3_length(askew), vec3_dot(axis, middle.axis));
    between_collars(joint, &found.axial);
    for (int i = 0; i < SIDE_COUNT; i++) {
        found.collars[i].gap = INFINITY;
    }
    for (size_t i = 0; i < joint->place_count; i++) {
        const Place *place = &joint->places[i];
        if (place->shape == PLACE_HOLE) {
            found.slid += place->slid;
            const End end = end_of(joint, joint->pin.holes[i]);
            const double gap = place->clearance - vec3_length(end.offset);
            found.ends[i] = play_side(&place->sides[0], gap);
            found.gap = fmin(found.gap, gap);
            found.is_touching = found.is_touching || gap < 0.0;
            continue;
        }
        for (int k = 0; k < SIDE_COUNT; k++) {
            found.collars[k] = play_side(&place->sides[k], found.axial);
            found.is_touching = found.is_touching || found.collars[k].is_touching;
        }
    }
    bool is_finite = isfinite(vec3_length(middle.offset) + vec3_length(joint->force) + found.axial +
                              found.tilt + found.slid + found.bend);
    for (int i = 0; i < SIDE_COUNT; i++) {
        is_finite = is_finite && play_is_side_finite(&found.ends[i]) &&
                    play_is_side_finite(&found.collars[i]);
    }
    if (!is_finite) {
        return refusal(error, JP_ERROR_WORLD, "the pin's state is out of a double's range");
    }
    *state = found;
    return refusal_none(error);
}
