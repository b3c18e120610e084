// Random shafts of balanced rotors, whose centres rest on their axes: flywheels one after another
// on torsion springs and couplings with backlash, wheels that turn one another, and either
// together.
#include "random_case.h"
#include "random_draw.h"

#include "model/options.h"

enum { ROTOR_MOST = 4 };

typedef struct Shaft {
    Draw draw;
    size_t count;
    double inertias[ROTOR_MOST]; // kg m^2
    double at[ROTOR_MOST];       // m, along x: 0 of the first shaft
    int teeth[ROTOR_MOST];       // of the wheels; 0 of a flywheel on the shaft before
} Shaft;

static void draw_rotors(Shaft *shaft)
{
    Draw *draw = &shaft->draw;
    const double module = draw_log_between(draw, 5e-4, 4e-3);
    shaft->count = 1 + draw_below(draw, ROTOR_MOST);
    for (size_t i = 0; i < shaft->count; i++) {
        shaft->inertias[i] = draw_log_between(draw, 1e-5, 1e-2);
        if (i > 0 && draw_chance(draw, 0.3)) {
            // the wheel before may be one already
            shaft->teeth[i] = 12 + (int)draw_below(draw, 60);
            shaft->teeth[i - 1] =
                shaft->teeth[i - 1] > 0 ? shaft->teeth[i - 1] : 12 + (int)draw_below(draw, 60);
            shaft->at[i] =
                shaft->at[i - 1] + 0.5 * module * (shaft->teeth[i] + shaft->teeth[i - 1]);
        } else if (i > 0) {
            shaft->at[i] = shaft->at[i - 1];
        }
    }
}

static bool is_meshed(const Shaft *shaft, size_t number)
{
    return number > 0 && shaft->at[number] > shaft->at[number - 1];
}

// One at which an inertia rings with a frequency up to 1 kHz.
static double draw_stiffness(Draw *draw, double inertia, double least_hz)
{
    const double rate = 2.0 * M_PI * draw_log_between(draw, least_hz, 1000.0);
    return inertia * rate * rate;
}

// A wheel and a first flywheel turn on the ground; a later flywheel on the one before.
static void write_joints(Shaft *shaft, FILE *file)
{
    Draw *draw = &shaft->draw;
    for (size_t i = 0; i < shaft->count; i++) {
        const double inertia = shaft->inertias[i];
        fprintf(file, "  joint-%zu: {between: [", i);
        if (i == 0 || is_meshed(shaft, i)) {
            fprintf(file, "ground");
        } else {
            fprintf(file, "rotor-%zu", i - 1);
        }
        fprintf(file, ", rotor-%zu], at: [%.15g m, 0 m]", i, shaft->at[i]);
        if (i > 0 && !is_meshed(shaft, i) && draw_chance(draw, 0.4)) {
            const double restitution = draw_between(draw, 0.2, 0.95);
            const double stiffness = draw_stiffness(draw, inertia, 20.0);
            fprintf(file, ", backlash: %.6g deg, stiffness: %.5g N m/rad, restitution: %.3g",
                    draw_log_between(draw, 0.01, 5.0), stiffness, restitution);
        }
        fprintf(file, "}\n");
    }
}

// Pairs of gears need two pivots on one carrier, here the ground.
static void write_meshes(Shaft *shaft, FILE *file)
{
    Draw *draw = &shaft->draw;
    for (size_t i = 1; i < shaft->count; i++) {
        if (!is_meshed(shaft, i) || (i > 1 && !is_meshed(shaft, i - 1))) {
            continue;
        }
        const double share = (double)shaft->teeth[i] / (shaft->teeth[i] + shaft->teeth[i - 1]);
        const double radius = (shaft->at[i] - shaft->at[i - 1]) * share;
        const double restitution = draw_between(draw, 0.2, 0.95);
        const double stiffness =
            draw_stiffness(draw, shaft->inertias[i] / (radius * radius), 200.0);
        fprintf(file,
                "  mesh-%zu: {gears: [joint-%zu, joint-%zu], teeth: [%d, %d], backlash: %.6g mm,\n"
                "    stiffness: %.5g N/m, restitution: %.3g}\n",
                i, i - 1, i, shaft->teeth[i - 1], shaft->teeth[i],
                draw_log_between(draw, 1e-3, 0.3), stiffness, restitution);
    }
}

static void write_springs(Shaft *shaft, FILE *file)
{
    Draw *draw = &shaft->draw;
    fprintf(file, "torsion-springs:\n");
    for (size_t i = 0; i < shaft->count; i++) {
        const double stiffness = draw_stiffness(draw, shaft->inertias[i], 5.0);
        const double damping =
            draw_log_between(draw, 1e-3, 0.5) * sqrt(stiffness * shaft->inertias[i]);
        fprintf(file, "  coil-%zu: {joint: joint-%zu, ", i, i);
        if (i > 0 || draw_chance(draw, 0.5)) {
            fprintf(file, "stiffness: %.5g N m/rad, ", stiffness);
        }
        fprintf(file, "damping: %.5g N m s/rad}\n", damping);
    }
}

// Any damping but the last, the viscous one, whose coefficient is not that of a torque.
static void write_damping(Draw *draw, FILE *file)
{
#define ROTOR_WORD(id, word, ...) word,
    static const char *const DAMPINGS[] = {OPTIONS_DAMPING_LIST(ROTOR_WORD)};
    fprintf(file, "contact: {damping: %s}\n", DAMPINGS[draw_below(draw, DAMPING_VISCOUS)]);
}

static void write_rotors(uint64_t seed, FILE *file)
{
    Shaft shaft = {.draw = draw_start(seed)};
    Draw *draw = &shaft.draw;
    draw_rotors(&shaft);
    const size_t drive = shaft.count > 1 ? draw_below(draw, 4) : draw_below(draw, 2);
    fprintf(file, "title: Random rotors %llu\nbodies:\n", (unsigned long long)seed);
    for (size_t i = 0; i < shaft.count; i++) {
        fprintf(file, "  rotor-%zu: {mass: %.5g kg, inertia: %.6g kg mm^2, at: [%.15g m, 0 m]", i,
                draw_log_between(draw, 0.1, 10.0), 1e6 * shaft.inertias[i], shaft.at[i]);
        if (drive < 2) {
            fprintf(file, ", spin: %.5g rad/s", draw_between(draw, -50.0, 50.0));
        }
        fprintf(file, "}\n");
    }
    fprintf(file, "joints:\n");
    write_joints(&shaft, file);
    write_meshes(&shaft, file);
    write_springs(&shaft, file);
    const double speed = draw_speed_rpm(draw);
    const double torque = shaft.inertias[0] * draw_log_between(draw, 10.0, 1e4);
    if (drive == 1) {
        fprintf(file, "drive: {joint: joint-0, torque: [[0 s, %.5g N m], [20 ms, %.5g N m]]}\n",
                torque, -0.3 * torque);
    } else if (drive == 2) {
        fprintf(file, "drive: {joint: joint-0, speed: %.5g rpm}\n", speed);
    } else if (drive == 3) {
        fprintf(file, "drive: {joint: joint-0, speed: [[0 s, 0 rpm], [%.4g ms, %.5g rpm]]}\n",
                draw_between(draw, 5.0, 40.0), speed);
    }
    write_damping(draw, file);
    draw_run(draw, drive == 2 ? "revolutions: 1" : "duration: 0.1 s", file);
}

const CaseKind CASE_ROTORS = {
    .name = "rotors",
    .summary = "balanced rotors on springs, couplings and gears, free, under a torque or driven",
    .write = write_rotors,
};
