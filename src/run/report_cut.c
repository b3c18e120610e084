// Finds what of a step lies after the instant at which the reported time begins.
//
// The impulse P, N s, of a joint in a step from a to b, cut at the instant t, is divided as looks
// at the force F, N, within the step divide it:
//     after = P I(t, b) / (I(a, t) + I(t, b)),   I(u, v) the integral of F from u to v, N s
// by Gauss and Legendre's rule of eight nodes, which is exact up to degree 15. A step whose values
// are means over it has nothing to look at: its impulse is spread evenly.
#include "run/report_cut.h"

#include "base/zeroed.h"

#include <math.h>
#include <stdlib.h>

enum { NODE_PAIRS = 4 };

// of half an interval from its middle, and the weights of half its width; Abramowitz and Stegun,
// Handbook of Mathematical Functions, 1964, table 25.4
static const double NODES[NODE_PAIRS] = {0.183434642495649805, 0.525532409916328986,
                                         0.796666477413626740, 0.960289856497536232};
static const double WEIGHTS[NODE_PAIRS] = {0.362683783378361983, 0.313706645877887287,
                                           0.222381034453374471, 0.101228536290376259};

ReportCut report_cut_start(const Linkage *linkage, const Solver *solver, const void *state,
                           double from_s)
{
    ReportCut cut = {.linkage = linkage,
                     .solver = solver,
                     .state = state,
                     .from_s = from_s,
                     .is_over = from_s == 0.0};
    if (!cut.is_over) {
        cut.sample = sample_create(linkage);
        cut.recorded_s = zeroed(linkage->joint_count, sizeof *cut.recorded_s);
        cut.is_cut = zeroed(linkage->joint_count, sizeof *cut.is_cut);
        cut.after = zeroed(linkage->joint_count, sizeof *cut.after);
        cut.before = zeroed(linkage->joint_count, sizeof *cut.before);
        cut.tops = zeroed(linkage->joint_count, sizeof *cut.tops);
    }
    return cut;
}

void report_cut_finish(ReportCut *cut)
{
    if (cut->recorded_s != NULL) {
        sample_free(&cut->sample);
    }
    free(cut->recorded_s);
    free(cut->is_cut);
    free(cut->after);
    free(cut->before);
    free(cut->tops);
    cut->recorded_s = NULL;
}

// Joints of a record, by their places in it: some, or all (NULL).
static size_t count_of(const ReportCut *cut, const StepRecord *step, const SolverSome *some)
{
    return some != NULL ? some->joint_count : solver_joint_count(step->part, cut->linkage);
}

static size_t place_of(const SolverSome *some, size_t index)
{
    return some != NULL ? some->joints[index] : index;
}

static void raise_top(JointPeak *top, const JointState *state, double time_s)
{
    if (state->force > top->force) {
        top->force = state->force;
        top->force_s = time_s;
    }
    if (joint_state_depth(state) > top->depth) {
        top->depth = joint_state_depth(state);
        top->depth_s = time_s;
    }
}

// One look, which counts for so much of the integral over its side.
static void add_look(ReportCut *cut, const StepRecord *step, const SolverSome *some, double time_s,
                     double weight_s)
{
    const bool is_after = time_s >= cut->from_s;
    const size_t count = count_of(cut, step, some);
    solver_look(cut->solver, cut->state, time_s, step->part, some, &cut->sample);
    for (size_t k = 0; k < count; k++) {
        const size_t i = solver_joint(step->part, place_of(some, k));
        const JointState *state = &cut->sample.joints[i];
        (is_after ? cut->after : cut->before)[i] += weight_s * state->force;
        if (is_after) {
            raise_top(&cut->tops[i], state, time_s);
        }
    }
}

static void add_side(ReportCut *cut, const StepRecord *step, const SolverSome *some, double start_s,
                     double end_s)
{
    const double half_s = 0.5 * (end_s - start_s);
    for (size_t k = 0; k < NODE_PAIRS; k++) {
        for (int sign = -1; sign <= 1; sign += 2) {
            add_look(cut, step, some, start_s + half_s * (1.0 + sign * NODES[k]),
                     half_s * WEIGHTS[k]);
        }
    }
}

// What the record itself says of the time after the cut.
static void add_record(ReportCut *cut, const StepRecord *step, size_t place)
{
    const size_t i = solver_joint(step->part, place);
    JointPeak *top = &cut->tops[i];
    raise_top(top, &step->joints[place], fmax(step->joint_s, cut->from_s));
    const JointPeak *peak = step->peaks != NULL ? &step->peaks[place] : NULL;
    if (peak != NULL && peak->force_s >= cut->from_s && peak->force > top->force) {
        top->force = peak->force;
        top->force_s = peak->force_s;
    }
    if (peak != NULL && peak->depth_s >= cut->from_s && peak->depth > top->depth) {
        top->depth = peak->depth;
        top->depth_s = peak->depth_s;
    }
}

// Cuts what the record says of joints whose last one ended at the same time.
static void cut_joints(ReportCut *cut, const StepRecord *step, const SolverSome *some,
                       double start_s)
{
    const size_t count = count_of(cut, step, some);
    const double share = (step->end_s - cut->from_s) / (step->end_s - start_s);
    for (size_t k = 0; k < count; k++) {
        const size_t i = solver_joint(step->part, place_of(some, k));
        cut->is_cut[i] = true;
        cut->before[i] = cut->after[i] = 0.0;
        cut->tops[i] = (JointPeak){0};
    }
    if (!step->is_mean && cut->solver != NULL) {
        add_side(cut, step, some, start_s, cut->from_s);
        add_side(cut, step, some, cut->from_s, step->end_s);
        add_look(cut, step, some, cut->from_s, 0.0);
    }
    for (size_t k = 0; k < count; k++) {
        const size_t place = place_of(some, k);
        const size_t i = solver_joint(step->part, place);
        const double sum = cut->before[i] + cut->after[i];
        cut->after[i] = step->impulse[place] * (sum > 0.0 ? cut->after[i] / sum : share);
        add_record(cut, step, place);
    }
}

// Takes joints of a record, of which the last one ended at one time: true where they are cut.
static bool take_joints(ReportCut *cut, const StepRecord *step, const SolverSome *some)
{
    const size_t count = count_of(cut, step, some);
    bool is_any = false;
    if (count > 0) {
        const double start_s = cut->recorded_s[solver_joint(step->part, place_of(some, 0))];
        is_any = start_s < cut->from_s && step->end_s > cut->from_s;
        if (is_any) {
            cut_joints(cut, step, some, start_s);
        }
    }
    for (size_t k = 0; k < count; k++) {
        cut->recorded_s[solver_joint(step->part, place_of(some, k))] = step->end_s;
    }
    return is_any;
}

bool report_cut_take(ReportCut *cut, const StepRecord *step)
{
    if (cut->is_over) {
        return false;
    }
    bool is_any = false;
    cut->is_over = true;
    for (size_t i = 0; i < cut->linkage->joint_count; i++) {
        cut->is_cut[i] = false;
        cut->is_over = cut->is_over && cut->recorded_s[i] >= cut->from_s;
    }
    if (step->changed == NULL) {
        return !cut->is_over && take_joints(cut, step, NULL);
    }
    for (size_t n = 0; !cut->is_over && n < step->changed->joint_count; n++) {
        const SolverSome one = {.joint_count = 1, .joints = &step->changed->joints[n]};
        is_any = take_joints(cut, step, &one) || is_any;
    }
    return is_any;
}
