// Makes field tables of the rows of model/number_list.h.
#include "write/number_fields.h"

#include <assert.h>
#include <math.h>

NumberRecord number_record(NumberOwner owner, const NumberSource *of, size_t member)
{
    NumberRecord record;
    NumberSource source = *of;
    Wear wear;
    if (owner == NUMBER_OWNER_JOINT_WEAR && of->run != NULL && of->run->is_complete) {
        // over all samples, once for all of its numbers
        wear = wear_of(of->run, member);
        source.wear = &wear;
    }
    for (NumberId id = 0; id < NUMBER_COUNT; id++) {
        const bool is_shown =
            NUMBERS[id].owner == owner && (NUMBERS[id].places & NUMBER_SHOWN) != 0;
        record.values[id] = is_shown ? number_find(id, &source, member) : (Extreme){NAN, NAN, NAN};
    }
    return record;
}

static void add(NumberFields *fields, const Field *field)
{
    // the last row ends the table
    assert(fields->count + 1 < NUMBER_FIELD_MAX);
    fields->rows[fields->count++] = *field;
    fields->rows[fields->count] = (Field){.type = FIELD_END};
}

void number_fields_label(NumberFields *fields, const char *title, const char *unit,
                         TableAlign align)
{
    add(fields, &(Field){.type = FIELD_LABEL,
                         .where = FIELD_TABLE,
                         .title = title,
                         .unit = unit,
                         .align = align});
}

static unsigned where_of(const Number *number)
{
    return ((number->places & NUMBER_JSON) != 0 ? FIELD_JSON : 0U) |
           ((number->places & NUMBER_TEXT) != 0 ? FIELD_TABLE : 0U);
}

static void add_value(NumberFields *fields, NumberId id, NumberTurn turn)
{
    const Number *number = &NUMBERS[id];
    add(fields, &(Field){
                    .key = number->keys[turn],
                    .type = number_is_whole(number) ? FIELD_WHOLE : FIELD_NUMBER,
                    .where = where_of(number),
                    .title = number->titles[turn],
                    .unit = number->units[turn],
                    .format = number->format,
                    .offset = offsetof(NumberRecord, values) + id * sizeof(Extreme) +
                              offsetof(Extreme, value),
                    .per_si = number->kind == NUMBER_OF_MICROSECONDS ? 1.0 : 0.0,
                    .align = (number->traits & NUMBER_DETAIL) != 0  ? TABLE_DETAIL
                             : (number->traits & NUMBER_MINOR) != 0 ? TABLE_MINOR
                                                                    : TABLE_LEFT,
                });
}

// Where or when an extreme stood, or something happened.
static void add_time(NumberFields *fields, NumberId id, bool has_crank)
{
    const Number *number = &NUMBERS[id];
    const size_t offset = offsetof(NumberRecord, values) + id * sizeof(Extreme);
    const bool is_instant = (number->traits & NUMBER_INSTANT) != 0;
    const unsigned where = where_of(number);
    add(fields, &(Field){.key = number->crank_key,
                         .type = FIELD_DEGREES,
                         .where = has_crank ? where : where & ~(unsigned)FIELD_TABLE,
                         .title = is_instant ? "crank" : "at crank",
                         .unit = "deg",
                         .format = "%.1f",
                         .offset = offset + offsetof(Extreme, crank_rad)});
    if (!has_crank && !is_instant) {
        add(fields, &(Field){.type = FIELD_NUMBER,
                             .where = where & FIELD_TABLE,
                             .title = "at time",
                             .unit = "ms",
                             .format = "%.4f",
                             .offset = offset + offsetof(Extreme, time_s)});
    }
}

void number_fields_add(NumberFields *fields, NumberOwner owner, NumberTurn turn, unsigned without,
                       bool has_crank)
{
    for (NumberId id = 0; id < NUMBER_COUNT; id++) {
        const Number *number = &NUMBERS[id];
        if (number->owner == owner && (number->traits & without) == 0 && where_of(number) != 0) {
            add_value(fields, id, turn);
            if ((number->traits & (NUMBER_TIMED | NUMBER_INSTANT)) != 0) {
                add_time(fields, id, has_crank);
            }
        }
    }
}

unsigned number_fields_lacked(const Linkage *linkage)
{
    return (linkage->load_count == 0 ? NUMBER_LOADED : 0U) |
           (linkage->is_spatial ? 0U : NUMBER_SPATIAL);
}

void number_fields_json(json_t *object, NumberOwner owner, const NumberSource *of,
                        const Linkage *linkage, size_t member)
{
    NumberFields fields = {.count = 0};
    const NumberRecord record = number_record(owner, of, member);
    const NumberTurn turn = number_turn(owner, linkage, member);
    number_fields_add(&fields, owner, turn, number_fields_lacked(linkage), true);
    fields_json_set(fields.rows, FIELD_JSON, &record, object);
}
