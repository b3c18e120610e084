// Finds the angle and the speed of the driven body.
//
//     omega = w_i + alpha_i (t - t_i),  angle = start + the integral of omega from time zero
#include "model/drive.h"

#include <math.h>

static bool is_constant(const Driver *driver)
{
    return driver->speeds.count == 0;
}

double drive_angle(const Driver *driver, double time_s)
{
    return is_constant(driver) ? driver->start + driver->speed * time_s
                               : (double)drive_angle_exact(driver, time_s);
}

long double drive_angle_exact(const Driver *driver, long double time_s)
{
    const long double turned =
        is_constant(driver) ? driver->speed * time_s : time_table_integral(&driver->speeds, time_s);
    return driver->start + turned;
}

DriveState drive_at(const Driver *driver, double time_s)
{
    DriveState state = {.angle = drive_angle(driver, time_s), .omega = driver->speed};
    if (!is_constant(driver)) {
        const TimePiece piece = time_table_piece(&driver->speeds, time_s);
        state.omega = time_table_at(&driver->speeds, time_s);
        state.alpha = piece.slope;
    }
    return state;
}

DriveState drive_since(const Driver *driver, double from_s, double time_s)
{
    DriveState state = drive_at(driver, from_s);
    const double since_s = time_s - from_s;
    state.angle += since_s * (state.omega + 0.5 * state.alpha * since_s);
    state.omega += since_s * state.alpha;
    return state;
}

double drive_next_kink(const Driver *driver, double time_s)
{
    return time_table_next_bend(&driver->speeds, time_s);
}

static void extend(DriveExtent *extent, const Driver *driver, double time_s)
{
    const double turned = drive_angle(driver, time_s) - driver->start;
    extent->back = fmin(extent->back, turned);
    extent->forth = fmax(extent->forth, turned);
}

DriveExtent drive_extent(const Driver *driver, double to_s)
{
    DriveExtent extent = {0.0, 0.0};
    // it turns round where a piece's line passes through zero
    for (double start_s = 0.0; start_s < to_s;) {
        const double end_s = fmin(to_s, drive_next_kink(driver, start_s));
        const DriveState first = drive_at(driver, start_s);
        const double rest_s = first.alpha != 0.0 ? -first.omega / first.alpha : INFINITY;
        if (rest_s > 0.0 && start_s + rest_s < end_s) {
            extend(&extent, driver, start_s + rest_s);
        }
        extend(&extent, driver, end_s);
        start_s = end_s;
    }
    return extent;
}

bool drive_is_steady(const Driver *driver)
{
    return driver->is_present && is_constant(driver);
}

void drive_take_largest(Driver *driver)
{
    driver->speed = is_constant(driver) ? driver->speed : time_table_largest(&driver->speeds);
}
