// Moves links, pins and bushings in the coordinates of all bodies.
//
//     M a = F + J' l,   J a = g   with J the pins' rows (and the drive's), by elimination
// integrated by the extrapolated modified midpoint rule (Gragg, Bulirsch and Stoer), whose steps
// are halved until two columns agree, also where a curve has a kink.
#include "bushed.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum {
    STATE_MOST = 6 * BUSHED_BODIES,
    ROWS_MOST = 2 * BUSHED_PINS + 1,
    SYSTEM_MOST = 3 * BUSHED_BODIES + ROWS_MOST,
    COLUMNS = 8,
    TEXT_SIZE = 16384,
};

// of positions, m, and of speeds, m/s: by the step
static const double AGREED = 1e-13;
static const double STEP_FIRST = 1e-3; // s
static const double STEP_MOST = 8e-3;
static const double STEP_LEAST = 1e-12; // below it a kink is passed

// Random numbers of its own: Knuth's MMIX generator.
static double draw(unsigned long long *seed, double low, double high)
{
    *seed = *seed * 6364136223846793005ULL + 1442695040888963407ULL;
    return low + (high - low) * (double)(*seed >> 11) / 9007199254740992.0;
}

// A curve that rises through zero, with a soft middle and stiff ends.
static void draw_curve(BushedMount *mount, int row, double width, double stiffness,
                       unsigned long long *seed)
{
    static const double RISE[] = {2.6, 0.5, 0.7, 1.3, 3.1};
    const size_t count = 6;
    double over = -width;
    double pull = 0.0;
    mount->points[row] = count;
    for (size_t i = 0; i < count; i++) {
        mount->over[row][i] = over;
        mount->pull[row][i] = pull;
        const double wide = width * draw(seed, 0.3, 0.5);
        over += wide;
        pull += i + 1 < count ? wide * stiffness * RISE[i] * draw(seed, 0.8, 1.2) : 0.0;
    }
    // its third point stands at no deflection, where it is nearly relaxed
    const double shift = mount->over[row][2];
    const double lift = mount->pull[row][2];
    for (size_t i = 0; i < count; i++) {
        mount->over[row][i] -= shift;
        mount->pull[row][i] -= lift;
    }
}

static void draw_mount(Bushed *bushed, int a, int b, double x, double y, unsigned long long *seed)
{
    BushedMount *mount = &bushed->mounts[bushed->mount_count++];
    *mount = (BushedMount){.bodies = {a, b}, .at = {{x, y}, {x, y}}};
    mount->direction = draw(seed, -3.0, 3.0);
    for (int row = 0; row < 3; row++) {
        const double scale = row == 2 ? 0.01 : 1.0;
        mount->stiffness[row] = scale * exp(draw(seed, log(300.0), log(2e4)));
        mount->damping[row] = scale * draw(seed, 0.0, 40.0);
    }
    if (draw(seed, 0.0, 1.0) < 0.5) {
        mount->is_smooth = draw(seed, 0.0, 1.0) < 0.5;
        for (int row = 0; row < 3; row++) {
            draw_curve(mount, row, row == 2 ? 0.2 : 5e-3, mount->stiffness[row], seed);
        }
    }
    if (draw(seed, 0.0, 1.0) < 0.4) {
        mount->at[1][0] += draw(seed, -4e-3, 4e-3);
        mount->at[1][1] += draw(seed, -4e-3, 4e-3);
    }
    mount->has_angle = draw(seed, 0.0, 1.0) < 0.4;
    const double angle_a = a == BUSHED_GROUND ? 0.0 : bushed->bodies[a].state[2];
    const double angle_b = b == BUSHED_GROUND ? 0.0 : bushed->bodies[b].state[2];
    mount->angle = angle_b - angle_a + (mount->has_angle ? draw(seed, -0.05, 0.05) : 0.0);
}

Bushed bushed_random(unsigned number)
{
    unsigned long long seed = 977ULL * (number + 1);
    draw(&seed, 0.0, 1.0);
    Bushed bushed = {.gravity = 9.81, .end_s = 0.5};
    bushed.body_count = (size_t)draw(&seed, 2.0, BUSHED_BODIES + 0.999);
    bushed.driven = number % 4 == 0 ? 10.0 : 0.0;
    double x = draw(&seed, -0.3, 0.3);
    double y = draw(&seed, -0.3, 0.3);
    for (int i = 0; i < (int)bushed.body_count; i++) {
        BushedBody *body = &bushed.bodies[i];
        const double length = draw(&seed, 0.2, 0.5);
        const double angle = draw(&seed, -1.5, 1.5);
        body->mass = draw(&seed, 0.5, 2.0);
        body->inertia = body->mass * length * length / 12.0;
        body->state[0] = x + 0.5 * length * cos(angle);
        body->state[1] = y + 0.5 * length * sin(angle);
        body->state[2] = angle;
        const bool is_after_drive = i == 1 && bushed.driven > 0.0;
        const bool is_pinned =
            !is_after_drive && ((i == 0 && bushed.driven > 0.0) || draw(&seed, 0.0, 1.0) < 0.4);
        // the ground stands on either side
        const bool is_turned = draw(&seed, 0.0, 1.0) < 0.5;
        if (is_pinned) {
            bushed.pins[bushed.pin_count++] = (BushedPin){{i - 1, i}, {x, y}};
        } else if (is_turned) {
            draw_mount(&bushed, i, i - 1, x, y, &seed);
        } else {
            draw_mount(&bushed, i - 1, i, x, y, &seed);
        }
        x += length * cos(angle);
        y += length * sin(angle);
    }
    draw_mount(&bushed, (int)bushed.body_count - 1, BUSHED_GROUND, x, y, &seed);
    if (bushed.driven > 0.0) {
        bushed.end_s = 0.8 * 2.0 * M_PI / bushed.driven;
        BushedBody *crank = &bushed.bodies[0];
        crank->state[5] = bushed.driven;
        crank->state[3] = -bushed.driven * (crank->state[1] - bushed.pins[0].at[1]);
        crank->state[4] = bushed.driven * (crank->state[0] - bushed.pins[0].at[0]);
    }
    return bushed;
}

// The case.

static void put_name(int body, char name[16])
{
    snprintf(name, 16, body == BUSHED_GROUND ? "ground" : "b%d", body);
}

static size_t put_mount(const BushedMount *mount, size_t number, char *text, size_t size)
{
    char a[16];
    char b[16];
    put_name(mount->bodies[0], a);
    put_name(mount->bodies[1], b);
    const bool is_apart = mount->at[0][0] != mount->at[1][0] || mount->at[0][1] != mount->at[1][1];
    int used = snprintf(text, size, "  m%zu:\n    between: [%s, %s]\n", number, a, b);
    for (int side = 0; side < (is_apart ? 2 : 1); side++) {
        used += snprintf(text + used, size - (size_t)used, "    at%s: [%.17g m, %.17g m]\n",
                         !is_apart   ? ""
                         : side == 0 ? "-a"
                                     : "-b",
                         mount->at[side][0], mount->at[side][1]);
    }
    used +=
        snprintf(text + used, size - (size_t)used, "    direction: %.17g rad\n", mount->direction);
    used += snprintf(text + used, size - (size_t)used, "    damping: [%.17g N s/m, %.17g N s/m]\n",
                     mount->damping[0], mount->damping[1]);
    used += snprintf(text + used, size - (size_t)used, "    torsional-damping: %.17g N m s/rad\n",
                     mount->damping[2]);
    if (mount->has_angle) {
        used += snprintf(text + used, size - (size_t)used, "    angle: %.17g rad\n", mount->angle);
    }
    if (mount->points[0] == 0) {
        used += snprintf(text + used, size - (size_t)used,
                         "    stiffness: [%.17g N/m, %.17g N/m]\n    torsional-stiffness: %.17g N "
                         "m/rad\n",
                         mount->stiffness[0], mount->stiffness[1], mount->stiffness[2]);
        return (size_t)used;
    }
    used += snprintf(text + used, size - (size_t)used, "    interpolation: %s\n",
                     mount->is_smooth ? "smooth" : "linear");
    for (int row = 0; row < 3; row++) {
        static const char *const KEYS[] = {"force-x", "force-y", "torque"};
        used += snprintf(text + used, size - (size_t)used, "    %s: [", KEYS[row]);
        for (size_t i = 0; i < mount->points[row]; i++) {
            used += snprintf(text + used, size - (size_t)used,
                             row == 2 ? "%s[%.17g rad, %.17g N m]" : "%s[%.17g m, %.17g N]",
                             i > 0 ? ", " : "", mount->over[row][i], mount->pull[row][i]);
        }
        used += snprintf(text + used, size - (size_t)used, "]\n");
    }
    return (size_t)used;
}

char *bushed_case(const Bushed *bushed)
{
    char *text = malloc(TEXT_SIZE);
    size_t used =
        (size_t)snprintf(text, TEXT_SIZE, "gravity: %.17g m/s^2\nbodies:\n", bushed->gravity);
    for (size_t i = 0; i < bushed->body_count; i++) {
        const BushedBody *body = &bushed->bodies[i];
        used += (size_t)snprintf(text + used, TEXT_SIZE - used,
                                 "  b%zu: {mass: %.17g kg, inertia: %.17g kg m^2, at: [%.17g m, "
                                 "%.17g m], angle: %.17g rad}\n",
                                 i, body->mass, body->inertia, body->state[0], body->state[1],
                                 body->state[2]);
    }
    used += (size_t)snprintf(text + used, TEXT_SIZE - used, "bushings:\n");
    for (size_t i = 0; i < bushed->mount_count; i++) {
        used += put_mount(&bushed->mounts[i], i, text + used, TEXT_SIZE - used);
    }
    if (bushed->pin_count > 0) {
        used += (size_t)snprintf(text + used, TEXT_SIZE - used, "joints:\n");
    }
    for (size_t i = 0; i < bushed->pin_count; i++) {
        const BushedPin *pin = &bushed->pins[i];
        char a[16];
        char b[16];
        put_name(pin->bodies[0], a);
        put_name(pin->bodies[1], b);
        used += (size_t)snprintf(text + used, TEXT_SIZE - used,
                                 "  p%zu: {between: [%s, %s], at: [%.17g m, %.17g m]}\n", i, a, b,
                                 pin->at[0], pin->at[1]);
    }
    if (bushed->driven > 0.0) {
        snprintf(
            text + used, TEXT_SIZE - used,
            "drive: {joint: p0, speed: %.17g rad/s}\nrun: {revolutions: %.17g, samples: 200}\n",
            bushed->driven, bushed->end_s * bushed->driven / (2.0 * M_PI));
    } else {
        snprintf(text + used, TEXT_SIZE - used, "run: {duration: %.17g s, samples: 100}\n",
                 bushed->end_s);
    }
    return text;
}

// The motion.

// The slope of the cubic at an inner point, by the harmonic mean of Fritsch and Butland; at an end
// that of the line there.
static double cubic_slope(const double *x, const double *f, size_t count, size_t i)
{
    if (i == 0) {
        return (f[1] - f[0]) / (x[1] - x[0]);
    }
    if (i + 1 == count) {
        return (f[i] - f[i - 1]) / (x[i] - x[i - 1]);
    }
    const double before = (f[i] - f[i - 1]) / (x[i] - x[i - 1]);
    const double behind = (f[i + 1] - f[i]) / (x[i + 1] - x[i]);
    if (before * behind <= 0.0) {
        return 0.0;
    }
    const double share = (1.0 + (x[i + 1] - x[i]) / (x[i + 1] - x[i - 1])) / 3.0;
    return before * behind / (share * behind + (1.0 - share) * before);
}

static double curve_pull(const BushedMount *mount, int row, double u)
{
    const double *x = mount->over[row];
    const double *f = mount->pull[row];
    const size_t count = mount->points[row];
    size_t i = 0;
    while (i + 2 < count && u > x[i + 1]) {
        i++;
    }
    const double h = x[i + 1] - x[i];
    const double t = (u - x[i]) / h;
    if (!mount->is_smooth || t < 0.0 || t > 1.0) {
        return f[i] + t * (f[i + 1] - f[i]); // the ends of the cubic have the slope of their lines
    }
    const double m0 = cubic_slope(x, f, count, i);
    const double m1 = cubic_slope(x, f, count, i + 1);
    const double s = 1.0 - t;
    return f[i] * (1.0 + 2.0 * t) * s * s + h * m0 * t * s * s +
           f[i + 1] * t * t * (3.0 - 2.0 * t) - h * m1 * t * t * s;
}

typedef struct Anchored {
    double arms[2][2]; // m, of the anchors in their bodies' frames (of the ground in the world's)
} Anchored;

static Anchored anchored(const Bushed *bushed, const int bodies[2], const double *at_a,
                         const double *at_b)
{
    Anchored found;
    for (int side = 0; side < 2; side++) {
        const double *at = side == 0 ? at_a : at_b;
        memcpy(found.arms[side], at, sizeof found.arms[side]);
        if (bodies[side] != BUSHED_GROUND) {
            const double *own = bushed->bodies[bodies[side]].state;
            const double dx = at[0] - own[0];
            const double dy = at[1] - own[1];
            found.arms[side][0] = cos(own[2]) * dx + sin(own[2]) * dy;
            found.arms[side][1] = -sin(own[2]) * dx + cos(own[2]) * dy;
        }
    }
    return found;
}

typedef struct Place {
    double at[2];    // m
    double going[2]; // m/s
    double arm[2];   // m, from the centre of mass, in the world
    double angle;
    double omega;
} Place;

static Place place_of(const double *y, size_t count, int body, const double arm[2])
{
    if (body == BUSHED_GROUND) {
        return (Place){.at = {arm[0], arm[1]}};
    }
    const double *q = y + 3 * (size_t)body;
    const double *v = y + 3 * (count + (size_t)body);
    const double c = cos(q[2]);
    const double s = sin(q[2]);
    Place place = {
        .arm = {c * arm[0] - s * arm[1], s * arm[0] + c * arm[1]}, .angle = q[2], .omega = v[2]};
    place.at[0] = q[0] + place.arm[0];
    place.at[1] = q[1] + place.arm[1];
    place.going[0] = v[0] - v[2] * place.arm[1];
    place.going[1] = v[1] + v[2] * place.arm[0];
    return place;
}

static void push(const Place *place, const double *at, int body, double fx, double fy,
                 double moment, double *forces)
{
    if (body != BUSHED_GROUND) {
        double *force = forces + 3 * (size_t)body;
        const double rx = at[0] - (place->at[0] - place->arm[0]);
        const double ry = at[1] - (place->at[1] - place->arm[1]);
        force[0] += fx;
        force[1] += fy;
        force[2] += rx * fy - ry * fx + moment;
    }
}

static void push_mount(const Bushed *bushed, const BushedMount *mount, const double *y,
                       double *forces)
{
    const Anchored own = anchored(bushed, mount->bodies, mount->at[0], mount->at[1]);
    const Place a = place_of(y, bushed->body_count, mount->bodies[0], own.arms[0]);
    const Place b = place_of(y, bushed->body_count, mount->bodies[1], own.arms[1]);
    const double start =
        mount->bodies[0] == BUSHED_GROUND ? 0.0 : bushed->bodies[mount->bodies[0]].state[2];
    const double turned = mount->direction + a.angle - start;
    const double d[2] = {b.at[0] - a.at[0], b.at[1] - a.at[1]};
    const double w[2] = {b.going[0] - a.going[0] + a.omega * d[1],
                         b.going[1] - a.going[1] - a.omega * d[0]};
    double pull[3];
    for (int row = 0; row < 3; row++) {
        const double ex = row == 0 ? cos(turned) : -sin(turned);
        const double ey = row == 0 ? sin(turned) : cos(turned);
        const double u = row == 2 ? b.angle - a.angle - mount->angle : ex * d[0] + ey * d[1];
        const double rate = row == 2 ? b.omega - a.omega : ex * w[0] + ey * w[1];
        pull[row] =
            (mount->points[row] > 0 ? curve_pull(mount, row, u) : mount->stiffness[row] * u) +
            mount->damping[row] * rate;
    }
    const double fx = pull[0] * cos(turned) - pull[1] * sin(turned);
    const double fy = pull[0] * sin(turned) + pull[1] * cos(turned);
    push(&a, b.at, mount->bodies[0], fx, fy, pull[2], forces);
    push(&b, b.at, mount->bodies[1], -fx, -fy, -pull[2], forces);
}

// Solves a dense system in place, by elimination with the largest pivot.
static bool solve(size_t n, double a[SYSTEM_MOST][SYSTEM_MOST], double *b)
{
    for (size_t k = 0; k < n; k++) {
        size_t top = k;
        for (size_t i = k + 1; i < n; i++) {
            top = fabs(a[i][k]) > fabs(a[top][k]) ? i : top;
        }
        for (size_t j = 0; j < n; j++) {
            const double kept = a[k][j];
            a[k][j] = a[top][j];
            a[top][j] = kept;
        }
        const double kept = b[k];
        b[k] = b[top];
        b[top] = kept;
        if (!(fabs(a[k][k]) > 0.0)) {
            return false;
        }
        for (size_t i = k + 1; i < n; i++) {
            const double factor = a[i][k] / a[k][k];
            for (size_t j = k; j < n; j++) {
                a[i][j] -= factor * a[k][j];
            }
            b[i] -= factor * b[k];
        }
    }
    for (size_t k = n; k-- > 0;) {
        for (size_t j = k + 1; j < n; j++) {
            b[k] -= a[k][j] * b[j];
        }
        b[k] /= a[k][k];
    }
    return true;
}

// The rows of a pin: their part in the matrix, and what the second rates must make up for.
static void add_pin(const Bushed *bushed, const BushedPin *pin, const double *y, size_t row,
                    double a[SYSTEM_MOST][SYSTEM_MOST], double *b)
{
    const Anchored own = anchored(bushed, pin->bodies, pin->at, pin->at);
    for (int side = 0; side < 2; side++) {
        const int body = pin->bodies[side];
        if (body == BUSHED_GROUND) {
            continue;
        }
        const Place place = place_of(y, bushed->body_count, body, own.arms[side]);
        const double sign = side == 0 ? -1.0 : 1.0;
        const double rows[2][3] = {{sign, 0.0, -sign * place.arm[1]},
                                   {0.0, sign, sign * place.arm[0]}};
        for (size_t i = 0; i < 2; i++) {
            for (size_t k = 0; k < 3; k++) {
                a[row + i][3 * (size_t)body + k] = rows[i][k];
                a[3 * (size_t)body + k][row + i] = rows[i][k];
            }
            b[row + i] += sign * place.omega * place.omega * place.arm[i];
        }
    }
}

static bool rates(const Bushed *bushed, const double *y, double *dy)
{
    const size_t n = 3 * bushed->body_count;
    static double a[SYSTEM_MOST][SYSTEM_MOST];
    double b[SYSTEM_MOST] = {0.0};
    memset(a, 0, sizeof a);
    for (size_t i = 0; i < bushed->body_count; i++) {
        const BushedBody *body = &bushed->bodies[i];
        a[3 * i][3 * i] = a[3 * i + 1][3 * i + 1] = body->mass;
        a[3 * i + 2][3 * i + 2] = body->inertia;
        b[3 * i + 1] = -body->mass * bushed->gravity;
    }
    for (size_t i = 0; i < bushed->mount_count; i++) {
        push_mount(bushed, &bushed->mounts[i], y, b);
    }
    size_t rows = n;
    for (size_t i = 0; i < bushed->pin_count; i++, rows += 2) {
        add_pin(bushed, &bushed->pins[i], y, rows, a, b);
    }
    if (bushed->driven > 0.0) {
        a[rows][2] = a[2][rows] = 1.0;
        rows++;
    }
    if (!solve(rows, a, b)) {
        return false;
    }
    memcpy(dy, y + n, n * sizeof *dy);
    memcpy(dy + n, b, n * sizeof *dy);
    return true;
}

// The modified midpoint rule over a step, in so many parts, with Gragg's smoothing at the end.
static bool midpoint(const Bushed *bushed, const double *y, double step, int parts, double *to)
{
    const size_t n = 6 * bushed->body_count;
    const double h = step / parts;
    double before[STATE_MOST];
    double now[STATE_MOST];
    double dy[STATE_MOST];
    memcpy(before, y, n * sizeof *y);
    if (!rates(bushed, y, dy)) {
        return false;
    }
    for (size_t i = 0; i < n; i++) {
        now[i] = y[i] + h * dy[i];
    }
    for (int k = 1; k < parts; k++) {
        if (!rates(bushed, now, dy)) {
            return false;
        }
        for (size_t i = 0; i < n; i++) {
            const double next = before[i] + 2.0 * h * dy[i];
            before[i] = now[i];
            now[i] = next;
        }
    }
    if (!rates(bushed, now, dy)) {
        return false;
    }
    for (size_t i = 0; i < n; i++) {
        to[i] = 0.5 * (now[i] + before[i] + h * dy[i]);
    }
    return true;
}

// A step by extrapolation; how far the last two columns are apart.
static bool extrapolate(const Bushed *bushed, const double *y, double step, double *to,
                        double *apart)
{
    const size_t n = 6 * bushed->body_count;
    double table[COLUMNS][STATE_MOST];
    for (int k = 0; k < COLUMNS; k++) {
        const int parts = 2 * (k + 1);
        double row[STATE_MOST];
        if (!midpoint(bushed, y, step, parts, row)) {
            return false;
        }
        // Neville's scheme in the square of the parts' length
        for (int j = 0; j < k; j++) {
            const double ratio = (double)parts / (2.0 * (k - j));
            for (size_t i = 0; i < n; i++) {
                const double next = row[i] + (row[i] - table[j][i]) / (ratio * ratio - 1.0);
                table[j][i] = row[i];
                row[i] = next;
            }
        }
        *apart = 0.0;
        for (size_t i = 0; i < n; i++) {
            const double scale = fmax(1.0, fabs(row[i]));
            *apart = fmax(*apart, fabs(row[i] - (k > 0 ? table[k - 1][i] : 0.0)) / scale);
        }
        memcpy(table[k], row, sizeof row);
    }
    memcpy(to, table[COLUMNS - 1], n * sizeof *to);
    return isfinite(*apart);
}

// Takes note of how fast the bodies go.
static void note_speeds(size_t count, const double *y, BushedTruth *truth)
{
    for (size_t i = 0; i < count; i++) {
        const double *v = y + 3 * (count + i);
        truth->fastest = fmax(truth->fastest, hypot(v[0], v[1]));
        truth->turning = fmax(truth->turning, fabs(v[2]));
    }
}

bool bushed_integrate(const Bushed *bushed, BushedTruth *truth)
{
    const size_t count = bushed->body_count;
    double y[STATE_MOST];
    double next[STATE_MOST];
    double time_s = 0.0;
    double step = STEP_FIRST;
    *truth = (BushedTruth){.fastest = 0.0};
    for (size_t i = 0; i < count; i++) {
        memcpy(y + 3 * i, bushed->bodies[i].state, 3 * sizeof *y);
        memcpy(y + 3 * (count + i), bushed->bodies[i].state + 3, 3 * sizeof *y);
    }
    while (time_s < bushed->end_s) {
        const bool is_last = time_s + step >= bushed->end_s;
        const double width = is_last ? bushed->end_s - time_s : step;
        double apart;
        if (!extrapolate(bushed, y, width, next, &apart)) {
            return false;
        }
        if (apart > AGREED && width > STEP_LEAST) {
            step = 0.5 * width;
            continue;
        }
        memcpy(y, next, sizeof y);
        note_speeds(count, y, truth);
        time_s = is_last ? bushed->end_s : time_s + width;
        step = apart < 0.1 * AGREED ? fmin(STEP_MOST, 2.0 * step) : step;
    }
    for (size_t i = 0; i < count; i++) {
        memcpy(truth->states + 6 * i, y + 3 * i, 3 * sizeof *y);
        memcpy(truth->states + 6 * i + 3, y + 3 * (count + i), 3 * sizeof *y);
    }
    return true;
}

double bushed_apart(const Bushed *bushed, const double *states, const BushedTruth *truth)
{
    double apart = 0.0;
    for (size_t i = 0; i < 6 * bushed->body_count; i++) {
        const double scale = i % 6 < 3 ? 1.0 : i % 6 == 5 ? truth->turning : truth->fastest;
        apart = fmax(apart, fabs(states[i] - truth->states[i]) / scale);
    }
    return apart;
}
