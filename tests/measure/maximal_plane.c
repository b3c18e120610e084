// How does a mechanism in the plane move, in x, y and phi of every body?
//
// With W = M^-1 of the bodies that nothing drives, rows J of the ideal joints and their bias g
// (J q'' + g = 0):
//     (J W J') l = -(J a + g),   q'' = a + W J' l,
// a the accelerations by gravity, contacts, springs and the torque, and of the driven body those of
// its path. Rows of a joint, d from anchor a to anchor b, t and n = perp t of its line:
//     revolute     d = 0
//     prismatic    n . d = 0,  phi_b - phi_a = held
#include "maximal.h"

#include "base/drive.h"
#include "base/zeroed.h"
#include "contact/touch.h"

#include <math.h>
#include <stdlib.h>

enum { CLOSINGS = 4, ROW_MOST = 2 };

typedef struct Vec {
    Real x;
    Real y;
} Vec;

// One row over two bodies; the ground's part is 0.
typedef struct Row {
    int body[2];
    Real x[2];
    Real y[2];
    Real turn[2];
    Real value; // how far it is open, m or rad
    Real bias;
} Row;

typedef struct Plane {
    Maximal shared;
    const Linkage *linkage;
    Touch *places;
    int driven;
    Vec2 gravity;
    double *masses;
    double *inertias;
} Plane;

static const Plane *plane_of(const Maximal *maximal)
{
    return (const Plane *)maximal;
}

static Vec vec_add(Vec a, Vec b)
{
    return (Vec){a.x + b.x, a.y + b.y};
}

static Vec vec_sub(Vec a, Vec b)
{
    return (Vec){a.x - b.x, a.y - b.y};
}

static Vec vec_times(Real factor, Vec a)
{
    return (Vec){factor * a.x, factor * a.y};
}

static Vec vec_perp(Vec a)
{
    return (Vec){-a.y, a.x};
}

static Real vec_dot(Vec a, Vec b)
{
    return a.x * b.x + a.y * b.y;
}

static Real vec_cross(Vec a, Vec b)
{
    return a.x * b.y - a.y * b.x;
}

static Real vec_length(Vec a)
{
    return sqrtl(vec_dot(a, a));
}

// A state: coordinates x, y, phi of each body, then their rates.
typedef struct View {
    const Real *q;
    const Real *v;
    const Vec *along; // by body, of its x axis; NULL where it is found when asked for
} View;

static View view_of(const Plane *plane, const Real *y)
{
    return (View){.q = y, .v = y + 3 * plane->linkage->body_count};
}

static Real angle_of(View view, int body)
{
    return body == LINKAGE_GROUND ? 0.0L : view.q[3 * body + 2];
}

static Real omega_of(View view, int body)
{
    return body == LINKAGE_GROUND ? 0.0L : view.v[3 * body + 2];
}

static Vec centre_of(View view, int body)
{
    return body == LINKAGE_GROUND ? (Vec){0.0L, 0.0L}
                                  : (Vec){view.q[3 * body], view.q[3 * body + 1]};
}

static Vec direction_of(Real angle)
{
    return (Vec){cosl(angle), sinl(angle)};
}

static Vec turned(Vec along, Vec2 local)
{
    return (Vec){along.x * local.x - along.y * local.y, along.y * local.x + along.x * local.y};
}

// A point of a body from its centre, or of the ground from the origin.
static Vec arm_of(View view, int body, Vec2 local)
{
    if (body == LINKAGE_GROUND) {
        return (Vec){local.x, local.y};
    }
    return turned(view.along != NULL ? view.along[body] : direction_of(angle_of(view, body)),
                  local);
}

static Vec velocity_of(View view, int body, Vec arm)
{
    if (body == LINKAGE_GROUND) {
        return (Vec){0.0L, 0.0L};
    }
    return vec_add((Vec){view.v[3 * body], view.v[3 * body + 1]},
                   vec_times(omega_of(view, body), vec_perp(arm)));
}

static Vec along_of(View view, int body, double direction)
{
    return direction_of(angle_of(view, body) + direction);
}

// Two anchors of two bodies, seen from their centres, and what lies between them.
typedef struct Ends {
    int body[2];
    Vec arm[2];
    Vec apart; // m, of b less of a
    Vec moving;
} Ends;

static Ends ends_of(View view, int body_a, Vec2 anchor_a, int body_b, Vec2 anchor_b)
{
    Ends ends = {.body = {body_a, body_b}};
    ends.arm[0] = arm_of(view, body_a, anchor_a);
    ends.arm[1] = arm_of(view, body_b, anchor_b);
    ends.apart = vec_sub(vec_add(centre_of(view, body_b), ends.arm[1]),
                         vec_add(centre_of(view, body_a), ends.arm[0]));
    ends.moving =
        vec_sub(velocity_of(view, body_b, ends.arm[1]), velocity_of(view, body_a, ends.arm[0]));
    return ends;
}

static Ends ends_of_joint(View view, const Joint *joint)
{
    return ends_of(view, joint->body_a, joint->anchor_a, joint->body_b, joint->anchor_b);
}

static void rows_of(View view, const Joint *joint, Row rows[ROW_MOST])
{
    const Ends ends = ends_of_joint(view, joint);
    const Real wa = omega_of(view, joint->body_a);
    const Real wb = omega_of(view, joint->body_b);
    const Vec bias = vec_sub(vec_times(wa * wa, ends.arm[0]), vec_times(wb * wb, ends.arm[1]));
    for (int i = 0; i < ROW_MOST; i++) {
        rows[i] = (Row){.body = {joint->body_a, joint->body_b}};
    }
    if (joint->kind == JOINT_REVOLUTE || joint->kind == JOINT_CLEARANCE) {
        const Vec2 start = joint->kind == JOINT_CLEARANCE ? joint->clearance.start : (Vec2){0, 0};
        for (int side = 0; side < 2; side++) {
            const Real sign = side == 0 ? -1.0L : 1.0L;
            rows[0].x[side] = sign;
            rows[0].turn[side] = -sign * ends.arm[side].y;
            rows[1].y[side] = sign;
            rows[1].turn[side] = sign * ends.arm[side].x;
        }
        rows[0].value = ends.apart.x - start.x;
        rows[1].value = ends.apart.y - start.y;
        rows[0].bias = bias.x;
        rows[1].bias = bias.y;
        return;
    }
    const Vec2 start = joint->kind == JOINT_GUIDE ? joint->guide.start : (Vec2){0, 0};
    const Vec t = along_of(view, joint->body_a, joint->direction);
    const Vec n = vec_perp(t);
    const Vec lever = vec_add(ends.arm[0], ends.apart);
    rows[0].x[0] = -n.x;
    rows[0].y[0] = -n.y;
    rows[0].turn[0] = -vec_cross(lever, n);
    rows[0].x[1] = n.x;
    rows[0].y[1] = n.y;
    rows[0].turn[1] = vec_cross(ends.arm[1], n);
    rows[0].value = vec_dot(n, ends.apart) - start.x;
    rows[0].bias =
        vec_dot(n, bias) - 2.0L * wa * vec_dot(t, ends.moving) - wa * wa * vec_dot(n, ends.apart);
    rows[1].turn[0] = -1.0L;
    rows[1].turn[1] = 1.0L;
    rows[1].value =
        angle_of(view, joint->body_b) - angle_of(view, joint->body_a) - joint->held_angle - start.y;
}

static bool is_free(const Plane *plane, int body)
{
    return body != LINKAGE_GROUND && body != plane->driven;
}

// All rows that hold bodies that nothing drives, of ideal joints or also of those with play.
static size_t list_rows(const Plane *plane, View view, bool with_play, Row *rows)
{
    const Linkage *linkage = plane->linkage;
    size_t count = 0;
    for (size_t i = 0; i < linkage->joint_count; i++) {
        const Joint *joint = &linkage->joints[i];
        const bool has_play = joint->kind == JOINT_CLEARANCE || joint->kind == JOINT_GUIDE;
        if ((joint_is_ideal(joint->kind) || (with_play && has_play)) &&
            (is_free(plane, joint->body_a) || is_free(plane, joint->body_b))) {
            rows_of(view, joint, rows + count);
            count += ROW_MOST;
        }
    }
    return count;
}

// What a row's coefficients make of three numbers a body.
static Real row_times(const Row *row, const Real *of)
{
    Real sum = 0.0L;
    for (int side = 0; side < 2; side++) {
        const int body = row->body[side];
        if (body != LINKAGE_GROUND) {
            sum += row->x[side] * of[3 * body] + row->y[side] * of[3 * body + 1] +
                   row->turn[side] * of[3 * body + 2];
        }
    }
    return sum;
}

// What one row's coefficients make of W J' of another.
static Real rows_share(const Plane *plane, const Row *a, const Row *b)
{
    Real sum = 0.0L;
    for (int i = 0; i < 2; i++) {
        for (int k = 0; k < 2; k++) {
            const int body = a->body[i];
            if (body == b->body[k] && is_free(plane, body)) {
                sum += (a->x[i] * b->x[k] + a->y[i] * b->y[k]) / plane->masses[body] +
                       a->turn[i] * b->turn[k] / plane->inertias[body];
            }
        }
    }
    return sum;
}

// W J' l for one row, added to three numbers a body.
static void add_row(const Plane *plane, const Row *row, Real share, Real *to)
{
    for (int side = 0; side < 2; side++) {
        const int body = row->body[side];
        if (is_free(plane, body)) {
            to[3 * body] += share * row->x[side] / plane->masses[body];
            to[3 * body + 1] += share * row->y[side] / plane->masses[body];
            to[3 * body + 2] += share * row->turn[side] / plane->inertias[body];
        }
    }
}

// Changes three numbers a body by W J' l so that the rows of them become -right.
static void meet_rows(const Plane *plane, size_t count, const Row *rows, Real *right, Real *of)
{
    Real *matrix = zeroed(count * count, sizeof *matrix);
    for (size_t i = 0; i < count; i++) {
        right[i] = -right[i] - row_times(&rows[i], of);
        for (size_t k = 0; k <= i; k++) {
            matrix[k * count + i] = rows_share(plane, &rows[k], &rows[i]);
            matrix[i * count + k] = matrix[k * count + i];
        }
    }
    maximal_solve(count, matrix, right);
    for (size_t i = 0; i < count; i++) {
        add_row(plane, &rows[i], right[i], of);
    }
    free(matrix);
}

// Where a drive without points is at a time: at a constant speed, held, or by a sinusoid.
typedef struct Path {
    Real angle;
    Real omega;
    Real alpha;
} Path;

static Path path_of(const Driver *driver, Real t)
{
    const Wave *wave = &driver->table.wave;
    if (driver->table.count == 0) {
        return (Path){driver->start + driver->speed * t, driver->speed, 0.0L};
    }
    const Real a = wave->amplitude;
    const Real w = wave->rate;
    const Real p = wave->phase;
    if (driver->has_angles) {
        return (Path){driver->start + driver->table.values[0] + a * sinl(w * t + p),
                      a * w * cosl(w * t + p), -a * w * w * sinl(w * t + p)};
    }
    const Real v = driver->table.values[0];
    return (Path){driver->start + v * t + a / w * (cosl(p) - cosl(w * t + p)),
                  v + a * sinl(w * t + p), a * w * cosl(w * t + p)};
}

static bool is_wave(const Driver *driver)
{
    return driver->table.count > 0 && driver->table.wave.rate > 0.0;
}

// Puts the driven body on its path.
static void put_driven(const Plane *plane, Real time_s, Real *q, Real *v)
{
    if (plane->driven == LINKAGE_GROUND) {
        return;
    }
    const Driver *driver = &plane->linkage->driver;
    const Joint *joint = &plane->linkage->joints[driver->joint];
    Real omega = driver->speed;
    if (driver->table.count > 0) {
        // either piece says the same at a bend
        const TimePiece piece = time_table_piece(&driver->table, (double)time_s);
        omega = piece.value + piece.slope * (time_s - piece.time_s);
    }
    Real *of = q + 3 * plane->driven;
    Real *rate = v + 3 * plane->driven;
    of[2] = drive_angle_exact(driver, time_s);
    if (is_wave(driver)) {
        const Path path = path_of(driver, time_s);
        of[2] = path.angle;
        omega = path.omega;
    }
    const Vec arm = turned(direction_of(of[2]), joint->anchor_b);
    of[0] = joint->anchor_a.x - arm.x;
    of[1] = joint->anchor_a.y - arm.y;
    rate[0] = omega * arm.y;
    rate[1] = -omega * arm.x;
    rate[2] = omega;
}

static void project(const Maximal *maximal, Real time_s, Real *y)
{
    const Plane *plane = plane_of(maximal);
    const Linkage *linkage = plane->linkage;
    const bool is_start = time_s < 0.0L;
    const bool with_play = is_start && linkage->driver.is_present;
    Real *v = y + 3 * linkage->body_count;
    Row *rows = zeroed(ROW_MOST * linkage->joint_count, sizeof *rows);
    Real *right = zeroed(ROW_MOST * linkage->joint_count, sizeof *right);
    Real *change = zeroed(3 * linkage->body_count, sizeof *change);
    put_driven(plane, is_start ? 0.0L : time_s, y, v);
    for (int round = 0; round < (is_start ? 2 * CLOSINGS : 2); round++) {
        const size_t count = list_rows(plane, view_of(plane, y), with_play, rows);
        for (size_t i = 0; i < count; i++) {
            right[i] = rows[i].value;
        }
        for (size_t i = 0; i < 3 * linkage->body_count; i++) {
            change[i] = 0.0L;
        }
        meet_rows(plane, count, rows, right, change);
        for (size_t i = 0; i < 3 * linkage->body_count; i++) {
            y[i] += change[i];
        }
    }
    const size_t count = list_rows(plane, view_of(plane, y), false, rows);
    for (size_t i = 0; i < count; i++) {
        right[i] = 0.0L;
    }
    meet_rows(plane, count, rows, right, v);
    free(rows);
    free(right);
    free(change);
}

// A contact's normal and, from the centres of its bodies, where it acts.
typedef struct Pose {
    MaximalGap gap;
    Vec normal;   // direction of the force on body b; 0 of a turn
    Vec at[2];    // from the centres
    Vec apart;    // from anchor a to anchor b
    Real sliding; // m/s
    Real lever;   // m: of gears, by what the force twists gear b beside its moment, and gear a back
} Pose;

static Real coordinate_of(const Plane *plane, View view, const Touch *place, bool is_rate)
{
    const Joint *joint = &plane->linkage->joints[place->joint];
    Real (*of)(View, int) = is_rate ? omega_of : angle_of;
    const Real a = of(view, joint->body_a);
    const Real b = of(view, joint->body_b);
    return joint->body_b == LINKAGE_GROUND ? a - b : b - a;
}

// How far the pitch circle of a rack's pinion has come along the rack, from how far its centre has
// and how far it has turned on the rack.
static Real way_on_rack(const Plane *plane, View view, const Touch *place, const Ends *ends)
{
    const Joint *joint = &plane->linkage->joints[place->joint];
    const Vec along = along_of(view, joint->body_a, place->direction);
    const Real turned = angle_of(view, joint->body_b) - angle_of(view, joint->body_a);
    return vec_dot(along, ends->apart) + place->radius_b * turned;
}

// How far a point, seen from a cam's centre in the cam's own directions, is from the profile at an
// angle, squared.
static Real apart_squared(const Profile *profile, Vec point, Real angle)
{
    const Real r = profile_at(profile, (double)angle).r;
    const Vec to = {point.x - r * cosl(angle), point.y - r * sinl(angle)};
    return vec_dot(to, to);
}

// The angle at which a function of it is least: by a scan all round, and where the slope there goes
// through 0, by bisection and then secants.
typedef Real (*OfAngle)(const Profile *profile, Vec vector, Real angle);

static Real least_at(OfAngle of, OfAngle slope, const Profile *profile, Vec vector)
{
    enum { SCAN = 48, HALVES = 12, SECANTS = 5 };
    const Real pitch = 2.0L * M_PI / SCAN;
    Real at = 0.0L;
    Real least = INFINITY;
    for (int i = 0; i < SCAN; i++) {
        const Real value = of(profile, vector, i * pitch);
        at = value < least ? i * pitch : at;
        least = fminl(least, value);
    }
    Real low = at - pitch;
    Real high = at + pitch;
    for (int i = 0; i < HALVES; i++) {
        const Real middle = 0.5L * (low + high);
        *(slope(profile, vector, middle) > 0.0L ? &high : &low) = middle;
    }
    Real before = low;
    Real now = high;
    Real slope_before = slope(profile, vector, before);
    for (int i = 0; i < SECANTS; i++) {
        const Real slope_now = slope(profile, vector, now);
        if (slope_now == slope_before) {
            break;
        }
        const Real next = now - slope_now * (now - before) / (slope_now - slope_before);
        before = now;
        slope_before = slope_now;
        now = next;
    }
    return now;
}

static Vec tangent_at(const Profile *profile, Real angle)
{
    const ProfileAt at = profile_at(profile, (double)angle);
    const Real c = cosl(angle);
    const Real s = sinl(angle);
    return (Vec){at.r1 * c - at.r * s, at.r1 * s + at.r * c};
}

static Real apart_slope(const Profile *profile, Vec point, Real angle)
{
    const Real r = profile_at(profile, (double)angle).r;
    const Vec to = {point.x - r * cosl(angle), point.y - r * sinl(angle)};
    return -vec_dot(to, tangent_at(profile, angle));
}

static Real reach_slope(const Profile *profile, Vec direction, Real angle)
{
    return -vec_dot(direction, tangent_at(profile, angle));
}

// The reach of the profile along a direction, negative: it is least where that is largest.
static Real reach_negative(const Profile *profile, Vec direction, Real angle)
{
    const Real r = profile_at(profile, (double)angle).r;
    return -r * (direction.x * cosl(angle) + direction.y * sinl(angle));
}

static Vec turn_by(Real angle, Vec vector)
{
    return (Vec){cosl(angle) * vector.x - sinl(angle) * vector.y,
                 sinl(angle) * vector.x + cosl(angle) * vector.y};
}

// A roller or flat at a cam: normal, depth and where they touch, and the rate by the two points of
// the bodies there.
static void meet_cam(const Plane *plane, View view, const Touch *place, const Ends *ends,
                     Pose *pose)
{
    const Joint *joint = &plane->linkage->joints[place->joint];
    const Cam *cam = &place->cam;
    const Real zero = angle_of(view, joint->body_a) + cam->direction;
    const Vec seen = turn_by(-zero, ends->apart);
    Vec from_b;
    if (cam->is_flat) {
        const Vec facing = along_of(view, joint->body_b, cam->facing);
        pose->normal = vec_times(-1.0L, facing);
        const Vec out = turn_by(-zero, pose->normal);
        const Real at = least_at(reach_negative, reach_slope, cam->profile, out);
        const Real r = profile_at(cam->profile, (double)at).r;
        const Vec met = turn_by(zero, (Vec){r * cosl(at), r * sinl(at)});
        pose->gap.depth = vec_dot(pose->normal, vec_sub(met, ends->apart));
        // on the flat, as a roller's own surface
        from_b = vec_sub(vec_sub(met, vec_times(pose->gap.depth, pose->normal)), ends->apart);
    } else {
        const Real at = least_at(apart_squared, apart_slope, cam->profile, seen);
        const ProfileAt r = profile_at(cam->profile, (double)at);
        const Vec tangent = tangent_at(cam->profile, at);
        const Vec out = vec_times(-1.0L / vec_length(tangent), vec_perp(tangent));
        const Vec to = {seen.x - r.r * cosl(at), seen.y - r.r * sinl(at)};
        pose->normal = turn_by(zero, out);
        pose->gap.depth = place->radius_b - vec_dot(out, to);
        from_b = vec_times(-place->radius_b, pose->normal);
    }
    pose->at[0] = vec_add(ends->arm[0], vec_add(ends->apart, from_b));
    pose->at[1] = vec_add(ends->arm[1], from_b);
    const Vec relative = vec_sub(velocity_of(view, joint->body_b, pose->at[1]),
                                 velocity_of(view, joint->body_a, pose->at[0]));
    pose->gap.closing = -vec_dot(pose->normal, relative);
    pose->sliding = vec_dot(vec_perp(pose->normal), relative);
}

// A pin in a slot: its centre in the slot's own directions, and the rate by the two points of the
// bodies where it touches the wall.
static void meet_slot(const Plane *plane, View view, const Touch *place, const Ends *ends,
                      Pose *pose)
{
    const Joint *joint = &plane->linkage->joints[place->joint];
    const Vec across = along_of(view, joint->body_a, place->direction);
    const Vec along = vec_perp(across);
    const Real half = 0.5L * joint->stop.slot;
    const Real seen = vec_dot(along, ends->apart);
    const Real middle = fmaxl(-half, fminl(half, seen));
    const Vec out = vec_sub(ends->apart, vec_times(middle, along));
    const Vec off = fabsl(seen) > half ? out : vec_times(vec_dot(across, out), across);
    const Real distance = vec_length(off);
    pose->gap.depth = distance - (joint->stop.radius_a - (Real)joint->stop.radius_b);
    pose->normal = distance > 0.0L ? vec_times(-1.0L / distance, off) : across;
    const Vec wall =
        vec_sub(vec_times(middle, along), vec_times(joint->stop.radius_a, pose->normal));
    pose->at[0] = vec_add(ends->arm[0], wall);
    pose->at[1] = vec_add(ends->arm[1], vec_sub(wall, ends->apart));
    const Vec relative = vec_sub(velocity_of(view, joint->body_b, pose->at[1]),
                                 velocity_of(view, joint->body_a, pose->at[0]));
    pose->gap.closing = -vec_dot(pose->normal, relative);
    pose->sliding = vec_dot(vec_perp(pose->normal), relative);
}

// Where the force acts: on the wall of body a, or on the circle of body b.
static void place_force(const Touch *place, const Ends *ends, Pose *pose)
{
    Vec from_a;
    switch (place->shape) {
    case TOUCH_HOLE:
        from_a = vec_times(-place->radius_a, pose->normal);
        break;
    case TOUCH_DISC:
        from_a = vec_times(place->radius_a, pose->normal);
        break;
    case TOUCH_TEETH:
        from_a =
            vec_times(place->radius_a / ((Real)place->radius_a + place->radius_b), ends->apart);
        break;
    case TOUCH_RACK:
        // towards the rack, square to its line
        from_a = vec_sub(ends->apart,
                         vec_times(place->radius_b * (Real)place->sign, vec_perp(pose->normal)));
        break;
    default:
        from_a = vec_sub(ends->apart, vec_times(place->radius_b, pose->normal));
    }
    pose->at[0] = vec_add(ends->arm[0], from_a);
    pose->at[1] = vec_add(ends->arm[1], vec_sub(from_a, ends->apart));
}

// How far a flank stands out by the tables of its gears, and the lever of what that changes.
static Real stand_out(const Plane *plane, View view, const Touch *place, Pose *pose)
{
    const Joint *joint = &plane->linkage->joints[place->joint];
    const Gear *gear = &joint->gear;
    const Real share = gear->radius_b / ((Real)gear->radius_a + gear->radius_b);
    // the angle of gear a against the line of the centres, taken from both gears
    const Real turned =
        share * (angle_of(view, joint->body_a) - angle_of(view, joint->body_b)) - gear->zero;
    const size_t tables[2] = {gear->error, gear->relief};
    Real out_by = 0.0L;
    for (int i = 0; i < 2; i++) {
        if (tables[i] > 0) {
            const ProfileAt at =
                profile_at(&plane->linkage->profiles[tables[i] - 1], (double)turned);
            const Real factor = i == 0 ? place->sign : -1.0L;
            out_by += factor * at.r;
            pose->lever += factor * share * at.r1;
        }
    }
    return out_by;
}

// How far the string between the base circles of two gears is from being unwound: the flanks are
// involutes, so that along the line of action, the common tangent of the circles, each reaches as
// far as its circle has unwound to the point where the tangent leaves it.
static void meet_teeth(const Plane *plane, View view, const Touch *place, const Ends *ends,
                       Pose *pose)
{
    const Joint *joint = &plane->linkage->joints[place->joint];
    const Gear *gear = &joint->gear;
    const Real pitch = (Real)gear->radius_a + gear->radius_b;
    const Real alpha = gear->pressure_angle;
    const Real base[2] = {gear->radius_a * cosl(alpha), gear->radius_b * cosl(alpha)};
    const Real around = base[0] + base[1];
    const Real out = alpha == 0.0L ? 0.0L : base[0] * base[1] > 0.0L ? 1.0L : -1.0L;
    const Real distance = vec_length(ends->apart);
    const Real working = alpha == 0.0L ? 0.0L : acosl(around / distance);
    const Real line =
        atan2l(ends->apart.y, ends->apart.x) + place->sign * (0.5L * acosl(-1.0L) - out * working);
    pose->normal = direction_of(line);
    place_force(place, ends, pose);
    const Real unwound = base[0] * (angle_of(view, joint->body_a) - line) +
                         base[1] * (angle_of(view, joint->body_b) - line);
    const Real placed = out * pitch * sinl(alpha) + around * (0.5L * acosl(-1.0L) - out * alpha);
    const Real gap = vec_dot(pose->normal, ends->apart) * (out == 0.0L ? 0.0L : 1.0L) -
                     place->sign * unwound - placed - place->clearance * cosl(alpha);
    const Real out_by = stand_out(plane, view, place, pose);
    // of whole turns the one at which the gap's middle is nearest
    const Real middle = (place->sign * joint->limits.middle - place->clearance) * cosl(alpha);
    pose->gap.depth = out_by - (middle + remainderl(gap - middle, 2.0L * acosl(-1.0L) * around));
    pose->gap.closing =
        -vec_dot(pose->normal, vec_sub(velocity_of(view, joint->body_b, pose->at[1]),
                                       velocity_of(view, joint->body_a, pose->at[0]))) +
        pose->lever * (omega_of(view, joint->body_a) - omega_of(view, joint->body_b));
}

static Pose pose_of(const Plane *plane, View view, const Touch *place)
{
    const Joint *joint = &plane->linkage->joints[place->joint];
    const Ends ends = ends_of(view, joint->body_a, place->anchor_a, joint->body_b, place->anchor_b);
    Pose pose = {.apart = ends.apart};
    if (place->shape == TOUCH_TURN) {
        pose.gap.depth = place->clearance - place->sign * coordinate_of(plane, view, place, false);
        pose.gap.closing = -place->sign * coordinate_of(plane, view, place, true);
        return pose;
    }
    if (place->shape == TOUCH_TEETH) {
        meet_teeth(plane, view, place, &ends, &pose);
        return pose;
    }
    if (place->shape == TOUCH_CAM) {
        meet_cam(plane, view, place, &ends, &pose);
        return pose;
    }
    if (place->shape == TOUCH_SLOT) {
        meet_slot(plane, view, place, &ends, &pose);
        return pose;
    }
    if (place->shape == TOUCH_RACK) {
        pose.normal = vec_times(place->sign, along_of(view, joint->body_a, place->direction));
        place_force(place, &ends, &pose);
        pose.gap.depth = place->clearance - place->sign * way_on_rack(plane, view, place, &ends);
        // by the two points of the bodies at which teeth push
        pose.gap.closing =
            -vec_dot(pose.normal, vec_sub(velocity_of(view, joint->body_b, pose.at[1]),
                                          velocity_of(view, joint->body_a, pose.at[0])));
        return pose;
    }
    if (place->shape == TOUCH_LINE) {
        pose.normal = along_of(view, joint->body_a, place->direction);
        pose.gap.depth = place->clearance - vec_dot(pose.normal, ends.apart);
        pose.gap.closing =
            -vec_dot(pose.normal, ends.moving) -
            omega_of(view, joint->body_a) * vec_dot(vec_perp(pose.normal), ends.apart);
    } else {
        const Real outside = place->shape == TOUCH_DISC ? 1.0L : -1.0L;
        const Real distance = vec_length(ends.apart);
        pose.gap.depth = outside * (place->clearance - distance);
        pose.normal = distance > 0.0L ? vec_times(outside / distance, ends.apart) : (Vec){0, 0};
        pose.gap.closing =
            distance > 0.0L ? -vec_dot(pose.normal, ends.moving) : vec_length(ends.moving);
    }
    place_force(place, &ends, &pose);
    const Vec relative = vec_sub(velocity_of(view, joint->body_b, pose.at[1]),
                                 velocity_of(view, joint->body_a, pose.at[0]));
    pose.sliding = vec_dot(vec_perp(pose.normal), relative);
    return pose;
}

static MaximalGap gap(const Maximal *maximal, size_t contact, const Real *y)
{
    const Plane *plane = plane_of(maximal);
    return pose_of(plane, view_of(plane, y), &plane->places[contact]).gap;
}

// Of a slot the centres of the arcs at its ends; of all others there is none.
static Real corner(const Maximal *maximal, size_t contact, const Real *y)
{
    const Plane *plane = plane_of(maximal);
    const View view = view_of(plane, y);
    const Touch *place = &plane->places[contact];
    const Joint *joint = &plane->linkage->joints[place->joint];
    if (place->shape != TOUCH_SLOT) {
        return 1.0L;
    }
    const Ends ends = ends_of(view, joint->body_a, place->anchor_a, joint->body_b, place->anchor_b);
    const Vec along = vec_perp(along_of(view, joint->body_a, place->direction));
    return fabsl(vec_dot(along, ends.apart)) - 0.5L * joint->stop.slot;
}

// Adds a force at a point of a body, and a moment, to accelerations.
static void push(const Plane *plane, int body, Vec arm, Vec force, Real moment, Real *accelerations)
{
    if (is_free(plane, body)) {
        accelerations[3 * body] += force.x / plane->masses[body];
        accelerations[3 * body + 1] += force.y / plane->masses[body];
        accelerations[3 * body + 2] += (vec_cross(arm, force) + moment) / plane->inertias[body];
    }
}

static void push_pair(const Plane *plane, const int body[2], const Vec at[2], Vec force,
                      Real *accelerations)
{
    push(plane, body[1], at[1], force, 0.0L, accelerations);
    push(plane, body[0], at[0], vec_times(-1.0L, force), 0.0L, accelerations);
}

// A moment that a joint's turned body gets: its body b, or a where b is the ground.
static void turn_joint(const Plane *plane, int number, Real moment, Real *accelerations)
{
    const Joint *joint = &plane->linkage->joints[number];
    const Real sign = joint->body_b == LINKAGE_GROUND ? -1.0L : 1.0L;
    const Vec none = {0.0L, 0.0L};
    push(plane, joint->body_b, none, none, sign * moment, accelerations);
    push(plane, joint->body_a, none, none, -sign * moment, accelerations);
}

static void add_contacts(const Plane *plane, View view, Real *accelerations)
{
    const ContactOptions *options = &plane->shared.scenario->contact;
    for (size_t i = 0; i < plane->shared.contact_count; i++) {
        const MaximalContact *contact = &plane->shared.contacts[i];
        const Touch *place = &plane->places[i];
        if (contact->mode != MAXIMAL_PRESSED) {
            continue;
        }
        const Pose pose = pose_of(plane, view, place);
        const Real force = maximal_press(contact, pose.gap);
        if (place->shape == TOUCH_TURN) {
            turn_joint(plane, place->joint, place->sign * force, accelerations);
            continue;
        }
        const bool rolls = place->shape == TOUCH_TEETH || place->shape == TOUCH_RACK;
        const Real held =
            rolls ? 0.0L
                  : options->friction * force * tanhl(pose.sliding / options->friction_speed);
        const Joint *joint = &plane->linkage->joints[place->joint];
        if (place->shape == TOUCH_TEETH) {
            const Vec none = {0.0L, 0.0L};
            push(plane, joint->body_a, none, none, -pose.lever * force, accelerations);
            push(plane, joint->body_b, none, none, pose.lever * force, accelerations);
        }
        push_pair(plane, (const int[2]){joint->body_a, joint->body_b}, pose.at,
                  vec_sub(vec_times(force, pose.normal), vec_times(held, vec_perp(pose.normal))),
                  accelerations);
    }
}

static void add_springs(const Plane *plane, View view, Real *accelerations)
{
    const Linkage *linkage = plane->linkage;
    for (size_t i = 0; i < linkage->spring_count; i++) {
        const Spring *spring = &linkage->springs[i];
        const Ends ends =
            ends_of(view, spring->body_a, spring->anchor_a, spring->body_b, spring->anchor_b);
        const Real distance = vec_length(ends.apart);
        const Vec along = vec_times(1.0L / distance, ends.apart);
        const Real tension = spring->stiffness * (distance - spring->length) +
                             spring->damping * vec_dot(along, ends.moving);
        push_pair(plane, ends.body, ends.arm, vec_times(-tension, along), accelerations);
    }
    for (size_t i = 0; i < linkage->torsion_count; i++) {
        const TorsionSpring *spring = &linkage->torsions[i];
        const Joint *joint = &linkage->joints[spring->joint];
        const Real sign = joint->body_b == LINKAGE_GROUND ? -1.0L : 1.0L;
        const Real angle = sign * (angle_of(view, joint->body_b) - angle_of(view, joint->body_a));
        const Real rate = sign * (omega_of(view, joint->body_b) - omega_of(view, joint->body_a));
        turn_joint(plane, spring->joint,
                   -spring->stiffness * (angle - spring->angle) - spring->damping * rate,
                   accelerations);
    }
}

// The torque of a soft drive, before its limit.
static Real followed_torque(const Plane *plane, Real time_s, View view)
{
    const Torque *torque = &plane->linkage->torque;
    const Joint *joint = &plane->linkage->joints[torque->joint];
    const Path path = path_of(&torque->followed, time_s);
    const Real sign = joint->body_b == LINKAGE_GROUND ? -1.0L : 1.0L;
    const Real angle = sign * (angle_of(view, joint->body_b) - angle_of(view, joint->body_a));
    const Real rate = sign * (omega_of(view, joint->body_b) - omega_of(view, joint->body_a));
    return torque->stiffness * (path.angle - angle) + torque->slope * (path.omega - rate);
}

static Real limit(const Maximal *maximal, Real time_s, const Real *y)
{
    const Plane *plane = plane_of(maximal);
    const Torque *torque = &plane->linkage->torque;
    return torque->limit == 0.0
               ? -1.0L
               : fabsl(followed_torque(plane, time_s, view_of(plane, y))) - torque->limit;
}

static void add_torque(const Plane *plane, double since_s, Real time_s, View view,
                       Real *accelerations)
{
    const Torque *torque = &plane->linkage->torque;
    if (torque->table.count == 0) {
        return;
    }
    const TimePiece piece = time_table_piece(&torque->table, since_s);
    const Wave *wave = &torque->table.wave;
    Real value =
        piece.value + piece.slope * (time_s - piece.time_s) +
        (wave->rate > 0.0 ? wave->amplitude * sinl(wave->rate * time_s + wave->phase) : 0.0L);
    if (torque->followed.is_present) {
        value = followed_torque(plane, time_s, view);
        value = torque->limit > 0.0 ? fminl(fmaxl(value, -torque->limit), torque->limit) : value;
    }
    const Joint *joint = &plane->linkage->joints[torque->joint];
    if (joint->kind != JOINT_PRISMATIC) {
        turn_joint(plane, torque->joint, value, accelerations);
        return;
    }
    const Ends ends = ends_of_joint(view, joint);
    // both forces act at the anchor of body b
    const Vec at[2] = {vec_add(ends.arm[0], ends.apart), ends.arm[1]};
    push_pair(plane, ends.body, at,
              vec_times(value, along_of(view, joint->body_a, joint->direction)), accelerations);
}

// Torques on bodies and forces at their points, constant or sinusoids; other loads are refused.
static void add_loads(const Plane *plane, Real time_s, View view, Real *accelerations)
{
    for (size_t i = 0; i < plane->linkage->load_count; i++) {
        const Load *load = &plane->linkage->loads[i];
        const Wave *wave = &load->table.wave;
        const Vec none = {0.0L, 0.0L};
        Real value = load->table.values[0];
        value +=
            wave->rate > 0.0 ? wave->amplitude * sinl(wave->rate * time_s + wave->phase) : 0.0L;
        if (load->kind == LOAD_TORQUE) {
            push(plane, load->body, none, none, value, accelerations);
            continue;
        }
        const Vec along = load->frame == LOAD_IN_BODY ? along_of(view, load->body, load->direction)
                                                      : direction_of(load->direction);
        push(plane, load->body, arm_of(view, load->body, load->anchor), vec_times(value, along),
             0.0L, accelerations);
    }
}

static bool has_other_loads(const Linkage *linkage)
{
    for (size_t i = 0; i < linkage->load_count; i++) {
        const Load *load = &linkage->loads[i];
        if (load->kind == LOAD_ALONG || load->table.count != 1) {
            return true;
        }
    }
    return false;
}

static void rates(const Maximal *maximal, double since_s, Real time_s, const Real *y, Real *out)
{
    const Plane *plane = plane_of(maximal);
    const Linkage *linkage = plane->linkage;
    const size_t n = 3 * linkage->body_count;
    View view = view_of(plane, y);
    Vec *along = zeroed(linkage->body_count, sizeof *along);
    Real *accelerations = out + n;
    for (size_t i = 0; i < linkage->body_count; i++) {
        along[i] = direction_of(view.q[3 * i + 2]);
    }
    view.along = along;
    for (size_t i = 0; i < linkage->body_count; i++) {
        accelerations[3 * i] = plane->gravity.x;
        accelerations[3 * i + 1] = plane->gravity.y;
        accelerations[3 * i + 2] = 0.0L;
    }
    for (size_t i = 0; i < n; i++) {
        out[i] = view.v[i];
    }
    if (plane->driven != LINKAGE_GROUND) {
        const Driver *driver = &linkage->driver;
        const Joint *joint = &linkage->joints[driver->joint];
        const Real alpha = is_wave(driver) ? path_of(driver, time_s).alpha
                           : driver->table.count > 0
                               ? time_table_piece(&driver->table, since_s).slope
                               : 0.0;
        const Real omega = view.v[3 * plane->driven + 2];
        const Vec arm = arm_of(view, plane->driven, joint->anchor_b);
        Real *of = accelerations + 3 * plane->driven;
        of[0] = omega * omega * arm.x + alpha * arm.y;
        of[1] = omega * omega * arm.y - alpha * arm.x;
        of[2] = alpha;
    }
    add_contacts(plane, view, accelerations);
    add_springs(plane, view, accelerations);
    add_torque(plane, since_s, time_s, view, accelerations);
    add_loads(plane, time_s, view, accelerations);
    Row *rows = zeroed(ROW_MOST * linkage->joint_count, sizeof *rows);
    Real *right = zeroed(ROW_MOST * linkage->joint_count, sizeof *right);
    const size_t count = list_rows(plane, view, false, rows);
    for (size_t i = 0; i < count; i++) {
        right[i] = rows[i].bias;
    }
    meet_rows(plane, count, rows, right, accelerations);
    free(along);
    free(rows);
    free(right);
}

static void sample(const Maximal *maximal, const Real *y, Trajectory *trajectory, size_t number)
{
    const Plane *plane = plane_of(maximal);
    const View view = view_of(plane, y);
    for (size_t i = 0; i < plane->linkage->body_count; i++) {
        trajectory->motions[number * trajectory->body_count + i] = (Motion){
            .position = {(double)view.q[3 * i], (double)view.q[3 * i + 1]},
            .angle = (double)view.q[3 * i + 2],
            .velocity = {(double)view.v[3 * i], (double)view.v[3 * i + 1]},
            .omega = (double)view.v[3 * i + 2],
        };
    }
}

static Real fastest(const Maximal *maximal, const Real *y)
{
    const Plane *plane = plane_of(maximal);
    const View view = view_of(plane, y);
    Real largest = 0.0L;
    for (size_t i = 0; i < plane->linkage->body_count; i++) {
        const Real *v = view.v + 3 * i;
        largest = fmaxl(largest, hypotl(v[0], v[1]) + maximal->arms[3 * i + 2] * fabsl(v[2]));
    }
    return largest;
}

static void destroy(Maximal *maximal)
{
    Plane *plane = (Plane *)maximal;
    maximal_finish(maximal);
    free(plane->places);
    free(plane->masses);
    free(plane->inertias);
    free(plane);
}

static const MaximalKind PLANE = {
    .rates = rates,
    .gap = gap,
    .corner = corner,
    .limit = limit,
    .project = project,
    .sample = sample,
    .fastest = fastest,
    .destroy = destroy,
};

// How far something may come while it is apart before it is looked at: its play.
static Real flight_of(const Joint *joint, const Touch *place)
{
    if (place->shape == TOUCH_HOLE || place->shape == TOUCH_DISC || place->shape == TOUCH_SLOT) {
        return place->clearance;
    }
    if (place->shape == TOUCH_CAM) {
        return 0.05 * place->cam.profile->reach;
    }
    if (joint->kind == JOINT_GUIDE) {
        return linkage_radial_clearance(joint);
    }
    const double play = joint->limits.kind != LIMIT_NONE ? coordinate_play(joint) : 0.0;
    return isfinite(play) ? play : 0.0;
}

static void set_bodies(Plane *plane, const MaximalFlaw *flaw)
{
    const Linkage *linkage = plane->linkage;
    const size_t n = linkage->body_count;
    bool is_flawed = false;
    plane->masses = zeroed(n, sizeof *plane->masses);
    plane->inertias = zeroed(n, sizeof *plane->inertias);
    for (size_t i = 0; i < n; i++) {
        const Body *body = &linkage->bodies[i];
        const double factor = !is_flawed && is_free(plane, (int)i) ? flaw->mass : 1.0;
        is_flawed = is_flawed || is_free(plane, (int)i);
        plane->masses[i] = factor * body->mass;
        plane->inertias[i] = factor * body->inertia;
        const double values[3] = {body->start.position.x, body->start.position.y,
                                  body->start.angle};
        const double rates_of[3] = {body->start.velocity.x, body->start.velocity.y,
                                    body->start.omega};
        for (size_t k = 0; k < 3; k++) {
            plane->shared.start[3 * i + k] = values[k];
            plane->shared.start[3 * (n + i) + k] = rates_of[k];
            plane->shared.arms[3 * i + k] = k == 2 ? linkage_reach(linkage, (int)i) : 1.0;
            plane->shared.arms[3 * (n + i) + k] = plane->shared.arms[3 * i + k];
            plane->shared.is_speed[3 * (n + i) + k] = true;
        }
    }
}

Maximal *maximal_plane_create(const Scenario *scenario, const MaximalFlaw *flaw, Err *err)
{
    const Linkage *linkage = &scenario->linkage;
    Touch *places = NULL;
    size_t count = 0;
    if (linkage->is_spatial) {
        err_set(err, ERR_CASE, "these are the equations of the plane");
        return NULL;
    }
    if (scenario->contact.model != CONTACT_IMPACT) {
        err_set(err, ERR_CASE, "the velocity-level model is not among these equations");
        return NULL;
    }
    if (has_other_loads(linkage)) {
        err_set(err, ERR_CASE, "of loads these equations have constants and sinusoids on bodies");
        return NULL;
    }
    if (linkage->torque.followed.is_present && linkage->torque.followed.table.count > 1) {
        err_set(err, ERR_CASE, "soft drives follow no points in these equations");
        return NULL;
    }
    if (!touch_list(scenario, &places, &count, err)) {
        return NULL;
    }
    Plane *plane = zeroed(1, sizeof *plane);
    plane->linkage = linkage;
    plane->places = places;
    plane->driven = linkage_driven_body(linkage);
    plane->gravity = vec2_scale(flaw->gravity, scenario_gravity(scenario));
    maximal_init(&plane->shared, 6 * linkage->body_count, count);
    plane->shared.kind = &PLANE;
    plane->shared.scenario = scenario;
    set_bodies(plane, flaw);
    for (size_t i = 0; i < count; i++) {
        plane->shared.contacts[i] = (MaximalContact){
            .law = places[i].law,
            .flight = flight_of(&linkage->joints[places[i].joint], &places[i]),
        };
    }
    // at the start pins stand where the case puts them
    project(&plane->shared, -1.0L, plane->shared.start);
    return &plane->shared;
}
