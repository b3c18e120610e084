// Finds where the places of all joints with play are in a step.
#include "world/joints.h"

#include "world/pin.h"

static void start_joint(JpJoint *joint)
{
    if (joint->kind == PLAY_PIN) {
        pin_start(joint);
    }
    if (joint->kind == PLAY_PIN || joint->place_count == 0) {
        return;
    }
    Place *place = &joint->places[0];
    const Direction along = coordinate_direction(&joint->coordinate);
    place->line_before = coordinate_read(&joint->coordinate) - joint->rotor.position;
    place->rate_before = direction_rate(&along) - joint->rotor.speed;
}

// The one row of a line.
static void find_line_rows(Place *place)
{
    place->row_count = 1;
    place->rows[0] = place->along;
    place->start[0] = place->line_before;
    place->start_rate[0] = place->rate_before;
}

static void find_joint(JpJoint *joint, bool has_rows)
{
    if (joint->kind == PLAY_PIN) {
        pin_find(joint, has_rows);
    } else if (joint->place_count > 0) {
        Place *place = &joint->places[0];
        place->along = coordinate_direction(&joint->coordinate);
        place->position = coordinate_read(&joint->coordinate) - joint->rotor.position;
    }
    for (size_t i = 0; i < joint->place_count; i++) {
        Place *place = &joint->places[i];
        place->rate = play_rate(joint, place);
        if (has_rows && place->shape == PLACE_LINE) {
            find_line_rows(place);
        }
    }
}

void joints_start(JpWorld *world)
{
    for (JpJoint *joint = world->joints; joint != NULL; joint = joint->next) {
        start_joint(joint);
    }
}

void joints_find(JpWorld *world, bool has_rows)
{
    for (JpJoint *joint = world->joints; joint != NULL; joint = joint->next) {
        find_joint(joint, has_rows);
    }
}

void joints_now(JpJoint *joint, const Place *place, double at[2], double rate[2])
{
    at[1] = rate[1] = 0.0;
    if (joint->kind == PLAY_PIN) {
        pin_now(joint, place, at, rate);
        return;
    }
    const Direction along = coordinate_direction(&joint->coordinate);
    at[0] = coordinate_read(&joint->coordinate) - joint->rotor.position;
    rate[0] = direction_rate(&along) - joint->rotor.speed;
}
