// Lists what there is: the keys of case files and the numbers of runs, from the program's own
// tables, and what the name of a number says of it.
#include "library/library.h"

#include "casefile/schema.h"
#include "model/numbers.h"

#include <math.h>
#include <string.h>

size_t jp_key_count(void)
{
    return SCHEMA_ROW_COUNT;
}

JpCaseStatus jp_key_at(size_t index, JpKey *key)
{
    if (index >= SCHEMA_ROW_COUNT || key == NULL) {
        return JP_CASE_ERROR_USAGE;
    }
    const SchemaRow *row = &SCHEMA_ROWS[index];
    const bool has_range = row->words == NULL && row->low < row->high;
    *key = (JpKey){
        .path = row->path,
        .unit = schema_unit(row),
        .doc = row->doc,
        .low = has_range ? row->low : NAN,
        .high = has_range ? row->high : NAN,
        .words = row->words,
    };
    return JP_CASE_OK;
}

// Units, by how names of numbers end in them: the longest of those that one may end in comes first.
static const struct {
    const char *end;
    const char *unit;
} ENDS[] = {
    {"_N_m_s_rad", "N m s/rad"},
    {"_N_m_rad", "N m/rad"},
    {"_rad_s2", "rad/s^2"},
    {"_m_s2", "m/s^2"},
    {"_N_s_m", "N s/m"},
    {"_Pa_m_s", "Pa m/s"},
    {"_N_m_s", "N m s"},
    {"_m_N_s", "m/(N s)"},
    {"_kg_m2", "kg m^2"},
    {"_rad_s", "rad/s"},
    {"_m_s", "m/s"},
    {"_N_m", "N m"},
    {"_N_s", "N s"},
    {"_deg", "deg"},
    {"_rad", "rad"},
    {"_kg", "kg"},
    {"_Pa", "Pa"},
    {"_Hz", "Hz"},
    {"_N", "N"},
    {"_m", "m"},
    {"_s", "s"},
    {"_J", "J"},
    {"_us", "us"},
};

// What the last key of a name has.
static const char *last_key(const char *name)
{
    // the lists of JSON number their members
    const char *key = name;
    for (const char *point = name; (point = strchr(point, '.')) != NULL; point++) {
        const char next = point[1];
        key = next >= '0' && next <= '9' ? key : point + 1;
    }
    return key;
}

const char *listing_unit(const char *name)
{
    const char *key = last_key(name);
    const size_t size = strcspn(key, ".");
    for (size_t i = 0; i < sizeof ENDS / sizeof *ENDS; i++) {
        const size_t length = strlen(ENDS[i].end);
        if (size > length && strncmp(key + size - length, ENDS[i].end, length) == 0) {
            const bool is_stiffness = strncmp(key, "stiffness", strlen("stiffness")) == 0;
            return is_stiffness && strcmp(ENDS[i].end, "_N_m") == 0 ? "N/m" : ENDS[i].unit;
        }
    }
    return "";
}

// Where in the JSON of a run the numbers of an owner stand: with a star for a name or a number, and
// nowhere with the last.
#define PLACE_BODY          "bodies.*."
#define PLACE_BODY_SPIKE    "bodies.*.alpha_spikes.*."
#define PLACE_JOINT         "joints.*."
#define PLACE_JOINT_SPIKE   "joints.*.force_spikes.*."
#define PLACE_JOINT_CONTACT "joints.*.spikes.*."
#define PLACE_JOINT_WEAR    "joints.*.wear."
#define PLACE_RUN           ""
#define PLACE_ENERGY        "energy."
#define PLACE_COST          ""
#define PLACE_SECTION       NOWHERE
#define PLACE_SETTLED       NOWHERE
#define PLACE_SETTLED_JOINT NOWHERE
#define PLACE_SETTLED_BODY  NOWHERE
#define PLACE_ERROR         "error."
#define PLACE_TRUTH         "error."
#define NOWHERE             "-"

// The paths of a number, and that of the crank's angle beside it.
typedef struct NumberPaths {
    const char *paths[NUMBER_TURN_COUNT];
    const char *crank;
} NumberPaths;

// clang-format off
#define PATH_UNITS(word, ...) PATH_UNITS_OF(word, __VA_ARGS__)
#define PATH_UNITS_OF(word, key, unit, turned_key, turned_unit, sped_key, ...) \
    {word key, word turned_key, word sped_key}
#define PATH_ROW(of, id, word, what, title, turned, shown_as, in, with, ...) \
    [NUMBER_##of##_##id] = { \
        PATH_UNITS(PLACE_##of word, NUMBER_UNITS_##what), \
        ((with) & NUMBER_INSTANT) != 0 ? PLACE_##of "crank_deg" : PLACE_##of word "_crank_deg", \
    },
// clang-format on
static const NumberPaths PATHS[NUMBER_COUNT] = {NUMBER_LIST(PATH_ROW)};

// Whether a name is one of a path.
static bool is_of_path(const char *name, const char *path)
{
    for (; *path != '\0'; path++) {
        if (*path == '*') {
            const size_t length = strcspn(name, ".");
            if (length == 0) {
                return false;
            }
            name += length;
        } else if (*name++ != *path) {
            return false;
        }
    }
    return *name == '\0';
}

static bool is_listed(NumberId id)
{
    return (NUMBERS[id].places & NUMBER_JSON) != 0 &&
           strncmp(PATHS[id].paths[0], NOWHERE, strlen(NOWHERE)) != 0;
}

static bool has_crank(NumberId id)
{
    return (NUMBERS[id].traits & (NUMBER_TIMED | NUMBER_INSTANT)) != 0;
}

bool listing_find(const char *name, ListingPlace *place)
{
    for (NumberId id = 0; id < NUMBER_COUNT; id++) {
        for (int turn = 0; is_listed(id) && turn < NUMBER_TURN_COUNT; turn++) {
            const char *path = PATHS[id].paths[turn];
            const char *star = strchr(path, '*');
            if (!is_of_path(name, path) || (star != NULL && strchr(star + 1, '*') != NULL)) {
                continue;
            }
            *place = (ListingPlace){.id = id, .turn = (NumberTurn)turn, .path = path};
            if (star != NULL) {
                const char *member = name + (star - path);
                const size_t length = strcspn(member, ".");
                if (length >= sizeof place->member) {
                    return false;
                }
                memcpy(place->member, member, length);
            }
            return true;
        }
    }
    return false;
}

const char *listing_doc(const char *name)
{
    for (NumberId id = 0; id < NUMBER_COUNT; id++) {
        for (int turn = 0; is_listed(id) && turn < NUMBER_TURN_COUNT; turn++) {
            if (is_of_path(name, PATHS[id].paths[turn])) {
                return NUMBERS[id].meaning;
            }
        }
        if (is_listed(id) && has_crank(id) && is_of_path(name, PATHS[id].crank)) {
            return "angle of the crank there";
        }
    }
    return "";
}

// Quantities.

// Whether a number has a path of its own for such a unit: those of joints for forces and torques,
// spikes of bodies as accelerations.
static bool has_turn(NumberId id, int turn)
{
    const Number *number = &NUMBERS[id];
    const bool is_of_joint = number_members(number) == NUMBER_OF_JOINTS;
    if (number->owner == NUMBER_OWNER_BODY_SPIKE) {
        return turn == NUMBER_SPED;
    }
    return turn == NUMBER_PUSHED || (turn == NUMBER_TURNED && is_of_joint &&
                                     strcmp(number->keys[turn], number->keys[NUMBER_PUSHED]) != 0);
}

// Finds the number and the unit of a place in the list; how many come before where there is none.
static bool find_quantity(size_t index, NumberId *found, int *found_turn, size_t *count)
{
    *count = 0;
    for (NumberId id = 0; id < NUMBER_COUNT; id++) {
        for (int turn = 0; is_listed(id) && turn < NUMBER_TURN_COUNT; turn++) {
            if (has_turn(id, turn) && (*count)++ == index) {
                *found = id;
                *found_turn = turn;
                return true;
            }
        }
    }
    return false;
}

size_t jp_quantity_count(void)
{
    NumberId id;
    int turn;
    size_t count;
    find_quantity((size_t)-1, &id, &turn, &count);
    return count;
}

JpCaseStatus jp_quantity_at(size_t index, JpQuantity *quantity)
{
    NumberId id;
    int turn;
    size_t count;
    if (quantity == NULL || !find_quantity(index, &id, &turn, &count)) {
        return JP_CASE_ERROR_USAGE;
    }
    *quantity = (JpQuantity){
        .path = PATHS[id].paths[turn],
        .name = NUMBERS[id].name,
        .unit = listing_unit(PATHS[id].paths[turn]),
        .doc = NUMBERS[id].meaning,
        .is_timed = (NUMBERS[id].traits & NUMBER_TIMED) != 0,
    };
    return JP_CASE_OK;
}
