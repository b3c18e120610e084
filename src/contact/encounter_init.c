// What does an encounter consist of, and how much room does it take?
//
// Arrays by joint and by row grow as joints are added. Mobilities stand in rows, of which each has
// the columns next to its diagonal: rows times columns of few rows, else in proportion to the rows.
#include "contact/encounter.h"

#include "base/zeroed.h"
#include "contact/encounter_force.h"
#include "contact/encounter_stiff.h"

#include <math.h>
#include <string.h>

// rad: of implicit steps, where the phase is not given
static const double STIFF_PHASE = 0.05;

Encounter encounter_start(double phase)
{
    return (Encounter){
        .phase = phase,
        .stiff_phase = phase > 0.0 ? phase : STIFF_PHASE,
        .stable = 2.0,
        .event_most = SIZE_MAX,
        .longest_s = {INFINITY, INFINITY},
    };
}

size_t encounter_rows(const Encounter *encounter)
{
    return encounter->row_count;
}

static void grow(Encounter *encounter, size_t rows)
{
    if (encounter->joint_count == encounter->joint_room) {
        const size_t room = 2 * encounter->joint_room + 1;
        encounter->joints = memory_grown(encounter->joints, room, sizeof *encounter->joints);
        encounter->joint_room = room;
    }
    while (encounter->row_count + rows > encounter->row_room) {
        const size_t room = 2 * encounter->row_room + ENCOUNTER_ROWS_PLAIN;
        encounter->joint_of = memory_grown(encounter->joint_of, room, sizeof *encounter->joint_of);
        encounter->row_room = room;
    }
}

void encounter_add(Encounter *encounter, const EncounterJoint *joint, size_t rows)
{
    grow(encounter, rows);
    EncounterJoint *added = &encounter->joints[encounter->joint_count];
    *added = *joint;
    added->first_row = encounter->row_count;
    added->row_count = rows;
    added->has_friction =
        added->law.friction > 0.0 && (rows > ENCOUNTER_ROWS_PLAIN || added->shape == TOUCH_LINE);
    for (size_t i = 0; i < rows; i++) {
        encounter->joint_of[encounter->row_count++] = (int)encounter->joint_count;
    }
    encounter->joint_count++;
}

EncounterPoint encounter_point(size_t rows, size_t joints)
{
    // one piece of memory, so that there is no moment at which half of it has no owner
    const size_t bytes = 5 * rows * sizeof(double);
    double *numbers = zeroed(1, bytes + joints * sizeof(EncounterPlaced));
    return (EncounterPoint){
        .placed = (EncounterPlaced *)(numbers + 5 * rows),
        .impulse = numbers,
        .moment = numbers + rows,
        .force = numbers + 3 * rows,
        .rate = numbers + 4 * rows,
    };
}

void encounter_point_free(EncounterPoint *point)
{
    free(point->impulse);
    *point = (EncounterPoint){.time_s = 0.0};
}

// The encounter owns it before it is filled.
static void make_work(Encounter *encounter)
{
    const size_t rows = encounter->row_count;
    const size_t joints = encounter->joint_count;
    EncounterWork *work = encounter->work = zeroed(1, sizeof *work);
    work->ends[0] = encounter_point(rows, joints);
    work->ends[1] = encounter_point(rows, joints);
    work->inside = encounter_point(rows, joints);
    work->last = encounter_point(rows, joints);
    work->trial = encounter_point(rows, joints);
    work->touching = zeroed(joints, sizeof *work->touching);
    work->forces = zeroed(rows, sizeof *work->forces);
    work->positions = zeroed(rows, sizeof *work->positions);
    work->speeds = zeroed(rows, sizeof *work->speeds);
    for (size_t i = 0; i < ENCOUNTER_ERRORS; i++) {
        work->errors[i] = zeroed(2 * rows, sizeof *work->errors[i]);
    }
    work->crossings_s = zeroed(joints, sizeof *work->crossings_s);
    work->has_event = zeroed(joints, sizeof *work->has_event);
}

static void free_work(EncounterWork *work)
{
    if (work == NULL) {
        return;
    }
    encounter_point_free(&work->ends[0]);
    encounter_point_free(&work->ends[1]);
    encounter_point_free(&work->inside);
    encounter_point_free(&work->last);
    encounter_point_free(&work->trial);
    free(work->touching);
    free(work->forces);
    free(work->positions);
    free(work->speeds);
    for (size_t i = 0; i < ENCOUNTER_ERRORS; i++) {
        free(work->errors[i]);
    }
    free(work->crossings_s);
    free(work->has_event);
    free(work);
}

void encounter_make_rows(Encounter *encounter)
{
    const size_t rows = encounter->row_count;
    encounter->free = zeroed(rows, sizeof *encounter->free);
    encounter->position = zeroed(rows, sizeof *encounter->position);
    encounter->speed = zeroed(rows, sizeof *encounter->speed);
}

void encounter_make_room(Encounter *encounter, size_t reach)
{
    const size_t rows = encounter->row_count;
    const bool is_dense = 2 * reach + 1 >= rows;
    // row i begins with column 0, or with column i - reach
    encounter->reach = is_dense ? rows : reach;
    encounter->origin = is_dense ? 0 : reach;
    encounter->pitch = is_dense ? rows : 2 * reach;
    encounter->mobility =
        zeroed(rows * (is_dense ? rows : 2 * reach + 1), sizeof *encounter->mobility);
    encounter_make_rows(encounter);
    make_work(encounter);
}

void encounter_finish(Encounter *encounter)
{
    free(encounter->joints);
    free(encounter->joint_of);
    free(encounter->mobility);
    free(encounter->drift);
    free(encounter->mobility_rate);
    free(encounter->free_rate);
    free(encounter->free);
    free(encounter->position);
    free(encounter->speed);
    free(encounter->times);
    free(encounter->values);
    free(encounter->closings);
    free(encounter->losses);
    free(encounter->touching);
    free_work(encounter->work);
    encounter_stiff_finish(encounter);
    *encounter = (Encounter){.joint_count = 0};
}

EncounterSums encounter_sums(size_t rows)
{
    double *numbers = zeroed(4 * rows, sizeof *numbers);
    return (EncounterSums){
        .impulse = numbers, .moment = numbers + rows, .force = numbers + 3 * rows};
}

void encounter_sums_free(EncounterSums *sums)
{
    free(sums->impulse);
    *sums = (EncounterSums){.impulse = NULL};
}
