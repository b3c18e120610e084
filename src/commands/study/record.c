// Lists the columns of a row of a study, in their order.
#include "commands/study/record.h"

const char *const RUN_OUTCOME_WORDS[RUN_OUTCOME_COUNT] = {
    [RUN_OUTCOME_OK] = "ok",
    [RUN_OUTCOME_REFUSED] = "refused",
    [RUN_OUTCOME_FAILED] = "failed",
    [RUN_OUTCOME_ENDED] = "ended",
    [RUN_OUTCOME_TIMED_OUT] = "timed out",
    [RUN_OUTCOME_NO_MEMORY] = "no memory",
};

static const RecordField RUN = {"run", COLUMN_RUN, offsetof(Record, run)};
static const RecordField OUTCOME[] = {
    {"outcome", COLUMN_FATE, offsetof(Record, outcome)},
    {"reason", COLUMN_REASON, offsetof(Record, reason)},
};
static const RecordField LAST[] = {
    {"hash", COLUMN_HASH, offsetof(Record, hash)},
    {"wall_s", COLUMN_REAL, offsetof(Record, wall_s)},
};
enum { OUTCOME_COUNT = 2, LAST_COUNT = 2 };

bool record_field(const Layout *layout, size_t number, RecordField *field)
{
    if (number == 0) {
        *field = RUN;
        return true;
    }
    size_t i = number - 1;
    if (i < layout->setting_count) {
        const Column *column = &layout->settings[i];
        *field = (RecordField){column->name, column->kind,
                               offsetof(Record, settings) + i * sizeof(Cell)};
        return true;
    }
    i -= layout->setting_count;
    if (i < OUTCOME_COUNT) {
        *field = OUTCOME[i];
        return true;
    }
    i -= OUTCOME_COUNT;
    if (i < layout->result_count) {
        const Column *column = &layout->results[i];
        *field = (RecordField){column->name, column->kind,
                               offsetof(Record, results) + i * sizeof(double)};
        return true;
    }
    i -= layout->result_count;
    if (i < LAST_COUNT) {
        *field = LAST[i];
    }
    return i < LAST_COUNT;
}
