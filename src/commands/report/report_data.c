// Gathers what a report carries for its script.
#include "commands/report/report_data.h"
#include "base/zeroed.h"
#include "commands/report/report_marks.h"
#include "commands/report/report_pack.h"
#include "model/coordinate.h"
#include "run/bushing_load.h"
#include "run/drive_torque.h"
#include "write/json_value.h"
#include "write/series_rows.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum {
    FORMAT = 1,
    // Values of all signals together, so that a page stays below 1 MB and its plots are drawn
    // within a second; and samples of a run, of which some 2,000 columns of pixels see each.
    VALUES_MOST = 380000,
    VALUES_LEAST = 60000, // where the picture leaves no room
    SAMPLES_MOST = 24000,
};

// The mechanism.

static json_t *vector_json(Vec2 vector)
{
    return json_pack("[f,f]", vector.x, vector.y);
}

static json_t *bodies_json(const Linkage *linkage)
{
    json_t *bodies = json_array();
    for (size_t i = 0; i < linkage->body_count; i++) {
        const Body *body = &linkage->bodies[i];
        json_t *object = json_object();
        json_object_set_new(object, "name", json_value_text(body->name));
        json_object_set_new(object, "is_driven", json_boolean(linkage_is_driven(linkage, (int)i)));
        json_value_set(object, "gyration_m", sqrt(body->inertia / body->mass));
        json_array_append_new(bodies, object);
    }
    return bodies;
}

// The profile of a cam as a polygon about the anchor on body a, in that body's frame.
static void set_cam(json_t *object, const Linkage *linkage, const Joint *joint)
{
    enum { SIDES = 180 };
    const Profile *profile = linkage_profile(linkage, joint);
    if (profile == NULL) {
        return;
    }
    json_t *points = json_array();
    for (int i = 0; i < SIDES; i++) {
        const double angle = 2.0 * M_PI * i / SIDES;
        const Vec2 out = vec2_rotate(angle + joint->direction, (Vec2){1.0, 0.0});
        json_array_append_new(points, vector_json(vec2_scale(profile_at(profile, angle).r, out)));
    }
    json_object_set_new(object, "profile_m", points);
    json_object_set_new(object, "is_flat", json_boolean(joint->stop.is_flat));
    json_value_set(object, "facing_rad", joint->stop.facing);
}

// Between which values stops or flanks keep the coordinate of a joint, m or rad; null: no stop.
static void set_limit(json_t *object, const Joint *joint)
{
    if (joint->limits.kind == LIMIT_NONE) {
        return;
    }
    json_t *limit = json_object();
    json_object_set_new(limit, "kind",
                        json_string(joint->limits.kind == LIMIT_STOPS ? "stops" : "backlash"));
    json_value_set(limit, "low", coordinate_low(joint));
    json_value_set(limit, "high", coordinate_high(joint));
    json_object_set_new(object, "limit", limit);
}

// What a joint is drawn by: whether it pivots or slides, what touches in it, and the sizes of that,
// m.
static void set_shape(json_t *object, const Linkage *linkage, const Joint *joint)
{
    json_object_set_new(object, "pivots", json_boolean(joint_pivots(joint->kind)));
    json_object_set_new(object, "slides", json_boolean(joint_slides(joint->kind)));
    json_value_set(object, "clearance_m", linkage_radial_clearance(joint));
    set_limit(object, joint);
    switch (joint_touches(joint->kind)) {
    case JOINT_TOUCHES_NOTHING:
        json_object_set_new(object, "touches", json_string("nothing"));
        break;
    case JOINT_TOUCHES_HOLE:
        json_object_set_new(object, "touches", json_string("hole"));
        json_value_set(object, "pin_radius_m", joint->clearance.pin_radius);
        break;
    case JOINT_TOUCHES_GUIDES:
        json_object_set_new(object, "touches", json_string("guides"));
        json_value_set(object, "height_m", joint->guide.height);
        json_value_set(object, "opening_m", joint->guide.opening);
        json_value_set(object, "length_m", joint->guide.length);
        break;
    case JOINT_TOUCHES_DISC:
        json_object_set_new(object, "touches", json_string("disc"));
        json_object_set_new(object, "is_disc", json_boolean(joint->stop.is_disc));
        json_value_set(object, "radius_a_m", joint->stop.radius_a);
        json_value_set(object, "radius_b_m", joint->stop.radius_b);
        json_value_set(object, "slot_m", joint->stop.slot);
        set_cam(object, linkage, joint);
        break;
    case JOINT_TOUCHES_TEETH:
        json_object_set_new(object, "touches", json_string("teeth"));
        json_value_set(object, "radius_a_m", joint->gear.radius_a);
        json_value_set(object, "radius_b_m", joint->gear.radius_b);
        json_object_set_new(object, "is_rack", json_boolean(joint_has_rack(joint->kind)));
        json_value_set(object, "teeth_a", joint->gear.teeth[0]);
        json_value_set(object, "teeth_b", joint->gear.teeth[1]);
        break;
    }
}

static json_t *vector3_json(Vec3 vector)
{
    return json_pack("[f,f,f]", vector.x, vector.y, vector.z);
}

// Where a joint is on both of its bodies in space, and how its axis stands there.
static void set_space(json_t *object, const Linkage *linkage, size_t number)
{
    const SpaceEnd a = space_end(linkage, number, 0);
    const SpaceEnd b = space_end(linkage, number, 1);
    json_object_set_new(object, "space_a_m", vector3_json(a.anchor));
    json_object_set_new(object, "space_b_m", vector3_json(b.anchor));
    json_object_set_new(object, "axis_a", vector3_json(a.axis));
    json_value_set(object, "width_m", linkage->joints[number].clearance.width);
}

static json_t *joints_json(const Linkage *linkage)
{
    json_t *joints = json_array();
    for (size_t i = 0; i < linkage->joint_count; i++) {
        const Joint *joint = &linkage->joints[i];
        json_t *object = json_object();
        json_object_set_new(object, "name", json_value_text(joint->name));
        json_object_set_new(object, "has_play", json_boolean(linkage_has_play(joint)));
        json_object_set_new(object, "is_torsional", json_boolean(linkage_is_torsional(joint)));
        json_object_set_new(object, "body_a", json_integer(joint->body_a));
        json_object_set_new(object, "body_b", json_integer(joint->body_b));
        json_object_set_new(object, "anchor_a_m", vector_json(joint->anchor_a));
        json_object_set_new(object, "anchor_b_m", vector_json(joint->anchor_b));
        json_value_set(object, "direction_rad", joint->direction);
        json_value_set(object, "held_angle_rad", joint->held_angle);
        set_shape(object, linkage, joint);
        if (linkage->is_spatial) {
            set_space(object, linkage, i);
        }
        json_array_append_new(joints, object);
    }
    return joints;
}

static json_t *springs_json(const Linkage *linkage)
{
    json_t *springs = json_array();
    for (size_t i = 0; i < linkage->spring_count; i++) {
        const Spring *spring = &linkage->springs[i];
        json_t *object = json_object();
        json_object_set_new(object, "name", json_value_text(spring->name));
        json_object_set_new(object, "body_a", json_integer(spring->body_a));
        json_object_set_new(object, "body_b", json_integer(spring->body_b));
        json_object_set_new(object, "anchor_a_m", vector_json(spring->anchor_a));
        json_object_set_new(object, "anchor_b_m", vector_json(spring->anchor_b));
        json_array_append_new(springs, object);
    }
    return springs;
}

static json_t *bushings_json(const Linkage *linkage)
{
    json_t *bushings = json_array();
    for (size_t i = 0; i < linkage->bushing_count; i++) {
        const Bushing *bushing = &linkage->bushings[i];
        json_t *object = json_object();
        json_object_set_new(object, "name", json_value_text(bushing->name));
        json_object_set_new(object, "body_a", json_integer(bushing->body_a));
        json_object_set_new(object, "body_b", json_integer(bushing->body_b));
        json_object_set_new(object, "anchor_a_m", vector_json(bushing->anchor_a));
        json_object_set_new(object, "anchor_b_m", vector_json(bushing->anchor_b));
        json_array_append_new(bushings, object);
    }
    return bushings;
}

static json_t *points_json(const Scenario *scenario)
{
    json_t *points = json_array();
    for (size_t i = 0; i < scenario->point_count; i++) {
        const TracedPoint *point = &scenario->points[i];
        json_t *object = json_object();
        json_object_set_new(object, "name", json_value_text(point->name));
        json_object_set_new(object, "body", json_integer(point->body));
        json_object_set_new(object, "at_m", vector_json(point->local));
        json_array_append_new(points, object);
    }
    return points;
}

// Signals.

// How a column is thinned, and whether an angle turns on and on.
typedef enum Thinning { THIN_SAMPLE, THIN_LEAST, THIN_MOST, THIN_TURNING } Thinning;

// Of which joints a column is carried: of those that feel their play alone; of all in the plane,
// and of these; of all. In space a force has a third component, which only those with play have
// here.
typedef enum CarriedOf { CARRIED_OF_PLAY, CARRIED_OF_PLANE, CARRIED_OF_ALL } CarriedOf;

// A column that a report carries.
typedef struct Carried {
    SeriesOf of;
    const char *what; // as in the table of write/series_rows.c
    Thinning thinning;
    CarriedOf joints;
} Carried;

static const Carried CARRIED[] = {
    {SERIES_OF_BODY, "x_m", THIN_SAMPLE, CARRIED_OF_ALL},
    {SERIES_OF_BODY, "y_m", THIN_SAMPLE, CARRIED_OF_ALL},
    {SERIES_OF_BODY, "angle_rad", THIN_TURNING, CARRIED_OF_ALL},
    {SERIES_OF_BODY, "omega_rad_s", THIN_SAMPLE, CARRIED_OF_ALL},
    {SERIES_OF_BODY, "alpha_rad_s2", THIN_SAMPLE, CARRIED_OF_ALL},
    {SERIES_OF_BODY, "alpha_min_rad_s2", THIN_LEAST, CARRIED_OF_ALL},
    {SERIES_OF_BODY, "alpha_max_rad_s2", THIN_MOST, CARRIED_OF_ALL},
    {SERIES_OF_JOINT, "ex_m", THIN_SAMPLE, CARRIED_OF_PLAY},
    {SERIES_OF_JOINT, "ey_m", THIN_SAMPLE, CARRIED_OF_PLAY},
    {SERIES_OF_JOINT, "tilt_rad", THIN_SAMPLE, CARRIED_OF_PLAY},
    {SERIES_OF_JOINT, "coordinate", THIN_SAMPLE, CARRIED_OF_PLAY},
    {SERIES_OF_JOINT, "gap", THIN_SAMPLE, CARRIED_OF_PLAY},
    {SERIES_OF_JOINT, "gap_min", THIN_LEAST, CARRIED_OF_PLAY},
    {SERIES_OF_JOINT, "force", THIN_SAMPLE, CARRIED_OF_ALL},
    {SERIES_OF_JOINT, "force_max", THIN_MOST, CARRIED_OF_ALL},
    {SERIES_OF_JOINT, "force_x_N", THIN_SAMPLE, CARRIED_OF_PLANE},
    {SERIES_OF_JOINT, "force_y_N", THIN_SAMPLE, CARRIED_OF_PLANE},
    {SERIES_OF_RUN, "drive_torque_N_m", THIN_SAMPLE, CARRIED_OF_ALL},
};
enum { CARRIED_COUNT = sizeof CARRIED / sizeof *CARRIED };

// Of more joints without play a page carries none: their largest forces are in its tables.
enum { IDEALS_MOST = 24 };

static bool is_carried(const Carried *carried, const Trajectory *run, size_t joint)
{
    const Linkage *linkage = &run->linkage;
    if (carried->of != SERIES_OF_JOINT || trajectory_feels_play(run, &linkage->joints[joint])) {
        return true;
    }
    size_t ideals = 0;
    for (size_t i = 0; i < linkage->joint_count; i++) {
        ideals += linkage_has_play(&linkage->joints[i]) ? 0 : 1;
    }
    return ideals <= IDEALS_MOST && !linkage_is_torsional(&linkage->joints[joint]) &&
           carried->joints != CARRIED_OF_PLAY &&
           (carried->joints == CARRIED_OF_ALL || !linkage->is_spatial);
}

static const Carried *find_carried(SeriesName name, const Trajectory *run)
{
    for (size_t i = 0; i < CARRIED_COUNT; i++) {
        const Carried *carried = &CARRIED[i];
        if (carried->of == name.of && strcmp(carried->what, name.what) == 0) {
            return is_carried(carried, run, name.number) ? carried : NULL;
        }
    }
    return NULL;
}

// The samples of a run that are kept: every stride-th.
typedef struct Kept {
    const Trajectory *run;
    const SeriesColumns *columns;
    size_t stride;
    size_t count;
    double *values; // room for as many; owned
} Kept;

// The value of a column at a kept sample, or the least or largest up to the next one; the last
// stretch goes to the end of the run.
static double kept_value(const Kept *kept, size_t column, Thinning thinning, size_t number)
{
    const size_t first = number * kept->stride;
    const bool is_last = number + 1 == kept->count;
    const size_t behind = is_last ? kept->run->sample_count : first + kept->stride;
    double value = series_columns_value(kept->columns, kept->run, first, column);
    for (size_t i = first + 1; i < behind && thinning != THIN_SAMPLE && thinning != THIN_TURNING;
         i++) {
        const double next = series_columns_value(kept->columns, kept->run, i, column);
        value = thinning == THIN_LEAST ? fmin(value, next) : fmax(value, next);
    }
    return value;
}

static const char *const SERIES_WORDS[] = {
    [SERIES_OF_RUN] = "run",     [SERIES_OF_BODY] = "body", [SERIES_OF_JOINT] = "joint",
    [SERIES_OF_POINT] = "point", [SERIES_OF_RATE] = "rate",
};

static json_t *signal_json(SeriesName name, const char *what, const PackedSignal *signal)
{
    json_t *object = json_object();
    json_object_set_new(object, "name", json_value_text(name.name));
    json_object_set_new(object, "of", json_string(SERIES_WORDS[name.of]));
    json_object_set_new(object, "number", json_integer((json_int_t)name.number));
    json_object_set_new(object, "what", json_string(what));
    report_signal_place(object, signal);
    return object;
}

// Adds the difference of a column to that of the truth at the same samples.
static void add_difference(const Kept *kept, const Trajectory *truth, size_t column,
                           const char *what, Pack *pack, json_t *signals)
{
    for (size_t i = 0; i < kept->count; i++) {
        const size_t sample = i * kept->stride;
        kept->values[i] = series_columns_value(kept->columns, kept->run, sample, column) -
                          series_columns_value(kept->columns, truth, sample, column);
    }
    const PackedSignal signal = pack_add(pack, kept->values, kept->count, false);
    SeriesName name = series_columns_name(kept->columns, column);
    name.name = "";
    json_array_append_new(signals, signal_json(name, what, &signal));
}

// 1: speeds by turning below this share of a body's speed are rounding
static const double TURNING = 1e-9;

// Whether a body turns, and does not only move.
static bool is_turning(const Trajectory *run, size_t body)
{
    double speed = 0.0;
    for (size_t i = 0; i < run->sample_count; i++) {
        speed = fmax(speed, vec2_length(trajectory_motion(run, i, body)->velocity));
    }
    return trajectory_omega_scale(run, body) * run->reach[body] > TURNING * speed;
}

// Adds a signal that no column has: a value of each sample that is kept.
typedef double KeptValue(const Trajectory *run, size_t sample, size_t number);

static void add_signal(const Kept *kept, SeriesOf of, size_t number, const char *what,
                       KeptValue *value, Pack *pack, json_t *signals)
{
    for (size_t i = 0; i < kept->count; i++) {
        kept->values[i] = value(kept->run, i * kept->stride, number);
    }
    const PackedSignal signal = pack_add(pack, kept->values, kept->count, false);
    const SeriesName name = {"", of, number, what};
    json_array_append_new(signals, signal_json(name, what, &signal));
}

static double velocity_x(const Trajectory *run, size_t sample, size_t body)
{
    return trajectory_motion(run, sample, body)->velocity.x;
}

static double velocity_y(const Trajectory *run, size_t sample, size_t body)
{
    return trajectory_motion(run, sample, body)->velocity.y;
}

// How bodies stand in space, and where pins are in their holes.
#define SPACE_VALUE(name, of, member)                                                              \
    static double name(const Trajectory *run, size_t sample, size_t number)                        \
    {                                                                                              \
        return trajectory_space_##of(run, sample, number)->member;                                 \
    }
SPACE_VALUE(space_z, motion, position.z)
SPACE_VALUE(turn_w, motion, turn.w)
SPACE_VALUE(turn_x, motion, turn.x)
SPACE_VALUE(turn_y, motion, turn.y)
SPACE_VALUE(turn_z, motion, turn.z)
SPACE_VALUE(offset_z, state, offset.z)
SPACE_VALUE(force_z, state, force_on_b.z)

static void add_space(const Kept *kept, Pack *pack, json_t *signals)
{
    const Trajectory *run = kept->run;
    for (size_t i = 0; i < run->body_count; i++) {
        add_signal(kept, SERIES_OF_BODY, i, "height_m", space_z, pack, signals);
        add_signal(kept, SERIES_OF_BODY, i, "turn_w", turn_w, pack, signals);
        add_signal(kept, SERIES_OF_BODY, i, "turn_x", turn_x, pack, signals);
        add_signal(kept, SERIES_OF_BODY, i, "turn_y", turn_y, pack, signals);
        add_signal(kept, SERIES_OF_BODY, i, "turn_z", turn_z, pack, signals);
    }
    for (size_t i = 0; i < run->joint_count; i++) {
        if (trajectory_feels_play(run, &run->linkage.joints[i])) {
            add_signal(kept, SERIES_OF_JOINT, i, "offset_z_m", offset_z, pack, signals);
            add_signal(kept, SERIES_OF_JOINT, i, "load_z_N", force_z, pack, signals);
        }
    }
}

// Adds the size of the acceleration of a body's centre, at the samples and the largest up to the
// next one.
static void add_acceleration(const Kept *kept, size_t body, Pack *pack, json_t *signals)
{
    static const char *const NAMES[] = {"acceleration_m_s2", "acceleration_max_m_s2"};
    for (int which = 0; which < 2; which++) {
        for (size_t i = 0; i < kept->count; i++) {
            const size_t first = i * kept->stride;
            const bool is_last = i + 1 == kept->count;
            const size_t behind = is_last ? kept->run->sample_count : first + kept->stride;
            double value = vec2_length(trajectory_motion(kept->run, first, body)->acceleration);
            for (size_t k = first; which == 1 && k < behind; k++) {
                value = fmax(value,
                             trajectory_body_range(kept->run, k, body, RANGES_ACCELERATION).most);
            }
            kept->values[i] = value;
        }
        const PackedSignal signal = pack_add(pack, kept->values, kept->count, false);
        const SeriesName name = {"", SERIES_OF_BODY, body, NAMES[which]};
        json_array_append_new(signals, signal_json(name, name.what, &signal));
    }
}

// No column has what bushings bear: their signals and peaks have a word of their own.
static const char OF_BUSHING[] = "bushing";

static json_t *signals_json(const Kept *kept, const Trajectory *truth, Pack *pack)
{
    json_t *signals = json_array();
    const bool has_difference =
        truth != NULL && truth != kept->run && truth->sample_count == kept->run->sample_count;
    for (size_t i = 0; i < kept->columns->count; i++) {
        const SeriesName name = series_columns_name(kept->columns, i);
        const Carried *carried = find_carried(name, kept->run);
        if (carried == NULL) {
            continue;
        }
        for (size_t k = 0; k < kept->count; k++) {
            kept->values[k] = kept_value(kept, i, carried->thinning, k);
        }
        const PackedSignal signal =
            pack_add(pack, kept->values, kept->count, carried->thinning == THIN_TURNING);
        json_array_append_new(signals, signal_json(name, name.what, &signal));
        if (has_difference && strcmp(name.what, "omega_rad_s") == 0) {
            add_difference(kept, truth, i, "omega_difference_rad_s", pack, signals);
        } else if (has_difference && strcmp(name.what, "force") == 0 &&
                   trajectory_feels_play(kept->run, &kept->run->linkage.joints[name.number])) {
            add_difference(kept, truth, i, "force_difference", pack, signals);
        }
    }
    for (size_t i = 0; i < kept->run->body_count; i++) {
        if (!is_turning(kept->run, i)) {
            add_acceleration(kept, i, pack, signals);
            add_signal(kept, SERIES_OF_BODY, i, "vx_m_s", velocity_x, pack, signals);
            add_signal(kept, SERIES_OF_BODY, i, "vy_m_s", velocity_y, pack, signals);
        }
    }
    for (size_t i = 0; i < kept->run->linkage.bushing_count; i++) {
        add_signal(kept, SERIES_OF_JOINT, i, "force", bushing_force_at, pack, signals);
        json_t *signal = json_array_get(signals, json_array_size(signals) - 1);
        json_object_set_new(signal, "of", json_string(OF_BUSHING));
    }
    if (kept->run->space_motions != NULL) {
        add_space(kept, pack, signals);
    }
    return signals;
}

// How many signals of all runs are carried.
static size_t count_signals(const RunReport *report, const SeriesColumns *columns)
{
    size_t count = 0;
    for (size_t i = 0; i < report->run_count; i++) {
        for (size_t k = 0; report->runs[i]->is_complete && k < columns->count; k++) {
            count += find_carried(series_columns_name(columns, k), report->runs[i]) != NULL;
        }
    }
    return count;
}

// Peaks, exact: what 16 bits and samples left out may round, these have.

static void add_peak(json_t *peaks, SeriesOf of, size_t number, const char *what, double value,
                     double time_s)
{
    if (!isfinite(value)) {
        return;
    }
    json_t *peak = json_object();
    json_object_set_new(peak, "of", json_string(SERIES_WORDS[of]));
    json_object_set_new(peak, "number", json_integer((json_int_t)number));
    json_object_set_new(peak, "what", json_string(what));
    json_value_set(peak, "value", value);
    json_value_set(peak, "time_s", time_s);
    json_array_append_new(peaks, peak);
}

// Of samples that are left out, too.
static void add_torque_peaks(const RunReport *report, const Trajectory *run, json_t *peaks)
{
    const size_t drives = drive_torque_count(&report->scenario->linkage);
    for (size_t drive = 0; drive < drives; drive++) {
        for (int sign = -1; sign <= 1; sign += 2) {
            Extreme most = {.value = -INFINITY};
            for (size_t i = 0; i < run->sample_count; i++) {
                const double torque = drive_torque_at(report->scenario, run, drive, i);
                if (run->times[i] >= run->report_from_s && sign * torque > most.value) {
                    most = (Extreme){.value = sign * torque, .time_s = run->times[i]};
                }
            }
            add_peak(peaks, SERIES_OF_RUN, drive, "drive_torque_N_m", sign * most.value,
                     most.time_s);
        }
    }
}

static json_t *peaks_json(const RunReport *report, const Trajectory *run)
{
    json_t *peaks = json_array();
    add_torque_peaks(report, run, peaks);
    for (size_t i = 0; i < run->body_count; i++) {
        const BodyExtremes *body = &run->bodies[i];
        const struct {
            const char *what;
            const Extreme *extreme;
        } EXTREMES[] = {{"omega_rad_s", &body->omega_max},
                        {"omega_rad_s", &body->omega_min},
                        {"alpha_rad_s2", &body->alpha_max},
                        {"alpha_rad_s2", &body->alpha_min}};
        for (size_t k = 0; k < sizeof EXTREMES / sizeof *EXTREMES; k++) {
            add_peak(peaks, SERIES_OF_BODY, i, EXTREMES[k].what, EXTREMES[k].extreme->value,
                     EXTREMES[k].extreme->time_s);
        }
        const SignalSpikes *spikes = &run->alpha_spikes[i];
        for (size_t k = 0; spikes->is_known && k < spikes->kept; k++) {
            add_peak(peaks, SERIES_OF_BODY, i, "alpha_rad_s2", spikes->spikes[k].value,
                     spikes->spikes[k].time_s);
        }
    }
    for (size_t i = 0; i < run->joint_count; i++) {
        const JointExtremes *joint = &run->joints[i];
        const bool is_felt = trajectory_feels_play(run, &run->linkage.joints[i]);
        if (is_felt || !linkage_is_torsional(&run->linkage.joints[i])) {
            add_peak(peaks, SERIES_OF_JOINT, i, "force", joint->force_max.value,
                     joint->force_max.time_s);
        }
        if (!is_felt) {
            continue;
        }
        if (joint->penetration_max.value > 0.0) {
            add_peak(peaks, SERIES_OF_JOINT, i, "gap", -joint->penetration_max.value,
                     joint->penetration_max.time_s);
        }
        for (size_t k = 0; k < joint->spike_count; k++) {
            add_peak(peaks, SERIES_OF_JOINT, i, "force", joint->spikes[k].force_max,
                     joint->spikes[k].peak_s);
        }
        const SignalSpikes *spikes = &run->force_spikes[i];
        for (size_t k = 0; spikes->is_known && k < spikes->kept; k++) {
            add_peak(peaks, SERIES_OF_JOINT, i, "force", spikes->spikes[k].value,
                     spikes->spikes[k].time_s);
        }
    }
    for (size_t i = 0; i < run->linkage.bushing_count; i++) {
        const Extreme force = bushing_extremes(run, i).force;
        add_peak(peaks, SERIES_OF_JOINT, i, "force", force.value, force.time_s);
        json_t *peak = json_array_get(peaks, json_array_size(peaks) - 1);
        json_object_set_new(peak, "of", json_string(OF_BUSHING));
    }
    return peaks;
}

static json_t *spike_json(size_t joint, const char *kind, double onset_s, double peak_s,
                          double end_s, double force, double impulse)
{
    json_t *object = json_object();
    json_object_set_new(object, "joint", json_integer((json_int_t)joint));
    json_object_set_new(object, "kind", json_string(kind));
    json_value_set(object, "onset_s", onset_s);
    json_value_set(object, "peak_s", peak_s);
    json_value_set(object, "end_s", end_s);
    json_value_set(object, "force", force);
    json_value_set(object, "impulse", impulse);
    return object;
}

// The spikes of each joint's force, and its strongest contacts.
static json_t *spikes_json(const Trajectory *run)
{
    json_t *list = json_array();
    for (size_t i = 0; i < run->joint_count; i++) {
        if (!trajectory_feels_play(run, &run->linkage.joints[i])) {
            continue;
        }
        const SignalSpikes *spikes = &run->force_spikes[i];
        for (size_t k = 0; spikes->is_known && k < spikes->kept; k++) {
            const SignalSpike *spike = &spikes->spikes[k];
            json_array_append_new(list, spike_json(i, "spike", spike->onset_s, spike->time_s,
                                                   spike->end_s, spike->value, spike->impulse));
        }
        const JointExtremes *joint = &run->joints[i];
        for (size_t k = 0; k < joint->spike_count; k++) {
            const Spike *contact = &joint->spikes[k];
            json_array_append_new(list, spike_json(i, "contact", contact->onset_s, contact->peak_s,
                                                   contact->onset_s + contact->duration_s,
                                                   contact->force_max, contact->impulse));
        }
    }
    return list;
}

static json_t *run_json(const RunReport *report, const Kept *kept, const Trajectory *truth,
                        size_t marks_most, Pack *pack)
{
    const Trajectory *run = kept->run;
    const double interval_s =
        (run->sample_count > 1 ? run->times[1] - run->times[0] : 0.0) * (double)kept->stride;
    json_t *object = json_object();
    json_object_set_new(object, "backend", json_string(run->backend));
    json_object_set_new(object, "label", json_string(run->label));
    json_object_set_new(object, "is_truth", json_boolean(run == truth));
    json_value_set(object, "from_s", run->times[0]);
    json_value_set(object, "interval_s", interval_s);
    json_object_set_new(object, "stride", json_integer((json_int_t)kept->stride));
    json_object_set_new(object, "signals", signals_json(kept, truth, pack));
    json_object_set_new(object, "marks",
                        report_marks_json(run, run->times[0], interval_s, marks_most, pack));
    json_object_set_new(object, "peaks", peaks_json(report, run));
    json_object_set_new(object, "spikes", spikes_json(run));
    return object;
}

// How many marks each run of a page has at most.
static size_t marks_of_run(const RunReport *report)
{
    size_t count = 0;
    for (size_t i = 0; i < report->run_count; i++) {
        count += report->runs[i]->marked_count > 0 ? 1 : 0;
    }
    return count > 0 ? REPORT_MARKS_MOST / count : 0;
}

static json_t *runs_json(const RunReport *report, size_t values_most, Pack *pack)
{
    const Trajectory *truth = run_report_has_truth(report) ? report->truth->trajectory : NULL;
    SeriesColumns columns =
        series_columns_create(report->scenario, report->scenario->run.keeps_ranges);
    const size_t signal_count = count_signals(report, &columns);
    size_t room = signal_count > 0 ? values_most / signal_count : SAMPLES_MOST;
    room = room > SAMPLES_MOST ? SAMPLES_MOST : room;
    const size_t marks_most = marks_of_run(report);
    json_t *runs = json_array();
    for (size_t i = 0; i < report->run_count; i++) {
        const Trajectory *run = report->runs[i];
        if (!run->is_complete || run->sample_count == 0) {
            continue;
        }
        Kept kept = {.run = run, .columns = &columns};
        kept.stride = 1 + (run->sample_count - 1) / (room + 1);
        kept.count = 1 + (run->sample_count - 1) / kept.stride;
        kept.values = zeroed(kept.count, sizeof *kept.values);
        json_array_append_new(runs, run_json(report, &kept, truth, marks_most, pack));
        free(kept.values);
    }
    series_columns_finish(&columns);
    return runs;
}

static json_t *crank_json(const Driver *driver)
{
    return drive_is_steady(driver)
               ? json_pack("{s:f,s:f}", "speed_rad_s", driver->speed, "start_rad", driver->start)
               : json_null();
}

// Of a page of so many bytes, those of its script, tables, results and peaks; and of each value.
static const double PAGE_SIZE = 960e3;
static const double OTHER_SIZE = 200e3;
static const double VALUE_SIZE = 0.9;
static const double MARKS_SIZE = 2.2 * REPORT_MARKS_MOST * REPORT_MARK_VALUES; // of all marks

// How many values a page has room for beside its picture.
static size_t values_for(size_t picture_size)
{
    const double room = (PAGE_SIZE - OTHER_SIZE - MARKS_SIZE - (double)picture_size) / VALUE_SIZE;
    return (size_t)fmax(VALUES_LEAST, fmin(VALUES_MOST, room));
}

void report_data_write(const RunReport *report, const char *command, size_t picture_size,
                       Text *text)
{
    const Scenario *scenario = report->scenario;
    const Linkage *linkage = &scenario->linkage;
    Pack pack = {0};
    json_t *data = json_object();
    json_object_set_new(data, "format", json_integer(FORMAT));
    json_object_set_new(data, "title", json_value_text(scenario->title));
    json_object_set_new(data, "case", json_value_text(scenario_path(scenario)));
    json_object_set_new(data, "command", json_value_text(command));
    json_object_set_new(data, "is_spatial", json_boolean(linkage->is_spatial));
    json_object_set_new(data, "has_plane", json_boolean(space_has_plane(linkage)));
    json_object_set_new(data, "crank", crank_json(&linkage->driver));
    json_value_set(data, "duration_s", scenario_duration(scenario));
    json_value_set(data, "report_from_s", scenario_report_from(scenario));
    const bool is_limited = report->truth != NULL && report->truth->is_limited;
    json_value_set(data, "horizon_s", is_limited ? report->truth->horizon_s : NAN);
    json_object_set_new(data, "bodies", bodies_json(linkage));
    json_object_set_new(data, "joints", joints_json(linkage));
    json_object_set_new(data, "springs", springs_json(linkage));
    json_object_set_new(data, "bushings", bushings_json(linkage));
    json_object_set_new(data, "points", points_json(scenario));
    json_object_set_new(data, "runs", runs_json(report, values_for(picture_size), &pack));
    json_object_set_new(data, "results", run_json_build(report));
    Text json;
    text_init(&json);
    json_value_write(data, JSON_COMPACT | JSON_REAL_PRECISION(17), &json);
    pack_write(&pack, json.data, text);
    text_finish(&json);
    json_decref(data);
    pack_finish(&pack);
}
