// How does a truth cross a pipe?
//
// Truth | Trajectory | times | crank angles | motions | states, the pointers in the first two
// replaced on arrival.
#include "measure/truth_pack.h"

#include <string.h>

// The four arrays of a trajectory and their sizes in bytes.
typedef struct Part {
    void *start;
    size_t size;
} Part;

enum { PART_COUNT = 4 };

static void list_parts(const Trajectory *trajectory, Part parts[PART_COUNT])
{
    const size_t samples = trajectory->sample_count;
    parts[0] = (Part){trajectory->times, samples * sizeof(double)};
    parts[1] = (Part){trajectory->crank_angles, samples * sizeof(double)};
    parts[2] = (Part){trajectory->motions, samples * trajectory->body_count * sizeof(Motion)};
    parts[3] = (Part){trajectory->states, samples * trajectory->joint_count * sizeof(JointState)};
}

size_t truth_pack_size(const Scenario *scenario)
{
    const Linkage *linkage = &scenario->linkage;
    const size_t a_sample = 2 * sizeof(double) + linkage->body_count * sizeof(Motion) +
                            linkage->joint_count * sizeof(JointState);
    return sizeof(Truth) + sizeof(Trajectory) + scenario_sample_count(scenario) * a_sample;
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
        memcpy(target, parts[i].start, parts[i].size);
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
    memcpy(truth.trajectory, source + sizeof truth, sizeof *truth.trajectory);
    // ranges are for the pictures and series of `run`, which has its truth in the same process
    truth.trajectory->ranges = (Ranges){0};
    truth.trajectory->times = parts[0].start;
    truth.trajectory->crank_angles = parts[1].start;
    truth.trajectory->motions = parts[2].start;
    truth.trajectory->states = parts[3].start;
    source += sizeof truth + sizeof *truth.trajectory;
    for (int i = 0; i < PART_COUNT; i++) {
        memcpy(parts[i].start, source, parts[i].size);
        source += parts[i].size;
    }
    return truth;
}
