// Where do the rows of a linkage's response stand, and how fast do their rates change by
// themselves?
//
// Revolute joints and pins: x and y of anchor b less anchor a. Prismatic joints:
// model/joint_rows.h. At a line of body a with normal n and tangent t = perp n, d from anchor a to
// anchor b, r the radius of body b's circle; w, alpha turning and its rate:
//     rates     n . d' + w_a t . d                           of the gap
//               t . d' - w_a (n . d - r) - w_b r             of sliding
//     theirs    n . d'' + 2 w_a t . d' - w_a^2 n . d + alpha_a t . d
//               t . d'' - 2 w_a n . d' - w_a^2 t . d - alpha_a (n . d - r) - alpha_b r
// Ends of a coordinate: model/coordinate.h. At a cam likewise with the normal where it is met, and
// the terms of base/cam.h.
#include "model/response_rows.h"

#include "model/coordinate.h"

static bool is_fixed(const Linkage *linkage, int body)
{
    return body == LINKAGE_GROUND || linkage_is_driven(linkage, body);
}

// Two rows, x and y: pin or second anchor against hole or first.
static void place_point(Response *response, size_t row, const JointEnd ends[2],
                        const Motion *motions)
{
    ResponseRow *x_row = &response->rows[row];
    ResponseRow *y_row = &response->rows[row + 1];
    for (int side = 0; side < 2; side++) {
        const JointEnd end = ends[side];
        const bool stays = is_fixed(response->linkage, end.body);
        const double sign = side == 0 ? -1.0 : 1.0;
        const Vec2 arm = stays ? end.anchor : response_arm(response, motions, end.body, end.anchor);
        x_row->body[side] = y_row->body[side] = stays ? LINKAGE_GROUND : end.body;
        x_row->x[side] = sign;
        x_row->turn[side] = -sign * arm.y;
        y_row->y[side] = sign;
        y_row->turn[side] = sign * arm.x;
    }
}

static void place_prismatic(Response *response, size_t row, int joint, const Motion *motions)
{
    JointRows rows;
    joint_rows_find(response->linkage, motions, joint, &rows);
    for (int side = 0; side < 2; side++) {
        const int body = linkage_end(&response->linkage->joints[joint], side).body;
        for (size_t i = 0; i < JOINT_ROWS; i++) {
            ResponseRow *of = &response->rows[row + i];
            of->body[side] = is_fixed(response->linkage, body) ? LINKAGE_GROUND : body;
            of->x[side] = rows.rows[i].x[side];
            of->y[side] = rows.rows[i].y[side];
            of->turn[side] = rows.rows[i].turn[side];
        }
    }
}

static double angle_of(int body, const Motion *motions)
{
    return body == LINKAGE_GROUND ? 0.0 : motions[body].angle;
}

static double omega_of(int body, const Motion *motions)
{
    return body == LINKAGE_GROUND ? 0.0 : motions[body].omega;
}

// The normal of a line, in the world.
static Vec2 line_normal(const ResponsePlace *place, int body_a, const Motion *motions)
{
    return vec2_rotate(angle_of(body_a, motions) + place->direction, (Vec2){1.0, 0.0});
}

// The pose of a cam and its follower.
static CamPose cam_of(const ResponsePlace *place, const JointEnd ends[2], const Motion *motions)
{
    const Cam *cam = &place->cam;
    const Vec2 offset = vec2_sub(linkage_point(motions, ends[1].body, ends[1].anchor),
                                 linkage_point(motions, ends[0].body, ends[0].anchor));
    const Vec2 x = {1.0, 0.0};
    return cam_pose(cam, vec2_rotate(angle_of(ends[0].body, motions) + cam->direction, x),
                    vec2_rotate(angle_of(ends[1].body, motions) + cam->facing, x), offset);
}

// Two rows, along the normal and the tangent of a line or cam: of both bodies the point that
// touches.
static void place_line(Response *response, size_t row, const ResponsePlace *place,
                       const JointEnd ends[2], const Motion *motions)
{
    const bool is_cam = place->cam.profile != NULL;
    const CamPose cam = is_cam ? cam_of(place, ends, motions) : (CamPose){.gap = 0.0};
    const Vec2 normal = is_cam ? cam.normal : line_normal(place, ends[0].body, motions);
    const Vec2 directions[2] = {normal, vec2_perp(normal)};
    const Vec2 anchor = linkage_point(motions, ends[1].body, ends[1].anchor);
    const Vec2 point =
        is_cam ? vec2_add(anchor, cam.from_b) : vec2_sub(anchor, vec2_scale(place->radius, normal));
    for (int side = 0; side < 2; side++) {
        const int body =
            is_fixed(response->linkage, ends[side].body) ? LINKAGE_GROUND : ends[side].body;
        const double sign = side == 0 ? -1.0 : 1.0;
        const Vec2 arm = body == LINKAGE_GROUND ? point : vec2_sub(point, motions[body].position);
        for (size_t i = 0; i < 2; i++) {
            ResponseRow *of = &response->rows[row + i];
            of->body[side] = body;
            of->x[side] = sign * directions[i].x;
            of->y[side] = sign * directions[i].y;
            of->turn[side] = sign * vec2_cross(arm, directions[i]);
        }
    }
}

// One row, along the coordinate of a joint; nothing pushes in the other.
static void place_coordinate(Response *response, size_t row, const ResponsePlace *place,
                             const Motion *motions)
{
    const Joint *joint = &response->linkage->joints[place->joint];
    JointRow along;
    coordinate_row(response->linkage, motions, place->joint, place->sign, &along);
    response->rows[row + 1] = (ResponseRow){.body = {LINKAGE_GROUND, LINKAGE_GROUND}};
    for (int side = 0; side < 2; side++) {
        const int body = linkage_end(joint, side).body;
        ResponseRow *of = &response->rows[row];
        of->body[side] = is_fixed(response->linkage, body) ? LINKAGE_GROUND : body;
        of->x[side] = along.x[side];
        of->y[side] = along.y[side];
        of->turn[side] = along.turn[side];
    }
}

// The turn of one body of a joint, as a row of its own.
static void place_turn(Response *response, size_t row, int end)
{
    const ResponseRow *x_row = &response->rows[row - 2 - (size_t)end];
    ResponseRow *turn = &response->rows[row];
    turn->body[0] = x_row->body[end];
    turn->turn[0] = 1.0;
    turn->body[1] = LINKAGE_GROUND;
}

void response_rows_place_ideal(Response *response, size_t row, const Motion *motions)
{
    const Joint *joint = &response->linkage->joints[response->joint_of[row]];
    switch (joint_held_by(joint->kind)) {
    case JOINT_HOLDS_LINE:
        place_prismatic(response, row, response->joint_of[row], motions);
        break;
    case JOINT_HOLDS_POINT:
    case JOINT_HOLDS_NOTHING: // has no ideal rows
        place_point(response, row, (JointEnd[]){linkage_end(joint, 0), linkage_end(joint, 1)},
                    motions);
        break;
    }
}

void response_rows_place_play(Response *response, size_t number, const Motion *motions)
{
    const Joint *joints = response->linkage->joints;
    const ResponsePlace *place = &response->places[number];
    const size_t row = response->ideal_rows + response->first_row[number];
    const JointEnd ends[2] = {{joints[place->joint].body_a, place->anchor_a},
                              {joints[place->joint].body_b, place->anchor_b}};
    if (place->sign != 0.0) {
        place_coordinate(response, row, place, motions);
    } else if (place->is_line) {
        place_line(response, row, place, ends, motions);
    } else {
        place_point(response, row, ends, motions);
    }
    if (place->has_turns) {
        place_turn(response, row + 2, 0);
        place_turn(response, row + 3, 1);
    }
}

void response_rows_place(Response *response, const Motion *motions)
{
    for (size_t row = 0; row < response->ideal_rows; row += 2) {
        response_rows_place_ideal(response, row, motions);
    }
    for (size_t i = 0; i < response->place_count; i++) {
        response_rows_place_play(response, i, motions);
    }
}

// The rate of a body's turning under loads, rad/s^2; of the driven body that of the drive.
static double free_turning(const Linkage *linkage, const Motion *motions, int body,
                           const BodyLoad *loads)
{
    if (body == LINKAGE_GROUND) {
        return 0.0;
    }
    if (linkage_is_driven(linkage, body)) {
        return motions[body].alpha;
    }
    return loads == NULL ? 0.0 : loads[body].moment / linkage->bodies[body].inertia;
}

// Acceleration of the end of a joint on one body under gravity and loads.
static Vec2 end_acceleration(const Response *response, const Motion *motions, int body, Vec2 anchor,
                             Vec2 gravity, const BodyLoad *loads)
{
    if (body == LINKAGE_GROUND) {
        return (Vec2){0.0, 0.0};
    }
    const Linkage *linkage = response->linkage;
    const Motion *motion = &motions[body];
    const bool is_driven = linkage_is_driven(linkage, body);
    const double alpha = free_turning(linkage, motions, body, loads);
    Vec2 centre = is_driven ? motion->acceleration : gravity;
    const Vec2 arm = response_arm(response, motions, body, anchor);
    if (loads != NULL && !is_driven) {
        const double mass = linkage->bodies[body].mass;
        const Vec2 turning = vec2_scale(alpha, vec2_perp(arm));
        centre = vec2_add(centre, vec2_add(vec2_scale(1.0 / mass, loads[body].force), turning));
    } else if (alpha != 0.0) {
        centre = vec2_add(centre, vec2_scale(alpha, vec2_perp(arm)));
    }
    return vec2_sub(centre, vec2_scale(motion->omega * motion->omega, arm));
}

// Acceleration of the anchor on body b less that of the anchor on body a.
static Vec2 relative_acceleration(const Response *response, const Motion *motions, int joint,
                                  Vec2 anchor_a, Vec2 anchor_b, Vec2 gravity, const BodyLoad *loads)
{
    const Joint *of = &response->linkage->joints[joint];
    return vec2_sub(end_acceleration(response, motions, of->body_b, anchor_b, gravity, loads),
                    end_acceleration(response, motions, of->body_a, anchor_a, gravity, loads));
}

// The rates of the rates of a line's rows, from the relative acceleration of its anchors.
static void line_free(const Linkage *linkage, const ResponsePlace *place, const Motion *motions,
                      const BodyLoad *loads, Vec2 relative, double *gamma)
{
    const int a = linkage->joints[place->joint].body_a;
    const int b = linkage->joints[place->joint].body_b;
    const double omega = a == LINKAGE_GROUND ? 0.0 : motions[a].omega;
    const double alpha = free_turning(linkage, motions, a, loads);
    const Vec2 n = line_normal(place, a, motions);
    const Vec2 t = vec2_perp(n);
    const Vec2 d = vec2_sub(linkage_point(motions, b, place->anchor_b),
                            linkage_point(motions, a, place->anchor_a));
    const Vec2 rate = vec2_sub(linkage_point_velocity(motions, b, place->anchor_b),
                               linkage_point_velocity(motions, a, place->anchor_a));
    gamma[0] = vec2_dot(n, relative) + 2.0 * omega * vec2_dot(t, rate) -
               omega * omega * vec2_dot(n, d) + alpha * vec2_dot(t, d);
    gamma[1] = vec2_dot(t, relative) - 2.0 * omega * vec2_dot(n, rate) -
               omega * omega * vec2_dot(t, d) - alpha * (vec2_dot(n, d) - place->radius) -
               free_turning(linkage, motions, b, loads) * place->radius;
}

// The acceleration of body b at a point, seen from its anchor, less that of body a there, from the
// relative acceleration of the anchors, along a direction.
static double acceleration_at(Vec2 direction, Vec2 relative, Vec2 offset, Vec2 from_b,
                              const double omegas[2], const double alphas[2])
{
    const Vec2 from_a = vec2_add(offset, from_b);
    const Vec2 of_b = vec2_sub(vec2_scale(alphas[1], vec2_perp(from_b)),
                               vec2_scale(omegas[1] * omegas[1], from_b));
    const Vec2 of_a = vec2_sub(vec2_scale(alphas[0], vec2_perp(from_a)),
                               vec2_scale(omegas[0] * omegas[0], from_a));
    return vec2_dot(direction, vec2_add(relative, vec2_sub(of_b, of_a)));
}

// The rates of the rates of a cam's rows.
static void cam_free(const Linkage *linkage, const ResponsePlace *place, const Motion *motions,
                     const BodyLoad *loads, Vec2 relative, double *gamma)
{
    const Joint *joint = &linkage->joints[place->joint];
    const JointEnd ends[2] = {{joint->body_a, place->anchor_a}, {joint->body_b, place->anchor_b}};
    const double omegas[2] = {omega_of(joint->body_a, motions), omega_of(joint->body_b, motions)};
    const double alphas[2] = {free_turning(linkage, motions, joint->body_a, loads),
                              free_turning(linkage, motions, joint->body_b, loads)};
    const CamPose pose = cam_of(place, ends, motions);
    const Vec2 offset = vec2_sub(linkage_point(motions, joint->body_b, place->anchor_b),
                                 linkage_point(motions, joint->body_a, place->anchor_a));
    const Vec2 velocity = vec2_sub(linkage_point_velocity(motions, joint->body_b, place->anchor_b),
                                   linkage_point_velocity(motions, joint->body_a, place->anchor_a));
    const double sliding = cam_sliding(&pose, offset, velocity, omegas[0], omegas[1]);
    const double rate = cam_rate(&pose, offset, velocity, omegas[0], omegas[1]);
    gamma[0] = acceleration_at(pose.normal, relative, offset, pose.measured, omegas, alphas) +
               cam_bend(&place->cam, &pose, omegas[0], omegas[1], sliding);
    gamma[1] =
        acceleration_at(vec2_perp(pose.normal), relative, offset, pose.from_b, omegas, alphas) -
        cam_turning(&place->cam, &pose, omegas[0], omegas[1], sliding) * rate;
}

// The rate of the rate of a coordinate's row, from the relative acceleration of the anchors. Of a
// rack it is that of a line across, and of the turns.
static void coordinate_free(const Linkage *linkage, const ResponsePlace *place,
                            const Motion *motions, const BodyLoad *loads, Vec2 relative,
                            double *gamma)
{
    const Joint *joint = &linkage->joints[place->joint];
    const double a = free_turning(linkage, motions, joint->body_a, loads);
    const double b = free_turning(linkage, motions, joint->body_b, loads);
    gamma[1] = 0.0;
    switch (joint_coordinate(joint->kind)) {
    case JOINT_COORDINATE_TEETH: {
        const MeshFlank flank = coordinate_flank(linkage, motions, place->joint, place->sign);
        const Vec2 velocity = linkage_joint_gap(linkage, motions, place->joint).velocity;
        gamma[0] = mesh_rate(&flank, relative, a, b) + mesh_bend(&flank, velocity,
                                                                 omega_of(joint->body_a, motions),
                                                                 omega_of(joint->body_b, motions));
        break;
    }
    case JOINT_COORDINATE_RACK:
        line_free(linkage, place, motions, loads, relative, gamma);
        gamma[0] = place->sign * (gamma[0] + joint->gear.radius_b * (b - a));
        gamma[1] = 0.0;
        break;
    case JOINT_COORDINATE_ANGLE:
    case JOINT_COORDINATE_NONE:
    case JOINT_COORDINATE_POSITION: // the places of which are lines
        gamma[0] = place->sign * coordinate_sense(joint) * (b - a);
        break;
    }
}

// The rates of the rates of a prismatic joint's rows: their own and those of the bodies.
static void prismatic_free(const Linkage *linkage, int joint, const Motion *motions, Vec2 gravity,
                           const BodyLoad *loads, double *gamma)
{
    JointRows rows;
    joint_rows_find(linkage, motions, joint, &rows);
    gamma[0] = rows.bias[0];
    gamma[1] = rows.bias[1];
    for (int side = 0; side < 2; side++) {
        const int body = linkage_end(&linkage->joints[joint], side).body;
        if (body == LINKAGE_GROUND) {
            continue;
        }
        const bool is_driven = linkage_is_driven(linkage, body);
        Vec2 centre = is_driven ? motions[body].acceleration : gravity;
        if (loads != NULL && !is_driven) {
            const double mass = linkage->bodies[body].mass;
            centre = vec2_add(centre, vec2_scale(1.0 / mass, loads[body].force));
        }
        for (size_t i = 0; i < JOINT_ROWS; i++) {
            const JointRow *row = &rows.rows[i];
            gamma[i] += row->x[side] * centre.x + row->y[side] * centre.y +
                        row->turn[side] * free_turning(linkage, motions, body, loads);
        }
    }
}

void response_rows_loose(const Response *response, const Motion *motions, Vec2 gravity,
                         const BodyLoad *loads, double *gamma)
{
    const Linkage *linkage = response->linkage;
    size_t row = 0;
    for (; row < response->ideal_rows; row += 2) {
        const int number = response->joint_of[row];
        const Joint *joint = &linkage->joints[number];
        if (joint_slides(joint->kind)) {
            prismatic_free(linkage, number, motions, gravity, loads, gamma + row);
            continue;
        }
        const Vec2 relative = relative_acceleration(response, motions, number, joint->anchor_a,
                                                    joint->anchor_b, gravity, loads);
        gamma[row] = relative.x;
        gamma[row + 1] = relative.y;
    }
    for (size_t i = 0; i < response->place_count; i++) {
        const ResponsePlace *place = &response->places[i];
        const Joint *joint = &linkage->joints[place->joint];
        const Vec2 relative = relative_acceleration(
            response, motions, place->joint, place->anchor_a, place->anchor_b, gravity, loads);
        gamma[row] = relative.x;
        gamma[row + 1] = relative.y;
        if (place->sign != 0.0) {
            coordinate_free(linkage, place, motions, loads, relative, gamma + row);
        } else if (place->cam.profile != NULL) {
            cam_free(linkage, place, motions, loads, relative, gamma + row);
        } else if (place->is_line) {
            line_free(linkage, place, motions, loads, relative, gamma + row);
        }
        row += 2;
        if (place->has_turns) {
            gamma[row++] = free_turning(linkage, motions, joint->body_a, loads);
            gamma[row++] = free_turning(linkage, motions, joint->body_b, loads);
        }
    }
}
