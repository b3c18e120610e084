// Writes the contacts of a run as rows: when each began, how long it lasted, how hard it pressed.
#include "write/contact_table.h"
#include "measure/number_values.h"
#include "write/row_file.h"
#include "write/units.h"

#include <assert.h>
#include <math.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum {
    COLUMNS_MOST = 3 + 2 * NUMBER_COUNT,
    NAME_SIZE = 40, // of a quantity and its unit
};

// Which columns the contacts of a linkage have: those of model/number_list.h with NUMBER_CSV, of
// which those that are forces or lengths stand twice where some joints have torques and angles.
typedef struct ContactTable {
    char names[COLUMNS_MOST][NAME_SIZE];
    const char *heads[COLUMNS_MOST]; // these
    size_t count;
    bool has_crank;
    bool has_turns[2]; // a joint with play of lengths, and one of angles
    bool has_pins;
} ContactTable;

static bool is_column(const Number *number)
{
    return number->owner == NUMBER_OWNER_JOINT_CONTACT && (number->places & NUMBER_CSV) != 0;
}

// Whether all joints have a number in one unit.
static bool is_of_all(const Number *number)
{
    return strcmp(number->keys[NUMBER_PUSHED], number->keys[NUMBER_TURNED]) == 0;
}

static void add_name(ContactTable *table, const char *name)
{
    assert(table->count < COLUMNS_MOST);
    char *head = table->names[table->count];
    snprintf(head, NAME_SIZE, "%s", name);
    table->heads[table->count++] = head;
}

// The names point into the table, which is not to be moved.
static void name_columns(ContactTable *table)
{
    add_name(table, "joint");
    for (NumberId id = 0; id < NUMBER_COUNT; id++) {
        if (is_column(&NUMBERS[id]) && is_of_all(&NUMBERS[id])) {
            add_name(table, NUMBERS[id].keys[NUMBER_PUSHED]);
        }
    }
    if (table->has_crank) {
        add_name(table, "onset_crank_deg");
    }
    for (int turn = NUMBER_PUSHED; turn <= NUMBER_TURNED; turn++) {
        for (NumberId id = 0; table->has_turns[turn] && id < NUMBER_COUNT; id++) {
            if (is_column(&NUMBERS[id]) && !is_of_all(&NUMBERS[id])) {
                add_name(table, NUMBERS[id].keys[turn]);
            }
        }
    }
    if (table->has_pins) {
        add_name(table, "wall_deg");
    }
}

static void find_columns(const Linkage *linkage, ContactTable *table)
{
    *table = (ContactTable){.has_crank = linkage->driver.is_present};
    for (size_t i = 0; i < linkage->joint_count; i++) {
        const Joint *joint = &linkage->joints[i];
        if (linkage_has_play(joint)) {
            table->has_turns[linkage_is_torsional(joint) ? NUMBER_TURNED : NUMBER_PUSHED] = true;
        }
        table->has_pins = table->has_pins || (joint_has_hole(joint->kind) && !linkage->is_spatial);
    }
    name_columns(table);
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

static void write_row(const ContactTable *table, const Trajectory *trajectory,
                      const JointSpike *contact, RowFile *file)
{
    const NumberSource source = {.run = trajectory, .contact = &contact->spike};
    const NumberTurn own =
        number_turn(NUMBER_OWNER_JOINT_CONTACT, &trajectory->linkage, contact->joint);
    row_file_word(file, trajectory->linkage.joints[contact->joint].name);
    for (NumberId id = 0; id < NUMBER_COUNT; id++) {
        if (is_column(&NUMBERS[id]) && is_of_all(&NUMBERS[id])) {
            row_file_number(file, number_find(id, &source, contact->joint).value);
        }
    }
    if (table->has_crank) {
        row_file_number(file, contact->spike.crank_rad * UNITS_DEG);
    }
    for (int turn = NUMBER_PUSHED; turn <= NUMBER_TURNED; turn++) {
        for (NumberId id = 0; table->has_turns[turn] && id < NUMBER_COUNT; id++) {
            if (is_column(&NUMBERS[id]) && !is_of_all(&NUMBERS[id])) {
                const double value = number_find(id, &source, contact->joint).value;
                row_file_number(file, turn == (int)own ? value : NAN);
            }
        }
    }
    if (table->has_pins) {
        row_file_number(file, wall_deg(trajectory, contact));
    }
    row_file_end_row(file);
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

bool contact_table_write(const Trajectory *trajectory, const char *path, Err *err)
{
    ContactTable table;
    find_columns(&trajectory->linkage, &table);
    RowFile file;
    if (!row_file_begin(&file, path, table.heads, table.count, err)) {
        return false;
    }
    if (trajectory->contact_count > 0) {
        qsort(trajectory->contacts, trajectory->contact_count, sizeof *trajectory->contacts,
              compare_onsets);
    }
    for (size_t i = 0; i < trajectory->contact_count; i++) {
        write_row(&table, trajectory, &trajectory->contacts[i], &file);
    }
    return row_file_end(&file, err);
}
