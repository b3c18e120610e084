// Divides a linkage into mechanisms that share nothing but the ground.
//
// Those whose bodies no joint, spring or bushing connects, not by way of the driven body either.
#include "model/components.h"

#include "base/union_find.h"
#include "base/zeroed.h"

// The first body of those that a body is known to be connected with.
static void connect(size_t *parents, int a, int b)
{
    if (a != LINKAGE_GROUND && b != LINKAGE_GROUND) {
        union_find_join(parents, (size_t)a, (size_t)b);
    }
}

// Numbers the mechanisms: by body which one it belongs to. Returns how many there are.
static size_t number_components(const Linkage *linkage, size_t *member_of)
{
    size_t *parents = zeroed(linkage->body_count, sizeof *parents);
    size_t count = 0;
    union_find_start(parents, linkage->body_count);
    for (size_t i = 0; i < linkage->joint_count; i++) {
        connect(parents, linkage->joints[i].body_a, linkage->joints[i].body_b);
    }
    for (size_t i = 0; i < linkage->spring_count; i++) {
        connect(parents, linkage->springs[i].body_a, linkage->springs[i].body_b);
    }
    for (size_t i = 0; i < linkage->bushing_count; i++) {
        connect(parents, linkage->bushings[i].body_a, linkage->bushings[i].body_b);
    }
    // the crank's angle is that of all: what further drives turn goes with it
    for (size_t i = 1; i < linkage_drive_count(linkage); i++) {
        connect(parents, linkage_driven_body(linkage), linkage_drive_body(linkage, i));
    }
    for (size_t i = 0; i < linkage->body_count; i++) {
        const size_t leader = union_find_root(parents, i);
        member_of[i] = leader == i ? count++ : member_of[leader];
    }
    free(parents);
    return count;
}

static size_t member_of_pair(const size_t *member_of, int a, int b)
{
    return member_of[a != LINKAGE_GROUND ? a : b];
}

static size_t member_of_load(const Linkage *linkage, const size_t *member_of, size_t number)
{
    const Load *load = &linkage->loads[number];
    if (load->kind != LOAD_ALONG) {
        return member_of[load->body];
    }
    const Joint *joint = &linkage->joints[load->joint];
    return member_of_pair(member_of, joint->body_a, joint->body_b);
}

static int renumber(const int *own, int body)
{
    return body == LINKAGE_GROUND ? LINKAGE_GROUND : own[body];
}

// Gives a component's teeth the numbers that their pivots have there.
static void renumber_gears(const int *own_joint, Linkage *linkage)
{
    for (size_t i = 0; i < linkage->joint_count; i++) {
        Gear *gear = &linkage->joints[i].gear;
        if (joint_has_teeth(linkage->joints[i].kind)) {
            gear->pivots[0] = own_joint[gear->pivots[0]];
            gear->pivots[1] = own_joint[gear->pivots[1]];
        }
    }
}

// Gives a component the drive of a joint.
static void take_drive(const Linkage *whole, int joint, int own_joint, Linkage *linkage)
{
    const int drive = linkage_drive_of_joint(whole, (size_t)joint);
    if (drive == 0) {
        linkage->driver = whole->driver;
        linkage->driver.joint = own_joint;
    } else if (drive > 0) {
        Driver *further = &linkage->further[linkage->further_count++];
        *further = whole->further[drive - 1];
        further->joint = own_joint;
    }
}

// What the linkage has more than bodies: by component, then with their numbers there.
static void share_out(const Linkage *whole, const size_t *member_of, Component *components,
                      size_t count)
{
    int *own_body = zeroed(whole->body_count, sizeof *own_body);
    int *own_joint = zeroed(whole->joint_count, sizeof *own_joint);
    for (size_t i = 0; i < whole->body_count; i++) {
        Component *component = &components[member_of[i]];
        Linkage *linkage = &component->scenario->linkage;
        own_body[i] = (int)linkage->body_count;
        component->bodies[linkage->body_count] = (int)i;
        linkage->bodies[linkage->body_count++] = whole->bodies[i];
    }
    for (size_t i = 0; i < whole->joint_count; i++) {
        Joint joint = whole->joints[i];
        Component *component = &components[member_of_pair(member_of, joint.body_a, joint.body_b)];
        Linkage *linkage = &component->scenario->linkage;
        joint.body_a = renumber(own_body, joint.body_a);
        joint.body_b = renumber(own_body, joint.body_b);
        own_joint[i] = (int)linkage->joint_count;
        component->joints[linkage->joint_count] = (int)i;
        linkage->joints[linkage->joint_count++] = joint;
        linkage->gap_damper_count += joint.contact.gap_damping > 0.0 ? 1 : 0;
        take_drive(whole, (int)i, own_joint[i], linkage);
        if (whole->torque.table.count > 0 && whole->torque.joint == (int)i) {
            linkage->torque = whole->torque;
            linkage->torque.joint = own_joint[i];
        }
    }
    for (size_t i = 0; i < whole->spring_count; i++) {
        Spring spring = whole->springs[i];
        const size_t number = member_of_pair(member_of, spring.body_a, spring.body_b);
        Linkage *linkage = &components[number].scenario->linkage;
        spring.body_a = renumber(own_body, spring.body_a);
        spring.body_b = renumber(own_body, spring.body_b);
        linkage->springs[linkage->spring_count++] = spring;
    }
    for (size_t i = 0; i < whole->torsion_count; i++) {
        TorsionSpring torsion = whole->torsions[i];
        const Joint *joint = &whole->joints[torsion.joint];
        const size_t number = member_of_pair(member_of, joint->body_a, joint->body_b);
        Linkage *linkage = &components[number].scenario->linkage;
        torsion.joint = own_joint[torsion.joint];
        linkage->torsions[linkage->torsion_count++] = torsion;
    }
    for (size_t i = 0; i < whole->bushing_count; i++) {
        Bushing bushing = whole->bushings[i];
        const size_t number = member_of_pair(member_of, bushing.body_a, bushing.body_b);
        Linkage *linkage = &components[number].scenario->linkage;
        bushing.body_a = renumber(own_body, bushing.body_a);
        bushing.body_b = renumber(own_body, bushing.body_b);
        linkage->bushings[linkage->bushing_count++] = bushing;
    }
    for (size_t i = 0; i < whole->load_count; i++) {
        Load load = whole->loads[i];
        Linkage *linkage = &components[member_of_load(whole, member_of, i)].scenario->linkage;
        if (load.kind == LOAD_ALONG) {
            load.joint = own_joint[load.joint];
        } else {
            load.body = own_body[load.body];
        }
        linkage->loads[linkage->load_count++] = load;
    }
    for (size_t i = 0; i < count; i++) {
        renumber_gears(own_joint, &components[i].scenario->linkage);
    }
    free(own_body);
    free(own_joint);
}

// Counts what each component has.
static LinkageRoom *count_rooms(const Linkage *whole, const size_t *member_of, size_t count)
{
    LinkageRoom *rooms = zeroed(count, sizeof *rooms);
    for (size_t i = 0; i < whole->body_count; i++) {
        rooms[member_of[i]].bodies++;
    }
    for (size_t i = 0; i < whole->joint_count; i++) {
        const Joint *joint = &whole->joints[i];
        rooms[member_of_pair(member_of, joint->body_a, joint->body_b)].joints++;
    }
    for (size_t i = 1; i < linkage_drive_count(whole); i++) {
        rooms[member_of[linkage_driven_body(whole)]].further++;
    }
    for (size_t i = 0; i < whole->spring_count; i++) {
        const Spring *spring = &whole->springs[i];
        rooms[member_of_pair(member_of, spring->body_a, spring->body_b)].springs++;
    }
    for (size_t i = 0; i < whole->torsion_count; i++) {
        const Joint *joint = &whole->joints[whole->torsions[i].joint];
        rooms[member_of_pair(member_of, joint->body_a, joint->body_b)].torsions++;
    }
    for (size_t i = 0; i < whole->bushing_count; i++) {
        const Bushing *bushing = &whole->bushings[i];
        rooms[member_of_pair(member_of, bushing->body_a, bushing->body_b)].bushings++;
    }
    for (size_t i = 0; i < whole->load_count; i++) {
        rooms[member_of_load(whole, member_of, i)].loads++;
    }
    for (size_t i = 0; i < count; i++) {
        rooms[i].profiles = whole->profile_count;
    }
    return rooms;
}

// Each has all profiles, so that cams keep their numbers.
static void take_profiles(const Linkage *whole, Linkage *linkage)
{
    linkage->profile_count = whole->profile_count;
    for (size_t i = 0; i < whole->profile_count; i++) {
        linkage->profiles[i] = whole->profiles[i];
    }
}

size_t components_count(const Linkage *linkage)
{
    size_t *member_of = zeroed(linkage->body_count, sizeof *member_of);
    const size_t count = number_components(linkage, member_of);
    free(member_of);
    return count;
}

Component *components_make(const Scenario *scenario, size_t *count)
{
    const Linkage *whole = &scenario->linkage;
    size_t *member_of = zeroed(whole->body_count, sizeof *member_of);
    *count = number_components(whole, member_of);
    Component *components = zeroed(*count, sizeof *components);
    LinkageRoom *rooms = count_rooms(whole, member_of, *count);
    for (size_t i = 0; i < *count; i++) {
        Component *component = &components[i];
        component->scenario = zeroed(1, sizeof *component->scenario);
        *component->scenario = scenario_around(scenario, linkage_create(rooms[i]));
        component->scenario->linkage.is_spatial = whole->is_spatial;
        take_profiles(whole, &component->scenario->linkage);
        // one without the driver has no revolutions
        component->scenario->run.duration = scenario_duration(scenario);
        component->bodies = zeroed(rooms[i].bodies, sizeof *component->bodies);
        component->joints = zeroed(rooms[i].joints, sizeof *component->joints);
    }
    share_out(whole, member_of, components, *count);
    for (size_t i = 0; i < *count; i++) {
        Component *component = &components[i];
        const Linkage *linkage = &component->scenario->linkage;
        component->sample = sample_create(linkage);
        component->part = (SolverPart){.number = i,
                                       .body_count = linkage->body_count,
                                       .joint_count = linkage->joint_count,
                                       .bodies = component->bodies,
                                       .joints = component->joints};
    }
    free(rooms);
    free(member_of);
    return components;
}

void components_free(Component *components, size_t count, const Solver *solver)
{
    for (size_t i = 0; i < count; i++) {
        if (components[i].state != NULL) {
            solver->close(components[i].state);
        }
        scenario_destroy(components[i].scenario);
        sample_free(&components[i].sample);
        free(components[i].bodies);
        free(components[i].joints);
    }
    free(components);
}

// Writes one body or joint, by its place in the component.
static void show_body(const Component *component, size_t k, Sample *sample)
{
    const int body = component->bodies[k];
    sample->bodies[body] = component->sample.bodies[k];
    if (component->scenario->linkage.is_spatial) {
        sample->space_bodies[body] = component->sample.space_bodies[k];
    }
}

static void show_joint(const Component *component, size_t k, Sample *sample)
{
    const int joint = component->joints[k];
    sample->joints[joint] = component->sample.joints[k];
    if (component->scenario->linkage.is_spatial) {
        sample->space_joints[joint] = component->sample.space_joints[k];
    }
}

void component_show_bodies(const Component *component, Sample *sample)
{
    for (size_t k = 0; k < component->part.body_count; k++) {
        show_body(component, k, sample);
    }
}

void component_show(const Component *component, Sample *sample)
{
    component_show_bodies(component, sample);
    for (size_t k = 0; k < component->part.joint_count; k++) {
        show_joint(component, k, sample);
    }
}

void component_show_some(const Component *component, const SolverSome *some, Sample *sample)
{
    for (size_t n = 0; n < some->body_count; n++) {
        show_body(component, some->bodies[n], sample);
    }
    for (size_t n = 0; n < some->joint_count; n++) {
        show_joint(component, some->joints[n], sample);
    }
}
