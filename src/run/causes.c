// From which joints with play does a force reach a body?
#include "run/causes.h"

#include "base/leaders.h"
#include "base/zeroed.h"

// Whether a body hands on forces from one of its joints to another.
static bool hands_on(const Linkage *linkage, int body)
{
    return body != LINKAGE_GROUND && body != linkage_driven_body(linkage);
}

// By body: the first of those that ideal joints connect with it.
static size_t *connect(const Linkage *linkage)
{
    size_t *leaders = zeroed(linkage->body_count, sizeof *leaders);
    leaders_start(leaders, linkage->body_count);
    for (size_t i = 0; i < linkage->joint_count; i++) {
        const Joint *joint = &linkage->joints[i];
        if (linkage_kind_is_ideal(joint->kind) && hands_on(linkage, joint->body_a) &&
            hands_on(linkage, joint->body_b)) {
            leaders_join(leaders, (size_t)joint->body_a, (size_t)joint->body_b);
        }
    }
    for (size_t i = 0; i < linkage->body_count; i++) {
        leaders[i] = leaders_find(leaders, i);
    }
    return leaders;
}

// The sets whose bodies a joint acts on, two at most; returns how many.
static size_t sets_of(const Linkage *linkage, const size_t *leaders, const Joint *joint,
                      size_t sets[2])
{
    const int bodies[2] = {joint->body_a, joint->body_b};
    size_t count = 0;
    for (size_t end = 0; linkage_has_play(joint) && end < 2; end++) {
        if (hands_on(linkage, bodies[end])) {
            const size_t set = leaders[bodies[end]];
            count += count == 0 || sets[0] != set ? 1 : 0;
            sets[count - 1] = set;
        }
    }
    return count;
}

Causes causes_find(const Linkage *linkage)
{
    size_t *leaders = connect(linkage);
    Causes causes = {
        .firsts = zeroed(linkage->body_count, sizeof *causes.firsts),
        .counts = zeroed(linkage->body_count, sizeof *causes.counts),
        .joints = zeroed(2 * linkage->joint_count, sizeof *causes.joints),
    };
    size_t sets[2];
    for (size_t i = 0; i < linkage->joint_count; i++) {
        for (size_t k = sets_of(linkage, leaders, &linkage->joints[i], sets); k-- > 0;) {
            causes.counts[sets[k]]++;
        }
    }
    for (size_t i = 1; i < linkage->body_count; i++) {
        causes.firsts[i] = causes.firsts[i - 1] + causes.counts[i - 1];
        causes.counts[i - 1] = 0;
    }
    causes.counts[linkage->body_count - 1] = 0;
    for (size_t i = 0; i < linkage->joint_count; i++) {
        for (size_t k = sets_of(linkage, leaders, &linkage->joints[i], sets); k-- > 0;) {
            causes.joints[causes.firsts[sets[k]] + causes.counts[sets[k]]++] = (int)i;
        }
    }
    for (size_t i = 0; i < linkage->body_count; i++) {
        // the first of a set comes before the others
        causes.firsts[i] = causes.firsts[leaders[i]];
        causes.counts[i] = causes.counts[leaders[i]];
    }
    free(leaders);
    return causes;
}

void causes_finish(Causes *causes)
{
    free(causes->firsts);
    free(causes->counts);
    free(causes->joints);
}
