// How far, how fast and how hard did a slider go along its line?
#include "commands/run/slide_range.h"

#include "model/joint_rows.h"

bool slide_range_has(const Joint *joint)
{
    return joint_rows_is_angle(joint->kind, 1);
}

double slide_range_acceleration(const Linkage *linkage, const Trajectory *run, size_t sample,
                                size_t joint)
{
    const Motion *motions = trajectory_motion(run, sample, 0);
    const Joint *of = &linkage->joints[joint];
    const int body = of->body_b == LINKAGE_GROUND ? of->body_a : of->body_b;
    return vec2_dot(joint_rows_along(linkage, motions, (int)joint), motions[body].acceleration);
}

static Extreme at_sample(double value, const Trajectory *run, size_t sample)
{
    return (Extreme){value, run->times[sample], run->crank_angles[sample]};
}

// Takes a value that was then into the least and most.
static void widen(Extreme range[2], double value, const Trajectory *run, size_t sample)
{
    const Extreme now = at_sample(value, run, sample);
    range[0] = sample == 0 || value < range[0].value ? now : range[0];
    range[1] = sample == 0 || value > range[1].value ? now : range[1];
}

SlideRange slide_range_find(const Linkage *linkage, const Trajectory *run, size_t joint)
{
    SlideRange range = {0};
    for (size_t i = 0; i < run->sample_count; i++) {
        const Motion *motions = trajectory_motion(run, i, 0);
        const JointGap gap = linkage_joint_gap(linkage, motions, (int)joint);
        const Vec2 along = joint_rows_along(linkage, motions, (int)joint);
        const int body = linkage->joints[joint].body_a;
        const double omega = body == LINKAGE_GROUND ? 0.0 : motions[body].omega;
        widen(range.position, vec2_dot(along, gap.position), run, i);
        // the line turns with its body
        widen(range.velocity,
              vec2_dot(along, gap.velocity) + omega * vec2_dot(vec2_perp(along), gap.position), run,
              i);
        widen(range.acceleration, slide_range_acceleration(linkage, run, i, joint), run, i);
        const double resultant = vec2_length(trajectory_state(run, i, joint)->force_on_b);
        if (i == 0 || resultant > range.resultant.value) {
            range.resultant = at_sample(resultant, run, i);
        }
    }
    return range;
}
