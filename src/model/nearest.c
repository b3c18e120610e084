// Finds the positions and speeds of a linkage's bodies that are nearest to given ones and keep its
// joints.
//
// With J the rows of the joints and the drive, M the masses and inertias, r what is missing,
//     min du' M du  with  J du = r    gives    du = M^-1 J' (J M^-1 J')^-1 r,
// which for speeds is what a blow does. Rows of joints with play may be redundant: the diagonal is
// then what keeps the matrix regular.
#include "model/nearest.h"

#include "base/dense.h"
#include "base/zeroed.h"
#include "model/joint_rows.h"
#include "model/joint_system.h"
#include "model/kinematics.h"

enum { STEP_MAX = 12 }; // Newton doubles the digits: from a clearance to rounding takes about 3

static const double SOFT = 1e-12; // on the diagonal of ones: a second pass leaves its square
// m, and of what is longer than a metre the share: its rounding is a hundredth of it
static const double NEAREST_CLOSED = 1e-14;
static const double AGREES = 1e-9; // of the largest speed: what written digits leave

// The rows that are asked for, and what each is to change by.
typedef struct Demand {
    bool *include; // by joint; owned, like the next two
    double *wanted;
    double *change;  // room for what it asks for, three columns a body
    size_t rows;     // of the joints; those of drives stand behind them
    double distance; // the largest that is missing at any joint, m or m/s
} Demand;

static Demand create_demand(const Linkage *linkage)
{
    return (Demand){
        .include = zeroed(linkage->joint_count, sizeof(bool)),
        .wanted = zeroed(2 * linkage->joint_count + LINKAGE_DRIVE_MAX, sizeof(double)),
        .change = zeroed(3 * linkage->body_count, sizeof(double)),
    };
}

static void free_demand(Demand *demand)
{
    free(demand->include);
    free(demand->wanted);
    free(demand->change);
}

// Asks for the two rows of a joint; true where more is missing there than anywhere before.
static bool add_demand_rows(const Linkage *linkage, int joint, Vec2 missing, Demand *demand)
{
    demand->wanted[demand->rows++] = missing.x;
    demand->wanted[demand->rows++] = missing.y;
    const double size = joint_rows_size(linkage, joint, missing);
    const bool is_worst = size > demand->distance;
    demand->distance = fmax(demand->distance, size);
    return is_worst;
}

static double root_mass(const Linkage *linkage, size_t column)
{
    const Body *body = &linkage->bodies[column / 3];
    return sqrt(column % 3 == 2 ? body->inertia : body->mass);
}

// The least change that meets the demand, three columns a body. False where rows are redundant.
static bool least_change(const Linkage *linkage, const Motion *motions, const Demand *demand)
{
    double *change = demand->change;
    if (!kinematics_is_small(linkage)) {
        JointSystem system;
        joint_system_init(linkage, motions, demand->include, true, &system);
        joint_system_least_change(&system, demand->wanted, change);
        joint_system_finish(&system);
        return true;
    }
    Jacobian jacobian;
    kinematics_jacobian(linkage, motions, demand->include, true, &jacobian);
    const size_t rows = jacobian.rows;
    const size_t columns = jacobian.columns;
    double matrix[KINEMATICS_ROW_MAX * KINEMATICS_ROW_MAX];
    double pull[KINEMATICS_ROW_MAX];
    // columns over the root of their mass, then rows to length one: a matrix with ones in it
    for (size_t i = 0; i < rows; i++) {
        double *row = &jacobian.entries[i * columns];
        double square = 0.0;
        for (size_t c = 0; c < columns; c++) {
            row[c] /= root_mass(linkage, c);
            square += row[c] * row[c];
        }
        pull[i] = demand->wanted[i] / sqrt(square);
        for (size_t c = 0; c < columns; c++) {
            row[c] /= sqrt(square);
        }
        for (size_t k = 0; k <= i; k++) {
            double sum = i == k ? SOFT : 0.0;
            for (size_t c = 0; c < columns; c++) {
                sum += row[c] * jacobian.entries[k * columns + c];
            }
            matrix[i * rows + k] = sum;
            matrix[k * rows + i] = sum;
        }
    }
    if (!dense_solve(rows, matrix, pull)) {
        return false;
    }
    for (size_t c = 0; c < columns; c++) {
        change[c] = 0.0;
        for (size_t i = 0; i < rows; i++) {
            change[c] += jacobian.entries[i * columns + c] * pull[i] / root_mass(linkage, c);
        }
    }
    return true;
}

// What the pins, with_play, and the ideal joints still miss of where they are to start; false where
// they are there.
static bool demand_positions(const Linkage *linkage, const Motion *motions, bool with_play,
                             Demand *demand)
{
    demand->rows = 0;
    demand->distance = 0.0;
    double size = 1.0; // m
    for (size_t i = 0; i < linkage->joint_count; i++) {
        const Joint *joint = &linkage->joints[i];
        size = fmax(size, fmax(vec2_length(joint->anchor_a), vec2_length(joint->anchor_b)));
        const Vec2 hole = linkage_point(motions, joint->body_a, joint->anchor_a);
        const Vec2 pin = linkage_point(motions, joint->body_b, joint->anchor_b);
        size = fmax(size, vec2_length(hole));
        demand->include[i] =
            joint_rows_count(joint->kind) > 0 && (with_play || joint_is_ideal(joint->kind));
        if (demand->include[i] && joint_rows_is_angle(joint->kind, 1)) {
            const Vec2 opening = kinematics_opening(linkage, motions, (int)i);
            add_demand_rows(linkage, (int)i, vec2_sub(joint_rows_start(joint), opening), demand);
        } else if (demand->include[i]) {
            // an ideal joint starts at 0
            const Vec2 missing = vec2_sub(joint->clearance.start, vec2_sub(pin, hole));
            add_demand_rows(linkage, (int)i, missing, demand);
        }
    }
    for (size_t i = 0; i < linkage_drive_count(linkage); i++) {
        const double angle = motions[linkage_drive_body(linkage, i)].angle;
        demand->wanted[demand->rows + i] = linkage_drive(linkage, i)->start - angle;
    }
    return demand->distance > NEAREST_CLOSED * size;
}

static bool find_positions(const Linkage *linkage, bool with_play, Motion *motions)
{
    Demand demand = create_demand(linkage);
    bool is_solved = true;
    for (int step = 0; is_solved && demand_positions(linkage, motions, with_play, &demand);
         step++) {
        is_solved = step < STEP_MAX && least_change(linkage, motions, &demand);
        if (is_solved) {
            kinematics_move(linkage, demand.change, motions);
        }
    }
    free_demand(&demand);
    return is_solved;
}

bool nearest_positions(const Linkage *linkage, Motion *motions)
{
    return find_positions(linkage, true, motions);
}

bool nearest_ideal_positions(const Linkage *linkage, Motion *motions)
{
    return find_positions(linkage, false, motions);
}

// What the speeds miss of keeping joints closed and following the drive. Returns the joint that is
// furthest from it, or -1 where all agree; with play, joints with play are to be kept as well.
static int demand_speeds(const Linkage *linkage, const Motion *motions, bool with_play,
                         Demand *demand)
{
    int worst = -1;
    double largest = 0.0;
    demand->distance = 0.0;
    demand->rows = 0;
    for (size_t i = 0; i < linkage->joint_count; i++) {
        const Joint *joint = &linkage->joints[i];
        const Vec2 a = linkage_point_velocity(motions, joint->body_a, joint->anchor_a);
        const Vec2 b = linkage_point_velocity(motions, joint->body_b, joint->anchor_b);
        demand->include[i] =
            joint_rows_count(joint->kind) > 0 && (with_play || joint_is_ideal(joint->kind));
        largest = fmax(largest, fmax(vec2_length(a), vec2_length(b)));
        Vec2 missing = vec2_sub(a, b);
        if (joint_rows_is_angle(joint->kind, 1)) {
            JointRows rows;
            joint_rows_find(linkage, motions, (int)i, &rows);
            missing = (Vec2){-rows.rate[0], -rows.rate[1]};
        }
        if (demand->include[i] && add_demand_rows(linkage, (int)i, missing, demand)) {
            worst = (int)i;
        }
    }
    for (size_t i = 0; i < linkage->body_count; i++) {
        // of what turns about a pivot that stands still, no joint has a speed
        largest = fmax(largest, vec2_length(motions[i].velocity));
    }
    for (size_t i = 0; i < linkage_drive_count(linkage); i++) {
        const double omega = motions[linkage_drive_body(linkage, i)].omega;
        demand->wanted[demand->rows + i] = drive_at(linkage_drive(linkage, i), 0.0).omega - omega;
    }
    return demand->distance <= AGREES * largest ? -1 : worst;
}

void nearest_speeds(const Linkage *linkage, bool with_play, Motion *motions)
{
    Demand demand = create_demand(linkage);
    const double *change = demand.change;
    demand_speeds(linkage, motions, with_play, &demand);
    const bool is_solved = least_change(linkage, motions, &demand);
    for (size_t i = 0; is_solved && i < linkage->body_count; i++) {
        motions[i].velocity.x += change[3 * i];
        motions[i].velocity.y += change[3 * i + 1];
        motions[i].omega += change[3 * i + 2];
    }
    free_demand(&demand);
}

void nearest_change(const Linkage *linkage, const Motion *motions, SpeedChange *changes)
{
    Motion *moved = zeroed(linkage->body_count, sizeof *moved);
    Demand demand = create_demand(linkage);
    const double *change = demand.change;
    // the first pass leaves the softness of redundant rows, the second its square
    for (int pass = 0; pass < 2; pass++) {
        for (size_t i = 0; i < linkage->body_count; i++) {
            moved[i] = motions[i];
            moved[i].velocity = changes[i].velocity;
            moved[i].omega = changes[i].omega;
        }
        demand_speeds(linkage, moved, false, &demand);
        for (size_t i = 0; i < linkage_drive_count(linkage); i++) {
            demand.wanted[demand.rows + i] = -moved[linkage_drive_body(linkage, i)].omega;
        }
        const bool is_solved = least_change(linkage, motions, &demand);
        for (size_t i = 0; i < linkage->body_count; i++) {
            changes[i].velocity.x = is_solved ? changes[i].velocity.x + change[3 * i] : 0.0;
            changes[i].velocity.y = is_solved ? changes[i].velocity.y + change[3 * i + 1] : 0.0;
            changes[i].omega = is_solved ? changes[i].omega + change[3 * i + 2] : 0.0;
        }
    }
    free_demand(&demand);
    free(moved);
}

bool nearest_check(const Linkage *linkage, const Motion *motions, int *joint, double *distance)
{
    Demand demand = create_demand(linkage);
    *joint = demand_speeds(linkage, motions, false, &demand);
    *distance = demand.distance;
    bool follow = true;
    for (size_t i = 0; i < linkage_drive_count(linkage); i++) {
        const double missing = fabs(demand.wanted[demand.rows + i]);
        follow = follow && missing <= AGREES * fabs(linkage_drive(linkage, i)->speed);
    }
    free_demand(&demand);
    return *joint < 0 && follow;
}
