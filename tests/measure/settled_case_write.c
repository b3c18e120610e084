// Writes the sizes of a random case as a case file.
#include "settled_case.h"

#include <math.h>

// The height, m, at which a cam's follower begins, and the spring's length there, before it is
// squeezed.
static const double FOLLOWER_START = 0.04;
static const double FOLLOWER_SPRING = 0.26;

static void write_points(const SettledCase *sizes, const char *unit, FILE *file)
{
    const SettledTable *table = &sizes->table;
    fprintf(file, "[");
    for (size_t i = 0; i < table->count; i++) {
        fprintf(file, "[%.12g s, %.12g %s], ", table->at[i], table->values[i], unit);
    }
    // the last point is the first of the next period
    fprintf(file, "[%.12g s, %.12g %s]]", sizes->period, table->values[0], unit);
}

static void write_load(const SettledCase *sizes, const char *joint, const char *what,
                       const char *unit, FILE *file)
{
    fprintf(file, "loads:\n  push: {joint: %s, %s: ", joint, what);
    write_points(sizes, unit, file);
    fprintf(file, ", period: %.12g s%s}\n", sizes->period,
            sizes->table.is_smooth ? ", interpolation: smooth" : "");
}

static void write_run(const SettledCase *sizes, FILE *file)
{
    fprintf(file, "run: {");
    if (sizes->speed > 0.0) {
        fprintf(file, "revolutions: 1");
    } else {
        fprintf(file, "duration: %.12g s", sizes->period);
    }
    fprintf(file, ", samples: 360, backends: [reference]}\n");
}

static void write_cam(const SettledCase *sizes, FILE *file)
{
    fprintf(file, "bodies:\n  cam: {mass: 0.5 kg, inertia: 1e-4 kg m^2, at: [0 m, 0 m]}\n");
    fprintf(file, "  follower: {mass: %.12g kg, inertia: 1e-4 kg m^2, at: [0 m, %.12g m]}\n",
            sizes->mass, FOLLOWER_START);
    fprintf(file, "joints:\n  shaft: {between: [ground, cam], at: [0 m, 0 m]}\n");
    fprintf(file, "  rail: {between: [ground, follower], at: [0 m, %.12g m], along: 90 deg}\n",
            FOLLOWER_START);
    fprintf(file,
            "  face: {between: [follower, cam], at-a: [0 m, %.12g m], at-b: [0 m, %.12g m],\n"
            "         normal: -90 deg, radius: %.12g m, stiffness: %.12g N/m}\n",
            sizes->radius - sizes->eccentricity, -sizes->eccentricity, sizes->radius,
            sizes->stiffness);
    fprintf(file,
            "springs:\n  s: {between: [ground, follower], at-a: [0 m, %.12g m], "
            "at-b: [0 m, %.12g m],\n      stiffness: %.12g N/m, length: %.12g m}\n",
            FOLLOWER_START + FOLLOWER_SPRING, FOLLOWER_START, sizes->spring, sizes->spring_length);
    fprintf(file, "drive: {joint: shaft, speed: %.12g rpm}\n", sizes->speed);
}

static void write_arm(const SettledCase *sizes, FILE *file)
{
    fprintf(file,
            "bodies:\n  arm: {mass: %.12g kg, inertia: %.12g kg m^2, at: [%.17g m, %.17g m],\n"
            "        angle: %.12g rad}\n",
            sizes->mass, sizes->inertia, sizes->reach * cos(sizes->start),
            sizes->reach * sin(sizes->start), sizes->start);
    fprintf(file,
            "joints:\n  hinge: {between: [ground, arm], at: [0 m, 0 m], low: %.12g rad,\n"
            "          stiffness: %.12g N m/rad",
            sizes->low, sizes->stiffness);
    if (isfinite(sizes->high)) {
        fprintf(file, ", high: %.12g rad", sizes->high);
    }
    fprintf(file, "}\n");
    write_load(sizes, "hinge", "torque", "N m", file);
}

static void write_beam(const SettledCase *sizes, FILE *file)
{
    fprintf(file, "bodies:\n  beam: {mass: %.12g kg, inertia: 1e-3 kg m^2, at: [0 m, 0 m]}\n",
            sizes->mass);
    fprintf(file, "joints:\n  rail: {between: [ground, beam], at: [0 m, 0 m], along: 0 deg}\n");
    fprintf(file,
            "  stop: {between: [ground, beam], at-a: [%.12g m, 0 m], at-b: [0 m, 0 m], "
            "normal: 180 deg,\n         stiffness: %.12g N/m}\n",
            sizes->high, sizes->stiffness);
    fprintf(file,
            "springs:\n  s: {between: [ground, beam], at-a: [-0.3 m, 0 m], at-b: [0 m, 0 m],\n"
            "      stiffness: %.12g N/m, damping: %.12g N s/m}\n",
            sizes->spring, sizes->damping);
    write_load(sizes, "rail", "force", "N", file);
}

static void write_drive_angle(const SettledCase *sizes, const char *joint, FILE *file)
{
    fprintf(file, "drive:\n  joint: %s\n  angle: ", joint);
    write_points(sizes, "rad", file);
    fprintf(file, "\n  profile: spline\n  period: %.12g s\n", sizes->period);
}

static void write_gears(const SettledCase *sizes, FILE *file)
{
    fprintf(file,
            "bodies:\n  pinion: {mass: 1 kg, inertia: 0.01 kg m^2, at: [0 m, 0 m]}\n"
            "  wheel: {mass: 1 kg, inertia: %.12g kg m^2, at: [%.12g m, 0 m]}\n",
            sizes->inertia, sizes->distance);
    fprintf(file,
            "joints:\n  shaft-a: {between: [ground, pinion], at: [0 m, 0 m]}\n"
            "  shaft-b: {between: [ground, wheel], at: [%.12g m, 0 m]}\n",
            sizes->distance);
    fprintf(file,
            "  mesh: {gears: [shaft-a, shaft-b], teeth: [%d, %d], backlash: %.12g m, "
            "stiffness: %.12g N/m}\n",
            sizes->teeth[0], sizes->teeth[1], sizes->high - sizes->low, sizes->stiffness);
    fprintf(file, "torsion-springs:\n  oil: {joint: shaft-b, damping: %.12g N m s/rad}\n",
            sizes->damping);
    fprintf(file, "loads:\n  load: {joint: shaft-b, torque: %.12g N m}\n", sizes->load);
    write_drive_angle(sizes, "shaft-a", file);
}

static void write_pivot(const SettledCase *sizes, FILE *file)
{
    fprintf(file,
            "bodies:\n  rotor: {mass: 1 kg, inertia: 0.01 kg m^2, at: [0 m, 0 m]}\n"
            "  output: {mass: 1 kg, inertia: %.12g kg m^2, at: [0 m, 0 m]}\n",
            sizes->inertia);
    fprintf(file,
            "joints:\n  shaft: {between: [ground, rotor], at: [0 m, 0 m]}\n"
            "  coupling: {between: [rotor, output], at: [0 m, 0 m], backlash: %.12g rad,\n"
            "             stiffness: %.12g N m/rad}\n",
            sizes->high - sizes->low, sizes->stiffness);
    fprintf(file, "torsion-springs:\n  grease: {joint: coupling, damping: %.12g N m s/rad}\n",
            sizes->damping);
    fprintf(file, "loads:\n  load: {body: output, torque: %.12g N m}\n", sizes->load);
    write_drive_angle(sizes, "shaft", file);
}

static void write_link(const char *name, const SettledLink *link, FILE *file)
{
    fprintf(file, "  %s: {", name);
    if (link->length > 0.0) {
        fprintf(file, "length: %.12g m, ", link->length);
    }
    fprintf(file, "mass: %.12g kg, inertia: %.12g kg m^2}\n", link->mass, link->inertia);
}

static void write_pin(const char *name, const SettledCase *sizes, FILE *file)
{
    fprintf(file, "joints:\n  %s: {hole: %.12g m, pin: %.12g m, width: 0.02 m}\n", name,
            sizes->hole, sizes->pin);
    fprintf(file, "drive: {speed: %.12g rpm}\n", sizes->speed);
}

static void write_four_bar(const SettledCase *sizes, FILE *file)
{
    fprintf(file, "four-bar:\n  ground: {length: %.12g m}\n", sizes->ground);
    write_link("crank", &sizes->crank, file);
    write_link("coupler", &sizes->coupler, file);
    write_link("follower", &sizes->last, file);
    write_pin(sizes->kind == SETTLED_COUPLER_PIN ? "crank-coupler" : "coupler-follower", sizes,
              file);
}

static void write_slider_crank(const SettledCase *sizes, FILE *file)
{
    fprintf(file, "slider-crank:\n");
    write_link("crank", &sizes->crank, file);
    write_link("rod", &sizes->coupler, file);
    write_link("slider", &sizes->last, file);
    if (sizes->offset != 0.0) {
        fprintf(file, "  offset: %.12g m\n", sizes->offset);
    }
    write_pin(sizes->kind == SETTLED_CRANK_PIN ? "crank-rod" : "rod-slider", sizes, file);
}

static void write_contact(const SettledCase *sizes, FILE *file)
{
    fprintf(file, "contact: {");
    if (sizes->pin > 0.0 && sizes->stiffness > 0.0) {
        fprintf(file, "stiffness: %.12g N/m^1.5, ", sizes->stiffness);
    } else if (sizes->pin > 0.0) {
        fprintf(file, "law: hertz-socket, ");
    }
    fprintf(file, "damping: exact, restitution: %.12g}\n", sizes->restitution);
}

void settled_case_write(const SettledCase *sizes, FILE *file)
{
    static void (*const WRITERS[])(const SettledCase *, FILE *) = {
        [SETTLED_CAM] = write_cam,
        [SETTLED_ARM] = write_arm,
        [SETTLED_BEAM] = write_beam,
        [SETTLED_GEARS] = write_gears,
        [SETTLED_PIVOT] = write_pivot,
        [SETTLED_COUPLER_PIN] = write_four_bar,
        [SETTLED_FOLLOWER_PIN] = write_four_bar,
        [SETTLED_CRANK_PIN] = write_slider_crank,
        [SETTLED_WRIST_PIN] = write_slider_crank,
    };
    fprintf(file, "title: %s\ngravity: %.12g m/s^2\n", sizes->name, sizes->gravity);
    WRITERS[sizes->kind](sizes, file);
    write_contact(sizes, file);
    write_run(sizes, file);
}
