// From which joints with play does a force reach a body?
#include "run/causes.h"

#include "base/grouped.h"
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

// The set that one end of a joint with play acts on; none where its other end does already.
static size_t set_of(const Linkage *linkage, const size_t *leaders, size_t end)
{
    const Joint *joint = &linkage->joints[end / 2];
    const bool is_a = end % 2 == 0;
    const int body = is_a ? joint->body_a : joint->body_b;
    if (!linkage_has_play(joint) || !hands_on(linkage, body)) {
        return GROUPED_NONE;
    }
    const size_t set = leaders[body];
    return !is_a && set_of(linkage, leaders, end - 1) == set ? GROUPED_NONE : set;
}

Causes causes_find(const Linkage *linkage)
{
    const size_t ends = 2 * linkage->joint_count;
    Causes causes = {
        .set_of = connect(linkage),
        .firsts = zeroed(linkage->body_count + 1, sizeof *causes.firsts),
        .ends = zeroed(ends, sizeof *causes.ends),
    };
    size_t *sets = zeroed(ends, sizeof *sets);
    for (size_t i = 0; i < ends; i++) {
        sets[i] = set_of(linkage, causes.set_of, i);
    }
    grouped_list(linkage->body_count, ends, sets, causes.firsts, causes.ends);
    free(sets);
    return causes;
}

void causes_finish(Causes *causes)
{
    free(causes->set_of);
    free(causes->firsts);
    free(causes->ends);
}
