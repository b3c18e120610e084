// Finds keys of a case that nothing in it makes use of because another was forgotten.
#include "casefile/unused.h"

#include "base/zeroed.h"
#include "casefile/keys.h"

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
    // most keys stand in the order of their lines: the text is not counted from its start for each
    SourceCount lines = {.source = NULL};
    for (size_t i = 0; i < entries->count; i++) {
        const Entry *entry = &entries->entries[i];
        scenario->keys[i] = (ScenarioKey){
            .row = (size_t)(entry->row - SCHEMA_ROWS),
            .member = entry->index,
            .line = entry->source->is_override
                        ? 0
                        : source_line_next(&lines, entry->source, keys_span(entry->node).start),
        };
    }
}
