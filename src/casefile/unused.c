// Which keys does a case give that nothing in it makes use of, and what would?
#include "casefile/unused.h"

#include "base/zeroed.h"
#include "casefile/casefile.h"
#include "casefile/keys.h"

#include <string.h>

// Whether one of the keys that decide, their paths separated by blanks, is given by --set.
static bool is_overridden(const Entries *entries, const char *paths, size_t index)
{
    const Entry *first = entries_blame(entries, paths, index);
    return first != NULL && first->source->is_override;
}

bool unused_check(const Entries *entries, const Scenario *scenario, Err *err)
{
    const unsigned met = schema_met(scenario);
    for (size_t i = 0; i < entries->count; i++) {
        const Entry *entry = &entries->entries[i];
        SchemaLack lack;
        if (schema_lacks(entry->row, scenario, entry->index, met, &lack) && lack.is_mistake &&
            !is_overridden(entries, lack.paths, entry->index)) {
            char path[SCHEMA_PATH_SIZE];
            schema_path(entry->row, entries_name(entries, entry->row, entry->index), path);
            return entries_refuse(entry, err,
                                  "%s is used only with %s\nallowed: %s, or the case without this "
                                  "key",
                                  path, lack.words, lack.words);
        }
    }
    return true;
}

void unused_remember(const Entries *entries, Scenario *scenario)
{
    scenario->key_count = entries->count;
    scenario->keys = zeroed(entries->count + 1, sizeof *scenario->keys);
    for (size_t i = 0; i < entries->count; i++) {
        const Entry *entry = &entries->entries[i];
        scenario->keys[i] = (ScenarioKey){
            .row = (size_t)(entry->row - SCHEMA_ROWS),
            .member = entry->index,
            .line = entry->source->is_override
                        ? 0
                        : source_line(entry->source, keys_span(entry->node).start),
        };
    }
}

size_t casefile_unused(const Scenario *scenario, Text *lines)
{
    const unsigned met = schema_met(scenario);
    size_t count = 0;
    for (size_t i = 0; i < scenario->key_count; i++) {
        const ScenarioKey *key = &scenario->keys[i];
        const SchemaRow *row = &SCHEMA_ROWS[key->row];
        SchemaLack lack;
        if (!schema_lacks(row, scenario, key->member, met, &lack)) {
            continue;
        }
        char path[SCHEMA_PATH_SIZE];
        schema_path(row, schema_member_name(scenario, row->family, key->member), path);
        if (key->line > 0) {
            text_append(lines, "%s:%zu: ", scenario_path(scenario), key->line);
        }
        text_append(lines, "%s%s has no effect here; it would with %s\n", path,
                    key->line > 0 ? "" : " of the command line", lack.words);
        count++;
    }
    return count;
}
