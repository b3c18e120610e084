// Draws the sizes of random cases, so that motions that never separate, rattle and are chaotic all
// occur: forces are drawn as ratios to the inertia force of the motion that is imposed.
#include "settled_case.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum {
    CAMS_LAST = 8,
    ARMS_LAST = 14,
    BEAMS_LAST = 20,
    GEARS_LAST = 34,
    PIVOTS_LAST = 40,
    FOUR_BARS_LAST = 50,
};

// digits of sizes in a case file
enum { DIGITS = 3, TIME_DIGITS = 12 };

// of a four-bar's transmission angle: the coupler neither locks nor snaps through by its play
static const double TRANSMISSION_LEAST = 40.0 * M_PI / 180.0;

SettledDraw settled_draw_start(uint64_t seed, uint64_t stream)
{
    SettledDraw draw = {seed * 0x9e3779b97f4a7c15u + stream * 0xd1342543de82ef95u};
    // neighbouring seeds have nothing in common after one round
    settled_draw(&draw, 0.0, 1.0);
    return draw;
}

double settled_draw(SettledDraw *draw, double low, double high)
{
    uint64_t z = draw->state += 0x9e3779b97f4a7c15u;
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
    z ^= z >> 31;
    return low + (high - low) * (double)(z >> 11) * 0x1p-53;
}

static double round_to(double value, int digits)
{
    char text[40];
    snprintf(text, sizeof text, "%.*g", digits, value);
    return strtod(text, NULL);
}

static double rounded(double value)
{
    return round_to(value, DIGITS);
}

static double between(SettledDraw *draw, double low, double high)
{
    return rounded(settled_draw(draw, low, high));
}

// Uniform in the logarithm, without rounding.
static double spread(SettledDraw *draw, double low, double high)
{
    return exp(settled_draw(draw, log(low), log(high)));
}

static double log_between(SettledDraw *draw, double low, double high)
{
    return rounded(spread(draw, low, high));
}

static bool chance(SettledDraw *draw, double probability)
{
    return settled_draw(draw, 0.0, 1.0) < probability;
}

static void name_case(SettledCase *sizes, const char *word, int number)
{
    snprintf(sizes->name, sizeof sizes->name, "%s-%02d", word, number);
}

// The angle of a drive with so large an amplitude, rad from trough to crest, and a share of the
// second harmonic, from 0 at the start.
static void set_ripple(SettledCase *sizes, double amplitude, double second)
{
    SettledTable *table = &sizes->table;
    table->count = SETTLED_POINTS;
    for (size_t i = 0; i < table->count; i++) {
        const double phase = 2.0 * M_PI * (double)i / (double)table->count;
        const double share = 0.5 * (1.0 - cos(phase)) + second * 0.5 * (1.0 - cos(2.0 * phase));
        table->at[i] = round_to(sizes->period * (double)i / (double)table->count, TIME_DIGITS);
        table->values[i] = round_to(amplitude * share, TIME_DIGITS);
    }
}

// A load about a mean, with so large an amplitude: a triangle, or nearly a sine.
static void set_load(SettledDraw *draw, SettledCase *sizes, double mean, double amplitude)
{
    static const double SINE[] = {0.0, 1.0, 0.0, -1.0};
    SettledTable *table = &sizes->table;
    table->is_smooth = chance(draw, 0.5);
    table->count = table->is_smooth ? 4 : 2;
    const double rise = settled_draw(draw, 0.3, 0.7);
    for (size_t i = 0; i < table->count; i++) {
        const double share = table->is_smooth ? 0.25 * (double)i : rise * (double)i;
        const double value = table->is_smooth ? SINE[i] : i == 0 ? -1.0 : 1.0;
        table->at[i] = rounded(share * sizes->period);
        table->values[i] = rounded(mean + amplitude * value);
    }
}

static void draw_cam(SettledDraw *draw, SettledCase *sizes)
{
    sizes->kind = SETTLED_CAM;
    sizes->speed = log_between(draw, 300.0, 4000.0);
    sizes->period = 60.0 / sizes->speed;
    sizes->eccentricity = log_between(draw, 1e-3, 8e-3);
    sizes->radius = between(draw, 15e-3, 30e-3);
    sizes->mass = log_between(draw, 0.05, 0.5);
    // the spring's force at the top against the inertia force: above about 1 the follower never
    // leaves its cam
    const double omega = 2.0 * M_PI / sizes->period;
    const double force =
        spread(draw, 0.15, 1.5) * sizes->mass * sizes->eccentricity * omega * omega;
    const double squeezed = log_between(draw, 3e-3, 60e-3);
    sizes->spring = rounded(force / (squeezed + 2.0 * sizes->eccentricity));
    sizes->spring_length = round_to(0.26 + squeezed, 4);
    sizes->stiffness = log_between(draw, 1e6, 1e8);
    sizes->restitution = between(draw, 0.2, 0.8);
    sizes->low = 0.0;
    sizes->high = INFINITY;
}

static void draw_arm(SettledDraw *draw, SettledCase *sizes)
{
    const bool is_rotor = chance(draw, 0.5);
    sizes->kind = SETTLED_ARM;
    sizes->mass = log_between(draw, 0.3, 3.0);
    sizes->reach = is_rotor ? 0.0 : between(draw, 0.05, 0.2);
    sizes->gravity = is_rotor ? 0.0 : 9.81;
    sizes->inertia = log_between(draw, 1e-3, 2e-2);
    sizes->period = rounded(spread(draw, 10e-3, 60e-3));
    sizes->restitution = between(draw, 0.1, 0.8);
    const double omega = 2.0 * M_PI / sizes->period;
    const double inertia = sizes->inertia + sizes->mass * sizes->reach * sizes->reach;
    sizes->stiffness = rounded(inertia * pow(omega * spread(draw, 3.0, 30.0), 2.0));
    sizes->low = 0.0;
    if (is_rotor) {
        // the load alone carries it across the gap, or nearly so
        sizes->high = between(draw, 5e-3, 50e-3);
        const double amplitude =
            spread(draw, 0.2, 2.0) * 0.5 * sizes->high * inertia * omega * omega;
        set_load(draw, sizes, -settled_draw(draw, 0.0, 0.5) * amplitude, amplitude);
        sizes->start = rounded(0.5 * sizes->high);
    } else {
        sizes->high = INFINITY;
        const double weight = sizes->mass * sizes->gravity * sizes->reach;
        set_load(draw, sizes, 0.0, weight * spread(draw, 0.5, 6.0));
        sizes->start = between(draw, 0.005, 0.03);
    }
}

static void draw_beam(SettledDraw *draw, SettledCase *sizes)
{
    sizes->kind = SETTLED_BEAM;
    sizes->mass = log_between(draw, 0.1, 2.0);
    const double natural = 2.0 * M_PI * spread(draw, 5.0, 50.0);
    sizes->spring = rounded(sizes->mass * natural * natural);
    const double ratio = settled_draw(draw, 0.6, 2.4);
    sizes->period = rounded(2.0 * M_PI / (natural * ratio));
    const double zeta = spread(draw, 0.005, 0.1);
    sizes->damping = rounded(2.0 * zeta * sizes->mass * natural);
    sizes->low = -INFINITY;
    sizes->high = log_between(draw, 5e-5, 2e-3);
    sizes->stiffness = rounded(sizes->spring * spread(draw, 10.0, 1000.0));
    sizes->restitution = between(draw, 0.3, 0.9);
    // what the beam would swing without the stop, against the gap: it always meets the stop
    const double swing = sizes->high * spread(draw, 1.4, 10.0);
    const double receptance = hypot(1.0 - ratio * ratio, 2.0 * zeta * ratio);
    set_load(draw, sizes, 0.0, swing * sizes->spring * fmax(receptance, 0.1));
}

static void draw_gears(SettledDraw *draw, SettledCase *sizes)
{
    sizes->kind = SETTLED_GEARS;
    sizes->inertia = log_between(draw, 1e-3, 5e-2);
    sizes->teeth[0] = (int)settled_draw(draw, 17.0, 40.0);
    sizes->teeth[1] = (int)settled_draw(draw, 20.0, 60.0);
    sizes->distance = between(draw, 0.1, 0.3);
    sizes->period = rounded(2.0 * M_PI / spread(draw, 20.0, 400.0));
    const double teeth = (double)(sizes->teeth[0] + sizes->teeth[1]);
    const double radius_a = sizes->distance * sizes->teeth[0] / teeth;
    const double radius = sizes->distance * sizes->teeth[1] / teeth;
    const double mass = sizes->inertia / (radius * radius);
    const double omega = 2.0 * M_PI / sizes->period;
    const double backlash = log_between(draw, 2e-5, 5e-4);
    sizes->high = 0.5 * backlash;
    sizes->low = -sizes->high;
    // transmission error at the pitch circle, from trough to crest
    const double error = backlash * spread(draw, 0.05, 1.0);
    set_ripple(sizes, rounded(error / radius_a),
               chance(draw, 0.4) ? settled_draw(draw, 0.1, 0.4) : 0.0);
    const double tuning = spread(draw, 1.0, 30.0);
    sizes->stiffness = rounded(fmin(fmax(mass * pow(omega * tuning, 2.0), 1e4), 1e7));
    sizes->load = rounded(spread(draw, 0.1, 2.0) * mass * 0.5 * error * omega * omega * radius);
    sizes->damping = rounded(sizes->inertia * omega * spread(draw, 0.005, 0.2));
    sizes->restitution = chance(draw, 0.3) ? 1.0 : between(draw, 0.3, 0.9);
}

static void draw_pivot(SettledDraw *draw, SettledCase *sizes)
{
    sizes->kind = SETTLED_PIVOT;
    sizes->inertia = log_between(draw, 1e-4, 1e-2);
    sizes->period = rounded(2.0 * M_PI / spread(draw, 20.0, 400.0));
    const double omega = 2.0 * M_PI / sizes->period;
    const double backlash = log_between(draw, 2e-3, 3e-2);
    sizes->high = 0.5 * backlash;
    sizes->low = -sizes->high;
    const double ripple = rounded(backlash * spread(draw, 0.1, 2.0));
    set_ripple(sizes, ripple, chance(draw, 0.4) ? settled_draw(draw, 0.1, 0.4) : 0.0);
    sizes->stiffness = rounded(sizes->inertia * pow(omega * spread(draw, 3.0, 30.0), 2.0));
    sizes->load = rounded(spread(draw, 0.05, 1.5) * sizes->inertia * 0.5 * ripple * omega * omega);
    sizes->damping = rounded(sizes->inertia * omega * spread(draw, 0.005, 0.2));
    sizes->restitution = between(draw, 0.3, 0.9);
}

static SettledLink draw_link(SettledDraw *draw, double length)
{
    const double mass = rounded(length * settled_draw(draw, 1.0, 3.0));
    return (SettledLink){
        .length = length,
        .mass = mass,
        .inertia = rounded(mass * length * length / 12.0 * settled_draw(draw, 1.0, 1.5)),
    };
}

static void draw_pin(SettledDraw *draw, SettledCase *sizes)
{
    sizes->speed = log_between(draw, 120.0, 3000.0);
    sizes->period = 60.0 / sizes->speed;
    sizes->gravity = 9.81;
    sizes->restitution = between(draw, 0.3, 0.9);
    const double clearance = round_to(spread(draw, 5e-5, 5e-4), 2);
    sizes->pin = between(draw, 8e-3, 20e-3);
    sizes->hole = round_to(sizes->pin + 2.0 * clearance, 6);
    sizes->clearance = 0.5 * (sizes->hole - sizes->pin);
    sizes->stiffness = chance(draw, 0.5) ? log_between(draw, 1e9, 1e11) : 0.0;
}

// The angle between coupler and follower where the crank points along the ground link or away.
static double transmission_least(const SettledCase *sizes)
{
    double least = M_PI;
    for (int side = -1; side <= 1; side += 2) {
        const double d = sizes->ground + side * sizes->crank.length;
        const double b = sizes->coupler.length;
        const double c = sizes->last.length;
        const double cosine = (b * b + c * c - d * d) / (2.0 * b * c);
        if (!(fabs(cosine) < 1.0)) {
            return 0.0;
        }
        const double angle = acos(cosine);
        least = fmin(least, fmin(angle, M_PI - angle));
    }
    return least;
}

static void draw_four_bar(SettledDraw *draw, SettledCase *sizes)
{
    sizes->kind = chance(draw, 0.5) ? SETTLED_COUPLER_PIN : SETTLED_FOLLOWER_PIN;
    draw_pin(draw, sizes);
    const double crank = between(draw, 30e-3, 80e-3);
    // crank-rockers only: the crank is the shortest and the loop closes everywhere
    do {
        sizes->crank = draw_link(draw, crank);
        sizes->ground = rounded(crank * settled_draw(draw, 2.0, 4.0));
        sizes->coupler = draw_link(draw, rounded(crank * settled_draw(draw, 1.5, 4.0)));
        sizes->last = draw_link(draw, rounded(crank * settled_draw(draw, 1.5, 4.0)));
    } while (!(transmission_least(sizes) > TRANSMISSION_LEAST));
}

static void draw_slider_crank(SettledDraw *draw, SettledCase *sizes)
{
    sizes->kind = chance(draw, 0.5) ? SETTLED_CRANK_PIN : SETTLED_WRIST_PIN;
    draw_pin(draw, sizes);
    const double crank = between(draw, 20e-3, 70e-3);
    sizes->crank = draw_link(draw, crank);
    sizes->coupler = draw_link(draw, rounded(crank * settled_draw(draw, 2.2, 5.0)));
    sizes->offset = chance(draw, 0.3) ? rounded(crank * settled_draw(draw, -0.5, 0.5)) : 0.0;
    const double mass = log_between(draw, 0.05, 1.0);
    sizes->last = (SettledLink){.mass = mass, .inertia = rounded(mass * 1e-3)};
}

SettledCase settled_case_draw(uint64_t seed, int number)
{
    SettledDraw draw = settled_draw_start(seed, (uint64_t)number);
    SettledCase sizes = {.restitution = 1.0};
    if (number <= CAMS_LAST) {
        draw_cam(&draw, &sizes);
        name_case(&sizes, "cam", number);
    } else if (number <= ARMS_LAST) {
        draw_arm(&draw, &sizes);
        name_case(&sizes, "stop", number);
    } else if (number <= BEAMS_LAST) {
        draw_beam(&draw, &sizes);
        name_case(&sizes, "beam", number);
    } else if (number <= GEARS_LAST) {
        draw_gears(&draw, &sizes);
        name_case(&sizes, "gears", number);
    } else if (number <= PIVOTS_LAST) {
        draw_pivot(&draw, &sizes);
        name_case(&sizes, "pivot", number);
    } else if (number <= FOUR_BARS_LAST) {
        draw_four_bar(&draw, &sizes);
        name_case(&sizes, "four-bar", number);
    } else {
        draw_slider_crank(&draw, &sizes);
        name_case(&sizes, "slider-crank", number);
    }
    return sizes;
}

// A: eccentric cam under a follower.
static SettledCase case_a(void)
{
    return (SettledCase){
        .kind = SETTLED_CAM,
        .speed = 2500.0,
        .period = 60.0 / 2500.0,
        .eccentricity = 5e-3,
        .radius = 20e-3,
        .mass = 0.2,
        .spring = 2000.0,
        .spring_length = 0.27,
        .stiffness = 1e7,
        .restitution = 0.6,
        .high = INFINITY,
    };
}

// B and C: gears under a transmission error of that angular frequency, rad/s.
static SettledCase case_gears(double omega)
{
    SettledCase sizes = {
        .kind = SETTLED_GEARS,
        .period = round_to(2.0 * M_PI / omega, TIME_DIGITS),
        .inertia = 0.01,
        .teeth = {20, 20},
        .distance = 0.2,
        .low = -1e-4,
        .high = 1e-4,
        .stiffness = 1e4,
        .restitution = 1.0,
        .damping = 0.1,
        .load = 0.01,
    };
    set_ripple(&sizes, 1e-4, 0.0);
    return sizes;
}

// D: slider-crank with play at the wrist pin, at a speed in rpm.
static SettledCase case_d(double speed)
{
    return (SettledCase){
        .kind = SETTLED_WRIST_PIN,
        .speed = speed,
        .period = 60.0 / speed,
        .gravity = 9.80665,
        .restitution = 0.7,
        .pin = 20e-3,
        .hole = 20.4e-3,
        .clearance = 0.2e-3,
        .crank = {50e-3, 0.3, 1e-4},
        .coupler = {120e-3, 0.21, 2.5e-4},
        .last = {0.0, 0.14, 1e-4},
    };
}

// G: arm on a stop under a load that ripples. Its centre of mass is at (0.1, 0.01) m at 0.1 rad,
// here on the arm's own axis: 0.1005 m at 0.0997 rad, less 3e-4 rad.
static SettledCase case_g(void)
{
    return (SettledCase){
        .kind = SETTLED_ARM,
        .period = 20e-3,
        .gravity = 9.81,
        .mass = 1.0,
        .inertia = 0.01,
        .reach = 0.100498756211209,
        .start = 0.1,
        .low = 0.0,
        .high = 0.5 * M_PI,
        .stiffness = 1000.0,
        .restitution = 0.3,
        .table = {.count = 2, .at = {0.0, 10e-3}, .values = {0.0, 0.5}},
    };
}

bool settled_case_named(const char *name, SettledCase *found)
{
    if (strcmp(name, "A") == 0) {
        *found = case_a();
    } else if (strcmp(name, "B") == 0) {
        *found = case_gears(80.0);
    } else if (strcmp(name, "C") == 0) {
        *found = case_gears(100.0);
    } else if (name[0] == 'D' && atof(name + 1) > 0.0) {
        *found = case_d(atof(name + 1));
    } else if (strcmp(name, "G") == 0) {
        *found = case_g();
    } else {
        return false;
    }
    snprintf(found->name, sizeof found->name, "%s", name);
    return true;
}
