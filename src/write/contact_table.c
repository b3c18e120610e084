// Writes the contacts of a run as rows: when each began, how long it lasted, how hard it pressed.
#include "write/contact_table.h"
#include "base/hermite.h"
#include "write/row_file.h"
#include "write/units.h"

#include <assert.h>
#include <math.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>

// The numbers that have the units of what touches: N and m, or N m and rad where limits turn.

typedef double SpikeValue(const Spike *spike);

static double force_max(const Spike *spike)
{
    return spike->force_max;
}

static double impulse(const Spike *spike)
{
    return spike->impulse;
}

static double approach_speed(const Spike *spike)
{
    return spike->approach_speed;
}

static double penetration_max(const Spike *spike)
{
    return spike->penetration_max;
}

typedef struct ContactColumn {
    const char *name;
    size_t unit; // offset in JointUnits
    SpikeValue *find;
} ContactColumn;

static const ContactColumn COLUMNS[] = {
    {"force_max", offsetof(JointUnits, force_key), force_max},
    {"impulse", offsetof(JointUnits, impulse_key), impulse},
    {"approach_speed", offsetof(JointUnits, speed_key), approach_speed},
    {"penetration_max", offsetof(JointUnits, length_key), penetration_max},
};
enum { COLUMN_COUNT = sizeof COLUMNS / sizeof *COLUMNS };

enum {
    NAMES_MOST = 6 + 2 * COLUMN_COUNT,
    NAME_SIZE = 40, // of a quantity and its unit
};

// Which columns the contacts of a linkage have.
typedef struct ContactTable {
    char names[NAMES_MOST][NAME_SIZE];
    const char *heads[NAMES_MOST]; // these
    size_t count;
    bool has_crank;
    const Joint *kinds[2]; // a joint with play of lengths, and one of angles; NULL without
    bool has_pins;
} ContactTable;

static void add_name(ContactTable *table, const char *name, const char *unit)
{
    assert(table->count < NAMES_MOST);
    char *head = table->names[table->count];
    snprintf(head, NAME_SIZE, "%s%s%s", name, unit[0] != '\0' ? "_" : "", unit);
    table->heads[table->count++] = head;
}

// The names point into the table, which is not to be moved.
static void name_columns(ContactTable *table)
{
    static const char *const OF_ALL[] = {"joint", "onset_s", "duration_s", "peak_s"};
    for (size_t i = 0; i < sizeof OF_ALL / sizeof *OF_ALL; i++) {
        add_name(table, OF_ALL[i], "");
    }
    if (table->has_crank) {
        add_name(table, "onset_crank_deg", "");
    }
    for (size_t kind = 0; kind < 2; kind++) {
        const Joint *joint = table->kinds[kind];
        for (size_t i = 0; joint != NULL && i < COLUMN_COUNT; i++) {
            const char *units = (const char *)joint_units(joint);
            add_name(table, COLUMNS[i].name, *(const char *const *)(units + COLUMNS[i].unit));
        }
    }
    if (table->has_pins) {
        add_name(table, "wall_deg", "");
    }
}

static void find_columns(const Linkage *linkage, ContactTable *table)
{
    *table = (ContactTable){.has_crank = linkage->driver.is_present};
    for (size_t i = 0; i < linkage->joint_count; i++) {
        const Joint *joint = &linkage->joints[i];
        if (linkage_has_play(joint)) {
            table->kinds[linkage_is_torsional(joint) ? 1 : 0] = joint;
        }
        table->has_pins =
            table->has_pins || (joint->kind == JOINT_CLEARANCE && !linkage->is_spatial);
    }
    name_columns(table);
}

// The angle of a body at any time, rad, between the samples around it.
static double angle_at(const Trajectory *trajectory, int body, double time_s)
{
    if (body == LINKAGE_GROUND) {
        return 0.0;
    }
    const size_t samples = trajectory->sample_count;
    if (samples < 2) {
        return trajectory_motion(trajectory, 0, (size_t)body)->angle;
    }
    // samples are as far apart from each other as the first two
    const double *times = trajectory->times;
    const double number = floor(time_s / times[1]);
    const size_t before = number < (double)(samples - 2) ? (size_t)number : samples - 2;
    const Motion *a = trajectory_motion(trajectory, before, (size_t)body);
    const Motion *b = trajectory_motion(trajectory, before + 1, (size_t)body);
    const double angles[] = {a->angle, b->angle};
    const double speeds[] = {a->omega, b->omega};
    const Hermite between = hermite_fit(2, &times[before], angles, speeds);
    return hermite_at(&between, time_s).value;
}

// Where on the wall of its hole a pin pressed most, from the x axis of the body with the hole.
static double wall_deg(const Trajectory *trajectory, const JointSpike *contact)
{
    const Joint *joint = &trajectory->linkage.joints[contact->joint];
    if (joint->kind != JOINT_CLEARANCE) {
        return NAN;
    }
    const double angle = angle_at(trajectory, joint->body_a, contact->spike.peak_s);
    const Vec2 at = vec2_rotate(-angle, contact->spike.eccentricity);
    return atan2(at.y, at.x) * UNITS_DEG;
}

static void write_row(const ContactTable *table, const Trajectory *trajectory,
                      const JointSpike *contact, RowFile *file)
{
    const Joint *joint = &trajectory->linkage.joints[contact->joint];
    const Spike *spike = &contact->spike;
    row_file_word(file, joint->name);
    row_file_number(file, spike->onset_s);
    row_file_number(file, spike->duration_s);
    row_file_number(file, spike->peak_s);
    if (table->has_crank) {
        row_file_number(file, spike->crank_rad * UNITS_DEG);
    }
    for (size_t kind = 0; kind < 2; kind++) {
        const bool is_own = linkage_is_torsional(joint) == (kind == 1);
        for (size_t i = 0; table->kinds[kind] != NULL && i < COLUMN_COUNT; i++) {
            row_file_number(file, is_own ? COLUMNS[i].find(spike) : NAN);
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
