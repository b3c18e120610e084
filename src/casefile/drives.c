// Reads and checks what prescribes the motion of bodies.
#include "casefile/drives.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#define SOFT "drive.stiffness drive.damping"

// 1: of a period or of a turn, what rounding may leave
static const double PERIOD_ROUNDING = 1e-12;
static const double TURN_ROUNDING = 1e-9;

void drives_prepare(const Entries *entries, Linkage *linkage)
{
    const EntryNames *names = &entries->names[SCHEMA_DRIVE];
    linkage->further_count = names->count;
    linkage->driver.is_one_of_several = names->count > 0;
    for (size_t i = 0; i < names->count; i++) {
        linkage->further[i] = (Driver){
            .is_present = true,
            .is_one_of_several = true,
            .joint = entries_number(entries, SCHEMA_JOINT, names->names[i]),
        };
    }
}

bool drives_apply(const SchemaRow *row, const Driver *driver)
{
    switch (row->type) {
    case SCHEMA_SPEED:
        return !driver->has_angles;
    case SCHEMA_ANGLES:
    case SCHEMA_CHOICE:
        return driver->has_angles;
    default:
        return true;
    }
}

// The keys of a drive: the crank's, or one of the others'.
typedef struct DriveKeys {
    const char *moved; // what says how it moves
    const char *period;
    const char *joint; // NULL: its name says it
    const char *group;
} DriveKeys;

static const DriveKeys CRANK_KEYS = {"drive.speed drive.angle", "drive.period", "drive.joint",
                                     "drive"};
static const DriveKeys FURTHER_KEYS = {"drives.*.speed drives.*.angle", "drives.*.period", NULL,
                                       "drives.*"};

// Refuses a drive where a key of it stands, or else its group.
__attribute__((format(printf, 6, 7))) static bool refuse(const Entries *entries,
                                                         const DriveKeys *keys, size_t index,
                                                         Err *err, const char *allowed,
                                                         const char *format, ...)
{
    char text[ERR_TEXT_SIZE];
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(text, sizeof text, format, arguments);
    va_end(arguments);
    const Entry *entry = keys->joint != NULL ? entries_find(entries, keys->joint, index) : NULL;
    return entry != NULL ? entries_refuse(entry, err, "%s\nallowed: %s", text, allowed)
                         : entries_refuse_group(entries_group(entries, keys->group, index), err,
                                                "%s\nallowed: %s", text, allowed);
}

static bool check_turns(const Entry *entry, const Driver *driver, Err *err)
{
    const double turns = drive_turned_in_period(driver) / (2.0 * M_PI);
    const double whole = round(turns);
    if (fabs(turns - whole) <= TURN_ROUNDING) {
        return true;
    }
    if (whole == 0.0) {
        return entries_refuse(
            entry, err,
            "the drive turns by %.9g of a revolution in a period, and would start "
            "the next elsewhere\nallowed: whole turns in a period, or none",
            turns);
    }
    return entries_refuse(entry, err,
                          "the drive turns by %.9g revolutions in a period, and would start the "
                          "next elsewhere\nallowed: whole turns in a period, as with all %s "
                          "times %.9g",
                          turns, driver->has_angles ? "angles" : "speeds", whole / turns);
}

// Angles that repeat go from one end of the period to the other.
static bool repeat_angles(const Entry *entry, Driver *driver, Err *err)
{
    TimeTable *table = &driver->table;
    const size_t last = table->count - 1;
    const double off_s = fabs(table->times[last] - table->period_s);
    if (table->times[0] != 0.0 || off_s > PERIOD_ROUNDING * table->period_s) {
        return entries_refuse(entry, err,
                              "the points of an angle that repeats go from 0 s to the end of the "
                              "period\nallowed: a period of %.6g s, and a first point at 0 s",
                              table->times[last]);
    }
    driver->gain = table->values[last] - table->values[0];
    table->count--;
    return check_turns(entry, driver, err);
}

// Values that repeat have one at the end of a period and at its start, which is left out at the
// end.
static bool fold_end(const Entry *entry, const char *what, TimeTable *table, Err *err)
{
    const size_t last = table->count - 1;
    const double end_s = table->times[last];
    const bool is_at_end = fabs(end_s - table->period_s) <= PERIOD_ROUNDING * table->period_s;
    if (is_at_end && table->times[0] == 0.0 && table->values[last] != table->values[0]) {
        return entries_refuse(entry, err,
                              "the %s at the end of a period is not that at its start\nallowed: "
                              "the same at both, or a period longer than %.6g s",
                              what, end_s);
    }
    if (!is_at_end && end_s > table->period_s) {
        return entries_refuse(entry, err,
                              "the points of the %s do not fit into a period\nallowed: a "
                              "period of at least %.6g s, the time of the last point",
                              what, end_s);
    }
    table->count -= is_at_end && table->times[0] == 0.0 ? 1 : 0;
    return true;
}

static bool repeat_speeds(const Entry *entry, Driver *driver, Err *err)
{
    return fold_end(entry, "speed", &driver->table, err) && check_turns(entry, driver, err);
}

// A torque or a force over time has the period that stands beside it.
static bool repeat_torque(const Entries *entries, const Entry *entry, Linkage *linkage, Err *err)
{
    TimeTable *table = &linkage->torque.table;
    if (wave_exists(&table->wave)) {
        return entries_refuse(entry, err,
                              "a sinusoid repeats by its frequency\nallowed: no period, or points");
    }
    if (table->count < 2) {
        return entries_refuse(entry, err,
                              "only what changes over time repeats\nallowed: drive.period beside "
                              "drive.speed, drive.angle, drive.torque or drive.force over time");
    }
    table->period_s = linkage->driver.table.period_s;
    const bool is_force = entries_find(entries, "drive.force", 0) != NULL;
    return fold_end(entry, is_force ? "force" : "torque", table, err);
}

static bool complete(const Entries *entries, const DriveKeys *keys, size_t index, Driver *driver,
                     Err *err)
{
    const Entry *entry = entries_find(entries, keys->period, index);
    if (entry != NULL && driver->table.count > 0 && wave_exists(&driver->table.wave)) {
        return entries_refuse(entry, err,
                              "a sinusoid repeats by its frequency\nallowed: no period, or points");
    }
    if (entry != NULL && drive_is_held(driver)) {
        return entries_refuse(
            entry, err, "one angle that is held has no period\nallowed: no period, or points");
    }
    // a constant speed has no use for a period, which is said elsewhere
    const bool is_good = entry == NULL || driver->table.count == 0 ||
                         (driver->has_angles ? repeat_angles : repeat_speeds)(entry, driver, err);
    if (is_good) {
        drive_complete(driver);
    }
    return is_good;
}

bool drives_complete(const Entries *entries, Linkage *linkage, Err *err)
{
    const Entry *entry = entries_find(entries, "drive.period", 0);
    if (entry != NULL && !linkage->driver.is_present) {
        return repeat_torque(entries, entry, linkage, err);
    }
    Driver *driver = &linkage->driver;
    if (entries_blame(entries, SOFT, 0) != NULL && driver->table.count == 0 &&
        driver->speed == 0.0) {
        // a soft drive without a speed holds the angle of the start
        driver->has_angles = true;
        driver->table.count = 1;
        driver->table.times[0] = driver->table.values[0] = 0.0;
    }
    bool is_good = complete(entries, &CRANK_KEYS, 0, driver, err);
    for (size_t i = 0; is_good && i < linkage->further_count; i++) {
        is_good = complete(entries, &FURTHER_KEYS, i, &linkage->further[i], err);
    }
    return is_good;
}

// The joint of one drive.
static bool check_driven_joint(const Entries *entries, const DriveKeys *keys, size_t index,
                               const Joint *driven, Err *err)
{
    const bool has_play = linkage_has_play(driven);
    const bool turns = joint_has_angle(driven->kind);
    if (turns && has_play) {
        return refuse(entries, keys, index, err, "a torque, or another joint",
                      "the drive prescribes the motion of joint '%s', so nothing can "
                      "press at its limits",
                      driven->name);
    }
    if (turns && (driven->body_a == LINKAGE_GROUND || driven->body_b == LINKAGE_GROUND)) {
        return true;
    }
    return refuse(entries, keys, index, err, "an ideal joint with the ground",
                  "the drive cannot turn a body about joint '%s', which %s", driven->name,
                  has_play ? "has play"
                  : turns  ? "is not with the ground"
                           : "does not turn");
}

static int turned_body(const Linkage *linkage, int joint)
{
    int turned;
    int against;
    linkage_turning(linkage, joint, &turned, &against);
    return turned;
}

// A drive is named by its joint.
static bool refuse_name(const Entries *entries, size_t index, Err *err)
{
    const EntryNames *joints = &entries->names[SCHEMA_JOINT];
    Text list;
    text_init(&list);
    for (size_t i = 0; i < joints->count; i++) {
        text_append(&list, "%s%s", i > 0 ? ", " : "", joints->names[i]);
    }
    refuse(entries, &FURTHER_KEYS, index, err, list.data,
           "a drive is named by its joint, and '%s' is none",
           entries->names[SCHEMA_DRIVE].names[index]);
    text_finish(&list);
    return false;
}

static bool check_further(const Entries *entries, const Linkage *linkage, size_t index, Err *err)
{
    const int joint = linkage->further[index].joint;
    if (joint < 0) {
        return refuse_name(entries, index, err);
    }
    if (!check_driven_joint(entries, &FURTHER_KEYS, index, &linkage->joints[joint], err)) {
        return false;
    }
    const int body = turned_body(linkage, joint);
    bool is_taken = turned_body(linkage, linkage->driver.joint) == body;
    for (size_t i = 0; i < index; i++) {
        is_taken = is_taken || turned_body(linkage, linkage->further[i].joint) == body;
    }
    return !is_taken || refuse(entries, &FURTHER_KEYS, index, err, "a joint of another body",
                               "a drive turns the body '%s' already", linkage->bodies[body].name);
}

// A drive at a given speed or angle stands before all further ones.
static bool check_first(const Entries *entries, const Linkage *linkage, Err *err)
{
    const EntryGroup *drives = entries_group(entries, "drives", 0);
    if (linkage->further_count == 0) {
        return true;
    }
    if (linkage->further_count + 1 > LINKAGE_DRIVE_MAX) {
        return entries_refuse_group(drives, err, "%zu drives are too many\nallowed: at most %d",
                                    linkage->further_count + 1, LINKAGE_DRIVE_MAX);
    }
    if (linkage->driver.is_present && entries_blame(entries, SOFT, 0) == NULL) {
        return true;
    }
    return entries_refuse_group(
        drives, err,
        "further drives stand beside a drive that is not one of a given speed or "
        "angle\nallowed: drive: {joint: ..., speed: 60 rpm}, which counts the crank's angle; "
        "torques and motors beside it as loads and springs");
}

// The joint that the first drive names.
static bool check_named(const Entries *entries, const Entry *entry, const Linkage *linkage,
                        Err *err)
{
    const Joint *driven = &linkage->joints[linkage->driver.joint];
    if (entries_find(entries, "drive.force", 0) != NULL) {
        return joint_has_position(driven->kind) ||
               entries_refuse(entry, err,
                              "a force cannot push along joint '%s', which %s\nallowed: an ideal "
                              "prismatic joint",
                              driven->name, linkage_has_play(driven) ? "has play" : "has no line");
    }
    const bool is_torque = joint_has_angle(driven->kind) && linkage->torque.table.count > 0;
    return is_torque || check_driven_joint(entries, &CRANK_KEYS, 0, driven, err);
}

bool drives_check(const Entries *entries, const Linkage *linkage, Err *err)
{
    // a case without a drive may have no joint at all
    const Entry *entry = entries_find(entries, "drive.joint", 0);
    bool is_good = check_first(entries, linkage, err) &&
                   (entry == NULL || check_named(entries, entry, linkage, err));
    for (size_t i = 0; is_good && i < linkage->further_count; i++) {
        is_good = check_further(entries, linkage, i, err);
    }
    return is_good;
}

bool drives_refuse_redundant(const Entries *entries, const Linkage *linkage, size_t drive, Err *err)
{
    const DriveKeys *keys = drive == 0 ? &CRANK_KEYS : &FURTHER_KEYS;
    return refuse(entries, keys, drive == 0 ? 0 : drive - 1, err,
                  "a drive less, or play in a joint",
                  "the drive of joint '%s' is one too many: the joints and the drives before it "
                  "determine already how its body moves",
                  linkage->joints[linkage_drive(linkage, drive)->joint].name);
}
