// Which start lies beside a start without opening any ideal joint?
//
// Random speeds are added to all bodies; then the nearest speeds that the ideal joints and the
// driver allow are taken.
#include "model/perturb.h"

#include "base/lcg.h"
#include "model/nearest.h"
#include "model/scale.h"

void perturb_start(Scenario *scenario, double relative, unsigned member)
{
    Linkage *linkage = &scenario->linkage;
    const SpeedScale scale = scale_speeds(scenario);
    const int driven = linkage_driven_body(linkage);
    Motion motions[LINKAGE_BODY_MAX];
    uint64_t seed = member;
    for (size_t i = 0; i < linkage->body_count; i++) {
        motions[i] = linkage->bodies[i].start;
        if ((int)i != driven) {
            motions[i].velocity.x += relative * scale.moving * lcg_draw(&seed);
            motions[i].velocity.y += relative * scale.moving * lcg_draw(&seed);
            motions[i].omega += relative * scale.turning * lcg_draw(&seed);
        }
    }
    nearest_speeds(linkage, false, motions);
    for (size_t i = 0; i < linkage->body_count; i++) {
        linkage->bodies[i].start.velocity = motions[i].velocity;
        linkage->bodies[i].start.omega = motions[i].omega;
    }
}
