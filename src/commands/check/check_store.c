// Where does a baseline in the making keep what is measured?
//
// The key of the file is what the starts depend on: the program's fingerprint, the case, and every
// setting that it makes use of.
#include "commands/check/check_store.h"

#include "commands/check/measure_json.h"
#include "write/json_value.h"

#include <stdio.h>

static json_t *make_key(const CheckItem *item)
{
    const Baseline *now = &item->now;
    json_t *settings = json_object();
    for (size_t i = 0; i < now->setting_count; i++) {
        json_object_set_new(settings, now->settings[i].key,
                            json_value_text(now->settings[i].value));
    }
    return json_pack("{s:s, s:o, s:o}", "build", now->build, "case",
                     json_value_text(item->relative), "settings", settings);
}

bool check_store_open(CheckStore *store, const CheckItem *item, Err *err)
{
    char path[FILE_PATH_SIZE + sizeof ".partial"];
    *store = (CheckStore){.taken = 0};
    snprintf(path, sizeof path, "%s.partial", item->baseline_path);
    json_t *key = make_key(item);
    Err own = {0};
    // starts of another state of the case are worth nothing; what is no file of starts stays
    const bool is_open = journal_open(&store->journal, &JOURNAL_BLESS, path, key, false, &own) ||
                         journal_open(&store->journal, &JOURNAL_BLESS, path, key, true, err);
    json_decref(key);
    return is_open;
}

bool check_store_take_plan(const CheckStore *store, CheckPlan *plan, char *no_truth, size_t size)
{
    size_t index;
    json_t *line;
    json_array_foreach(store->journal.entries, index, line)
    {
        if (measure_json_take_plan(line, plan, no_truth, size)) {
            return true;
        }
    }
    return false;
}

// Adds a line, and to the lines that are known.
static bool keep(CheckStore *store, json_t *line, Err *err)
{
    json_array_append(store->journal.entries, line);
    return journal_add(&store->journal, line, err);
}

bool check_store_keep_plan(CheckStore *store, const CheckPlan *plan, const char *no_truth, Err *err)
{
    return keep(store, measure_json_plan(plan, no_truth), err);
}

void check_store_take(CheckStore *store, CheckWork *works, size_t count)
{
    size_t index;
    json_t *line;
    json_array_foreach(store->journal.entries, index, line)
    {
        for (size_t i = 0; i < count; i++) {
            if (!works[i].is_over && measure_json_take(line, works[i].start, works[i].measure)) {
                works[i].is_over = true;
                store->taken++;
            }
        }
    }
}

bool check_store_keep(CheckStore *store, const CheckWork *work, Err *err)
{
    return keep(store, measure_json_build(work->start, work->measure), err);
}

size_t check_store_count(const CheckStore *store)
{
    size_t count = 0;
    size_t index;
    json_t *line;
    json_array_foreach(store->journal.entries, index, line)
    {
        count += json_object_get(line, "metrics") != NULL ? 1 : 0;
    }
    return count;
}

void check_store_close(CheckStore *store, bool is_needed)
{
    if (is_needed) {
        journal_close(&store->journal);
    } else {
        journal_discard(&store->journal);
    }
}
