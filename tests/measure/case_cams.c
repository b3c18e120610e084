// Random cams: a profile of a few waves or an eccentric disc, on which a roller, a knife edge or a
// flat rides, on a slide or on a rocker, pressed by a spring; the cam turns at a speed, by a table,
// or freely.
#include "random_case.h"
#include "random_draw.h"

static const double DEGREES = 180.0 / M_PI;

enum { WAVES = 3 };

typedef struct CamCase {
    Draw draw;
    double base;         // m
    double waves[WAVES]; // m
    double phases[WAVES];
    bool is_flat;
    bool is_rocker;
    double roller;  // m
    Point follower; // where the roller's centre, or the flat, is
} CamCase;

static double radius_at(const CamCase *cam, double angle)
{
    double radius = cam->base;
    for (int i = 0; i < WAVES; i++) {
        radius += cam->waves[i] * cos((i + 1) * (angle - cam->phases[i]));
    }
    return radius;
}

static CamCase draw_cam(uint64_t seed)
{
    CamCase cam = {.draw = draw_start(seed)};
    Draw *draw = &cam.draw;
    cam.base = draw_log_between(draw, 0.012, 0.06);
    cam.is_flat = draw_chance(draw, 0.35);
    cam.is_rocker = draw_chance(draw, 0.4);
    // convex for a flat, and no hollow too small for the roller
    const double share = cam.is_flat ? 0.2 : 0.3;
    for (int i = 0; i < WAVES; i++) {
        const double most = share * cam.base / ((i + 1) * (i + 1) * (i + 1));
        cam.waves[i] = draw_between(draw, 0.0, most);
        cam.phases[i] = draw_between(draw, -M_PI, M_PI);
    }
    cam.roller =
        cam.is_flat || draw_chance(draw, 0.2) ? 0.0 : cam.base * draw_between(draw, 0.1, 0.6);
    double away = 0.0;
    for (int i = 0; i < 3600; i++) {
        const double angle = i / 3600.0 * 2.0 * M_PI;
        const double r = radius_at(&cam, angle);
        const double x = r * cos(angle);
        const double y = r * sin(angle);
        const double reach = cam.is_flat            ? y
                             : fabs(x) < cam.roller ? y + sqrt(cam.roller * cam.roller - x * x)
                                                    : 0.0;
        away = fmax(away, reach);
    }
    away = cam.roller == 0.0 && !cam.is_flat ? radius_at(&cam, 0.5 * M_PI) : away;
    cam.follower = (Point){0.0, away + draw_log_between(draw, 1e-6, 1e-3)};
    return cam;
}

static void write_profile(const CamCase *cam, FILE *file)
{
    enum { POINTS = 120 };
    fprintf(file, "profile: [");
    for (int i = 0; i < POINTS; i++) {
        const double angle = 2.0 * M_PI * i / POINTS;
        fprintf(file, "%s[%.15g deg, %.15g m]", i > 0 ? ", " : "", angle * DEGREES,
                radius_at(cam, angle));
    }
    fprintf(file, "]");
}

static void write_cams(uint64_t seed, FILE *file)
{
    CamCase cam = draw_cam(seed);
    Draw *draw = &cam.draw;
    const double mass = draw_log_between(draw, 0.05, 2.0);
    const double speed = draw_log_between(draw, 100.0, 1500.0);
    const size_t drive = draw_below(draw, 3);
    const double arm = draw_between(draw, 2.0, 4.0) * cam.base;
    fprintf(file, "title: Random cam %llu\nbodies:\n", (unsigned long long)seed);
    fprintf(file, "  cam: {mass: %.5g kg, inertia: %.6g kg mm^2, at: [%.15g m, %.15g m]",
            2.0 * mass, 2e6 * mass * cam.base * cam.base, 0.1 * cam.base, 0.0);
    if (drive == 2) {
        fprintf(file, ", spin: %.15g rad/s, velocity: [0 m/s, %.15g m/s]", speed * M_PI / 30.0,
                speed * M_PI / 30.0 * 0.1 * cam.base);
    }
    fprintf(file, "}\n  follower: {mass: %.5g kg, inertia: %.6g kg mm^2, at: [%.15g m, %.15g m]}\n",
            mass, 1e6 * mass * cam.base * cam.base, cam.is_rocker ? 0.3 * arm : 0.0,
            cam.follower.y + 0.2 * cam.base);
    fprintf(file, "joints:\n  pivot: {between: [ground, cam], at: [0 m, 0 m]}\n");
    if (cam.is_rocker) {
        fprintf(file, "  guide: {between: [ground, follower], at: [%.9g m, %.15g m]}\n", arm,
                cam.follower.y);
    } else {
        fprintf(file, "  guide: {between: [ground, follower], at: [0 m, %.9g m], along: 90 deg}\n",
                3.0 * cam.base);
    }
    const double rate = 2.0 * M_PI * draw_log_between(draw, 200.0, 2000.0);
    fprintf(file, "  ride: {between: [cam, follower], at-a: [0 m, 0 m], at-b: [0 m, %.15g m], ",
            cam.follower.y);
    if (cam.is_flat) {
        fprintf(file, "normal: -90 deg, ");
    } else {
        fprintf(file, "radius: %.9g m, ", cam.roller);
    }
    write_profile(&cam, file);
    fprintf(file, ",\n    stiffness: %.5g N/m, restitution: %.3g}\n", mass * rate * rate,
            draw_between(draw, 0.2, 0.9));
    const double stiff = mass * pow(2.0 * M_PI * draw_log_between(draw, 3.0, 30.0), 2.0);
    fprintf(
        file,
        "springs:\n  coil: {between: [ground, follower], at-a: [0 m, %.9g m], at-b: [0 m, %.15g "
        "m],\n    stiffness: %.5g N/m, damping: %.4g N s/m, length: %.9g m}\n",
        10.0 * cam.base, cam.follower.y + 0.2 * cam.base, stiff, 0.05 * sqrt(stiff * mass),
        10.0 * cam.base);
    if (drive == 0) {
        fprintf(file, "drive: {joint: pivot, speed: %.6g rpm}\n", speed);
    } else if (drive == 1) {
        fprintf(file,
                "drive: {joint: pivot, speed: [[0 ms, 0 rpm], [20 ms, %.6g rpm], [60 ms, %.6g "
                "rpm]]}\n",
                speed, -0.3 * speed);
    }
    fprintf(file, "contact: {damping: hunt-crossley");
    if (draw_chance(draw, 0.4)) {
        fprintf(file, ", friction: %.3g, friction-speed: 20 mm/s", draw_between(draw, 0.02, 0.3));
    }
    fprintf(file, "}\n");
    draw_run(draw, drive == 0 ? "revolutions: 1" : "duration: 0.1 s", file);
}

const CaseKind CASE_CAMS = {
    .name = "cams",
    .summary = "cams with rollers, knife edges and flats, on slides and rockers",
    .write = write_cams,
};
