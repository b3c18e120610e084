// Integrates mechanisms whose ideal joints have friction that sticks, in absolute coordinates.
#include "rubbing.h"

#include <assert.h>
#include <math.h>
#include <string.h>

enum {
    COORDINATES = 3 * RUBBING_BODIES,
    ROWS = 2 * RUBBING_JOINTS + 1,
    UNKNOWNS = COORDINATES + ROWS,
    SUBSTITUTIONS = 400,
    BISECTIONS = 60,
};

// Equations M a - J^T l = f, J a = c, with their factors.
typedef struct Equations {
    int rows;
    int size;
    int first_row[RUBBING_JOINTS];
    double jacobian[ROWS][COORDINATES];
    double right[ROWS]; // c
    double matrix[UNKNOWNS][UNKNOWNS];
    int pivots[UNKNOWNS];
} Equations;

// A point of a body, its velocity, and its arm.
typedef struct Point {
    double x[2];
    double v[2];
    double arm[2];
    double omega;
} Point;

static Point point_of(const Rubbing *rubbing, int body, const double at[2])
{
    Point point = {.x = {at[0], at[1]}};
    if (body >= 0) {
        const RubbingBody *of = &rubbing->bodies[body];
        const double c = cos(of->q[2]);
        const double s = sin(of->q[2]);
        point.arm[0] = c * at[0] - s * at[1];
        point.arm[1] = s * at[0] + c * at[1];
        point.omega = of->v[2];
        for (int k = 0; k < 2; k++) {
            point.x[k] = of->q[k] + point.arm[k];
        }
        point.v[0] = of->v[0] - of->v[2] * point.arm[1];
        point.v[1] = of->v[1] + of->v[2] * point.arm[0];
    }
    return point;
}

static double line_angle(const Rubbing *rubbing, const RubbingJoint *joint)
{
    return joint->along + (joint->a >= 0 ? rubbing->bodies[joint->a].q[2] : 0.0);
}

static double sliding_of(const Rubbing *rubbing, const RubbingJoint *joint)
{
    const Point a = point_of(rubbing, joint->a, joint->at_a);
    const Point b = point_of(rubbing, joint->b, joint->at_b);
    if (!joint->slides) {
        return b.omega - a.omega;
    }
    const double angle = line_angle(rubbing, joint);
    return cos(angle) * (b.v[0] - a.v[0]) + sin(angle) * (b.v[1] - a.v[1]);
}

static void add_force(double *load, int body, const double arm[2], double x, double y)
{
    if (body >= 0) {
        load[3 * body] += x;
        load[3 * body + 1] += y;
        load[3 * body + 2] += arm[0] * y - arm[1] * x;
    }
}

static void add_friction(const Rubbing *rubbing, const RubbingJoint *joint, double force,
                         double *load)
{
    if (!joint->slides) {
        load[3 * joint->b + 2] -= force;
        if (joint->a >= 0) {
            load[3 * joint->a + 2] += force;
        }
        return;
    }
    const double angle = line_angle(rubbing, joint);
    const double x = force * cos(angle);
    const double y = force * sin(angle);
    const Point b = point_of(rubbing, joint->b, joint->at_b);
    add_force(load, joint->b, b.arm, -x, -y);
    if (joint->a >= 0) {
        const double *centre = rubbing->bodies[joint->a].q;
        const double arm[2] = {b.x[0] - centre[0], b.x[1] - centre[1]};
        add_force(load, joint->a, arm, x, y);
    }
}

static void set_point_row(double *row, int body, const double arm[2], double x, double y)
{
    if (body >= 0) {
        row[3 * body] += x;
        row[3 * body + 1] += y;
        row[3 * body + 2] += arm[0] * y - arm[1] * x;
    }
}

static void add_pivot(const Rubbing *rubbing, const RubbingJoint *joint, Equations *equations)
{
    const Point a = point_of(rubbing, joint->a, joint->at_a);
    const Point b = point_of(rubbing, joint->b, joint->at_b);
    for (int k = 0; k < 2; k++) {
        double *row = equations->jacobian[equations->rows];
        set_point_row(row, joint->b, b.arm, k == 0, k == 1);
        set_point_row(row, joint->a, a.arm, -(k == 0), -(k == 1));
        equations->right[equations->rows++] =
            b.omega * b.omega * b.arm[k] - a.omega * a.omega * a.arm[k];
    }
    if (joint->is_driven) {
        double *row = equations->jacobian[equations->rows++];
        row[3 * joint->b + 2] += 1.0;
        if (joint->a >= 0) {
            row[3 * joint->a + 2] -= 1.0;
        }
    }
}

static void add_slider(const Rubbing *rubbing, const RubbingJoint *joint, Equations *equations)
{
    const Point a = point_of(rubbing, joint->a, joint->at_a);
    const Point b = point_of(rubbing, joint->b, joint->at_b);
    const double angle = line_angle(rubbing, joint);
    const double n[2] = {-sin(angle), cos(angle)};
    double gap[2];
    double under[2] = {0.0, 0.0};
    double gap_v[2];
    double c = 0.0;
    for (int k = 0; k < 2; k++) {
        gap[k] = b.x[k] - a.x[k];
        gap_v[k] = b.v[k] - a.v[k];
        under[k] = a.arm[k] + gap[k];
        c += n[k] * (b.omega * b.omega * b.arm[k] - a.omega * a.omega * a.arm[k] +
                     a.omega * a.omega * gap[k]);
    }
    // the normal turns with body a
    c -= 2.0 * a.omega * (-n[1] * gap_v[0] + n[0] * gap_v[1]);
    double *row = equations->jacobian[equations->rows];
    set_point_row(row, joint->b, b.arm, n[0], n[1]);
    set_point_row(row, joint->a, under, -n[0], -n[1]);
    equations->right[equations->rows++] = c;
    row = equations->jacobian[equations->rows++];
    row[3 * joint->b + 2] += 1.0;
    if (joint->a >= 0) {
        row[3 * joint->a + 2] -= 1.0;
    }
}

static void factor(Equations *equations)
{
    const int n = equations->size;
    for (int k = 0; k < n; k++) {
        int pivot = k;
        for (int i = k + 1; i < n; i++) {
            pivot = fabs(equations->matrix[i][k]) > fabs(equations->matrix[pivot][k]) ? i : pivot;
        }
        equations->pivots[k] = pivot;
        for (int j = 0; j < n; j++) {
            const double kept = equations->matrix[k][j];
            equations->matrix[k][j] = equations->matrix[pivot][j];
            equations->matrix[pivot][j] = kept;
        }
        assert(equations->matrix[k][k] != 0.0);
        for (int i = k + 1; i < n; i++) {
            equations->matrix[i][k] /= equations->matrix[k][k];
            for (int j = k + 1; j < n; j++) {
                equations->matrix[i][j] -= equations->matrix[i][k] * equations->matrix[k][j];
            }
        }
    }
}

static void substitute(const Equations *equations, double *x)
{
    const int n = equations->size;
    for (int k = 0; k < n; k++) {
        const double kept = x[k];
        x[k] = x[equations->pivots[k]];
        x[equations->pivots[k]] = kept;
    }
    for (int i = 0; i < n; i++) {
        for (int j = 0; j < i; j++) {
            x[i] -= equations->matrix[i][j] * x[j];
        }
    }
    for (int i = n; i-- > 0;) {
        for (int j = i + 1; j < n; j++) {
            x[i] -= equations->matrix[i][j] * x[j];
        }
        x[i] /= equations->matrix[i][i];
    }
}

static void set_up(const Rubbing *rubbing, Equations *equations)
{
    memset(equations, 0, sizeof *equations);
    for (int i = 0; i < rubbing->joint_count; i++) {
        equations->first_row[i] = equations->rows;
        (rubbing->joints[i].slides ? add_slider : add_pivot)(rubbing, &rubbing->joints[i],
                                                             equations);
    }
    const int coordinates = 3 * rubbing->body_count;
    equations->size = coordinates + equations->rows;
    for (int i = 0; i < coordinates; i++) {
        const RubbingBody *body = &rubbing->bodies[i / 3];
        equations->matrix[i][i] = i % 3 < 2 ? body->mass : body->inertia;
        for (int k = 0; k < equations->rows; k++) {
            equations->matrix[i][coordinates + k] = -equations->jacobian[k][i];
            equations->matrix[coordinates + k][i] = equations->jacobian[k][i];
        }
    }
    factor(equations);
}

// g of the law.
static double left_of(const RubbingJoint *joint, double speed)
{
    return 1.0 + (joint->ratio - 1.0) * exp(-pow(speed / joint->speed, 2.0));
}

static double bent_of(const RubbingJoint *joint, double speed)
{
    return joint->ratio * joint->z / joint->bend + joint->damping * speed;
}

static double share_of(const RubbingJoint *joint, double speed)
{
    return joint->mode == RUBBING_STICKS ? bent_of(joint, speed)
                                         : joint->way * left_of(joint, speed);
}

static double face_of(const double reaction[2], int face)
{
    const double one = reaction[face / 2];
    return face % 2 == 0 ? one : -one;
}

// What presses on a joint, N.
static double press_of(const RubbingJoint *joint, const double reaction[2])
{
    return joint->slides ? face_of(reaction, joint->face) : hypot(reaction[0], reaction[1]);
}

// The reactions of a solution: of a pivot its force, of a slider the force across its line and
// twice its moment over its length.
static void read_reaction(const Rubbing *rubbing, const Equations *equations, int number,
                          const double *x, double reaction[2])
{
    const RubbingJoint *joint = &rubbing->joints[number];
    const double *own = x + 3 * rubbing->body_count + equations->first_row[number];
    reaction[0] = own[0];
    reaction[1] = !joint->slides        ? own[1]
                  : joint->length > 0.0 ? 2.0 * own[1] / joint->length
                                        : 0.0;
}

// Writes the accelerations, and each joint's friction with what presses.
static void accelerate(Rubbing *rubbing, double *acceleration)
{
    static Equations equations;
    const int n = rubbing->joint_count;
    const int coordinates = 3 * rubbing->body_count;
    double bare[UNKNOWNS] = {0.0};
    double units[RUBBING_JOINTS][UNKNOWNS];
    double shares[RUBBING_JOINTS];
    set_up(rubbing, &equations);
    for (int i = 0; i < rubbing->body_count; i++) {
        bare[3 * i + 1] = -rubbing->gravity * rubbing->bodies[i].mass;
    }
    memcpy(bare + coordinates, equations.right, (size_t)equations.rows * sizeof *bare);
    substitute(&equations, bare);
    for (int i = 0; i < n; i++) {
        RubbingJoint *joint = &rubbing->joints[i];
        memset(units[i], 0, sizeof units[i]);
        add_friction(rubbing, joint, 1.0, units[i]);
        substitute(&equations, units[i]);
        shares[i] = share_of(joint, sliding_of(rubbing, joint));
        joint->force = 0.0;
    }
    double moved = 1.0;
    double x[UNKNOWNS];
    for (int pass = 0; pass < SUBSTITUTIONS && moved > 0.0; pass++) {
        memcpy(x, bare, sizeof x);
        for (int i = 0; i < n; i++) {
            for (int k = 0; k < equations.size; k++) {
                x[k] += units[i][k] * rubbing->joints[i].force;
            }
        }
        moved = 0.0;
        for (int i = 0; i < n; i++) {
            RubbingJoint *joint = &rubbing->joints[i];
            read_reaction(rubbing, &equations, i, x, joint->reaction);
            joint->pressed = joint->steady > 0.0
                                 ? joint->steady
                                 : joint->mu * (joint->slides ? 1.0 : joint->radius) *
                                       press_of(joint, joint->reaction);
            const double force = shares[i] * joint->pressed;
            moved = fmax(moved, fabs(force - joint->force));
            joint->force = force;
        }
    }
    memcpy(acceleration, x, (size_t)coordinates * sizeof *x);
}

// How a joint's sliding accelerates under a unit of its own friction.
static double mobility_of(Rubbing *rubbing, int number)
{
    static Equations equations;
    double unit[UNKNOWNS] = {0.0};
    set_up(rubbing, &equations);
    add_friction(rubbing, &rubbing->joints[number], -1.0, unit);
    substitute(&equations, unit);
    Rubbing moved = *rubbing;
    for (int i = 0; i < 3 * rubbing->body_count; i++) {
        moved.bodies[i / 3].v[i % 3] = unit[i];
    }
    return sliding_of(&moved, &moved.joints[number]);
}

static void set_damping(Rubbing *rubbing, int number)
{
    RubbingJoint *joint = &rubbing->joints[number];
    double acceleration[COORDINATES];
    joint->damping = 0.0;
    accelerate(rubbing, acceleration);
    const double mobility = mobility_of(rubbing, number);
    if (mobility > 1e-8 && joint->pressed > 0.0) {
        const double stiffness = joint->ratio * joint->pressed / joint->bend;
        joint->damping = 2.0 * joint->zeta * sqrt(stiffness / mobility) / joint->pressed;
    }
}

// A state is the bodies' coordinates and velocities, the bends, and what is lost.
enum { STATE = 2 * COORDINATES + RUBBING_JOINTS + 1 };

static void pack(const Rubbing *rubbing, double *y)
{
    for (int i = 0; i < COORDINATES; i++) {
        y[i] = rubbing->bodies[i / 3].q[i % 3];
        y[COORDINATES + i] = rubbing->bodies[i / 3].v[i % 3];
    }
    for (int i = 0; i < RUBBING_JOINTS; i++) {
        y[2 * COORDINATES + i] = rubbing->joints[i].z;
    }
    y[STATE - 1] = rubbing->lost;
}

static void unpack(const double *y, Rubbing *rubbing)
{
    for (int i = 0; i < COORDINATES; i++) {
        rubbing->bodies[i / 3].q[i % 3] = y[i];
        rubbing->bodies[i / 3].v[i % 3] = y[COORDINATES + i];
    }
    for (int i = 0; i < RUBBING_JOINTS; i++) {
        rubbing->joints[i].z = y[2 * COORDINATES + i];
    }
    rubbing->lost = y[STATE - 1];
}

static void rates_of(Rubbing *rubbing, const double *y, double *rates)
{
    unpack(y, rubbing);
    double acceleration[COORDINATES] = {0.0};
    accelerate(rubbing, acceleration);
    memset(rates, 0, STATE * sizeof *rates);
    for (int i = 0; i < 3 * rubbing->body_count; i++) {
        rates[i] = y[COORDINATES + i];
        rates[COORDINATES + i] = acceleration[i];
    }
    for (int i = 0; i < rubbing->joint_count; i++) {
        RubbingJoint *joint = &rubbing->joints[i];
        const double speed = sliding_of(rubbing, joint);
        rates[2 * COORDINATES + i] = joint->mode == RUBBING_SLIDES ? 0.0 : speed;
        rates[STATE - 1] += joint->force * speed;
    }
}

static void step_by(Rubbing *rubbing, double h)
{
    double y[STATE];
    double k[4][STATE];
    double at[STATE];
    pack(rubbing, y);
    rates_of(rubbing, y, k[0]);
    for (int stage = 1; stage < 4; stage++) {
        for (int i = 0; i < STATE; i++) {
            at[i] = y[i] + (stage < 3 ? 0.5 : 1.0) * h * k[stage - 1][i];
        }
        rates_of(rubbing, at, k[stage]);
    }
    for (int i = 0; i < STATE; i++) {
        y[i] += h / 6.0 * (k[0][i] + 2.0 * k[1][i] + 2.0 * k[2][i] + k[3][i]);
    }
    unpack(y, rubbing);
}

// The least of what is left of the modes of a joint, and what it does next.
static double left_in_mode(const RubbingJoint *joint, double speed, RubbingJoint *next)
{
    const double bent = bent_of(joint, speed);
    const double left = left_of(joint, speed);
    *next = *joint;
    double least = INFINITY;
    switch (joint->mode) {
    case RUBBING_STICKS:
        least = left - fabs(bent);
        next->mode = RUBBING_YIELDS;
        next->way = bent > 0.0 ? 1.0 : -1.0;
        break;
    case RUBBING_SLIDES:
        least = joint->way * speed;
        next->mode = RUBBING_STICKS;
        break;
    case RUBBING_YIELDS:
        least = joint->way * bent - left;
        next->mode = RUBBING_STICKS;
        if (1.0 - joint->way * joint->z / joint->bend < least) {
            least = 1.0 - joint->way * joint->z / joint->bend;
            next->mode = RUBBING_SLIDES;
            next->z = joint->way * joint->bend;
        }
        break;
    }
    return least;
}

// The same of the faces of a slider.
static double left_of_face(const RubbingJoint *joint, int *next)
{
    double most = -INFINITY;
    for (int face = 0; face < 4; face++) {
        const double value = face_of(joint->reaction, face);
        if (face != joint->face && value > most) {
            most = value;
            *next = face;
        }
    }
    return face_of(joint->reaction, joint->face) - most;
}

// The first joint that has come to an end, or -1.
static int ended(Rubbing *rubbing)
{
    double acceleration[COORDINATES];
    accelerate(rubbing, acceleration);
    for (int i = 0; i < rubbing->joint_count; i++) {
        const RubbingJoint *joint = &rubbing->joints[i];
        RubbingJoint next;
        int face;
        if (left_in_mode(joint, sliding_of(rubbing, joint), &next) < -1e-13 ||
            (joint->slides && joint->steady == 0.0 && left_of_face(joint, &face) < -1e-11)) {
            return i;
        }
    }
    return -1;
}

static void change(Rubbing *rubbing, int number)
{
    RubbingJoint *joint = &rubbing->joints[number];
    RubbingJoint next;
    int face = joint->face;
    rubbing->events++;
    if (joint->slides && joint->steady == 0.0 && left_of_face(joint, &face) < -1e-11) {
        joint->face = face;
        return;
    }
    const bool slid = joint->mode == RUBBING_SLIDES;
    left_in_mode(joint, sliding_of(rubbing, joint), &next);
    *joint = next;
    if (slid) {
        set_damping(rubbing, number);
    }
}

void rubbing_start(Rubbing *rubbing)
{
    static Equations equations;
    const int coordinates = 3 * rubbing->body_count;
    double x[UNKNOWNS] = {0.0};
    set_up(rubbing, &equations);
    for (int i = 0; i < coordinates; i++) {
        const RubbingBody *body = &rubbing->bodies[i / 3];
        x[i] = (i % 3 < 2 ? body->mass : body->inertia) * body->v[i % 3];
    }
    for (int i = 0; i < rubbing->joint_count; i++) {
        if (rubbing->joints[i].is_driven) {
            x[coordinates + equations.first_row[i] + 2] = rubbing->joints[i].drive;
        }
    }
    substitute(&equations, x);
    for (int i = 0; i < coordinates; i++) {
        rubbing->bodies[i / 3].v[i % 3] = x[i];
    }
    double acceleration[COORDINATES];
    for (int pass = 0; pass < 4; pass++) {
        accelerate(rubbing, acceleration);
        for (int i = 0; i < rubbing->joint_count; i++) {
            RubbingJoint *joint = &rubbing->joints[i];
            int face = joint->face;
            if (joint->slides && left_of_face(joint, &face) < 0.0) {
                joint->face = face;
            }
        }
    }
    double dampings[RUBBING_JOINTS];
    for (int i = 0; i < rubbing->joint_count; i++) {
        set_damping(rubbing, i);
        dampings[i] = rubbing->joints[i].damping;
        rubbing->joints[i].damping = 0.0;
    }
    for (int i = 0; i < rubbing->joint_count; i++) {
        rubbing->joints[i].damping = dampings[i];
    }
    for (int i = 0; i < rubbing->joint_count; i++) {
        RubbingJoint *joint = &rubbing->joints[i];
        RubbingJoint next;
        if (left_in_mode(joint, sliding_of(rubbing, joint), &next) < 0.0) {
            *joint = next;
        }
    }
}

void rubbing_run(Rubbing *rubbing, double duration_s, double step_s)
{
    double left_s = duration_s;
    while (left_s > 0.0) {
        const double h = fmin(step_s, left_s);
        Rubbing end = *rubbing;
        step_by(&end, h);
        if (ended(&end) < 0) {
            *rubbing = end;
            left_s = h == left_s ? 0.0 : left_s - h;
            continue;
        }
        double before = 0.0;
        double after = h;
        for (int i = 0; i < BISECTIONS; i++) {
            const double middle = 0.5 * (before + after);
            Rubbing tried = *rubbing;
            step_by(&tried, middle);
            if (ended(&tried) >= 0) {
                after = middle;
                end = tried;
            } else {
                before = middle;
            }
        }
        change(&end, ended(&end));
        *rubbing = end;
        left_s -= after;
    }
}
