// The keys of a case file: one row a key. The rows drive parsing, checking, `help case`, the page
// in docs/ and the list of resolved settings.
#pragma once

#include "casefile/units.h"
#include "model/scenario.h"

enum { SCHEMA_PATH_SIZE = 160, SCHEMA_JOINT_COUNT = 3, SCHEMA_CHILD_MAX = 16 };

// How a value is written, and what it becomes in the scenario.
typedef enum SchemaType {
    SCHEMA_QUANTITY,         // number with a unit (or plain) -> double
    SCHEMA_DIAMETER,         // length -> double, half of it
    SCHEMA_TOLERATED,        // length, bare or with a tolerance -> ToleratedLength
    SCHEMA_INTEGER,          // whole number -> size_t
    SCHEMA_CHOICE,           // one of the words -> enumeration
    SCHEMA_BACKENDS,         // list of words -> run.backends and run.backend_count
    SCHEMA_TEXT,             // text -> title
    SCHEMA_STIFFNESS,        // N/m^n -> contact.stiffness and contact.exponent
    SCHEMA_ECCENTRICITY,     // `centred` or [x, y] -> Vec2
    SCHEMA_RADIAL_CLEARANCE, // length -> Clearance: both radii
    SCHEMA_ALONG,            // length from a body's first joint -> double from its centre of mass
} SchemaType;

// Keys that come once, once a joint that may have play, or once a traced point. A `*` in the path
// stands for the name of the joint or point.
typedef enum SchemaFamily { SCHEMA_SINGLE, SCHEMA_JOINT, SCHEMA_POINT } SchemaFamily;

// Keys of which only one side may be given.
typedef enum SchemaRivalry {
    SCHEMA_NO_RIVAL,
    SCHEMA_SIZES,      // hole and pin against radial-clearance
    SCHEMA_ELASTICITY, // law against stiffness
} SchemaRivalry;

typedef struct SchemaRow {
    const char *path;
    SchemaType type;
    SchemaFamily family;
    Dimension dimension;
    size_t offset; // in a Scenario, of the first of its family
    double low;    // SI; smallest value allowed, or the bound itself where low_is_open
    double high;   // SI; largest value allowed
    bool low_is_open;
    bool is_required;
    SchemaRivalry rivalry;
    int side;                  // of the rivalry
    const char *const *words;  // of a choice, ends in NULL
    const char *default_words; // in place of the default's number; NULL: the number says it
    bool (*applies)(const Scenario *scenario, size_t index); // NULL: always
    const char *doc;
} SchemaRow;

// A group of keys, for the pages.
typedef struct SchemaGroup {
    const char *path; // empty for the keys that stand in no group
    const char *doc;
} SchemaGroup;

extern const SchemaRow SCHEMA_ROWS[];
extern const size_t SCHEMA_ROW_COUNT;
extern const SchemaGroup SCHEMA_GROUPS[];
extern const size_t SCHEMA_GROUP_COUNT;

// The moving links, which are the bodies in this order; ends in NULL.
extern const char *const SCHEMA_BODY_NAMES[];

// The joints that may have play, in the order of a four-bar's joints behind the driven one.
extern const char *const SCHEMA_JOINT_NAMES[SCHEMA_JOINT_COUNT];

// The row of a path with `*` for names; NULL where it is none.
const SchemaRow *schema_find(const char *path);

// Whether keys stand below the path (with `*` for names).
bool schema_is_group(const char *path);

// The words that may stand below a group, without repetition; for `joints` the names of the
// joints, for `points` none, as any name may. Returns how many.
size_t schema_children(const char *group, char names[SCHEMA_CHILD_MAX][LINKAGE_NAME_SIZE]);

// The path of a row for people: `*` replaced by the name (as it is for SCHEMA_SINGLE).
void schema_path(const SchemaRow *row, const char *name, char path[SCHEMA_PATH_SIZE]);

// The rows' fields in a scenario; `index` numbers the joint or point of a family.
void *schema_field(const SchemaRow *row, Scenario *scenario, size_t index);
const void *schema_field_const(const SchemaRow *row, const Scenario *scenario, size_t index);

// How many of the row's family a case can have.
size_t schema_family_size(const SchemaRow *row);
