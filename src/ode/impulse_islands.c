// Says what a part of a step holds of one island of contacts.
//
// Its bodies, joints and places at a mark of its own. All else is as it was when it was looked at
// last: no contact begins or ends there in between, so that contacts begin, last and end in the
// record when they do. The last part is the end of the step, of all.
#include "ode/impulse.h"

#include "base/zeroed.h"

#include <math.h>
#include <string.h>

// A mark of one of the islands, but for their last.
typedef struct IslandMark {
    double time_s;
    size_t node;
    size_t island;
} IslandMark;

struct ImpulseIslands {
    const ImpulseView *view;
    const ImpulseKind *kind;
    void *own;        // of the kind
    ImpulseSpan span; // of the step
    Marks marks;      // of one island at a time
    size_t count;
    size_t room;
    size_t next; // the first mark that has not been handed on; `count` of the step's end
    bool is_ended;
    IslandMark *order; // of all islands; owned, as are all arrays
    KernelSums sums;
    double *before;       // by row: impulses at the last part
    double (*losses)[2];  // by island: J, likewise
    double *elastic;      // J, by place: what is stored there
    double elastic_total; // J
    bool *is_touching;    // by place
    size_t touching;
    ImpulseScope scope; // of the island that is looked at
    bool *has_body;     // whether it is in the scope
    bool *has_joint;
    bool *has_group;
    bool *has_place;
};

ImpulseIslands *impulse_islands_create(const ImpulseView *view, const ImpulseKind *kind, void *own)
{
    const Linkage *linkage = &view->scenario->linkage;
    const size_t rows = kernel_rows(view->kernel);
    const size_t places = view->kernel->contact_count;
    ImpulseIslands *islands = zeroed(1, sizeof *islands);
    islands->view = view;
    islands->kind = kind;
    islands->own = own;
    islands->is_ended = true;
    islands->sums = kernel_sums(rows);
    islands->before = zeroed(rows, sizeof *islands->before);
    islands->losses = zeroed(places, sizeof *islands->losses);
    islands->elastic = zeroed(places, sizeof *islands->elastic);
    islands->is_touching = zeroed(places, sizeof *islands->is_touching);
    islands->scope.bodies = zeroed(linkage->body_count, sizeof *islands->scope.bodies);
    islands->scope.joints = zeroed(linkage->joint_count, sizeof *islands->scope.joints);
    islands->scope.part.groups = zeroed(view->groups->count, sizeof *islands->scope.part.groups);
    islands->scope.part.places = zeroed(places, sizeof *islands->scope.part.places);
    islands->has_body = zeroed(linkage->body_count, sizeof *islands->has_body);
    islands->has_joint = zeroed(linkage->joint_count, sizeof *islands->has_joint);
    islands->has_group = zeroed(view->groups->count, sizeof *islands->has_group);
    islands->has_place = zeroed(places, sizeof *islands->has_place);
    return islands;
}

void impulse_islands_destroy(ImpulseIslands *islands)
{
    if (islands == NULL) {
        return;
    }
    marks_finish(&islands->marks);
    free(islands->order);
    kernel_sums_free(&islands->sums);
    free(islands->before);
    free(islands->losses);
    free(islands->elastic);
    free(islands->is_touching);
    impulse_scope_finish(&islands->scope);
    free(islands->has_body);
    free(islands->has_joint);
    free(islands->has_group);
    free(islands->has_place);
    free(islands);
}

static int compare_marks(const void *a, const void *b)
{
    const IslandMark *first = a;
    const IslandMark *second = b;
    if (first->time_s != second->time_s) {
        return first->time_s < second->time_s ? -1 : 1;
    }
    if (first->island != second->island) {
        return first->island < second->island ? -1 : 1;
    }
    return (first->node > second->node) - (first->node < second->node);
}

// Lists the marks of an island but for that of the step's end.
static void list_marks(ImpulseIslands *islands, size_t number)
{
    const KernelIsland *island = islands->view->islands->islands[number];
    marks_find(&islands->marks, &island->kernel);
    const size_t count = islands->marks.count - 1;
    if (islands->count + count > islands->room) {
        islands->room = 2 * (islands->count + count);
        islands->order = realloc(islands->order, islands->room * sizeof *islands->order);
        assert(islands->order != NULL);
    }
    for (size_t i = 0; i < count; i++) {
        const Mark *mark = &islands->marks.marks[i];
        islands->order[islands->count++] = (IslandMark){mark->time_s, mark->node, number};
    }
    // rows of islands differ
    marks_finish(&islands->marks);
}

void impulse_islands_begin(ImpulseIslands *islands, const ImpulseSpan *span, ImpulsePart *part)
{
    const KernelIslands *all = islands->view->islands;
    islands->span = *span;
    islands->count = islands->next = 0;
    islands->is_ended = false;
    for (size_t i = 0; i < all->count; i++) {
        list_marks(islands, i);
        islands->losses[i][0] = islands->losses[i][1] = 0.0;
    }
    if (islands->count > 0) {
        qsort(islands->order, islands->count, sizeof *islands->order, compare_marks);
    }
    memset(islands->before, 0, kernel_rows(all->all) * sizeof *islands->before);
    part->end_s = islands->span.start_s;
}

bool impulse_islands_need_step(const ImpulseIslands *islands)
{
    return islands->is_ended;
}

const ImpulseScope *impulse_islands_scope(const ImpulseIslands *islands)
{
    return islands->is_ended ? islands->view->whole : &islands->scope;
}

static void add_group(ImpulseIslands *islands, size_t group)
{
    const ResponseGroups *groups = islands->view->groups;
    ImpulseScope *scope = &islands->scope;
    islands->has_group[group] = true;
    scope->part.groups[scope->part.group_count++] = group;
    for (size_t n = groups->first_node[group]; n < groups->first_node[group + 1]; n++) {
        const size_t joint = (size_t)groups->joints[n];
        if (!islands->has_joint[joint]) {
            islands->has_joint[joint] = true;
            scope->joints[scope->joint_count++] = joint;
        }
    }
    for (size_t n = groups->first_body[group]; n < groups->first_body[group + 1]; n++) {
        if (!islands->has_body[groups->bodies[n]]) {
            islands->has_body[groups->bodies[n]] = true;
            scope->bodies[scope->body_count++] = groups->bodies[n];
        }
    }
}

// Adds a place with its joint, its bodies, and all that its impulses move.
static void add_place(ImpulseIslands *islands, size_t place)
{
    const ResponseGroups *groups = islands->view->groups;
    const size_t number = (size_t)islands->view->islands->all->contacts[place].joint;
    const Joint *joint = &islands->view->scenario->linkage.joints[number];
    const int driven = linkage_driven_body(&islands->view->scenario->linkage);
    const int bodies[2] = {joint->body_a, joint->body_b};
    ImpulseScope *scope = &islands->scope;
    scope->part.places[scope->part.place_count++] = place;
    islands->has_place[place] = true;
    if (!islands->has_joint[number]) {
        islands->has_joint[number] = true;
        scope->joints[scope->joint_count++] = number;
    }
    for (int i = 0; i < 2; i++) {
        if (bodies[i] == LINKAGE_GROUND) {
            continue;
        }
        const size_t body = (size_t)bodies[i];
        const size_t group = groups->group_of[body];
        if (group < groups->count && !islands->has_group[group]) {
            add_group(islands, group);
        }
        if (!islands->has_body[body]) {
            islands->has_body[body] = true;
            scope->bodies[scope->body_count++] = body;
        }
        scope->has_drive = scope->has_drive || bodies[i] == driven;
    }
}

// Adds the places of other blocks that move the bodies of a block.
static void add_neighbours(ImpulseIslands *islands)
{
    const ResponseGroups *groups = islands->view->groups;
    ResponsePart *part = &islands->scope.part;
    for (size_t i = 0; i < part->group_count; i++) {
        const size_t group = part->groups[i];
        for (size_t n = groups->first_place[group]; n < groups->first_place[group + 1]; n++) {
            const size_t place = groups->places[n];
            if (islands->view->islands->is_active[place] && !islands->has_place[place]) {
                islands->has_place[place] = true;
                part->places[part->place_count++] = place;
            }
        }
    }
}

// Makes the scope that of an island.
static void set_scope(ImpulseIslands *islands, const KernelIsland *island)
{
    ImpulseScope *scope = &islands->scope;
    for (size_t i = 0; i < scope->body_count; i++) {
        islands->has_body[scope->bodies[i]] = false;
    }
    for (size_t i = 0; i < scope->joint_count; i++) {
        islands->has_joint[scope->joints[i]] = false;
    }
    for (size_t i = 0; i < scope->part.group_count; i++) {
        islands->has_group[scope->part.groups[i]] = false;
    }
    for (size_t i = 0; i < scope->part.place_count; i++) {
        islands->has_place[scope->part.places[i]] = false;
    }
    scope->has_drive = false;
    scope->body_count = scope->joint_count = 0;
    scope->part.group_count = scope->part.place_count = 0;
    for (size_t i = 0; i < island->kernel.contact_count; i++) {
        add_place(islands, island->members[i]);
    }
    scope->place_count = scope->part.place_count;
    if (islands->view->islands->is_divided[island->members[0]]) {
        add_neighbours(islands);
    }
}

// Writes the sums of an island's rows among those of all.
static void scatter(ImpulseIslands *islands, const KernelIsland *island)
{
    const Kernel *all = islands->view->islands->all;
    for (size_t i = 0; i < island->kernel.contact_count; i++) {
        const KernelContact *joint = &island->kernel.contacts[i];
        const size_t row = all->contacts[island->members[i]].first_row;
        const size_t size = joint->row_count * sizeof(double);
        memcpy(islands->sums.impulse + row, island->sums.impulse + joint->first_row, size);
        memcpy(islands->sums.moment + row, island->sums.moment + joint->first_row, size);
        memcpy(islands->sums.force + row, island->sums.force + joint->first_row, size);
    }
}

// Looks at the scope's island, and at others that move its bodies, and writes their sums.
static void look_at_scope(ImpulseIslands *islands, const IslandMark *mark)
{
    const KernelIslands *all = islands->view->islands;
    const ImpulseScope *scope = &islands->scope;
    kernel_island_look(all->islands[mark->island], mark->node, mark->time_s);
    scatter(islands, all->islands[mark->island]);
    size_t looked = mark->island;
    for (size_t i = scope->place_count; i < scope->part.place_count; i++) {
        const size_t number = all->island_of[scope->part.places[i]];
        if (number != looked) {
            KernelIsland *other = all->islands[number];
            kernel_island_look(other, kernel_node(&other->kernel, mark->time_s), mark->time_s);
            scatter(islands, other);
            looked = number;
        }
    }
}

// Adds the contacts of a scope's places to the record.
static void add_contacts(ImpulseIslands *islands, ImpulsePart *part, const ImpulseScope *scope,
                         double since_s)
{
    const KernelIslands *all = islands->view->islands;
    const bool *counts = islands->view->counts;
    for (size_t n = 0; n < scope->joint_count; n++) {
        part->is_known[scope->joints[n]] = false;
    }
    for (size_t n = 0; n < scope->place_count; n++) {
        const size_t i = scope->part.places[n];
        const KernelContact *place = &all->all->contacts[i];
        const double *impulse = islands->sums.impulse + place->first_row;
        double *before = islands->before + place->first_row;
        const bool is_touching = kernel_islands_pose(all, i, since_s, &islands->sums).is_touching;
        const double elastic =
            is_touching ? force_law_energy(&place->law, islands->view->depths[i]) : 0.0;
        const double pushed = hypot(impulse[0] - before[0], impulse[1] - before[1]);
        islands->elastic_total += elastic - islands->elastic[i];
        islands->elastic[i] = elastic;
        islands->touching += (is_touching ? 1 : 0);
        islands->touching -= (islands->is_touching[i] ? 1 : 0);
        islands->is_touching[i] = is_touching;
        if (counts == NULL || counts[i]) {
            impulse_part_add_place(part, place, is_touching, pushed);
        }
        before[0] = impulse[0];
        before[1] = impulse[1];
    }
    part->record.elastic = islands->elastic_total;
    part->most_rows = islands->touching > part->most_rows ? islands->touching : part->most_rows;
}

// The part up to a mark of an island.
static void take_island(ImpulseIslands *islands, ImpulsePart *part, const IslandMark *mark)
{
    KernelIsland *island = islands->view->islands->islands[mark->island];
    double *losses = islands->losses[mark->island];
    set_scope(islands, island);
    look_at_scope(islands, mark);
    part->end_s = islands->span.start_s + mark->time_s;
    const ImpulseTime at = {mark->time_s, mark->node, true};
    islands->kind->look(islands->own, &islands->scope, at, &islands->sums, part->omega,
                        part->alpha);
    part->record.dissipated = island->sums.dissipated - losses[0];
    part->record.friction = island->sums.friction - losses[1];
    losses[0] = island->sums.dissipated;
    losses[1] = island->sums.friction;
    add_contacts(islands, part, &islands->scope, mark->time_s);
}

// The part up to the end of the step.
static void take_end(ImpulseIslands *islands, ImpulsePart *part)
{
    const KernelIslands *all = islands->view->islands;
    const ImpulseScope *whole = islands->view->whole;
    const ImpulseSpan *span = &islands->span;
    kernel_islands_look(islands->view->islands, span->width_s, &islands->sums);
    part->end_s = span->end_s;
    const ImpulseTime at = {span->width_s, 0, false};
    islands->kind->look(islands->own, whole, at, &islands->sums, part->omega, part->alpha);
    part->record.dissipated = islands->sums.dissipated + span->damped;
    part->record.friction = islands->sums.friction;
    for (size_t i = 0; i < all->count; i++) {
        part->record.dissipated -= islands->losses[i][0];
        part->record.friction -= islands->losses[i][1];
    }
    part->record.drive_work = span->drive_work;
    part->record.load_work = span->load_work;
    // of ideal joints in the whole step
    for (size_t i = 0; i < whole->joint_count; i++) {
        part->impulse[i] = islands->kind->mean(islands->own, i) * span->width_s;
    }
    // what rounding left of sums of differences ends here
    memset(islands->elastic, 0, all->all->contact_count * sizeof *islands->elastic);
    islands->elastic_total = 0.0;
    add_contacts(islands, part, whole, span->width_s);
    islands->is_ended = true;
}

void impulse_islands_next(ImpulseIslands *islands, ImpulsePart *part)
{
    // what was pushed in the part before is in its record
    const ImpulseScope *recorded = islands->next == 0 ? islands->view->whole : &islands->scope;
    for (size_t n = 0; n < recorded->joint_count; n++) {
        part->impulse[recorded->joints[n]] = 0.0;
    }
    part->start_s = part->end_s;
    part->is_last = islands->next == islands->count;
    part->record = (StepRecord){
        .omega = part->omega,
        .alpha = part->alpha,
        .joints = islands->view->joints,
        .space_joints = islands->view->space_joints,
        .impulse = part->impulse,
        .approach = part->approach,
    };
    if (part->is_last) {
        take_end(islands, part);
    } else {
        take_island(islands, part, &islands->order[islands->next++]);
    }
    part->record.start_s = part->start_s;
    part->record.end_s = part->record.joint_s = part->end_s;
}
