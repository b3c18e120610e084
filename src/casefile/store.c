// Stores the values of a case, each if it is in its range.
#include "casefile/store.h"

#include "casefile/bushings.h"
#include "casefile/expect.h"
#include "casefile/fit.h"
#include "casefile/limits.h"
#include "casefile/loads.h"
#include "casefile/over_time.h"
#include "casefile/profiles.h"
#include "casefile/slot.h"
#include "casefile/stiffness_for.h"
#include "casefile/target.h"
#include "casefile/teeth.h"
#include "casefile/tolerance.h"
#include "casefile/waves.h"

#include <ctype.h>
#include <float.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

static const double PIN_RADIUS = 5e-3; // m, where nothing needs the size of the pin: the paper's

static const double ROUNDING = 1e-9; // of a radial clearance, and far below a nanometre

// Makes the hole of a pin; the row of the pin stands before.
static void store_radial_clearance(double radial, Clearance *clearance)
{
    clearance->is_pin_assumed = !(clearance->pin_radius > 0.0);
    clearance->pin_radius = clearance->is_pin_assumed ? PIN_RADIUS : clearance->pin_radius;
    clearance->hole_radius = clearance->pin_radius + radial;
}

// A number of any kind, or the word that stands for 0.
static bool store_number(const Target *target, Scenario *scenario)
{
    const Node *node = target->entry->node;
    const SchemaRow *row = target->entry->row;
    const char *word = row->zero_word;
    TargetNumber number = {.value = 0.0};
    const bool is_word = word != NULL && node->kind == NODE_SCALAR && strcmp(node->text, word) == 0;
    if (word != NULL && !is_word && node->kind == NODE_SCALAR &&
        strcspn(node->text, "0123456789") > 1) {
        return target_refuse(target, node->span, "'%.40s' is no choice for %s", node->text,
                             target->path);
    }
    if (!is_word && !target_number(target, node, &number)) {
        return false;
    }
    switch (row->type) {
    case SCHEMA_INTEGER:
        *(size_t *)target->field = (size_t)number.value;
        break;
    case SCHEMA_TOLERATED:
        *(ToleratedLength *)target->field = (ToleratedLength){.nominal = number.value};
        break;
    case SCHEMA_STIFFNESS:
        scenario->contact.stiffness = number.value;
        scenario->contact.exponent = number.exponent;
        break;
    case SCHEMA_SPAN:
        scenario->run.report_from = number.value;
        scenario->run.is_report_from_in_turns = number.is_in_turns;
        break;
    case SCHEMA_RADIAL_CLEARANCE:
        store_radial_clearance(number.value, target->field);
        break;
    default: // SCHEMA_ALONG is moved once the links are known
        *(double *)target->field = row->type == SCHEMA_DIAMETER ? 0.5 * number.value : number.value;
    }
    return true;
}

// Finds the number of a word in the row's list.
static bool find_word(const Target *target, const Node *node, int *number)
{
    if (!target_check_scalar(target, node)) {
        return false;
    }
    const char *const *words = target->entry->row->words;
    size_t count = 0;
    for (; words[count] != NULL; count++) {
        if (strcmp(words[count], node->text) == 0) {
            *number = (int)count;
            return true;
        }
    }
    const char *nearest = text_nearest(node->text, words, count);
    return target_refuse(target, node->span, "'%.40s' is no choice for %s%s%s%s", node->text,
                         target->path, nearest != NULL ? "; did you mean '" : "",
                         nearest != NULL ? nearest : "", nearest != NULL ? "'?" : "");
}

static bool store_backends(const Target *target, RunOptions *run)
{
    const Node *node = target->entry->node;
    const bool is_list = node->kind == NODE_LIST;
    RunOptions read = {0};
    for (const Node *item = is_list ? node->first : node; item != NULL;
         item = is_list ? item->next : NULL) {
        int number = 0;
        if (!find_word(target, item, &number)) {
            return false;
        }
        for (size_t i = 0; i < read.backend_count; i++) {
            if (read.backends[i] == (BackendKind)number) {
                return source_error(target->entry->source, item->span, "each backend once",
                                    target->err, "'%s' is listed twice", item->text);
            }
        }
        read.backends[read.backend_count++] = (BackendKind)number;
    }
    if (read.backend_count == 0) {
        return source_error(target->entry->source, node->span, "at least one backend", target->err,
                            "the list %s is empty", target->path);
    }
    memcpy(run->backends, read.backends, sizeof read.backends);
    run->backend_count = read.backend_count;
    return true;
}

static bool store_text(const Target *target, char *field, size_t size)
{
    const Node *node = target->entry->node;
    if (!target_check_scalar(target, node)) {
        return false;
    }
    if (strlen(node->text) >= size) {
        char allowed[QUANTITY_TEXT_SIZE];
        snprintf(allowed, sizeof allowed, "at most %zu bytes", size - 1);
        return source_error(target->entry->source, node->span, allowed, target->err,
                            "%s is too long: %zu bytes", target->path, strlen(node->text));
    }
    text_copy(field, size, node->text);
    return true;
}

static bool store_vector(const Target *target)
{
    const Node *node = target->entry->node;
    const SchemaRow *row = target->entry->row;
    TargetNumber x = {.value = 0.0};
    TargetNumber y = x;
    const bool is_word = row->default_words != NULL && node->kind == NODE_SCALAR &&
                         strcmp(node->text, row->default_words) == 0;
    const Node *pair[2];
    if (!is_word && row->default_words != NULL && node->kind == NODE_SCALAR &&
        text_nearest(node->text, &row->default_words, 1) != NULL) {
        return target_refuse(target, node->span, "'%.40s' is not a position; did you mean '%s'?",
                             node->text, row->default_words);
    }
    if (!is_word && !target_pair(node, pair)) {
        return target_refuse(target, node->span, "%s takes %s", target->path,
                             row->dimension == DIMENSION_SPEED ? "two speeds" : "a position");
    }
    if (!is_word && (!target_number(target, pair[0], &x) || !target_number(target, pair[1], &y))) {
        return false;
    }
    *(Vec2 *)target->field = (Vec2){x.value, y.value};
    return true;
}

// A pin at the wall is at the wall, though the difference of two radii is rounded.
static void seat_pin(Clearance *clearance)
{
    const double radial = clearance->hole_radius - clearance->pin_radius;
    const double start = vec2_length(clearance->start);
    if (start > radial && start <= radial * (1.0 + ROUNDING)) {
        clearance->start = vec2_scale(radial / start * (1.0 - DBL_EPSILON), clearance->start);
    }
}

// A place of a joint. Where those of hole and pin are apart they say where the pin starts in it;
// the second is stored last, and after the radii.
static bool store_anchor(const Target *target, Scenario *scenario)
{
    const SchemaRow *row = target->entry->row;
    if (!store_vector(target)) {
        return false;
    }
    if (row->family == SCHEMA_JOINT && row->side == 1) {
        Joint *joint = &scenario->linkage.joints[target->entry->index];
        if (joint_has_hole(joint->kind)) {
            joint->clearance.start = vec2_sub(joint->anchor_b, joint->anchor_a);
            seat_pin(&joint->clearance);
        }
    }
    return true;
}

// Where a pin starts in its hole, or a block between its guides: there the second number is an
// angle.
static bool store_start(const Target *target, Joint *joint)
{
    static const SchemaRow TILT = {.path = "joints.*.start",
                                   .type = SCHEMA_START,
                                   .dimension = DIMENSION_ANGLE,
                                   .low = -0.5 * M_PI,
                                   .high = 0.5 * M_PI};
    const Node *node = target->entry->node;
    const Node *pair[2];
    if (joint->limits.kind != LIMIT_NONE) {
        return limits_store(target, joint);
    }
    if (!joint_has_guides(joint->kind)) {
        const bool is_stored = store_vector(target);
        seat_pin(&joint->clearance);
        return is_stored;
    }
    if (node->kind == NODE_SCALAR && strcmp(node->text, target->entry->row->default_words) == 0) {
        return true;
    }
    if (!target_pair(node, pair)) {
        return source_error(target->entry->source, node->span,
                            "centred, or [distance, tilt] such as [0.1 mm, 0.05 deg]", target->err,
                            "%s takes a distance and an angle", target->path);
    }
    const Entry tilt = {&TILT, target->entry->index, pair[1], target->entry->source, NULL};
    Target of_tilt = *target;
    of_tilt.entry = &tilt;
    TargetNumber distance = {.value = 0.0};
    TargetNumber angle = distance;
    if (!target_number(target, pair[0], &distance) || !target_number(&of_tilt, pair[1], &angle)) {
        return false;
    }
    joint->guide.start = (Vec2){distance.value, angle.value};
    return true;
}

// Two diameters, kept as radii.
static bool store_discs(const Target *target, Stop *stop)
{
    const Node *node = target->entry->node;
    const Node *pair[2];
    TargetNumber first = {.value = 0.0};
    TargetNumber second = first;
    if (!target_pair(node, pair)) {
        return target_refuse(target, node->span, "%s takes the two diameters", target->path);
    }
    if (!target_number(target, pair[0], &first) || !target_number(target, pair[1], &second)) {
        return false;
    }
    if (first.value + second.value == 0.0) {
        return target_refuse(target, node->span, "of two discs one must have a size");
    }
    stop->radius_a = 0.5 * first.value;
    stop->radius_b = 0.5 * second.value;
    return true;
}

// The numbers of a list, at most three; false where it has more, or one of them is wrong. How many
// there are is counted up to four.
static bool read_numbers(const Target *target, double numbers[3], int *count)
{
    const Node *node = target->entry->node;
    const Node *item = node->kind == NODE_LIST ? node->first : NULL;
    for (*count = 0; item != NULL && *count < 3; item = item->next) {
        TargetNumber number;
        if (!target_number(target, item, &number)) {
            return false;
        }
        numbers[(*count)++] = number.value;
    }
    *count += item != NULL ? 1 : 0;
    return true;
}

// One number along -y, or a vector; `space` comes before it in the schema.
static bool store_gravity(const Target *target, Scenario *scenario)
{
    const Node *node = target->entry->node;
    TargetNumber downward;
    if (node->kind == NODE_SCALAR) {
        if (!target_number(target, node, &downward)) {
            return false;
        }
        scenario->gravity = scenario_downward(downward.value);
        return true;
    }
    double parts[3] = {0.0, 0.0, 0.0};
    int count;
    if (!read_numbers(target, parts, &count)) {
        return false;
    }
    if (count == 3 && scenario->space != SCENARIO_SPATIAL) {
        return source_error(target->entry->source, node->first->next->next->span,
                            "[x, y] such as [1 m/s^2, -9.8 m/s^2], or space: spatial", target->err,
                            "%s in the plane has no third number", target->path);
    }
    if (count != 2 && count != 3) {
        return target_refuse(target, node->span, "%s takes one number, or a list of two or three",
                             target->path);
    }
    scenario->gravity = (Vec3){parts[0], parts[1], parts[2]};
    return true;
}

// A direction of any length, kept as one of length 1.
static bool store_direction(const Target *target)
{
    const Node *node = target->entry->node;
    double parts[3] = {0.0, 0.0, 0.0};
    int count;
    if (!read_numbers(target, parts, &count)) {
        return false;
    }
    const Vec3 along = {parts[0], parts[1], parts[2]};
    if (count != 3 || !(vec3_length(along) > 0.0)) {
        return target_refuse(target, node->span, "%s takes a direction of three numbers, not all 0",
                             target->path);
    }
    *(Vec3 *)target->field = vec3_scale(1.0 / vec3_length(along), along);
    return true;
}

// Finds the number of a body or joint that the case names; the ground where it may stand.
static bool find_name(const Target *target, const Node *node, SchemaFamily family,
                      bool may_be_ground, int *number)
{
    if (!target_check_scalar(target, node)) {
        return false;
    }
    *number = entries_number(target->entries, family, node->text);
    if (*number < 0 && !(may_be_ground && strcmp(node->text, "ground") == 0)) {
        return entries_refuse_name(target->entries, target->entry->source, family, may_be_ground,
                                   node->text, node->span, target->err);
    }
    return true; // the ground is LINKAGE_GROUND, which is what an unknown name has
}

// The two joints that guide teeth.
static bool store_pivots(const Target *target, Gear *gear)
{
    const Node *pair[2];
    return target_pair(target->entry->node, pair)
               ? find_name(target, pair[0], SCHEMA_JOINT, false, &gear->pivots[0]) &&
                     find_name(target, pair[1], SCHEMA_JOINT, false, &gear->pivots[1])
               : target_refuse(target, target->entry->node->span, "%s takes two joints",
                               target->path);
}

static bool store_between(const Target *target, int *body_a, int *body_b)
{
    const Node *node = target->entry->node;
    const Node *pair[2];
    if (!target_pair(node, pair)) {
        return target_refuse(target, node->span, "%s takes the two bodies of the %s", target->path,
                             SCHEMA_FAMILIES[target->entry->row->family].what);
    }
    if (!find_name(target, pair[0], SCHEMA_BODY, true, body_a) ||
        !find_name(target, pair[1], SCHEMA_BODY, true, body_b)) {
        return false;
    }
    return *body_a != *body_b ||
           source_error(target->entry->source, pair[1]->span, "two different bodies", target->err,
                        "%s names %s twice", target->path, pair[1]->text);
}

// One number, with the messages of one, or points.
static bool store_speed(const Target *target)
{
    Driver *driver = target->field;
    TargetNumber number;
    if (target->entry->node->kind == NODE_LIST || waves_is_one(target->entry)) {
        return over_time_store_speed(target->entries, target->entry, driver, target->err);
    }
    if (!target_number(target, target->entry->node, &number)) {
        return false;
    }
    driver->speed = number.value;
    driver->table.count = 0;
    driver->table.wave = (Wave){.rate = 0.0};
    driver->has_angles = false;
    return true;
}

// Stores a value that has no tolerance, or no longer has one.
static bool store_plain(const Entries *entries, const Entry *entry, Scenario *scenario, Err *err)
{
    if (entry->row->type == SCHEMA_SIGNAL) {
        return true; // it is understood where its name stands
    }
    Target target = {.entries = entries, .entry = entry, .err = err};
    schema_path(entry->row, entries_name(entries, entry->row, entry->index), target.path);
    target.field = schema_field(entry->row, scenario, entry->index);
    Joint *joint;
    Spring *spring;
    Bushing *bushing;
    switch (entry->row->type) {
    case SCHEMA_CHOICE:
        return find_word(&target, entry->node, target.field); // an enumeration is an int
    case SCHEMA_BACKENDS:
        return store_backends(&target, &scenario->run);
    case SCHEMA_TEXT:
        return store_text(&target, target.field, SCENARIO_TITLE_SIZE);
    case SCHEMA_VECTOR:
        return store_vector(&target);
    case SCHEMA_ANCHOR: // moved to its body's frame once the bodies are placed
        return store_anchor(&target, scenario);
    case SCHEMA_START:
        return store_start(&target, &scenario->linkage.joints[entry->index]);
    case SCHEMA_STIFFNESS:
        if (entry->row->family != SCHEMA_JOINT) {
            return store_number(&target, scenario);
        }
        return limits_store(&target, &scenario->linkage.joints[entry->index]);
    case SCHEMA_STIFFNESS_FOR:
        return stiffness_for_store(&target, scenario);
    case SCHEMA_COORDINATE:
    case SCHEMA_DAMPER:
        return limits_store(&target, &scenario->linkage.joints[entry->index]);
    case SCHEMA_PIVOTS:
        return store_pivots(&target, target.field);
    case SCHEMA_TEETH:
        return teeth_store(&target, &scenario->linkage.joints[entry->index].gear);
    case SCHEMA_PROFILE:
        return profiles_store(&target, &scenario->linkage);
    case SCHEMA_DISCS:
        return store_discs(&target, target.field);
    case SCHEMA_SLOT:
        return slot_store(&target, target.field);
    case SCHEMA_GRAVITY:
        return store_gravity(&target, scenario);
    case SCHEMA_DIRECTION:
        return store_direction(&target);
    case SCHEMA_BETWEEN:
        if (entry->row->family == SCHEMA_SPRING) {
            spring = &scenario->linkage.springs[entry->index];
            return store_between(&target, &spring->body_a, &spring->body_b);
        }
        if (entry->row->family == SCHEMA_BUSHING) {
            bushing = &scenario->linkage.bushings[entry->index];
            return store_between(&target, &bushing->body_a, &bushing->body_b);
        }
        joint = &scenario->linkage.joints[entry->index];
        return store_between(&target, &joint->body_a, &joint->body_b);
    case SCHEMA_BODY_NAME:
        return find_name(&target, entry->node, SCHEMA_BODY, false, target.field);
    case SCHEMA_JOINT_NAME:
        return find_name(&target, entry->node, SCHEMA_JOINT, false, target.field);
    case SCHEMA_PAIR:
        return bushings_store_pair(&target, target.field);
    case SCHEMA_CURVE:
        return bushings_store_curve(&target, target.field);
    case SCHEMA_TORQUE:
        return over_time_store(entries, entry, target.field, err);
    case SCHEMA_SPEED:
        return store_speed(&target);
    case SCHEMA_ANGLES:
        return over_time_store_angles(entries, entry, target.field, err);
    case SCHEMA_LOAD:
        return loads_store_value(&target, &scenario->linkage,
                                 &scenario->linkage.loads[entry->index]);
    case SCHEMA_LOAD_PERIOD:
        return loads_store_period(&target, &scenario->linkage,
                                  &scenario->linkage.loads[entry->index]);
    case SCHEMA_SIGNAL:
        return true; // as above
    case SCHEMA_EXPECT:
        return expect_store(entries, entry, scenario, err);
    default:
        return store_number(&target, scenario);
    }
}

// The kind of the joint whose key a row is, as far as values depend on it.
static SchemaRow own_row(const Entry *entry, const Scenario *scenario)
{
    return entry->row->family == SCHEMA_JOINT && entry->index < scenario->linkage.joint_count
               ? limits_row(entry->row, scenario->linkage.joints[entry->index].kind, entry->node)
               : *entry->row;
}

// The limits of a length of a four-bar, in SI, for its closed form.
static void store_limits(const Scenario *scenario, ToleratedLength *length)
{
    const ScenarioTolerance *last = &scenario->tolerances[scenario->tolerance_count - 1];
    length->lower = last->lower * (length->nominal / last->nominal);
    length->upper = last->upper * (length->nominal / last->nominal);
}

// A fit of both is that of the pin, too.
static bool store_fit(const Entries *entries, const Entry *hole, Scenario *scenario, Err *err)
{
    const Entry pin = {schema_find("joints.*.pin"), hole->index, hole->node, hole->source, NULL};
    if (strcmp(hole->row->path, "joints.*.hole") != 0 || hole->node->kind != NODE_SCALAR ||
        !fit_is_of_both(hole->node->text)) {
        return true;
    }
    const Entry *given = entries_find(entries, "joints.*.pin", hole->index);
    return given == NULL ? store_value(entries, &pin, scenario, err)
                         : entries_refuse(given, err,
                                          "the fit of the hole says the size of the pin\nallowed: "
                                          "no pin, or a hole with one class such as 30 H7");
}

// A word where a case has signals is the name of none of them; a load may have that of a file.
static bool is_unknown_signal(const Entries *entries, const Entry *entry)
{
    return entries_is_signal(entry->row) && entry->row->type != SCHEMA_SIGNAL &&
           entries->names[SCHEMA_SIGNAL_FAMILY].count > 0 && entry->node->kind == NODE_SCALAR &&
           isalpha((unsigned char)entry->node->text[0]) && strchr(entry->node->text, '.') == NULL;
}

bool store_value(const Entries *entries, const Entry *entry, Scenario *scenario, Err *err)
{
    const SchemaRow row = own_row(entry, scenario);
    const Entry resolved = entries_resolve(entries, entry);
    if (resolved.signal == NULL && is_unknown_signal(entries, entry)) {
        return entries_refuse_name(entries, entry->source, SCHEMA_SIGNAL_FAMILY, false,
                                   entry->node->text, entry->node->span, err);
    }
    const size_t before = scenario->tolerance_count;
    PlainNode plain;
    if (!tolerance_take(&resolved, &row, scenario, &plain, err)) {
        return false;
    }
    Entry stored = resolved;
    stored.node = plain.node;
    if (!store_plain(entries, &stored, scenario, err)) {
        return false;
    }
    if (row.type == SCHEMA_TOLERATED && scenario->tolerance_count > before) {
        store_limits(scenario, schema_field(entry->row, scenario, entry->index));
    }
    return store_fit(entries, entry, scenario, err);
}
