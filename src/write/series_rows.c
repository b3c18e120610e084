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

// What a slider has more than a pin: its tilt, the couple with the force on it, and of a block the
// vector sum of the forces whose sizes its force adds up.
static bool slides(const Joint *joint)
{
    return joint->kind == JOINT_PRISMATIC || joint->kind == JOINT_GUIDE;
}

static void write_slide_heads(const Linkage *linkage, FILE *stream)
{
    for (size_t i = 0; i < linkage->joint_count; i++) {
        const char *name = linkage->joints[i].name;
        if (slides(&linkage->joints[i])) {
            fprintf(stream, ",%s_tilt_rad,%s_moment_N_m", name, name);
            fprintf(stream, ",%s_slide_acceleration_m_s2", name);
        }
        if (linkage->joints[i].kind == JOINT_GUIDE) {
            fprintf(stream, ",%s_resultant_N", name);
        }
    }
}

static void write_slides(const Linkage *linkage, const Trajectory *trajectory, size_t sample,
                         FILE *stream)
{
    const Motion *motions = trajectory_motion(trajectory, sample, 0);
    for (size_t i = 0; i < linkage->joint_count; i++) {
        const Joint *joint = &linkage->joints[i];
        if (slides(joint)) {
            const JointState *state = trajectory_state(trajectory, sample, i);
            const int body = joint->body_b == LINKAGE_GROUND ? joint->body_a : joint->body_b;
            const Vec2 along = joint_rows_along(linkage, motions, (int)i);
            const double numbers[] = {state->tilt, state->moment_on_b,
                                      vec2_dot(along, motions[body].acceleration)};
            write_cells(numbers, 3, stream);
        }
        if (joint->kind == JOINT_GUIDE) {
            const double resultant =
                vec2_length(trajectory_state(trajectory, sample, i)->force_on_b);
            write_cells(&resultant, 1, stream);
        }
    }
}

// The coordinate of a joint that has limits, whichever of its kind.
static void write_limit_heads(const Linkage *linkage, FILE *stream)
{
    for (size_t i = 0; i < linkage->joint_count; i++) {
        const Joint *joint = &linkage->joints[i];
        if (joint->limits.kind != LIMIT_NONE) {
            fprintf(stream, ",%s_coordinate_%s", joint->name, joint_units(joint)->length_key);
        }
    }
}

static void series_rows_write_limits(const Linkage *linkage, const Trajectory *trajectory,
                                     size_t sample, FILE *stream)
{
    for (size_t i = 0; i < linkage->joint_count; i++) {
        if (linkage->joints[i].limits.kind != LIMIT_NONE) {
            const double at = linkage->is_spatial
                                  ? trajectory_state(trajectory, sample, i)->tilt
                                  : coordinate_position(
                                        linkage, trajectory_motion(trajectory, sample, 0), (int)i);
            write_cells(&at, 1, stream);
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
    for (size_t i = 0; i < linkage->joint_count; i++) {
        const char *name = linkage->joints[i].name;
        if (linkage->joints[i].kind == JOINT_CLEARANCE) {
            fprintf(stream, ",%s_tilt_rad,%s_axial_m,%s_axial_force_N", name, name, name);
            fprintf(stream, ",%s_gap_back_m,%s_gap_front_m", name, name);
            fprintf(stream, ",%s_force_back_N,%s_force_front_N", name, name);
        }
    }
}

static void write_space(const Linkage *linkage, const Trajectory *trajectory, size_t sample,
                        FILE *stream)
{
    for (size_t i = 0; i < linkage->body_count; i++) {
        const SpaceMotion *motion = trajectory_space_motion(trajectory, sample, i);
        write_cells((const double[]){motion->position.z, motion->omega.x, motion->omega.y}, 3,
                    stream);
    }
    for (size_t i = 0; i < linkage->joint_count; i++) {
        const SpaceJointState *state = trajectory_space_state(trajectory, sample, i);
        const double numbers[] = {
            state->tilt,        state->axial,         state->axial_force,   state->end_gaps[0],
            state->end_gaps[1], state->end_forces[0], state->end_forces[1],
        };
        if (linkage->joints[i].kind == JOINT_CLEARANCE) {
            write_cells(numbers, sizeof numbers / sizeof numbers[0], stream);
        }
    }
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
    for (size_t i = 0; i < linkage->joint_count; i++) {
        const char *name = linkage->joints[i].name;
        const JointUnits *units = joint_units(&linkage->joints[i]);
        fprintf(stream, ",%s_ex_m,%s_ey_m,%s_gap_%s,%s_force_%s", name, name, name,
                units->length_key, name, units->force_key);
    }
    for (size_t i = 0; i < scenario->point_count; i++) {
        const char *name = scenario->points[i].name;
        fprintf(stream, ",%s_x_m,%s_y_m", name, name);
    }
    write_slide_heads(linkage, stream);
    write_limit_heads(linkage, stream);
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
    for (size_t i = 0; i < trajectory->joint_count; i++) {
        const JointState *state = trajectory_state(trajectory, sample, i);
        const double numbers[] = {state->eccentricity.x, state->eccentricity.y, state->gap,
                                  state->force};
        write_cells(numbers, 4, stream);
    }
    const Motion *motions = trajectory_motion(trajectory, sample, 0);
    for (size_t i = 0; i < scenario->point_count; i++) {
        const TracedPoint *point = &scenario->points[i];
        const Vec2 position = linkage_point(motions, point->body, point->local);
        write_cells((const double[]){position.x, position.y}, 2, stream);
    }
    write_slides(&scenario->linkage, trajectory, sample, stream);
    series_rows_write_limits(&scenario->linkage, trajectory, sample, stream);
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
