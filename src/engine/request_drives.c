// Writes drives that are more than one at a constant speed, and servos, as a part of the request of
// the driver protocol (docs/drivers.md).
#include "engine/features.h"
#include "engine/protocol.h"

static json_t *points_array(const TimeTable *table)
{
    json_t *points = json_array();
    for (size_t i = 0; i < table->count; i++) {
        json_array_append_new(points, engine_pair((Vec2){table->times[i], table->values[i]}));
    }
    return points;
}

void engine_add_wave(const Wave *wave, json_t *object)
{
    if (wave_exists(wave)) {
        json_object_set_new(object, "wave",
                            json_pack("{s:f, s:f, s:f}", "amplitude", wave->amplitude, "rate_rad_s",
                                      wave->rate, "phase_rad", wave->phase));
    }
}

static const char *profile_word(DriveProfile profile)
{
    switch (profile) {
    case DRIVE_CYCLOID:
        return "cycloid";
    case DRIVE_POLYNOMIAL:
        return "polynomial";
    case DRIVE_TRAPEZOID:
        return "trapezoid";
    case DRIVE_SPLINE:
        return "spline";
    }
    return "none";
}

static json_t *turning_object(const Driver *driver)
{
    json_t *object =
        json_pack("{s:f, s:f, s:s, s:o, s:f, s:f, s:s}", "speed_rad_s", driver->speed, "start_rad",
                  driver->start, "points_are", driver->has_angles ? "angles" : "speeds", "points",
                  points_array(&driver->table), "period_s", driver->table.period_s, "gain_rad",
                  driver->gain, "profile", profile_word(driver->profile));
    engine_add_wave(&driver->table.wave, object);
    return object;
}

static json_t *servo_object(const Torque *torque)
{
    json_t *object =
        json_pack("{s:i, s:o, s:f, s:f, s:f, s:f, s:o}", "joint", torque->joint, "points",
                  points_array(&torque->table), "period_s", torque->table.period_s, "stiffness",
                  torque->stiffness, "slope", torque->slope, "limit", torque->limit, "follows",
                  torque->followed.is_present ? turning_object(&torque->followed) : json_null());
    engine_add_wave(&torque->table.wave, object);
    return object;
}

void engine_add_drives(const Scenario *scenario, json_t *request)
{
    const Linkage *linkage = &scenario->linkage;
    json_t *drives = json_array();
    for (size_t i = 0; engine_has_drives(linkage) && i < linkage_drive_count(linkage); i++) {
        const Driver *driver = linkage_drive(linkage, i);
        json_t *object = turning_object(driver);
        json_object_set_new(object, "joint", json_integer(driver->joint));
        json_object_set_new(object, "body", json_integer(linkage_drive_body(linkage, i)));
        json_array_append_new(drives, object);
    }
    json_object_set_new(request, "drives", drives);
    if (engine_has_servo(linkage)) {
        json_object_set_new(request, "servos", json_pack("[o]", servo_object(&linkage->torque)));
    }
}
