// Whether two scenarios say the same: every number and word, bit for bit. Comparing
// them whole would compare what lies between their members, which nothing sets.
#pragma once

#include "close.h"

#include "casefile/casefile.h"

#include <string.h>

static inline bool same_setting(const CasefileSetting *one, const CasefileSetting *other)
{
    return one->kind == other->kind && one->number_count == other->number_count &&
           one->applies == other->applies && strcmp(one->text, other->text) == 0 &&
           memcmp(one->numbers, other->numbers, one->number_count * sizeof *one->numbers) == 0;
}

// Motions, vectors and clearances are doubles alone: there is nothing between them.
static inline bool same_body(const Body *one, const Body *other)
{
    return strcmp(one->name, other->name) == 0 && one->mass == other->mass &&
           one->inertia == other->inertia &&
           memcmp(&one->start, &other->start, sizeof one->start) == 0;
}

static inline bool same_joint(const Joint *one, const Joint *other)
{
    return strcmp(one->name, other->name) == 0 && one->kind == other->kind &&
           one->body_a == other->body_a && one->body_b == other->body_b &&
           memcmp(&one->anchor_a, &other->anchor_a, sizeof one->anchor_a) == 0 &&
           memcmp(&one->anchor_b, &other->anchor_b, sizeof one->anchor_b) == 0 &&
           memcmp(&one->clearance, &other->clearance, sizeof one->clearance) == 0;
}

// The linkage as it is run, and every setting.
static inline void assert_same_scenario(const Scenario *one, const Scenario *other)
{
    const Linkage *a = &one->linkage;
    const Linkage *b = &other->linkage;
    assert_int_equal(a->body_count, b->body_count);
    for (size_t i = 0; i < a->body_count; i++) {
        assert_true(same_body(&a->bodies[i], &b->bodies[i]));
    }
    assert_int_equal(a->joint_count, b->joint_count);
    for (size_t i = 0; i < a->joint_count; i++) {
        assert_true(same_joint(&a->joints[i], &b->joints[i]));
    }
    assert_int_equal(a->driver.is_present, b->driver.is_present);
    assert_int_equal(a->driver.joint, b->driver.joint);
    assert_true(a->driver.speed == b->driver.speed && a->driver.start == b->driver.start);
    CasefileWalk walks[2] = {casefile_walk(one), casefile_walk(other)};
    CasefileSetting settings[2];
    while (casefile_next(&walks[0], &settings[0])) {
        assert_true(casefile_next(&walks[1], &settings[1]));
        if (!same_setting(&settings[0], &settings[1])) {
            fail_msg("%s differs", settings[0].key);
        }
    }
}
