// Chooses the tree over the bodies of a linkage that leaves short loops.
//
// The cost of an evaluation grows with the loops that run past a body, with the square and more. In
// a row of four-bars one upright may hang on the next by their coupler, and then every foot closes
// a loop with all that is before it; or each hangs on its foot, and all loops have four joints. Two
// trees are made. One takes the joints in the order of the case. The other takes the bodies by how
// far they are from the ground, and hangs each on its youngest neighbour: so loops in a row stay
// with their neighbours, whatever the order of the joints. The tree whose loops are shorter in sum
// is taken, and of equal ones the first.
#include "reference/span.h"

#include "base/heap.h"
#include "base/zeroed.h"

#include <string.h>

static Span span_begin(const Linkage *linkage)
{
    const size_t ends = linkage->body_count + 1;
    Span span = {
        .linkage = linkage,
        .steps = zeroed(linkage->body_count, sizeof *span.steps),
        .is_used = zeroed(linkage->joint_count, sizeof *span.is_used),
        .parents = zeroed(ends, sizeof *span.parents),
        .depths = zeroed(ends, sizeof *span.depths),
        .ranks = zeroed(ends, sizeof *span.ranks),
    };
    for (size_t i = 0; i < ends; i++) {
        span.parents[i] = LINKAGE_GROUND;
        span.ranks[i] = -1;
    }
    span.ranks[0] = span.rank++;
    for (size_t i = 0; i < linkage_drive_count(linkage); i++) {
        span.ranks[linkage_drive_body(linkage, i) + 1] = span.rank++;
        span.is_used[linkage_drive(linkage, i)->joint] = true;
    }
    return span;
}

void span_finish(Span *span)
{
    free(span->steps);
    free(span->is_used);
    free(span->parents);
    free(span->depths);
    free(span->ranks);
}

static bool is_known(const Span *span, int body)
{
    return span->ranks[body + 1] >= 0;
}

static void hang(Span *span, int body, int joint, int parent)
{
    span->steps[span->count++] = (SpanStep){body, joint, parent};
    span->ranks[body + 1] = span->rank++;
    if (joint >= 0) {
        span->is_used[joint] = true;
        span->parents[body + 1] = parent;
        span->depths[body + 1] = span->depths[parent + 1] + 1;
    }
}

static int other_end(const Joint *joint, int body)
{
    return joint->body_a == body ? joint->body_b : joint->body_a;
}

// The ideal joints of each body, and the bodies that wait to be hung up.
typedef struct Waiting {
    size_t *firsts;   // by body, the ground first, and one more: where its joints begin
    int *joints;      // body by body, in the order of the case
    bool *is_waiting; // by body, the ground first: it is in the queue or was
    int *queue;
    size_t first;
    size_t behind;
} Waiting;

static Waiting waiting_create(const Linkage *linkage)
{
    const size_t ends = linkage->body_count + 1;
    Waiting waiting = {
        .firsts = zeroed(ends + 2, sizeof *waiting.firsts),
        .joints = zeroed(2 * linkage->joint_count, sizeof *waiting.joints),
        .is_waiting = zeroed(ends, sizeof *waiting.is_waiting),
        .queue = zeroed(ends, sizeof *waiting.queue),
    };
    // counts two places ahead; after the second pass each begins where the one before ends
    for (int pass = 0; pass < 2; pass++) {
        for (size_t i = 0; i < linkage->joint_count; i++) {
            const int bodies[2] = {linkage->joints[i].body_a, linkage->joints[i].body_b};
            for (int k = 0; joint_is_ideal(linkage->joints[i].kind) && k < 2; k++) {
                if (pass == 0) {
                    waiting.firsts[bodies[k] + 3]++;
                } else {
                    waiting.joints[waiting.firsts[bodies[k] + 2]++] = (int)i;
                }
            }
        }
        for (size_t i = 2; pass == 0 && i < ends + 2; i++) {
            waiting.firsts[i] += waiting.firsts[i - 1];
        }
    }
    return waiting;
}

static void waiting_free(Waiting *waiting)
{
    free(waiting->firsts);
    free(waiting->joints);
    free(waiting->is_waiting);
    free(waiting->queue);
}

static void wait_for(Waiting *waiting, int body)
{
    if (!waiting->is_waiting[body + 1]) {
        waiting->is_waiting[body + 1] = true;
        waiting->queue[waiting->behind++] = body;
    }
}

// Hangs a body on the last of its neighbours that became known, unless it is known itself, and lets
// its other neighbours wait.
static void span_take(Span *span, Waiting *waiting, int body)
{
    const Linkage *linkage = span->linkage;
    int best = -1;
    for (size_t i = waiting->firsts[body + 1]; i < waiting->firsts[body + 2]; i++) {
        const int joint = waiting->joints[i];
        const int other = other_end(&linkage->joints[joint], body);
        wait_for(waiting, other);
        if (!span->is_used[joint] && is_known(span, other) &&
            (best < 0 ||
             span->ranks[other + 1] > span->ranks[other_end(&linkage->joints[best], body) + 1])) {
            best = joint;
        }
    }
    if (!is_known(span, body)) {
        hang(span, body, best, other_end(&linkage->joints[best], body));
    }
}

// The ideal joints of a body that has become known can be used: those that come later than the one
// at hand in the same pass over all joints, the others in the next.
static void open_joints(const Waiting *waiting, int body, HeapItem at, Heap *open)
{
    for (size_t i = waiting->firsts[body + 1]; i < waiting->firsts[body + 2]; i++) {
        const size_t joint = (size_t)waiting->joints[i];
        heap_push(open, joint >= at.second ? at.first : at.first + 1, joint);
    }
}

// Hangs on every body that an unused ideal joint connects with a known one, in passes over the
// joints until none is left. The joints of what is known are open.
static void grow_in_order(Span *span, const Waiting *waiting, Heap *open)
{
    while (open->count > 0) {
        const HeapItem at = heap_pop(open);
        const Joint *joint = &span->linkage->joints[at.second];
        const bool a_known = is_known(span, joint->body_a);
        if (!span->is_used[at.second] && a_known != is_known(span, joint->body_b)) {
            const int child = a_known ? joint->body_b : joint->body_a;
            hang(span, child, (int)at.second, other_end(joint, child));
            open_joints(waiting, child, at, open);
        }
    }
}

static void grow_nearby(Span *span, Waiting *waiting, int root)
{
    wait_for(waiting, root);
    while (waiting->first < waiting->behind) {
        span_take(span, waiting, waiting->queue[waiting->first++]);
    }
}

static Span span_in_order(const Linkage *linkage)
{
    static const HeapItem START = {0, 0};
    Span span = span_begin(linkage);
    Waiting waiting = waiting_create(linkage);
    Heap open = {0};
    open_joints(&waiting, LINKAGE_GROUND, START, &open);
    for (size_t i = 0; i < linkage_drive_count(linkage); i++) {
        open_joints(&waiting, linkage_drive_body(linkage, i), START, &open);
    }
    grow_in_order(&span, &waiting, &open);
    for (int body = 0; body < (int)linkage->body_count; body++) {
        if (!is_known(&span, body)) {
            hang(&span, body, -1, LINKAGE_GROUND);
            open_joints(&waiting, body, START, &open);
            grow_in_order(&span, &waiting, &open);
        }
    }
    heap_finish(&open);
    waiting_free(&waiting);
    return span;
}

static Span span_nearby(const Linkage *linkage)
{
    Span span = span_begin(linkage);
    Waiting waiting = waiting_create(linkage);
    wait_for(&waiting, LINKAGE_GROUND);
    for (size_t i = 1; i < linkage_drive_count(linkage); i++) {
        wait_for(&waiting, linkage_drive_body(linkage, i));
    }
    grow_nearby(&span, &waiting, linkage_driven_body(linkage));
    for (int body = 0; body < (int)linkage->body_count; body++) {
        if (!is_known(&span, body)) {
            hang(&span, body, -1, LINKAGE_GROUND);
            grow_nearby(&span, &waiting, body);
        }
    }
    waiting_free(&waiting);
    return span;
}

// The joints of all loops, each counted in every loop that it is in.
static size_t loop_length(const Span *span)
{
    size_t sum = 0;
    for (size_t i = 0; i < span->linkage->joint_count; i++) {
        const Joint *joint = &span->linkage->joints[i];
        if (span->is_used[i] || !joint_is_ideal(joint->kind)) {
            continue;
        }
        int a = joint->body_a;
        int b = joint->body_b;
        sum++;
        while (a != b && span->depths[a + 1] + span->depths[b + 1] > 0) {
            int *deeper = span->depths[a + 1] >= span->depths[b + 1] ? &a : &b;
            *deeper = span->parents[*deeper + 1];
            sum++;
        }
    }
    return sum;
}

Span span_find(const Linkage *linkage)
{
    Span in_order = span_in_order(linkage);
    Span nearby = span_nearby(linkage);
    const bool is_nearby = loop_length(&nearby) < loop_length(&in_order);
    span_finish(is_nearby ? &in_order : &nearby);
    return is_nearby ? nearby : in_order;
}
