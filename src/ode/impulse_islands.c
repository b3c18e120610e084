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

// A scope, and whether a body, joint, group or place is in it.
typedef struct ScopeRoom {
    ImpulseScope scope;
    bool *has_body; // owned, as all arrays
    bool *has_joint;
    bool *has_group;
    bool *has_place;
} ScopeRoom;

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
    ScopeRoom scope;    // of the island that is looked at
    SolverSome changed; // of the record
    size_t *changed_joints;
    ScopeRoom some;       // of bodies and joints that are asked for
    KernelSums some_sums; // of their places
    size_t *first_place;  // of a joint, and behind the last
};

static ScopeRoom scope_room_create(const ImpulseView *view)
{
    const Linkage *linkage = &view->scenario->linkage;
    const size_t places = view->kernel->contact_count;
    ScopeRoom room = {.scope.body_count = 0};
    room.scope.bodies = zeroed(linkage->body_count, sizeof *room.scope.bodies);
    room.scope.joints = zeroed(linkage->joint_count, sizeof *room.scope.joints);
    room.scope.part.groups = zeroed(view->groups->count, sizeof *room.scope.part.groups);
    room.scope.part.places = zeroed(places, sizeof *room.scope.part.places);
    room.has_body = zeroed(linkage->body_count, sizeof *room.has_body);
    room.has_joint = zeroed(linkage->joint_count, sizeof *room.has_joint);
    room.has_group = zeroed(view->groups->count, sizeof *room.has_group);
    room.has_place = zeroed(places, sizeof *room.has_place);
    return room;
}

static void scope_room_finish(ScopeRoom *room)
{
    impulse_scope_finish(&room->scope);
    free(room->has_body);
    free(room->has_joint);
    free(room->has_group);
    free(room->has_place);
}

// The first place of each joint.
static size_t *list_first_places(const ImpulseView *view)
{
    const size_t joints = view->scenario->linkage.joint_count;
    size_t *firsts = zeroed(joints + 1, sizeof *firsts);
    for (size_t i = 0; i < view->kernel->contact_count; i++) {
        firsts[view->kernel->contacts[i].joint + 1]++;
    }
    for (size_t i = 0; i < joints; i++) {
        firsts[i + 1] += firsts[i];
    }
    return firsts;
}

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
    islands->scope = scope_room_create(view);
    islands->changed_joints = zeroed(linkage->joint_count + 1, sizeof *islands->changed_joints);
    islands->some = scope_room_create(view);
    islands->some_sums = kernel_sums(rows);
    islands->first_place = list_first_places(view);
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
    scope_room_finish(&islands->scope);
    free(islands->changed_joints);
    scope_room_finish(&islands->some);
    kernel_sums_free(&islands->some_sums);
    free(islands->first_place);
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
    return islands->is_ended ? islands->view->whole : &islands->scope.scope;
}

static void add_joint(ScopeRoom *room, size_t joint)
{
    if (!room->has_joint[joint]) {
        room->has_joint[joint] = true;
        room->scope.joints[room->scope.joint_count++] = joint;
    }
}

static void add_body(ScopeRoom *room, size_t body)
{
    if (!room->has_body[body]) {
        room->has_body[body] = true;
        room->scope.bodies[room->scope.body_count++] = body;
    }
}

static void add_group(const ResponseGroups *groups, size_t group, ScopeRoom *room)
{
    ImpulseScope *scope = &room->scope;
    room->has_group[group] = true;
    scope->part.groups[scope->part.group_count++] = group;
    for (size_t n = groups->first_node[group]; n < groups->first_node[group + 1]; n++) {
        add_joint(room, (size_t)groups->joints[n]);
    }
    for (size_t n = groups->first_body[group]; n < groups->first_body[group + 1]; n++) {
        add_body(room, groups->bodies[n]);
    }
}

// Adds the bodies of a joint, and all that moves with them.
static void add_bodies_of(const ImpulseIslands *islands, const Joint *joint, ScopeRoom *room)
{
    const ResponseGroups *groups = islands->view->groups;
    const int bodies[2] = {joint->body_a, joint->body_b};
    for (int i = 0; i < 2; i++) {
        if (bodies[i] == LINKAGE_GROUND) {
            continue;
        }
        const size_t body = (size_t)bodies[i];
        const size_t group = groups->group_of[body];
        if (group < groups->count && !room->has_group[group]) {
            add_group(groups, group, room);
        }
        add_body(room, body);
        room->scope.has_drive = room->scope.has_drive ||
                                linkage_is_driven(&islands->view->scenario->linkage, bodies[i]);
    }
}

// Adds a place alone.
static void add_place_alone(ScopeRoom *room, size_t place)
{
    if (!room->has_place[place]) {
        room->has_place[place] = true;
        room->scope.part.places[room->scope.part.place_count++] = place;
    }
}

// Adds a place with its joint, its bodies, and all that its impulses move.
static void add_place(const ImpulseIslands *islands, size_t place, ScopeRoom *room)
{
    const size_t number = (size_t)islands->view->islands->all->contacts[place].joint;
    add_place_alone(room, place);
    add_joint(room, number);
    add_bodies_of(islands, &islands->view->scenario->linkage.joints[number], room);
}

// Adds the places that press on the groups of the scope from a number on.
static void add_neighbours(const ImpulseIslands *islands, size_t first, ScopeRoom *room)
{
    const ResponseGroups *groups = islands->view->groups;
    const ResponsePart *part = &room->scope.part;
    for (size_t i = first; i < part->group_count; i++) {
        const size_t group = part->groups[i];
        for (size_t n = groups->first_place[group]; n < groups->first_place[group + 1]; n++) {
            if (islands->view->islands->is_active[groups->places[n]]) {
                add_place_alone(room, groups->places[n]);
            }
        }
    }
}

static void clear_scope(ScopeRoom *room)
{
    ImpulseScope *scope = &room->scope;
    for (size_t i = 0; i < scope->body_count; i++) {
        room->has_body[scope->bodies[i]] = false;
    }
    for (size_t i = 0; i < scope->joint_count; i++) {
        room->has_joint[scope->joints[i]] = false;
    }
    for (size_t i = 0; i < scope->part.group_count; i++) {
        room->has_group[scope->part.groups[i]] = false;
    }
    for (size_t i = 0; i < scope->part.place_count; i++) {
        room->has_place[scope->part.places[i]] = false;
    }
    scope->has_drive = false;
    scope->body_count = scope->joint_count = scope->place_count = 0;
    scope->part.group_count = scope->part.place_count = 0;
    scope->placed = (ResponsePart){.group_count = 0};
}

// Makes the scope that of an island.
static void set_scope(ImpulseIslands *islands, const KernelIsland *island)
{
    ScopeRoom *room = &islands->scope;
    clear_scope(room);
    for (size_t i = 0; i < island->kernel.contact_count; i++) {
        add_place(islands, island->members[i], room);
    }
    room->scope.place_count = room->scope.part.place_count;
    // the places of other blocks that move the bodies of a block
    if (islands->view->islands->is_divided[island->members[0]]) {
        add_neighbours(islands, 0, room);
    }
}

// Writes the sums of an island's rows among those of all.
static void scatter(const Kernel *all, const KernelIsland *island, KernelSums *sums)
{
    for (size_t i = 0; i < island->kernel.contact_count; i++) {
        const KernelContact *joint = &island->kernel.contacts[i];
        const size_t row = all->contacts[island->members[i]].first_row;
        const size_t size = joint->row_count * sizeof(double);
        memcpy(sums->impulse + row, island->sums.impulse + joint->first_row, size);
        memcpy(sums->moment + row, island->sums.moment + joint->first_row, size);
        memcpy(sums->force + row, island->sums.force + joint->first_row, size);
    }
}

// Looks at the islands of a scope's neighbours, but for its own, and writes their sums.
static void look_at_neighbours(const KernelIslands *all, const ImpulseScope *scope, size_t looked,
                               double since_s, KernelSums *sums)
{
    for (size_t i = scope->place_count; i < scope->part.place_count; i++) {
        const size_t number = all->island_of[scope->part.places[i]];
        if (all->is_active[scope->part.places[i]] && number != looked) {
            KernelIsland *island = all->islands[number];
            kernel_island_look(island, kernel_node(&island->kernel, since_s), since_s);
            scatter(all->all, island, sums);
            looked = number;
        }
    }
}

// Looks at the scope's island, and at others that move its bodies, and writes their sums.
static void look_at_scope(ImpulseIslands *islands, const IslandMark *mark)
{
    const KernelIslands *all = islands->view->islands;
    const ImpulseScope *scope = &islands->scope.scope;
    kernel_island_look(all->islands[mark->island], mark->node, mark->time_s);
    scatter(all->all, all->islands[mark->island], &islands->sums);
    look_at_neighbours(all, scope, mark->island, mark->time_s, &islands->sums);
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
    islands->kind->look(islands->own, &islands->scope.scope, at, &islands->sums, part->omega,
                        part->alpha);
    part->record.dissipated = island->sums.dissipated - losses[0];
    part->record.friction = island->sums.friction - losses[1];
    losses[0] = island->sums.dissipated;
    losses[1] = island->sums.friction;
    add_contacts(islands, part, &islands->scope.scope, mark->time_s);
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

// Lists what the last part was of. The drives answer what presses on their bodies.
static void note_changed(ImpulseIslands *islands)
{
    const Linkage *linkage = &islands->view->scenario->linkage;
    const ImpulseScope *scope = impulse_islands_scope(islands);
    islands->changed = (SolverSome){
        .body_count = scope->body_count,
        .joint_count = scope->joint_count,
        .bodies = scope->bodies,
        .joints = scope->joints,
    };
    if (!scope->has_drive || scope->is_whole) {
        return;
    }
    memcpy(islands->changed_joints, scope->joints, scope->joint_count * sizeof *scope->joints);
    islands->changed.joints = islands->changed_joints;
    for (size_t i = 0; i < linkage_drive_count(linkage); i++) {
        const size_t driven = (size_t)linkage_drive(linkage, i)->joint;
        if (!islands->scope.has_joint[driven]) {
            islands->changed_joints[islands->changed.joint_count++] = driven;
        }
    }
}

void impulse_islands_next(ImpulseIslands *islands, ImpulsePart *part)
{
    // what was pushed in the part before is in its record
    const ImpulseScope *recorded =
        islands->next == 0 ? islands->view->whole : &islands->scope.scope;
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
    if (islands->kind->observe_some != NULL) {
        note_changed(islands);
        part->record.changed = &islands->changed;
    }
    part->record.start_s = part->start_s;
    part->record.end_s = part->record.joint_s = part->end_s;
}

// A pin has its rows along x and y, wherever its bodies are.
static bool impulse_islands_is_pin(const Joint *joint)
{
    return joint_has_hole(joint->kind) && joint->limits.kind == LIMIT_NONE;
}

// Adds what an acceleration of a body comes from: the places that press on its group, and where
// one of them is no pin, the bodies at its other end, on which the direction of its rows depends.
static void ask_for_body(const ImpulseIslands *islands, size_t body, ScopeRoom *room)
{
    const ResponseGroups *groups = islands->view->groups;
    const Linkage *linkage = &islands->view->scenario->linkage;
    const size_t group = groups->group_of[body];
    add_body(room, body);
    if (group == groups->count) {
        room->scope.has_drive = true;
        return;
    }
    const size_t first = room->scope.part.group_count;
    if (!room->has_group[group]) {
        add_group(groups, group, room);
    }
    add_neighbours(islands, first, room);
    room->scope.placed = room->scope.part;
    for (size_t i = 0; i < room->scope.placed.place_count; i++) {
        const size_t place = room->scope.part.places[i];
        const Joint *joint = &linkage->joints[islands->view->kernel->contacts[place].joint];
        if (!impulse_islands_is_pin(joint)) {
            add_bodies_of(islands, joint, room);
        }
    }
    add_neighbours(islands, first, room);
}

// Adds what the state of a joint comes from: its places, its bodies and what presses on them. A pin
// that is integrated says it all.
static void ask_for_joint(const ImpulseIslands *islands, size_t joint, ScopeRoom *room)
{
    const Joint *of = &islands->view->scenario->linkage.joints[joint];
    const size_t first = islands->first_place[joint];
    const size_t behind = islands->first_place[joint + 1];
    for (size_t i = first; i < behind; i++) {
        add_place_alone(room, i);
    }
    room->scope.place_count = behind - first;
    add_joint(room, joint);
    if (behind - first == 1 && impulse_islands_is_pin(of) &&
        islands->view->islands->is_active[first]) {
        return;
    }
    add_bodies_of(islands, of, room);
    add_neighbours(islands, 0, room);
}

// Of places that fly nothing is in the sums.
static void clear_flying(const KernelIslands *all, const ImpulseScope *scope, KernelSums *sums)
{
    for (size_t i = 0; i < scope->part.place_count; i++) {
        const size_t place = scope->part.places[i];
        const KernelContact *contact = &all->all->contacts[place];
        const size_t size = contact->row_count * sizeof(double);
        if (!all->is_active[place]) {
            memset(sums->impulse + contact->first_row, 0, size);
            memset(sums->moment + contact->first_row, 0, size);
            memset(sums->force + contact->first_row, 0, size);
        }
    }
}

// Writes the sums of the rows of a scope's places, and of no others of their islands.
static void look_at_rows(const KernelIslands *all, const ImpulseScope *scope, double since_s,
                         KernelSums *sums)
{
    size_t looked = all->count;
    size_t node = 0;
    for (size_t i = 0; i < scope->part.place_count; i++) {
        const size_t place = scope->part.places[i];
        const size_t number = all->island_of[place];
        const size_t row = all->all->contacts[place].first_row;
        if (!all->is_active[place]) {
            continue;
        }
        const Kernel *kernel = &all->islands[number]->kernel;
        node = number != looked ? kernel_node(kernel, since_s) : node;
        looked = number;
        kernel_contact_at(kernel, all->number_in[place], node, since_s, sums->impulse + row,
                          sums->moment + row, sums->force + row);
    }
}

// Looks at the own places of a scope, so that kernel_islands_pose may be asked for them.
static void look_around_places(const KernelIslands *all, const ImpulseScope *scope, double since_s)
{
    for (size_t i = 0; i < scope->place_count; i++) {
        const size_t place = scope->part.places[i];
        if (all->is_active[place]) {
            KernelIsland *island = all->islands[all->island_of[place]];
            kernel_island_look_around(island, all->number_in[place],
                                      kernel_node(&island->kernel, since_s), since_s);
        }
    }
}

bool impulse_islands_observe(ImpulseIslands *islands, double since_s, const SolverSome *some,
                             Sample *sample)
{
    ScopeRoom *room = &islands->some;
    const bool is_body = some->body_count == 1;
    if (some->body_count + some->joint_count != 1 ||
        (!is_body &&
         linkage_drive_of_joint(&islands->view->scenario->linkage, some->joints[0]) >= 0)) {
        return false;
    }
    clear_scope(room);
    if (is_body) {
        ask_for_body(islands, some->bodies[0], room);
    } else {
        ask_for_joint(islands, some->joints[0], room);
    }
    const KernelIslands *all = islands->view->islands;
    clear_flying(all, &room->scope, &islands->some_sums);
    look_at_rows(all, &room->scope, since_s, &islands->some_sums);
    look_around_places(all, &room->scope, since_s);
    const ImpulseTime at = {since_s, 0, true};
    islands->kind->observe_some(islands->own, &room->scope, at, &islands->some_sums, !is_body,
                                sample);
    return true;
}
