// Which settings does a scenario hold, as a case file would name them?
#include "casefile/casefile.h"

#include "casefile/schema.h"

#include <assert.h>
#include <stdio.h>
#include <string.h>

// Rows of one family that follow each other; a family's settings go joint by joint.
static size_t block_size(size_t first)
{
    size_t size = 1;
    const SchemaFamily family = SCHEMA_ROWS[first].family;
    while (family != SCHEMA_SINGLE && first + size < SCHEMA_ROW_COUNT &&
           SCHEMA_ROWS[first + size].family == family) {
        size++;
    }
    return size;
}

// The row of a setting and the number of its joint or point; NULL beyond the last.
static const SchemaRow *find_row(size_t setting, size_t *index)
{
    for (size_t first = 0; first < SCHEMA_ROW_COUNT;) {
        const size_t rows = block_size(first);
        const size_t settings = rows * schema_family_size(&SCHEMA_ROWS[first]);
        if (setting < settings) {
            *index = setting / rows;
            return &SCHEMA_ROWS[first + setting % rows];
        }
        setting -= settings;
        first += rows;
    }
    return NULL;
}

size_t casefile_setting_count(void)
{
    size_t count = 0;
    for (size_t i = 0; i < SCHEMA_ROW_COUNT; i++) {
        count += schema_family_size(&SCHEMA_ROWS[i]);
    }
    return count;
}

static void set_number(CasefileSetting *setting, double number)
{
    setting->kind = CASEFILE_NUMBER;
    setting->number_count = 1;
    setting->numbers[0] = number;
}

static void set_tolerated(CasefileSetting *setting, const ToleratedLength *length)
{
    set_number(setting, length->nominal);
    setting->numbers[1] = length->lower;
    setting->numbers[2] = length->upper;
    setting->number_count = length->lower < 0.0 || length->upper > 0.0 ? 3 : 1;
}

static void set_stiffness(CasefileSetting *setting, const ContactOptions *contact)
{
    set_number(setting, contact->stiffness);
    if (contact->exponent == 1.0) {
        text_copy(setting->unit, sizeof setting->unit, "N/m");
    } else {
        snprintf(setting->unit, sizeof setting->unit, "N/m^%.6g", contact->exponent);
    }
}

static void set_backends(CasefileSetting *setting, const RunOptions *run)
{
    setting->kind = CASEFILE_TEXT;
    size_t length = 0;
    for (size_t i = 0; i < run->backend_count; i++) {
        const int written = snprintf(setting->text + length, sizeof setting->text - length, "%s%s",
                                     i > 0 ? ", " : "", OPTIONS_BACKENDS[run->backends[i]]);
        assert(written >= 0 && length + (size_t)written < sizeof setting->text);
        length += (size_t)written;
    }
}

// Where along its link a traced point stands, from the link's first joint.
static double point_along(const Scenario *scenario, size_t index)
{
    const TracedPoint *point = &scenario->points[index];
    const ToleratedLength *const lengths[] = {&scenario->fourbar.crank, &scenario->fourbar.coupler,
                                              &scenario->fourbar.follower};
    return point->local.x + 0.5 * lengths[point->body]->nominal;
}

static void set_value(CasefileSetting *setting, const SchemaRow *row, const Scenario *scenario,
                      size_t index)
{
    const void *field = schema_field_const(row, scenario, index);
    int number;
    switch (row->type) {
    case SCHEMA_QUANTITY:
        set_number(setting, *(const double *)field);
        break;
    case SCHEMA_DIAMETER:
        set_number(setting, 2.0 * *(const double *)field);
        break;
    case SCHEMA_TOLERATED:
        set_tolerated(setting, field);
        break;
    case SCHEMA_INTEGER:
        set_number(setting, (double)*(const size_t *)field);
        setting->kind = CASEFILE_INTEGER;
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
        setting->kind = CASEFILE_TEXT;
        text_copy(setting->text, sizeof setting->text, field);
        break;
    case SCHEMA_STIFFNESS:
        set_stiffness(setting, field);
        break;
    case SCHEMA_ECCENTRICITY:
        set_number(setting, ((const Vec2 *)field)->x);
        setting->numbers[1] = ((const Vec2 *)field)->y;
        setting->number_count = 2;
        break;
    case SCHEMA_RADIAL_CLEARANCE:
        set_number(setting, linkage_radial_clearance(&scenario->linkage.joints[index + 1]));
        break;
    case SCHEMA_ALONG:
        set_number(setting, point_along(scenario, index));
        break;
    }
}

bool casefile_setting(const Scenario *scenario, size_t index, CasefileSetting *setting)
{
    size_t member = 0;
    const SchemaRow *row = find_row(index, &member);
    if (row == NULL) {
        return false;
    }
    *setting = (CasefileSetting){0};
    // a point that the scenario does not have keeps the star for its name
    const char *name = row->family == SCHEMA_JOINT ? SCHEMA_JOINT_NAMES[member]
                       : row->family == SCHEMA_POINT && member < scenario->point_count
                           ? scenario->points[member].name
                           : "*";
    schema_path(row, name, setting->key);
    text_copy(setting->unit, sizeof setting->unit, units_si(row->dimension));
    set_value(setting, row, scenario, member);
    setting->applies = row->applies == NULL || row->applies(scenario, member);
    return true;
}
