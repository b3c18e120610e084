// Writes the rows of a series.
#include "write/series_rows.h"
#include "model/coordinate.h"
#include "model/distance.h"
#include "model/joint_rows.h"
#include "write/csv.h"
#include "write/units.h"

#include <stdio.h>

enum { RATE_COLUMNS_MOST = 3, RATE_COLUMN_SIZE = LINKAGE_NAME_SIZE + 32 };

// The columns that hold rates.

static const char *const AXES[] = {"x", "y", "z"};

// Of an angular velocity in space the part about z is the one that the plane has, without a letter.
static void name_of_turning(const char *body, int component, bool is_spatial,
                            char name[RATE_COLUMN_SIZE])
{
    if (is_spatial && component < 2) {
        snprintf(name, RATE_COLUMN_SIZE, "%s_omega_%s_rad_s", body, AXES[component]);
    } else {
        snprintf(name, RATE_COLUMN_SIZE, "%s_omega_rad_s", body);
    }
}

// Writes the names of a rate's columns, in the order of its components: x, y, z of a vector.
// Returns how many there are.
static int rate_columns(const Linkage *linkage, const DistanceRate *rate,
                        char names[RATE_COLUMNS_MOST][RATE_COLUMN_SIZE])
{
    const bool is_of_body = rate->kind == DISTANCE_TURNING || rate->kind == DISTANCE_MOVING;
    const char *of =
        is_of_body ? linkage->bodies[rate->number].name : linkage->joints[rate->number].name;
    const int count = distance_components(linkage, rate);
    for (int i = 0; i < count; i++) {
        if (rate->kind == DISTANCE_TURNING) {
            name_of_turning(of, i, linkage->is_spatial, names[i]);
        } else if (rate->kind == DISTANCE_TILT && count == 1) {
            snprintf(names[i], RATE_COLUMN_SIZE, "%s_tilt_rate_rad_s", of);
        } else if (rate->kind == DISTANCE_TILT) {
            snprintf(names[i], RATE_COLUMN_SIZE, "%s_tilt_rate_%s_rad_s", of, AXES[i]);
        } else if (count == 1) {
            snprintf(names[i], RATE_COLUMN_SIZE, "%s_rate_%s", of,
                     rate->reach > 0.0 ? "rad_s" : "m_s");
        } else {
            snprintf(names[i], RATE_COLUMN_SIZE, "%s_v%s_m_s", of, AXES[i]);
        }
    }
    return count;
}

static void write_range_heads(const Linkage *linkage, FILE *stream)
{
    for (size_t i = 0; i < linkage->body_count; i++) {
        const char *name = linkage->bodies[i].name;
        fprintf(stream, ",%s_omega_min_rad_s,%s_omega_max_rad_s", name, name);
        fprintf(stream, ",%s_alpha_min_rad_s2,%s_alpha_max_rad_s2", name, name);
    }
    for (size_t i = 0; i < linkage->joint_count; i++) {
        const char *name = linkage->joints[i].name;
        const JointUnits *units = joint_units(&linkage->joints[i]);
        const char *length = units->length_key;
        const char *force = units->force_key;
        fprintf(stream, ",%s_gap_min_%s,%s_gap_max_%s", name, length, name, length);
        fprintf(stream, ",%s_force_min_%s,%s_force_max_%s", name, force, name, force);
    }
}

// Each number behind the comma that ends the cell before it.
static void write_cells(const double *numbers, size_t count, FILE *stream)
{
    for (size_t i = 0; i < count; i++) {
        fputc(',', stream);
        csv_write_number(stream, numbers[i]);
    }
}

static void write_range(Range range, FILE *stream)
{
    write_cells((const double[]){range.least, range.most}, 2, stream);
}

// From this sample to the next.
static void write_ranges(const Trajectory *trajectory, size_t sample, FILE *stream)
{
    for (size_t i = 0; i < trajectory->body_count; i++) {
        write_range(trajectory_body_range(trajectory, sample, i, RANGES_OMEGA), stream);
        write_range(trajectory_body_range(trajectory, sample, i, RANGES_ALPHA), stream);
    }
    for (size_t i = 0; i < trajectory->joint_count; i++) {
        write_range(trajectory_joint_range(trajectory, sample, i, RANGES_GAP), stream);
        write_range(trajectory_joint_range(trajectory, sample, i, RANGES_FORCE), stream);
    }
}

// What is written of joints: a row gives the column's name, its unit, which joints have it, and its
// value.

// One joint at one sample.
typedef struct SeriesPlace {
    const Linkage *linkage;
    const Trajectory *trajectory;
    size_t sample;
    size_t joint;
    const JointState *state;
    const SpaceJointState *space; // NULL in the plane
} SeriesPlace;

typedef enum SeriesUnit {
    SERIES_AS_NAMED, // it stands in the name
    SERIES_FORCE,    // N, or N m where limits turn the joint
    SERIES_LENGTH,   // m, or rad
} SeriesUnit;

typedef struct SeriesColumn {
    const char *name;
    SeriesUnit unit;
    bool (*has)(const Joint *joint); // NULL: every joint
    double (*find)(const SeriesPlace *place);
} SeriesColumn;

static bool series_slides(const Joint *joint)
{
    return joint->kind == JOINT_PRISMATIC || joint->kind == JOINT_GUIDE;
}

static bool series_is_guide(const Joint *joint)
{
    return joint->kind == JOINT_GUIDE;
}

static bool series_is_pin(const Joint *joint)
{
    return joint->kind == JOINT_CLEARANCE;
}

static bool series_has_limits(const Joint *joint)
{
    return joint->limits.kind != LIMIT_NONE;
}

static double series_slide_acceleration(const SeriesPlace *place)
{
    const Joint *joint = &place->linkage->joints[place->joint];
    const Motion *motions = trajectory_motion(place->trajectory, place->sample, 0);
    const int body = joint->body_b == LINKAGE_GROUND ? joint->body_a : joint->body_b;
    const Vec2 along = joint_rows_along(place->linkage, motions, (int)place->joint);
    return vec2_dot(along, motions[body].acceleration);
}

// Of a block the vector sum of the forces whose sizes its force adds up.
static double series_resultant(const SeriesPlace *place)
{
    return vec2_length(place->state->force_on_b);
}

// The coordinate of a joint that has limits, whichever of its kind.
static double series_coordinate(const SeriesPlace *place)
{
    return place->linkage->is_spatial
               ? place->state->tilt
               : coordinate_position(place->linkage,
                                     trajectory_motion(place->trajectory, place->sample, 0),
                                     (int)place->joint);
}

// clang-format off
#define FINDER(name, member) \
    static double series_##name(const SeriesPlace *place) \
    { \
        return place->member; \
    }
FINDER(eccentricity_x, state->eccentricity.x)
FINDER(eccentricity_y, state->eccentricity.y)
FINDER(gap, state->gap)
FINDER(force, state->force)
FINDER(tilt, state->tilt)
FINDER(moment, state->moment_on_b)
FINDER(pin_tilt, space->tilt)
FINDER(pin_axial, space->axial)
FINDER(pin_axial_force, space->axial_force)
FINDER(gap_back, space->end_gaps[0])
FINDER(gap_front, space->end_gaps[1])
FINDER(force_back, space->end_forces[0])
FINDER(force_front, space->end_forces[1])

static const SeriesColumn OF_JOINTS[] = {
    {"ex_m", SERIES_AS_NAMED, NULL, series_eccentricity_x},
    {"ey_m", SERIES_AS_NAMED, NULL, series_eccentricity_y},
    {"gap", SERIES_LENGTH, NULL, series_gap},
    {"force", SERIES_FORCE, NULL, series_force},
    {0},
};
// what a slider has more than a pin
static const SeriesColumn OF_SLIDERS[] = {
    {"tilt_rad", SERIES_AS_NAMED, series_slides, series_tilt},
    {"moment_N_m", SERIES_AS_NAMED, series_slides, series_moment},
    {"slide_acceleration_m_s2", SERIES_AS_NAMED, series_slides, series_slide_acceleration},
    {"resultant_N", SERIES_AS_NAMED, series_is_guide, series_resultant},
    {0},
};
static const SeriesColumn OF_LIMITS[] = {
    {"coordinate", SERIES_LENGTH, series_has_limits, series_coordinate},
    {0},
};
static const SeriesColumn OF_PINS_IN_SPACE[] = {
    {"tilt_rad", SERIES_AS_NAMED, series_is_pin, series_pin_tilt},
    {"axial_m", SERIES_AS_NAMED, series_is_pin, series_pin_axial},
    {"axial_force_N", SERIES_AS_NAMED, series_is_pin, series_pin_axial_force},
    {"gap_back_m", SERIES_AS_NAMED, series_is_pin, series_gap_back},
    {"gap_front_m", SERIES_AS_NAMED, series_is_pin, series_gap_front},
    {"force_back_N", SERIES_AS_NAMED, series_is_pin, series_force_back},
    {"force_front_N", SERIES_AS_NAMED, series_is_pin, series_force_front},
    {0},
};
// clang-format on

static bool series_column_is_of(const SeriesColumn *column, const Joint *joint)
{
    return column->has == NULL || column->has(joint);
}

static void write_joint_heads(const SeriesColumn *columns, const Linkage *linkage, FILE *stream)
{
    for (size_t i = 0; i < linkage->joint_count; i++) {
        const Joint *joint = &linkage->joints[i];
        const JointUnits *units = joint_units(joint);
        for (const SeriesColumn *column = columns; column->name != NULL; column++) {
            if (series_column_is_of(column, joint)) {
                fprintf(stream, ",%s_%s%s%s", joint->name, column->name,
                        column->unit == SERIES_AS_NAMED ? "" : "_",
                        column->unit == SERIES_AS_NAMED ? ""
                        : column->unit == SERIES_FORCE  ? units->force_key
                                                        : units->length_key);
            }
        }
    }
}

static void write_joint_cells(const SeriesColumn *columns, const Linkage *linkage,
                              const Trajectory *trajectory, size_t sample, FILE *stream)
{
    for (size_t i = 0; i < linkage->joint_count; i++) {
        const SeriesPlace place = {
            .linkage = linkage,
            .trajectory = trajectory,
            .sample = sample,
            .joint = i,
            .state = trajectory_state(trajectory, sample, i),
            .space = linkage->is_spatial ? trajectory_space_state(trajectory, sample, i) : NULL,
        };
        for (const SeriesColumn *column = columns; column->name != NULL; column++) {
            if (series_column_is_of(column, &linkage->joints[i])) {
                const double value = column->find(&place);
                write_cells(&value, 1, stream);
            }
        }
    }
}

// What a linkage in space has more than one in the plane.
static void write_space_heads(const Linkage *linkage, FILE *stream)
{
    for (size_t i = 0; i < linkage->body_count; i++) {
        const char *name = linkage->bodies[i].name;
        fprintf(stream, ",%s_z_m,%s_omega_x_rad_s,%s_omega_y_rad_s", name, name, name);
    }
    write_joint_heads(OF_PINS_IN_SPACE, linkage, stream);
}

static void write_space(const Linkage *linkage, const Trajectory *trajectory, size_t sample,
                        FILE *stream)
{
    for (size_t i = 0; i < linkage->body_count; i++) {
        const SpaceMotion *motion = trajectory_space_motion(trajectory, sample, i);
        write_cells((const double[]){motion->position.z, motion->omega.x, motion->omega.y}, 3,
                    stream);
    }
    write_joint_cells(OF_PINS_IN_SPACE, linkage, trajectory, sample, stream);
}

// The rates by which motions are compared, but for what is written of every body anyway.
static void write_rate_heads(const DistanceMeasure *rates, FILE *stream)
{
    char names[RATE_COLUMNS_MOST][RATE_COLUMN_SIZE];
    for (size_t i = 0; i < rates->count; i++) {
        const int count = rate_columns(rates->linkage, &rates->rates[i], names);
        for (int k = 0; rates->rates[i].kind != DISTANCE_TURNING && k < count; k++) {
            fprintf(stream, ",%s", names[k]);
        }
    }
}

static void series_rows_write_rates(const DistanceMeasure *rates, const Trajectory *trajectory,
                                    size_t sample, FILE *stream)
{
    const DistanceMotion motion = distance_motion_at(trajectory, sample);
    for (size_t i = 0; i < rates->count; i++) {
        const DistanceRate *rate = &rates->rates[i];
        const Vec3 value = distance_value(rates->linkage, rate, motion);
        if (rate->kind != DISTANCE_TURNING) {
            write_cells((const double[]){value.x, value.y, value.z},
                        (size_t)distance_components(rates->linkage, rate), stream);
        }
    }
}

static void series_rows_write_head(const Scenario *scenario, const Trajectory *trajectory,
                                   const DistanceMeasure *rates, FILE *stream)
{
    const Linkage *linkage = &scenario->linkage;
    fputs("time_s,crank_deg", stream);
    for (size_t i = 0; i < linkage->body_count; i++) {
        const char *name = linkage->bodies[i].name;
        fprintf(stream, ",%s_angle_rad,%s_omega_rad_s,%s_alpha_rad_s2", name, name, name);
    }
    write_joint_heads(OF_JOINTS, linkage, stream);
    for (size_t i = 0; i < scenario->point_count; i++) {
        const char *name = scenario->points[i].name;
        fprintf(stream, ",%s_x_m,%s_y_m", name, name);
    }
    write_joint_heads(OF_SLIDERS, linkage, stream);
    write_joint_heads(OF_LIMITS, linkage, stream);
    if (linkage->is_spatial) {
        write_space_heads(linkage, stream);
    }
    write_rate_heads(rates, stream);
    if (trajectory->ranges.count > 0) {
        write_range_heads(linkage, stream);
    }
    fputc('\n', stream);
}

static void series_rows_write_row(const Scenario *scenario, const Trajectory *trajectory,
                                  const DistanceMeasure *rates, size_t sample, FILE *stream)
{
    const double crank_deg = trajectory->crank_angles[sample] * UNITS_DEG;
    csv_write_number(stream, trajectory->times[sample]);
    write_cells(&crank_deg, 1, stream);
    for (size_t i = 0; i < trajectory->body_count; i++) {
        const Motion *motion = trajectory_motion(trajectory, sample, i);
        write_cells((const double[]){motion->angle, motion->omega, motion->alpha}, 3, stream);
    }
    write_joint_cells(OF_JOINTS, &scenario->linkage, trajectory, sample, stream);
    const Motion *motions = trajectory_motion(trajectory, sample, 0);
    for (size_t i = 0; i < scenario->point_count; i++) {
        const TracedPoint *point = &scenario->points[i];
        const Vec2 position = linkage_point(motions, point->body, point->local);
        write_cells((const double[]){position.x, position.y}, 2, stream);
    }
    write_joint_cells(OF_SLIDERS, &scenario->linkage, trajectory, sample, stream);
    write_joint_cells(OF_LIMITS, &scenario->linkage, trajectory, sample, stream);
    if (scenario->linkage.is_spatial) {
        write_space(&scenario->linkage, trajectory, sample, stream);
    }
    series_rows_write_rates(rates, trajectory, sample, stream);
    if (trajectory->ranges.count > 0) {
        write_ranges(trajectory, sample, stream);
    }
    fputc('\n', stream);
}

void series_rows_write(const Scenario *scenario, const Trajectory *trajectory, FILE *stream)
{
    DistanceMeasure rates = distance_rates(&scenario->linkage);
    series_rows_write_head(scenario, trajectory, &rates, stream);
    for (size_t i = 0; i < trajectory->sample_count; i++) {
        series_rows_write_row(scenario, trajectory, &rates, i, stream);
    }
    distance_finish(&rates);
}
