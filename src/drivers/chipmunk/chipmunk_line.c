// Holds the centre of gravity of a body on a line of another, by one row of Chipmunk's solver.
//
// n across the line, which turns with body a; r from the centre of a to that of b:
//     n . (v_b - v_a - w_a x r) = -C / dt,   C = n . r - d,   d its distance at the start
// Chipmunk's own groove joint takes of the impulse that would stop both components of the velocity
// the one across the groove. Where the point in the groove is beside a centre of gravity, that has
// a share of the speed along the groove in it, and so pushes what slides without any force: the
// joint is then off by a share of that speed at any step.
//
// The ends of a sliding joint are the same row with n along the line, which only pushes back, and
// only where C is past an end: Chipmunk's own limits are so, but it has none for this.
#include "drivers/chipmunk/chipmunk_line.h"

#include <chipmunk/chipmunk_private.h>
#include <math.h>

typedef struct Line {
    cpConstraint constraint; // first: Chipmunk knows it as that
    cpVect across;           // n, in the frame of body a
    double low;              // m, between which n . r is kept; of a line they are the same
    double high;
    // of the step
    cpVect normal;
    cpVect arm; // from the centre of a
    double mass;
    int side;       // 1 and -1: it pushes up or down alone; 0: it does both; 2: neither
    double bias;    // speed at which the error is corrected
    double impulse; // so far
} Line;

// From the centre of a to that of b, which are not where their frames are.
static cpVect arm_of(const Line *line)
{
    const cpBody *a = line->constraint.a;
    const cpBody *b = line->constraint.b;
    return cpvsub(cpBodyLocalToWorld(b, b->cog), cpBodyLocalToWorld(a, a->cog));
}

static void prepare(cpConstraint *constraint, cpFloat step_s)
{
    Line *line = (Line *)constraint;
    const cpBody *a = constraint->a;
    line->normal = cpvrotate(line->across, cpBodyGetRotation(a));
    line->arm = arm_of(line);
    const double turning = cpvcross(line->arm, line->normal);
    line->mass = 1.0 / (a->m_inv + constraint->b->m_inv + a->i_inv * turning * turning);
    const double at = cpvdot(line->normal, line->arm);
    line->side = line->high == line->low ? 0 : at < line->low ? 1 : at > line->high ? -1 : 2;
    const double nearest = at < line->low ? line->low : fmin(at, line->high);
    line->bias = -bias_coef(constraint->errorBias, step_s) * (at - nearest) / step_s;
    if (line->side == 2) {
        line->impulse = 0.0;
    }
}

static void push(Line *line, double impulse)
{
    const cpVect on_b = cpvmult(line->normal, impulse);
    cpBody *a = line->constraint.a;
    cpBody *b = line->constraint.b;
    b->v = cpvadd(b->v, cpvmult(on_b, b->m_inv));
    a->v = cpvsub(a->v, cpvmult(on_b, a->m_inv));
    a->w -= a->i_inv * cpvcross(line->arm, on_b);
}

static void push_as_before(cpConstraint *constraint, cpFloat share)
{
    Line *line = (Line *)constraint;
    push(line, share * line->impulse);
}

static void push_more(cpConstraint *constraint, cpFloat step_s)
{
    Line *line = (Line *)constraint;
    const cpBody *a = constraint->a;
    const cpVect carried = cpvadd(a->v, cpvmult(cpvperp(line->arm), a->w));
    const double speed = cpvdot(line->normal, cpvsub(constraint->b->v, carried));
    const double before = line->impulse;
    (void)step_s;
    if (line->side == 2) {
        return;
    }
    line->impulse += line->mass * (line->bias - speed);
    if (line->side != 0 && line->impulse * line->side < 0.0) {
        line->impulse = 0.0;
    }
    push(line, line->impulse - before);
}

static cpFloat size_of_impulse(cpConstraint *constraint)
{
    return fabs(((const Line *)constraint)->impulse);
}

cpConstraint *chipmunk_ends_new(cpBody *a, cpBody *b, cpVect along, double low, double high)
{
    static const cpConstraintClass LINE = {prepare, push_as_before, push_more, size_of_impulse};
    Line *line = cpcalloc(1, sizeof *line);
    if (line == NULL) {
        return NULL;
    }
    cpConstraintInit(&line->constraint, &LINE, a, b);
    line->across = along;
    const double at = cpvdot(cpvrotate(line->across, cpBodyGetRotation(a)), arm_of(line));
    line->low = at + low;
    line->high = at + high;
    return &line->constraint;
}

cpConstraint *chipmunk_line_new(cpBody *a, cpBody *b, cpVect direction)
{
    return chipmunk_ends_new(a, b, cpvperp(direction), 0.0, 0.0);
}
