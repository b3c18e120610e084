// How does a truth cross a pipe?
//
// Truth | Trajectory | its arrays, those in space where there are any; the pointers in the first
// two are replaced on arrival.
#include "measure/truth_pack.h"

#include <string.h>

// The arrays of a trajectory and their sizes in bytes.
typedef struct Part {
    void *start;
    size_t size;
} Part;

enum { PART_COUNT = 11 };

static void list_parts(const Trajectory *trajectory, Part parts[PART_COUNT])
{
    const size_t samples = trajectory->sample_count;
    const size_t body_count = trajectory->body_count;
    const size_t joint_count = trajectory->joint_count;
    parts[0] = (Part){trajectory->times, samples * sizeof(double)};
    parts[1] = (Part){trajectory->crank_angles, samples * sizeof(double)};
    parts[2] = (Part){trajectory->motions, samples * trajectory->body_count * sizeof(Motion)};
    parts[3] = (Part){trajectory->states, samples * trajectory->joint_count * sizeof(JointState)};
    const bool is_spatial = trajectory->space_motions != NULL;
    const size_t bodies = is_spatial ? samples * trajectory->body_count : 0;
    const size_t joints = is_spatial ? samples * trajectory->joint_count : 0;
    parts[4] = (Part){trajectory->space_motions, bodies * sizeof(SpaceMotion)};
    parts[5] = (Part){trajectory->space_states, joints * sizeof(SpaceJointState)};
    parts[6] = (Part){trajectory->reach, body_count * sizeof(double)};
    parts[7] = (Part){trajectory->bodies, body_count * sizeof(BodyExtremes)};
    parts[8] = (Part){trajectory->joints, joint_count * sizeof(JointExtremes)};
    parts[9] = (Part){trajectory->alpha_spikes, body_count * sizeof(SignalSpikes)};
    parts[10] = (Part){trajectory->force_spikes, joint_count * sizeof(SignalSpikes)};
}

size_t truth_pack_size(const Scenario *scenario)
{
    const Linkage *linkage = &scenario->linkage;
    size_t a_sample = 2 * sizeof(double) + linkage->body_count * sizeof(Motion) +
                      linkage->joint_count * sizeof(JointState);
    if (linkage->is_spatial) {
        a_sample += linkage->body_count * sizeof(SpaceMotion) +
                    linkage->joint_count * sizeof(SpaceJointState);
    }
    const size_t once = linkage->body_count * (sizeof(double) + sizeof(BodyExtremes)) +
                        linkage->joint_count * sizeof(JointExtremes) +
                        (linkage->body_count + linkage->joint_count) * sizeof(SignalSpikes);
    return sizeof(Truth) + sizeof(Trajectory) + once + scenario_sample_count(scenario) * a_sample;
}

void truth_pack_write(const Truth *truth, void *packed)
{
    char *target = packed;
    memcpy(target, truth, sizeof *truth);
    memcpy(target + sizeof *truth, truth->trajectory, sizeof *truth->trajectory);
    target += sizeof *truth + sizeof *truth->trajectory;
    Part parts[PART_COUNT];
    list_parts(truth->trajectory, parts);
    for (int i = 0; i < PART_COUNT; i++) {
        if (parts[i].size > 0) {
            memcpy(target, parts[i].start, parts[i].size);
        }
        target += parts[i].size;
    }
}

Truth truth_pack_read(const Scenario *scenario, const void *packed)
{
    const char *source = packed;
    Truth truth;
    memcpy(&truth, source, sizeof truth);
    truth.trajectory = trajectory_create(scenario, "");
    Part parts[PART_COUNT];
    list_parts(truth.trajectory, parts);
    const Linkage linkage = truth.trajectory->linkage;
    memcpy(truth.trajectory, source + sizeof truth, sizeof *truth.trajectory);
    // ranges are for the pictures and series of `run`, which has its truth in the same process
    truth.trajectory->ranges = (Ranges){0};
    truth.trajectory->times = parts[0].start;
    truth.trajectory->crank_angles = parts[1].start;
    truth.trajectory->motions = parts[2].start;
    truth.trajectory->states = parts[3].start;
    truth.trajectory->space_motions = parts[4].start;
    truth.trajectory->space_states = parts[5].start;
    truth.trajectory->reach = parts[6].start;
    truth.trajectory->linkage = linkage;
    truth.trajectory->bodies = parts[7].start;
    truth.trajectory->joints = parts[8].start;
    truth.trajectory->alpha_spikes = parts[9].start;
    truth.trajectory->force_spikes = parts[10].start;
    source += sizeof truth + sizeof *truth.trajectory;
    for (int i = 0; i < PART_COUNT; i++) {
        if (parts[i].size > 0) {
            memcpy(parts[i].start, source, parts[i].size);
        }
        source += parts[i].size;
    }
    return truth;
}
