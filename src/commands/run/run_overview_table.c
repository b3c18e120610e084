// Writes the table of the first screen of a run.
#include "commands/run/run_overview.h"

#include "base/text.h"
#include "write/table.h"
#include "write/units.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

enum { NAME_MOST = 17 };

static size_t least(size_t a, size_t b)
{
    return a < b ? a : b;
}

static void cell_name(const char *kind, const char *name, Table *table)
{
    Text shown;
    text_init(&shown);
    text_append(&shown, "%s", kind);
    text_append_shown(&shown, name);
    const bool is_long = strlen(shown.data) > NAME_MOST;
    table_cell(table, "%.*s%s", is_long ? NAME_MOST - 1 : NAME_MOST, shown.data,
               is_long ? "~" : "");
    text_finish(&shown);
}

static void append_unless_unknown(Text *text, const char *format, double value)
{
    char words[32];
    snprintf(words, sizeof words, format, value);
    text_append(text, "%s", isfinite(value) ? words : "");
}

// With its unit; of a quantile of which only the low end is known, that.
static void append_with_unit(const OverviewCell *cell, Text *text)
{
    if (cell->has_interval && isinf(cell->high)) {
        text_append(text, "> ");
        units_append(text, cell->low, cell->unit);
    } else if (cell->has_interval) {
        units_append_within(text, cell->value, cell->low, cell->high, cell->unit);
    } else if (isfinite(cell->value)) {
        units_append(text, cell->value, cell->unit);
    }
}

// In the unit of the largest.
static void append_beside(const OverviewCell *cell, const OverviewCell *largest, Text *text)
{
    const double low = cell->has_interval ? cell->low : cell->value;
    const double high = cell->has_interval ? cell->high : cell->value;
    units_append_beside(text, cell->value, low, high, largest->value, largest->low, largest->high);
}

// A number without a unit, by a format where it has no interval.
static void append_plain(const OverviewCell *cell, const char *format, double per_si, Text *text)
{
    if (!cell->has_interval || !isfinite(cell->value)) {
        append_unless_unknown(text, format, cell->value * per_si);
    } else if (isinf(cell->high)) {
        text_append(text, "> ");
        units_append_digits(text, cell->low * per_si, cell->low * per_si, cell->low * per_si);
    } else {
        units_append_digits(text, cell->value * per_si, cell->low * per_si, cell->high * per_si);
    }
}

// Three digits, as people write a large number.
static void append_ratio(const OverviewCell *cell, Text *text)
{
    const bool is_large = !cell->has_interval && fabs(cell->value) >= 999.5;
    if (is_large && isfinite(cell->value)) {
        const double digit = pow(10.0, floor(log10(fabs(cell->value))) - 2.0);
        text_append(text, "%.0f", round(cell->value / digit) * digit);
    } else {
        append_plain(cell, "%.3g", 1.0, text);
    }
}

void run_overview_cell(const OverviewRow *row, OverviewQuantity quantity, Text *text)
{
    const OverviewCell *cell = &row->cells[quantity];
    if (!cell->is_there) {
        return;
    }
    switch (quantity) {
    case OVERVIEW_LARGEST:
    case OVERVIEW_DEEPEST:
        append_with_unit(cell, text);
        break;
    case OVERVIEW_MEDIAN:
    case OVERVIEW_MOST:
        append_beside(cell, &row->cells[OVERVIEW_LARGEST], text);
        break;
    case OVERVIEW_DEEPEST_MEDIAN:
    case OVERVIEW_DEEPEST_MOST:
        append_beside(cell, &row->cells[OVERVIEW_DEEPEST], text);
        break;
    case OVERVIEW_WIDTH:
        append_unless_unknown(text, cell->value * UNITS_PERCENT < 1.0 ? "<1" : "%.0f",
                              cell->value * UNITS_PERCENT);
        break;
    case OVERVIEW_CRANK:
        append_unless_unknown(text, "%.1f", units_wrapped_deg(cell->value));
        break;
    case OVERVIEW_TIME:
        append_unless_unknown(text, "%.4g", cell->value * UNITS_MS);
        break;
    case OVERVIEW_RATIO:
        append_ratio(cell, text);
        break;
    case OVERVIEW_IMPACTS:
        append_unless_unknown(text, "%.3g", cell->value);
        break;
    case OVERVIEW_CONTACT:
        append_plain(cell, "%.1f", UNITS_PERCENT, text);
        text_append(text, "%s", isfinite(cell->value) ? " %" : "");
        break;
    case OVERVIEW_QUANTITY_COUNT:
        break;
    }
}

static bool has_quantity(const OverviewRow *rows, size_t count, OverviewQuantity quantity)
{
    bool is_known = false;
    for (size_t i = 0; i < count; i++) {
        const OverviewCell *cell = &rows[i].cells[quantity];
        is_known |= cell->is_there && (cell->has_interval || isfinite(cell->value));
    }
    return is_known;
}

// Whether a column of it would have anything in it.
static bool is_known_of_any(const Overview *overview, OverviewQuantity quantity)
{
    return has_quantity(overview->joints, overview->joint_count, quantity) ||
           (run_overview_has_ideal(overview) &&
            has_quantity(overview->ideal_joints, overview->ideal_count, quantity)) ||
           has_quantity(overview->bushings, overview->bushing_count, quantity) ||
           has_quantity(overview->bodies, overview->body_count, quantity) ||
           has_quantity(overview->drives, overview->drive_count, quantity);
}

size_t run_overview_columns(const Overview *overview, bool has_crank,
                            OverviewColumn columns[OVERVIEW_COLUMN_MAX])
{
    const bool is_random = run_overview_is_random(overview);
    const char *turn = has_crank ? "a turn" : "";
    const char *impacts = has_crank ? "impacts a turn" : "impacts";
    const OverviewColumn of_run[] = {
        {OVERVIEW_LARGEST, "largest", "", "largest", false},
        {has_crank ? OVERVIEW_CRANK : OVERVIEW_TIME, "at", has_crank ? "deg" : "ms",
         has_crank ? "at, deg" : "at, ms", false},
        {OVERVIEW_RATIO, "x ideal", "", "x ideal", false},
        {OVERVIEW_IMPACTS, "impacts", turn, impacts, false},
        {OVERVIEW_CONTACT, "contact", "", "contact", false},
        {OVERVIEW_DEEPEST, "deepest", "", "deepest", false},
    };
    const OverviewColumn of_spread[] = {
        {OVERVIEW_LARGEST, "95 %", has_crank ? "of turns" : "", "95 %", false},
        {OVERVIEW_WIDTH, "+-", "%", "+- %", false},
        {OVERVIEW_MEDIAN, "50 %", "", "50 %", false},
        {OVERVIEW_MOST, "most", "", "most", false},
        {OVERVIEW_RATIO, "times", "ideal", "x ideal", true},
        {OVERVIEW_IMPACTS, "impacts", turn, impacts, false},
        {OVERVIEW_CONTACT, "contact", "", "contact", false},
        {OVERVIEW_DEEPEST, "deepest", "", "deepest", false},
    };
    const OverviewColumn *all = is_random ? of_spread : of_run;
    const size_t all_count = (is_random ? sizeof of_spread : sizeof of_run) / sizeof *columns;
    size_t count = 0;
    for (size_t i = 0; i < all_count; i++) {
        // of ideal joints the ratio to themselves is 1
        const bool says_nothing = all[i].quantity == OVERVIEW_RATIO && overview->joint_count == 0;
        if (is_known_of_any(overview, all[i].quantity) && !says_nothing) {
            columns[count++] = all[i];
        }
    }
    return count;
}

// A table of some of its rows.
typedef struct OverviewTable {
    Table *table;
    size_t column_count;
    OverviewColumn columns[OVERVIEW_COLUMN_MAX];
} OverviewTable;

static OverviewTable begin_table(const Overview *overview, bool has_crank, bool has_joints,
                                 size_t width)
{
    OverviewTable made = {.table = NULL};
    made.column_count = run_overview_columns(overview, has_crank, made.columns);
    made.table = table_create(1 + made.column_count);
    table_head(made.table, 0, has_joints ? "joint, body" : "body", "", TABLE_LEFT | TABLE_KEY);
    for (size_t i = 0; i < made.column_count; i++) {
        table_head(made.table, 1 + i, made.columns[i].title, made.columns[i].unit,
                   TABLE_RIGHT | (made.columns[i].is_minor ? TABLE_MINOR : 0));
    }
    table_fit(made.table, run_overview_is_random(overview) ? width : 0);
    return made;
}

// The rows of a kind, whose name stands before theirs.
static void add_rows(const OverviewTable *made, const char *kind, const OverviewRow *rows,
                     size_t count)
{
    for (size_t i = 0; i < count; i++) {
        cell_name(kind, rows[i].name, made->table);
        for (size_t k = 0; k < made->column_count; k++) {
            Text words;
            text_init(&words);
            run_overview_cell(&rows[i], made->columns[k].quantity, &words);
            table_cell(made->table, "%s", words.data != NULL ? words.data : "");
            text_finish(&words);
        }
    }
}

// Says how many of a kind there is no room for, after what was said of the kinds before.
static void append_left_out(size_t count, const char *one, const char *several, size_t *said,
                            Text *text)
{
    if (count > 0) {
        text_append(text, *said > 0 ? ", %zu %s" : "  And %zu more %s", count,
                    count > 1 ? several : one);
        *said += count;
    }
}

// Names so many of the joints without play, those with the largest forces. There is no row for any
// of them.
static void write_ideal_line(const Overview *overview, size_t most, Text *text)
{
    const size_t start = text->length;
    text_append(text, "  Without play: ");
    for (size_t i = 0; i < least(overview->ideal_count, most); i++) {
        const OverviewRow *row = &overview->ideal_joints[i];
        text_append(text, "%s", i > 0 ? ", " : "");
        text_append_shown(text, row->name);
        text_append(text, " ");
        run_overview_cell(row, OVERVIEW_LARGEST, text);
    }
    text_append(text, "; --full has more.\n");
    text_fold_behind(text, start, STYLE_WIDTH);
}

// Returns whether --full is said to have what there is no room for.
static bool write_left_out(const Overview *overview, OverviewRows shown, Text *text)
{
    const size_t joints = shown.joints;
    const size_t ideals = shown.ideals;
    const size_t bodies = shown.bodies;
    const bool has_ideal = run_overview_has_ideal(overview) && overview->ideal_count > 0;
    if (has_ideal && ideals == 0 && joints == overview->joint_count) {
        write_ideal_line(overview, shown.named, text);
        return true;
    }
    size_t said = 0;
    append_left_out(overview->joint_count - joints, "joint with play", "joints with play", &said,
                    text);
    append_left_out(has_ideal ? overview->ideal_count - ideals : 0, "joint without play",
                    "joints without play", &said, text);
    append_left_out(overview->body_count - bodies, "body", "bodies", &said, text);
    text_append(text, "%s", said > 0 ? ": --full shows them.\n" : "");
    return said > 0;
}

// Returns whether --full is said to have what there is no room for.
bool run_overview_table(const Overview *overview, const Scenario *scenario, OverviewRows rows,
                        Text *text)
{
    const bool has_crank = drive_is_steady(&scenario->linkage.driver);
    const size_t joints = least(overview->joint_count, rows.joints);
    const size_t ideals =
        run_overview_has_ideal(overview) ? least(overview->ideal_count, rows.ideals) : 0;
    const size_t bodies = least(overview->body_count, rows.bodies);
    const size_t bushings = least(overview->bushing_count, rows.bushings);
    if (joints + ideals + bushings + bodies == 0) {
        return false;
    }
    const OverviewTable made =
        begin_table(overview, has_crank, joints + ideals + bushings > 0, rows.width);
    add_rows(&made, "", overview->joints, joints);
    add_rows(&made, "", overview->ideal_joints, ideals);
    add_rows(&made, "", overview->bushings, bushings);
    add_rows(&made, "", overview->bodies, bodies);
    add_rows(&made, run_overview_drive_kind(overview), overview->drives, overview->drive_count);
    table_write(made.table, text);
    table_destroy(made.table);
    const OverviewRows shown = {
        .joints = joints, .ideals = ideals, .bodies = bodies, .named = rows.named};
    return write_left_out(overview, shown, text);
}
