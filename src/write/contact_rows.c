// Writes the contacts of a run as rows: when each began, how long it lasted, how hard it pressed.
#include "write/contact_rows.h"
#include "base/hermite.h"
#include "write/csv.h"
#include "write/units.h"

#include <math.h>
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

// A joint with play of either kind, or NULL where the linkage has none.
static const Joint *any_joint(const Linkage *linkage, bool is_torsional)
{
    for (size_t i = 0; i < linkage->joint_count; i++) {
        const Joint *joint = &linkage->joints[i];
        if (linkage_has_play(joint) && linkage_is_torsional(joint) == is_torsional) {
            return joint;
        }
    }
    return NULL;
}

static const char *unit_key(const Joint *joint, const ContactColumn *column)
{
    return *(const char *const *)((const char *)joint_units(joint) + column->unit);
}

static bool has_pins(const Linkage *linkage)
{
    for (size_t i = 0; i < linkage->joint_count; i++) {
        if (linkage->joints[i].kind == JOINT_CLEARANCE && !linkage->is_spatial) {
            return true;
        }
    }
    return false;
}

static void contact_rows_write_head(const Linkage *linkage, FILE *stream)
{
    fputs("joint,onset_s,duration_s,peak_s", stream);
    fputs(linkage->driver.is_present ? ",onset_crank_deg" : "", stream);
    for (int turns = 0; turns < 2; turns++) {
        const Joint *joint = any_joint(linkage, turns != 0);
        for (size_t i = 0; joint != NULL && i < COLUMN_COUNT; i++) {
            fprintf(stream, ",%s_%s", COLUMNS[i].name, unit_key(joint, &COLUMNS[i]));
        }
    }
    fputs(has_pins(linkage) ? ",wall_deg\n" : "\n", stream);
}

// The angle of a body at any time, rad, between the samples around it.
static double angle_at(const Trajectory *trajectory, int body, double time_s)
{
    if (body == LINKAGE_GROUND) {
        return 0.0;
    }
    size_t next = 1;
    size_t end = trajectory->sample_count;
    while (next < end) {
        const size_t middle = next + (end - next) / 2;
        if (trajectory->times[middle] < time_s) {
            next = middle + 1;
        } else {
            end = middle;
        }
    }
    const size_t last = trajectory->sample_count - 1;
    next = next < last ? next : last;
    const size_t before = next > 0 ? next - 1 : 0;
    const Motion *a = trajectory_motion(trajectory, before, (size_t)body);
    const Motion *b = trajectory_motion(trajectory, next, (size_t)body);
    if (next == before) {
        return a->angle;
    }
    const double nodes[] = {trajectory->times[before], trajectory->times[next]};
    const double angles[] = {a->angle, b->angle};
    const double speeds[] = {a->omega, b->omega};
    const Hermite between = hermite_fit(2, nodes, angles, speeds);
    return hermite_at(&between, time_s).value;
}

// Where on the wall of its hole a pin pressed most, from the x axis of the body with the hole.
static double contact_rows_wall_deg(const Trajectory *trajectory, const JointSpike *contact)
{
    const Joint *joint = &trajectory->linkage.joints[contact->joint];
    if (joint->kind != JOINT_CLEARANCE) {
        return NAN;
    }
    const double angle = angle_at(trajectory, joint->body_a, contact->spike.peak_s);
    const Vec2 at = vec2_rotate(-angle, contact->spike.eccentricity);
    return atan2(at.y, at.x) * UNITS_DEG;
}

static void contact_rows_write_row(const Trajectory *trajectory, const JointSpike *contact,
                                   FILE *stream)
{
    const Linkage *linkage = &trajectory->linkage;
    const Joint *joint = &linkage->joints[contact->joint];
    const Spike *spike = &contact->spike;
    csv_write_word(stream, joint->name);
    const double times[] = {spike->onset_s, spike->duration_s, spike->peak_s,
                            spike->crank_rad * UNITS_DEG};
    for (size_t i = 0; i < (linkage->driver.is_present ? 4 : 3); i++) {
        fputc(',', stream);
        csv_write_number(stream, times[i]);
    }
    for (int turns = 0; turns < 2; turns++) {
        const bool is_own = linkage_is_torsional(joint) == (turns != 0);
        for (size_t i = 0; any_joint(linkage, turns != 0) != NULL && i < COLUMN_COUNT; i++) {
            fputc(',', stream);
            csv_write_number(stream, is_own ? COLUMNS[i].find(spike) : NAN);
        }
    }
    if (has_pins(linkage)) {
        fputc(',', stream);
        csv_write_number(stream, contact_rows_wall_deg(trajectory, contact));
    }
    fputc('\n', stream);
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

void contact_rows_write(const Trajectory *trajectory, FILE *stream)
{
    contact_rows_write_head(&trajectory->linkage, stream);
    if (trajectory->contact_count == 0) {
        return;
    }
    qsort(trajectory->contacts, trajectory->contact_count, sizeof *trajectory->contacts,
          compare_onsets);
    for (size_t i = 0; i < trajectory->contact_count; i++) {
        contact_rows_write_row(trajectory, &trajectory->contacts[i], stream);
    }
}
