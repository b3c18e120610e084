// Reads a sinusoid: mean + amplitude sin(2 pi frequency t + phase).
#include "casefile/waves.h"

#include "casefile/keys.h"
#include "casefile/quantity.h"

#include <stdio.h>
#include <string.h>

static const double FREQUENCY_MOST = 1e6; // Hz, above what a step of a nanosecond can follow well
static const double PHASE_MOST = 1e3;     // rad

bool waves_is_one(const Entry *entry)
{
    return entry->node->kind == NODE_MAP;
}

static void describe(const Entry *entry, char allowed[QUANTITY_TEXT_SIZE])
{
    const char *value = units_example(entry->row->dimension);
    snprintf(allowed, QUANTITY_TEXT_SIZE,
             "{mean: %s, amplitude: %s, frequency: 50 Hz, phase: 30 deg}", value, value);
}

// Lets what overrides parts of a value replace them.
static void override_parts(const Entries *entries, const Entry *whole,
                           Entry parts[ENTRY_PART_COUNT])
{
    for (size_t i = 0; i < entries->part_count; i++) {
        const EntryPartGiven *given = &entries->parts[i];
        if (given->entry.row == whole->row && given->entry.index == whole->index) {
            parts[given->part] = given->entry;
        }
    }
}

// The parts of a resolved entry that is one, with what overrides them.
static bool find_parts(const Entries *entries, const Entry *entry, Entry parts[ENTRY_PART_COUNT],
                       Err *err)
{
    const Node *nodes[ENTRY_PART_COUNT];
    if (!keys_sort(entry->source, entry->node, ENTRY_PARTS, ENTRY_PART_COUNT, nodes, err)) {
        return false;
    }
    for (int i = 0; i < ENTRY_PART_COUNT; i++) {
        parts[i] = (Entry){entry->row, entry->index, nodes[i], entry->source, NULL};
    }
    if (entry->signal != NULL) {
        override_parts(entries, entry->signal, parts);
    }
    override_parts(entries, entry, parts);
    return true;
}

const Node *waves_part(const Entries *entries, const Entry *own, EntryPart part)
{
    const Entry entry = entries_resolve(entries, own);
    Entry parts[ENTRY_PART_COUNT];
    const bool is_one = waves_is_one(&entry) && find_parts(entries, &entry, parts, &(Err){0});
    return is_one ? parts[part].node : NULL;
}

Dimension waves_dimension(const Entries *entries, const Entry *own, EntryPart part)
{
    Dimension dimension = own->row->dimension;
    for (size_t i = 0; own->row->type == SCHEMA_SIGNAL && i < entries->count; i++) {
        const Entry *user = &entries->entries[i];
        const Entry *signal = entries_resolve(entries, user).signal;
        const bool is_user =
            signal != NULL && signal->row == own->row && signal->index == own->index;
        dimension = is_user ? user->row->dimension : dimension;
    }
    return part == ENTRY_FREQUENCY ? DIMENSION_FREQUENCY
           : part == ENTRY_PHASE   ? DIMENSION_ANGLE
                                   : dimension;
}

static bool read_part(const Entry *part, const char *name, Dimension dimension, double *value,
                      Err *err)
{
    Complaint complaint;
    if (part->node->kind != NODE_SCALAR || part->node->text[0] == '\0') {
        return source_error(part->source, keys_span(part->node), units_example(dimension), err,
                            "%s takes %s", name, units_dimension_name(dimension));
    }
    return quantity_parse(part->node->text, dimension, value, &complaint) ||
           source_error(part->source, part->node->span, complaint.allowed, err, "%s",
                        complaint.text);
}

// Refuses a part whose number is out of range.
static bool refuse_range(const Entry *part, const char *name, const char *allowed, Err *err)
{
    return source_error(part->source, part->node->span, allowed, err, "%s is out of range: %.60s",
                        name, part->node->text);
}

static bool check_ranges(const Entry *entry, const Entry parts[ENTRY_PART_COUNT], double reach,
                         const double values[ENTRY_PART_COUNT], Err *err)
{
    const SchemaRow *row = entry->row;
    char allowed[QUANTITY_TEXT_SIZE];
    if (!(values[ENTRY_FREQUENCY] > 0.0 && values[ENTRY_FREQUENCY] <= FREQUENCY_MOST)) {
        snprintf(allowed, sizeof allowed, "above 0 to %g Hz", FREQUENCY_MOST);
        return refuse_range(&parts[ENTRY_FREQUENCY], ENTRY_PARTS[ENTRY_FREQUENCY], allowed, err);
    }
    if (!(fabs(values[ENTRY_PHASE]) <= PHASE_MOST)) {
        snprintf(allowed, sizeof allowed, "-%g to %g rad", PHASE_MOST, PHASE_MOST);
        return refuse_range(&parts[ENTRY_PHASE], ENTRY_PARTS[ENTRY_PHASE], allowed, err);
    }
    if (!(reach <= row->high)) {
        snprintf(allowed, sizeof allowed, "mean and amplitude from %g to %g %s together", row->low,
                 row->high, units_si(row->dimension));
        return refuse_range(&parts[ENTRY_AMPLITUDE], ENTRY_PARTS[ENTRY_AMPLITUDE], allowed, err);
    }
    return true;
}

bool waves_read(const Entries *entries, const Entry *entry, Dimension dimension, double scale,
                WaveRead *read, Err *err)
{
    const Dimension dimensions[ENTRY_PART_COUNT] = {dimension, dimension, DIMENSION_FREQUENCY,
                                                    DIMENSION_ANGLE};
    Entry parts[ENTRY_PART_COUNT];
    double values[ENTRY_PART_COUNT] = {0.0};
    char allowed[QUANTITY_TEXT_SIZE];
    describe(entry, allowed);
    if (!find_parts(entries, entry, parts, err)) {
        return false;
    }
    for (int i = 0; i < ENTRY_PART_COUNT; i++) {
        const bool is_needed = i == ENTRY_AMPLITUDE || i == ENTRY_FREQUENCY;
        if (parts[i].node == NULL && is_needed) {
            return source_error(entry->source, keys_span(entry->node), allowed, err,
                                "the sinusoid has no %s", ENTRY_PARTS[i]);
        }
        if (parts[i].node != NULL &&
            !read_part(&parts[i], ENTRY_PARTS[i], dimensions[i], &values[i], err)) {
            return false;
        }
    }
    *read = (WaveRead){
        .has_mean = parts[ENTRY_MEAN].node != NULL,
        .mean = scale * values[ENTRY_MEAN],
        .wave = {scale * values[ENTRY_AMPLITUDE], 2.0 * M_PI * values[ENTRY_FREQUENCY],
                 values[ENTRY_PHASE]},
    };
    return check_ranges(entry, parts, fabs(read->mean) + fabs(read->wave.amplitude), values, err);
}

bool waves_check_used(const Entries *entries, Err *err)
{
    const EntryNames *names = &entries->names[SCHEMA_SIGNAL_FAMILY];
    for (size_t i = 0; i < names->count; i++) {
        const Entry *signal = entries_find(entries, "signals.*", i);
        bool is_used = signal == NULL;
        for (size_t k = 0; !is_used && k < entries->count; k++) {
            is_used = entries_resolve(entries, &entries->entries[k]).signal == signal;
        }
        if (!is_used) {
            return entries_refuse(signal, err,
                                  "nothing uses the signal '%s'\nallowed: its name as a value of a "
                                  "load or a drive, such as force: %s",
                                  names->names[i], names->names[i]);
        }
    }
    return true;
}
