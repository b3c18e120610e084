// Walks over the settings of a scenario, as a case file would name them.
#include "casefile/casefile.h"

#include "casefile/limits.h"
#include "casefile/loads.h"
#include "casefile/schema.h"
#include "casefile/slider.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

// How many settings a row makes: one for each member that the scenario has, and one, named by the
// star, that stands for any other.
static size_t member_count(const Scenario *scenario, const SchemaRow *row)
{
    const size_t members = schema_member_count(scenario, row->family);
    return !schema_is_setting(row) ? 0 : row->family == SCHEMA_SINGLE ? members : members + 1;
}

size_t casefile_setting_count(const Scenario *scenario)
{
    size_t count = 0;
    for (size_t i = 0; i < SCHEMA_ROW_COUNT; i++) {
        count += member_count(scenario, &SCHEMA_ROWS[i]);
    }
    return count;
}

static void set_number(CasefileSetting *setting, double number)
{
    setting->kind = CASEFILE_NUMBER;
    setting->number_count = 1;
    setting->numbers[0] = number;
}

// A number, or the word that stands for 0.
static void set_quantity(CasefileSetting *setting, const SchemaRow *row, double number)
{
    set_number(setting, number);
    if (row->zero_word != NULL && number == 0.0) {
        setting->kind = CASEFILE_WORD;
        text_copy(setting->text, sizeof setting->text, row->zero_word);
    }
}

static void set_tolerated(CasefileSetting *setting, const ToleratedLength *length)
{
    set_number(setting, length->nominal);
    setting->numbers[1] = length->lower;
    setting->numbers[2] = length->upper;
    if (length->lower < 0.0 || length->upper > 0.0) {
        setting->kind = CASEFILE_TOLERATED;
        setting->number_count = 3;
    }
}

static void set_stiffness(CasefileSetting *setting, const char *unit, double stiffness,
                          double exponent)
{
    set_number(setting, stiffness);
    if (exponent == 1.0) {
        text_copy(setting->unit, sizeof setting->unit, unit);
    } else {
        snprintf(setting->unit, sizeof setting->unit, "%s^%.6g", unit, exponent);
    }
}

// The unit of a number that is of an angle where the joint's limited coordinate is one.
static void set_turning(CasefileSetting *setting, const Joint *joint, Dimension dimension)
{
    if (linkage_is_torsional(joint)) {
        text_copy(setting->unit, sizeof setting->unit, units_si(dimension));
    }
}

// The depth that a stiffness was given for, and the force there.
static void set_stiffness_for(CasefileSetting *setting, const SchemaRow *row,
                              const Scenario *scenario, size_t index)
{
    const bool is_of_joint = row->family == SCHEMA_JOINT;
    const Joint *joint = is_of_joint ? schema_member(scenario, SCHEMA_JOINT, index) : NULL;
    const bool is_turning = is_of_joint && linkage_is_torsional(joint);
    const double depth = is_of_joint ? joint->contact.for_depth : scenario->contact.for_depth;
    const double stiffness = is_of_joint ? joint->contact.stiffness : scenario->contact.stiffness;
    const double exponent = is_of_joint ? joint->contact.exponent : scenario->contact.exponent;
    setting->kind = CASEFILE_TEXT;
    if (depth > 0.0) {
        const int used = snprintf(setting->text, sizeof setting->text, "%.10g %s at %.10g %s",
                                  depth, is_turning ? "rad" : "m", stiffness * pow(depth, exponent),
                                  is_turning ? "N m" : "N");
        if (exponent != 1.0) {
            snprintf(setting->text + used, sizeof setting->text - (size_t)used,
                     " with exponent %.6g", exponent);
        }
    }
}

// That of the contact, or a joint's own.
static void set_own_stiffness(CasefileSetting *setting, const SchemaRow *row,
                              const Scenario *scenario, size_t index)
{
    if (row->family == SCHEMA_JOINT) {
        const Joint *joint = schema_member(scenario, SCHEMA_JOINT, index);
        set_stiffness(
            setting,
            units_si(linkage_is_torsional(joint) ? DIMENSION_TORSION_SPRING : DIMENSION_SPRING),
            joint->contact.stiffness, joint->contact.exponent);
    } else {
        set_stiffness(setting, units_si(DIMENSION_SPRING), scenario->contact.stiffness,
                      scenario->contact.exponent);
    }
}

static void set_backends(CasefileSetting *setting, const RunOptions *run)
{
    setting->kind = CASEFILE_WORDS;
    for (size_t i = 0; i < run->backend_count; i++) {
        const size_t length = strlen(setting->text);
        snprintf(setting->text + length, sizeof setting->text - length, "%s%s", i > 0 ? ", " : "",
                 OPTIONS_BACKENDS[run->backends[i]]);
    }
}

// Where along its link a traced point stands: of a short form, from the link's first joint.
static double point_along(const Scenario *scenario, size_t index)
{
    const TracedPoint *point = schema_member(scenario, SCHEMA_POINT, index);
    if (scenario->has_slidercrank) {
        return point->local.x + slider_centre(&scenario->slidercrank, point->body);
    }
    const ToleratedLength *const lengths[] = {&scenario->fourbar.crank, &scenario->fourbar.coupler,
                                              &scenario->fourbar.follower};
    return point->local.x + (scenario->has_fourbar ? 0.5 * lengths[point->body]->nominal : 0.0);
}

static void set_vector(CasefileSetting *setting, Vec2 vector)
{
    set_number(setting, vector.x);
    setting->numbers[1] = vector.y;
    setting->number_count = 2;
}

static void set_direction(CasefileSetting *setting, Vec3 direction)
{
    set_number(setting, direction.x);
    setting->numbers[1] = direction.y;
    setting->numbers[2] = direction.z;
    setting->number_count = 3;
}

// One number where it is along -y or there is none, as most cases have it.
static void set_gravity(CasefileSetting *setting, const Scenario *scenario)
{
    const Vec3 gravity = scenario->gravity;
    if (gravity.x == 0.0 && gravity.z == 0.0) {
        set_number(setting, 0.0 - gravity.y); // never -0
    } else if (scenario->space == SCENARIO_SPATIAL) {
        set_direction(setting, gravity);
    } else {
        set_vector(setting, scenario_gravity(scenario));
    }
}

// Where a pin starts in its hole, or a block between its guides.
static void set_start(CasefileSetting *setting, const Joint *joint)
{
    const bool is_guide = joint_has_guides(joint->kind);
    if (joint->limits.kind != LIMIT_NONE) {
        set_number(setting, joint->limits.start);
        set_turning(setting, joint, DIMENSION_ANGLE);
        return;
    }
    set_vector(setting, is_guide ? joint->guide.start : joint->clearance.start);
    if (is_guide) {
        text_copy(setting->unit, sizeof setting->unit, "m, rad");
    }
}

// Where the x axis of a bushing points in the world at time zero.
static double bushing_heading(const Linkage *linkage, const Bushing *bushing)
{
    const bool is_held = bushing->body_a != LINKAGE_GROUND && linkage->body_count > 0;
    return bushing->direction + (is_held ? linkage->bodies[bushing->body_a].start.angle : 0.0);
}

// The direction of a joint's line in the world at time zero.
static double heading(const Linkage *linkage, const Joint *joint)
{
    const bool is_held = joint->body_a != LINKAGE_GROUND && linkage->body_count > 0;
    if (joint->stop.cam > 0) { // the normal is that of body b's flat
        const int body = joint->body_b;
        return joint->stop.facing +
               (body == LINKAGE_GROUND ? 0.0 : linkage->bodies[body].start.angle);
    }
    return joint->direction + (is_held ? linkage->bodies[joint->body_a].start.angle : 0.0);
}

// A point given in a body's frame, in the world at time zero.
static Vec2 start_point(const Linkage *linkage, int body, Vec2 local)
{
    return body == LINKAGE_GROUND ? local : linkage_point(&linkage->bodies[body].start, 0, local);
}

// Where a joint's hole, or an end of a stop or spring, stands at time zero.
static Vec2 anchor_place(const SchemaRow *row, const Scenario *scenario, size_t index)
{
    const bool is_first = row->side != 1;
    if (!(index < schema_member_count(scenario, row->family))) {
        return (Vec2){0.0, 0.0};
    }
    if (row->family == SCHEMA_SPRING) {
        const Spring *spring = &scenario->linkage.springs[index];
        return start_point(&scenario->linkage, is_first ? spring->body_a : spring->body_b,
                           is_first ? spring->anchor_a : spring->anchor_b);
    }
    if (row->family == SCHEMA_BUSHING) {
        const Bushing *bushing = &scenario->linkage.bushings[index];
        return start_point(&scenario->linkage, is_first ? bushing->body_a : bushing->body_b,
                           is_first ? bushing->anchor_a : bushing->anchor_b);
    }
    if (row->family == SCHEMA_LOAD_FAMILY) {
        const Load *load = &scenario->linkage.loads[index];
        return start_point(&scenario->linkage, load->body, load->anchor);
    }
    const Joint *joint = &scenario->linkage.joints[index];
    return start_point(&scenario->linkage, is_first ? joint->body_a : joint->body_b,
                       is_first ? joint->anchor_a : joint->anchor_b);
}

// Without bodies there is no first one, which a member that is not there would name.
static const char *body_name(const Linkage *linkage, int body)
{
    return body == LINKAGE_GROUND     ? "ground"
           : linkage->body_count == 0 ? ""
                                      : linkage->bodies[body].name;
}

static void set_words(CasefileSetting *setting, const char *first, const char *second)
{
    setting->kind = CASEFILE_TEXT;
    snprintf(setting->text, sizeof setting->text, second != NULL ? "%s, %s" : "%s", first, second);
}

static void set_between(CasefileSetting *setting, const SchemaRow *row, const Scenario *scenario,
                        size_t index)
{
    const Linkage *linkage = &scenario->linkage;
    const void *member = schema_member(scenario, row->family, index);
    const Spring *spring = row->family == SCHEMA_SPRING ? member : NULL;
    const Bushing *bushing = row->family == SCHEMA_BUSHING ? member : NULL;
    const Joint *joint = row->family == SCHEMA_JOINT ? member : NULL;
    const int body_a = spring != NULL    ? spring->body_a
                       : bushing != NULL ? bushing->body_a
                                         : joint->body_a;
    const int body_b = spring != NULL    ? spring->body_b
                       : bushing != NULL ? bushing->body_b
                                         : joint->body_b;
    set_words(setting, body_name(linkage, body_a), body_name(linkage, body_b));
}

// What is constant is one number; else it is pairs of what it is over and its value.
static void set_points(CasefileSetting *setting, size_t count, const double *at,
                       const double *values, const char *over_unit, const char *unit)
{
    if (count <= 1) {
        set_number(setting, values[0]);
        return;
    }
    setting->kind = CASEFILE_POINTS;
    setting->number_count = 2 * count;
    for (size_t i = 0; i < count; i++) {
        setting->numbers[2 * i] = at[i];
        setting->numbers[2 * i + 1] = values[i];
    }
    snprintf(setting->unit, sizeof setting->unit, "%s, %s", over_unit, unit);
}

// A sinusoid as a case would write it.
static void set_wave(CasefileSetting *setting, const SchemaRow *row, double mean, const Wave *wave)
{
    const char *unit = units_si(row->dimension);
    setting->kind = CASEFILE_WORD;
    snprintf(setting->text, sizeof setting->text,
             "{mean: %.17g %s, amplitude: %.17g %s, frequency: %.17g Hz, phase: %.17g rad}", mean,
             unit, wave->amplitude, unit, wave->rate / (2.0 * M_PI), wave->phase);
}

static void set_over_time(CasefileSetting *setting, const SchemaRow *row, const TimeTable *table)
{
    if (table->count > 0 && wave_exists(&table->wave)) {
        set_wave(setting, row, table->values[0], &table->wave);
        return;
    }
    set_points(setting, table->count, table->times, table->values, "s", units_si(row->dimension));
}

static void set_curve(CasefileSetting *setting, const SchemaRow *row, const ForceCurve *curve)
{
    const bool is_torque = row->dimension == DIMENSION_TORQUE;
    set_points(setting, curve->count, curve->at, curve->values, is_torque ? "rad" : "m",
               units_si(row->dimension));
}

// One number where both axes have it.
static void set_pair(CasefileSetting *setting, Vec2 pair)
{
    if (pair.x == pair.y) {
        set_number(setting, pair.x);
    } else {
        set_vector(setting, pair);
    }
}

static void set_load(CasefileSetting *setting, const SchemaRow *row, const Linkage *linkage,
                     const Load *load)
{
    const LoadTable *table = &load->table;
    if (wave_exists(&table->wave)) {
        set_wave(setting, row, table->values[0], &table->wave);
        return;
    }
    set_points(setting, table->count, table->at, table->values,
               units_si(loads_dimension(linkage, load)), units_si(row->dimension));
}

static void set_load_period(CasefileSetting *setting, const Linkage *linkage, const Load *load)
{
    set_number(setting, load->table.period);
    text_copy(setting->unit, sizeof setting->unit, units_si(loads_dimension(linkage, load)));
}

// With the point at the end of a period, which is the first of the next.
static void set_angles(CasefileSetting *setting, const SchemaRow *row, const Driver *driver)
{
    TimeTable table = driver->table;
    if (table.period_s > 0.0 && table.count > 0 && table.count < TIME_TABLE_MAX) {
        table.times[table.count] = table.times[0] + table.period_s;
        table.values[table.count++] = table.values[0] + driver->gain;
    }
    set_over_time(setting, row, &table);
}

static void set_speed(CasefileSetting *setting, const SchemaRow *row, const Driver *driver)
{
    if (driver->table.count > 0) {
        set_over_time(setting, row, &driver->table);
    } else {
        set_number(setting, driver->speed);
    }
}

static void set_pivots(CasefileSetting *setting, const Scenario *scenario, const Gear *gear)
{
    const Joint *first = schema_member(scenario, SCHEMA_JOINT, (size_t)gear->pivots[0]);
    const Joint *second = schema_member(scenario, SCHEMA_JOINT, (size_t)gear->pivots[1]);
    set_words(setting, first->name, second->name);
}

// What only joints have, and what names one.
static void set_of_joint(CasefileSetting *setting, const SchemaRow *row, const Scenario *scenario,
                         size_t index)
{
    const Linkage *linkage = &scenario->linkage;
    const void *field = schema_field_const(row, scenario, index);
    const Joint *joint = schema_member(scenario, SCHEMA_JOINT, index);
    int number;
    switch (row->type) {
    case SCHEMA_START:
        set_start(setting, joint);
        break;
    case SCHEMA_COORDINATE:
        set_number(setting, *(const double *)field);
        set_turning(setting, joint, DIMENSION_ANGLE);
        break;
    case SCHEMA_DAMPER:
        set_number(setting, *(const double *)field);
        set_turning(setting, joint, limits_turning_damper(row->dimension));
        break;
    case SCHEMA_PIVOTS:
        set_pivots(setting, scenario, &joint->gear);
        break;
    case SCHEMA_TEETH:
        set_vector(setting, (Vec2){joint->gear.teeth[0], joint->gear.teeth[1]});
        break;
    case SCHEMA_DISCS:
        set_vector(setting, (Vec2){2.0 * joint->stop.radius_a, 2.0 * joint->stop.radius_b});
        break;
    case SCHEMA_SLOT:
        set_vector(setting, (Vec2){joint->stop.slot, 2.0 * joint->stop.radius_a});
        break;
    case SCHEMA_HEADING:
        set_number(setting,
                   row->family == SCHEMA_BUSHING
                       ? bushing_heading(linkage, schema_member(scenario, SCHEMA_BUSHING, index))
                       : heading(linkage, joint));
        break;
    case SCHEMA_PROFILE:
        if (*(const size_t *)field > 0) {
            const Profile *profile = &linkage->profiles[*(const size_t *)field - 1];
            set_points(setting, profile->count, profile->angles, profile->radii, "rad", "m");
        }
        break;
    case SCHEMA_RADIAL_CLEARANCE:
        set_number(setting, linkage_radial_clearance(joint));
        break;
    case SCHEMA_JOINT_NAME:
        memcpy(&number, field, sizeof number);
        joint = schema_member(scenario, SCHEMA_JOINT, (size_t)number);
        set_words(setting, joint->name, NULL);
        break;
    default: // an expectation is no setting
        break;
    }
}

static void set_value(CasefileSetting *setting, const SchemaRow *row, const Scenario *scenario,
                      size_t index)
{
    const Linkage *linkage = &scenario->linkage;
    const void *field = schema_field_const(row, scenario, index);
    int number;
    switch (row->type) {
    case SCHEMA_QUANTITY:
        set_quantity(setting, row, *(const double *)field);
        break;
    case SCHEMA_DIAMETER:
        set_number(setting, 2.0 * *(const double *)field);
        break;
    case SCHEMA_TOLERATED:
        set_tolerated(setting, field);
        break;
    case SCHEMA_INTEGER:
        set_quantity(setting, row, (double)*(const size_t *)field);
        setting->kind = setting->kind == CASEFILE_NUMBER ? CASEFILE_INTEGER : setting->kind;
        break;
    case SCHEMA_CHOICE:
        memcpy(&number, field, sizeof number);
        setting->kind = CASEFILE_WORD;
        text_copy(setting->text, sizeof setting->text, row->words[number]);
        break;
    case SCHEMA_BACKENDS:
        set_backends(setting, &scenario->run);
        break;
    case SCHEMA_TEXT:
        set_words(setting, field, NULL);
        break;
    case SCHEMA_STIFFNESS:
        set_own_stiffness(setting, row, scenario, index);
        break;
    case SCHEMA_STIFFNESS_FOR:
        set_stiffness_for(setting, row, scenario, index);
        break;
    case SCHEMA_SPAN:
        set_number(setting, scenario_report_from(scenario));
        break;
    case SCHEMA_VECTOR:
        set_vector(setting, *(const Vec2 *)field);
        break;
    case SCHEMA_GRAVITY:
        set_gravity(setting, scenario);
        break;
    case SCHEMA_DIRECTION:
        set_direction(setting, *(const Vec3 *)field);
        break;
    case SCHEMA_ANCHOR:
        set_vector(setting, anchor_place(row, scenario, index));
        break;
    case SCHEMA_BETWEEN:
        set_between(setting, row, scenario, index);
        break;
    case SCHEMA_BODY_NAME:
        set_words(setting, body_name(linkage, *(const int *)field), NULL);
        break;
    case SCHEMA_PAIR:
        set_pair(setting, *(const Vec2 *)field);
        break;
    case SCHEMA_CURVE:
        set_curve(setting, row, field);
        break;
    case SCHEMA_TORQUE:
        set_over_time(setting, row, field);
        break;
    case SCHEMA_SPEED:
        set_speed(setting, row, field);
        break;
    case SCHEMA_ANGLES:
        set_angles(setting, row, field);
        break;
    case SCHEMA_LOAD:
        set_load(setting, row, linkage, schema_member(scenario, SCHEMA_LOAD_FAMILY, index));
        break;
    case SCHEMA_LOAD_PERIOD:
        set_load_period(setting, linkage, schema_member(scenario, SCHEMA_LOAD_FAMILY, index));
        break;
    case SCHEMA_ALONG:
        set_number(setting, point_along(scenario, index));
        break;
    default:
        set_of_joint(setting, row, scenario, index);
    }
}

const char *schema_member_name(const Scenario *scenario, SchemaFamily family, size_t member)
{
    const bool is_there = member < schema_member_count(scenario, family);
    const void *named = schema_member(scenario, family, member);
    switch (is_there ? family : SCHEMA_SINGLE) {
    case SCHEMA_BODY:
        return ((const Body *)named)->name;
    case SCHEMA_JOINT:
        return ((const Joint *)named)->name;
    case SCHEMA_POINT:
        return ((const TracedPoint *)named)->name;
    case SCHEMA_SPRING:
        return ((const Spring *)named)->name;
    case SCHEMA_TORSION_SPRING:
        return ((const TorsionSpring *)named)->name;
    case SCHEMA_BUSHING:
        return ((const Bushing *)named)->name;
    case SCHEMA_LOAD_FAMILY:
        return ((const Load *)named)->name;
    case SCHEMA_DRIVE:
        return scenario->linkage.joints[((const Driver *)named)->joint].name;
    default:
        return "*";
    }
}

// The tolerance of a number, which is written in a unit of its own.
static void set_tolerance(CasefileSetting *setting, const Scenario *scenario, size_t row,
                          size_t member)
{
    for (size_t i = 0; i < scenario->tolerance_count && setting->number_count == 1; i++) {
        const ScenarioTolerance *given = &scenario->tolerances[i];
        if (given->row == row && given->member == member && given->nominal != 0.0) {
            const double per_unit = setting->numbers[0] / given->nominal;
            setting->kind = CASEFILE_TOLERATED;
            setting->number_count = 3;
            setting->numbers[1] = given->lower * per_unit;
            setting->numbers[2] = given->upper * per_unit;
        }
    }
}

CasefileWalk casefile_walk(const Scenario *scenario)
{
    return (CasefileWalk){.scenario = scenario, .met = schema_met(scenario)};
}

// One member's setting of a row.
static void set_setting(CasefileSetting *setting, const CasefileWalk *walk, size_t member)
{
    const Scenario *scenario = walk->scenario;
    const SchemaRow *row = &SCHEMA_ROWS[walk->row];
    // of the numbers there are thousands of bytes, in most settings for one or none
    memset(setting, 0, offsetof(CasefileSetting, numbers) + 3 * sizeof *setting->numbers);
    schema_path(row, schema_member_name(scenario, row->family, member), setting->key);
    text_copy(setting->unit, sizeof setting->unit, schema_unit(row));
    set_value(setting, row, scenario, member);
    set_tolerance(setting, scenario, walk->row, member);
    setting->applies = schema_applies(row, scenario, member, walk->met);
}

bool casefile_next(CasefileWalk *walk, CasefileSetting *setting)
{
    const Scenario *scenario = walk->scenario;
    while (walk->row < SCHEMA_ROW_COUNT &&
           walk->member >= member_count(scenario, &SCHEMA_ROWS[walk->row])) {
        walk->row++;
        walk->member = 0;
    }
    if (walk->row == SCHEMA_ROW_COUNT) {
        return false;
    }
    set_setting(setting, walk, walk->member++);
    return true;
}

bool casefile_find(const Scenario *scenario, const char *key, CasefileSetting *setting)
{
    CasefileWalk walk = casefile_walk(scenario);
    const SchemaRow *row = schema_of_key(key);
    walk.row = row != NULL ? (size_t)(row - SCHEMA_ROWS) : 0;
    for (size_t i = 0; row != NULL && i < member_count(scenario, row); i++) {
        char path[SCHEMA_PATH_SIZE];
        schema_path(row, schema_member_name(scenario, row->family, i), path);
        if (strcmp(path, key) == 0) {
            set_setting(setting, &walk, i);
            return true;
        }
    }
    return false;
}

// Whether the command line gives one of the keys of these paths, which blanks separate: what the
// file says beside it is then kept for the file's own setting.
static bool is_decided(const Scenario *scenario, const char *paths)
{
    for (size_t i = 0; i < scenario->key_count; i++) {
        const char *path = SCHEMA_ROWS[scenario->keys[i].row].path;
        const size_t length = strlen(path);
        const char *found = scenario->keys[i].line == 0 ? strstr(paths, path) : NULL;
        if (found != NULL && (found[length] == ' ' || found[length] == '\0')) {
            return true;
        }
    }
    return false;
}

bool casefile_gives(const Scenario *scenario, const char *beginning)
{
    bool gives = false;
    for (size_t i = 0; i < scenario->key_count && !gives; i++) {
        const char *path = SCHEMA_ROWS[scenario->keys[i].row].path;
        gives = strncmp(path, beginning, strlen(beginning)) == 0;
    }
    return gives;
}

size_t casefile_unused(const Scenario *scenario, bool is_program, Text *lines)
{
    const unsigned met = schema_met(scenario);
    size_t count = 0;
    for (size_t i = 0; i < scenario->key_count; i++) {
        const ScenarioKey *key = &scenario->keys[i];
        const SchemaRow *row = &SCHEMA_ROWS[key->row];
        SchemaLack lack;
        if (!schema_lacks(row, scenario, key->member, met, &lack) ||
            (key->line > 0 && is_decided(scenario, lack.paths))) {
            continue;
        }
        char path[SCHEMA_PATH_SIZE];
        schema_path(row, schema_member_name(scenario, row->family, key->member), path);
        if (key->line > 0) {
            text_append(lines, "%s:%zu: ", scenario_path(scenario), key->line);
        }
        text_append(lines, "%s%s has no effect here; it would with %s\n", path,
                    key->line > 0 ? ""
                    : is_program  ? ", which was set,"
                                  : " of the command line",
                    lack.words);
        count++;
    }
    return count;
}
