// Packs the marks of a run's contacts for a page.
//
// A time between two samples 10^-5 of a run apart would lose most of its digits in 16 bits; it is
// therefore the number of a sample and a share of the interval, each of which loses none that a
// picture shows.
#include "commands/report/report_marks.h"
#include "base/zeroed.h"
#include "write/json_value.h"

#include <math.h>
#include <stdlib.h>

// How many contacts of a joint, the strongest, have more than onset, peak, deepest and end, and how
// short these are: a longer one is seen by its samples.
enum { SHAPED_MOST = 40 };
static const double SHAPED_INTERVALS = 24.0;

// A contact and where it stands among those of its joint.
typedef struct RankedContact {
    const MarkedContact *contact;
    size_t rank; // 0: the strongest
    bool is_kept;
    bool is_shaped;
} RankedContact;

static int by_joint_and_force(const void *a, const void *b)
{
    const MarkedContact *first = ((const RankedContact *)a)->contact;
    const MarkedContact *second = ((const RankedContact *)b)->contact;
    if (first->joint != second->joint) {
        return first->joint < second->joint ? -1 : 1;
    }
    if (first->is_reported != second->is_reported) {
        return first->is_reported ? -1 : 1;
    }
    return (first->force_max < second->force_max) - (first->force_max > second->force_max);
}

static int by_rank(const void *a, const void *b)
{
    const RankedContact *first = a;
    const RankedContact *second = b;
    if (first->rank != second->rank) {
        return first->rank < second->rank ? -1 : 1;
    }
    return (first->contact > second->contact) - (first->contact < second->contact);
}

static int by_place(const void *a, const void *b)
{
    const MarkedContact *first = ((const RankedContact *)a)->contact;
    const MarkedContact *second = ((const RankedContact *)b)->contact;
    return (first > second) - (first < second);
}

// The strongest of a joint come first, and its deepest with them.
static void rank_contacts(RankedContact *ranked, size_t count)
{
    qsort(ranked, count, sizeof *ranked, by_joint_and_force);
    for (size_t first = 0, end; first < count; first = end) {
        size_t deepest = first;
        for (end = first; end < count && ranked[end].contact->joint == ranked[first].contact->joint;
             end++) {
            const MarkedContact *one = ranked[end].contact;
            ranked[end].rank = end - first;
            deepest = one->is_reported && one->depth_max > ranked[deepest].contact->depth_max
                          ? end
                          : deepest;
        }
        ranked[deepest].rank = 0;
    }
}

// Whether a contact has marks between its own four that a picture is better for.
static bool is_shaped(const RankedContact *one, double interval_s)
{
    const ContactMark *marks = one->contact->marks;
    return one->rank < SHAPED_MOST &&
           marks[one->contact->count - 1].time_s - marks[0].time_s < SHAPED_INTERVALS * interval_s;
}

static bool is_shown(const RankedContact *one, size_t mark)
{
    return one->is_kept &&
           (one->is_shaped || one->contact->marks[mark].kind != CONTACT_MARK_BETWEEN);
}

static size_t count_shown(const RankedContact *one)
{
    size_t count = 0;
    for (size_t i = 0; i < one->contact->count; i++) {
        count += is_shown(one, i) ? 1 : 0;
    }
    return count;
}

// Chooses what there is room for, and puts it back into the order of joint and time.
static void choose_contacts(RankedContact *ranked, size_t count, double interval_s, size_t most)
{
    rank_contacts(ranked, count);
    qsort(ranked, count, sizeof *ranked, by_rank);
    size_t room = most;
    for (size_t i = 0; i < count; i++) {
        ranked[i].is_kept = true;
        ranked[i].is_shaped = is_shaped(&ranked[i], interval_s);
        const size_t taken = count_shown(&ranked[i]);
        ranked[i].is_kept = taken <= room;
        room -= ranked[i].is_kept ? taken : 0;
    }
    qsort(ranked, count, sizeof *ranked, by_place);
}

// Where the marks of a joint stand among the kept samples.
typedef struct MarkGrid {
    double from_s;
    double interval_s;
} MarkGrid;

static double sample_of(const MarkGrid *grid, const ContactMark *mark)
{
    return fmax(0.0, floor((mark->time_s - grid->from_s) / grid->interval_s));
}

static double share_of(const MarkGrid *grid, const ContactMark *mark)
{
    return (mark->time_s - grid->from_s) / grid->interval_s - sample_of(grid, mark);
}

// clang-format off
#define REPORT_MARK_LIST(member) \
    member("sample", sample_of(grid, mark)) \
    member("share", share_of(grid, mark)) \
    member("kind", (double)mark->kind) \
    member("ex_m", mark->eccentricity.x) \
    member("ey_m", mark->eccentricity.y) \
    member("force_x_N", mark->force_on_b.x) \
    member("force_y_N", mark->force_on_b.y) \
    member("force", mark->force) \
    member("gap", mark->gap) \
    member("alpha_a_rad_s2", mark->alpha_a) \
    member("alpha_b_rad_s2", mark->alpha_b)
// clang-format on

#define MARK_NAME(name, value) name,
static const char *const MARK_NAMES[] = {REPORT_MARK_LIST(MARK_NAME)};
_Static_assert(sizeof MARK_NAMES / sizeof *MARK_NAMES == REPORT_MARK_VALUES, "values of a mark");

static void take_values(const MarkGrid *grid, const ContactMark *mark,
                        double values[REPORT_MARK_VALUES])
{
    size_t next = 0;
#define MARK_VALUE(name, value) values[next++] = value;
    REPORT_MARK_LIST(MARK_VALUE)
}

void report_signal_place(json_t *object, const PackedSignal *signal)
{
    json_object_set_new(object, "offset", json_integer((json_int_t)signal->offset));
    json_object_set_new(object, "count", json_integer((json_int_t)signal->count));
    json_value_set(object, "low", signal->low);
    json_value_set(object, "slope", signal->slope);
    json_value_set(object, "step", signal->step);
}

static json_t *joint_json(const RankedContact *ranked, size_t count, const MarkGrid *grid,
                          Pack *pack)
{
    size_t shown = 0;
    for (size_t i = 0; i < count; i++) {
        shown += count_shown(&ranked[i]);
    }
    double *columns = zeroed(shown * REPORT_MARK_VALUES, sizeof *columns);
    size_t row = 0;
    for (size_t i = 0; i < count; i++) {
        for (size_t k = 0; k < ranked[i].contact->count; k++) {
            double values[REPORT_MARK_VALUES];
            take_values(grid, &ranked[i].contact->marks[k], values);
            for (size_t v = 0; is_shown(&ranked[i], k) && v < REPORT_MARK_VALUES; v++) {
                columns[v * shown + row] = values[v];
            }
            row += is_shown(&ranked[i], k) ? 1 : 0;
        }
    }
    json_t *signals = json_array();
    for (size_t v = 0; shown > 0 && v < REPORT_MARK_VALUES; v++) {
        const PackedSignal signal = pack_add(pack, columns + v * shown, shown, false);
        json_t *object = json_object();
        json_object_set_new(object, "what", json_string(MARK_NAMES[v]));
        report_signal_place(object, &signal);
        json_array_append_new(signals, object);
    }
    free(columns);
    json_t *joint = json_object();
    json_object_set_new(joint, "joint", json_integer((json_int_t)ranked[0].contact->joint));
    json_object_set_new(joint, "count", json_integer((json_int_t)shown));
    json_object_set_new(joint, "signals", signals);
    return joint;
}

json_t *report_marks_json(const Trajectory *run, double from_s, double interval_s, size_t most,
                          Pack *pack)
{
    json_t *joints = json_array();
    const size_t count = run->marked_count;
    if (count == 0 || !(interval_s > 0.0)) {
        return joints;
    }
    const MarkGrid grid = {from_s, interval_s};
    RankedContact *ranked = zeroed(count, sizeof *ranked);
    for (size_t i = 0; i < count; i++) {
        ranked[i].contact = &run->marked[i];
    }
    choose_contacts(ranked, count, interval_s, most);
    for (size_t first = 0, end; first < count; first = end) {
        end = first;
        while (end < count && ranked[end].contact->joint == ranked[first].contact->joint) {
            end++;
        }
        json_array_append_new(joints, joint_json(ranked + first, end - first, &grid, pack));
    }
    free(ranked);
    return joints;
}
