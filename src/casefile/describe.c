// What may stand in a case file, for people: in a terminal and as a page of the documentation.
#include "casefile/casefile.h"
#include "casefile/expect.h"
#include "casefile/expect_outcome.h"
#include "casefile/schema.h"
#include "casefile/schema_needs.h"

#include <stdio.h>
#include <string.h>

enum { DESCRIBE_INDENT = 8, DESCRIBE_TITLES = 18, DESCRIBE_COUNTS = 4 }; // columns

static const char EXAMPLE[] =
    "title: Crank-rocker at 1000 rpm with play in the crank-coupler pin\n"
    "four-bar:\n"
    "  ground:   {length: 254 mm}\n"
    "  crank:    {length: 108 mm,   mass: 0.12 kg, inertia: 173.92 kg mm^2}\n"
    "  coupler:  {length: 279.4 mm, mass: 0.29 kg, inertia: 2070.46 kg mm^2}\n"
    "  follower: {length: 270.5 mm, mass: 0.28 kg, inertia: 1988.39 kg mm^2}\n"
    "joints:\n"
    "  crank-coupler: {hole: 10.015 mm, pin: 9.986 mm, width: 13 mm}\n"
    "drive: {speed: 1000 rpm, start: 0 deg}\n"
    "contact: {law: hertz-socket, damping: lankarani-nikravesh, restitution: 0.9}\n"
    "run: {revolutions: 1, samples: 3600, step: 1 us, backends: [analytic, ode]}\n"
    "ode: {solver: direct, map: textbook}\n";

static const char SLIDER_EXAMPLE[] =
    "title: Slider-crank at 1000 rpm with play in a pin and in the guide\n"
    "slider-crank:\n"
    "  crank:  {length: 50 mm,  mass: 0.30 kg, inertia: 100 kg mm^2}\n"
    "  rod:    {length: 120 mm, mass: 0.21 kg, inertia: 250 kg mm^2}\n"
    "  slider: {mass: 0.14 kg, inertia: 100 kg mm^2}\n"
    "joints:\n"
    "  rod-slider:   {hole: 20.1 mm, pin: 20 mm, width: 20 mm}\n"
    "  slider-guide: {guide: 40.2 mm, block: 40 mm, length: 60 mm}\n"
    "drive: {speed: 1000 rpm}\n"
    "contact: {stiffness: 1e9 N/m, damping: exact, restitution: 0.5}\n"
    "run: {revolutions: 0.1, samples: 3600}\n";

static const char LONG_EXAMPLE[] =
    "title: Pin circling in its hole\n"
    "bodies:\n"
    "  pin: {mass: 0.1 kg, inertia: 2 kg mm^2, at: [0 mm, 0 mm],\n"
    "        velocity: [0.5 m/s, 0 m/s]}\n"
    "joints:\n"
    "  hole: {between: [ground, pin], at: [0 mm, 0 mm], hole: 10.2 mm, pin: 10 mm,\n"
    "         width: 10 mm}\n"
    "run: {duration: 60 ms, samples: 3600, step: 1 us, backends: [reference, ode]}\n";

static const char EXPECT_EXAMPLE[] = "expect:\n"
                                     "  joints.crank-coupler.force_max: below 1.2 kN\n"
                                     "  joints.crank-coupler.impacts: between 3 and 12\n"
                                     "  bodies.coupler.alpha_max: within 2 % of 7574 rad/s^2\n"
                                     "  ode.error.max: below 1e-3\n";

static const char *const RULES[] = {
    "A case is one YAML document of at most 16 MiB. Every quantity but 0 has its unit; the "
    "decimal separator is a point.",
    "Numbers of the mechanism, its loads and contacts may have a tolerance, 108 +- 0.3 mm, 108 "
    "+0.1/-0.2 mm, 1000 rpm +- 1 %, and hole and pin a fit, 30 H7 and 30 g6: run draws from them.",
    "A case has four-bar, slider-crank, or, for any linkage, bodies.",
    "Unknown and doubled keys are errors, as are anchors, aliases and tags.",
    "A key that the case makes no use of is an error where another key was forgotten, such as "
    "space: spatial beside inertia-x; otherwise a warning says what would use it.",
    "On the command line, --set KEY=VALUE takes a key's whole path: --set run.step=2us. It "
    "replaces what the file says about the key, and about a key that excludes it.",
};

// sections that are no groups of the schema
static const char EXPECT[] = "expect";
static const char TOP_LEVEL[] = "top";

enum { RULE_COUNT = sizeof RULES / sizeof RULES[0] };

// The group a row belongs to: what stands before the first dot, empty where there is none.
static bool is_in_group(const SchemaRow *row, const char *group)
{
    const char *dot = strchr(row->path, '.');
    const size_t length = dot != NULL ? (size_t)(dot - row->path) : 0;
    return strlen(group) == length && strncmp(row->path, group, length) == 0;
}

// The range in SI; nothing where the value is no number.
static void describe_range(const SchemaRow *row, Text *text)
{
    if (!(row->low < row->high)) {
        return;
    }
    const char *unit = schema_unit(row);
    const int digits = row->type == SCHEMA_INTEGER ? 12 : 6;
    text_append(text, row->low_is_open ? "above %.*g, up to %.*g%s%s" : "%.*g to %.*g%s%s", digits,
                row->low, digits, row->high, unit[0] != '\0' ? " " : "", unit);
}

// Of which joints a key is required.
static void append_kinds(const SchemaRow *row, Text *text)
{
    const bool is_of_hinges = schema_is_of_any(row, JOINTS_WITH_ANGLE);
    const bool is_of_stops = schema_is_of_any(row, JOINTS_WITH_DISC);
    if (row->family != SCHEMA_JOINT || row->rivalry != SCHEMA_NO_RIVAL ||
        (is_of_hinges && is_of_stops)) {
        return;
    }
    text_append(text, schema_is_of_any(row, JOINTS_WITH_MESH)   ? " of gears"
                      : schema_is_of_any(row, JOINTS_WITH_RACK) ? " of a rack"
                      : is_of_hinges                            ? " but of a stop"
                      : is_of_stops                             ? " of a stop"
                      : schema_is_of_any(row, JOINTS_WITH_POSITION)
                          ? " of a prismatic joint or guide"
                      : schema_is_of_any(row, JOINTS_WITH_GUIDES) ? " of a guide"
                                                                  : "");
}

// The default, as the program's own default scenario has it.
static void describe_default(size_t row_number, Text *text)
{
    const SchemaRow *row = &SCHEMA_ROWS[row_number];
    if (row->is_required && row->default_words == NULL) {
        text_append(text, row->rivalry == SCHEMA_SIZES ? "required without radial-clearance"
                          : row->rivalry == SCHEMA_DRIVING
                              ? "required without angle, torque, force or stall-torque"
                          : row->rivalry == SCHEMA_STOPPING
                              ? "required of a stop, or discs, or profile"
                          : row->rivalry == SCHEMA_PLACING && row->family == SCHEMA_BUSHING
                              ? row->side == SCHEMA_PLACE_OF_BOTH ? "required without at-a and at-b"
                                                                  : "required without at"
                          : row->side == SCHEMA_PLACE_OF_BOTH
                              ? "required without at-a and at-b, but of a stop"
                          : row->rivalry == SCHEMA_PLACING ? "required of a stop"
                                                           : "required");
        append_kinds(row, text);
        return;
    }
    if (row->default_words != NULL) {
        text_append(text, "%s", row->default_words);
        if (row->is_required) {
            append_kinds(row, text);
        }
        return;
    }
    const Scenario defaults = scenario_default();
    char path[SCHEMA_PATH_SIZE];
    schema_path(row, "*", path);
    CasefileSetting setting;
    CasefileWalk walk = casefile_walk(&defaults);
    while (casefile_next(&walk, &setting)) {
        if (strcmp(setting.key, path) == 0) {
            break;
        }
    }
    if (setting.kind == CASEFILE_NUMBER || setting.kind == CASEFILE_INTEGER) {
        const char *blank = setting.unit[0] != '\0' ? " " : "";
        static const char *const FORMATS[] = {"%.6g", "[%.6g, %.6g]", "[%.6g, %.6g, %.6g]"};
        text_append(text, FORMATS[setting.number_count - 1], setting.numbers[0], setting.numbers[1],
                    setting.numbers[2]);
        text_append(text, "%s%s", blank, setting.unit);
    } else {
        text_append(text, "%s", setting.text);
    }
}

// Appends words in lines of so many columns, indented.
static void append_wrapped(const char *words, int indent, int width, Text *text)
{
    size_t column = 0;
    while (*words != '\0') {
        const size_t length = strcspn(words, " ");
        if (column > 0 && column + 1 + length > (size_t)width) {
            text_append(text, "\n");
            column = 0;
        }
        if (column == 0) {
            text_append(text, "%*s%.*s", indent, "", (int)length, words);
            column = (size_t)indent + length;
        } else {
            text_append(text, " %.*s", (int)length, words);
            column += 1 + length;
        }
        words += length;
        words += *words == ' ' ? 1 : 0;
    }
    text_append(text, "\n");
}

static bool is_of_group(const SchemaRow *row, const char *group)
{
    return strncmp(row->path, group, strlen(group)) == 0;
}

// The row's meaning, and what a case needs besides for it to matter. The page leaves out what it
// says of whole groups: of ODE, of mechanisms in space, and that contacts are those of joints with
// play that have no values of their own.
static void describe_meaning(const SchemaRow *row, bool is_page, Text *text)
{
    SchemaRow shown = *row;
    if (is_page) {
        shown.needs &= ~SPATIAL & ~(is_of_group(row, "ode.") ? ODE : 0U) &
                       ~(is_of_group(row, "contact.") ? PLAY : 0U);
        shown.wants &= ~(COMMON_STIFFNESS | COMMON_DAMPING | COMMON_FRICTION);
        shown.needs &= ~((row->wants & SETTLED) != 0 ? PLAY | REPEATING | IMPACT : 0U) &
                       ~((row->wants & PIN) != 0 ? PLAY : 0U);
        // an engine is its own backend, and a chosen step is that of a backend with steps
        const bool is_said = is_of_group(row, "engines.") || (row->needs & CHOSEN_STEP) != 0;
        shown.backends = is_said ? 0 : row->backends;
    }
    Text needs;
    text_init(&needs);
    schema_list_needs(&shown, &needs);
    text_append(text,
                needs.length == 0 ? "%s"
                : is_page         ? "%s. Needs %s"
                                  : "%s. Used with: %s",
                row->doc, needs.data);
    text_finish(&needs);
}

// Whether two keys of links, such as four-bar.crank.offset and four-bar.coupler.offset, are one to
// people.
static bool are_alike(const SchemaRow *row, const SchemaRow *other)
{
    const char *dot = strchr(row->path, '.');
    const char *last = strrchr(row->path, '.');
    const char *other_last = strrchr(other->path, '.');
    return dot != NULL && last != dot && other_last != NULL && row->family == SCHEMA_SINGLE &&
           other->family == SCHEMA_SINGLE && strcmp(last, other_last) == 0 &&
           strncmp(row->path, other->path, (size_t)(dot - row->path) + 1) == 0 &&
           strcmp(row->doc, other->doc) == 0 && row->low == other->low && row->high == other->high;
}

// How many of the rows from first to before end are alike to one, besides it.
static size_t count_alike(const SchemaRow *row, size_t first, size_t end)
{
    size_t count = 0;
    for (size_t i = first; i < end; i++) {
        count += &SCHEMA_ROWS[i] != row && are_alike(row, &SCHEMA_ROWS[i]) ? 1 : 0;
    }
    return count;
}

// Whether two keys of one body mean the same, such as its products of inertia.
static bool means_the_same(size_t row_number, size_t other_number)
{
    if (row_number >= SCHEMA_ROW_COUNT || other_number >= SCHEMA_ROW_COUNT) {
        return false;
    }
    const SchemaRow *row = &SCHEMA_ROWS[row_number];
    const SchemaRow *other = &SCHEMA_ROWS[other_number];
    const char *dot = strrchr(row->path, '.');
    return dot != NULL && strcmp(row->doc, other->doc) == 0 &&
           strncmp(row->path, other->path, (size_t)(dot - row->path) + 1) == 0 &&
           row->low == other->low && row->high == other->high;
}

// What a value is, without the units, which the page lists once.
static void describe_value(const SchemaRow *row, Text *text)
{
    Text words;
    Text units;
    text_init(&words);
    text_init(&units);
    schema_describe(row, false, &words);
    text_append(&units, " in ");
    units_list(row->dimension, &units);
    const char *listed = strstr(words.data, units.data);
    // without its article
    const char *name = words.data;
    name += strncmp(name, "a ", 2) == 0 ? 2 : strncmp(name, "an ", 3) == 0 ? 3 : 0;
    if (row->dimension != DIMENSION_NONE && listed != NULL) {
        text_append(text, "%.*s%s", (int)(listed - name), name, listed + units.length);
    } else {
        const size_t plain = strncmp(name, "plain ", 6) == 0 ? 6 : 0;
        text_append(text, "%s", name + plain);
    }
    text_finish(&units);
    text_finish(&words);
}

// A key on the page; links that share one share the line.
static void describe_line(size_t row_number, const char *path, Text *text)
{
    const SchemaRow *row = &SCHEMA_ROWS[row_number];
    if (count_alike(row, 0, row_number) > 0 || means_the_same(row_number, row_number - 1)) {
        return;
    }
    Text words;
    text_init(&words);
    if (count_alike(row, row_number, SCHEMA_ROW_COUNT) > 0) {
        const int length = (int)(strchr(path, '.') - path);
        text_append(text, "- `%.*s.<link>%s`", length, path, strrchr(path, '.'));
    } else {
        text_append(text, "- `%s`", path);
    }
    for (size_t i = row_number + 1; means_the_same(i, row_number); i++) {
        text_append(text, ", `%s`", strrchr(SCHEMA_ROWS[i].path, '.') + 1);
    }
    text_append(text, " (");
    describe_value(row, text);
    describe_default(row_number, &words);
    if (strcmp(words.data, "none") != 0) {
        text_append(text, row->is_required ? "; %s" : "; default %s", words.data);
    }
    text_finish(&words);
    text_append(text, "): ");
    describe_meaning(row, true, text);
    text_append(text, "\n");
}

// A row in words for a terminal of a width, or on a line of the page (0).
static void describe_row(size_t row_number, int width, Text *text)
{
    const bool is_page = width == 0;
    const SchemaRow *row = &SCHEMA_ROWS[row_number];
    char path[SCHEMA_PATH_SIZE];
    char name[LINKAGE_NAME_SIZE];
    snprintf(name, sizeof name, "<%s>", SCHEMA_FAMILIES[row->family].what);
    schema_path(row, name, path);
    if (is_page) {
        describe_line(row_number, path, text);
        return;
    }
    Text words;
    text_init(&words);
    describe_meaning(row, false, &words);
    text_append(&words, ". ");
    schema_describe(row, false, &words);
    text_append(&words, "; ");
    const size_t before = words.length;
    describe_range(row, &words);
    text_append(&words, "%s%s", words.length > before ? "; " : "",
                row->is_required ? "" : "default: ");
    describe_default(row_number, &words);
    text_append(text, "    %s\n", path);
    append_wrapped(words.data, DESCRIBE_INDENT, width, text);
    text_finish(&words);
}

// The keys of a group that are for mechanisms in space, or the others.
static void describe_keys(const SchemaGroup *group, bool is_of_space, int width, Text *text)
{
    const bool is_page = width == 0;
    size_t count = 0;
    for (size_t i = 0; i < SCHEMA_ROW_COUNT; i++) {
        const SchemaRow *row = &SCHEMA_ROWS[i];
        if (!is_in_group(row, group->path) || ((row->needs & SPATIAL) != 0) != is_of_space) {
            continue;
        }
        if (is_page && is_of_space && count == 0) {
            text_append(text, "\nWith `space: spatial`:\n\n");
        }
        describe_row(i, width, text);
        count++;
    }
}

static void describe_group(const SchemaGroup *group, int width, Text *text)
{
    const bool is_page = width == 0;
    const bool is_peak = group->path[0] == '\0';
    if (is_page) {
        text_append(text, is_peak ? "\n## %s\n\n%s\n\n" : "\n## `%s`\n\n%s\n\n",
                    is_peak ? "Top level" : group->path, group->doc);
    } else {
        text_append(text, "\n%s\n", is_peak ? TOP_LEVEL : group->path);
        append_wrapped(group->doc, 2, width, text);
    }
    describe_keys(group, false, width, text);
    describe_keys(group, true, width, text);
}

static void describe_groups(int width, Text *text)
{
    for (size_t g = 0; g < SCHEMA_GROUP_COUNT; g++) {
        describe_group(&SCHEMA_GROUPS[g], width, text);
    }
}

// The units of every quantity, once.
static void describe_units(Text *text)
{
    text_append(text, "\n## Units\n\nThe range of each key is in `jointplay help case KEY`.\n\n");
    for (int i = 0; i < DIMENSION_COUNT; i++) {
        Text units;
        text_init(&units);
        units_list((Dimension)i, &units);
        if (units.length > 0) {
            text_append(text, "- %s: %s\n", units_dimension_name((Dimension)i), units.data);
        }
        text_finish(&units);
    }
}

// The path of a number that can be limited.
static void append_path(NumberId id, Text *text)
{
    static const char *const MEMBERS[] = {
        [NUMBER_OF_WHOLE] = "", [NUMBER_OF_BODIES] = "<body>.", [NUMBER_OF_JOINTS] = "<joint>."};
    const NumberOwnerRow *owner = &NUMBER_OWNERS[NUMBERS[id].owner];
    text_append(text, "%s.%s%s%s", owner->path, MEMBERS[owner->members], owner->before,
                NUMBERS[id].name);
}

// Those whose meanings the page of results has.
static void list_known(Text *text)
{
    const char *before = "- with the meanings in [numbers](output.md#numbers): ";
    for (NumberId id = 0; id < NUMBER_COUNT; id++) {
        if ((NUMBERS[id].places & NUMBER_EXPECT) != 0 && (NUMBERS[id].places & NUMBER_JSON) != 0) {
            text_append(text, "%s`", before);
            append_path(id, text);
            text_append(text, "`");
            before = ", ";
        }
    }
    text_append(text, "\n");
}

static void describe_expectation(NumberId id, int width, Text *text)
{
    const bool is_page = width == 0;
    const Number *number = &NUMBERS[id];
    const bool is_sped = number->owner == NUMBER_OWNER_BODY_SPIKE;
    const ExpectRow row = expect_row(id, is_sped ? NUMBER_SPED : NUMBER_PUSHED);
    text_append(text, is_page ? "- `" : "    ");
    append_path(id, text);
    if (is_page) {
        text_append(text, "`: %s%s\n", number->meaning,
                    row.needs_play ? "; of a joint with play" : "");
        return;
    }
    Text units;
    text_init(&units);
    units_list(row.dimension, &units);
    const char *unit = units.length > 0 ? units.data : row.is_count ? "a whole number" : "plain";
    text_append(text, "\n");
    Text words;
    text_init(&words);
    text_append(&words, "%s%s; %s", number->meaning, row.needs_play ? ", of a joint with play" : "",
                unit);
    append_wrapped(words.data, DESCRIBE_INDENT, width, text);
    text_finish(&words);
    text_finish(&units);
}

// How runs are expected to end.
static void describe_outcomes(int width, Text *text)
{
    const bool is_page = width == 0;
    static const char WORDS[] =
        "`outcome` is how runs end. Without a path in front it applies to every backend of the "
        "case that models the play; behind a backend, to that one; behind words of a scheme of "
        "ODE, as `compare --schemes` takes them, to every scheme with these words, at run.step. "
        "`jointplay check` makes these runs itself: one that is expected to fail is no error.";
    static const char KINDS[] =
        "agrees: it ends, and its error up to the horizon and the reference's uncertainty are "
        "together within X. reported: it ends, and the error, which `jointplay run` prints, is "
        "above X. detected: it stops after its first step, or ends short of its tolerance, with "
        "a message that has these words. refused: it does not begin, with such a message.";
    static const char EXAMPLE_OF_OUTCOMES[] = "expect:\n"
                                              "  outcome: agrees within 1e-3\n"
                                              "  direct/staggered/impulse.outcome: agrees within "
                                              "1e-5\n"
                                              "  plain/textbook.outcome: reported above 0.1\n";
    if (is_page) {
        text_append(text,
                    "\n%s\n\nAn outcome is one of: `%s` ([meanings and an example]"
                    "(checking.md#how-runs-end)).\n",
                    WORDS, EXPECT_OUTCOME_FORMS);
        return;
    }
    text_append(text, "\n");
    append_wrapped(WORDS, 2, width, text);
    text_append(text, "  An outcome is one of:\n");
    append_wrapped(EXPECT_OUTCOME_FORMS, 4, width, text);
    text_append(text, "\n%s\n", EXAMPLE_OF_OUTCOMES);
    append_wrapped(KINDS, 2, width, text);
}

static void describe_expect(int width, Text *text)
{
    const bool is_page = width == 0;
    static const char WORDS[] =
        "Your own limits for numbers of the runs, which `jointplay check` judges, with or without "
        "a baseline. A path may begin with a backend, as in ode.joints.pin.force_max; without one "
        "the limit applies to every backend of the case that models the play, and for an error to "
        "every one except the reference itself. Extremes are taken over every step of the whole "
        "run, errors up to the predictability horizon.";
    text_append(text,
                is_page ? "\n## `expect`\n\n%s\n\nA limit is one of: `%s`. Only between and within "
                          "include their ends ([an example](checking.md#limits-of-your-own)).\n\n"
                        : "\nexpect\n",
                WORDS, EXPECT_FORMS);
    if (!is_page) {
        append_wrapped(WORDS, 2, width, text);
        text_append(text, "  A limit is one of:\n");
        append_wrapped(EXPECT_FORMS, 4, width, text);
        text_append(text, "\n%s\n", EXPECT_EXAMPLE);
    }
    if (is_page) {
        list_known(text);
    }
    for (NumberId id = 0; id < NUMBER_COUNT; id++) {
        const bool is_known = is_page && (NUMBERS[id].places & NUMBER_JSON) != 0;
        if ((NUMBERS[id].places & NUMBER_EXPECT) != 0 && !is_known) {
            describe_expectation(id, width, text);
        }
    }
    describe_outcomes(width, text);
}

static void describe_rules(int width, Text *text)
{
    for (size_t i = 0; i < RULE_COUNT; i++) {
        append_wrapped(RULES[i], 0, width, text);
    }
}

static size_t count_keys(const char *group)
{
    size_t count = 0;
    for (size_t i = 0; i < SCHEMA_ROW_COUNT; i++) {
        count += is_in_group(&SCHEMA_ROWS[i], group) ? 1 : 0;
    }
    return count;
}

static void append_title(const char *name, size_t keys, const char *title, int width, Text *text)
{
    char count[24] = "";
    if (keys > 0) {
        snprintf(count, sizeof count, "%zu", keys);
    }
    text_append(text, "  %-*s%*s  ", DESCRIBE_TITLES - 2, name, DESCRIBE_COUNTS, count);
    const int indent = DESCRIBE_TITLES + DESCRIBE_COUNTS + 2;
    Text words;
    text_init(&words);
    append_wrapped(title, indent, width > 2 * indent ? width : 2 * indent, &words);
    text_append(text, "%s", words.data + indent);
    text_finish(&words);
}

void casefile_describe(int width, Text *text)
{
    text_append(text, "A case file\n\n"
                      "  jointplay help case SECTION  the keys of a section, such as joints\n"
                      "  jointplay help case KEY      one key: contact.friction, or friction for\n"
                      "                               all of that name\n"
                      "  jointplay help case --all    all keys of all sections\n\n");
    text_append(text, "%s\n  %-*s%*s\n", EXAMPLE, DESCRIBE_TITLES - 2, "section", DESCRIBE_COUNTS,
                "keys");
    for (size_t g = 0; g < SCHEMA_GROUP_COUNT; g++) {
        const SchemaGroup *group = &SCHEMA_GROUPS[g];
        append_title(group->path[0] != '\0' ? group->path : TOP_LEVEL, count_keys(group->path),
                     group->title, width, text);
    }
    append_title(EXPECT, 0, "your own limits, which 'jointplay check' judges", width, text);
    text_append(text, "\n");
    describe_rules(width, text);
    text_append(text, "\n");
    append_wrapped("'jointplay new' writes an example to begin with.", 0, width, text);
}

void casefile_describe_all(int width, Text *text)
{
    text_append(text, "A case file\n\n");
    describe_rules(width, text);
    text_append(text, "\n%s\nOr, for a slider-crank:\n\n%s\nOr, for any other linkage:\n\n%s",
                EXAMPLE, SLIDER_EXAMPLE, LONG_EXAMPLE);
    describe_groups(width, text);
    describe_expect(width, text);
}

// The last word of a path, and how long what stands before it is, without its dot.
static const char *last_word(const char *path, size_t length, size_t *before)
{
    size_t at = length;
    while (at > 0 && path[at - 1] != '.') {
        at--;
    }
    *before = at > 0 ? at - 1 : 0;
    return path + at;
}

// Whether a path of the schema ends with the words of a name; a star there is any word.
static bool ends_with(const char *path, const char *name)
{
    size_t path_left = strlen(path);
    size_t name_left = strlen(name);
    while (name_left > 0 && path_left > 0) {
        size_t path_before;
        size_t name_before;
        const char *word = last_word(path, path_left, &path_before);
        const char *wanted = last_word(name, name_left, &name_before);
        const size_t size = path_left - (size_t)(word - path);
        const size_t wanted_size = name_left - (size_t)(wanted - name);
        const bool is_any = size == 1 && word[0] == '*';
        if (!is_any && (size != wanted_size || strncmp(word, wanted, size) != 0)) {
            return false;
        }
        path_left = path_before;
        name_left = name_before;
    }
    return name_left == 0;
}

// All keys that a name means.
static size_t describe_named(const char *name, int width, Text *text)
{
    size_t count = 0;
    for (size_t i = 0; i < SCHEMA_ROW_COUNT; i++) {
        const char *path = SCHEMA_ROWS[i].path;
        // one that ends with a name of somebody's own is meant by its whole path alone
        const bool is_own = path[strlen(path) - 1] == '*' && strchr(name, '.') == NULL;
        const bool is_named = !is_own && ends_with(path, name);
        if (is_named) {
            describe_row(i, width, text);
        }
        count += is_named ? 1 : 0;
    }
    return count;
}

// Says which section or key a word that is none may stand for.
static bool refuse_part(const char *name, Err *err)
{
    enum { KEY_MOST = 512 };
    const char *names[KEY_MOST] = {EXPECT};
    size_t count = 1;
    Text list;
    text_init(&list);
    for (size_t g = 0; g < SCHEMA_GROUP_COUNT; g++) {
        if (SCHEMA_GROUPS[g].path[0] != '\0') {
            names[count++] = SCHEMA_GROUPS[g].path;
            text_append(&list, "%s, ", SCHEMA_GROUPS[g].path);
        }
    }
    for (size_t i = 0; i < SCHEMA_ROW_COUNT && count < KEY_MOST; i++) {
        const char *dot = strrchr(SCHEMA_ROWS[i].path, '.');
        names[count++] = strchr(name, '.') != NULL || dot == NULL ? SCHEMA_ROWS[i].path : dot + 1;
    }
    const char *nearest = text_nearest(name, names, count);
    err_set(err, ERR_USAGE, "'jointplay help case' has no section or key '%s'%s%s%s\nallowed: %s%s",
            name, nearest != NULL ? "; did you mean '" : "", nearest != NULL ? nearest : "",
            nearest != NULL ? "'?" : "", list.data, EXPECT);
    text_finish(&list);
    return false;
}

// The top level is called so, and expect is no group of the schema.
bool casefile_describe_part(const char *name, int width, Text *text, Err *err)
{
    if (strcmp(name, EXPECT) == 0) {
        describe_expect(width, text);
        return true;
    }
    for (size_t g = 0; g < SCHEMA_GROUP_COUNT; g++) {
        const SchemaGroup *group = &SCHEMA_GROUPS[g];
        if (strcmp(name, group->path[0] != '\0' ? group->path : TOP_LEVEL) == 0) {
            describe_group(group, width, text);
            return true;
        }
    }
    return describe_named(name, width, text) > 0 || refuse_part(name, err);
}

void casefile_describe_markdown(Text *text)
{
    text_append(text, "# The case file\n\n"
                      "This page is generated from the program's own schema.\n\n");
    for (size_t i = 0; i < RULE_COUNT; i++) {
        text_append(text, "- %s\n", RULES[i]);
    }
    text_append(
        text,
        "\n```yaml\n%s```\n\nOr, for a slider-crank:\n\n```yaml\n%s```\n\nOr, for any other "
        "linkage:\n\n```yaml\n%s```\n",
        EXAMPLE, SLIDER_EXAMPLE, LONG_EXAMPLE);
    describe_units(text);
    describe_groups(0, text);
    describe_expect(0, text);
}
