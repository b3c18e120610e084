// Finds the contacts of a run as rows: when each began, how long it lasted, how hard it pressed.
#include "write/contact_table.h"
#include "measure/number_values.h"
#include "write/units.h"

#include <assert.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

static bool is_column(const Number *number)
{
    return number->owner == NUMBER_OWNER_JOINT_CONTACT && (number->places & NUMBER_CSV) != 0;
}

// Whether all joints have a number in one unit.
static bool is_of_all(const Number *number)
{
    return strcmp(number->keys[NUMBER_PUSHED], number->keys[NUMBER_TURNED]) == 0;
}

static void contact_table_add(ContactTable *table, ContactColumn column)
{
    assert(table->count < CONTACT_COLUMN_MAX);
    table->columns[table->count++] = column;
}

// The numbers that are the same for all joints, or those of joints of one kind.
static void add_numbers(ContactTable *table, bool is_alike, NumberTurn turn)
{
    for (NumberId id = 0; id < NUMBER_COUNT; id++) {
        if (is_column(&NUMBERS[id]) && is_of_all(&NUMBERS[id]) == is_alike) {
            contact_table_add(table, (ContactColumn){.name = NUMBERS[id].keys[turn],
                                                     .of = CONTACT_NUMBER,
                                                     .id = id,
                                                     .turn = turn,
                                                     .is_alike = is_alike});
        }
    }
}

ContactTable contact_table_of(const Linkage *linkage)
{
    ContactTable table = {.count = 0};
    // joints with play of lengths, and of angles
    bool has_turns[] = {[NUMBER_PUSHED] = false, [NUMBER_TURNED] = false};
    bool has_pins = false;
    for (size_t i = 0; i < linkage->joint_count; i++) {
        const Joint *joint = &linkage->joints[i];
        if (linkage_has_play(joint)) {
            has_turns[linkage_is_torsional(joint) ? NUMBER_TURNED : NUMBER_PUSHED] = true;
        }
        has_pins = has_pins || (joint_has_hole(joint->kind) && !linkage->is_spatial);
    }
    contact_table_add(&table, (ContactColumn){.name = "joint", .of = CONTACT_JOINT});
    add_numbers(&table, true, NUMBER_PUSHED);
    if (linkage->driver.is_present) {
        contact_table_add(&table, (ContactColumn){.name = "onset_crank_deg", .of = CONTACT_CRANK});
    }
    for (int turn = NUMBER_PUSHED; turn <= NUMBER_TURNED; turn++) {
        if (has_turns[turn]) {
            add_numbers(&table, false, (NumberTurn)turn);
        }
    }
    if (has_pins) {
        contact_table_add(&table, (ContactColumn){.name = "wall_deg", .of = CONTACT_WALL});
    }
    return table;
}

// Where on the wall of its hole a pin pressed most, from the x axis of the body with the hole.
static double wall_deg(const Trajectory *trajectory, const JointSpike *contact)
{
    const Joint *joint = &trajectory->linkage.joints[contact->joint];
    if (!joint_has_hole(joint->kind)) {
        return NAN;
    }
    const double angle = trajectory_angle_at(trajectory, joint->body_a, contact->spike.peak_s);
    const Vec2 at = vec2_rotate(-angle, contact->spike.eccentricity);
    return atan2(at.y, at.x) * UNITS_DEG;
}

double contact_table_number(const ContactColumn *column, const Trajectory *trajectory,
                            const JointSpike *contact)
{
    const NumberSource source = {.run = trajectory, .contact = &contact->spike};
    switch (column->of) {
    case CONTACT_JOINT:
        return (double)contact->joint;
    case CONTACT_CRANK:
        return contact->spike.crank_rad * UNITS_DEG;
    case CONTACT_WALL:
        return wall_deg(trajectory, contact);
    case CONTACT_NUMBER:
        break;
    }
    const bool is_its =
        column->is_alike || column->turn == number_turn(NUMBER_OWNER_JOINT_CONTACT,
                                                        &trajectory->linkage, contact->joint);
    return is_its ? number_find(column->id, &source, contact->joint).value : NAN;
}

static int compare_onsets(const void *a, const void *b)
{
    const JointSpike *one = a;
    const JointSpike *other = b;
    if (one->spike.onset_s != other->spike.onset_s) {
        return one->spike.onset_s < other->spike.onset_s ? -1 : 1;
    }
    return (one->joint > other->joint) - (one->joint < other->joint);
}

void contact_table_sort(const Trajectory *trajectory)
{
    if (trajectory->contact_count > 0) {
        qsort(trajectory->contacts, trajectory->contact_count, sizeof *trajectory->contacts,
              compare_onsets);
    }
}
