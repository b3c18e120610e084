// The keys of a case file: one row a key. The rows drive parsing, checking, `help case`, the page
// in docs/ and the list of resolved settings.
#pragma once

#include "base/text.h"
#include "casefile/units.h"
#include "model/scenario.h"

#include <assert.h>

enum { SCHEMA_PATH_SIZE = 160, SCHEMA_CHILD_MAX = 64 };

// How a value is written, and what it becomes in the scenario.
typedef enum SchemaType {
    SCHEMA_QUANTITY,      // number with a unit (or plain) -> double
    SCHEMA_DIAMETER,      // length -> double, half of it
    SCHEMA_TOLERATED,     // length, bare or with a tolerance -> ToleratedLength
    SCHEMA_INTEGER,       // whole number -> size_t
    SCHEMA_CHOICE,        // one of the words -> enumeration
    SCHEMA_BACKENDS,      // list of words -> run.backends and run.backend_count
    SCHEMA_TEXT,          // text -> title
    SCHEMA_STIFFNESS,     // N/m^n -> stiffness and exponent of the contact or of a joint
    SCHEMA_STIFFNESS_FOR, // a depth at a force -> the same
    SCHEMA_SPAN,          // time or turns of the driver -> run.report_from
    SCHEMA_VECTOR,        // [x, y], or `centred` where the row has it as default -> Vec2
    SCHEMA_GRAVITY,       // acceleration along -y, [x, y], or in space [x, y, z] -> Vec3
    SCHEMA_DIRECTION,     // [x, y, z] without units, of any length -> Vec3 of length 1
    SCHEMA_START,         // [x, y] of a pin, [distance, tilt] of a block, of a backlash one number,
                          // or `centred`
    SCHEMA_COORDINATE,    // angle of a hinge, length of a slider or of gears -> double of a Limits
    SCHEMA_DAMPER,        // damping of a joint's contact -> double
    SCHEMA_PIVOTS,        // [joint, joint] -> the joints that guide teeth: pivots of a Gear
    SCHEMA_PROFILE,       // a list of [angle, length] -> size_t, which of the linkage's profiles
    SCHEMA_TEETH,         // [number, number] -> the teeth of a Gear
    SCHEMA_DISCS,         // [diameter, diameter] -> the radii of a Stop
    SCHEMA_SLOT,          // [length, width] -> the slot of a Stop
    SCHEMA_HEADING, // angle of the world -> direction of a joint or bushing, of body a once it is
                    // placed
    SCHEMA_RADIAL_CLEARANCE, // length -> Clearance: both radii
    SCHEMA_ALONG,            // length from a link's first joint -> double from its centre of mass
    SCHEMA_ANCHOR,           // [x, y] of the world -> an anchor, of a body once it is placed
    SCHEMA_BETWEEN,          // [body, body] -> body_a and body_b of a joint, spring or bushing
    SCHEMA_PAIR,             // one number for both axes, or [x, y] -> Vec2
    SCHEMA_CURVE,            // list of [length, force] or [angle, torque] -> ForceCurve
    SCHEMA_BODY_NAME,        // name of a body -> int
    SCHEMA_JOINT_NAME,       // name of a joint -> int
    SCHEMA_TORQUE,           // torque, or list of [time, torque] -> TimeTable
    SCHEMA_SPEED,            // speed, or list of [time, speed] -> Driver
    SCHEMA_ANGLES,           // list of [time, angle] -> Driver
    SCHEMA_LOAD,             // force or torque, a list of points, or a CSV file -> Load
    SCHEMA_LOAD_PERIOD,      // time, angle or length -> the period of a Load
    SCHEMA_SIGNAL,           // what any of the four before may have -> nothing: used by its name
    SCHEMA_EXPECT,           // mapping of paths to limits -> expectations; no setting of a run
} SchemaType;

// Keys that come once, or once a body, joint, traced point, spring, bushing, load or drive. A `*`
// in the path stands for the name of that. A signal is a value, not a group of keys.
typedef enum SchemaFamily {
    SCHEMA_SINGLE,
    SCHEMA_BODY,
    SCHEMA_JOINT,
    SCHEMA_POINT,
    SCHEMA_SPRING,
    SCHEMA_TORSION_SPRING,
    SCHEMA_BUSHING,
    SCHEMA_LOAD_FAMILY,
    SCHEMA_DRIVE,
    SCHEMA_SIGNAL_FAMILY,
    SCHEMA_FAMILY_COUNT,
} SchemaFamily;

// A case has one form: a short one, `four-bar` or `slider-crank`, or the long one, `bodies`. A key
// stands in some of them, whose bits are added, or in all.
typedef enum SchemaForm {
    SCHEMA_ALL = 0,
    SCHEMA_FOUR_BAR = 1 << 0,
    SCHEMA_SLIDER_CRANK = 1 << 1,
    SCHEMA_LONG = 1 << 2,
    SCHEMA_SHORT = SCHEMA_FOUR_BAR | SCHEMA_SLIDER_CRANK,
} SchemaForm;

// The side of a place that is both bodies', against those of one, 0 and 1.
enum { SCHEMA_PLACE_OF_BOTH = -1 };

enum { SCHEMA_FORM_COUNT = 3 };
static_assert((int)SCHEMA_LONG == 1 << (SCHEMA_FORM_COUNT - 1), "the long form is the last");

// What a form is called and gives.
typedef struct SchemaFormRow {
    SchemaForm form;
    const char *key;           // that makes a case one of that form
    const char *const *links;  // bodies of a short form, ending in NULL
    const char *const *pivots; // its joints, likewise; the first is the driven one
    const char *loose;         // those that can have play, for messages
} SchemaFormRow;

// Keys of which only one side may be given.
typedef enum SchemaRivalry {
    SCHEMA_NO_RIVAL,
    SCHEMA_SIZES,      // hole against radial-clearance
    SCHEMA_ELASTICITY, // law against stiffness
    SCHEMA_DRIVING,    // speed against angle, torque and others
    SCHEMA_STOPPING,   // the normal of a line, and a radius, against two discs
    SCHEMA_LIMITING,   // backlash against low and high
    SCHEMA_PLACING,    // one place of a joint against one for each of its bodies
    SCHEMA_PULLING,    // stiffness of a bushing against points of its forces
    SCHEMA_TWISTING,   // torsional-stiffness against points of its torque
} SchemaRivalry;

// The bit of a backend, and those of all that take steps of run.step.
#define SCHEMA_WITH(backend)        (1U << (backend))
#define SCHEMA_WITH_ENGINE(id, ...) | SCHEMA_WITH(id)
#define SCHEMA_STEPPED              (SCHEMA_WITH(BACKEND_ODE) OPTIONS_ENGINE_LIST(SCHEMA_WITH_ENGINE))

typedef struct SchemaRow {
    const char *path;
    SchemaType type;
    SchemaFamily family;
    SchemaForm form;
    Dimension dimension;
    const char *plain_unit; // SI unit of a number that is written plain; NULL where it has none
    SchemaFamily holder;    // whose field it is; SCHEMA_SINGLE: the Scenario's own
    size_t member;          // the number of the holder, to which that of the family is added
    size_t offset;          // in the holder
    size_t flag;            // where the holder notes, as a bool, that the key is given; 0: nowhere
    double low;             // SI; smallest value allowed, or the bound itself where low_is_open
    double high;            // SI; largest value allowed
    bool low_is_open;
    bool is_required;
    SchemaRivalry rivalry;
    int side;                  // of the rivalry; of an anchor, the end that it is of
    const char *const *words;  // of a choice, ends in NULL
    const char *zero_word;     // what may be written for the number 0; NULL: nothing
    const char *excused_by;    // the path beside which a required key may miss; NULL: none
    const char *default_words; // in place of the default's number; NULL: the number says it
    JointKinds kinds;          // of joints, that have the key; 0: all
    unsigned needs;            // what a scenario must have for the key to be among its settings
    unsigned backends;         // of which one must run, SCHEMA_WITH each; 0: any
    unsigned wants;            // and, besides, for its value to change anything
    const char *doc;
} SchemaRow;

// A group of keys, for the pages.
typedef struct SchemaGroup {
    const char *path;  // empty for the keys that stand in no group
    const char *title; // what it has, in a few words
    const char *doc;
} SchemaGroup;

// What a case can have several of, by name.
typedef struct SchemaFamilyRow {
    const char *group; // the key above the names
    const char *what;  // one of them
    size_t most;
} SchemaFamilyRow;

extern const SchemaRow SCHEMA_ROWS[];
extern const size_t SCHEMA_ROW_COUNT;
extern const SchemaGroup SCHEMA_GROUPS[];
extern const size_t SCHEMA_GROUP_COUNT;
extern const SchemaFamilyRow SCHEMA_FAMILIES[SCHEMA_FAMILY_COUNT];

extern const SchemaFormRow SCHEMA_FORMS[SCHEMA_FORM_COUNT];

// The row of a form, which is one alone.
const SchemaFormRow *schema_form(SchemaForm form);

// Whether a row is one of that form.
bool schema_is_of_form(const SchemaRow *row, SchemaForm form);

// The SI unit of a row's number, such as "m"; empty where it has none.
const char *schema_unit(const SchemaRow *row);

// Adds the words that a row allows, with commas between them; the row must have some.
void schema_list_words(const SchemaRow *row, Text *text);

// Appends how a row's value is written: for a page with all its units, for a message with an
// example of one.
void schema_describe(const SchemaRow *row, bool with_example, Text *text);

// Whether two rows are the two ways to say one thing, so that a member may have only one of them.
bool schema_are_rivals(const SchemaRow *row, const SchemaRow *other);

// Whether a row is of joints of that kind; of all other rows that is true as well.
bool schema_is_of_kind(const SchemaRow *row, JointKind kind);

// The same of any of several kinds.
bool schema_is_of_any(const SchemaRow *row, JointKinds kinds);

// What rows may ask of a scenario as a whole that it has: bits of schema_needs.h.
unsigned schema_met(const Scenario *scenario);

// Whether a scenario, which has met those bits, makes use of a row, of that member of its family.
bool schema_applies(const SchemaRow *row, const Scenario *scenario, size_t index, unsigned met);

// What a row lacks that a scenario makes no use of.
typedef struct SchemaLack {
    const char *words; // what would make use of it
    const char *paths; // the keys that decide about that, separated by blanks; empty: none alone
    bool is_mistake;   // nothing but a key that was forgotten explains it
} SchemaLack;

// Whether a scenario, which has met those bits, makes no use of a row of that member and something
// else would; what it lacks.
bool schema_lacks(const SchemaRow *row, const Scenario *scenario, size_t index, unsigned met,
                  SchemaLack *lack);

// Appends what a row asks of a case before it matters, all of it; nothing where it always does.
void schema_list_needs(const SchemaRow *row, Text *text);

// Whether a row's value is one that a run depends on or is named by: all but expectations.
bool schema_is_setting(const SchemaRow *row);

// The row of a path with `*` for names; NULL where it is none.
const SchemaRow *schema_find(const char *path);

// The row of a key, with any name in place of the star; NULL where it is of none.
const SchemaRow *schema_of_key(const char *key);

// Whether the path (with `*` for names) is a key of that form, or a group of such keys.
bool schema_knows(const char *path, SchemaForm form);

// The words that may stand below a group in that form, without repetition and without names that
// a case gives. Returns how many.
size_t schema_children(const char *group, SchemaForm form,
                       char names[SCHEMA_CHILD_MAX][LINKAGE_NAME_SIZE]);

// The path of a row for people: `*` replaced by the name (as it is for SCHEMA_SINGLE).
void schema_path(const SchemaRow *row, const char *name, char path[SCHEMA_PATH_SIZE]);

// How many members of a family a scenario has; of SCHEMA_SINGLE 1.
size_t schema_member_count(const Scenario *scenario, SchemaFamily family);

// One of them. A member that the scenario does not have is one with nothing but zeros.
const void *schema_member(const Scenario *scenario, SchemaFamily family, size_t index);

// Its name; of one that the scenario does not have, and of SCHEMA_SINGLE, a star.
const char *schema_member_name(const Scenario *scenario, SchemaFamily family, size_t index);

// The rows' fields in a scenario; `index` numbers the member of a family, which the scenario must
// have for schema_field.
void *schema_field(const SchemaRow *row, Scenario *scenario, size_t index);
const void *schema_field_const(const SchemaRow *row, const Scenario *scenario, size_t index);
