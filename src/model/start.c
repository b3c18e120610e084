// Walks over the numbers of a start, in one order for writing and reading.
#include "model/start.h"

#include <math.h>
#include <stddef.h>

// Numbers that are written to, or read from; without either they are counted.
typedef struct Walk {
    size_t count;
    double *to;
    const double *from;
} Walk;

static void walk_number(Walk *walk, double *number)
{
    if (walk->to != NULL) {
        walk->to[walk->count] = *number;
    } else if (walk->from != NULL) {
        *number = walk->from[walk->count];
    }
    walk->count++;
}

static void walk_flag(Walk *walk, bool *flag)
{
    double number = *flag ? 1.0 : 0.0;
    walk_number(walk, &number);
    *flag = number != 0.0;
}

// One that may be infinite: then it is the same at every start.
static void walk_limit(Walk *walk, double *limit)
{
    double number = isfinite(*limit) ? *limit : 0.0;
    walk_number(walk, &number);
    *limit = isfinite(*limit) ? number : *limit;
}

static void walk_body(Walk *walk, Body *body, bool is_spatial)
{
    Motion *motion = &body->start;
    double *const plane[] = {
        &motion->position.x, &motion->position.y,     &motion->angle,
        &motion->velocity.x, &motion->velocity.y,     &motion->omega,
        &motion->alpha,      &motion->acceleration.x, &motion->acceleration.y,
    };
    for (size_t i = 0; i < sizeof plane / sizeof *plane; i++) {
        walk_number(walk, plane[i]);
    }
    if (!is_spatial) {
        return;
    }
    BodySpace *space = &body->space;
    walk_flag(walk, &space->is_elsewhere);
    double *const beside[] = {
        &space->height,     &space->velocity_z, &space->omega_x,    &space->omega_y,
        &space->position.x, &space->position.y, &space->position.z, &space->turn.w,
        &space->turn.x,     &space->turn.y,     &space->turn.z,
    };
    for (size_t i = 0; i < sizeof beside / sizeof *beside; i++) {
        walk_number(walk, beside[i]);
    }
}

static void walk_contact(Walk *walk, ContactState *contact)
{
    walk_flag(walk, &contact->is_touching);
    walk_flag(walk, &contact->is_slack);
    walk_flag(walk, &contact->is_released);
    walk_flag(walk, &contact->is_resting);
    walk_number(walk, &contact->impact_speed);
    walk_number(walk, &contact->damping_speed);
    walk_number(walk, &contact->age_s);
}

static void walk_joint(Walk *walk, Joint *joint)
{
    walk_number(walk, &joint->held_angle);
    for (size_t i = 0; joint->friction.law != BRISTLE_REGULARIZED && i < JOINT_PLACES; i++) {
        walk_number(walk, &joint->contacts[i].bend);
    }
    if (!linkage_has_play(joint)) {
        return;
    }
    walk_number(walk, &joint->clearance.start.x);
    walk_number(walk, &joint->clearance.start.y);
    walk_number(walk, &joint->guide.start.x);
    walk_number(walk, &joint->guide.start.y);
    if (linkage_has_teeth_tables(joint)) {
        walk_number(walk, &joint->gear.zero);
    }
    walk_limit(walk, &joint->limits.middle);
    walk_limit(walk, &joint->limits.low);
    walk_limit(walk, &joint->limits.high);
    for (size_t i = 0; i < JOINT_PLACES; i++) {
        walk_contact(walk, &joint->contacts[i]);
    }
}

static size_t walk_start(Walk *walk, Linkage *linkage)
{
    walk_number(walk, &linkage->driver.start);
    for (size_t i = 0; i < linkage->further_count; i++) {
        walk_number(walk, &linkage->further[i].start);
    }
    for (size_t i = 0; i < linkage->body_count; i++) {
        walk_body(walk, &linkage->bodies[i], linkage->is_spatial);
    }
    for (size_t i = 0; i < linkage->joint_count; i++) {
        walk_joint(walk, &linkage->joints[i]);
    }
    for (size_t i = 0; i < linkage->torsion_count; i++) {
        walk_number(walk, &linkage->torsions[i].angle);
    }
    for (size_t i = 0; i < linkage->bushing_count; i++) {
        walk_number(walk, &linkage->bushings[i].angle);
    }
    return walk->count;
}

size_t start_number_count(const Linkage *linkage)
{
    // nothing is written but what stands there
    Linkage same = *linkage;
    return walk_start(&(Walk){.to = NULL}, &same);
}

void start_numbers(const Linkage *linkage, double *numbers)
{
    Linkage same = *linkage;
    walk_start(&(Walk){.to = numbers}, &same);
}

void start_set_numbers(const double *numbers, Linkage *linkage)
{
    walk_start(&(Walk){.from = numbers}, linkage);
}
