// Finds the row of a key, and the field of the scenario that its value goes to.
#include "casefile/schema.h"

#include <assert.h>
#include <stdio.h>
#include <string.h>

bool schema_is_setting(const SchemaRow *row)
{
    return row->type != SCHEMA_EXPECT && row->type != SCHEMA_SIGNAL;
}

const SchemaRow *schema_find(const char *path)
{
    for (size_t i = 0; i < SCHEMA_ROW_COUNT; i++) {
        if (strcmp(SCHEMA_ROWS[i].path, path) == 0) {
            return &SCHEMA_ROWS[i];
        }
    }
    return NULL;
}

// Whether a key is that of a path, with a name in place of its star.
static bool is_of_path(const char *key, const char *path)
{
    const char *star = strchr(path, '*');
    const size_t before = star != NULL ? (size_t)(star - path) : 0;
    if (star == NULL || strncmp(path, key, before) != 0) {
        return star == NULL && strcmp(path, key) == 0;
    }
    const size_t name = strcspn(key + before, ".");
    return name > 0 && strcmp(key + before + name, star + 1) == 0;
}

const SchemaRow *schema_of_key(const char *key)
{
    for (size_t i = 0; i < SCHEMA_ROW_COUNT; i++) {
        if (is_of_path(key, SCHEMA_ROWS[i].path)) {
            return &SCHEMA_ROWS[i];
        }
    }
    return NULL;
}

// What stands behind "group." in the path, or NULL where the path is not below the group.
static const char *below(const char *path, const char *group)
{
    const size_t length = strlen(group);
    if (length == 0) {
        return path;
    }
    return strncmp(path, group, length) == 0 && path[length] == '.' ? path + length + 1 : NULL;
}

const SchemaFormRow *schema_form(SchemaForm form)
{
    for (size_t i = 0; i < SCHEMA_FORM_COUNT; i++) {
        if (SCHEMA_FORMS[i].form == form) {
            return &SCHEMA_FORMS[i];
        }
    }
    return NULL;
}

bool schema_is_of_form(const SchemaRow *row, SchemaForm form)
{
    return row->form == SCHEMA_ALL || (row->form & form) != 0;
}

const char *schema_unit(const SchemaRow *row)
{
    return row->plain_unit != NULL ? row->plain_unit : units_si(row->dimension);
}

void schema_list_words(const SchemaRow *row, Text *text)
{
    for (size_t i = 0; row->words[i] != NULL; i++) {
        text_append(text, "%s%s", i > 0 ? ", " : "", row->words[i]);
    }
}

// A quantity in its units, or with an example of one; or the word that stands for 0.
static void describe_quantity(const SchemaRow *row, bool with_example, Text *text)
{
    text_append(text, "%s%s%s", row->zero_word != NULL ? row->zero_word : "",
                row->zero_word != NULL ? ", or " : "", units_dimension_name(row->dimension));
    if (with_example) {
        text_append(text, " such as %s", units_example(row->dimension));
    } else if (row->dimension != DIMENSION_NONE) {
        text_append(text, " in ");
        units_list(row->dimension, text);
    }
}

static void describe_vector(const SchemaRow *row, bool with_example, Text *text)
{
    const bool has_word = row->default_words != NULL;
    text_append(text, "%s", has_word ? "centred, or " : "");
    if (with_example) {
        text_append(text, "[x, y] such as %s",
                    has_word                            ? "[5 um, 0 um]"
                    : row->dimension == DIMENSION_SPEED ? "[0.5 m/s, 0 m/s]"
                                                        : "[25 mm, 0 mm]");
    } else {
        text_append(text, "%s in [x, y]", units_dimension_name(row->dimension));
    }
}

// A torque or a force over time.
static void describe_torque(const SchemaRow *row, bool with_example, Text *text)
{
    const bool is_force = row->dimension == DIMENSION_FORCE;
    if (with_example) {
        text_append(text, "%s such as %s, or points [[0 s, 1 %s], [10 ms, 0 %s]]",
                    units_dimension_name(row->dimension), units_example(row->dimension),
                    units_si(row->dimension), units_si(row->dimension));
    } else {
        text_append(text, "%s, a list of [time, %s], or a sinusoid",
                    units_dimension_name(row->dimension), is_force ? "force" : "torque");
    }
}

// A force or torque over a deflection.
static void describe_curve(const SchemaRow *row, bool with_example, Text *text)
{
    const bool is_torque = row->dimension == DIMENSION_TORQUE;
    text_append(text, "%s",
                !with_example
                    ? (is_torque ? "a list of [angle, torque]" : "a list of [length, force]")
                : is_torque ? "points in order such as [[-5 deg, -2 N m], [5 deg, 2 N m]]"
                            : "points in order such as [[-1 mm, -50 N], [1 mm, 50 N]]");
}

void schema_describe(const SchemaRow *row, bool with_example, Text *text)
{
    // what a page says of a type, and what a message says
    static const char *const WORDS[][2] = {
        [SCHEMA_TEXT] = {"text", "text on one line"},
        [SCHEMA_INTEGER] = {"a whole number", "a whole number such as 100"},
        [SCHEMA_GRAVITY] = {"an acceleration in m/s^2, mm/s^2, or in [x, y] or [x, y, z]",
                            "an acceleration such as 9.80665 m/s^2, or [x, y] such as "
                            "[1 m/s^2, -9.8 m/s^2], or with space: spatial [x, y, z]"},
        [SCHEMA_DIRECTION] = {"[x, y, z]", "a direction such as [0, 0, 1]"},
        [SCHEMA_START] = {"centred, or a length in [x, y], or [distance, tilt]",
                          "centred, or [x, y] such as [5 um, 0 um]"},
        [SCHEMA_COORDINATE] = {"an angle, or a length", "an angle such as 0.6 deg, or a length "
                                                        "such as 0.2 mm"},
        [SCHEMA_STIFFNESS_FOR] = {"a depth at a force",
                                  "a depth at a force such as 0.1 mm at 500 N"},
        [SCHEMA_PIVOTS] = {"[joint, joint]",
                           "two joints such as [pinion, wheel], or [guide, pinion] of a rack"},
        [SCHEMA_PROFILE] = {"list of [angle, length]",
                            "points such as [[0 deg, 20 mm], [60 deg, 21 mm], ...]"},
        [SCHEMA_TEETH] = {"[whole number, whole number]", "two whole numbers such as [20, 60]"},
        [SCHEMA_DISCS] = {"[length, length]", "two diameters such as [20 mm, 20 mm]"},
        [SCHEMA_SLOT] = {"[length, length]", "length and width such as [30 mm, 8.1 mm]"},
        [SCHEMA_BETWEEN] = {"[body, body]", "two bodies such as [ground, pin]"},
        [SCHEMA_BODY_NAME] = {"a body", "a body"},
        [SCHEMA_JOINT_NAME] = {"a joint", "a joint"},
        [SCHEMA_SPEED] = {"an angular speed, a list of [time, speed], or a sinusoid",
                          "a speed such as 1000 rpm, or points [[0 s, 0 rpm], [10 ms, 1000 rpm]]"},
        [SCHEMA_ANGLES] = {"a list of [time, angle], or a sinusoid",
                           "points [[0 s, 0 deg], [0.5 s, 90 deg], [1 s, 0 deg]]"},
        [SCHEMA_LOAD_PERIOD] = {"none, or a time, an angle or a length",
                                "none, or a time, an angle or a length such as 720 deg"},
        [SCHEMA_SIGNAL] = {"a value, a list of points, or a sinusoid",
                           "a value, points or a sinusoid, as what uses it takes"},
        [SCHEMA_EXPECT] = {"a mapping of paths to limits", "a mapping of paths to limits"},
    };
    switch (row->type) {
    case SCHEMA_CHOICE:
    case SCHEMA_BACKENDS:
        text_append(text, row->type == SCHEMA_BACKENDS && !with_example ? "a list of " : "");
        schema_list_words(row, text);
        break;
    case SCHEMA_VECTOR:
    case SCHEMA_ANCHOR:
        describe_vector(row, with_example, text);
        break;
    case SCHEMA_TORQUE:
        describe_torque(row, with_example, text);
        break;
    case SCHEMA_PAIR:
        describe_quantity(row, with_example, text);
        text_append(text, with_example ? ", or [x, y]" : ", or two in [x, y]");
        break;
    case SCHEMA_CURVE:
        describe_curve(row, with_example, text);
        break;
    case SCHEMA_LOAD:
        text_append(text,
                    with_example
                        ? "%s such as %s, points [[0 deg, 0 %s], [90 deg, 1 %s]], or a file "
                          "such as load.csv"
                        : "%s, a list of points, a CSV file, or a sinusoid",
                    units_dimension_name(row->dimension), units_example(row->dimension),
                    units_si(row->dimension), units_si(row->dimension));
        break;
    case SCHEMA_SPAN:
        text_append(text, with_example ? "a time such as 60 ms, or 1 revolution" : "a time in ");
        if (!with_example) {
            units_list(row->dimension, text);
            text_append(text, ", or in revolutions");
        }
        break;
    case SCHEMA_INTEGER:
        text_append(text, "%s%s%s", row->zero_word != NULL ? row->zero_word : "",
                    row->zero_word != NULL ? ", or " : "", WORDS[row->type][with_example ? 1 : 0]);
        break;
    default:
        if (WORDS[row->type][0] != NULL) {
            text_append(text, "%s", WORDS[row->type][with_example]);
        } else {
            describe_quantity(row, with_example, text);
        }
    }
}

bool schema_are_rivals(const SchemaRow *row, const SchemaRow *other)
{
    if (row->rivalry == SCHEMA_NO_RIVAL || other->rivalry != row->rivalry ||
        other->family != row->family) {
        return false;
    }
    // those of the two bodies go together
    return row->rivalry == SCHEMA_PLACING
               ? (row->side == SCHEMA_PLACE_OF_BOTH) != (other->side == SCHEMA_PLACE_OF_BOTH)
               : other->side != row->side;
}

bool schema_is_of_kind(const SchemaRow *row, JointKind kind)
{
    return row->kinds == 0 || joint_is_among(kind, row->kinds);
}

bool schema_is_of_any(const SchemaRow *row, JointKinds kinds)
{
    return row->kinds == 0 || (row->kinds & kinds) != 0;
}

bool schema_knows(const char *path, SchemaForm form)
{
    for (size_t i = 0; i < SCHEMA_ROW_COUNT; i++) {
        const SchemaRow *row = &SCHEMA_ROWS[i];
        if (schema_is_of_form(row, form) &&
            (strcmp(row->path, path) == 0 || below(row->path, path) != NULL)) {
            return true;
        }
    }
    return false;
}

static size_t add_child(char names[SCHEMA_CHILD_MAX][LINKAGE_NAME_SIZE], size_t count,
                        const char *name, int length)
{
    char child[LINKAGE_NAME_SIZE];
    snprintf(child, sizeof child, "%.*s", length, name);
    for (size_t i = 0; i < count; i++) {
        if (strcmp(names[i], child) == 0) {
            return count;
        }
    }
    assert(count < SCHEMA_CHILD_MAX);
    text_copy(names[count], LINKAGE_NAME_SIZE, child);
    return count + 1;
}

size_t schema_children(const char *group, SchemaForm form,
                       char names[SCHEMA_CHILD_MAX][LINKAGE_NAME_SIZE])
{
    size_t count = 0;
    for (size_t i = 0; i < SCHEMA_ROW_COUNT; i++) {
        const char *rest = below(SCHEMA_ROWS[i].path, group);
        if (rest != NULL && rest[0] != '*' && schema_is_of_form(&SCHEMA_ROWS[i], form)) {
            count = add_child(names, count, rest, (int)strcspn(rest, "."));
        }
    }
    return count;
}

void schema_path(const SchemaRow *row, const char *name, char path[SCHEMA_PATH_SIZE])
{
    const char *star = strchr(row->path, '*');
    if (star == NULL) {
        text_copy(path, SCHEMA_PATH_SIZE, row->path);
        return;
    }
    snprintf(path, SCHEMA_PATH_SIZE, "%.*s%s%s", (int)(star - row->path), row->path, name,
             star + 1);
}

size_t schema_member_count(const Scenario *scenario, SchemaFamily family)
{
    const Linkage *linkage = &scenario->linkage;
    const size_t counts[SCHEMA_FAMILY_COUNT] = {1,
                                                linkage->body_count,
                                                linkage->joint_count,
                                                scenario->point_count,
                                                linkage->spring_count,
                                                linkage->torsion_count,
                                                linkage->bushing_count,
                                                linkage->load_count,
                                                linkage->further_count,
                                                0}; // signals are used up by what names them
    return counts[family];
}

const void *schema_member(const Scenario *scenario, SchemaFamily family, size_t index)
{
    static const Body NO_BODY;
    static const Joint NO_JOINT = {.space.axis = {0.0, 0.0, 1.0}}; // normal to the plane
    static const TracedPoint NO_POINT;
    static const Spring NO_SPRING;
    static const TorsionSpring NO_TORSION;
    static const Bushing NO_BUSHING;
    static const Load NO_LOAD;
    static const Driver NO_DRIVE;
    const Linkage *linkage = &scenario->linkage;
    const bool is_there = index < schema_member_count(scenario, family);
    switch (family) {
    case SCHEMA_BODY:
        return is_there ? &linkage->bodies[index] : &NO_BODY;
    case SCHEMA_JOINT:
        return is_there ? &linkage->joints[index] : &NO_JOINT;
    case SCHEMA_POINT:
        return is_there ? &scenario->points[index] : &NO_POINT;
    case SCHEMA_SPRING:
        return is_there ? &linkage->springs[index] : &NO_SPRING;
    case SCHEMA_TORSION_SPRING:
        return is_there ? &linkage->torsions[index] : &NO_TORSION;
    case SCHEMA_BUSHING:
        return is_there ? &linkage->bushings[index] : &NO_BUSHING;
    case SCHEMA_LOAD_FAMILY:
        return is_there ? &linkage->loads[index] : &NO_LOAD;
    case SCHEMA_DRIVE:
        return is_there ? &linkage->further[index] : &NO_DRIVE;
    default:
        return scenario;
    }
}

const void *schema_field_const(const SchemaRow *row, const Scenario *scenario, size_t index)
{
    return (const char *)schema_member(scenario, row->holder, row->member + index) + row->offset;
}

void *schema_field(const SchemaRow *row, Scenario *scenario, size_t index)
{
    assert(row->member + index < schema_member_count(scenario, row->holder));
    return (void *)schema_field_const(row, scenario, index);
}
