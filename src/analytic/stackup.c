// Finds the worst that tolerances and play can do to a four-bar's motion.
//
// All corners are tried: two ends of each tolerated length, five placings of each play (none,
// either link longer or shorter). The extremes of a turn are monotone in each length over
// tolerances of some thousandths, so the worst stands in a corner; the tests hold that against
// random interiors.
#include "analytic/stackup.h"

#include <math.h>
#include <string.h>

const char *const STACKUP_LENGTH_NAMES[STACKUP_LENGTHS] = {"ground", "crank", "coupler",
                                                           "follower"};
const char *const STACKUP_SOURCE_NAMES[STACKUP_SOURCES] = {
    "ground length",      "crank length",          "coupler length",       "follower length",
    "play crank-coupler", "play coupler-follower", "play follower-ground",
};
const char *const STACKUP_QUANTITY_NAMES[FOURBAR_QUANTITY_COUNT] = {
    "omega coupler",  "omega follower", "alpha coupler",
    "alpha follower", "follower angle", "transmission angle",
};

enum { GRID = 360, SIDES = 2, PLACINGS = 5 };

// the two links each play can add to, as numbers of the lengths
static const int PLAY_LINKS[STACKUP_PLAYS][2] = {{1, 2}, {2, 3}, {3, 0}};

static const char *const PLAY_JOINTS[STACKUP_PLAYS] = {"crank-coupler", "coupler-follower",
                                                       "follower-ground"};

typedef struct Search {
    const FourBar *fourbar;
    const double *play;
    double speed;
    Vec2 cranks[GRID]; // unit vectors
    FourBarTurn turn;
    double best[FOURBAR_QUANTITY_COUNT][2];
    StackupCombination worst[FOURBAR_QUANTITY_COUNT][2];
    bool is_turning; // whether the crank turned fully in every corner so far
} Search;

static const ToleratedLength *length_of(const FourBar *fourbar, int number)
{
    const ToleratedLength *lengths[STACKUP_LENGTHS] = {&fourbar->ground, &fourbar->crank,
                                                       &fourbar->coupler, &fourbar->follower};
    return lengths[number];
}

static bool has_tolerance(const ToleratedLength *length)
{
    return length->lower < 0.0 || length->upper > 0.0;
}

FourBarLengths stackup_lengths(const FourBar *fourbar, const double play[STACKUP_PLAYS],
                               const StackupCombination *combination)
{
    double values[STACKUP_LENGTHS];
    for (int i = 0; i < STACKUP_LENGTHS; i++) {
        const ToleratedLength *length = length_of(fourbar, i);
        const int side = combination->length_side[i];
        values[i] =
            length->nominal + (side > 0 ? length->upper : 0.0) + (side < 0 ? length->lower : 0.0);
    }
    for (int i = 0; i < STACKUP_PLAYS; i++) {
        if (combination->play_link[i] >= 0) {
            values[combination->play_link[i]] += combination->play_sign[i] * play[i];
        }
    }
    return (FourBarLengths){values[0], values[1], values[2], values[3], fourbar->assembly};
}

// Whether the crank turns fully, and the mechanism is of the nominal one's class: between two
// classes lie lengths at which it does not turn.
static bool is_alike(const Search *search, const FourBarLengths *lengths)
{
    const FourBar corner = {
        .ground = {lengths->ground, 0.0, 0.0},
        .crank = {lengths->crank, 0.0, 0.0},
        .coupler = {lengths->coupler, 0.0, 0.0},
        .follower = {lengths->follower, 0.0, 0.0},
    };
    return fourbar_crank_turns(&corner) &&
           fourbar_grashof(&corner) == fourbar_grashof(search->fourbar);
}

static void try_combination(Search *search, const StackupCombination *combination)
{
    const FourBarLengths lengths = stackup_lengths(search->fourbar, search->play, combination);
    search->is_turning = search->is_turning && is_alike(search, &lengths);
    for (int i = 0; i < GRID; i++) {
        double values[FOURBAR_QUANTITY_COUNT];
        fourbar_motion_quantities(&lengths, search->speed, search->cranks[i], values);
        for (int quantity = 0; quantity < FOURBAR_QUANTITY_COUNT; quantity++) {
            double *best = search->best[quantity];
            if (values[quantity] < best[0]) {
                best[0] = values[quantity];
                search->worst[quantity][0] = *combination;
            }
            if (values[quantity] > best[1]) {
                best[1] = values[quantity];
                search->worst[quantity][1] = *combination;
            }
        }
    }
}

// Sets one play to one of its five placings: none, then longer and shorter of either link.
static void place_play(StackupCombination *combination, int play, int placing)
{
    combination->play_link[play] = placing == 0 ? -1 : PLAY_LINKS[play][(placing - 1) / 2];
    combination->play_sign[play] = placing == 0 ? 0 : (placing % 2 == 1 ? 1 : -1);
}

static void try_plays(Search *search, StackupCombination *combination, int play)
{
    if (play == STACKUP_PLAYS) {
        try_combination(search, combination);
        return;
    }
    const int placings = search->play[play] > 0.0 ? PLACINGS : 1;
    for (int placing = 0; placing < placings; placing++) {
        place_play(combination, play, placing);
        try_plays(search, combination, play + 1);
    }
}

static void try_lengths(Search *search, StackupCombination *combination, int number)
{
    if (number == STACKUP_LENGTHS) {
        try_plays(search, combination, 0);
        return;
    }
    const ToleratedLength *length = length_of(search->fourbar, number);
    const bool is_tolerated = has_tolerance(length);
    for (int side = 0; side < (is_tolerated ? SIDES : 1); side++) {
        combination->length_side[number] = is_tolerated ? 2 * side - 1 : 0;
        try_lengths(search, combination, number + 1);
    }
}

static double extreme_of(const Search *search, const StackupCombination *combination,
                         FourBarQuantity quantity, bool is_high)
{
    const FourBarLengths lengths = stackup_lengths(search->fourbar, search->play, combination);
    return fourbar_motion_bound(&lengths, search->speed, quantity, is_high, &search->turn);
}

// What one bound becomes, and what each source of its worst combination does alone.
static StackupBound refine(const Search *search, const bool is_source[STACKUP_SOURCES],
                           FourBarQuantity quantity, bool is_high, double nominal)
{
    StackupBound bound = {.combination = search->worst[quantity][is_high]};
    bound.value = extreme_of(search, &bound.combination, quantity, is_high);
    for (int source = 0; source < STACKUP_SOURCES; source++) {
        StackupCombination single = {.play_link = {-1, -1, -1}};
        if (source < STACKUP_LENGTHS) {
            single.length_side[source] = bound.combination.length_side[source];
        } else {
            const int play = source - STACKUP_LENGTHS;
            single.play_link[play] = bound.combination.play_link[play];
            single.play_sign[play] = bound.combination.play_sign[play];
        }
        bound.alone[source] =
            is_source[source] ? extreme_of(search, &single, quantity, is_high) - nominal : 0.0;
    }
    return bound;
}

static void find_sources(const Scenario *scenario, Stackup *stackup)
{
    for (int i = 0; i < STACKUP_LENGTHS; i++) {
        const ToleratedLength *length = length_of(&scenario->fourbar, i);
        stackup->is_source[i] = has_tolerance(length);
    }
    for (int i = 0; i < STACKUP_PLAYS; i++) {
        const int joint = linkage_find_joint(&scenario->linkage, PLAY_JOINTS[i]);
        const bool is_loose = joint >= 0 && joint_has_hole(scenario->linkage.joints[joint].kind);
        stackup->play[i] =
            is_loose ? linkage_radial_clearance(&scenario->linkage.joints[joint]) : 0.0;
        stackup->is_source[STACKUP_LENGTHS + i] = is_loose;
    }
    for (int i = 0; i < STACKUP_SOURCES; i++) {
        stackup->has_sources = stackup->has_sources || stackup->is_source[i];
    }
}

bool stackup_compute(const Scenario *scenario, Stackup *stackup, Err *err)
{
    if (!scenario->has_fourbar || !fourbar_crank_turns(&scenario->fourbar)) {
        return err_set(err, ERR_SOLVER, "%s",
                       scenario->has_slidercrank
                           ? "it is for four-bars only"
                           : "a stack-up needs a four-bar whose crank turns fully");
    }
    if (!drive_is_steady(&scenario->linkage.driver)) {
        return err_set(err, ERR_SOLVER, "it is for drives of constant speed");
    }
    Stackup made = {.has_sources = false};
    find_sources(scenario, &made);
    Search search = {
        .fourbar = &scenario->fourbar,
        .play = made.play,
        .speed = scenario->linkage.driver.speed,
        .is_turning = true,
    };
    for (int i = 0; i < GRID; i++) {
        const double angle = 2.0 * M_PI * i / GRID;
        search.cranks[i] = (Vec2){cos(angle), sin(angle)};
    }
    fourbar_motion_turn(&search.turn);
    for (int quantity = 0; quantity < FOURBAR_QUANTITY_COUNT; quantity++) {
        search.best[quantity][0] = INFINITY;
        search.best[quantity][1] = -INFINITY;
    }
    StackupCombination combination = {.play_link = {-1, -1, -1}};
    try_lengths(&search, &combination, 0);
    if (!search.is_turning) {
        return err_set(err, ERR_SOLVER,
                       "within its tolerances the crank does not always turn fully");
    }
    const StackupCombination nominal = {.play_link = {-1, -1, -1}};
    for (int quantity = 0; quantity < FOURBAR_QUANTITY_COUNT; quantity++) {
        StackupRow *row = &made.rows[quantity];
        row->nominal_low = extreme_of(&search, &nominal, quantity, false);
        row->nominal_high = extreme_of(&search, &nominal, quantity, true);
        row->low = refine(&search, made.is_source, quantity, false, row->nominal_low);
        row->high = refine(&search, made.is_source, quantity, true, row->nominal_high);
    }
    *stackup = made;
    return true;
}
