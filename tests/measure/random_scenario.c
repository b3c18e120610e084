#include "random_scenario.h"

#include "../support/kept.h"
#include "../support/of_one_start.h"

#include "casefile/casefile.h"
#include "model/distance.h"

#include <assert.h>
#include <stdlib.h>

bool random_scenario(const CaseKind *kind, uint64_t seed, const char *const *settings, size_t count,
                     Scenario *scenario, Err *err)
{
    char *text = NULL;
    size_t size = 0;
    FILE *file = open_memstream(&text, &size);
    assert(file != NULL);
    kind->write(seed, file);
    fclose(file);
    const char **all = calloc(count + OF_ONE_START_MAX, sizeof *all);
    assert(all != NULL);
    const size_t used = of_one_start(settings, count, all);
    const bool is_loaded = casefile_load_text("random case", text, size, all, used, scenario, err);
    free(all);
    free(text);
    return is_loaded;
}

// A point of the ground goes along, one of a body stays where it is in the body.
static void move_anchor(int body, Vec2 *anchor, Vec2 by)
{
    if (body == LINKAGE_GROUND) {
        *anchor = vec2_add(*anchor, by);
    }
}

static const Vec2 BY = {0.0721, -0.0413}; // m

Scenario moved_scenario(const Scenario *scenario, double tolerance)
{
    Scenario other = kept_copy(scenario);
    Linkage *linkage = &other.linkage;
    for (size_t i = 0; i < linkage->body_count; i++) {
        linkage->bodies[i].start.position = vec2_add(linkage->bodies[i].start.position, BY);
    }
    for (size_t i = 0; i < linkage->joint_count; i++) {
        Joint *joint = &linkage->joints[i];
        move_anchor(joint->body_a, &joint->anchor_a, BY);
        move_anchor(joint->body_b, &joint->anchor_b, BY);
    }
    for (size_t i = 0; i < linkage->spring_count; i++) {
        Spring *spring = &linkage->springs[i];
        move_anchor(spring->body_a, &spring->anchor_a, BY);
        move_anchor(spring->body_b, &spring->anchor_b, BY);
    }
    for (size_t i = 0; i < linkage->bushing_count; i++) {
        Bushing *bushing = &linkage->bushings[i];
        move_anchor(bushing->body_a, &bushing->anchor_a, BY);
        move_anchor(bushing->body_b, &bushing->anchor_b, BY);
    }
    // closed forms are of a pivot at the origin
    other.has_fourbar = false;
    other.has_slidercrank = false;
    other.reference.tolerance = tolerance;
    return other;
}

void move_back(Trajectory *moved)
{
    for (size_t i = 0; i < moved->sample_count * moved->body_count; i++) {
        moved->motions[i].position = vec2_sub(moved->motions[i].position, BY);
    }
}

double apart_until(const Trajectory *run, const Trajectory *judge, const Trajectory *scale,
                   double until_s)
{
    DistanceMeasure measure = distance_measure(scale);
    double largest = 0.0;
    for (size_t k = 0; k < judge->sample_count && judge->times[k] <= until_s; k++) {
        const double error = distance_apart(&measure, distance_motion_at(run, k),
                                            distance_motion_at(judge, k), NULL);
        largest = error <= largest ? largest : error;
    }
    distance_finish(&measure);
    return largest;
}
