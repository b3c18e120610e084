// Finds where bodies touch, what presses there, and the rows in which the kernel integrates it.
//
// With d from anchor a to anchor b, n the direction of the force on body b, t = perp n:
//     hole, disc    rows x, y of d;  with friction the turns of both bodies
//     line, cam     gap and sliding: the velocities of both bodies at the point that touches
//     slot          across and along the slot, of the pin's centre against the slot under it
//     turn          s q - c, q the angle of b less that of a; the other way where b is the ground
//     teeth         base/mesh.h
//     rack          s q - c, q = m . d + r_b (phi_b - phi_a), m along the rack
// As a force the law presses with N n at the point that touches, and friction with
//     - mu N tanh(v_t / v_s) t,   v_t = t . (v_b - v_a) there
#include "drivers/common/place.h"

#include "kernel/friction_law.h"

#include <math.h>

static const Vec2 NOTHING = {0.0, 0.0};

// m or rad: the gap of what rubs, which no coordinate uses up in a step
static const double RUB_GAP = -1.0;

static DriverMotion motion_of(const DriverMotion *motions, int body)
{
    return body == DRIVER_GROUND ? (DriverMotion){.angle = 0.0} : motions[body];
}

// A direction of body a, given in its frame, in the world.
static Vec2 along_a(const DriverPlace *place, const DriverMotion *motions)
{
    const double angle = motion_of(motions, place->bodies[0]).angle;
    return vec2_rotate(angle + place->direction, (Vec2){1.0, 0.0});
}

static Vec2 anchor_b(const DriverPlace *place, const DriverMotion *motions)
{
    return driver_point(motions, place->bodies[1], place->anchors[1]);
}

static Vec2 offset_of(const DriverPlace *place, const DriverMotion *motions)
{
    return vec2_sub(anchor_b(place, motions),
                    driver_point(motions, place->bodies[0], place->anchors[0]));
}

static Vec2 velocity_of(const DriverPlace *place, const DriverMotion *motions)
{
    return vec2_sub(driver_point_velocity(motions, place->bodies[1], place->anchors[1]),
                    driver_point_velocity(motions, place->bodies[0], place->anchors[0]));
}

// The sign with which an angle follows body b.
static double sense_of(const DriverPlace *place)
{
    return place->bodies[1] == DRIVER_GROUND ? -1.0 : 1.0;
}

static MeshFlank flank_of(const DriverPlace *place, const DriverMotion *motions)
{
    const Mesh mesh = {.gear = &place->gear,
                       .error = place->gear.error > 0 ? &place->tables[0] : NULL,
                       .relief = place->gear.relief > 0 ? &place->tables[1] : NULL};
    return mesh_flank(&mesh, place->sign, offset_of(place, motions),
                      motion_of(motions, place->bodies[0]).angle,
                      motion_of(motions, place->bodies[1]).angle);
}

static CamPose cam_of(const DriverPlace *place, const DriverMotion *motions)
{
    const Vec2 facing = vec2_rotate(motion_of(motions, place->bodies[1]).angle + place->cam.facing,
                                    (Vec2){1.0, 0.0});
    return cam_pose(&place->cam, along_a(place, motions), facing, offset_of(place, motions));
}

// The gap of an angle or a rack, with the angles of both bodies.
static double gap_of_coordinate(const DriverPlace *place, const DriverMotion *motions)
{
    const double turned =
        motion_of(motions, place->bodies[1]).angle - motion_of(motions, place->bodies[0]).angle;
    const double position = place->shape == DRIVER_TURN
                                ? sense_of(place) * turned
                                : vec2_dot(along_a(place, motions), offset_of(place, motions)) +
                                      place->radii[1] * turned;
    return place->sign * position - place->clearance;
}

static double gap_of_teeth(const DriverPlace *place, const DriverMotion *motions)
{
    const MeshFlank flank = flank_of(place, motions);
    const double position =
        mesh_position(&place->gear, flank.offset, motion_of(motions, place->bodies[0]).angle,
                      motion_of(motions, place->bodies[1]).angle, place->middle);
    return mesh_gap(&place->gear, &flank, place->sign * position - place->clearance,
                    vec2_length(flank.offset) - mesh_distance(&place->gear));
}

// Where the pin of a slot is, across it and along it.
static Vec2 in_slot(const DriverPlace *place, const DriverMotion *motions)
{
    const Vec2 across = along_a(place, motions);
    const Vec2 offset = offset_of(place, motions);
    return (Vec2){vec2_dot(across, offset), vec2_dot(vec2_perp(across), offset)};
}

// The normal of a slot, and from its anchor the point of its middle line that it is at.
static Vec2 normal_in_slot(const DriverPlace *place, const DriverMotion *motions, double *gap,
                           Vec2 *middle)
{
    const Vec2 across = along_a(place, motions);
    const Vec2 along = vec2_perp(across);
    const Vec2 at = in_slot(place, motions);
    const PinHole pose = pin_slot_pose(at, NOTHING, place->half_length, place->clearance);
    *gap = pose.gap;
    *middle = vec2_scale(at.y - pose.eccentricity.y, along);
    return vec2_add(vec2_scale(pose.normal.x, across), vec2_scale(pose.normal.y, along));
}

// The rate of a gap that has a normal.
static double approach_along(const DriverPlace *place, const DriverMotion *motions, Vec2 normal,
                             Vec2 point)
{
    double rate = 0.0;
    for (int side = 0; side < 2; side++) {
        const DriverMotion motion = motion_of(motions, place->bodies[side]);
        const Vec2 arm = vec2_sub(point, motion.position);
        const Vec2 going = vec2_add(motion.velocity, vec2_scale(motion.omega, vec2_perp(arm)));
        rate += (side == 0 ? 1.0 : -1.0) *
                (place->bodies[side] == DRIVER_GROUND ? 0.0 : vec2_dot(normal, going));
    }
    return rate;
}

PlacePose place_pose(const DriverPlace *place, const DriverMotion *motions)
{
    PlacePose pose = {.offset = offset_of(place, motions)};
    const Vec2 from = anchor_b(place, motions);
    Vec2 from_b = NOTHING;
    switch (place->shape) {
    case DRIVER_HOLE:
    case DRIVER_DISC: {
        // a disc outside is a hole of negative size
        const double outside = place->shape == DRIVER_DISC ? 1.0 : -1.0;
        const PinHole pin = pin_hole_pose(NOTHING, pose.offset, velocity_of(place, motions), 0.0);
        pose.gap = outside * (pin.eccentricity_size - place->clearance);
        pose.normal = vec2_scale(-outside, pin.normal);
        pose.approach = pin.has_normal ? -outside * pin.approach_speed : pin.approach_speed;
        from_b = vec2_sub(vec2_scale(outside * place->radii[0], pose.normal), pose.offset);
        pose.point = vec2_add(from, from_b);
        return pose;
    }
    case DRIVER_SLOT: {
        Vec2 middle;
        pose.normal = normal_in_slot(place, motions, &pose.gap, &middle);
        from_b = vec2_sub(vec2_sub(middle, vec2_scale(place->radii[0], pose.normal)), pose.offset);
        break;
    }
    case DRIVER_LINE:
        pose.normal = along_a(place, motions);
        pose.gap = vec2_dot(pose.normal, pose.offset) - place->clearance;
        from_b = vec2_scale(-place->radii[1], pose.normal);
        break;
    case DRIVER_CAM: {
        const CamPose cam = cam_of(place, motions);
        pose.normal = cam.normal;
        pose.gap = cam.gap;
        from_b = cam.from_b;
        break;
    }
    case DRIVER_TURN:
    case DRIVER_TEETH:
    case DRIVER_RACK:
    case DRIVER_SHAPE_COUNT: {
        const PlaceRow row = place_row(place, motions, 0);
        pose.gap = place->shape == DRIVER_TEETH ? gap_of_teeth(place, motions)
                                                : gap_of_coordinate(place, motions);
        pose.approach = -place_rate(place, &row, motions);
        return pose;
    }
    }
    pose.point = vec2_add(from, from_b);
    pose.approach = approach_along(place, motions, pose.normal, pose.point);
    return pose;
}

// A row along a direction at a point of each body.
static PlaceRow row_at(const DriverPlace *place, const DriverMotion *motions, Vec2 direction,
                       const Vec2 points[2])
{
    PlaceRow row = {.turn = {0.0, 0.0}};
    for (int side = 0; side < 2; side++) {
        const double sign = side == 0 ? -1.0 : 1.0;
        const Vec2 arm = vec2_sub(points[side], motion_of(motions, place->bodies[side]).position);
        row.along[side] = vec2_scale(sign, direction);
        row.turn[side] = sign * vec2_cross(arm, direction);
    }
    return row;
}

// The rows of a place that presses at one point of both bodies, along two directions.
static PlaceRow row_of_wall(const DriverPlace *place, const DriverMotion *motions, size_t row)
{
    const Vec2 centre = anchor_b(place, motions);
    Vec2 first = along_a(place, motions);
    Vec2 point = centre; // of a slot: the pin's centre
    bool slides = true;
    if (place->shape == DRIVER_LINE) {
        point = vec2_sub(centre, vec2_scale(place->radii[1], first));
    } else if (place->shape == DRIVER_CAM) {
        const CamPose cam = cam_of(place, motions);
        first = cam.normal;
        point = vec2_add(centre, cam.from_b);
    } else if (place->shape == DRIVER_TEETH) {
        const MeshFlank flank = flank_of(place, motions);
        first = flank.normal;
        point = vec2_add(centre, flank.from_b);
        slides = false;
    } else if (place->shape == DRIVER_RACK) {
        first = vec2_scale(place->sign, first);
        point = vec2_sub(centre, vec2_scale(place->sign * place->radii[1], vec2_perp(first)));
        slides = false;
    }
    if (row > 0 && !slides) {
        return (PlaceRow){.turn = {0.0, 0.0}};
    }
    return row_at(place, motions, row == 0 ? first : vec2_perp(first), (Vec2[]){point, point});
}

PlaceRow place_row(const DriverPlace *place, const DriverMotion *motions, size_t row)
{
    if (row >= KERNEL_ROW_TURN) {
        const size_t side = row - KERNEL_ROW_TURN;
        return (PlaceRow){.turn = {side == 0 ? 1.0 : 0.0, side == 0 ? 0.0 : 1.0}};
    }
    if (place->shape == DRIVER_TURN) {
        const double turn = row == 0 ? place->sign * sense_of(place) : 0.0;
        return (PlaceRow){.turn = {-turn, turn}};
    }
    if (!place_is_point(place)) {
        return row_of_wall(place, motions, row);
    }
    PlaceRow rows[KERNEL_ROW_TURN];
    place_rows(place, motions, rows);
    return rows[row];
}

void place_rows(const DriverPlace *place, const DriverMotion *motions,
                PlaceRow rows[KERNEL_ROW_TURN])
{
    if (!place_is_point(place)) {
        rows[0] = place_row(place, motions, 0);
        rows[1] = place_row(place, motions, 1);
        return;
    }
    const Vec2 points[2] = {driver_point(motions, place->bodies[0], place->anchors[0]),
                            anchor_b(place, motions)};
    rows[0] = row_at(place, motions, (Vec2){1.0, 0.0}, points);
    rows[1] = row_at(place, motions, (Vec2){0.0, 1.0}, points);
}

bool place_is_point(const DriverPlace *place)
{
    return place->shape == DRIVER_HOLE || place->shape == DRIVER_DISC;
}

KernelContact place_contact(const DriverPlace *place)
{
    KernelContact contact = {.law = place->law,
                             .shape = KERNEL_LINE,
                             .joint = place->joint,
                             .siblings = {place->siblings[0], place->siblings[1]},
                             .state = place->contact,
                             .is_rub = place->is_rub};
    const double sign = place->shape == DRIVER_DISC ? -1.0 : 1.0;
    if (place_is_point(place) || place->shape == DRIVER_SLOT) {
        contact.shape = place->shape == DRIVER_HOLE   ? KERNEL_HOLE
                        : place->shape == DRIVER_DISC ? KERNEL_DISC
                                                      : KERNEL_SLOT;
        contact.radial_clearance = sign * place->clearance;
        contact.hole_radius = sign * place->radii[0];
        contact.half_length = place->half_length;
    }
    return contact;
}

void place_position(const DriverPlace *place, const DriverMotion *motions, double position[2])
{
    Vec2 at = {0.0, 0.0};
    if (place->is_rub) {
        at.x = RUB_GAP;
    } else if (place_is_point(place)) {
        at = offset_of(place, motions);
    } else if (place->shape == DRIVER_SLOT) {
        at = in_slot(place, motions);
    } else {
        at.x = place_pose(place, motions).gap;
    }
    position[0] = at.x;
    position[1] = at.y;
}

double place_rate(const DriverPlace *place, const PlaceRow *row, const DriverMotion *motions)
{
    double rate = 0.0;
    for (int side = 0; side < 2; side++) {
        const DriverMotion motion = motion_of(motions, place->bodies[side]);
        rate += vec2_dot(row->along[side], motion.velocity) + row->turn[side] * motion.omega;
    }
    return rate;
}

Vec2 place_force(const DriverPlace *place, const PlaceRow *row, double value)
{
    return place->shape == DRIVER_TURN ? (Vec2){value * row->turn[1], 0.0}
                                       : vec2_scale(value, row->along[1]);
}

// Contacts whose law acts as a force.

DriverContact *places_start(const DriverCase *of)
{
    DriverContact *contacts = driver_room(of->place_count, sizeof *contacts);
    for (size_t i = 0; i < of->place_count; i++) {
        contacts[i].state = of->places[i].contact;
    }
    return contacts;
}

static void follow(const DriverPlace *place, const PlacePose *pose, DriverContact *contact,
                   DriverTotals *totals)
{
    ContactState *state = &contact->state;
    const double depth = -pose->gap;
    contact->begun_share = 0.0;
    if (depth > 0.0) {
        if (!state->is_touching) {
            const double before = fmax(contact->gap_before, 0.0);
            const double share = before / (before + depth);
            contact->begun_share = 1.0 - share;
            *state = contact_state_begun((1.0 - share) * contact->approach_before +
                                         share * pose->approach);
            totals->begun++;
            totals->approach = state->impact_speed;
        }
        contact_state_follow(state, pose->approach, place->law.resting_speed);
        totals->depth_max = fmax(totals->depth_max, depth);
    } else {
        state->is_touching = false;
    }
    contact->gap_before = pose->gap;
    contact->approach_before = pose->approach;
}

void places_follow(const DriverCase *of, const DriverMotion *motions, DriverContact *contacts,
                   DriverTotals *totals)
{
    for (size_t i = 0; i < of->place_count; i++) {
        const DriverPlace *place = &of->places[i];
        const PlacePose pose = place_pose(place, motions);
        follow(place, &pose, &contacts[i], &totals[place->joint]);
    }
}

// What presses along the normal, N; 0 of a place that does not touch.
static double pressing_of(const DriverPlace *place, const DriverContact *contact,
                          const PlacePose *pose)
{
    if (!(pose->gap < 0.0)) {
        return 0.0;
    }
    const double began = fmax(contact->approach_before, pose->approach);
    const double speed = contact->state.is_touching ? contact->state.damping_speed : began;
    return force_law_force(&place->law, -pose->gap, pose->approach, speed);
}

// The force on body b at the point that touches.
static Vec2 force_at(const DriverPlace *place, const PlacePose *pose, double pressing,
                     const DriverMotion *motions)
{
    const Vec2 force = vec2_scale(pressing, pose->normal);
    if (!(place->law.friction > 0.0) || place->shape == DRIVER_RACK ||
        place->shape == DRIVER_TEETH) {
        return force;
    }
    const Vec2 tangent = vec2_perp(pose->normal);
    const double sliding = -approach_along(place, motions, tangent, pose->point);
    const double held =
        place->law.friction * pressing * friction_hold(sliding, place->law.friction_speed).held;
    return vec2_sub(force, vec2_scale(held, tangent));
}

// Lets a row act on both bodies.
static void push_row(const DriverPlace *place, const PlaceRow *row, double value,
                     DriverAction *actions)
{
    for (int side = 0; side < 2; side++) {
        if (place->bodies[side] != DRIVER_GROUND) {
            DriverAction *action = &actions[place->bodies[side]];
            action->force = vec2_add(action->force, vec2_scale(value, row->along[side]));
            action->moment += value * row->turn[side];
        }
    }
}

// Lets a place press. Returns the force on body b, or the torque, and how large it is.
static Vec2 press(const DriverPlace *place, const DriverContact *contact, const PlacePose *at,
                  const DriverMotion *motions, DriverAction *actions, double *size)
{
    const PlacePose pose = *at;
    const double pressing = pressing_of(place, contact, &pose);
    *size = pressing;
    if (pressing == 0.0) {
        return NOTHING;
    }
    const bool is_end = place->shape >= DRIVER_TURN;
    if (is_end) {
        const PlaceRow row = place_row(place, motions, 0);
        if (actions != NULL) {
            push_row(place, &row, pressing, actions);
        }
        return place_force(place, &row, pressing);
    }
    const Vec2 force = force_at(place, &pose, pressing, motions);
    const PlaceRow unit = row_at(place, motions, force, (Vec2[]){pose.point, pose.point});
    if (actions != NULL) {
        push_row(place, &unit, 1.0, actions);
    }
    *size = vec2_length(force);
    return force;
}

// Notes the force of a contact that has been followed to the end of a step.
static void note_force(const DriverPlace *place, const PlacePose *pose, double force, double step_s,
                       DriverContact *contact, DriverPeak *peak)
{
    if (!(pose->gap < 0.0)) {
        contact->peaks = (ContactPeaks){.force = 0.0};
        return;
    }
    if (contact->begun_share > 0.0) {
        // a damper may press from the first instant on
        const double speed = contact->state.impact_speed;
        contact_peaks_begin(&contact->peaks, force_law_viscous(&place->law, 0.0) * speed,
                            contact->begun_share * step_s);
    }
    contact_peaks_note_step(&contact->peaks, force, -pose->gap, 1.0, step_s);
    peak->force = fmax(peak->force, contact->peaks.force);
    peak->depth = fmax(peak->depth, contact->peaks.depth);
}

// Lets the places of a joint press, from the first on. Returns the first of another.
static size_t press_joint(const DriverCase *of, size_t first, DriverContact *contacts,
                          const DriverMotion *motions, DriverAction *actions, Vec2 *force,
                          double step_s, DriverPeak *peak)
{
    double sum = 0.0;
    size_t i = first;
    *peak = (DriverPeak){.force = 0.0};
    for (; i < of->place_count && of->places[i].joint == of->places[first].joint; i++) {
        const DriverPlace *place = &of->places[i];
        const PlacePose pose = place_pose(place, motions);
        double size;
        *force = vec2_add(*force, press(place, &contacts[i], &pose, motions, actions, &size));
        sum += size;
        if (step_s > 0.0) {
            note_force(place, &pose, size, step_s, &contacts[i], peak);
        }
    }
    peak->force = fmax(peak->force, sum);
    return i;
}

void places_press(const DriverCase *of, DriverContact *contacts, const DriverMotion *motions,
                  DriverAction *actions, Vec2 *forces, DriverRun *run, double step_s)
{
    for (size_t i = 0; i < of->joint_count; i++) {
        forces[i] = NOTHING;
    }
    for (size_t i = 0; i < of->place_count;) {
        const int joint = of->places[i].joint;
        DriverPeak peak;
        i = press_joint(of, i, contacts, motions, actions, &forces[joint],
                        run != NULL ? step_s : 0.0, &peak);
        if (run != NULL) {
            run->peaks[joint] = peak;
            run->totals[joint].force_max = fmax(run->totals[joint].force_max, peak.force);
            run->totals[joint].depth_max = fmax(run->totals[joint].depth_max, peak.depth);
        }
    }
}

void places_touches(const DriverRun *run, const DriverMotion *motions, const Vec2 *forces,
                    DriverTouch *touches)
{
    const DriverCase *of = run->of;
    for (size_t i = 0; i < of->place_count;) {
        const DriverPlace *first = &of->places[i];
        const DriverPeak *peak = &run->peaks[first->joint];
        const Vec2 force = forces[first->joint];
        double least = INFINITY;
        Vec2 offset = NOTHING;
        for (; i < of->place_count && of->places[i].joint == first->joint; i++) {
            const PlacePose pose = place_pose(&of->places[i], motions);
            least = fmin(least, pose.gap);
            offset = pose.offset;
        }
        touches[first->joint] = (DriverTouch){
            .eccentricity = first->shape == DRIVER_HOLE ? offset : (Vec2){least, 0.0},
            .force = force,
            .force_max = fmax(vec2_length(force), peak->force),
            .depth_max = fmax(fmax(-least, 0.0), peak->depth),
            .approach = run->totals[first->joint].approach,
        };
    }
}
