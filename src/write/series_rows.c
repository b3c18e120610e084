// Finds the columns of a series: one table gives the heads and the cells.
#include "write/series_rows.h"
#include "base/zeroed.h"
#include "model/coordinate.h"
#include "model/joint_rows.h"
#include "model/loads.h"
#include "run/drive_torque.h"
#include "write/units.h"

#include <assert.h>
#include <fnmatch.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { COLUMN_NAME_SIZE = LINKAGE_NAME_SIZE + 48, COMPONENTS_MOST = 3 };

// One number at one sample: of the run, or of a body, a joint, a point or a rate.
typedef struct SeriesPlace {
    const SeriesColumns *columns;
    const Linkage *linkage;
    const Trajectory *trajectory;
    size_t sample;
    size_t number; // of the body, joint, point or rate
    int component; // of a rate
} SeriesPlace;

typedef double SeriesFind(const SeriesPlace *place);

struct SeriesColumn {
    char name[COLUMN_NAME_SIZE];
    SeriesOf of;
    const char *what; // the name of its row below; of a number of the run its whole name
    SeriesFind *find;
    size_t number;
    int component;
};

typedef enum SeriesUnit {
    SERIES_AS_NAMED, // it stands in the name
    SERIES_FORCE,    // N, or N m where limits turn the joint
    SERIES_LENGTH,   // m, or rad
} SeriesUnit;

// What is written of each body, joint or point.
typedef struct SeriesRow {
    const char *name;
    SeriesUnit unit;
    bool (*has)(const Scenario *scenario, size_t joint); // NULL: all of them
    SeriesFind *find;
} SeriesRow;

// Which joints have a column.

static const Joint *joint_of(const Scenario *scenario, size_t joint)
{
    return &scenario->linkage.joints[joint];
}

static bool slides(const Scenario *scenario, size_t joint)
{
    return joint_slides(joint_of(scenario, joint)->kind);
}

static bool is_guide(const Scenario *scenario, size_t joint)
{
    return joint_has_guides(joint_of(scenario, joint)->kind);
}

static bool is_pin(const Scenario *scenario, size_t joint)
{
    return joint_has_hole(joint_of(scenario, joint)->kind);
}

static bool has_limits(const Scenario *scenario, size_t joint)
{
    return joint_of(scenario, joint)->limits.kind != LIMIT_NONE;
}

static bool has_play(const Scenario *scenario, size_t joint)
{
    return linkage_has_play(joint_of(scenario, joint));
}

// Whether a body's speed can change: that of a drive of constant speed cannot.
static bool speeds_up(const Scenario *scenario, size_t body)
{
    const Linkage *linkage = &scenario->linkage;
    const int drive = linkage_drive_of_body(linkage, (int)body);
    return drive < 0 || linkage_drive(linkage, (size_t)drive)->table.count > 0;
}

// Whether a moment comes with the force at the anchor of body b that is not a slider's: of limits,
// of teeth, of friction at the wall of a hole or stop.
static bool turns(const Scenario *scenario, size_t joint)
{
    const Joint *of = joint_of(scenario, joint);
    const double friction = scenario_friction(scenario, of);
    const bool is_circle = joint_has_hole(of->kind) || joint_has_disc(of->kind);
    return linkage_is_torsional(of) || joint_has_teeth(of->kind) || (is_circle && friction > 0.0);
}

// Numbers of the run, of bodies and of points.

static const Motion *motions_at(const SeriesPlace *place)
{
    return trajectory_motion(place->trajectory, place->sample, 0);
}

static double crank_deg(const SeriesPlace *place)
{
    return place->trajectory->crank_angles[place->sample] * UNITS_DEG;
}

static double point_x(const SeriesPlace *place)
{
    const TracedPoint *point = &place->columns->scenario->points[place->number];
    return linkage_point(motions_at(place), point->body, point->local).x;
}

static double point_y(const SeriesPlace *place)
{
    const TracedPoint *point = &place->columns->scenario->points[place->number];
    return linkage_point(motions_at(place), point->body, point->local).y;
}

// Numbers of joints.

static double slide_acceleration(const SeriesPlace *place)
{
    const Joint *joint = &place->linkage->joints[place->number];
    const Motion *motions = motions_at(place);
    const int body = joint->body_b == LINKAGE_GROUND ? joint->body_a : joint->body_b;
    const Vec2 along = joint_rows_along(place->linkage, motions, (int)place->number);
    return vec2_dot(along, motions[body].acceleration);
}

static const JointState *joint_at(const SeriesPlace *place)
{
    return trajectory_state(place->trajectory, place->sample, place->number);
}

// Of a block the vector sum of the forces whose sizes its force adds up.
static double resultant(const SeriesPlace *place)
{
    return vec2_length(joint_at(place)->force_on_b);
}

// The coordinate of a joint that has limits, whichever of its kind.
static double coordinate(const SeriesPlace *place)
{
    return place->linkage->is_spatial
               ? joint_at(place)->tilt
               : coordinate_position(place->linkage, motions_at(place), (int)place->number);
}

// A vector in the frame of the joint's body a, which has the hole.
static Vec2 in_hole(const SeriesPlace *place, Vec2 vector)
{
    const int body = place->linkage->joints[place->number].body_a;
    const double angle = body == LINKAGE_GROUND ? 0.0 : motions_at(place)[body].angle;
    return vec2_rotate(-angle, vector);
}

static double hole_force_x(const SeriesPlace *place)
{
    return in_hole(place, joint_at(place)->force_on_b).x;
}

static double hole_force_y(const SeriesPlace *place)
{
    return in_hole(place, joint_at(place)->force_on_b).y;
}

// Where on the wall of its hole the pin is pressed, from the x axis of body a; none apart from it.
static double wall_deg(const SeriesPlace *place)
{
    const Vec2 at = in_hole(place, joint_at(place)->eccentricity);
    return joint_at(place)->is_touching ? atan2(at.y, at.x) * UNITS_DEG : NAN;
}

static double torque_of_drive(const SeriesPlace *place)
{
    return drive_torque_at(place->columns->scenario, place->trajectory, place->number,
                           place->sample);
}

static double load_of(const SeriesPlace *place)
{
    const double time_s = place->trajectory->times[place->sample];
    return load_value(place->linkage, &place->linkage->loads[place->number], motions_at(place),
                      time_s, time_s);
}

static double rate(const SeriesPlace *place)
{
    const DistanceMeasure *rates = &place->columns->rates;
    const Vec3 value = distance_value(rates->linkage, &rates->rates[place->number],
                                      distance_motion_at(place->trajectory, place->sample));
    return place->component == 0 ? value.x : place->component == 1 ? value.y : value.z;
}

// clang-format off
#define FINDER(name, value) \
    static double name(const SeriesPlace *place) \
    { \
        return value; \
    }
#define BODY(member) motions_at(place)[place->number].member
#define SPACE_BODY(member) \
    trajectory_space_motion(place->trajectory, place->sample, place->number)->member
#define SPACE_JOINT(member) \
    trajectory_space_state(place->trajectory, place->sample, place->number)->member
#define BODY_RANGE(which) \
    trajectory_body_range(place->trajectory, place->sample, place->number, which)
#define JOINT_RANGE(which) \
    trajectory_joint_range(place->trajectory, place->sample, place->number, which)

FINDER(time_s, place->trajectory->times[place->sample])
FINDER(body_x, BODY(position.x))
FINDER(body_y, BODY(position.y))
FINDER(body_angle, BODY(angle))
FINDER(body_omega, BODY(omega))
FINDER(body_alpha, BODY(alpha))
FINDER(body_ax, BODY(acceleration.x))
FINDER(body_ay, BODY(acceleration.y))
FINDER(body_z, SPACE_BODY(position.z))
FINDER(body_omega_x, SPACE_BODY(omega.x))
FINDER(body_omega_y, SPACE_BODY(omega.y))
FINDER(body_az, SPACE_BODY(acceleration.z))
FINDER(body_alpha_x, SPACE_BODY(alpha.x))
FINDER(body_alpha_y, SPACE_BODY(alpha.y))
FINDER(eccentricity_x, joint_at(place)->eccentricity.x)
FINDER(eccentricity_y, joint_at(place)->eccentricity.y)
FINDER(hole_eccentricity_x, in_hole(place, joint_at(place)->eccentricity).x)
FINDER(hole_eccentricity_y, in_hole(place, joint_at(place)->eccentricity).y)
FINDER(gap, joint_at(place)->gap)
FINDER(force, joint_at(place)->force)
FINDER(force_x, joint_at(place)->force_on_b.x)
FINDER(force_y, joint_at(place)->force_on_b.y)
FINDER(tilt, joint_at(place)->tilt)
FINDER(moment, joint_moment(place->linkage, motions_at(place), place->number, joint_at(place)))
FINDER(pin_tilt, SPACE_JOINT(tilt))
FINDER(pin_axial, SPACE_JOINT(axial))
FINDER(pin_axial_force, SPACE_JOINT(axial_force))
FINDER(gap_back, SPACE_JOINT(end_gaps[0]))
FINDER(gap_front, SPACE_JOINT(end_gaps[1]))
FINDER(force_back, SPACE_JOINT(end_forces[0]))
FINDER(force_front, SPACE_JOINT(end_forces[1]))
FINDER(force_z, SPACE_JOINT(force_on_b.z))
FINDER(omega_min, BODY_RANGE(RANGES_OMEGA).least)
FINDER(omega_max, BODY_RANGE(RANGES_OMEGA).most)
FINDER(alpha_min, BODY_RANGE(RANGES_ALPHA).least)
FINDER(alpha_max, BODY_RANGE(RANGES_ALPHA).most)
FINDER(gap_min, JOINT_RANGE(RANGES_GAP).least)
FINDER(gap_max, JOINT_RANGE(RANGES_GAP).most)
FINDER(force_min, JOINT_RANGE(RANGES_FORCE).least)
FINDER(force_max, JOINT_RANGE(RANGES_FORCE).most)

// The columns, in the order in which they are written: all rows of a table for one body or joint
// after another.

static const SeriesRow OF_BODIES[] = {
    {"angle_rad", SERIES_AS_NAMED, NULL, body_angle},
    {"omega_rad_s", SERIES_AS_NAMED, NULL, body_omega},
    {"alpha_rad_s2", SERIES_AS_NAMED, NULL, body_alpha},
    {0},
};
static const SeriesRow OF_JOINTS[] = {
    {"ex_m", SERIES_AS_NAMED, NULL, eccentricity_x},
    {"ey_m", SERIES_AS_NAMED, NULL, eccentricity_y},
    {"gap", SERIES_LENGTH, NULL, gap},
    {"force", SERIES_FORCE, NULL, force},
    {0},
};
static const SeriesRow OF_POINTS[] = {
    {"x_m", SERIES_AS_NAMED, NULL, point_x},
    {"y_m", SERIES_AS_NAMED, NULL, point_y},
    {0},
};
// what a slider has more than a pin
static const SeriesRow OF_SLIDERS[] = {
    {"tilt_rad", SERIES_AS_NAMED, slides, tilt},
    {"moment_N_m", SERIES_AS_NAMED, slides, moment},
    {"slide_acceleration_m_s2", SERIES_AS_NAMED, slides, slide_acceleration},
    {"resultant_N", SERIES_AS_NAMED, is_guide, resultant},
    {0},
};
static const SeriesRow OF_LIMITS[] = {
    {"coordinate", SERIES_LENGTH, has_limits, coordinate},
    {0},
};
static const SeriesRow OF_BODIES_IN_SPACE[] = {
    {"z_m", SERIES_AS_NAMED, NULL, body_z},
    {"omega_x_rad_s", SERIES_AS_NAMED, NULL, body_omega_x},
    {"omega_y_rad_s", SERIES_AS_NAMED, NULL, body_omega_y},
    {0},
};
static const SeriesRow OF_PINS_IN_SPACE[] = {
    {"tilt_rad", SERIES_AS_NAMED, is_pin, pin_tilt},
    {"axial_m", SERIES_AS_NAMED, is_pin, pin_axial},
    {"axial_force_N", SERIES_AS_NAMED, is_pin, pin_axial_force},
    {"gap_back_m", SERIES_AS_NAMED, is_pin, gap_back},
    {"gap_front_m", SERIES_AS_NAMED, is_pin, gap_front},
    {"force_back_N", SERIES_AS_NAMED, is_pin, force_back},
    {"force_front_N", SERIES_AS_NAMED, is_pin, force_front},
    {0},
};
// what Newton's law of a body asks for beside its mass: where its centre is and how that moves
static const SeriesRow OF_CENTRES[] = {
    {"x_m", SERIES_AS_NAMED, NULL, body_x},
    {"y_m", SERIES_AS_NAMED, NULL, body_y},
    {"ax_m_s2", SERIES_AS_NAMED, NULL, body_ax},
    {"ay_m_s2", SERIES_AS_NAMED, NULL, body_ay},
    {0},
};
static const SeriesRow OF_CENTRES_IN_SPACE[] = {
    {"az_m_s2", SERIES_AS_NAMED, NULL, body_az},
    {"alpha_x_rad_s2", SERIES_AS_NAMED, NULL, body_alpha_x},
    {"alpha_y_rad_s2", SERIES_AS_NAMED, NULL, body_alpha_y},
    {0},
};
// and the forces on it
static const SeriesRow OF_FORCES[] = {
    {"force_x_N", SERIES_AS_NAMED, NULL, force_x},
    {"force_y_N", SERIES_AS_NAMED, NULL, force_y},
    {0},
};
static const SeriesRow OF_FORCES_IN_PLANE[] = {
    {"moment_N_m", SERIES_AS_NAMED, turns, moment},
    {"hole_ex_m", SERIES_AS_NAMED, is_pin, hole_eccentricity_x},
    {"hole_ey_m", SERIES_AS_NAMED, is_pin, hole_eccentricity_y},
    {"hole_force_x_N", SERIES_AS_NAMED, is_pin, hole_force_x},
    {"hole_force_y_N", SERIES_AS_NAMED, is_pin, hole_force_y},
    {"wall_deg", SERIES_AS_NAMED, is_pin, wall_deg},
    {0},
};
static const SeriesRow OF_FORCES_IN_SPACE[] = {
    {"force_z_N", SERIES_AS_NAMED, NULL, force_z},
    {0},
};
static const SeriesRow OF_BODIES_BETWEEN[] = {
    {"omega_min_rad_s", SERIES_AS_NAMED, speeds_up, omega_min},
    {"omega_max_rad_s", SERIES_AS_NAMED, speeds_up, omega_max},
    {"alpha_min_rad_s2", SERIES_AS_NAMED, speeds_up, alpha_min},
    {"alpha_max_rad_s2", SERIES_AS_NAMED, speeds_up, alpha_max},
    {0},
};
static const SeriesRow OF_JOINTS_BETWEEN[] = {
    {"gap_min", SERIES_LENGTH, has_play, gap_min},
    {"gap_max", SERIES_LENGTH, has_play, gap_max},
    {"force_min", SERIES_FORCE, NULL, force_min},
    {"force_max", SERIES_FORCE, NULL, force_max},
    {0},
};
// clang-format on

// A name that is looked for among columns.
typedef struct SoughtColumn {
    const SeriesColumn *columns;
    const char *name;
} SoughtColumn;

static bool is_sought(size_t number, const void *sought)
{
    const SoughtColumn *of = sought;
    return strcmp(of->columns[number].name, of->name) == 0;
}

static bool has_column(const SeriesColumns *columns, const char *name)
{
    const SoughtColumn sought = {columns->columns, name};
    return lookup_find(&columns->names, lookup_hash(name), is_sought, &sought) != LOOKUP_NONE;
}

// Adds a column. A body and a point, say, may share their name: the later column then ends in _2.
static void add_column(SeriesColumns *columns, SeriesColumn column)
{
    char name[COLUMN_NAME_SIZE];
    memcpy(name, column.name, sizeof name);
    for (int i = 2; has_column(columns, column.name); i++) {
        snprintf(column.name, sizeof column.name, "%.*s_%d", COLUMN_NAME_SIZE - 16, name, i);
    }
    if (columns->count == columns->room) {
        columns->room = columns->room > 0 ? 2 * columns->room : 128;
        columns->columns = realloc(columns->columns, columns->room * sizeof *columns->columns);
        assert(columns->columns != NULL);
    }
    lookup_add(&columns->names, lookup_hash(column.name), columns->count);
    columns->columns[columns->count++] = column;
}

// Adds the columns that a table has of one body, joint or point.
static void add_rows(SeriesColumns *columns, const SeriesRow *rows, SeriesOf kind, const char *of,
                     size_t number, const JointUnits *units)
{
    for (const SeriesRow *row = rows; row->name != NULL; row++) {
        if (row->has != NULL && !row->has(columns->scenario, number)) {
            continue;
        }
        SeriesColumn column = {.of = kind, .what = row->name, .find = row->find, .number = number};
        const char *unit = row->unit == SERIES_AS_NAMED ? ""
                           : row->unit == SERIES_FORCE  ? units->force_key
                                                        : units->length_key;
        snprintf(column.name, sizeof column.name, "%s_%s%s%s", of, row->name,
                 row->unit == SERIES_AS_NAMED ? "" : "_", unit);
        add_column(columns, column);
    }
}

static void add_bodies(SeriesColumns *columns, const SeriesRow *rows)
{
    const Linkage *linkage = &columns->scenario->linkage;
    for (size_t i = 0; i < linkage->body_count; i++) {
        add_rows(columns, rows, SERIES_OF_BODY, linkage->bodies[i].name, i, NULL);
    }
}

static void add_joints(SeriesColumns *columns, const SeriesRow *rows)
{
    const Linkage *linkage = &columns->scenario->linkage;
    for (size_t i = 0; i < linkage->joint_count; i++) {
        const Joint *joint = &linkage->joints[i];
        add_rows(columns, rows, SERIES_OF_JOINT, joint->name, i, joint_units(joint));
    }
}

// Names a component of a rate: x, y, z of a vector.
static void name_rate(const Linkage *linkage, const DistanceRate *of, SeriesColumn *column)
{
    static const char *const AXES[] = {"x", "y", "z"};
    const bool is_of_body = of->kind == DISTANCE_MOVING;
    const char *name =
        is_of_body ? linkage->bodies[of->number].name : linkage->joints[of->number].name;
    const char *axis = AXES[column->component];
    const bool is_scalar = distance_components(linkage, of) == 1;
    if (of->kind == DISTANCE_TILT && is_scalar) {
        snprintf(column->name, sizeof column->name, "%s_tilt_rate_rad_s", name);
    } else if (of->kind == DISTANCE_TILT) {
        snprintf(column->name, sizeof column->name, "%s_tilt_rate_%s_rad_s", name, axis);
    } else if (is_scalar) {
        snprintf(column->name, sizeof column->name, "%s_rate_%s", name,
                 of->reach > 0.0 ? "rad_s" : "m_s");
    } else {
        snprintf(column->name, sizeof column->name, "%s_v%s_m_s", name, axis);
    }
}

// The rates by which motions are compared, but for what is written of every body anyway.
static void add_rates(SeriesColumns *columns)
{
    const DistanceMeasure *rates = &columns->rates;
    for (size_t i = 0; i < rates->count; i++) {
        const int count = distance_components(rates->linkage, &rates->rates[i]);
        for (int k = 0; rates->rates[i].kind != DISTANCE_TURNING && k < count; k++) {
            SeriesColumn column = {
                .of = SERIES_OF_RATE, .what = "", .find = rate, .number = i, .component = k};
            name_rate(rates->linkage, &rates->rates[i], &column);
            add_column(columns, column);
        }
    }
}

// The torque of the drive, or of each of several: those beside the crank's have the names of their
// joints.
static void add_torques(SeriesColumns *columns)
{
    const Linkage *linkage = &columns->scenario->linkage;
    for (size_t i = 0; i == 0 || i < linkage_drive_count(linkage); i++) {
        SeriesColumn column = {.what = "drive_torque_N_m", .find = torque_of_drive, .number = i};
        if (i == 0) {
            text_copy(column.name, sizeof column.name, column.what);
        } else {
            snprintf(column.name, sizeof column.name, "%s_%s",
                     linkage->joints[linkage_drive(linkage, i)->joint].name, column.what);
        }
        add_column(columns, column);
    }
}

SeriesColumns series_columns_create(const Scenario *scenario, bool has_ranges)
{
    SeriesColumns columns = {
        .scenario = scenario,
        .rates = distance_rates(&scenario->linkage),
    };
    const bool is_spatial = scenario->linkage.is_spatial;
    add_column(&columns, (SeriesColumn){.name = "time_s", .what = "time_s", .find = time_s});
    add_column(&columns,
               (SeriesColumn){.name = "crank_deg", .what = "crank_deg", .find = crank_deg});
    add_bodies(&columns, OF_BODIES);
    add_joints(&columns, OF_JOINTS);
    for (size_t i = 0; i < scenario->point_count; i++) {
        add_rows(&columns, OF_POINTS, SERIES_OF_POINT, scenario->points[i].name, i, NULL);
    }
    add_joints(&columns, OF_SLIDERS);
    add_joints(&columns, OF_LIMITS);
    if (is_spatial) {
        add_bodies(&columns, OF_BODIES_IN_SPACE);
        add_joints(&columns, OF_PINS_IN_SPACE);
    }
    add_rates(&columns);
    add_bodies(&columns, OF_CENTRES);
    if (is_spatial) {
        add_bodies(&columns, OF_CENTRES_IN_SPACE);
    }
    add_joints(&columns, OF_FORCES);
    add_joints(&columns, is_spatial ? OF_FORCES_IN_SPACE : OF_FORCES_IN_PLANE);
    if (drive_torque_exists(&scenario->linkage)) {
        add_torques(&columns);
    }
    for (size_t i = 0; i < scenario->linkage.load_count; i++) {
        const Load *load = &scenario->linkage.loads[i];
        const char *what = load_is_force(&scenario->linkage, load) ? "load_N" : "load_N_m";
        SeriesColumn column = {.what = what, .find = load_of, .number = i};
        snprintf(column.name, sizeof column.name, "%s_%s", load->name, what);
        add_column(&columns, column);
    }
    if (has_ranges) {
        add_bodies(&columns, OF_BODIES_BETWEEN);
        add_joints(&columns, OF_JOINTS_BETWEEN);
    }
    return columns;
}

void series_columns_finish(SeriesColumns *columns)
{
    distance_finish(&columns->rates);
    lookup_finish(&columns->names);
    free(columns->columns);
    *columns = (SeriesColumns){0};
}

// Takes the next of the patterns, without the blanks around it; false where there is none.
static bool next_pattern(const char **patterns, char pattern[COLUMN_NAME_SIZE])
{
    const char *from = *patterns;
    if (from == NULL) {
        return false;
    }
    const char *comma = strchr(from, ',');
    from += strspn(from, " ");
    size_t size = comma != NULL ? (size_t)(comma - from) : strlen(from);
    while (size > 0 && from[size - 1] == ' ') {
        size--;
    }
    snprintf(pattern, COLUMN_NAME_SIZE, "%.*s", (int)size, from);
    *patterns = comma != NULL ? comma + 1 : NULL;
    return true;
}

static bool is_chosen(const SeriesColumn *column, const char *patterns)
{
    char pattern[COLUMN_NAME_SIZE];
    while (next_pattern(&patterns, pattern)) {
        if (fnmatch(pattern, column->name, 0) == 0) {
            return true;
        }
    }
    return false;
}

void series_columns_choose(SeriesColumns *columns, const char *patterns)
{
    size_t kept = 1; // the time
    for (size_t i = kept; i < columns->count; i++) {
        if (is_chosen(&columns->columns[i], patterns)) {
            columns->columns[kept++] = columns->columns[i];
        }
    }
    columns->count = kept;
}

// The names of all columns; the caller frees them.
static const char **names_of(const SeriesColumns *columns)
{
    const char **names = zeroed(columns->count, sizeof *names);
    for (size_t i = 0; i < columns->count; i++) {
        names[i] = columns->columns[i].name;
    }
    return names;
}

// Says that no column is called so, and which might be meant.
static bool fail_unknown(const SeriesColumns *columns, const char *pattern, Err *err)
{
    const char **names = names_of(columns);
    const char *nearest = text_nearest(pattern, names, columns->count);
    err_set(err, ERR_USAGE,
            "--columns: no column is called '%s'; %s%s%s* stands for any letters, and the file "
            "without --columns begins with all names",
            pattern, nearest != NULL ? "did you mean '" : "", nearest != NULL ? nearest : "",
            nearest != NULL ? "'? " : "");
    free(names);
    return false;
}

bool series_columns_check(const SeriesColumns *columns, const char *patterns, Err *err)
{
    char pattern[COLUMN_NAME_SIZE];
    while (next_pattern(&patterns, pattern)) {
        size_t found = 0;
        for (size_t i = 0; i < columns->count; i++) {
            found += fnmatch(pattern, columns->columns[i].name, 0) == 0;
        }
        if (found == 0) {
            return fail_unknown(columns, pattern, err);
        }
    }
    return true;
}

SeriesName series_columns_name(const SeriesColumns *columns, size_t number)
{
    const SeriesColumn *column = &columns->columns[number];
    return (SeriesName){column->name, column->of, column->number, column->what};
}

double series_columns_value(const SeriesColumns *columns, const Trajectory *trajectory,
                            size_t sample, size_t number)
{
    const SeriesColumn *column = &columns->columns[number];
    const SeriesPlace place = {
        .columns = columns,
        .linkage = &columns->scenario->linkage,
        .trajectory = trajectory,
        .sample = sample,
        .number = column->number,
        .component = column->component,
    };
    return column->find(&place);
}
