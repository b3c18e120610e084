// Are the verdicts of `jointplay map` right on joints that nobody tuned for, and the same at any
// mass, length and time?
//
// map_verdicts [COUNT [SEED]] draws joints (2000, seed 1). Of each, under every map, the verdict of
// the prediction is held against that of the engine's own impacts, and against that of the same
// joint with mass, length and time scaled by up to 1e6 either way. Exit status 1 where any differs.
#include "random_joint.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

enum { DEFAULT_COUNT = 2000, DEFAULT_SEED = 1, SHOWN = 20 };

static const double SCALE_MOST = 1e6;

typedef struct Tally {
    size_t counts[VERDICT_COUNT];
    size_t wrong;    // the engine says another one
    size_t moved;    // the scaled joint has another one
    double worst[2]; // of a valid one's figures: predicted and delivered; scaled and not
} Tally;

static double draw_scale(unsigned short *state)
{
    return pow(SCALE_MOST, 2.0 * erand48(state) - 1.0);
}

static void try_map(const RandomJoint *joint, const RandomJoint *scaled, int number, OdeMap map,
                    Tally *tally)
{
    ImpactFigures predicted;
    ImpactFigures of_scaled;
    ImpactDelivered delivered;
    const VerdictKind said = random_joint_predict(joint, map, &predicted);
    const VerdictKind again = random_joint_predict(scaled, map, &of_scaled);
    const VerdictKind right = random_joint_deliver(joint, map, &predicted, &delivered);
    tally->counts[said]++;
    if (said == VERDICT_VALID && said == right && said == again) {
        tally->worst[0] =
            fmax(tally->worst[0], random_joint_difference(&delivered.figures, &predicted));
        const double unit[] = {scaled->contact.asked.force_max / joint->contact.asked.force_max,
                               scaled->contact.asked.penetration_max /
                                   joint->contact.asked.penetration_max};
        of_scaled.force_max.mean /= unit[0];
        of_scaled.penetration_max.mean /= unit[1];
        tally->worst[1] = fmax(tally->worst[1], random_joint_difference(&of_scaled, &predicted));
    }
    if (right != said && tally->wrong++ < SHOWN) {
        printf("joint %d, %s, %.3g kg, %.3g m/s, %.3g steps: said %s, is %s %s\n", number,
               OPTIONS_ODE_MAPS[map], joint->contact.impact.mass, joint->contact.impact.speed,
               joint->contact.half_period_s / joint->step_s, VERDICT_NAMES[said],
               right < VERDICT_COUNT ? VERDICT_NAMES[right] : "not measured:", delivered.message);
    }
    if (again != said && tally->moved++ < SHOWN) {
        printf("joint %d, %s: said %s, and %s when scaled\n", number, OPTIONS_ODE_MAPS[map],
               VERDICT_NAMES[said], VERDICT_NAMES[again]);
    }
}

int main(int argc, char **argv)
{
    const int count = argc > 1 ? atoi(argv[1]) : DEFAULT_COUNT;
    const int seed = argc > 2 ? atoi(argv[2]) : DEFAULT_SEED;
    unsigned short state[3] = {(unsigned short)seed, 11, 3};
    Tally tally = {{0}, 0, 0, {0.0, 0.0}};
    for (int i = 0; i < count; i++) {
        const RandomJoint joint = random_joint_draw(state, i);
        const double scales[] = {draw_scale(state), draw_scale(state), draw_scale(state)};
        const RandomJoint scaled = random_joint_scaled(&joint, scales[0], scales[1], scales[2]);
        for (int map = ODE_MAP_TEXTBOOK; map <= ODE_MAP_IMPULSE; map++) {
            try_map(&joint, &scaled, i, (OdeMap)map, &tally);
        }
    }
    printf("%d joints, %d verdicts: %zu wrong in the engine, %zu moved by scaling\n", count,
           count * MAPPING_MAP_COUNT, tally.wrong, tally.moved);
    for (int i = 0; i < VERDICT_COUNT; i++) {
        printf("  %-12s %zu\n", VERDICT_NAMES[i], tally.counts[i]);
    }
    printf("where valid, delivered and predicted differ by at most %.2e, scaled and not by %.2e\n",
           tally.worst[0], tally.worst[1]);
    return tally.wrong + tally.moved > 0;
}
