// Computes where the rows of a kernel are and how fast they go, and the poses of its contacts.
//
// Rows whose mobility and free acceleration change in the step move by the impulses P, their
// integrals Q, and theirs, R (kernel/run.c), W' = S + S^T:
//     u'' = g + g' (t - h/2) + 2 S P + (W + (t - h/2) W') f
//     u'  = u0' + g t + g' t (t - h) / 2 + (W + (t - h/2) W') P + (S - S^T) Q
//     u   = u0 + u0' t + g t^2 / 2 + g' t^2 (t/6 - h/4) + (W + (t - h/2) W') Q - 2 S^T R
// where S, g' and with them W' are zero if these are taken as constant.
#include "kernel/internal.h"

#include "base/zeroed.h"

#include <assert.h>
#include <math.h>

void kernel_make_drift(Kernel *kernel)
{
    const size_t rows = kernel->row_count;
    assert(kernel->pitch == rows);
    kernel->drift = zeroed(rows * rows, sizeof *kernel->drift);
    kernel->mobility_rate = zeroed(rows * rows, sizeof *kernel->mobility_rate);
    kernel->free_rate = zeroed(rows, sizeof *kernel->free_rate);
}

// The share of the mobility of one contact's first two rows that it changes by in half the step.
static double share_changed(const Kernel *kernel, const KernelContact *contact, const double *drift)
{
    const size_t rows = kernel->row_count;
    double size = 0.0;
    double change = 0.0;
    for (size_t i = contact->first_row; i < contact->first_row + 2; i++) {
        for (size_t k = contact->first_row; k < contact->first_row + 2; k++) {
            size = fmax(size, fabs(*kernel_mobility(kernel, i, k)));
            change = fmax(change, fabs(drift[i * rows + k] + drift[k * rows + i]));
        }
    }
    return size > 0.0 ? kernel->middle_s * change / size : 0.0;
}

// How much of a drift is let in: all of it in steps that are of use. With W linear in time the
// square of its change is missing, by which it stays positive: without, a contact of frequency w
// that changes by a share r in half the step grows by up to exp(w h r).
static double drift_share(const Kernel *kernel, const double *drift)
{
    double most = 1.0;
    for (size_t i = 0; i < kernel->contact_count; i++) {
        const KernelContact *contact = &kernel->contacts[i];
        const double changed = share_changed(kernel, contact, drift);
        const double growth = 2.0 * kernel->middle_s * contact->frequency * changed;
        most = fmax(most, fmax(2.0 * changed, growth));
    }
    return 1.0 / most;
}

void kernel_set_drift(Kernel *kernel, const double *drift, double duration)
{
    const size_t rows = kernel->row_count;
    kernel->middle_s = 0.5 * duration;
    const double share = drift_share(kernel, drift);
    for (size_t i = 0; i < rows; i++) {
        for (size_t k = 0; k < rows; k++) {
            kernel->drift[i * rows + k] = share * drift[i * rows + k];
            kernel->mobility_rate[i * rows + k] =
                share * (drift[i * rows + k] + drift[k * rows + i]);
        }
    }
}

static void add_drift_to_all(const Kernel *kernel, size_t row, double time_s, const double *impulse,
                             const double *moment, double *positions, double *speeds)
{
    const size_t rows = kernel->row_count;
    const double *drift = kernel->drift + row * rows;
    const double *rate = kernel->mobility_rate + row * rows;
    const double since_s = time_s - kernel->middle_s;
    const double pushed = since_s * impulse[row] + moment[row];
    const double moved = since_s * moment[row];
    for (size_t i = 0; i < rows; i++) {
        speeds[i] += pushed * rate[i] - 2.0 * moment[row] * drift[i];
        positions[i] += moved * rate[i] - 2.0 * moment[rows + row] * drift[i];
    }
}

static void add_free_bend(const Kernel *kernel, double time_s, double *positions, double *speeds)
{
    for (size_t i = 0; i < kernel->row_count; i++) {
        const double bend = 0.5 * time_s * kernel->free_rate[i];
        speeds[i] += bend * (time_s - 2.0 * kernel->middle_s);
        positions[i] += bend * time_s * (time_s / 3.0 - kernel->middle_s);
    }
}

// Adds to a row's speed and position, from the impulses so far and the moments, of a kernel of so
// many rows. Inline: for every pose.
static inline void add_drift(const Kernel *kernel, size_t rows, size_t row, double time_s,
                             const double *impulse, const double *moment, double *speed,
                             double *moved)
{
    const double *drift = kernel->drift + row * rows;
    const double *rate = kernel->mobility_rate + row * rows;
    const double *second = moment + rows;
    const double since_s = time_s - kernel->middle_s;
    const double bend = 0.5 * time_s * kernel->free_rate[row];
    *speed += bend * (time_s - 2.0 * kernel->middle_s);
    *moved += bend * time_s * (time_s / 3.0 - kernel->middle_s);
    for (size_t k = 0; k < rows; k++) {
        const double other = rate[k] - drift[k]; // of the transpose
        *speed += since_s * rate[k] * impulse[k] + (drift[k] - other) * moment[k];
        *moved += since_s * rate[k] * moment[k] - 2.0 * other * second[k];
    }
}

// What a row's acceleration has more, under forces, after impulses, likewise.
static inline double drift_acceleration(const Kernel *kernel, size_t rows, size_t row,
                                        double time_s, const double *impulse, const double *force)
{
    const double since_s = time_s - kernel->middle_s;
    double sum = since_s * kernel->free_rate[row];
    for (size_t k = 0; k < rows; k++) {
        sum += since_s * kernel->mobility_rate[row * rows + k] * force[k] +
               2.0 * kernel->drift[row * rows + k] * impulse[k];
    }
    return sum;
}

// Where a row is and how fast it goes, from the impulses in a span of so many rows.
static inline double row_motion_by(const Kernel *kernel, KernelSpan span, size_t rows, size_t row,
                                   double time_s, const double *impulse, const double *moment,
                                   double *position)
{
    const double *mobility = kernel_mobility(kernel, row, 0);
    double speed = kernel_free_speed(kernel, row, time_s);
    double moved = kernel_free_position(kernel, row, time_s);
    for (size_t k = span.first; k < span.end; k++) {
        moved += mobility[k] * moment[k];
        speed += mobility[k] * impulse[k];
    }
    if (kernel->drift != NULL) {
        add_drift(kernel, rows, row, time_s, impulse, moment, &speed, &moved);
    }
    *position = moved;
    return speed;
}

// Where a row is and how fast it goes, from the impulses so far. One pin without friction is what
// most linkages have; its loops are unrolled.
static inline double row_motion(const Kernel *kernel, size_t row, double time_s,
                                const double *impulse, const double *moment, double *position)
{
    const size_t rows = kernel->row_count;
    if (rows == KERNEL_ROWS_PLAIN) {
        return row_motion_by(kernel, (KernelSpan){0, KERNEL_ROWS_PLAIN}, KERNEL_ROWS_PLAIN, row,
                             time_s, impulse, moment, position);
    }
    return row_motion_by(kernel, kernel_span(kernel, row), rows, row, time_s, impulse, moment,
                         position);
}

double kernel_motion_speed(const Kernel *kernel, size_t row, double time_s, const double *impulse,
                           const double *moment)
{
    double position;
    return row_motion(kernel, row, time_s, impulse, moment, &position);
}

Vec2 kernel_motion_position(const Kernel *kernel, size_t contact, const KernelPoint *point)
{
    const size_t row = kernel->contacts[contact].first_row;
    double position[2];
    for (size_t i = 0; i < 2; i++) {
        row_motion(kernel, row + i, point->time_s, point->impulse, point->moment, &position[i]);
    }
    return (Vec2){position[0], position[1]};
}

// The acceleration of a row under the forces in a span of so many rows.
static inline double row_acceleration_by(const Kernel *kernel, KernelSpan span, size_t rows,
                                         size_t row, double time_s, const double *impulse,
                                         const double *force)
{
    const double *mobility = kernel_mobility(kernel, row, 0);
    double acceleration = kernel_free_rate(kernel, row, time_s);
    for (size_t k = span.first; k < span.end; k++) {
        acceleration += mobility[k] * force[k];
    }
    if (kernel->drift != NULL) {
        acceleration += drift_acceleration(kernel, rows, row, time_s, impulse, force);
    }
    return acceleration;
}

double kernel_motion_acceleration(const Kernel *kernel, size_t row, double time_s,
                                  const double *impulse, const double *force)
{
    const size_t rows = kernel->row_count;
    return rows == KERNEL_ROWS_PLAIN
               ? row_acceleration_by(kernel, (KernelSpan){0, KERNEL_ROWS_PLAIN}, KERNEL_ROWS_PLAIN,
                                     row, time_s, impulse, force)
               : row_acceleration_by(kernel, kernel_span(kernel, row), rows, row, time_s, impulse,
                                     force);
}

// What goes on along the line changes nothing.
static PinHole line_pose(double gap, double rate)
{
    return (PinHole){
        .eccentricity = {gap, 0.0},
        .eccentricity_size = INFINITY,
        .gap = gap,
        .penetration = -gap,
        .has_normal = true,
        .normal = {1.0, 0.0},
        .approach_speed = -rate,
    };
}

static PinHole disc_pose(Vec2 position, Vec2 speed, double clearance)
{
    PinHole pose = pin_hole_pose((Vec2){0.0, 0.0}, position, speed, -clearance);
    pose.gap = -pose.gap;
    pose.penetration = -pose.gap;
    pose.eccentricity_size = -pose.eccentricity_size;
    if (pose.has_normal) {
        pose.normal = vec2_scale(-1.0, pose.normal);
        pose.approach_speed = -pose.approach_speed;
    }
    return pose;
}

static PinHole slot_pose(const KernelContact *contact, Vec2 at, Vec2 rate)
{
    const double clearance = contact->radial_clearance;
    const double half = contact->half_length;
    switch (contact->part) {
    case KERNEL_PART_WALLS:
        return pin_walls_pose(at, rate, clearance);
    case KERNEL_PART_LOW:
        return pin_hole_pose((Vec2){0.0, -half}, at, rate, clearance);
    case KERNEL_PART_HIGH:
        return pin_hole_pose((Vec2){0.0, half}, at, rate, clearance);
    case KERNEL_PART_NEAREST:
        break;
    }
    return pin_slot_pose(at, rate, half, clearance);
}

// Of all shapes but the one that has to be fast.
static PinHole other_pose(const KernelContact *contact, const double position[2],
                          const double speed[2])
{
    const Vec2 at = {position[0], position[1]};
    const Vec2 rate = {speed[0], speed[1]};
    switch (contact->shape) {
    case KERNEL_LINE:
        return line_pose(position[0], speed[0]);
    case KERNEL_SLOT:
        return slot_pose(contact, at, rate);
    case KERNEL_HOLE:
    case KERNEL_DISC:
        break;
    }
    return disc_pose(at, rate, contact->radial_clearance);
}

PinHole kernel_motion_pose_of(const Kernel *kernel, size_t contact, const double position[2],
                              const double speed[2])
{
    const KernelContact *of = &kernel->contacts[contact];
    return of->shape == KERNEL_HOLE
               ? pin_hole_pose((Vec2){0.0, 0.0}, (Vec2){position[0], position[1]},
                               (Vec2){speed[0], speed[1]}, of->radial_clearance)
               : other_pose(of, position, speed);
}

// The pose of a contact, and how fast its first two rows go.
static PinHole find_pose(const Kernel *kernel, size_t contact, double time_s, const double *impulse,
                         const double *moment, double speed[2])
{
    const size_t row = kernel->contacts[contact].first_row;
    double position[2];
    speed[0] = row_motion(kernel, row, time_s, impulse, moment, &position[0]);
    speed[1] = row_motion(kernel, row + 1, time_s, impulse, moment, &position[1]);
    return kernel_motion_pose_of(kernel, contact, position, speed);
}

PinHole kernel_motion_pose(const Kernel *kernel, size_t contact, double time_s,
                           const double *impulse, const double *moment)
{
    double speed[2];
    if (kernel->contacts[contact].shape == KERNEL_LINE) {
        double gap;
        const size_t row = kernel->contacts[contact].first_row;
        speed[0] = row_motion(kernel, row, time_s, impulse, moment, &gap);
        return line_pose(gap, speed[0]);
    }
    return find_pose(kernel, contact, time_s, impulse, moment, speed);
}

void kernel_point_begin(const Kernel *kernel, KernelPoint *point, double time_s)
{
    point->time_s = time_s;
    for (size_t i = 0; i < kernel->contact_count; i++) {
        point->known[i].is_known = false;
    }
}

const PinHole *kernel_point_pose(const Kernel *kernel, const KernelPoint *point, size_t contact)
{
    KernelKnownPose *known = &point->known[contact];
    if (!known->is_known) {
        known->pose =
            find_pose(kernel, contact, point->time_s, point->impulse, point->moment, known->speed);
        known->is_known = true;
    }
    return &known->pose;
}

PinHole kernel_motion_flight(const Kernel *kernel, size_t contact, double time_s,
                             const double moved[2], const double speeds[2])
{
    const size_t row = kernel->contacts[contact].first_row;
    double position[2];
    double speed[2];
    for (size_t i = 0; i < 2; i++) {
        speed[i] = kernel->speed[row + i] + time_s * kernel->free[row + i] + speeds[i];
        position[i] = kernel->position[row + i] + moved[i] +
                      time_s * (kernel->speed[row + i] + 0.5 * time_s * kernel->free[row + i]);
    }
    return kernel_motion_pose_of(kernel, contact, position, speed);
}

void kernel_motion_all(const Kernel *kernel, double time_s, const double *impulse,
                       const double *moment, double *positions, double *speeds)
{
    const size_t width = kernel->row_count;
    for (size_t i = 0; i < width; i++) {
        speeds[i] = kernel->speed[i] + time_s * kernel->free[i];
        positions[i] =
            kernel->position[i] + time_s * (kernel->speed[i] + 0.5 * time_s * kernel->free[i]);
    }
    if (kernel->input != NULL) {
        const KernelAdded *added = kernel_input_at(kernel, time_s);
        for (size_t i = 0; i < width; i++) {
            speeds[i] += added->speed[i];
            positions[i] += added->position[i];
        }
    }
    if (kernel->drift != NULL) {
        add_free_bend(kernel, time_s, positions, speeds);
    }
    for (size_t k = 0; k < width; k++) {
        const double *mobility = kernel_mobility(kernel, k, 0);
        const KernelSpan span = kernel_span(kernel, k);
        const double pushed = impulse[k];
        const double moved = moment[k];
        // rows of a contact that has not touched yet
        if (pushed == 0.0 && moved == 0.0) {
            continue;
        }
        for (size_t i = span.first; i < span.end; i++) {
            speeds[i] += mobility[i] * pushed;
            positions[i] += mobility[i] * moved;
        }
        if (kernel->drift != NULL) {
            add_drift_to_all(kernel, k, time_s, impulse, moment, positions, speeds);
        }
    }
}
