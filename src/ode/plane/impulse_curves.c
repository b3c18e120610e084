// Finds how bodies move inside a step of few rows, as polynomials in time.
//
// The parabola A + B s + C s^2 has Newton's form, through the last three steps' values at their
// middles.
#include "ode/plane/impulse_curves.h"

#include "base/zeroed.h"

ImpulseCurves impulse_curves_create(const Linkage *linkage, size_t place_count, size_t row_count)
{
    const size_t body_count = linkage->body_count;
    return (ImpulseCurves){
        .linkage = linkage,
        .body_count = body_count,
        .row_count = row_count,
        .place_count = place_count,
        .bodies = zeroed(body_count * IMPULSE_HALVES, sizeof(ImpulseCurve)),
        .columns = zeroed(body_count * row_count, sizeof(ImpulseColumn)),
        .places = zeroed(place_count, sizeof(ImpulseCurve)),
        .place_columns = zeroed(place_count * row_count, sizeof(ImpulsePlaceColumn)),
    };
}

void impulse_curves_finish(ImpulseCurves *curves)
{
    free(curves->bodies);
    free(curves->columns);
    free(curves->places);
    free(curves->place_columns);
    *curves = (ImpulseCurves){.body_count = 0};
}

void impulse_curves_carry(ImpulseCurves *curves, Carry *carry)
{
    CARRY(carry, curves->width_s);
    CARRY_ARRAY(carry, curves->bodies, curves->body_count * IMPULSE_HALVES);
    CARRY_ARRAY(carry, curves->columns, curves->body_count * curves->row_count);
    CARRY_ARRAY(carry, curves->places, curves->place_count);
    CARRY_ARRAY(carry, curves->place_columns, curves->place_count * curves->row_count);
}

void impulse_curves_set_body(ImpulseCurves *curves, size_t body, const Motion *before,
                             const double *mean, const double *rate, const double *rest)
{
    const double width_s = curves->width_s;
    const double per_square = 1.0 / (width_s * width_s);
    const double position[3] = {before->position.x, before->position.y, before->angle};
    const double speed[3] = {before->velocity.x, before->velocity.y, before->omega};
    for (size_t k = 0; k < 3; k++) {
        ImpulseCurve *curve = &curves->bodies[body * IMPULSE_HALVES + k / 2];
        curve->position[k % 2] = position[k];
        curve->speed[k % 2] = speed[k];
        curve->bend[k % 2] = 0.5 * mean[k] - 0.25 * width_s * rate[k] + per_square * rest[k];
        curve->acceleration[k % 2] = mean[k] - 0.5 * width_s * rate[k];
        curve->rate[k % 2] = rate[k];
    }
}

void impulse_curves_set_places(ImpulseCurves *curves, const Kernel *kernel)
{
    const size_t rows = curves->row_count;
    for (size_t place = 0; place < curves->place_count; place++) {
        ImpulseCurve *curve = &curves->places[place];
        for (size_t i = 0; i < 2; i++) {
            const size_t row = kernel->contacts[place].first_row + i;
            const double bent = 0.5 * curves->width_s * kernel->free_rate[row];
            curve->position[i] = kernel->position[row];
            curve->speed[i] = kernel->speed[row];
            curve->bend[i] = 0.5 * (kernel->free[row] - bent);
            curve->acceleration[i] = kernel->free[row] - bent;
            curve->rate[i] = kernel->free_rate[row];
            for (size_t k = 0; k < rows; k++) {
                ImpulsePlaceColumn *column = &curves->place_columns[place * rows + k];
                const double drift = kernel->drift[row * rows + k];
                const double rate = kernel->mobility_rate[row * rows + k];
                column->middle[i] = *kernel_mobility(kernel, row, k);
                column->rate[i] = rate;
                column->late[i] = 2.0 * drift - rate;
                column->second[i] = 2.0 * (drift - rate);
            }
        }
    }
}

void impulse_curves_set_columns(ImpulseCurves *curves, double *const columns[KERNEL_COLUMNS_KNOWN],
                                const double middles_s[KERNEL_COLUMNS_KNOWN], const double *rates)
{
    const double last_s = middles_s[0] - middles_s[1];
    const double per_last = 1.0 / last_s;
    const double per_former = 1.0 / (middles_s[1] - middles_s[2]);
    const double per_both = 1.0 / (middles_s[0] - middles_s[2]);
    for (size_t body = 0; body < curves->body_count; body++) {
        for (size_t row = 0; row < curves->row_count; row++) {
            ImpulseColumn *column = &curves->columns[body * curves->row_count + row];
            const size_t first = 3 * (row * curves->body_count + body);
            for (size_t k = 0; k < 3; k++) {
                const double now = columns[0][first + k];
                const double rise = per_last * (now - columns[1][first + k]);
                const double before = per_former * (columns[1][first + k] - columns[2][first + k]);
                column->middle[k / 2][k % 2] = now;
                column->rate[k / 2][k % 2] = rates[first + k];
                column->bend[k / 2][k % 2] = per_both * (rise - before);
                column->slope[k / 2][k % 2] = rise + last_s * column->bend[k / 2][k % 2];
            }
        }
    }
}

// Whether the contacts have done anything so far, or do now.
static bool has_pushed(const KernelSums *sums, size_t rows)
{
    for (size_t row = 0; row < rows; row++) {
        if (sums->impulse[row] != 0.0 || sums->moment[row] != 0.0 || sums->force[row] != 0.0) {
            return true;
        }
    }
    return false;
}

static inline Double2 position_on(const ImpulseCurve *curve, double since_s)
{
    const Double2 bent = curve->bend + (1.0 / 6.0 * since_s) * curve->rate;
    return curve->position + since_s * (curve->speed + since_s * bent);
}

static inline Double2 speed_on(const ImpulseCurve *curve, double since_s)
{
    return curve->speed + since_s * (curve->acceleration + (0.5 * since_s) * curve->rate);
}

// How one body moves under so many rows, all or none.
static inline Motion body_at(const ImpulseCurve *curve, const ImpulseColumn *columns, size_t rows,
                             double since_s, double off_s, const KernelSums *sums)
{
    Double2 q[IMPULSE_HALVES];
    Double2 v[IMPULSE_HALVES];
    Double2 a[IMPULSE_HALVES];
    for (size_t k = 0; k < IMPULSE_HALVES; k++) {
        q[k] = position_on(&curve[k], since_s);
        v[k] = speed_on(&curve[k], since_s);
        a[k] = curve[k].acceleration + since_s * curve[k].rate;
    }
    for (size_t row = 0; row < rows; row++) {
        const ImpulseColumn *column = &columns[row];
        const double moved = sums->moment[row];
        const double twice = 2.0 * sums->moment[rows + row];
        for (size_t k = 0; k < IMPULSE_HALVES; k++) {
            const Double2 now = column->middle[k] + off_s * column->rate[k];
            q[k] += moved * now - twice * column->rate[k];
            v[k] += sums->impulse[row] * now - moved * column->rate[k];
            a[k] += sums->force[row] *
                    (column->middle[k] + off_s * (column->slope[k] + off_s * column->bend[k]));
        }
    }
    return (Motion){
        .position = {q[0][0], q[0][1]},
        .angle = q[1][0],
        .velocity = {v[0][0], v[0][1]},
        .omega = v[1][0],
        .acceleration = {a[0][0], a[0][1]},
        .alpha = a[1][0],
    };
}

void impulse_curves_at(const ImpulseCurves *curves, double since_s, const KernelSums *sums,
                       Motion *motions)
{
    const double off_s = since_s - 0.5 * curves->width_s;
    const size_t rows = has_pushed(sums, curves->row_count) ? curves->row_count : 0;
    for (size_t i = 0; i < curves->body_count; i++) {
        if (!linkage_is_driven(curves->linkage, (int)i)) {
            motions[i] =
                body_at(curves->bodies + i * IMPULSE_HALVES,
                        curves->columns + i * curves->row_count, rows, since_s, off_s, sums);
        }
    }
}

void impulse_curves_place_at(const ImpulseCurves *curves, size_t place, double since_s,
                             const KernelSums *sums, double position[2], double speed[2])
{
    const size_t rows = curves->row_count;
    const double off_s = since_s - 0.5 * curves->width_s;
    Double2 u = position_on(&curves->places[place], since_s);
    Double2 v = speed_on(&curves->places[place], since_s);
    for (size_t row = 0; row < rows; row++) {
        const ImpulsePlaceColumn *column = &curves->place_columns[place * rows + row];
        const Double2 now = column->middle + off_s * column->rate;
        u += sums->moment[row] * now + sums->moment[rows + row] * column->second;
        v += sums->impulse[row] * now + sums->moment[row] * column->late;
    }
    position[0] = u[0];
    position[1] = u[1];
    speed[0] = v[0];
    speed[1] = v[1];
}

void impulse_curves_press(const ImpulseCurves *curves, double off_s, const double *forces,
                          double *rates)
{
    for (size_t i = 0; i < curves->body_count; i++) {
        const ImpulseColumn *columns = curves->columns + i * curves->row_count;
        Double2 sum[IMPULSE_HALVES] = {{0.0, 0.0}, {0.0, 0.0}};
        for (size_t row = 0; row < curves->row_count; row++) {
            for (size_t k = 0; k < IMPULSE_HALVES; k++) {
                const ImpulseColumn *column = &columns[row];
                sum[k] += forces[row] * (column->middle[k] +
                                         off_s * (column->slope[k] + off_s * column->bend[k]));
            }
        }
        rates[3 * i] = sum[0][0];
        rates[3 * i + 1] = sum[0][1];
        rates[3 * i + 2] = sum[1][0];
    }
}
