// Finds the angle and the speed of a driven body.
//
//     speeds    omega = w_i + alpha_i (t - t_i),  angle = start + the integral of omega
//     angles    angle = start + a_i + sum of a_k tau^k - lift sin(2 pi tau) / (2 pi)
//     a wave    omega = w + A sin(r t + p),  or  angle = start + a + A sin(r t + p)
// with tau = (t - t_i) / T between two points, T and the lift from one to the other; the last term
// is that of a cycloid. Source of the laws of motion: Norton, Cam Design and Manufacturing
// Handbook, 2009, chapter 2 (cycloid, 3-4-5 polynomial, trapezoid of the speed).
#include "base/drive.h"

#include "base/dense.h"

#include <math.h>
#include <string.h>

static const long double TURN = 6.28318530717958647692528676655900577L;

static bool is_constant(const Driver *driver)
{
    return driver->table.count == 0;
}

static bool has_angles(const Driver *driver)
{
    return !is_constant(driver) && driver->has_angles;
}

// The way from one point of angles to the next, or a phase of it.
typedef struct Move {
    double time_s;
    double width_s;                // 0: it stands
    double terms[DRIVE_TERMS + 1]; // rad, a_0 to a_5 of tau
    double wave;                   // rad, of a cycloid
} Move;

// When the second and the third phase of a trapezoid begin.
static double phase_start(const TimePiece *piece, int phase)
{
    return piece->time_s + phase * piece->width_s / 3.0;
}

static void set_trapezoid(const TimePiece *piece, double time_s, double lift, Move *move)
{
    static const double PHASES[3][3] = {{0.0, 0.0, 2.25}, {-0.25, 1.5, 0.0}, {-1.25, 4.5, -2.25}};
    const int phase = time_s >= phase_start(piece, 2) ? 2 : time_s >= phase_start(piece, 1) ? 1 : 0;
    for (int k = 0; k < 3; k++) {
        move->terms[k] += lift * PHASES[phase][k];
    }
}

static void set_spline(const Driver *driver, const TimePiece *piece, double lift, Move *move)
{
    const double before = piece->width_s * driver->slopes[piece->from];
    const double behind = piece->width_s * driver->slopes[piece->to];
    move->terms[1] = before;
    move->terms[2] = 3.0 * lift - 2.0 * before - behind;
    move->terms[3] = before + behind - 2.0 * lift;
}

// The lift of a piece of angles, rad.
static double lift_of(const Driver *driver, const TimePiece *piece)
{
    const double *angles = driver->table.values;
    return angles[piece->to] + (piece->to > piece->from ? 0.0 : driver->gain) - angles[piece->from];
}

// The way that holds from a time on.
static Move find_move(const Driver *driver, double from_s)
{
    const TimePiece piece = time_table_piece(&driver->table, from_s);
    Move move = {.time_s = piece.time_s, .width_s = piece.width_s};
    move.terms[0] = piece.value + (double)piece.period * driver->gain;
    if (piece.width_s == 0.0) {
        return move;
    }
    const double lift = lift_of(driver, &piece);
    switch (driver->profile) {
    case DRIVE_CYCLOID:
        move.terms[1] = move.wave = lift;
        break;
    case DRIVE_POLYNOMIAL:
        move.terms[3] = 10.0 * lift;
        move.terms[4] = -15.0 * lift;
        move.terms[5] = 6.0 * lift;
        break;
    case DRIVE_TRAPEZOID:
        set_trapezoid(&piece, from_s, lift, &move);
        break;
    case DRIVE_SPLINE:
        set_spline(driver, &piece, lift, &move);
        break;
    }
    return move;
}

static long double angle_by_moves(const Driver *driver, long double time_s)
{
    const Move move = find_move(driver, (double)time_s);
    const Wave *wave = &driver->table.wave;
    if (wave_exists(wave)) {
        return move.terms[0] + wave->amplitude * sinl(wave->rate * time_s + wave->phase);
    }
    if (move.width_s == 0.0) {
        return move.terms[0];
    }
    const long double tau = (time_s - move.time_s) / move.width_s;
    long double angle = 0.0L;
    for (int k = DRIVE_TERMS; k >= 0; k--) {
        angle = angle * tau + move.terms[k];
    }
    return move.wave == 0.0 ? angle : angle - move.wave * sinl(TURN * tau) / (TURN);
}

double drive_angle(const Driver *driver, double time_s)
{
    return is_constant(driver) ? driver->start + driver->speed * time_s
                               : (double)drive_angle_exact(driver, time_s);
}

long double drive_angle_exact(const Driver *driver, long double time_s)
{
    const long double turned = is_constant(driver)  ? driver->speed * time_s
                               : has_angles(driver) ? angle_by_moves(driver, time_s)
                                                    : time_table_integral(&driver->table, time_s);
    return driver->start + turned;
}

// The polynomial of a way, by powers of the time since an instant at tau. Its coefficients about
// tau are small differences of large ones near the end of a way: they are found in long double.
static DrivePiece piece_of_move(const Move *move, long double tau)
{
    DrivePiece piece = {.wave = move->wave, .phase = (double)tau, .width_s = move->width_s};
    long double terms[DRIVE_TERMS + 1];
    for (int k = 0; k <= DRIVE_TERMS; k++) {
        terms[k] = move->terms[k];
    }
    long double scale = 1.0L;
    for (int k = 0; k <= DRIVE_TERMS; k++) {
        // what is left by Horner's division by (x - tau) is the next coefficient about tau
        for (int i = DRIVE_TERMS - 1; i >= k; i--) {
            terms[i] += tau * terms[i + 1];
        }
        if (k > 0) {
            scale /= move->width_s;
            piece.terms[k - 1] = (double)(scale * terms[k]);
        }
    }
    piece.is_uniform = move->wave == 0.0 && piece.terms[2] == 0.0 && piece.terms[3] == 0.0 &&
                       piece.terms[4] == 0.0;
    return piece;
}

DrivePiece drive_piece(const Driver *driver, double from_s)
{
    if (is_constant(driver)) {
        return (DrivePiece){.is_uniform = true, .terms = {driver->speed}};
    }
    const Wave *wave = &driver->table.wave;
    if (wave_exists(wave)) {
        DrivePiece piece = {.swing = wave_from(wave, from_s)};
        if (!has_angles(driver)) {
            piece.swing = wave_integral(&piece.swing);
            piece.terms[0] = driver->table.values[0];
        }
        return piece;
    }
    if (has_angles(driver)) {
        const Move move = find_move(driver, from_s);
        return move.width_s == 0.0
                   ? (DrivePiece){.is_uniform = true}
                   : piece_of_move(&move, ((long double)from_s - move.time_s) / move.width_s);
    }
    return (DrivePiece){.is_uniform = true,
                        .terms = {time_table_at(&driver->table, from_s),
                                  0.5 * time_table_piece(&driver->table, from_s).slope}};
}

DriveState drive_piece_at(const DrivePiece *piece, double since_s)
{
    const double *c = piece->terms;
    if (piece->is_uniform) {
        return (DriveState){since_s * (c[0] + c[1] * since_s), c[0] + 2.0 * c[1] * since_s,
                            2.0 * c[1]};
    }
    const double s = since_s;
    DriveState state = {
        .angle = s * (c[0] + s * (c[1] + s * (c[2] + s * (c[3] + s * c[4])))),
        .omega = c[0] + s * (2.0 * c[1] + s * (3.0 * c[2] + s * (4.0 * c[3] + s * 5.0 * c[4]))),
        .alpha = 2.0 * c[1] + s * (6.0 * c[2] + s * (12.0 * c[3] + s * 20.0 * c[4])),
    };
    if (piece->wave != 0.0) {
        const double rate = 2.0 * M_PI / piece->width_s;
        const double before = 2.0 * M_PI * piece->phase;
        const double half = 0.5 * rate * s;
        state.angle -= piece->wave / M_PI * cos(before + half) * sin(half);
        state.omega -= piece->wave / piece->width_s * cos(before + 2.0 * half);
        state.alpha += piece->wave / piece->width_s * rate * sin(before + 2.0 * half);
    }
    if (wave_exists(&piece->swing)) {
        const Wave *swing = &piece->swing;
        const double lift = swing->amplitude * swing->rate;
        const double at = swing->rate * s + swing->phase;
        state.angle += wave_growth(swing, 0.0, s);
        state.omega += lift * cos(at);
        state.alpha -= lift * swing->rate * sin(at);
    }
    return state;
}

DriveState drive_at(const Driver *driver, double time_s)
{
    return drive_since(driver, time_s, time_s);
}

DriveState drive_since(const Driver *driver, double from_s, double time_s)
{
    if (is_constant(driver)) {
        return (DriveState){(time_s - from_s) * driver->speed + drive_angle(driver, from_s),
                            driver->speed, 0.0};
    }
    const DrivePiece piece = drive_piece(driver, from_s);
    DriveState state = drive_piece_at(&piece, time_s - from_s);
    state.angle += drive_angle(driver, from_s);
    return state;
}

double drive_next_kink(const Driver *driver, double time_s)
{
    if (has_angles(driver) && driver->profile == DRIVE_TRAPEZOID) {
        const TimePiece piece = time_table_piece(&driver->table, time_s);
        for (int phase = 1; piece.width_s > 0.0 && phase < 3; phase++) {
            if (phase_start(&piece, phase) > time_s) {
                return phase_start(&piece, phase);
            }
        }
    }
    return time_table_next_bend(&driver->table, time_s);
}

static void extend(DriveExtent *extent, const Driver *driver, double time_s)
{
    const double turned = drive_angle(driver, time_s) - driver->start;
    extent->back = fmin(extent->back, turned);
    extent->forth = fmax(extent->forth, turned);
}

// When the speed c_1 + 2 c_2 s + 3 c_3 s^2 of a piece passes through zero, s after its instant; not
// positive or NAN where it does not. Cycloids and polynomials of the fifth degree do not turn back.
static void find_rests(const DrivePiece *piece, double rests_s[2])
{
    const double *c = piece->terms;
    rests_s[0] = rests_s[1] = piece->is_uniform && c[1] != 0.0 ? -0.5 * c[0] / c[1] : NAN;
    if (!piece->is_uniform && piece->wave == 0.0 && c[4] == 0.0) {
        const double root = sqrt(c[1] * c[1] - 3.0 * c[2] * c[0]);
        const double sum = -(c[1] + copysign(root, c[1]));
        rests_s[0] = sum / (3.0 * c[2]);
        rests_s[1] = c[0] / sum;
    }
}

// A wave turns back where its speed v + A r cos(r t + p) passes through zero. It does so in every
// period, each like the first but for the way of the mean speed, so that only the first and the
// last can have the furthest.
static void extend_by_wave(DriveExtent *extent, const Driver *driver, double to_s)
{
    const DrivePiece piece = drive_piece(driver, 0.0);
    const Wave *swing = &piece.swing;
    const double share = -piece.terms[0] / (swing->amplitude * swing->rate);
    const double period_s = wave_period(swing);
    extend(extent, driver, to_s);
    for (int side = 0; fabs(share) <= 1.0 && side < 2; side++) {
        const double phase = side == 0 ? acos(share) : -acos(share);
        const double turned = fmod(phase - swing->phase, 2.0 * M_PI);
        const double first_s = (turned < 0.0 ? turned + 2.0 * M_PI : turned) / swing->rate;
        const double last_s = first_s + floor((to_s - first_s) / period_s) * period_s;
        if (first_s <= to_s) {
            extend(extent, driver, first_s);
            extend(extent, driver, last_s);
        }
    }
}

DriveExtent drive_extent(const Driver *driver, double to_s)
{
    DriveExtent extent = {0.0, 0.0};
    if (!is_constant(driver) && wave_exists(&driver->table.wave)) {
        extend_by_wave(&extent, driver, to_s);
        return extent;
    }
    for (double start_s = 0.0; start_s < to_s;) {
        const double end_s = fmin(to_s, drive_next_kink(driver, start_s));
        const DrivePiece piece = drive_piece(driver, start_s);
        double rests_s[2];
        find_rests(&piece, rests_s);
        for (int i = 0; i < 2; i++) {
            if (rests_s[i] > 0.0 && start_s + rests_s[i] < end_s) {
                extend(&extent, driver, start_s + rests_s[i]);
            }
        }
        extend(&extent, driver, end_s);
        start_s = end_s;
    }
    return extent;
}

bool drive_is_steady(const Driver *driver)
{
    return driver->is_present && is_constant(driver) && !driver->is_one_of_several;
}

bool drive_is_smooth(const Driver *driver)
{
    return is_constant(driver) || drive_is_held(driver) || wave_exists(&driver->table.wave);
}

bool drive_is_held(const Driver *driver)
{
    return has_angles(driver) && !time_table_changes(&driver->table);
}

// Periods of a wave in which its mean speed may make whole turns; beyond that some number of them
// is near any ratio.
enum { DRIVE_PERIODS_MOST = 64 };

// 1: of a turn, what the digits of a speed and a frequency may leave
static const double DRIVE_TURN_ROUNDING = 1e-9;

double drive_period(const Driver *driver)
{
    const TimeTable *table = &driver->table;
    const double wave_s = wave_period(&table->wave);
    if (is_constant(driver) || !wave_exists(&table->wave)) {
        return is_constant(driver) ? 0.0 : table->period_s;
    }
    const double turns = has_angles(driver) ? 0.0 : table->values[0] * wave_s / (2.0 * M_PI);
    for (int count = 1; count <= DRIVE_PERIODS_MOST; count++) {
        const double all = count * turns;
        if (fabs(all - round(all)) <= DRIVE_TURN_ROUNDING * fmax(1.0, fabs(all))) {
            return count * wave_s;
        }
    }
    return 0.0;
}

double drive_turned_in_period(const Driver *driver)
{
    if (!is_constant(driver) && wave_exists(&driver->table.wave)) {
        return has_angles(driver) ? 0.0 : driver->table.values[0] * drive_period(driver);
    }
    return has_angles(driver) ? driver->gain
                              : (double)time_table_integral(&driver->table, driver->table.period_s);
}

// The slopes of the spline whose second rate has no jump:
//     m_i-1 / T_i-1 + 2 m_i (1 / T_i-1 + 1 / T_i) + m_i+1 / T_i = 3 (lift_i-1 / T_i-1^2 + lift_i /
//     T_i^2)
static void find_slopes(Driver *driver)
{
    const size_t n = driver->table.count;
    const bool repeats = driver->table.period_s > 0.0;
    double matrix[TIME_TABLE_MAX * TIME_TABLE_MAX] = {0.0};
    double right[TIME_TABLE_MAX] = {0.0};
    for (size_t i = 0; i < n; i++) {
        if (!repeats && (i == 0 || i + 1 == n)) {
            matrix[i * n + i] = 1.0;
            continue;
        }
        const size_t ends[2] = {(i + n - 1) % n, i};
        for (int side = 0; side < 2; side++) {
            const TimePiece piece = time_table_between(&driver->table, ends[side]);
            const size_t other = side == 0 ? piece.from : piece.to;
            matrix[i * n + i] += 2.0 / piece.width_s;
            matrix[i * n + other] += 1.0 / piece.width_s;
            right[i] += 3.0 * lift_of(driver, &piece) / (piece.width_s * piece.width_s);
        }
    }
    if (dense_solve(n, matrix, right)) {
        memcpy(driver->slopes, right, n * sizeof *right);
    }
}

// The largest speed between two points of angles, by its size: that of a spline stands at a point
// or where its slope does not change, all others halfway.
static double largest_between(const Driver *driver, size_t from)
{
    const TimePiece way = time_table_between(&driver->table, from);
    const DrivePiece piece = drive_piece(driver, way.time_s);
    const double *c = piece.terms;
    const double top_s =
        driver->profile == DRIVE_SPLINE && c[2] != 0.0 ? -c[1] / (3.0 * c[2]) : 0.5 * way.width_s;
    double largest = c[0];
    if (driver->profile == DRIVE_TRAPEZOID) {
        return 1.5 * lift_of(driver, &way) / way.width_s;
    }
    if (top_s > 0.0 && top_s < way.width_s) {
        const double top = drive_piece_at(&piece, top_s).omega;
        largest = fabs(top) > fabs(largest) ? top : largest;
    }
    return largest;
}

void drive_complete(Driver *driver)
{
    if (!has_angles(driver)) {
        driver->speed = is_constant(driver) ? driver->speed : time_table_largest(&driver->table);
        return;
    }
    if (wave_exists(&driver->table.wave)) {
        driver->speed = driver->table.wave.amplitude * driver->table.wave.rate;
        return;
    }
    find_slopes(driver);
    driver->speed = 0.0;
    const size_t ways = driver->table.count - (driver->table.period_s > 0.0 ? 0 : 1);
    for (size_t i = 0; i < ways; i++) {
        const double between = largest_between(driver, i);
        driver->speed = fabs(between) > fabs(driver->speed) ? between : driver->speed;
    }
}
