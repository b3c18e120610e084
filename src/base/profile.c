// Finds the spline through the points of a cam's profile, and where something meets it.
//
// On a piece of width h with s from 0 to 1 the polynomial of degree 5 has the values, slopes m and
// second derivatives q of both ends. That its third and fourth derivatives are continuous gives two
// equations a knot:
//     f'''(0)  = (60 D - (36 m_0 + 24 m_1) h - (9 q_0 - 3 q_1) h^2) / h^3
//     f''''(0) = (-360 D + (192 m_0 + 168 m_1) h + (36 q_0 - 24 q_1) h^2) / h^4,    D = f_1 - f_0
// and at the end likewise, by symmetry. Taken as 0, N - 1, 1, N - 2, ... the knots of a ring are a
// band.
//
// A curve r(t) about a centre has the curvature (r^2 + 2 r'^2 - r r'') / (r^2 + r'^2)^1.5.
#include "base/profile.h"

#include "base/banded.h"

#include <math.h>

static double period_of(const Profile *profile)
{
    return profile->period > 0.0 ? profile->period : 2.0 * M_PI;
}

static bool check_points(const Profile *profile, Err *err)
{
    if (profile->count < PROFILE_MIN || profile->count > PROFILE_MAX) {
        return err_set(err, ERR_CASE, "a profile of %zu points, allowed: %d to %d", profile->count,
                       PROFILE_MIN, PROFILE_MAX);
    }
    for (size_t i = 0; i < profile->count; i++) {
        const double last = i == 0 ? profile->angles[profile->count - 1] - period_of(profile)
                                   : profile->angles[i - 1];
        if (!(profile->angles[i] > last)) {
            return err_set(err, ERR_CASE,
                           "point %zu of a profile is not behind the one before, or more than a "
                           "period behind the first",
                           i + 1);
        }
        if (!(profile->is_signed || profile->radii[i] > 0.0) || !isfinite(profile->radii[i])) {
            return err_set(err, ERR_CASE, "point %zu of a profile is not away from the centre",
                           i + 1);
        }
    }
    return true;
}

// Where a knot of the ring stands in the band.
static size_t row_of(size_t knot, size_t count)
{
    return knot < (count + 1) / 2 ? 2 * knot : 2 * (count - 1 - knot) + 1;
}

// One piece's part in an equation of continuity at one of its ends, with a sign.
static void add_end(const Profile *profile, size_t piece, bool is_far, double sign, Banded *band,
                    double *right)
{
    const size_t count = profile->count;
    const size_t ends[2] = {piece, (piece + 1) % count};
    const double h = profile->angles[piece + 1] - profile->angles[piece];
    const double step = profile->radii[piece + 1] - profile->radii[piece];
    const size_t knot = ends[is_far ? 1 : 0];
    const size_t row = 2 * row_of(knot, count);
    // by end: of slope and second derivative, in f''' and f''''
    const double third[2][2] = {{-36.0, -9.0}, {-24.0, 3.0}};
    const double fourth[2][2] = {{192.0, 36.0}, {168.0, -24.0}};
    for (int end = 0; end < 2; end++) {
        const size_t column = 2 * row_of(ends[end], count);
        // seen from the far end slopes and odd derivatives change their sign
        const int mirrored = is_far ? 1 - end : end;
        const double odd = is_far ? -1.0 : 1.0;
        *banded_entry(band, row, column) += sign * third[mirrored][0] / (h * h);
        *banded_entry(band, row, column + 1) += sign * odd * third[mirrored][1] / h;
        *banded_entry(band, row + 1, column) += sign * odd * fourth[mirrored][0] / (h * h * h);
        *banded_entry(band, row + 1, column + 1) += sign * fourth[mirrored][1] / (h * h);
    }
    const double odd = is_far ? -1.0 : 1.0;
    const double rise = odd * step; // as seen from that end
    right[row] -= sign * odd * 60.0 * rise / (h * h * h);
    right[row + 1] += sign * 360.0 * rise / (h * h * h * h);
}

static void find_curvatures(Profile *profile)
{
    enum { LOOKS = 8 };
    profile->reach = -INFINITY;
    profile->least = INFINITY;
    profile->least_hump = profile->least_hollow = INFINITY;
    for (size_t i = 0; i < profile->count; i++) {
        const double h = profile->angles[i + 1] - profile->angles[i];
        for (int k = 0; k < LOOKS; k++) {
            const double angle = profile->angles[i] + h * k / LOOKS;
            const ProfileAt at = profile_at(profile, angle);
            profile->reach = fmax(profile->reach, at.r);
            profile->least = fmin(profile->least, at.r);
            if (profile->is_signed) {
                continue;
            }
            const double curvature = profile_curvature(&at);
            if (curvature > 0.0) {
                profile->least_hump = fmin(profile->least_hump, 1.0 / curvature);
            } else if (-1.0 / curvature < profile->least_hollow) {
                profile->least_hollow = -1.0 / curvature;
                profile->hollow_at = angle;
            }
        }
    }
}

bool profile_settle(Profile *profile, Err *err)
{
    if (!check_points(profile, err)) {
        return false;
    }
    const size_t count = profile->count;
    profile->angles[count] = profile->angles[0] + period_of(profile);
    profile->radii[count] = profile->radii[0];
    Banded band = {.count = 0};
    double right[2 * PROFILE_MAX] = {0.0};
    banded_shape(&band, 2 * count, 5);
    for (size_t piece = 0; piece < count; piece++) {
        add_end(profile, piece, false, 1.0, &band, right);
        add_end(profile, piece, true, -1.0, &band, right);
    }
    const bool is_found = banded_factor(&band);
    if (is_found) {
        banded_substitute(&band, right);
    }
    banded_finish(&band);
    for (size_t knot = 0; knot <= count; knot++) {
        const size_t row = 2 * row_of(knot % count, count);
        profile->slopes[knot] = right[row];
        profile->bends[knot] = right[row + 1];
    }
    find_curvatures(profile);
    return is_found || err_set(err, ERR_CASE, "there is no smooth curve through a profile");
}

// The piece of an angle that lies within the profile's period.
static size_t piece_of(const Profile *profile, double angle)
{
    // points mostly are evenly spaced
    const double share = (angle - profile->angles[0]) / period_of(profile);
    size_t piece =
        (size_t)fmin(fmax(share * (double)profile->count, 0.0), (double)(profile->count - 1));
    while (piece > 0 && angle < profile->angles[piece]) {
        piece--;
    }
    while (piece + 1 < profile->count && angle >= profile->angles[piece + 1]) {
        piece++;
    }
    return piece;
}

ProfileAt profile_at(const Profile *profile, double angle)
{
    const double period = period_of(profile);
    const double turns = floor((angle - profile->angles[0]) / period);
    const double within = angle - turns * period;
    const size_t i = piece_of(profile, within);
    const double h = profile->angles[i + 1] - profile->angles[i];
    const double s = (within - profile->angles[i]) / h;
    const double d = profile->radii[i + 1] - profile->radii[i];
    const double m0 = h * profile->slopes[i];
    const double m1 = h * profile->slopes[i + 1];
    const double q0 = h * h * profile->bends[i];
    const double q1 = h * h * profile->bends[i + 1];
    const double c3 = 10.0 * d - 6.0 * m0 - 4.0 * m1 - 1.5 * q0 + 0.5 * q1;
    const double c4 = -15.0 * d + 8.0 * m0 + 7.0 * m1 + 1.5 * q0 - q1;
    const double c5 = 6.0 * d - 3.0 * (m0 + m1) - 0.5 * (q0 - q1);
    return (ProfileAt){
        .r = profile->radii[i] + s * (m0 + s * (0.5 * q0 + s * (c3 + s * (c4 + s * c5)))),
        .r1 = (m0 + s * (q0 + s * (3.0 * c3 + s * (4.0 * c4 + s * 5.0 * c5)))) / h,
        .r2 = (q0 + s * (6.0 * c3 + s * (12.0 * c4 + s * 20.0 * c5))) / (h * h),
    };
}

double profile_curvature(const ProfileAt *at)
{
    const double square = at->r * at->r + at->r1 * at->r1;
    return (square + at->r1 * at->r1 - at->r * at->r2) / (square * sqrt(square));
}

// The curve at an angle, in the plane: the point, and its derivatives by the angle.
typedef struct Place {
    ProfileAt at;
    Vec2 point;
    Vec2 first;
    Vec2 second;
} Place;

static Place place_at(const Profile *profile, double angle)
{
    const ProfileAt at = profile_at(profile, angle);
    const Vec2 out = {cos(angle), sin(angle)};
    const Vec2 along = vec2_perp(out);
    return (Place){
        .at = at,
        .point = vec2_scale(at.r, out),
        .first = vec2_add(vec2_scale(at.r1, out), vec2_scale(at.r, along)),
        .second = vec2_add(vec2_scale(at.r2 - at.r, out), vec2_scale(2.0 * at.r1, along)),
    };
}

// Newton's steps end where they are no longer than rounding.
enum { STEPS_MOST = 30 };
static const double ROUNDED = 4e-16;

ProfileNearest profile_nearest(const Profile *profile, Vec2 point)
{
    // The nearest point of the curve is no further than the one below, which bounds its angle.
    const double rho = vec2_length(point);
    const double below = atan2(point.y, point.x);
    const double away = fabs(rho - profile_at(profile, below).r);
    const double window = away < rho ? asin(away / rho) : M_PI;
    const double pitch = period_of(profile) / (double)profile->count;
    const int looks = (int)fmin(ceil(window / pitch), 0.5 * (double)profile->count);
    double angle = below;
    double least = INFINITY;
    for (int i = -looks; i <= looks; i++) {
        const double at = below + (looks > 0 ? window * i / looks : 0.0);
        const ProfileAt r = profile_at(profile, at);
        const double square = rho * rho + r.r * r.r - 2.0 * rho * r.r * cos(at - below);
        if (square < least) {
            least = square;
            angle = at;
        }
    }
    // (p - P(t)) . P'(t) = 0; where Newton's step goes uphill it follows the slope
    Place place = place_at(profile, angle);
    for (int i = 0; i < STEPS_MOST; i++) {
        const Vec2 to = vec2_sub(point, place.point);
        const double slope = -vec2_dot(to, place.first);
        const double speed = vec2_dot(place.first, place.first);
        const double bend = speed - vec2_dot(to, place.second);
        double step = -slope / (bend > 0.1 * speed ? bend : speed);
        step = fmin(fmax(step, -pitch), pitch);
        angle += step;
        place = place_at(profile, angle);
        if (fabs(step) <= ROUNDED * (1.0 + fabs(angle))) {
            break;
        }
    }
    const Vec2 normal = vec2_scale(-1.0 / vec2_length(place.first), vec2_perp(place.first));
    return (ProfileNearest){
        .distance = vec2_dot(normal, vec2_sub(point, place.point)),
        .normal = normal,
        .curvature = profile_curvature(&place.at),
    };
}

ProfileFurthest profile_furthest(const Profile *profile, Vec2 direction)
{
    // of a convex curve the angle of the normal grows with that of the point
    const double towards = atan2(direction.y, direction.x);
    double low = towards - 0.5 * M_PI;
    double high = towards + 0.5 * M_PI;
    double angle = towards;
    Place place = place_at(profile, angle);
    for (int i = 0; i < 2 * STEPS_MOST; i++) {
        // d . P'(t) falls through 0
        const double slope = vec2_dot(direction, place.first);
        const double bend = vec2_dot(direction, place.second);
        *(slope > 0.0 ? &low : &high) = angle;
        double next = angle - slope / bend;
        next = bend < 0.0 && next > low && next < high ? next : 0.5 * (low + high);
        const double step = next - angle;
        angle = next;
        place = place_at(profile, angle);
        if (fabs(step) <= ROUNDED * (1.0 + fabs(angle))) {
            break;
        }
    }
    return (ProfileFurthest){
        .reach = vec2_dot(direction, place.point),
        .point = place.point,
        .curvature = profile_curvature(&place.at),
    };
}
