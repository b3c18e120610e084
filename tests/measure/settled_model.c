// Writes the equations of motion of a random case out, each kind in its own coordinates.
//
// Contact        N = K d^n (1 + chi d'/v0), not below 0
// exact damping  chi (1 + e) = ln((1 + chi) / (1 - chi e))
// hertz-socket   K = 4/3 E* sqrt(R),  E* = E / (2 (1 - nu^2)),  R = Ri Rj / (Ri - Rj)
//
// Linkages: n(a) = (cos a, sin a), A = a n(omega t) the crank pin; psi the coupler's angle, b its
// length; a follower of length c at angle phi about (g, 0), or a slider at (x, offset).
// In each case the offset is e = (follower pin or slider) - b n(psi) - A.
//   coupler on the crank pin     I_A psi'' = m b/2 n x (g - A''), follower or slider alone
//   coupler on the other pin     with the follower a double pendulum, with the slider a cart
#include "settled_model.h"

#include <assert.h>
#include <math.h>
#include <string.h>

// the program's defaults: steel of pins and holes
static const double YOUNGS_MODULUS = 2.07e11; // Pa
static const double POISSON_RATIO = 0.29;

// halvings of an interval of chi, which is below 1 / e
enum { HALVINGS = 200 };

// sweeps of Gauss and Seidel, each of which leaves a quarter of the error
enum { SWEEPS = 80 };

// iterations of Newton's method from the position without play, and what it has to come to
enum { PLACE_ITERATIONS = 50 };
static const double PLACE_TOLERANCE = 1e-14; // m

static double mismatch(double chi, double e)
{
    return chi * (1.0 + e) - log((1.0 + chi) / (1.0 - chi * e));
}

// The mismatch is positive below the root, behind the trivial one at 0.
static double exact_factor(double e)
{
    if (e == 1.0) {
        return 0.0;
    }
    double low = 0.5 * (1.0 - e);
    double high = 1.0 / e;
    for (int i = 0; i < HALVINGS; i++) {
        const double middle = 0.5 * (low + high);
        if (mismatch(middle, e) > 0.0) {
            low = middle;
        } else {
            high = middle;
        }
    }
    return low;
}

static double hertz_stiffness(const SettledCase *sizes)
{
    const double modulus = YOUNGS_MODULUS / (2.0 * (1.0 - POISSON_RATIO * POISSON_RATIO));
    const double hole = 0.5 * sizes->hole;
    const double pin = 0.5 * sizes->pin;
    return 4.0 / 3.0 * modulus * sqrt(hole * pin / (hole - pin));
}

// Slopes of the periodic cubic spline: its second rate has no jump.
static void spline_slopes(const ModelWall *wall, const double *values, double *slopes)
{
    const size_t n = wall->pieces;
    for (size_t i = 0; i < n; i++) {
        slopes[i] = 0.0;
    }
    for (int sweep = 0; sweep < SWEEPS; sweep++) {
        for (size_t i = 0; i < n; i++) {
            const size_t before = (i + n - 1) % n;
            const size_t behind = (i + 1) % n;
            const double h0 = wall->at[before + 1] - wall->at[before];
            const double h1 = wall->at[i + 1] - wall->at[i];
            const double d0 = (values[i] - values[before]) / h0;
            const double d1 = (values[behind] - values[i]) / h1;
            slopes[i] = (3.0 * (d0 / h0 + d1 / h1) - slopes[before] / h0 - slopes[behind] / h1) /
                        (2.0 / h0 + 2.0 / h1);
        }
    }
}

// Slopes of Fritsch and Butland: harmonic means of the secants to both sides.
static void smooth_slopes(const ModelWall *wall, const double *values, double *slopes)
{
    const size_t n = wall->pieces;
    for (size_t i = 0; i < n; i++) {
        const size_t before = (i + n - 1) % n;
        const double h0 = wall->at[before + 1] - wall->at[before];
        const double h1 = wall->at[i + 1] - wall->at[i];
        const double d0 = (values[i] - values[before]) / h0;
        const double d1 = (values[(i + 1) % n] - values[i]) / h1;
        slopes[i] =
            d0 * d1 > 0.0 ? 3.0 * (h0 + h1) / ((2.0 * h1 + h0) / d0 + (h1 + 2.0 * h0) / d1) : 0.0;
    }
}

static void make_pieces(const SettledCase *sizes, bool is_drive, ModelWall *wall)
{
    const SettledTable *table = &sizes->table;
    double slopes[SETTLED_POINTS];
    wall->pieces = table->count;
    memcpy(wall->at, table->at, sizeof table->at);
    wall->at[table->count] = sizes->period;
    if (is_drive) {
        spline_slopes(wall, table->values, slopes);
    } else {
        smooth_slopes(wall, table->values, slopes);
    }
    for (size_t i = 0; i < wall->pieces; i++) {
        const size_t next = (i + 1) % wall->pieces;
        const double h = wall->at[i + 1] - wall->at[i];
        const double d = (table->values[next] - table->values[i]) / h;
        double *terms = wall->terms[i];
        terms[0] = table->values[i];
        terms[1] = d;
        if (is_drive || table->is_smooth) {
            terms[1] = slopes[i];
            terms[2] = (3.0 * d - 2.0 * slopes[i] - slopes[next]) / h;
            terms[3] = (slopes[i] + slopes[next] - 2.0 * d) / (h * h);
        }
    }
}

static void make_cam(const SettledCase *sizes, ModelWall *wall)
{
    wall->mass = sizes->mass;
    wall->spring = sizes->spring;
    // at the start u = -eccentricity and the spring is 0.26 m long
    wall->rest = 0.26 - sizes->spring_length - sizes->eccentricity;
    wall->amplitude = sizes->eccentricity;
    wall->omega = 2.0 * M_PI / sizes->period;
}

static void make_arm(const SettledCase *sizes, ModelWall *wall)
{
    wall->mass = sizes->inertia + sizes->mass * sizes->reach * sizes->reach;
    wall->weight = sizes->mass * sizes->gravity * sizes->reach;
    make_pieces(sizes, false, wall);
}

static void make_beam(const SettledCase *sizes, ModelWall *wall)
{
    wall->mass = sizes->mass;
    wall->spring = sizes->spring;
    wall->damping = sizes->damping;
    make_pieces(sizes, false, wall);
}

// u = -r_b phi_b, w = r_a phi_a: x is the coordinate of the teeth
static void make_gears(const SettledCase *sizes, ModelWall *wall)
{
    const double teeth = (double)(sizes->teeth[0] + sizes->teeth[1]);
    const double radius = sizes->distance * sizes->teeth[1] / teeth;
    wall->mass = sizes->inertia / (radius * radius);
    wall->damping = sizes->damping / (radius * radius);
    wall->push = -sizes->load / radius;
    wall->gain = sizes->distance * sizes->teeth[0] / teeth;
    make_pieces(sizes, true, wall);
}

static void make_pivot(const SettledCase *sizes, ModelWall *wall)
{
    wall->mass = sizes->inertia;
    wall->relative = sizes->damping;
    wall->push = sizes->load;
    wall->gain = 1.0;
    make_pieces(sizes, true, wall);
}

static void make_pin(const SettledCase *sizes, ModelPin *pin)
{
    *pin = (ModelPin){
        .crank = sizes->crank.length,
        .coupler = sizes->coupler.length,
        .last = sizes->last.length,
        .ground = sizes->ground,
        .offset = sizes->offset,
        .omega = 2.0 * M_PI / sizes->period,
        .mass = sizes->coupler.mass,
        .inertia = sizes->coupler.inertia,
        .last_mass = sizes->last.mass,
        .last_inertia = sizes->last.inertia,
        .gravity = sizes->gravity,
        .is_hung = sizes->kind == SETTLED_COUPLER_PIN || sizes->kind == SETTLED_CRANK_PIN,
    };
}

static void set_stops(Model *model)
{
    const ModelWall *wall = &model->wall;
    model->stops = 0;
    for (size_t i = 1; i < wall->pieces; i++) {
        model->stop_at[model->stops++] = wall->at[i];
    }
    model->stop_at[model->stops++] = model->period;
}

Model model_make(const SettledCase *sizes)
{
    static void (*const MAKERS[])(const SettledCase *, ModelWall *) = {
        [SETTLED_CAM] = make_cam,     [SETTLED_ARM] = make_arm,     [SETTLED_BEAM] = make_beam,
        [SETTLED_GEARS] = make_gears, [SETTLED_PIVOT] = make_pivot,
    };
    Model model = {
        .is_pin = sizes->kind >= SETTLED_COUPLER_PIN,
        .period = sizes->period,
        .stiffness = sizes->stiffness > 0.0 ? sizes->stiffness : hertz_stiffness(sizes),
        .hysteresis = exact_factor(sizes->restitution),
        .clearance = sizes->clearance,
        .reach = {1.0, 1.0},
    };
    model.exponent = model.is_pin ? 1.5 : 1.0;
    model.coordinates = model.is_pin ? 2 : 1;
    if (model.is_pin) {
        make_pin(sizes, &model.pin);
        model.reach[0] = model.pin.coupler;
        model.reach[1] = model.pin.last > 0.0 ? model.pin.last : 1.0;
    } else {
        model.wall.low = sizes->low;
        model.wall.high = sizes->high;
        MAKERS[sizes->kind](sizes, &model.wall);
    }
    set_stops(&model);
    return model;
}

int model_contacts(const Model *model)
{
    return model->is_pin ? 1 : 2;
}

void model_depth(const Model *model, int contact, const ModelOffset *offset, double depth[3])
{
    if (!model->is_pin) {
        const double sign = contact == 0 ? -1.0 : 1.0;
        const double end = contact == 0 ? model->wall.low : model->wall.high;
        depth[0] = sign * (offset->x[0] - end);
        depth[1] = sign * offset->v[0];
        depth[2] = sign * offset->a[0];
        return;
    }
    const double *x = offset->x;
    const double *v = offset->v;
    const double length = sqrt(x[0] * x[0] + x[1] * x[1]);
    depth[0] = length - model->clearance;
    if (length == 0.0) {
        depth[1] = hypot(v[0], v[1]);
        depth[2] = 0.0;
        return;
    }
    const double across = (x[0] * v[1] - x[1] * v[0]) / length;
    depth[1] = (x[0] * v[0] + x[1] * v[1]) / length;
    depth[2] = (x[0] * offset->a[0] + x[1] * offset->a[1] + across * across) / length;
}

double model_force(const Model *model, const ModelTouch *touch, double depth, double closing)
{
    const double size = fabs(depth);
    const double elastic = model->stiffness * depth * (model->exponent == 1.0 ? 1.0 : sqrt(size));
    const double force = elastic * (1.0 + touch->rate * closing);
    // outside the wall, where a step overshoots, the force goes on as it is within
    return depth > 0.0 && force < 0.0 ? 0.0 : force;
}

// A value with its first two rates.
typedef struct Value {
    double value, first, second;
} Value;

static Value table_at(const ModelWall *wall, double time)
{
    // pieces of a drive are of one length but for rounding
    size_t i = (size_t)(time / wall->at[wall->pieces] * (double)wall->pieces);
    i = i < wall->pieces ? i : wall->pieces - 1;
    while (i > 0 && time < wall->at[i]) {
        i--;
    }
    while (i + 1 < wall->pieces && time >= wall->at[i + 1]) {
        i++;
    }
    const double s = time - wall->at[i];
    const double *c = wall->terms[i];
    return (Value){
        c[0] + s * (c[1] + s * (c[2] + s * c[3])),
        c[1] + s * (2.0 * c[2] + 3.0 * s * c[3]),
        2.0 * c[2] + 6.0 * s * c[3],
    };
}

static Value wall_at(const ModelWall *wall, double time)
{
    if (wall->gain > 0.0) {
        const Value angle = table_at(wall, time);
        return (Value){wall->gain * angle.value, wall->gain * angle.first,
                       wall->gain * angle.second};
    }
    if (wall->amplitude > 0.0) {
        const double phase = wall->omega * time;
        const double cosine = wall->amplitude * cos(phase);
        return (Value){-cosine, wall->omega * wall->amplitude * sin(phase),
                       wall->omega * wall->omega * cosine};
    }
    return (Value){0.0, 0.0, 0.0};
}

static void wall_rates(const Model *model, double time, const double *y, const ModelTouch *touches,
                       double *rates, ModelOffset *offset)
{
    const ModelWall *wall = &model->wall;
    const Value w = wall_at(wall, time);
    const double u = y[0] + w.value;
    *offset = (ModelOffset){.x = {y[0], 0.0}, .v = {y[1], 0.0}};
    double force = wall->push - wall->spring * (u - wall->rest) - wall->damping * (y[1] + w.first) -
                   wall->relative * y[1];
    if (wall->gain == 0.0 && wall->pieces > 0) {
        force += table_at(wall, time).value;
    }
    if (wall->weight > 0.0) {
        force -= wall->weight * cos(u);
    }
    for (int i = 0; i < MODEL_CONTACTS; i++) {
        if (touches[i].is_touching) {
            double depth[3];
            model_depth(model, i, offset, depth);
            const double press = model_force(model, &touches[i], depth[0], depth[1]);
            force += i == 0 ? press : -press;
        }
    }
    rates[0] = y[1];
    rates[1] = force / wall->mass - w.second;
    offset->a[0] = rates[1];
}

// What the equations of a linkage consist of at one instant.
typedef struct Parts {
    double e[2];      // m
    double moved[2];  // m/s, e_t
    double bias[2];   // m/s^2, b
    double row[2][2]; // J: e[i] over q[k]
    double mass[3];   // M11, M12, M22
    double force[2];  // Q
} Parts;

typedef struct Turned {
    double cosine, sine;
} Turned;

// Masses and forces where the coupler stays with the crank pin, whose acceleration is given.
static void carried_parts(const ModelPin *pin, const double *y, const double pin_rate[2],
                          Turned psi, Turned phi, Parts *parts)
{
    (void)y;
    const double half = 0.5 * pin->coupler;
    parts->mass[0] = pin->inertia + pin->mass * half * half;
    parts->mass[1] = 0.0;
    parts->force[0] =
        pin->mass * half * (psi.cosine * (-pin->gravity - pin_rate[1]) + psi.sine * pin_rate[0]);
    if (pin->last > 0.0) {
        const double middle = 0.5 * pin->last;
        parts->mass[2] = pin->last_inertia + pin->last_mass * middle * middle;
        parts->force[1] = -pin->last_mass * pin->gravity * middle * phi.cosine;
    } else {
        parts->mass[2] = pin->last_mass;
        parts->force[1] = 0.0;
    }
}

// Where it stays with the follower or the slider.
static void hung_parts(const ModelPin *pin, const double *y, Turned psi, Turned phi, Parts *parts)
{
    const double half = 0.5 * pin->coupler;
    const double moment = pin->mass * half;
    parts->mass[0] = pin->inertia + moment * half;
    parts->force[0] = moment * pin->gravity * psi.cosine;
    if (pin->last == 0.0) {
        parts->mass[1] = moment * psi.sine;
        parts->mass[2] = pin->mass + pin->last_mass;
        parts->force[1] = -moment * psi.cosine * y[2] * y[2];
        return;
    }
    const double middle = 0.5 * pin->last;
    const double coupling = -moment * pin->last;
    const double cosine = phi.cosine * psi.cosine + phi.sine * psi.sine;
    const double sine = phi.sine * psi.cosine - phi.cosine * psi.sine;
    parts->mass[1] = coupling * cosine;
    parts->mass[2] =
        pin->last_inertia + pin->last_mass * middle * middle + pin->mass * pin->last * pin->last;
    parts->force[0] += coupling * sine * y[3] * y[3];
    parts->force[1] = -coupling * sine * y[2] * y[2] -
                      (pin->mass * pin->last + pin->last_mass * middle) * pin->gravity * phi.cosine;
}

static Turned turned(double angle)
{
    return (Turned){cos(angle), sin(angle)};
}

static void pin_parts(const ModelPin *pin, double time, const double *y, Parts *parts)
{
    const Turned crank = turned(pin->omega * time);
    const Turned psi = turned(y[0]);
    const Turned phi = pin->last > 0.0 ? turned(y[1]) : (Turned){0.0, 0.0};
    const double square = pin->omega * pin->omega;
    const double b = pin->coupler;
    const double c = pin->last;
    const double base[2] = {pin->crank * crank.cosine, pin->crank * crank.sine};
    const double rate[2] = {-square * base[0], -square * base[1]};
    const double end[2] = {c > 0.0 ? pin->ground + c * phi.cosine : y[1],
                           c > 0.0 ? c * phi.sine : pin->offset};
    parts->e[0] = end[0] - b * psi.cosine - base[0];
    parts->e[1] = end[1] - b * psi.sine - base[1];
    parts->moved[0] = pin->omega * base[1];
    parts->moved[1] = -pin->omega * base[0];
    parts->row[0][0] = b * psi.sine;
    parts->row[1][0] = -b * psi.cosine;
    parts->row[0][1] = c > 0.0 ? -c * phi.sine : 1.0;
    parts->row[1][1] = c * phi.cosine;
    const double turn = b * y[2] * y[2];
    const double swing = c * y[3] * y[3];
    parts->bias[0] = turn * psi.cosine - swing * phi.cosine - rate[0];
    parts->bias[1] = turn * psi.sine - swing * phi.sine - rate[1];
    if (pin->is_hung) {
        hung_parts(pin, y, psi, phi, parts);
    } else {
        carried_parts(pin, y, rate, psi, phi, parts);
    }
}

static void pin_rates(const Model *model, double time, const double *y, const ModelTouch *touches,
                      double *rates, ModelOffset *offset)
{
    Parts parts;
    pin_parts(&model->pin, time, y, &parts);
    for (int i = 0; i < 2; i++) {
        offset->x[i] = parts.e[i];
        offset->v[i] = parts.moved[i] + parts.row[i][0] * y[2] + parts.row[i][1] * y[3];
        offset->a[i] = 0.0;
    }
    if (touches[0].is_touching) {
        double depth[3];
        model_depth(model, 0, offset, depth);
        const double press = model_force(model, &touches[0], depth[0], depth[1]);
        const double share = -press / (depth[0] + model->clearance);
        for (int k = 0; k < 2; k++) {
            parts.force[k] += share * (parts.row[0][k] * parts.e[0] + parts.row[1][k] * parts.e[1]);
        }
    }
    const double *m = parts.mass;
    const double whole = m[0] * m[2] - m[1] * m[1];
    rates[0] = y[2];
    rates[1] = y[3];
    rates[2] = (m[2] * parts.force[0] - m[1] * parts.force[1]) / whole;
    rates[3] = (m[0] * parts.force[1] - m[1] * parts.force[0]) / whole;
    for (int i = 0; i < 2; i++) {
        offset->a[i] = parts.bias[i] + parts.row[i][0] * rates[2] + parts.row[i][1] * rates[3];
    }
}

void model_rates(const Model *model, double time, const double *y, const ModelTouch *touches,
                 double *rates, ModelOffset *offset)
{
    if (model->is_pin) {
        pin_rates(model, time, y, touches, rates, offset);
    } else {
        wall_rates(model, time, y, touches, rates, offset);
    }
}

// Solves J z = right.
static void solve_row(const Parts *parts, const double right[2], double z[2])
{
    const double(*j)[2] = parts->row;
    const double whole = j[0][0] * j[1][1] - j[0][1] * j[1][0];
    z[0] = (j[1][1] * right[0] - j[0][1] * right[1]) / whole;
    z[1] = (j[0][0] * right[1] - j[1][0] * right[0]) / whole;
}

// The position without play at the start of a period: of a four-bar the open one, the follower pin
// to the left of the line from crank pin to follower pivot.
static void ideal_place(const ModelPin *pin, double *y)
{
    const double a = pin->crank;
    const double b = pin->coupler;
    if (pin->last == 0.0) {
        y[0] = asin(pin->offset / b);
        y[1] = a + b * cos(y[0]);
        return;
    }
    const double d = pin->ground - a;
    y[0] = acos((b * b + d * d - pin->last * pin->last) / (2.0 * b * d));
    y[1] = atan2(b * sin(y[0]), b * cos(y[0]) - d);
}

static bool pin_place(const Model *model, const double x[2], const double v[2], double *y)
{
    Parts parts;
    ideal_place(&model->pin, y);
    y[2] = y[3] = 0.0;
    bool is_placed = false;
    for (int i = 0; i < PLACE_ITERATIONS && !is_placed; i++) {
        pin_parts(&model->pin, 0.0, y, &parts);
        const double left[2] = {x[0] - parts.e[0], x[1] - parts.e[1]};
        double z[2];
        solve_row(&parts, left, z);
        y[0] += z[0];
        y[1] += z[1];
        is_placed = hypot(left[0], left[1]) < PLACE_TOLERANCE;
    }
    pin_parts(&model->pin, 0.0, y, &parts);
    const double wanted[2] = {v[0] - parts.moved[0], v[1] - parts.moved[1]};
    solve_row(&parts, wanted, y + 2);
    return is_placed;
}

bool model_place(const Model *model, const double x[2], const double v[2], double *y)
{
    if (model->is_pin) {
        return pin_place(model, x, v, y);
    }
    y[0] = x[0];
    y[1] = v[0];
    return true;
}

void model_written(const Model *model, const SettledCase *sizes, double *y)
{
    static const double NONE[2] = {0.0, 0.0};
    if (model->is_pin) {
        model_place(model, NONE, NONE, y);
    } else {
        // at rest: a follower on its cam, an arm at its angle, a beam at its spring's length, gears
        // in the middle of their gap
        y[0] = sizes->start;
        y[1] = -wall_at(&model->wall, 0.0).first;
    }
}
