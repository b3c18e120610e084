// Checks that a mechanism closes where it starts, and that its crank can turn through the run.
//
// In a four-bar with a crank, b coupler, c follower, g ground, coupler and follower meet at the
// crank angle theta when the diagonal d(theta) from crank pin to follower pivot satisfies
//     |b - c| <= d <= b + c,    d^2 = a^2 + g^2 - 2 a g cos(theta),
// so that cos(theta) must lie between the values for d = b + c and for d = |b - c|. Where one of
// these is a cosine, its angle is a dead centre. Play in the joints widens both ends of the range.
#include "casefile/closure.h"

#include "base/grouped.h"
#include "base/zeroed.h"
#include "model/joint_rows.h"
#include "model/kinematics.h"
#include "model/lock.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

enum { STARTS_SIZE = 192, POSES_LEAST = 100, POSES_MOST = 20000 };

// Relative: as close as this to a dead centre, the accelerations are those of rounding errors.
static const double MARGIN = 1e-9;

static const double DEGREE = M_PI / 180.0;

// Where a message points: at the first of these that overrides the case, else at the first given.
// The start is not to blame for a turn, nor the revolutions for the start.
#define BLAMED                                                                                     \
    "four-bar.crank.length four-bar.ground.length four-bar.coupler.length "                        \
    "four-bar.follower.length"

// The cosines of the crank angles at which the loop just closes.
typedef struct Reach {
    double shortest; // m, |b - c|
    double longest;  // m, b + c
    double cos_low;  // at the longest diagonal
    double cos_high; // at the shortest
} Reach;

// The reach of coupler and follower whose joints give way by some play, m.
static Reach find_reach(const FourBar *fourbar, double play)
{
    Reach reach;
    fourbar_diagonal_range(fourbar, &reach.shortest, &reach.longest);
    reach.shortest = fmax(0.0, reach.shortest - play);
    reach.longest += play;
    const double a = fourbar->crank.nominal;
    const double g = fourbar->ground.nominal;
    const double squares = a * a + g * g;
    reach.cos_low = (squares - reach.longest * reach.longest) / (2.0 * a * g);
    reach.cos_high = (squares - reach.shortest * reach.shortest) / (2.0 * a * g);
    return reach;
}

static const Entry *longest_link(const Entries *entries, const FourBar *fourbar, double *length)
{
    const double lengths[] = {fourbar->crank.nominal, fourbar->ground.nominal,
                              fourbar->coupler.nominal, fourbar->follower.nominal};
    // of equal ones the ground comes first
    size_t longest = 1;
    for (size_t i = 0; i < sizeof lengths / sizeof lengths[0]; i++) {
        longest = lengths[i] > lengths[longest] ? i : longest;
    }
    static const char *const PATHS[] = {"four-bar.crank.length", "four-bar.ground.length",
                                        "four-bar.coupler.length", "four-bar.follower.length"};
    *length = lengths[longest];
    return entries_find(entries, PATHS[longest], 0);
}

// The start angles that close, in words.
static void describe_starts(const Reach *reach, char *text, size_t size)
{
    const double first = reach->cos_high < 1.0 ? acos(reach->cos_high) / DEGREE : 0.0;
    const double last = reach->cos_low > -1.0 ? acos(reach->cos_low) / DEGREE : 180.0;
    if (first == 0.0) {
        snprintf(text, size, "a start between %.4g and %.4g deg", -last, last);
    } else if (last == 180.0) {
        snprintf(text, size, "a start between %.4g and %.4g deg", first, 360.0 - first);
    } else {
        snprintf(text, size, "a start between %.4g and %.4g deg or between %.4g and %.4g deg",
                 first, last, -last, -first);
    }
}

static bool check_start(const Entries *entries, const Scenario *scenario, const Reach *reach,
                        Err *err)
{
    const FourBar *fourbar = &scenario->fourbar;
    const double start = scenario->linkage.driver.start;
    const double diagonal = fourbar_diagonal(fourbar, start);
    const double margin = MARGIN * reach->longest;
    double longest;
    const Entry *link = longest_link(entries, fourbar, &longest);
    if (reach->cos_low >= 1.0 || reach->cos_high <= -1.0) {
        const double sum = fourbar->ground.nominal + fourbar->crank.nominal +
                           fourbar->coupler.nominal + fourbar->follower.nominal;
        return entries_refuse(link, err,
                              "the mechanism closes at no crank angle: this link is too long\n"
                              "allowed: less than the other three together, %.6g mm",
                              1e3 * (sum - longest));
    }
    if (diagonal > reach->shortest + margin && diagonal < reach->longest - margin) {
        return true;
    }
    const Entry *blamed = entries_blame(entries, "drive.start " BLAMED, 0);
    // a start that is a default is not to blame: the longest link is
    const bool is_at_home =
        strcmp(blamed->row->path, "drive.start") != 0 && !blamed->source->is_override;
    char starts[STARTS_SIZE];
    describe_starts(reach, starts, sizeof starts);
    return entries_refuse(is_at_home ? link : blamed, err,
                          "the mechanism does not close at the start, %.4g deg: crank pin and "
                          "follower pivot are %.4g mm apart, coupler and follower join distances "
                          "between %.4g and %.4g mm\nallowed: %s",
                          start / DEGREE, 1e3 * diagonal, 1e3 * reach->shortest,
                          1e3 * reach->longest, starts);
}

// What all joints together give way, m.
static double total_play(const Linkage *linkage)
{
    double play = 0.0;
    for (size_t i = 0; i < linkage->joint_count; i++) {
        const Joint *joint = &linkage->joints[i];
        play += linkage_radial_clearance(joint);
    }
    return play;
}

// The angle the crank turns from its start until cos(theta) is the value given, rad.
static double travel_to(double cosine, double start, double direction)
{
    // a change point has 1 or -1 here but for rounding
    if (!(fabs(cosine) <= 1.0 + MARGIN)) {
        return INFINITY;
    }
    const double angle = acos(fmin(fmax(cosine, -1.0), 1.0));
    double travel = INFINITY;
    for (int side = -1; side <= 1; side += 2) {
        double turned = fmod(direction * (side * angle - start), 2.0 * M_PI);
        turned += turned < 0.0 ? 2.0 * M_PI : 0.0;
        travel = fmin(travel, turned);
    }
    return travel;
}

// How far the crank turns from its start to a dead centre, rad.
static double free_travel(const Reach *reach, const Driver *driver, double direction)
{
    return fmin(travel_to(reach->cos_low, driver->start, direction),
                travel_to(reach->cos_high, driver->start, direction));
}

// How far the drive turns in the run, rad.
static DriveExtent run_extent(const Scenario *scenario)
{
    const Driver *driver = &scenario->linkage.driver;
    const double turned = 2.0 * M_PI * scenario->run.revolutions;
    return driver->table.count > 0 ? drive_extent(driver, scenario->run.duration)
           : driver->speed < 0.0   ? (DriveExtent){.back = -turned}
                                   : (DriveExtent){.forth = turned};
}

// What keeps the drive away from an angle that is so many revolutions from its start.
static void describe_less(const Driver *driver, double turns, char *text, size_t size)
{
    snprintf(text, size,
             driver->table.count == 0 ? "less than %.4g revolutions"
                                      : "speeds that turn it by less than %.4g revolutions",
             turns);
}

static bool check_way(const Entries *entries, const Scenario *scenario, const Reach *reach,
                      const Reach *most, double direction, double turned, Err *err)
{
    const FourBar *fourbar = &scenario->fourbar;
    const Driver *driver = &scenario->linkage.driver;
    const double travel = free_travel(reach, driver, direction);
    if (!(free_travel(most, driver, direction) / (2.0 * M_PI) <= turned / (2.0 * M_PI))) {
        return true;
    }
    char less[STARTS_SIZE];
    describe_less(driver, travel / (2.0 * M_PI), less, sizeof less);
    const Entry *entry = entries_blame(entries, BLAMED " run.revolutions run.duration", 0);
    return entries_refuse(
        entry, err,
        "the crank cannot turn through the run: from %.4g deg it reaches a dead centre at %.4g deg "
        "(the mechanism is a %s)\nallowed: %s, or a crank that turns fully "
        "(crank or ground the shortest link, and with the longest shorter than the other two "
        "together)",
        driver->start / DEGREE, (driver->start + direction * travel) / DEGREE,
        FOURBAR_GRASHOF_NAMES[fourbar_grashof(fourbar)], less);
}

bool closure_check(const Entries *entries, const Scenario *scenario, Err *err)
{
    const Reach reach = find_reach(&scenario->fourbar, 0.0);
    if (!check_start(entries, scenario, &reach, err)) {
        return false;
    }
    // play may be enough to let the crank pass: then the run shows whether it does
    const Reach most = find_reach(&scenario->fourbar, total_play(&scenario->linkage));
    const DriveExtent extent = run_extent(scenario);
    return (extent.forth == 0.0 ||
            check_way(entries, scenario, &reach, &most, 1.0, extent.forth, err)) &&
           (extent.back == 0.0 ||
            check_way(entries, scenario, &reach, &most, -1.0, -extent.back, err));
}

// How many poses of a run with several drives are tried: a degree of the fastest, or less.
static size_t pose_count(const Scenario *scenario)
{
    const Linkage *linkage = &scenario->linkage;
    double fastest = 0.0;
    for (size_t i = 0; i < linkage_drive_count(linkage); i++) {
        fastest = fmax(fastest, fabs(linkage_drive(linkage, i)->speed));
    }
    const double degrees = fastest * scenario_duration(scenario) / DEGREE;
    return (size_t)fmin(fmax(ceil(degrees), POSES_LEAST), POSES_MOST);
}

// Several drives that leave no freedom must find the mechanism closed all the way.
static bool check_several(const Entries *entries, const Scenario *scenario, Err *err)
{
    const Linkage *linkage = &scenario->linkage;
    if (linkage->further_count == 0 || !kinematics_is_determined(linkage) ||
        scenario_has_clearance(scenario)) {
        return true;
    }
    Motion *motions = zeroed(linkage->body_count, sizeof *motions);
    linkage_start(linkage, motions);
    const size_t count = pose_count(scenario);
    double time_s = 0.0;
    bool is_closed = true;
    for (size_t i = 1; is_closed && i <= count; i++) {
        Err unused = {ERR_NONE, ""};
        DriveState drives[LINKAGE_DRIVE_MAX];
        time_s = scenario_duration(scenario) * (double)i / (double)count;
        linkage_drives_since(linkage, time_s, time_s, drives);
        is_closed = kinematics_solve_driven(linkage, drives, motions, &unused);
    }
    free(motions);
    return is_closed ||
           entries_refuse(entries_blame(entries, "run.duration drive.speed drive.angle", 0), err,
                          "the drives cannot move the mechanism through the run: at %.4g ms it "
                          "cannot be closed, with the crank at %.4g deg\nallowed: a shorter run, "
                          "other speeds or angles, or lengths with which it closes",
                          1e3 * time_s, linkage_crank_angle(linkage, time_s) / DEGREE);
}

bool closure_check_ideal(const Entries *entries, const Scenario *scenario, Err *err)
{
    if (scenario->linkage.further_count > 0) {
        return check_several(entries, scenario, err);
    }
    const Driver *driver = &scenario->linkage.driver;
    const DriveExtent extent = run_extent(scenario);
    const Lock lock = lock_find_between(&scenario->linkage, LOCK_IDEAL_ONLY, extent);
    const Entry *entry = entries_blame(entries, "run.revolutions run.duration drive.speed", 0);
    char less[STARTS_SIZE];
    const double crossed = lock.crossing - driver->start;
    if (lock.has_crossing && crossed >= extent.back && crossed <= extent.forth) {
        describe_less(driver, fabs(crossed) / (2.0 * M_PI), less, sizeof less);
        return entries_refuse(
            entry, err,
            "ideal joints do not determine how the mechanism continues: from %.4g deg it "
            "reaches a change point at %.4g deg, where it can continue in two "
            "ways\nallowed: %s, or play in one of the "
            "joints that are in line there",
            driver->start / DEGREE, lock.crossing / DEGREE, less);
    }
    if (lock.state != LOCK_FOUND) {
        return true;
    }
    describe_less(driver, fabs(lock.crank_angle - driver->start) / (2.0 * M_PI), less, sizeof less);
    return entries_refuse(entry, err,
                          "the crank cannot turn through the run: from %.4g deg it turns up to "
                          "%.6g deg, where the mechanism locks\nallowed: %s, or lengths with which "
                          "it turns",
                          driver->start / DEGREE, lock.crank_angle / DEGREE, less);
}

// The ends of joints on each body: 2 i + side of joint i.
typedef struct BodyEnds {
    size_t *firsts; // by body and one more: where its ends begin; owned, like the ends
    size_t *ends;
} BodyEnds;

static BodyEnds list_ends(const Linkage *linkage)
{
    const size_t count = 2 * linkage->joint_count;
    size_t *bodies = zeroed(count, sizeof *bodies);
    for (size_t i = 0; i < count; i++) {
        const int body = linkage_end(&linkage->joints[i / 2], i % 2).body;
        bodies[i] = body == LINKAGE_GROUND ? GROUPED_NONE : (size_t)body;
    }
    const BodyEnds ends = {
        .firsts = zeroed(linkage->body_count + 1, sizeof *ends.firsts),
        .ends = zeroed(count, sizeof *ends.ends),
    };
    grouped_list(linkage->body_count, count, bodies, ends.firsts, ends.ends);
    free(bodies);
    return ends;
}

// Whether a bushing holds a body.
static bool is_bushed(const Linkage *linkage, size_t body)
{
    bool is_held = false;
    for (size_t i = 0; i < linkage->bushing_count; i++) {
        const Bushing *bushing = &linkage->bushings[i];
        is_held = is_held || bushing->body_a == (int)body || bushing->body_b == (int)body;
    }
    return is_held;
}

static bool check_bodies(const Entries *entries, const Linkage *linkage, const BodyEnds *ends,
                         Err *err)
{
    for (size_t i = 0; i < linkage->body_count; i++) {
        if (ends->firsts[i] == ends->firsts[i + 1] && !is_bushed(linkage, i)) {
            const EntryGroup *group = entries_group(entries, "bodies.*", i);
            return entries_refuse_group(
                group, err,
                "the body '%s' has no joint: nothing holds it\nallowed: a "
                "joint or bushing between it and the ground or another body",
                linkage->bodies[i].name);
        }
    }
    return true;
}

// How far two joints may be from one another to be at one place, m: pins that stand apart from
// their holes' centres do so within their play.
static double same_place(const Joint *joint, const Joint *other)
{
    const bool has_apart = joint->is_apart || other->is_apart;
    return has_apart ? linkage_radial_clearance(joint) + linkage_radial_clearance(other) : 0.0;
}

// The least distance from a joint to the next on one of its bodies, m; infinite without a next.
// Joints at one place are one hinge of several bodies.
static double shortest_link(const Entries *entries, const Scenario *scenario, const BodyEnds *ends,
                            size_t number)
{
    const FourBar *fourbar = &scenario->fourbar;
    const Linkage *linkage = &scenario->linkage;
    if (entries->form == SCHEMA_SLIDER_CRANK) {
        const double links[] = {INFINITY, scenario->slidercrank.crank, scenario->slidercrank.rod,
                                INFINITY};
        return fmin(links[number], links[(number + 1) % 4]);
    }
    if (entries->form == SCHEMA_FOUR_BAR) {
        const double links[] = {fourbar->ground.nominal, fourbar->crank.nominal,
                                fourbar->coupler.nominal, fourbar->follower.nominal};
        return fmin(links[number], links[(number + 1) % 4]);
    }
    const Joint *joint = &linkage->joints[number];
    double shortest = INFINITY;
    for (int side = 0; side < 2; side++) {
        const int body = linkage_end(joint, side).body;
        const size_t end = body == LINKAGE_GROUND ? 0 : ends->firsts[body + 1];
        for (size_t i = body == LINKAGE_GROUND ? 0 : ends->firsts[body]; i < end; i++) {
            const Joint *other = &linkage->joints[ends->ends[i] / 2];
            // in a case with bodies every joint still stands at its place in the world
            const double distance = vec2_length(vec2_sub(other->anchor_a, joint->anchor_a));
            if (joint_rows_count(other->kind) > 0 && distance > same_place(joint, other)) {
                shortest = fmin(shortest, distance);
            }
        }
    }
    return shortest;
}

static bool check_play(const Entries *entries, const Scenario *scenario, const BodyEnds *ends,
                       size_t number, Err *err)
{
    const Joint *joint = &scenario->linkage.joints[number];
    const double shortest = shortest_link(entries, scenario, ends, number);
    const double radial = linkage_radial_clearance(joint);
    if (!joint_has_hole(joint->kind) || radial < shortest) {
        return true;
    }
    return entries_refuse(
        entries_blame(entries, "joints.*.radial-clearance joints.*.hole joints.*.pin", number), err,
        "the radial clearance of joint '%s' (%.6g mm) is as long as a link\n"
        "allowed: a radial clearance far below %.6g mm, the next joint's "
        "distance; usual are 5 to 500 um",
        joint->name, 1e3 * radial, 1e3 * shortest);
}

bool closure_check_members(const Entries *entries, const Scenario *scenario, Err *err)
{
    BodyEnds ends = list_ends(&scenario->linkage);
    // the links of a short form are joined by definition
    bool is_good =
        entries->form != SCHEMA_LONG || check_bodies(entries, &scenario->linkage, &ends, err);
    for (size_t i = 0; is_good && i < scenario->linkage.joint_count; i++) {
        is_good = check_play(entries, scenario, &ends, i, err);
    }
    free(ends.firsts);
    free(ends.ends);
    return is_good;
}
