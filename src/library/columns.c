// Makes the tables of runs column by column: series, contacts and spikes.
#include "library/library.h"

#include "base/zeroed.h"
#include "write/contact_table.h"
#include "write/number_fields.h"
#include "write/series_rows.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const char *const TABLES[ANSWER_TABLE_COUNT] = {
    [TABLE_SERIES] = "series",
    [TABLE_CONTACTS] = "contacts",
    [TABLE_SPIKES] = "spikes",
};

// A table that is asked for, and a column of it.
typedef struct Wanted {
    JpAnswer *of;
    const char *table; // as given
    const char *name;  // of the column; NULL: by its number
    size_t index;
    size_t run; // from here on what was found
    AnswerTable which;
    AnswerColumns *columns;
    AnswerColumn *column;
} Wanted;

static bool find_table(Wanted *wanted, Err *err)
{
    const char *name = wanted->table;
    if (!answer_find_run(wanted->of, &name, &wanted->run)) {
        return err_set(err, ERR_USAGE, "only what came of a run has tables");
    }
    for (int i = 0; i < ANSWER_TABLE_COUNT; i++) {
        if (strcmp(TABLES[i], name) == 0) {
            wanted->which = (AnswerTable)i;
            wanted->columns = &wanted->of->tables[wanted->run][i];
            const Trajectory *run = wanted->of->run->runs[wanted->run];
            if (i == TABLE_CONTACTS && !wanted->of->scenario->run.keeps_contacts) {
                return err_set(err, ERR_USAGE,
                               "contacts were not kept: ask the run for contacts (has_contacts in "
                               "C)");
            }
            return run->is_complete ||
                   err_set(err, ERR_SOLVER, "the run of %s failed: %s", run->backend, run->message);
        }
    }
    return err_set(err, ERR_USAGE,
                   "there is no table '%s'; allowed: series, contacts, spikes, with a backend and "
                   "a point in front",
                   wanted->table);
}

static AnswerColumn named(const char *name, const char *unit, const char *doc)
{
    return (AnswerColumn){.name = strdup(name), .unit = strdup(unit), .doc = doc};
}

// Series.

static SeriesColumns series_of(const Wanted *wanted)
{
    const Trajectory *run = wanted->of->run->runs[wanted->run];
    return series_columns_create(wanted->of->scenario, run->ranges.count > 0);
}

static void list_series(const Wanted *wanted, AnswerColumns *listed)
{
    SeriesColumns series = series_of(wanted);
    listed->columns = zeroed(series.count, sizeof *listed->columns);
    for (size_t i = 0; i < series.count; i++) {
        const char *name = series_columns_name(&series, i).name;
        listed->columns[i] = named(name, listing_unit(name), "");
    }
    listed->count = series.count;
    series_columns_finish(&series);
}

static void fill_series(const Wanted *wanted, size_t number, AnswerColumn *column)
{
    const Trajectory *run = wanted->of->run->runs[wanted->run];
    SeriesColumns series = series_of(wanted);
    column->count = run->sample_count;
    column->numbers = zeroed(column->count, sizeof *column->numbers);
    for (size_t k = 0; k < column->count; k++) {
        column->numbers[k] = series_columns_value(&series, run, k, number);
    }
    series_columns_finish(&series);
}

// Contacts.

static void list_contacts(const Wanted *wanted, AnswerColumns *listed)
{
    const ContactTable table = contact_table_of(&wanted->of->scenario->linkage);
    listed->columns = zeroed(table.count, sizeof *listed->columns);
    for (size_t i = 0; i < table.count; i++) {
        const ContactColumn *column = &table.columns[i];
        listed->columns[i] =
            named(column->name, listing_unit(column->name),
                  column->of == CONTACT_NUMBER  ? NUMBERS[column->id].meaning
                  : column->of == CONTACT_JOINT ? "joint of the contact"
                  : column->of == CONTACT_CRANK ? "angle of the crank at its onset"
                                                : "where on the wall of its hole the pin pressed "
                                                  "most, from the x axis of the hole's body");
    }
    listed->count = table.count;
}

static void fill_contacts(const Wanted *wanted, size_t number, AnswerColumn *column)
{
    const Trajectory *run = wanted->of->run->runs[wanted->run];
    const ContactTable table = contact_table_of(&wanted->of->scenario->linkage);
    contact_table_sort(run);
    column->count = run->contact_count;
    if (table.columns[number].of == CONTACT_JOINT) {
        column->words = zeroed(column->count, sizeof *column->words);
        for (size_t i = 0; i < column->count; i++) {
            column->words[i] = run->linkage.joints[run->contacts[i].joint].name;
        }
        return;
    }
    column->numbers = zeroed(column->count, sizeof *column->numbers);
    for (size_t i = 0; i < column->count; i++) {
        column->numbers[i] = contact_table_number(&table.columns[number], run, &run->contacts[i]);
    }
}

// Spikes.

// One spike: of a body's acceleration or a joint's force.
typedef struct SpikeOf {
    NumberOwner owner;
    size_t member;
    NumberTurn turn;
    const SignalSpike *spike;
} SpikeOf;

typedef void SpikeTake(const SpikeOf *of, const Trajectory *run, void *context);

static void each_kept(const Trajectory *run, NumberOwner owner, size_t member,
                      const SignalSpikes *spikes, SpikeTake *take, void *context)
{
    for (size_t i = 0; spikes->is_known && i < spikes->kept; i++) {
        take(&(SpikeOf){owner, member, number_turn(owner, &run->linkage, member),
                        &spikes->spikes[i]},
             run, context);
    }
}

// Those that the JSON has, in its order.
static void each_spike(const Trajectory *run, SpikeTake *take, void *context)
{
    for (size_t i = 0; i < run->body_count; i++) {
        if (!linkage_is_driven(&run->linkage, (int)i)) {
            each_kept(run, NUMBER_OWNER_BODY_SPIKE, i, &run->alpha_spikes[i], take, context);
        }
    }
    for (size_t i = 0; i < run->joint_count; i++) {
        each_kept(run, NUMBER_OWNER_JOINT_SPIKE, i, &run->force_spikes[i], take, context);
    }
}

typedef enum SpikeColumnOf {
    SPIKE_SIGNAL, // alpha or force
    SPIKE_MEMBER, // the body or joint
    SPIKE_JOINT,  // of a body's: the joint whose force changes most
    SPIKE_CRANK,
    SPIKE_NUMBER,
} SpikeColumnOf;

typedef struct SpikeColumn {
    SpikeColumnOf of;
    NumberId id; // of a joint's spikes
    NumberTurn turn;
    bool is_alike; // in one unit of all
} SpikeColumn;

enum { SPIKE_COLUMN_MAX = 4 + NUMBER_TURN_COUNT * NUMBER_COUNT };

static bool is_alike(const Number *number)
{
    return strcmp(number->keys[NUMBER_PUSHED], number->keys[NUMBER_TURNED]) == 0 &&
           strcmp(number->keys[NUMBER_PUSHED], number->keys[NUMBER_SPED]) == 0;
}

static size_t list_spike_columns(SpikeColumn columns[SPIKE_COLUMN_MAX])
{
    size_t count = 0;
    for (int of = SPIKE_SIGNAL; of < SPIKE_NUMBER; of++) {
        columns[count++] = (SpikeColumn){.of = (SpikeColumnOf)of};
    }
    for (NumberId id = 0; id < NUMBER_COUNT; id++) {
        const Number *number = &NUMBERS[id];
        const int turns = is_alike(number) ? 1 : NUMBER_TURN_COUNT;
        for (int turn = 0; number->owner == NUMBER_OWNER_JOINT_SPIKE &&
                           (number->places & NUMBER_JSON) != 0 && turn < turns;
             turn++) {
            columns[count++] = (SpikeColumn){SPIKE_NUMBER, id, (NumberTurn)turn, turns == 1};
        }
    }
    return count;
}

static void list_spikes(const Wanted *wanted, AnswerColumns *listed)
{
    static const char *const NAMES[] = {"signal", "name", "joint", "crank_deg"};
    static const char *const DOCS[] = {
        "alpha, the angular acceleration of a body, or force, that of a joint",
        "body or joint of the spike",
        "of a body's spike the joint with play whose force changes most",
        "angle of the crank at the peak",
    };
    SpikeColumn columns[SPIKE_COLUMN_MAX];
    (void)wanted;
    listed->count = list_spike_columns(columns);
    listed->columns = zeroed(listed->count, sizeof *listed->columns);
    for (size_t i = 0; i < listed->count; i++) {
        const SpikeColumn *column = &columns[i];
        const char *name =
            column->of == SPIKE_NUMBER ? NUMBERS[column->id].keys[column->turn] : NAMES[column->of];
        listed->columns[i] =
            named(name, listing_unit(name),
                  column->of == SPIKE_NUMBER ? NUMBERS[column->id].meaning : DOCS[column->of]);
    }
}

static void spike_count(const SpikeOf *of, const Trajectory *run, void *context)
{
    (void)of;
    (void)run;
    AnswerColumn *column = context;
    column->count++;
}

typedef struct SpikeFill {
    const Scenario *scenario;
    const SpikeColumn *of;
    AnswerColumn *column;
    size_t row;
} SpikeFill;

static const char *spike_word(const SpikeColumn *column, const SpikeOf *of, const Trajectory *run)
{
    const bool is_body = of->owner == NUMBER_OWNER_BODY_SPIKE;
    switch (column->of) {
    case SPIKE_SIGNAL:
        return is_body ? "alpha" : "force";
    case SPIKE_MEMBER:
        return is_body ? run->linkage.bodies[of->member].name
                       : run->linkage.joints[of->member].name;
    case SPIKE_JOINT:
        return of->spike->joint >= 0 ? run->linkage.joints[of->spike->joint].name : "";
    case SPIKE_CRANK:
    case SPIKE_NUMBER:
        break;
    }
    return "";
}

// The same number of the owner that the spike has: both have the same rows.
static NumberId number_of_owner(NumberId id, NumberOwner owner)
{
    for (NumberId other = 0; other < NUMBER_COUNT; other++) {
        if (NUMBERS[other].owner == owner && strcmp(NUMBERS[other].name, NUMBERS[id].name) == 0) {
            return other;
        }
    }
    return id;
}

static double spike_number(const SpikeFill *fill, const SpikeOf *of, const Trajectory *run)
{
    const NumberSource source = {.scenario = fill->scenario, .run = run, .spike = of->spike};
    if (fill->of->of == SPIKE_CRANK) {
        return of->spike->crank_rad * (180.0 / M_PI);
    }
    const bool is_its = fill->of->is_alike || fill->of->turn == of->turn;
    const NumberId id = number_of_owner(fill->of->id, of->owner);
    return is_its ? number_find(id, &source, of->member).value : NAN;
}

static void spike_fill(const SpikeOf *of, const Trajectory *run, void *context)
{
    SpikeFill *fill = context;
    if (fill->column->words != NULL) {
        fill->column->words[fill->row++] = spike_word(fill->of, of, run);
    } else {
        fill->column->numbers[fill->row++] = spike_number(fill, of, run);
    }
}

static void fill_spikes(const Wanted *wanted, size_t number, AnswerColumn *column)
{
    const Trajectory *run = wanted->of->run->runs[wanted->run];
    SpikeColumn columns[SPIKE_COLUMN_MAX];
    list_spike_columns(columns);
    each_spike(run, spike_count, column);
    if (columns[number].of < SPIKE_CRANK) {
        column->words = zeroed(column->count, sizeof *column->words);
    } else {
        column->numbers = zeroed(column->count, sizeof *column->numbers);
    }
    SpikeFill fill = {wanted->of->scenario, &columns[number], column, 0};
    each_spike(run, spike_fill, &fill);
}

// Tables.

static const struct {
    void (*list)(const Wanted *wanted, AnswerColumns *listed);
    void (*fill)(const Wanted *wanted, size_t number, AnswerColumn *column);
} MAKERS[ANSWER_TABLE_COUNT] = {
    [TABLE_SERIES] = {list_series, fill_series},
    [TABLE_CONTACTS] = {list_contacts, fill_contacts},
    [TABLE_SPIKES] = {list_spikes, fill_spikes},
};

// In a call of its own, which takes no memory behind its end; as the next.
static bool work_columns(void *context, Err *err)
{
    Wanted *wanted = context;
    if (!find_table(wanted, err)) {
        return false;
    }
    if (!wanted->columns->is_listed) {
        AnswerColumns listed = {.is_listed = true};
        MAKERS[wanted->which].list(wanted, &listed);
        *wanted->columns = listed;
    }
    return true;
}

static bool fail_unknown_column(const Wanted *wanted, Err *err)
{
    const AnswerColumns *columns = wanted->columns;
    const char **names = zeroed(columns->count, sizeof *names);
    for (size_t i = 0; i < columns->count; i++) {
        names[i] = columns->columns[i].name;
    }
    const char *nearest = text_nearest(wanted->name, names, columns->count);
    err_set(err, ERR_USAGE, "the table '%s' has no column '%s'%s%s%s", wanted->table, wanted->name,
            nearest != NULL ? "; did you mean '" : "", nearest != NULL ? nearest : "",
            nearest != NULL ? "'?" : "");
    free(names);
    return false;
}

static bool work_column(void *context, Err *err)
{
    Wanted *wanted = context;
    const AnswerColumns *columns = wanted->columns;
    size_t number = wanted->index;
    if (wanted->name != NULL) {
        number = 0;
        while (number < columns->count &&
               strcmp(columns->columns[number].name, wanted->name) != 0) {
            number++;
        }
        if (number == columns->count) {
            return fail_unknown_column(wanted, err);
        }
    }
    if (number >= columns->count) {
        return err_set(err, ERR_USAGE, "the table '%s' has %zu columns, and none of number %zu",
                       wanted->table, columns->count, number);
    }
    wanted->column = &columns->columns[number];
    if (!wanted->column->is_made) {
        AnswerColumn made = *wanted->column;
        MAKERS[wanted->which].fill(wanted, number, &made);
        made.is_made = true;
        *wanted->column = made;
    }
    return true;
}

static JpCaseStatus want(Wanted *wanted, bool is_column, JpCaseError *error)
{
    if (wanted->of == NULL || wanted->table == NULL) {
        return library_refuse(error, wanted->of == NULL
                                         ? "there is no answer: NULL was given for it"
                                         : "there is no table: NULL was given for it");
    }
    LibraryCall list = {.work = work_columns, .context = wanted};
    LibraryCall make = {.work = work_column, .context = wanted};
    const JpCaseStatus status = library_call(&list, error);
    return status == JP_CASE_OK && is_column ? library_call(&make, error) : status;
}

size_t jp_answer_column_count(JpAnswer *of, const char *table, JpCaseError *error)
{
    Wanted wanted = {.of = of, .table = table};
    return want(&wanted, false, error) == JP_CASE_OK ? wanted.columns->count : 0;
}

static JpCaseStatus hand_out(Wanted *wanted, JpColumn *column, JpCaseError *error)
{
    if (column == NULL) {
        return library_refuse(error, "there is nowhere to write to: NULL was given for it");
    }
    const JpCaseStatus status = want(wanted, true, error);
    if (status == JP_CASE_OK) {
        const AnswerColumn *found = wanted->column;
        *column = (JpColumn){
            .name = found->name,
            .unit = found->unit,
            .doc = found->doc,
            .count = found->count,
            .numbers = found->numbers,
            .words = found->words,
        };
    }
    return status;
}

JpCaseStatus jp_answer_column_at(JpAnswer *of, const char *table, size_t index, JpColumn *column,
                                 JpCaseError *error)
{
    Wanted wanted = {.of = of, .table = table, .index = index};
    return hand_out(&wanted, column, error);
}

JpCaseStatus jp_answer_column(JpAnswer *of, const char *table, const char *name, JpColumn *column,
                              JpCaseError *error)
{
    Wanted wanted = {.of = of, .table = table, .name = name};
    if (name == NULL) {
        return library_refuse(error, "there is no column: NULL was given for its name");
    }
    return hand_out(&wanted, column, error);
}
