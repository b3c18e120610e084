// Searches the best constants for a contact at a step that cannot be changed.
//
// The search is over (ln k, ln c), k and c the spring and damper that the map makes a row of: a
// grid wide enough for every contact from the law's own length to one of a hundred steps, then
// grids ever finer about its best points. Nothing is smooth here, for the number of steps in the
// contact jumps, so nothing is taken of slopes.
//
// Constants are rows of the velocity-level model without bounce: F = ((ERP / h) d + d') / (CFM + h
// / m). That is how they are predicted and how they are run.
#include "measure/constants.h"
#include "model/coordinate.h"

#include <assert.h>
#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

const OdeMap CONSTANTS_MAPS[CONSTANTS_MAP_COUNT] = {ODE_MAP_TEXTBOOK, ODE_MAP_CORRECTED,
                                                    ODE_MAP_MIDPOINT};

enum {
    GRID = 100,  // points a side of the first grid
    STARTS = 4,  // of its local minima, the best, are looked at closer
    CLOSER = 25, // points to either side of the middle of a finer grid
    CLOSER_ROUNDS = 12
};

static const double CLOSER_RATIO = 0.3;
static const double CLOSEST = 1e-5;

// m/s: nothing is as fast, so that nothing bounces
static const double NO_BOUNCE = 1e100;

// 1: sums of squares are compared with room for their rounding
static const double SUM_ROUNDING = 1.0 + 1e-12;

// beyond the outermost springs and dampers that a contact could want
static const double WIDE = 30.0;

// with more steps than this in a contact the corrected map adds nothing of its own to spring and
// damper: what is found with that many is right to (omega h)^2 / 24, 3e-4, with more
static const double STEPS_ENOUGH = 40.0;

// how long a contact may last in the search: this multiple of the law's, plus this many steps
static const double LONGEST_SHARE = 20.0;
static const double LONGEST_STEPS = 400.0;

// the hole of the pin that is run, as cmd_map.c's: play for this many of the longer of a step and
// a contact, and a pin for which no depth is too deep
static const double ROOM = 20.0;
static const double PIN_PLAYS = 10.0;

static MapImpactCase impact_of(const MappingContact *contact, double step_s,
                               const ConstantsSetting *setting)
{
    MapImpactCase impact = contact->impact;
    impact.step = step_s;
    impact.end = 0.0; // constants know no end
    impact.law = map_impact_linear(setting->stiffness, setting->damping);
    if (setting->map == ODE_MAP_MIDPOINT) {
        impact.rows = (MapImpactRows){.map = map_get(setting->map)};
    } else {
        impact.rows = (MapImpactRows){
            .cfm = setting->row.cfm,
            .push_out = setting->row.erp,
            .bounce_speed = NO_BOUNCE,
        };
    }
    return impact;
}

static double square_of_log(double value, double asked)
{
    const double log_ratio = log(fmax(value, DBL_MIN) / asked);
    return log_ratio * log_ratio;
}

// When a search gives up a setting, which then has an infinite misfit.
typedef struct Patience {
    size_t step_most;   // of one impact; 0 for a prediction that is shown, which is never given up
    double misfit_most; // of a setting that is of any use
    int first_phase;    // looked at first: the one that ruled out the setting before
} Patience;

// Of the terms of the misfit one of a phase's three is the penetration's: the depth, m, at which
// that term alone makes the whole too large.
static double worst_depth(const MapImpact *asked, double misfit_most)
{
    return asked->penetration_max * exp(misfit_most * sqrt(3.0 * MAP_IMPACT_PHASES));
}

static double restitution_off(const MapImpact *phase, const MapImpact *asked)
{
    return (phase->restitution - asked->restitution) /
           fmax(asked->restitution, MAPPING_VALID_SHARE);
}

// What one phase adds to the sum of the squares of a setting's misfit, over MAP_IMPACT_PHASES.
static double phase_misfit(const MapImpact *phase, const MapImpact *asked)
{
    const double off = restitution_off(phase, asked);
    return (off * off + square_of_log(phase->force_max, asked->force_max) +
            square_of_log(phase->penetration_max, asked->penetration_max)) /
           3.0;
}

static bool phase_meets_restitution(const MapImpact *phase, const MapImpact *asked)
{
    return phase->is_ended && phase->fallbacks == 0 &&
           fabs(restitution_off(phase, asked)) <= MAPPING_VALID_SHARE;
}

// Predicts a setting with a row, phase by phase. A search ends with the phase that rules the
// setting out, and begins with it the next time: settings beside each other fail in the same phase.
static void predict_phases(const MappingContact *contact, const MapImpactCase *impact,
                           Patience *patience, ConstantsSetting *setting)
{
    const MapImpact *asked = &contact->asked;
    const bool is_search = patience->step_most > 0;
    const double sum_most =
        patience->misfit_most * patience->misfit_most * MAP_IMPACT_PHASES * SUM_ROUNDING;
    MapImpact phases[MAP_IMPACT_PHASES];
    double sum = 0.0;
    bool is_ruled_out = false;
    int seen = 0;
    setting->is_restitution_met = true;
    while (seen < MAP_IMPACT_PHASES && !is_ruled_out) {
        const int number = (patience->first_phase + seen++) % MAP_IMPACT_PHASES;
        const MapImpact *phase = &phases[number];
        phases[number] = map_impact(impact, map_impact_phase(number));
        sum += phase_misfit(phase, asked);
        setting->is_restitution_met =
            setting->is_restitution_met && phase_meets_restitution(phase, asked);
        is_ruled_out =
            !phase->is_ended || (is_search && (!setting->is_restitution_met || sum > sum_most));
        patience->first_phase = is_search && is_ruled_out ? number : patience->first_phase;
    }
    setting->misfit = INFINITY;
    if (is_search && is_ruled_out) {
        return;
    }
    // in the order of the phases, so that no bit of it depends on which came first
    sum = 0.0;
    for (int i = 0; i < seen; i++) {
        impact_add_phase(&setting->predicted, i, &phases[i]);
        sum += phase_misfit(&phases[i], asked);
    }
    setting->misfit = is_ruled_out ? INFINITY : sqrt(sum / MAP_IMPACT_PHASES);
}

// Makes the row and predicts it.
static ConstantsSetting constants_predict(const MappingContact *contact, double step_s, OdeMap map,
                                          double stiffness, double damping, Patience *patience)
{
    ConstantsSetting setting = {.map = map, .stiffness = stiffness, .damping = damping};
    const MapContact at = {
        .stiffness = stiffness,
        .damping = damping,
        .step = step_s,
        .mass = contact->impact.mass,
        .depth = contact->asked.penetration_max,
    };
    setting.row = map_get(map)->convert(&at);
    MapImpactCase impact = impact_of(contact, step_s, &setting);
    if (patience->step_most > 0) {
        impact.step_most = patience->step_most;
        impact.end = worst_depth(&contact->asked, patience->misfit_most);
    }
    predict_phases(contact, &impact, patience, &setting);
    return setting;
}

ConstantsSetting constants_setting(const MappingContact *contact, double step_s, OdeMap map,
                                   double stiffness, double damping)
{
    Patience endless = {.misfit_most = INFINITY};
    ConstantsSetting setting =
        constants_predict(contact, step_s, map, stiffness, damping, &endless);
    setting.verdict = verdict_judge(contact, map, step_s, &setting.predicted);
    return setting;
}

bool constants_is_better(const ConstantsSetting *one, const ConstantsSetting *other)
{
    if (one->is_restitution_met != other->is_restitution_met) {
        return one->is_restitution_met;
    }
    return one->misfit < other->misfit;
}

typedef struct Search {
    const MappingContact *contact;
    OdeMap map;
    double step_s;
    Patience patience;
} Search;

typedef struct Point {
    double log_stiffness;
    double log_damping;
    ConstantsSetting setting;
} Point;

// A setting whose misfit is larger than is of any use is given up.
static Point constants_look(Search *search, double log_stiffness, double log_damping,
                            double misfit_most)
{
    search->patience.misfit_most = misfit_most;
    return (Point){log_stiffness, log_damping,
                   constants_predict(search->contact, search->step_s, search->map,
                                     exp(log_stiffness), exp(log_damping), &search->patience)};
}

// Keeps a point among the best, the best first.
static void constants_keep(Point best[STARTS], size_t *count, const Point *point)
{
    size_t index = *count;
    while (index > 0 && constants_is_better(&point->setting, &best[index - 1].setting)) {
        index--;
    }
    if (index == STARTS) {
        return;
    }
    const size_t moved = *count - index - (*count == STARTS ? 1 : 0);
    memmove(&best[index + 1], &best[index], moved * sizeof *best);
    best[index] = *point;
    *count += *count < STARTS ? 1 : 0;
}

// Whether no neighbour on the grid is better.
static bool is_local_best(const Point *grid, int number)
{
    for (int i = number / GRID - 1; i <= number / GRID + 1; i++) {
        for (int k = number % GRID - 1; k <= number % GRID + 1; k++) {
            const bool is_on_it = i >= 0 && i < GRID && k >= 0 && k < GRID;
            if (is_on_it &&
                constants_is_better(&grid[i * GRID + k].setting, &grid[number].setting)) {
                return false;
            }
        }
    }
    return true;
}

// Looks at finer and finer grids about a point and moves to the best.
static void look_closer(Search *search, double across_k, double across_c, Point *point)
{
    double share = 2.0; // of the first grid's distances
    for (int round = 0; round < CLOSER_ROUNDS && share > CLOSEST; round++) {
        const Point middle = *point;
        bool is_moved = false;
        for (int i = -CLOSER; i <= CLOSER; i++) {
            for (int k = -CLOSER; k <= CLOSER; k++) {
                const Point tried = constants_look(
                    search, middle.log_stiffness + share * across_k * i / CLOSER,
                    middle.log_damping + share * across_c * k / CLOSER, point->setting.misfit);
                if (constants_is_better(&tried.setting, &point->setting)) {
                    *point = tried;
                    is_moved = true;
                }
            }
        }
        // as long as it gets on it goes on, along the edge of what is allowed too
        share *= is_moved ? 1.0 : CLOSER_RATIO;
    }
}

// Springs from the law's own, or the stiffest that a step sees, to those of a contact of very many
// steps; dampers from next to none to those that let nothing back.
static void find_constants(Search *search, double *stiffness, double *damping)
{
    const MappingContact *contact = search->contact;
    const double mass = contact->impact.mass;
    const double step_s = search->step_s;
    const double by_step = mass / (step_s * step_s);
    const double high = fmax(contact->secant, by_step) * WIDE;
    const double low = fmin(contact->secant / WIDE, by_step / (LONGEST_STEPS * LONGEST_STEPS));
    const double low_c = 1e-4 * sqrt(low * mass);
    const double high_c = WIDE * sqrt(high * mass);
    const double across_k = log(high / low) / (GRID - 1);
    const double across_c = log(high_c / low_c) / (GRID - 1);
    Point *grid = malloc(GRID * GRID * sizeof *grid);
    assert(grid != NULL);
    for (int i = 0; i < GRID * GRID; i++) {
        grid[i] = constants_look(search, log(low) + across_k * (i / GRID),
                                 log(low_c) + across_c * (i % GRID), INFINITY);
    }
    Point best[STARTS];
    size_t count = 0;
    for (int i = 0; i < GRID * GRID; i++) {
        if (is_local_best(grid, i)) {
            constants_keep(best, &count, &grid[i]);
        }
    }
    free(grid);
    // beside a start that meets the restitution, those that do not are no use
    while (best[0].setting.is_restitution_met && !best[count - 1].setting.is_restitution_met) {
        count--;
    }
    for (size_t i = 0; i < count; i++) {
        look_closer(search, across_k, across_c, &best[i]);
    }
    size_t chosen = 0;
    for (size_t i = 1; i < count; i++) {
        chosen = constants_is_better(&best[i].setting, &best[chosen].setting) ? i : chosen;
    }
    *stiffness = exp(best[chosen].log_stiffness);
    *damping = exp(best[chosen].log_damping);
}

void constants_apply(const ConstantsSetting *setting, Scenario *scenario)
{
    ContactOptions *options = &scenario->contact;
    scenario_set_stiffness(scenario, setting->stiffness, 1.0);
    options->damping = DAMPING_VISCOUS;
    options->is_damping_for_all = true;
    options->viscous_coefficient = setting->damping;
    if (setting->map != ODE_MAP_MIDPOINT) {
        options->model = CONTACT_POISSON;
        options->bounce_speed = NO_BOUNCE;
        options->penalty = 1.0 / setting->row.cfm;
        scenario->ode.push_out = setting->row.erp;
    }
}

// A pin in a hole that leaves it room, with the constants; for scenario_free.
static Scenario constants_scenario(const MappingContact *contact, double step_s,
                                   const ConstantsSetting *setting)
{
    const Scenario shared = mapping_scenario(contact, setting->map, step_s);
    Scenario scenario = scenario_copy(&shared);
    Clearance *clearance = &scenario.linkage.joints[contact->joint.joint].clearance;
    const double room =
        ROOM * (contact->impact.speed * fmax(step_s, setting->predicted.duration.most) +
                setting->predicted.penetration_max.most);
    clearance->pin_radius = PIN_PLAYS * room;
    clearance->hole_radius = clearance->pin_radius + room;
    constants_apply(setting, &scenario);
    scenario.contact.friction = 0.0;
    scenario.linkage.joints[contact->joint.joint].contact.has_friction = false;
    return scenario;
}

static ImpactDelivered deliver(const MappingContact *contact, double step_s,
                               const ConstantsSetting *setting)
{
    Scenario scenario = constants_scenario(contact, step_s, setting);
    const ImpactDelivered delivered =
        impact_deliver(&scenario, contact->joint.joint, contact->impact.mass, contact->impact.speed,
                       setting->predicted.duration.most);
    scenario_free(&scenario);
    return delivered;
}

ImpactDelivered constants_deliver(const MappingContact *contact, double step_s, OdeMap map,
                                  double stiffness, double damping)
{
    const ConstantsSetting setting = constants_setting(contact, step_s, map, stiffness, damping);
    return deliver(contact, step_s, &setting);
}

static ConstantsSetting search_setting(const MappingContact *contact, double step_s, OdeMap map)
{
    Search search = {
        .contact = contact,
        .map = map,
        .step_s = step_s,
        .patience.step_most =
            (size_t)(LONGEST_SHARE * contact->asked.duration / step_s + LONGEST_STEPS),
    };
    double stiffness;
    double damping;
    find_constants(&search, &stiffness, &damping);
    return constants_setting(contact, step_s, map, stiffness, damping);
}

// With many steps in a contact the corrected map's constants are good at any step, and the
// textbook's, which adds a damper h k, takes that off. Those of the corrected map at that many
// steps are given where the step is a finer one.
static ConstantsSetting constants_find_setting(const MappingContact *contact, double step_s,
                                               OdeMap map, const ConstantsSetting *fine)
{
    if (fine == NULL) {
        return search_setting(contact, step_s, map);
    }
    const double added = map == ODE_MAP_TEXTBOOK ? step_s * fine->stiffness : 0.0;
    return fine->damping > added
               ? constants_setting(contact, step_s, map, fine->stiffness, fine->damping - added)
               : search_setting(contact, step_s, map);
}

void constants_find(const MappingContact *contact, double step_s, Constants *held)
{
    const Joint *joint = &contact->scenario.linkage.joints[contact->joint.joint];
    *held = (Constants){
        .step_s = step_s,
        .flight = contact->impact.speed * step_s,
        .play = 2.0 * (joint->limits.kind != LIMIT_NONE ? coordinate_play(joint)
                                                        : linkage_radial_clearance(joint)),
    };
    const double searched_s = contact->asked.duration / STEPS_ENOUGH;
    const bool is_fine = step_s < searched_s;
    ConstantsSetting fine;
    if (is_fine) {
        fine = search_setting(contact, searched_s, ODE_MAP_CORRECTED);
    }
    for (int i = 0; i < CONSTANTS_MAP_COUNT; i++) {
        ConstantsSetting *setting = &held->settings[i];
        *setting =
            constants_find_setting(contact, step_s, CONSTANTS_MAPS[i], is_fine ? &fine : NULL);
        setting->delivered = deliver(contact, step_s, setting);
    }
}
