// Takes the sections of a run from its samples.
//
// With x_n the velocities of all bodies at section n, the run repeats after p revolutions where
//     |x_n - x_(n-p)| <= SECTION_TOLERANCE max |x|
// of all n of the last p revolutions; the smallest such p is the period. The norm is the largest
// difference of any body's velocity, or of its angular velocity times its reach.
#include "measure/section.h"

#include "model/common_period.h"
#include "model/joint_rows.h"

#include <math.h>

const double SECTION_TOLERANCE = 1e-5;

// 1: of a period, by which a sample may miss its end: rounding of times that are multiples
static const double SAMPLE_MISS = 1e-9;

double section_difference(const Trajectory *run, size_t a, size_t b)
{
    double most = 0.0;
    for (size_t i = 0; i < run->body_count; i++) {
        double moving = 0.0;
        double turning = 0.0;
        if (run->space_motions != NULL) {
            const SpaceMotion *of_a = trajectory_space_motion(run, a, i);
            const SpaceMotion *of_b = trajectory_space_motion(run, b, i);
            moving = vec3_length(vec3_sub(of_a->velocity, of_b->velocity));
            turning = vec3_length(vec3_sub(of_a->omega, of_b->omega));
        } else {
            const Motion *of_a = trajectory_motion(run, a, i);
            const Motion *of_b = trajectory_motion(run, b, i);
            moving = vec2_length(vec2_sub(of_a->velocity, of_b->velocity));
            turning = fabs(of_a->omega - of_b->omega);
        }
        most = fmax(most, fmax(moving, turning * run->reach[i]));
    }
    return most;
}

// m/s, of any body's fastest point at any section.
static double fastest_of(const Trajectory *run, const Sections *sections)
{
    double fastest = 0.0;
    for (size_t n = 0; n < sections->count; n++) {
        const size_t sample = section_sample(sections, n);
        for (size_t i = 0; i < run->body_count; i++) {
            const Motion *motion = trajectory_motion(run, sample, i);
            double omega = fabs(motion->omega);
            double speed = vec2_length(motion->velocity);
            if (run->space_motions != NULL) {
                omega = vec3_length(trajectory_space_motion(run, sample, i)->omega);
                speed = vec3_length(trajectory_space_motion(run, sample, i)->velocity);
            }
            fastest = fmax(fastest, speed + omega * run->reach[i]);
        }
    }
    return fastest;
}

// The largest change over p revolutions in the last p.
static double change_of(const Trajectory *run, const Sections *sections, size_t p)
{
    double change = 0.0;
    for (size_t n = sections->count - p; n < sections->count; n++) {
        change = fmax(change, section_difference(run, section_sample(sections, n),
                                                 section_sample(sections, n - p)));
    }
    return change;
}

static void find_period(const Trajectory *run, Sections *sections)
{
    const double fastest = fastest_of(run, sections);
    const size_t revolutions = sections->count - 1;
    sections->is_period_known = revolutions >= 2;
    for (size_t p = 1; p <= SECTION_PERIOD_MAX && 2 * p <= revolutions; p++) {
        const double apart = change_of(run, sections, p);
        const double change = fastest > 0.0 ? apart / fastest : 0.0;
        sections->change = fmin(change, isnan(sections->change) ? INFINITY : sections->change);
        if (change <= SECTION_TOLERANCE) {
            sections->period = p;
            sections->change = change;
            return;
        }
    }
}

Sections section_find(const Trajectory *run)
{
    Sections sections = {.change = NAN};
    const double drive_s = linkage_period(&run->linkage);
    const double period_s = drive_s > 0.0 ? drive_s : common_period_find(&run->linkage).period_s;
    if (!run->is_complete || !(period_s > 0.0) || run->sample_count < 2) {
        return sections;
    }
    const double interval_s = run->times[1] - run->times[0];
    const double samples = round(period_s / interval_s);
    const double last = (double)run->sample_count - 1.0;
    if (samples < 1.0 || samples > last ||
        fabs(samples * interval_s - period_s) > SAMPLE_MISS * period_s) {
        return sections;
    }
    sections.stride = (size_t)samples;
    // sections are counted from the start, whose crank angle they have
    const double before = ceil(run->report_from_s / period_s - SAMPLE_MISS);
    sections.first = (size_t)(before * samples);
    if (before * samples > last) {
        return sections;
    }
    sections.count = 1 + (run->sample_count - 1 - sections.first) / sections.stride;
    find_period(run, &sections);
    return sections;
}

double section_period(const Trajectory *run)
{
    const Sections sections = section_find(run);
    return sections.is_period_known ? (double)sections.period : NAN;
}

// The sample of a section counted from the end; false where there is none.
static bool sample_before(const Trajectory *run, size_t before, size_t *sample)
{
    const Sections sections = section_find(run);
    const bool is_there = before + 1 < sections.count;
    *sample = is_there ? section_sample(&sections, sections.count - 1 - before) : 0;
    return is_there;
}

double section_omega(const Trajectory *run, size_t body, size_t before)
{
    size_t sample = 0;
    return sample_before(run, before, &sample) ? trajectory_motion(run, sample, body)->omega : NAN;
}

int section_slider(const Linkage *linkage, size_t body)
{
    for (size_t i = 0; i < linkage->joint_count; i++) {
        const Joint *joint = &linkage->joints[i];
        if (joint_slides(joint->kind) && joint->body_a == LINKAGE_GROUND &&
            joint->body_b == (int)body) {
            return (int)i;
        }
    }
    return -1;
}

double section_slide(const Trajectory *run, size_t body, size_t before)
{
    size_t sample = 0;
    const int joint = section_slider(&run->linkage, body);
    if (joint < 0 || !sample_before(run, before, &sample)) {
        return NAN;
    }
    const Motion *motions = trajectory_motion(run, sample, 0);
    return vec2_dot(joint_rows_along(&run->linkage, motions, joint), motions[body].velocity);
}
