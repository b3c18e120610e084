// Reads the request of a run.
#include "drivers/common/reading.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const json_t *member(const json_t *object, const char *key)
{
    const json_t *value = json_object_get(object, key);
    if (value == NULL) {
        driver_fail("the request has no '%s'", key);
    }
    return value;
}

static double number(const json_t *object, const char *key)
{
    return json_number_value(member(object, key));
}

static Vec2 pair(const json_t *object, const char *key)
{
    const json_t *value = member(object, key);
    return (Vec2){json_number_value(json_array_get(value, 0)),
                  json_number_value(json_array_get(value, 1))};
}

static void copy_text(const json_t *object, const char *key, char target[DRIVER_NAME_SIZE])
{
    const char *text = json_string_value(member(object, key));
    snprintf(target, DRIVER_NAME_SIZE, "%s", text != NULL ? text : "");
}

static Wave read_wave(const json_t *object)
{
    const json_t *wave = json_object_get(object, "wave");
    return wave == NULL ? (Wave){0.0, 0.0, 0.0}
                        : (Wave){.amplitude = number(wave, "amplitude"),
                                 .rate = number(wave, "rate_rad_s"),
                                 .phase = number(wave, "phase_rad")};
}

static DriverBody read_body(const json_t *object)
{
    DriverBody body = {.mass = number(object, "mass_kg"),
                       .inertia = number(object, "inertia_kg_m2"),
                       .start = {.position = pair(object, "position_m"),
                                 .angle = number(object, "angle_rad"),
                                 .velocity = pair(object, "velocity_m_s"),
                                 .omega = number(object, "omega_rad_s")}};
    copy_text(object, "name", body.name);
    return body;
}

static ForceLaw read_law(const json_t *object)
{
    ForceLaw law = {.family = FORCE_LAW_POWER};
    const char *family = json_string_value(member(object, "family"));
    if (strcmp(family, "conforming") == 0) {
        law.family = FORCE_LAW_CONFORMING;
        law.conforming.stiffness = number(object, "stiffness_N_m");
        law.conforming.play = number(object, "play_m");
        const json_t *series = member(object, "series");
        for (size_t i = 0; i < CONFORMING_TERMS; i++) {
            law.conforming.series[i] = json_number_value(json_array_get(series, i));
        }
    } else if (strcmp(family, "power") == 0) {
        law.stiffness = number(object, "stiffness_N_m");
        law.exponent = number(object, "exponent");
    } else {
        law.family = FORCE_LAW_LOGARITHMIC;
        law.compliance = number(object, "compliance_m_N");
        law.offset = number(object, "offset");
        law.log_scale = number(object, "log_scale");
    }
    law.hysteresis = number(object, "hysteresis");
    law.viscous = number(object, "viscous_N_s_m");
    law.full_damping_depth = number(object, "full_damping_depth_m");
    law.impact_speed_floor = number(object, "impact_speed_floor_m_s");
    law.resting_speed = number(object, "resting_speed_m_s");
    law.friction = number(object, "friction");
    law.friction_speed = number(object, "friction_speed_m_s");
    const json_t *bristle = json_object_get(object, "bristle");
    if (bristle != NULL) {
        law.bristle = (BristlePair){.law = BRISTLE_STICK,
                                    .limit = number(bristle, "presliding_m"),
                                    .ratio = number(bristle, "breakaway_ratio"),
                                    .speed = number(bristle, "breakaway_speed_m_s"),
                                    .zeta = number(bristle, "damping_ratio"),
                                    .mass = number(bristle, "mass_kg")};
    }
    return law;
}

static ContactState read_contact(const json_t *object)
{
    if (json_is_null(object)) {
        return (ContactState){.is_touching = false};
    }
    return (ContactState){.is_touching = true,
                          .is_slack = json_is_true(member(object, "is_slack")),
                          .is_released = json_is_true(member(object, "is_released")),
                          .is_resting = json_is_true(member(object, "is_resting")),
                          .impact_speed = number(object, "impact_speed_m_s"),
                          .damping_speed = number(object, "damping_speed_m_s"),
                          .age_s = number(object, "age_s"),
                          // not bent where none is told
                          .bend = json_number_value(json_object_get(object, "bend_m"))};
}

static DriverJoint read_joint(const json_t *object)
{
    DriverJoint joint = {.kind = DRIVER_REVOLUTE};
    copy_text(object, "name", joint.name);
    joint.bodies[0] = (int)number(object, "body_a");
    joint.bodies[1] = (int)number(object, "body_b");
    joint.anchors[0] = pair(object, "anchor_a_m");
    joint.anchors[1] = pair(object, "anchor_b_m");
    const char *kind = json_string_value(member(object, "kind"));
    joint.slides = strcmp(kind, "prismatic") == 0 || strcmp(kind, "guide") == 0;
    joint.direction = joint.slides ? number(object, "direction_rad") : 0.0;
    if (strcmp(kind, "prismatic") == 0) {
        joint.kind = DRIVER_PRISMATIC;
    } else if (strcmp(kind, "pin-in-hole") == 0) {
        joint.kind = DRIVER_PIN_IN_HOLE;
        joint.clearance = number(object, "radial_clearance_m");
        joint.law = read_law(member(object, "law"));
    } else if (strcmp(kind, "revolute") != 0) {
        joint.kind = DRIVER_TOUCHING;
        if (strcmp(kind, "guide") != 0 && strcmp(kind, "stop") != 0 && strcmp(kind, "gears") != 0 &&
            strcmp(kind, "rack") != 0) {
            driver_refuse("the %s '%s'", kind, joint.name);
        }
    }
    return joint;
}

// The place of a pin in its hole.
static void read_hole(const json_t *object, int number_of, const DriverJoint *joint,
                      DriverPlace *place)
{
    *place = (DriverPlace){
        .joint = number_of,
        .shape = DRIVER_HOLE,
        .bodies = {joint->bodies[0], joint->bodies[1]},
        .anchors = {joint->anchors[0], joint->anchors[1]},
        .clearance = joint->clearance,
        .radii = {number(object, "hole_radius_m"), 0.0},
        .law = joint->law,
        .contact = read_contact(member(object, "contact")),
    };
}

// A table over an angle that comes again after a period, rad.
static void read_profile(const json_t *object, bool is_signed, Profile *profile)
{
    const json_t *points = member(object, "points");
    Err err = {0};
    *profile = (Profile){.count = json_array_size(points),
                         .period = number(object, "period_rad"),
                         .is_signed = is_signed};
    for (size_t i = 0; i < profile->count && i < PROFILE_MAX; i++) {
        const json_t *point = json_array_get(points, i);
        profile->angles[i] = json_number_value(json_array_get(point, 0));
        profile->radii[i] = json_number_value(json_array_get(point, 1));
    }
    if (!profile_settle(profile, &err)) {
        driver_fail("%s", err.text);
    }
}

static void read_cam(const json_t *object, DriverPlace *place)
{
    place->tables = driver_room(1, sizeof *place->tables);
    read_profile(member(object, "profile"), false, &place->tables[0]);
    place->cam = (Cam){.profile = &place->tables[0],
                       .direction = place->direction,
                       .radius = place->radii[1],
                       .is_flat = json_is_true(member(object, "is_flat")),
                       .facing = number(object, "facing_rad")};
}

static void read_teeth(const json_t *object, DriverPlace *place)
{
    const json_t *error = json_object_get(object, "transmission_error");
    const json_t *relief = json_object_get(object, "relief");
    place->tables = driver_room(2, sizeof *place->tables);
    place->middle = number(object, "middle_m");
    place->gear = (Gear){.radius_a = place->radii[0],
                         .radius_b = place->radii[1],
                         .pressure_angle = number(object, "pressure_angle_rad"),
                         .zero = number(object, "zero_rad"),
                         .error = json_is_object(error) ? 1 : 0,
                         .relief = json_is_object(relief) ? 1 : 0};
    if (place->gear.error > 0) {
        read_profile(error, true, &place->tables[0]);
    }
    if (place->gear.relief > 0) {
        read_profile(relief, true, &place->tables[1]);
    }
}

static void read_place(const json_t *object, const DriverCase *of, DriverPlace *place)
{
    static const char *const SHAPES[DRIVER_SHAPE_COUNT] = {"hole", "disc", "line",  "cam",
                                                           "slot", "turn", "teeth", "rack"};
    const char *shape = json_string_value(member(object, "shape"));
    const Vec2 siblings = pair(object, "siblings");
    int kind = 0;
    while (kind < DRIVER_SHAPE_COUNT && (shape == NULL || strcmp(shape, SHAPES[kind]) != 0)) {
        kind++;
    }
    if (kind == DRIVER_SHAPE_COUNT) {
        driver_refuse("what touches as a '%s'", shape != NULL ? shape : "?");
    }
    const int joint = (int)number(object, "joint");
    *place = (DriverPlace){
        .joint = joint,
        .shape = (DriverShape)kind,
        .bodies = {of->joints[joint].bodies[0], of->joints[joint].bodies[1]},
        .anchors = {pair(object, "anchor_a_m"), pair(object, "anchor_b_m")},
        .direction = number(object, "direction_rad"),
        .clearance = number(object, "clearance"),
        .sign = number(object, "sign"),
        .radii = {number(object, "radius_a_m"), number(object, "radius_b_m")},
        .half_length = number(object, "half_length_m"),
        .siblings = {(int)siblings.x, (int)siblings.y},
        .law = read_law(member(object, "law")),
        .contact = read_contact(member(object, "contact")),
    };
    if (place->shape == DRIVER_CAM) {
        read_cam(object, place);
    } else if (place->shape == DRIVER_TEETH) {
        read_teeth(object, place);
    }
}

static BristleMode read_mode(const json_t *bristle)
{
    static const char *const MODES[] = {"sticks", "yields-forth", "yields-back", "slides-forth",
                                        "slides-back"};
    const char *word = json_string_value(member(bristle, "mode"));
    int mode = 0;
    while (word != NULL && mode < BRISTLE_SLIDING_BACK && strcmp(word, MODES[mode]) != 0) {
        mode++;
    }
    return (BristleMode)mode;
}

// The place of an ideal joint that rubs: its turning, or its sliding along the line.
static void read_rub(const json_t *object, const DriverCase *of, DriverPlace *place, DriverRub *rub)
{
    const int number_of = (int)number(object, "joint");
    const DriverJoint *joint = &of->joints[number_of];
    const json_t *bristle = json_object_get(object, "bristle");
    *rub = (DriverRub){.is_steady = json_is_true(member(object, "is_steady")),
                       .length = number(object, "length_m")};
    *place = (DriverPlace){
        .joint = number_of,
        .shape = joint->slides ? DRIVER_RACK : DRIVER_TURN,
        .bodies = {joint->bodies[0], joint->bodies[1]},
        .anchors = {joint->anchors[0], joint->anchors[1]},
        .direction = joint->direction,
        .sign = 1.0,
        .law = {.family = FORCE_LAW_POWER,
                .exponent = 1.0,
                .friction = number(object, "friction"),
                .friction_speed = number(object, "friction_speed")},
        .contact = {.is_touching = true},
        .is_rub = true,
    };
    if (bristle != NULL) {
        place->law.bristle = (BristlePair){.law = BRISTLE_STICK,
                                           .limit = number(bristle, "presliding"),
                                           .ratio = number(bristle, "breakaway_ratio"),
                                           .speed = number(bristle, "breakaway_speed"),
                                           .zeta = number(bristle, "damping_ratio")};
        place->contact.bend = number(bristle, "bend");
        place->contact.bristle = read_mode(bristle);
    }
}

// The friction of ideal joints: contacts within the step, and else torques and forces.
static void read_rubs(const json_t *request, DriverCase *of)
{
    const json_t *rubs = json_object_get(request, "rubs");
    const size_t count = json_array_size(rubs);
    const bool is_within = driver_is_way(of, "kernel");
    of->rubs = driver_room(count, sizeof *of->rubs);
    of->drags = driver_room(count, sizeof *of->drags);
    for (size_t i = 0; i < count; i++) {
        DriverPlace *place = &of->places[of->place_count + i];
        read_rub(json_array_get(rubs, i), of, place, &of->rubs[i]);
        const bool holds = place->law.bristle.law == BRISTLE_STICK;
        if (!is_within && (!of->rubs[i].is_steady || (holds && !driver_is_way(of, "native")))) {
            driver_refuse("the friction of the ideal joint '%s' in the way '%s'",
                          of->joints[place->joint].name, of->way);
        }
        of->drags[i] = (DriverDrag){.joint = place->joint,
                                    .holds = holds,
                                    .most = place->law.friction,
                                    .speed = place->law.friction_speed};
    }
    of->rub_count = is_within ? count : 0;
    of->drag_count = is_within ? 0 : count;
}

// What touches: the pins in their holes, and the places that are listed.
static void read_places(const json_t *request, const json_t *joints, DriverCase *of)
{
    const json_t *touches = json_object_get(request, "touches");
    const size_t rubs = json_array_size(json_object_get(request, "rubs"));
    of->places = driver_room(of->joint_count + json_array_size(touches) + rubs, sizeof *of->places);
    for (size_t i = 0; i < of->joint_count; i++) {
        if (of->joints[i].kind == DRIVER_PIN_IN_HOLE) {
            read_hole(json_array_get(joints, i), (int)i, &of->joints[i],
                      &of->places[of->place_count++]);
        }
    }
    for (size_t i = 0; i < json_array_size(touches); i++) {
        read_place(json_array_get(touches, i), of, &of->places[of->place_count++]);
    }
}

static void read_time_table(const json_t *object, TimeTable *table)
{
    const json_t *points = member(object, "points");
    *table = (TimeTable){.count = json_array_size(points),
                         .period_s = number(object, "period_s"),
                         .wave = read_wave(object)};
    if (table->count > TIME_TABLE_MAX) {
        driver_fail("a table over time has more than %d points", TIME_TABLE_MAX);
    }
    for (size_t i = 0; i < table->count; i++) {
        const json_t *point = json_array_get(points, i);
        table->times[i] = json_number_value(json_array_get(point, 0));
        table->values[i] = json_number_value(json_array_get(point, 1));
    }
}

// How a drive turns: at a constant speed, or by a table of speeds or angles.
static void read_turning(const json_t *object, Driver *driver)
{
    static const char *const PROFILES[] = {"cycloid", "polynomial", "trapezoid", "spline"};
    const char *profile = json_string_value(member(object, "profile"));
    const char *kind = json_string_value(member(object, "points_are"));
    *driver = (Driver){.is_present = true,
                       .speed = number(object, "speed_rad_s"),
                       .start = number(object, "start_rad"),
                       .has_angles = kind != NULL && strcmp(kind, "angles") == 0,
                       .gain = number(object, "gain_rad")};
    for (int i = 0; i < (int)(sizeof PROFILES / sizeof *PROFILES); i++) {
        driver->profile = profile != NULL && strcmp(profile, PROFILES[i]) == 0 ? (DriveProfile)i
                                                                               : driver->profile;
    }
    read_time_table(object, &driver->table);
    drive_complete(driver);
}

static void read_drives(const json_t *request, DriverCase *of)
{
    const json_t *drives = json_object_get(request, "drives");
    of->drive_count = json_array_size(drives);
    of->drives = driver_room(of->drive_count, sizeof *of->drives);
    for (size_t i = 0; i < of->drive_count; i++) {
        const json_t *drive = json_array_get(drives, i);
        of->drives[i].body = (int)number(drive, "body");
        of->drives[i].joint = (int)number(drive, "joint");
        read_turning(drive, &of->drives[i].law);
    }
}

static void read_servos(const json_t *request, DriverCase *of)
{
    const json_t *servos = json_object_get(request, "servos");
    of->servo_count = json_array_size(servos);
    of->servos = driver_room(of->servo_count, sizeof *of->servos);
    for (size_t i = 0; i < of->servo_count; i++) {
        const json_t *object = json_array_get(servos, i);
        const json_t *followed = json_object_get(object, "follows");
        DriverServo *servo = &of->servos[i];
        servo->joint = (int)number(object, "joint");
        servo->stiffness = number(object, "stiffness");
        servo->slope = number(object, "slope");
        servo->limit = number(object, "limit");
        read_time_table(object, &servo->table);
        if (json_is_object(followed)) {
            read_turning(followed, &servo->followed);
        }
    }
}

static void read_drive(const json_t *drive, DriverCase *of)
{
    of->driven_body = DRIVER_GROUND;
    of->has_drive = !json_is_null(drive);
    if (of->has_drive) {
        of->driven_body = (int)number(drive, "body");
        of->drive_joint = (int)number(drive, "joint");
        of->drive_speed = number(drive, "speed_rad_s");
        of->steady = (DriverDrive){.body = of->driven_body,
                                   .joint = of->drive_joint,
                                   .law = {.is_present = true,
                                           .speed = of->drive_speed,
                                           .start = of->bodies[of->driven_body].start.angle}};
    }
}

static DriverSpring read_spring(const json_t *object)
{
    return (DriverSpring){.bodies = {(int)number(object, "body_a"), (int)number(object, "body_b")},
                          .anchors = {pair(object, "anchor_a_m"), pair(object, "anchor_b_m")},
                          .stiffness = number(object, "stiffness_N_m"),
                          .length = number(object, "length_m"),
                          .damping = number(object, "damping_N_s_m")};
}

static DriverTorsion read_torsion(const json_t *object)
{
    return (DriverTorsion){.joint = (int)number(object, "joint"),
                           .stiffness = number(object, "stiffness_N_m_rad"),
                           .angle = number(object, "angle_rad"),
                           .damping = number(object, "damping_N_m_s_rad")};
}

// One of the curves of a bushing; without points there is none.
static void read_curve(const json_t *object, const char *key, ForceCurveShape shape,
                       ForceCurve *curve)
{
    const json_t *points = member(object, key);
    curve->count = json_array_size(points);
    if (curve->count > FORCE_CURVE_MAX || curve->count == 1) {
        driver_fail("a bushing has a curve of %zu points", curve->count);
    }
    for (size_t i = 0; i < curve->count; i++) {
        const json_t *point = json_array_get(points, i);
        curve->at[i] = json_number_value(json_array_get(point, 0));
        curve->values[i] = json_number_value(json_array_get(point, 1));
    }
    force_curve_settle(curve, shape);
}

static void read_bushing(const json_t *object, DriverBushing *bushing)
{
    const char *word = json_string_value(member(object, "shape"));
    const bool is_smooth =
        word != NULL && strcmp(word, FORCE_CURVE_SHAPES[FORCE_CURVE_SMOOTH]) == 0;
    const ForceCurveShape shape = is_smooth ? FORCE_CURVE_SMOOTH : FORCE_CURVE_LINEAR;
    const Vec2 stiffness = pair(object, "stiffness_N_m");
    const Vec2 damping = pair(object, "damping_N_s_m");
    *bushing = (DriverBushing){
        .bodies = {(int)number(object, "body_a"), (int)number(object, "body_b")},
        .anchors = {pair(object, "anchor_a_m"), pair(object, "anchor_b_m")},
        .direction = number(object, "direction_rad"),
        .angle = number(object, "angle_rad"),
        .stiffness = {stiffness.x, stiffness.y, number(object, "stiffness_N_m_rad")},
        .damping = {damping.x, damping.y, number(object, "damping_N_m_s_rad")},
    };
    copy_text(object, "name", bushing->name);
    read_curve(object, "force_x", shape, &bushing->curves[0]);
    read_curve(object, "force_y", shape, &bushing->curves[1]);
    read_curve(object, "torque", shape, &bushing->curves[2]);
}

static void read_table(const json_t *object, LoadTable *table)
{
    const json_t *points = member(object, "points");
    const char *shape = json_string_value(member(object, "shape"));
    table->count = json_array_size(points);
    table->period = number(object, "period");
    if (table->count > LOAD_TABLE_MAX) {
        driver_fail("a load has more than %d points", LOAD_TABLE_MAX);
    }
    for (size_t i = 0; i < table->count; i++) {
        const json_t *point = json_array_get(points, i);
        table->at[i] = json_number_value(json_array_get(point, 0));
        table->values[i] = json_number_value(json_array_get(point, 1));
    }
    for (int i = 0; i < LOAD_SHAPE_COUNT; i++) {
        table->shape =
            shape != NULL && strcmp(shape, LOAD_SHAPES[i]) == 0 ? (LoadShape)i : table->shape;
    }
    table->wave = read_wave(object);
    load_table_settle(table);
}

static void read_load(const json_t *object, DriverLoad *load)
{
    const json_t *over = json_object_get(object, "over_joint");
    copy_text(object, "name", load->name);
    load->over_joint = over != NULL ? (int)json_number_value(over) : -1;
    load->shift = number(object, "shift");
    load->rate = over != NULL ? 0.0 : number(object, "rate");
    read_table(object, &load->table);
    if (json_object_get(object, "joint") != NULL) {
        load->kind = DRIVER_ALONG;
        load->joint = (int)number(object, "joint");
        return;
    }
    load->kind = DRIVER_TORQUE;
    load->body = (int)number(object, "body");
    if (json_object_get(object, "direction_rad") != NULL) {
        load->kind = DRIVER_FORCE;
        load->anchor = pair(object, "anchor_m");
        load->direction = number(object, "direction_rad");
        load->turns_along = json_is_true(member(object, "turns_along"));
    }
}

// What acts on the bodies; a request of protocol 1 has nothing of it, one of 2 no bushings.
static void read_actions(const json_t *request, DriverCase *of)
{
    const json_t *springs = json_object_get(request, "springs");
    const json_t *torsions = json_object_get(request, "torsion_springs");
    const json_t *bushings = json_object_get(request, "bushings");
    const json_t *loads = json_object_get(request, "loads");
    of->bushing_count = json_array_size(bushings);
    of->bushings = driver_room(of->bushing_count, sizeof *of->bushings);
    for (size_t i = 0; i < of->bushing_count; i++) {
        read_bushing(json_array_get(bushings, i), &of->bushings[i]);
    }
    of->spring_count = json_array_size(springs);
    of->torsion_count = json_array_size(torsions);
    of->load_count = json_array_size(loads);
    of->springs = driver_room(of->spring_count, sizeof *of->springs);
    of->torsions = driver_room(of->torsion_count, sizeof *of->torsions);
    of->loads = driver_room(of->load_count, sizeof *of->loads);
    for (size_t i = 0; i < of->spring_count; i++) {
        of->springs[i] = read_spring(json_array_get(springs, i));
    }
    for (size_t i = 0; i < of->torsion_count; i++) {
        of->torsions[i] = read_torsion(json_array_get(torsions, i));
    }
    for (size_t i = 0; i < of->load_count; i++) {
        read_load(json_array_get(loads, i), &of->loads[i]);
    }
}

DriverCase *driver_read_case(const json_t *request)
{
    DriverCase *of = driver_room(1, sizeof *of);
    copy_text(request, "way", of->way);
    of->step_s = number(request, "step_s");
    of->duration_s = number(request, "duration_s");
    of->record_s = json_number_value(json_object_get(request, "record_s"));
    of->gravity = pair(request, "gravity_m_s2");
    of->wants_model = json_is_true(json_object_get(request, "model"));
    const json_t *bodies = member(request, "bodies");
    const json_t *joints = member(request, "joints");
    const json_t *times = member(request, "sample_times_s");
    of->body_count = json_array_size(bodies);
    of->joint_count = json_array_size(joints);
    of->sample_count = json_array_size(times);
    of->bodies = driver_room(of->body_count, sizeof *of->bodies);
    of->joints = driver_room(of->joint_count, sizeof *of->joints);
    of->sample_times = driver_room(of->sample_count, sizeof *of->sample_times);
    for (size_t i = 0; i < of->body_count; i++) {
        of->bodies[i] = read_body(json_array_get(bodies, i));
    }
    for (size_t i = 0; i < of->joint_count; i++) {
        of->joints[i] = read_joint(json_array_get(joints, i));
    }
    for (size_t i = 0; i < of->sample_count; i++) {
        of->sample_times[i] = json_number_value(json_array_get(times, i));
    }
    read_drive(member(request, "drive"), of);
    read_places(request, joints, of);
    read_rubs(request, of);
    read_drives(request, of);
    read_servos(request, of);
    read_actions(request, of);
    return of;
}
