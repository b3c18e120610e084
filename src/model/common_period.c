// Finds the period that all that acts on a linkage has in common.
//
// Periods T_1 and T_2, s, are commensurable where p T_1 = q T_2 with whole numbers p and q; what
// they have in common is the smallest such time. Over the angle of a crank that turns by g, rad, in
// a period T of its drive, a load of period P, rad, is the same after n T where n g is a multiple
// of P.
#include "model/common_period.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>

// Periods of what acts that the common one may hold: beyond that a run of one takes long, and some
// p / q is near any ratio
enum { PERIODS_MOST = 64 };

// 1: of a common period, what the digits of two that are written down may leave
static const double PERIOD_ROUNDING = 1e-9;

enum { NAME_SIZE = LINKAGE_NAME_SIZE + 32 };

// What has a period.
typedef struct Beat {
    char name[NAME_SIZE];
    double period_s;
} Beat;

// The search: what has been found so far.
typedef struct Search {
    CommonPeriod found;
    Beat first;    // whose period the common one is a multiple of
    Beat shortest; // of all
    bool is_over;  // there is none
} Search;

__attribute__((format(printf, 2, 3))) static void end_search(Search *search, const char *format,
                                                             ...)
{
    if (search->is_over) {
        return;
    }
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(search->found.why, sizeof search->found.why, format, arguments);
    va_end(arguments);
    search->found.period_s = 0.0;
    search->is_over = true;
}

// The least whole number of a that is a whole number of b, both above 0; 0: none is within
// PERIODS_MOST of either.
static double least_multiple(double a, double b)
{
    for (int count = 1; count <= PERIODS_MOST; count++) {
        const double others = count * a / b;
        const double whole = round(others);
        if (whole >= 1.0 && whole <= PERIODS_MOST &&
            fabs(others - whole) <= PERIOD_ROUNDING * whole) {
            return count;
        }
    }
    return 0.0;
}

static void refuse_pair(Search *search, const Beat *one, const Beat *other)
{
    end_search(search, "%s, of period %.9g ms, and %s, of %.9g ms, have no period in common",
               one->name, 1e3 * one->period_s, other->name, 1e3 * other->period_s);
    search->found.is_mismatch = true;
}

// Takes in what has a period of its own.
static void add_beat(Search *search, const Beat *beat)
{
    if (search->is_over) {
        return;
    }
    if (search->found.period_s == 0.0) {
        search->first = search->shortest = *beat;
        search->found.period_s = beat->period_s;
        return;
    }
    if (beat->period_s < search->shortest.period_s) {
        search->shortest = *beat;
    }
    const double multiple = least_multiple(search->found.period_s, beat->period_s);
    const double common_s = multiple * search->found.period_s;
    const double periods = common_s / search->shortest.period_s;
    if (multiple == 0.0 || periods > PERIODS_MOST + 0.5) {
        refuse_pair(search, &search->first, beat);
        return;
    }
    search->found.period_s = common_s;
}

// The angle by which a drive turns its body in its period, rad.
static double turned_in_period(const Driver *driver)
{
    return driver->table.count == 0 ? 2.0 * M_PI : fabs(drive_turned_in_period(driver));
}

// Of a drive that has one; 0: it stands, and INFINITY: it never repeats.
static double period_of(const Driver *driver)
{
    if (driver->table.count == 0) {
        return driver->speed != 0.0 ? 2.0 * M_PI / fabs(driver->speed) : 0.0;
    }
    return drive_is_held(driver)        ? 0.0
           : drive_period(driver) > 0.0 ? drive_period(driver)
                                        : INFINITY;
}

// Takes in a drive. The words say which it is.
static void add_drive(Search *search, const Driver *driver, const char *name)
{
    Beat beat = {.period_s = period_of(driver)};
    snprintf(beat.name, sizeof beat.name, "%s", name);
    if (!isfinite(beat.period_s) && wave_exists(&driver->table.wave)) {
        const Beat wave = {"the wave of its speed", wave_period(&driver->table.wave)};
        beat.period_s = 2.0 * M_PI / fabs(driver->table.values[0]);
        refuse_pair(search, &beat, &wave);
    } else if (!isfinite(beat.period_s)) {
        end_search(search, "the speed of its drive changes without a drive.period");
    } else if (beat.period_s > 0.0) {
        add_beat(search, &beat);
    }
}

// A soft drive follows angles through its stiffness, and speeds through its damping: to that alone
// a constant speed is nothing that repeats.
static void add_torque(Search *search, const Linkage *linkage)
{
    const Torque *torque = &linkage->torque;
    const Driver *followed = &torque->followed;
    if (followed->is_present && (torque->stiffness > 0.0 || followed->table.count > 0)) {
        add_drive(search, followed, "the drive");
    }
    if (!time_table_changes(&torque->table)) {
        return;
    }
    if (wave_exists(&torque->table.wave)) {
        const Beat beat = {"the drive", wave_period(&torque->table.wave)};
        add_beat(search, &beat);
    } else if (torque->table.period_s > 0.0) {
        const Beat beat = {"the drive", torque->table.period_s};
        add_beat(search, &beat);
    } else {
        end_search(search, "the torque or force of its drive changes without a drive.period");
    }
}

// The drive that turns the crank at times that are known, or NULL.
static const Driver *crank_drive(const Linkage *linkage)
{
    const Torque *torque = &linkage->torque;
    const bool is_led = torque->followed.is_present && torque->stiffness > 0.0;
    return linkage->driver.is_present ? &linkage->driver : is_led ? &torque->followed : NULL;
}

// A load over the angle of a crank that is turned at known times.
static void add_crank_load(Search *search, const Load *load, const Driver *driver)
{
    const double drive_s = period_of(driver);
    const double turned = turned_in_period(driver);
    if (drive_s == 0.0 || turned == 0.0 || !isfinite(drive_s)) {
        return; // the crank comes back by itself, or never: then the drive has said so
    }
    Beat beat = {.period_s = drive_s * load->table.period / turned};
    snprintf(beat.name, sizeof beat.name, "load '%s'", load->name);
    if (!(load->table.period > 0.0)) {
        end_search(search, "load '%s' over the crank's angle does not repeat", load->name);
    } else if (driver->table.count == 0) {
        add_beat(search, &beat);
    } else {
        // between the whole turns of its periods such a drive is elsewhere
        const double periods = least_multiple(turned, load->table.period);
        const Beat drive = {"the drive", drive_s};
        beat.period_s = periods * drive_s;
        if (periods == 0.0) {
            beat.period_s = drive_s * load->table.period / turned;
            refuse_pair(search, &drive, &beat);
        } else {
            add_beat(search, &beat);
        }
    }
}

static void add_load(Search *search, const Linkage *linkage, const Load *load)
{
    const Driver *driver = crank_drive(linkage);
    if (wave_exists(&load->table.wave)) {
        Beat wave = {.period_s = wave_period(&load->table.wave)};
        snprintf(wave.name, sizeof wave.name, "load '%s'", load->name);
        add_beat(search, &wave);
        return;
    }
    if (load->table.count < 2 || load->over == LOAD_OVER_POSITION) {
        return;
    }
    if (load->over == LOAD_OVER_CRANK) {
        if (driver != NULL) {
            add_crank_load(search, load, driver);
        }
        return;
    }
    if (!(load->table.period > 0.0)) {
        end_search(search, "load '%s' over time does not repeat", load->name);
        return;
    }
    Beat beat = {.period_s = load->table.period};
    snprintf(beat.name, sizeof beat.name, "load '%s'", load->name);
    add_beat(search, &beat);
}

// Why nothing has a period.
static const char *no_beat(const Linkage *linkage)
{
    return linkage->torque.followed.is_present && drive_is_held(&linkage->torque.followed)
               ? "its drive holds an angle, and no load repeats over time"
           : linkage->torque.followed.is_present
               ? "its drive is soft, and turns it at no given speed"
           : linkage->torque.table.count > 0
               ? "a torque or force drives it at no given speed, and nothing repeats over time"
               : "nothing drives it at a given speed, and no load repeats over time";
}

CommonPeriod common_period_find(const Linkage *linkage)
{
    Search search = {.is_over = false};
    const size_t count = linkage_drive_count(linkage);
    for (size_t i = 0; i < count; i++) {
        const Driver *driver = linkage_drive(linkage, i);
        char name[NAME_SIZE] = "the drive";
        if (count > 1) {
            snprintf(name, sizeof name, "the drive of '%s'", linkage->joints[driver->joint].name);
        }
        add_drive(&search, driver, name);
    }
    add_torque(&search, linkage);
    for (size_t i = 0; i < linkage->load_count; i++) {
        add_load(&search, linkage, &linkage->loads[i]);
    }
    if (search.found.period_s == 0.0) {
        end_search(&search, "%s", no_beat(linkage));
    }
    return search.found;
}
