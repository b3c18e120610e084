// Takes the tolerances of a case's numbers.
//
// A value with a tolerance is read as its nominal number, by whatever reads numbers of its key, and
// the limits are noted in the scenario in the value's own unit, so that a number between them is
// written and read as the nominal one is. Of a fit the number is the middle of its limits.
#include "casefile/tolerance.h"

#include "base/memory.h"
#include "casefile/fit.h"
#include "casefile/target.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

// Groups whose keys describe the mechanism and what acts on it.
static const char *const GROUPS[] = {
    "four-bar.",        "slider-crank.", "bodies.",  "joints.", "springs.",
    "torsion-springs.", "bushings.",     "loads.",   "drive.",  "drives.",
    "gravity",          "material.",     "contact.",
};

// Keys among them that say when or from where it moves, or how a force is smoothed.
static const char *const WITHOUT[] = {
    "drive.start",     "drive.period",      "drives.*.period",      "loads.*.period",
    "bodies.*.spin",   "bodies.*.velocity", "bodies.*.spin-x",      "bodies.*.velocity-z",
    "bodies.*.spin-y", "joints.*.start",    "contact.bounce-speed", "contact.impact-speed-floor",
};

static const char HOLE[] = "joints.*.hole";
static const char PIN[] = "joints.*.pin";

static bool is_number(SchemaType type)
{
    switch (type) {
    case SCHEMA_QUANTITY:
    case SCHEMA_DIAMETER:
    case SCHEMA_TOLERATED:
    case SCHEMA_STIFFNESS:
    case SCHEMA_COORDINATE:
    case SCHEMA_DAMPER:
    case SCHEMA_HEADING:
    case SCHEMA_RADIAL_CLEARANCE:
    case SCHEMA_TORQUE:
    case SCHEMA_SPEED:
    case SCHEMA_LOAD:
    case SCHEMA_VECTOR:
    case SCHEMA_PAIR:
    case SCHEMA_ANCHOR:
    case SCHEMA_GRAVITY:
        return true;
    default:
        return false;
    }
}

bool tolerance_is_of(const SchemaRow *row)
{
    bool is_of = false;
    for (size_t i = 0; i < sizeof GROUPS / sizeof *GROUPS; i++) {
        is_of = is_of || strncmp(row->path, GROUPS[i], strlen(GROUPS[i])) == 0;
    }
    for (size_t i = 0; i < sizeof WITHOUT / sizeof *WITHOUT; i++) {
        is_of = is_of && strcmp(row->path, WITHOUT[i]) != 0;
    }
    return is_of && is_number(row->type);
}

// How many of one unit make one of another; of units that are not the row's the reader complains.
static bool find_ratio(const SchemaRow *row, const char *unit, const char *other, double *ratio,
                       Complaint *complaint)
{
    char text[QUANTITY_TEXT_SIZE];
    TargetNumber one;
    TargetNumber other_one;
    *ratio = 1.0;
    if (strcmp(unit, other) == 0) {
        return true;
    }
    snprintf(text, sizeof text, "1 %.200s", unit);
    if (!target_read(row, text, &one, complaint)) {
        return false;
    }
    snprintf(text, sizeof text, "1 %.200s", other);
    if (!target_read(row, text, &other_one, complaint)) {
        return false;
    }
    *ratio = other_one.value / one.value;
    return true;
}

static bool read_limits(const SchemaRow *row, const char *text, Tolerated *tolerated,
                        Complaint *complaint)
{
    QuantityCut cut;
    if (!quantity_cut(text, row->dimension, &cut, complaint)) {
        return false;
    }
    if (!cut.is_there) {
        return true;
    }
    double ratio = 0.01 * fabs(cut.nominal);
    if (!cut.is_percent && !find_ratio(row, cut.unit, cut.limit_unit, &ratio, complaint)) {
        return false;
    }
    tolerated->is_there = true;
    tolerated->nominal = cut.nominal;
    tolerated->lower = ratio * cut.lower;
    tolerated->upper = ratio * cut.upper;
    text_copy(tolerated->unit, sizeof tolerated->unit, cut.unit);
    return true;
}

bool tolerance_read(const SchemaRow *row, const char *text, Tolerated *tolerated,
                    Complaint *complaint)
{
    *tolerated = (Tolerated){.is_there = false};
    const bool is_hole = strcmp(row->path, HOLE) == 0;
    if ((is_hole || strcmp(row->path, PIN) == 0) && fit_is(text)) {
        FitLimits limits;
        if (!fit_read(text, is_hole, &limits, complaint)) {
            return false;
        }
        tolerated->is_there = true;
        tolerated->nominal = 0.5 * (limits.low + limits.high);
        tolerated->lower = limits.low - tolerated->nominal;
        tolerated->upper = limits.high - tolerated->nominal;
        text_copy(tolerated->unit, sizeof tolerated->unit, "mm");
        return true;
    }
    return read_limits(row, text, tolerated, complaint);
}

// Whether the limits are in the range of the row; what cannot be read has its message where the
// number is.
static bool are_in_range(const SchemaRow *row, const Tolerated *tolerated)
{
    const double limits[2] = {tolerated->nominal + tolerated->lower,
                              tolerated->nominal + tolerated->upper};
    bool are = true;
    for (int i = 0; i < 2; i++) {
        char text[QUANTITY_TEXT_SIZE];
        TargetNumber number;
        Complaint unused;
        snprintf(text, sizeof text, "%.17g %s", limits[i], tolerated->unit);
        are = are && (!target_read(row, text, &number, &unused) ||
                      (number.value <= row->high &&
                       (row->low_is_open ? number.value > row->low : number.value >= row->low)));
    }
    return are;
}

static void note(const Entry *entry, size_t item, const Tolerated *tolerated, Scenario *scenario)
{
    const size_t count = scenario->tolerance_count;
    scenario->tolerances =
        memory_grown(scenario->tolerances, count + 1, sizeof *scenario->tolerances);
    ScenarioTolerance *noted = &scenario->tolerances[scenario->tolerance_count++];
    *noted = (ScenarioTolerance){
        .row = (size_t)(schema_find(entry->row->path) - SCHEMA_ROWS),
        .member = entry->index,
        .item = item,
        .nominal = tolerated->nominal,
        .lower = tolerated->lower,
        .upper = tolerated->upper,
    };
    text_copy(noted->unit, sizeof noted->unit, tolerated->unit);
}

// Takes the tolerance of one number; the text is that of the number alone.
static bool take_one(const Entry *entry, const SchemaRow *row, const Node *node, size_t item,
                     Scenario *scenario, bool *is_there, char *text, Err *err)
{
    Tolerated tolerated;
    Complaint complaint = {.allowed = ""};
    if (!tolerance_read(row, node->text, &tolerated, &complaint)) {
        return source_error(entry->source, node->span, complaint.allowed, err, "%s",
                            complaint.text);
    }
    *is_there = tolerated.is_there;
    if (!tolerated.is_there) {
        return true;
    }
    if (!are_in_range(row, &tolerated)) {
        return source_error(entry->source, node->span, "a smaller tolerance", err,
                            "with its tolerance %s leaves its range: %.60s", row->path, node->text);
    }
    snprintf(text, QUANTITY_TEXT_SIZE, "%.17g %s", tolerated.nominal, tolerated.unit);
    text[strcspn(text, "\n")] = '\0';
    if (tolerated.unit[0] == '\0') {
        text[strlen(text) - 1] = '\0';
    }
    note(entry, item, &tolerated, scenario);
    return true;
}

bool tolerance_take(const Entry *entry, const SchemaRow *row, Scenario *scenario, PlainNode *plain,
                    Err *err)
{
    const Node *node = entry->node;
    bool is_there = false;
    plain->node = node;
    if (!tolerance_is_of(row)) {
        return true;
    }
    if (node->kind == NODE_SCALAR) {
        if (!take_one(entry, row, node, 0, scenario, &is_there, plain->texts[0], err)) {
            return false;
        }
        if (is_there) {
            plain->scalar = *node;
            plain->scalar.text = plain->texts[0];
            plain->node = &plain->scalar;
        }
        return true;
    }
    const bool is_vector =
        row->type == SCHEMA_VECTOR || row->type == SCHEMA_ANCHOR || row->type == SCHEMA_PAIR;
    size_t count = 0;
    bool is_any = false;
    for (const Node *item = node->kind == NODE_LIST ? node->first : NULL;
         is_vector && item != NULL && item->kind == NODE_SCALAR && count < 3; item = item->next) {
        Node *copy = &plain->items[count];
        *copy = *item;
        if (!take_one(entry, row, item, count, scenario, &is_there, plain->texts[count], err)) {
            return false;
        }
        if (is_there) {
            copy->text = plain->texts[count];
            is_any = true;
        }
        if (count > 0) {
            plain->items[count - 1].next = copy;
        }
        count++;
    }
    if (is_any) {
        plain->scalar = *node;
        plain->scalar.first = &plain->items[0];
        plain->node = &plain->scalar;
    }
    return true;
}
