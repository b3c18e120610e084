// What an impact on a joint asks for, what ODE makes of it, and whether that is valid.
//
// Asked is the law's own impact at the mass and speed of the joint's contacts; predicted, the same
// impact on ODE's row (contact/map_impact.h); delivered, a single pin run in ODE.
//
// k = F(d)/d, dF/dd and c are those at the law's deepest point d of that impact: the row that ODE
// has there is the one whose ERP and CFM are shown. omega = sqrt((dF/dd) / m). Tc is the length of
// the same impact without damping. Of a damping that depends on the depth, the equivalent viscous
// damper is 2 zeta sqrt(k m), zeta the damping ratio of the same restitution.
#include "measure/mapping_contact.h"
#include "base/clock.h"
#include "base/room.h"
#include "base/sorted.h"
#include "base/text.h"
#include "contact/damping.h"
#include "contact/law.h"
#include "contact/penalty.h"
#include "contact/touch.h"
#include "model/coordinate.h"
#include "model/space.h"
#include "run/registry.h"
#include "run/run.h"

#include <assert.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

// as many as a run of one impact may have: the maps are right long before
const double MAPPING_STEPS_MOST = 1e5;

Scenario mapping_scenario(const MappingContact *contact, OdeMap map, double step_s)
{
    Scenario scenario = contact->scenario;
    scenario.run.step = step_s;
    scenario.ode.map = map;
    if (map == ODE_MAP_IMPULSE) {
        scenario.ode.collider = ODE_COLLIDER_PIN_HOLE;
    }
    // maps of the mid-step belong to staggered stepping, and a contact needs one world
    if (map >= ODE_MAP_MIDPOINT || scenario.ode.stepping == ODE_EXTRAPOLATED) {
        scenario.ode.stepping = ODE_STAGGERED;
    }
    return scenario;
}

// The impact of a contact at a step under a map, as ODE makes it. Not of ODE_MAP_IMPULSE.
static MapImpactCase mapping_case(const MappingContact *contact, OdeMap map, double step_s)
{
    MapImpactCase impact = contact->impact;
    const ContactOptions *options = &contact->scenario.contact;
    impact.step = step_s;
    // where the engine ends a run
    const Joint *at = &contact->scenario.linkage.joints[contact->joint.joint];
    impact.end = law_depth_max(&impact.law, at);
    if (mapping_contact_is_poisson(contact)) {
        impact.rows = (MapImpactRows){
            .cfm = map_poisson_cfm(options->penalty),
            .push_out = contact->scenario.ode.push_out,
            .restitution = scenario_restitution(&contact->scenario, at),
            .bounce_speed = options->bounce_speed,
        };
    } else {
        impact.rows = (MapImpactRows){.map = map_get(map)};
    }
    return impact;
}

ImpactFigures mapping_predict(const MappingContact *contact, OdeMap map, double step_s)
{
    if (map == ODE_MAP_IMPULSE) {
        return impact_figures_of(&contact->asked);
    }
    if (contact->asked.duration > MAPPING_STEPS_MOST * step_s) {
        return (ImpactFigures){.is_too_fine = true};
    }
    const MapImpactCase impact = mapping_case(contact, map, step_s);
    return impact_predict(&impact);
}

// The numbers of a law at the deepest point of its impact.
static void fill_deepest(MappingContact *contact)
{
    const ForceLaw *law = &contact->impact.law;
    const double depth = contact->asked.penetration_max;
    contact->secant = force_law_secant(law, depth);
    contact->tangent = force_law_tangent(law, depth);
    contact->damping = force_law_damping(law, depth, contact->impact.speed);
    const double ratio = damping_linear_ratio(fmin(contact->asked.restitution, 1.0));
    contact->equivalent = 2.0 * ratio * sqrt(contact->secant * contact->impact.mass);
}

const char *mapping_law_name(const Scenario *scenario, const Joint *joint)
{
    const ContactOptions own = law_options(&scenario->contact, joint);
    return own.stiffness > 0.0 ? "stiffness" : OPTIONS_LAWS[own.law];
}

// The law's own impact, with and without damping.
static bool mapping_contact_ask(MappingContact *contact, const Joint *at, Err *err)
{
    const MapImpactCase *impact = &contact->impact;
    const double holds = law_depth_max(&impact->law, at); // m
    MapImpactCase undamped = *impact;
    undamped.law.viscous = undamped.law.hysteresis = 0.0;
    contact->asked = map_impact_law(impact);
    contact->half_period_s = map_impact_law(&undamped).duration;
    if (!(contact->half_period_s > 0.0) || contact->asked.penetration_max > holds) {
        return err_set(err, ERR_SOLVER,
                       "%s: an impact of %.4g kg at %.4g m/s goes past the end of the law %s, "
                       "which holds to a depth of %.4g um",
                       at->name, impact->mass, impact->speed, contact->law_name, 1e6 * holds);
    }
    if (!contact->asked.is_ended || !(contact->asked.restitution > 0.0)) {
        const bool is_turning = linkage_is_torsional(at);
        return err_set(err, ERR_SOLVER,
                       "%s: after an impact of %.4g %s at %.4g %s the damping of the law %s keeps "
                       "the pin at the wall",
                       at->name, impact->mass, is_turning ? "kg m^2" : "kg", impact->speed,
                       is_turning ? "rad/s" : "m/s", contact->law_name);
    }
    return true;
}

bool mapping_contact_make(const Scenario *scenario, const MappingJoint *joint, double mass,
                          double speed, MappingContact *contact, Err *err)
{
    const Joint *at = &scenario->linkage.joints[joint->joint];
    MappingContact made = {.joint = *joint, .scenario = *scenario};
    made.law_name = mapping_law_name(scenario, at);
    made.impact.mass = mass;
    made.impact.speed = speed;
    if (mapping_contact_is_poisson(&made)) {
        // the model has no law: it asks for a restitution, and for no force and no depth
        ContactOptions *options = &made.scenario.contact;
        made.law_name = "poisson";
        if (!(options->penalty > 0.0)) {
            options->penalty =
                penalty_estimate(scenario->linkage.driver.speed, &scenario->material);
        }
        made.asked = (MapImpact){
            .restitution = scenario_restitution(&made.scenario, at),
            .force_max = NAN,
            .penetration_max = NAN,
            .duration = NAN,
            .is_ended = true,
        };
        made.half_period_s = made.secant = made.tangent = made.damping = made.equivalent = NAN;
        *contact = made;
        return true;
    }
    if (!law_of_joint(scenario, at, &made.impact.law, err)) {
        return false;
    }
    if (made.impact.law.family == FORCE_LAW_POWER) {
        // the law as it is, in whatever world the pin is run
        scenario_set_stiffness(&made.scenario, made.impact.law.stiffness, made.impact.law.exponent);
    }
    if (!mapping_contact_ask(&made, at, err)) {
        return false;
    }
    fill_deepest(&made);
    *contact = made;
    return true;
}

// The mass and the speed with which the bodies of a joint meet.
//
// The mass along a normal n is 1 / (n W n), W the block of one place of the joint in the linkage's
// mobility (model/response.h), the ideal joints holding and all other places free. It is looked up
// at instants spread over the run. Of a pin in directions spread over half a turn: which of them
// contacts choose is known only after a run, and changes with the setting that is sought. Of a
// block's corners and of stops along the normals that they have.
//
// The closing speeds are those at the onsets of the reference's contacts, every one of them.

enum { INSTANT_COUNT = 120, DIRECTION_COUNT = 24, MASS_COUNT = INSTANT_COUNT * DIRECTION_COUNT };

// What is known of one joint with play.
typedef struct Gathered {
    int joint; // its number
    bool was_touching;
    size_t mass_count;
    double *masses; // owned, MASS_COUNT of them
    size_t speed_count;
    size_t speed_room;
    double *speeds; // owned
    double penetration;
    double force;
} Gathered;

typedef struct Gathering {
    const Scenario *scenario;
    Response response;
    size_t place_count;
    Touch *places; // owned
    size_t play_count;
    Gathered *play;  // owned
    size_t *play_of; // by joint, its number there plus one; 0: it has none; owned
} Gathering;

static void gathering_finish(Gathering *gathering)
{
    for (size_t i = 0; i < gathering->play_count; i++) {
        free(gathering->play[i].masses);
        free(gathering->play[i].speeds);
    }
    response_finish(&gathering->response);
    free(gathering->play);
    free(gathering->play_of);
    free(gathering->places);
    free(gathering);
}

static Gathering *gathering_start(const Scenario *scenario)
{
    Gathering *gathering = calloc(1, sizeof *gathering);
    assert(gathering != NULL);
    gathering->scenario = scenario;
    gathering->play = calloc(scenario->linkage.joint_count + 1, sizeof *gathering->play);
    gathering->play_of = calloc(scenario->linkage.joint_count + 1, sizeof *gathering->play_of);
    assert(gathering->play != NULL && gathering->play_of != NULL);
    for (size_t i = 0; i < scenario->linkage.joint_count; i++) {
        if (linkage_has_play(&scenario->linkage.joints[i])) {
            Gathered *gathered = &gathering->play[gathering->play_count++];
            gathered->joint = (int)i;
            gathering->play_of[i] = gathering->play_count;
            gathered->masses = calloc(MASS_COUNT, sizeof *gathered->masses);
            assert(gathered->masses != NULL);
        }
    }
    return gathering;
}

static void add_mass(Gathering *gathering, size_t play, size_t place, Vec2 along)
{
    const size_t row = response_first_row(&gathering->response, place);
    Gathered *gathered = &gathering->play[play];
    gathered->masses[gathered->mass_count++] = response_mass(&gathering->response, row, along);
}

// The masses at one place, as the bodies stand.
static void mapping_contact_add_place(Gathering *gathering, size_t play, size_t place,
                                      const Motion *motions)
{
    const Touch *touch = &gathering->places[place];
    if (touch_is_scalar(touch)) {
        // its rows are along the normal or the coordinate, and across
        add_mass(gathering, play, place, (Vec2){1.0, 0.0});
    } else if (touch->shape == TOUCH_DISC) {
        const TouchPose pose = touch_pose(&gathering->scenario->linkage, touch, motions);
        add_mass(gathering, play, place, pose.has_normal ? pose.normal : (Vec2){1.0, 0.0});
    } else {
        for (int k = 0; k < DIRECTION_COUNT; k++) {
            const double angle = M_PI * k / DIRECTION_COUNT;
            add_mass(gathering, play, place, (Vec2){cos(angle), sin(angle)});
        }
    }
}

static void mapping_contact_add_masses(Gathering *gathering, const Motion *motions)
{
    // in a position where the ideal joints lock, no mass is defined
    if (!response_place(&gathering->response, motions)) {
        return;
    }
    size_t play = 0;
    for (size_t place = 0; place < gathering->place_count; place++) {
        play += gathering->places[place].joint != gathering->play[play].joint ? 1 : 0;
        mapping_contact_add_place(gathering, play, place, motions);
    }
}

static void add_speed(Gathered *gathered, double speed)
{
    gathered->speeds = room_grow(gathered->speeds, &gathered->speed_room, gathered->speed_count + 1,
                                 sizeof *gathered->speeds);
    gathered->speeds[gathered->speed_count++] = speed;
}

static void add_record(Gathering *gathering, const StepRecord *record)
{
    const size_t count = solver_joint_count(record->part, &gathering->scenario->linkage);
    for (size_t k = 0; k < count; k++) {
        const size_t play = gathering->play_of[solver_joint(record->part, k)];
        if (play == 0) {
            continue;
        }
        Gathered *gathered = &gathering->play[play - 1];
        const double approach = record->approach[k];
        const JointState *state = &record->joints[k];
        if (state->is_touching && !gathered->was_touching && approach > 0.0) {
            add_speed(gathered, approach);
        }
        if (state->is_touching) {
            gathered->penetration = fmax(gathered->penetration, -state->gap);
            gathered->force = fmax(gathered->force, state->force);
        }
        gathered->was_touching = state->is_touching;
    }
}

// Steps the reference to a time and takes every record on the way.
static bool step_to(Gathering *gathering, void *state, double time_s, double *reached_s, Err *err)
{
    const Solver *solver = registry_solver(BACKEND_REFERENCE);
    while (*reached_s < time_s) {
        if (!solver->step(state, time_s, err)) {
            return false;
        }
        const StepRecord record = solver->record(state);
        add_record(gathering, &record);
        *reached_s = record.is_partial ? *reached_s : solver_reached(&record);
    }
    return true;
}

// Runs the reference from instant to instant, and from the last one to the end of the run.
static bool mapping_contact_gather(Gathering *gathering, RunWatch watch, Err *err)
{
    const Scenario *scenario = gathering->scenario;
    const Solver *solver = registry_solver(BACKEND_REFERENCE);
    const double duration_s = scenario_duration(scenario);
    const double started_s = clock_now_s();
    void *state = NULL;
    if (!solver->open(scenario, &state, err)) {
        return false;
    }
    Sample sample = sample_create(&scenario->linkage);
    bool is_right = true;
    double reached_s = 0.0;
    for (int k = 0; is_right && k < INSTANT_COUNT; k++) {
        const double time_s = duration_s * (k + 0.5) / INSTANT_COUNT;
        is_right = step_to(gathering, state, time_s, &reached_s, err);
        if (is_right) {
            solver->observe(state, fmin(time_s, reached_s), &sample);
            mapping_contact_add_masses(gathering, sample.bodies);
        }
        if (watch.progress != NULL) {
            watch.progress(reached_s / duration_s, clock_now_s() - started_s, watch.context);
        }
    }
    is_right = is_right && step_to(gathering, state, duration_s, &reached_s, err);
    sample_free(&sample);
    solver->close(state);
    return is_right;
}

static MappingJoint mapping_contact_conclude(Gathered *gathered)
{
    sorted_make(gathered->masses, gathered->mass_count);
    MappingJoint joint = {
        .joint = gathered->joint,
        .mass_least = gathered->masses[0],
        .mass_median = sorted_median(gathered->masses, gathered->mass_count),
        .mass_most = gathered->masses[gathered->mass_count - 1],
        .onsets = gathered->speed_count,
        .penetration_max = gathered->penetration,
        .force_max = gathered->force,
    };
    if (gathered->speed_count > 0) {
        sorted_make(gathered->speeds, gathered->speed_count);
        joint.speed_median = sorted_median(gathered->speeds, gathered->speed_count);
        joint.speed_most = gathered->speeds[gathered->speed_count - 1];
    }
    return joint;
}

MappingJoint *mapping_joint_list(const Scenario *scenario, size_t *count)
{
    const Linkage *linkage = &scenario->linkage;
    MappingJoint *joints = calloc(linkage->joint_count + 1, sizeof *joints);
    assert(joints != NULL);
    *count = 0;
    for (size_t i = 0; i < linkage->joint_count; i++) {
        if (linkage_has_play(&linkage->joints[i])) {
            joints[(*count)++].joint = (int)i;
        }
    }
    return joints;
}

bool mapping_joint_measure(const Scenario *scenario, RunWatch watch, MappingJoint **joints,
                           size_t *count, Err *err)
{
    if (!space_has_plane(&scenario->linkage)) {
        return err_set(err, ERR_SOLVER,
                       "the mapping takes masses from the plane, and not all axes of this case are "
                       "along z; run and compare show what each map makes of it");
    }
    Gathering *gathering = gathering_start(scenario);
    bool is_right = touch_list(scenario, &gathering->places, &gathering->place_count, err);
    if (is_right) {
        touch_response(&scenario->linkage, gathering->places, gathering->place_count, false,
                       &gathering->response);
        is_right = mapping_contact_gather(gathering, watch, err);
    }
    if (is_right && gathering->play[0].mass_count == 0) {
        is_right = err_set(err, ERR_SOLVER, "the ideal joints are redundant throughout the run");
    }
    if (is_right) {
        *joints = mapping_joint_list(scenario, count);
        for (size_t i = 0; i < *count; i++) {
            (*joints)[i] = mapping_contact_conclude(&gathering->play[i]);
        }
    }
    gathering_finish(gathering);
    return is_right;
}

// Whether a setting is valid, and what would be.
//
// Valid means: restitution, peak force and depth of an impact are each within MAPPING_VALID_SHARE
// of what the law asks, wherever the steps fall. A mechanism does not choose where they do, so that
// a right mean alone is not enough. The judgement is made on the prediction, before anything runs;
// the same judgement on what was delivered is how it is tested. Every number that is judged is a
// ratio, so that the same impact at another mass, length or time has the same verdict.
//
// POISSON rows ask for a restitution alone. Bounce beside a CFM gives (e - r) / (1 + r),
// r = CFM m / h, so that r <= (e - e') / (1 + e') holds for the least e' allowed: there the penalty
// and the step have a least and not a largest value.

// well below what the laws of contact differ by among each other: for one impact of the paper's pin
// the four laws of a cylinder in a hole give peaks from 972 to 1276 N
const double MAPPING_VALID_SHARE = 0.05;

// what rounding may add to the speed of an undamped impact
static const double GAIN_SHARE = 1e-6;

const char *const VERDICT_NAMES[VERDICT_COUNT] = {
    "valid",       "too-fine",    "past-end",     "unstable", "sticks", "too-coarse",
    "gains-speed", "over-damped", "under-damped", "peak",     "depth",  "scatters",
};

static bool is_off(double value, double asked)
{
    return !impact_is_near(value, asked, MAPPING_VALID_SHARE);
}

static bool is_restitution_off(double value, double asked)
{
    return !impact_is_restitution_near(value, asked, MAPPING_VALID_SHARE);
}

static bool is_valid(const MappingContact *contact, const ImpactFigures *figures)
{
    return mapping_contact_is_poisson(contact)
               ? impact_bounces_right(figures, &contact->asked, MAPPING_VALID_SHARE)
               : impact_is_right(figures, &contact->asked, MAPPING_VALID_SHARE);
}

VerdictKind verdict_judge(const MappingContact *contact, OdeMap map, double step_s,
                          const ImpactFigures *figures)
{
    const MapImpact *asked = &contact->asked;
    const bool is_poisson = mapping_contact_is_poisson(contact);
    if (figures->is_too_fine) {
        return VERDICT_TOO_FINE;
    }
    if (figures->is_past_end) {
        return VERDICT_PAST_END;
    }
    if (!figures->is_ended) {
        return VERDICT_STICKS;
    }
    if (figures->fallbacks > 0) {
        return VERDICT_UNSTABLE;
    }
    if (is_valid(contact, figures)) {
        return VERDICT_VALID;
    }
    if (!is_poisson && map != ODE_MAP_IMPULSE &&
        contact->half_period_s < IMPACT_COARSE_STEPS * step_s) {
        return VERDICT_TOO_COARSE;
    }
    const double restitution = figures->restitution.mean;
    if (figures->restitution.most > 1.0 + GAIN_SHARE &&
        is_restitution_off(figures->restitution.most, asked->restitution)) {
        return VERDICT_GAINS;
    }
    if (is_restitution_off(restitution, asked->restitution)) {
        return restitution < asked->restitution ? VERDICT_OVER_DAMPED : VERDICT_UNDER_DAMPED;
    }
    if (!is_poisson && is_off(figures->force_max.mean, asked->force_max)) {
        return VERDICT_PEAK;
    }
    if (!is_poisson && is_off(figures->penetration_max.mean, asked->penetration_max)) {
        return VERDICT_DEPTH;
    }
    return VERDICT_SCATTERS;
}

// A map of a contact whose steps are tried.
typedef struct StepTrial {
    const MappingContact *contact;
    OdeMap map;
} StepTrial;

static bool is_step_valid(double step_s, const void *context)
{
    const StepTrial *trial = context;
    const ImpactFigures figures = mapping_predict(trial->contact, trial->map, step_s);
    return verdict_judge(trial->contact, trial->map, step_s, &figures) == VERDICT_VALID;
}

// To three digits, so that what is printed is as valid as what was found.
static double mapping_contact_rounded(double value, double (*round_to)(double))
{
    const double unit = pow(10.0, floor(log10(value)) - 2.0);
    return round_to(value / unit) * unit;
}

static double find_step(const MappingContact *contact, OdeMap map)
{
    const StepTrial trial = {contact, map};
    const double longest_s = impact_longest_step(contact->half_period_s, is_step_valid, &trial);
    return longest_s > 0.0 ? mapping_contact_rounded(longest_s, floor) : 0.0;
}

void verdict_find_steps(MappingContact *contact)
{
    if (mapping_contact_is_poisson(contact)) {
        return;
    }
    for (int map = ODE_MAP_TEXTBOOK; map < ODE_MAP_IMPULSE; map++) {
        contact->largest_s[map] = find_step(contact, (OdeMap)map);
    }
    contact->largest_s[ODE_MAP_IMPULSE] = INFINITY;
}

double verdict_least_penalty(const MappingContact *contact, double step_s)
{
    const double asked = contact->asked.restitution;
    const double least = (1.0 - MAPPING_VALID_SHARE) * asked;
    const double ratio = (asked - least) / (1.0 + least); // r = m / (p h)
    return mapping_contact_rounded(contact->impact.mass / (ratio * step_s), ceil);
}

static double law_end(const MappingContact *contact)
{
    const Joint *at = &contact->scenario.linkage.joints[contact->joint.joint];
    return law_depth_max(&contact->impact.law, at);
}

static void say_fault(const MappingContact *contact, const MappingRow *row, Text *words)
{
    const ImpactFigures *figures = &row->predicted;
    const MapImpact *asked = &contact->asked;
    switch (row->verdict) {
    case VERDICT_UNSTABLE:
        text_append(
            words,
            "unstable: omega h reaches %.3g where the limit is %.3g, at a depth of %.3g um; the "
            "textbook's rows stand in",
            figures->omega_h_max, map_get(row->map)->stability_limit, 1e6 * figures->omega_h_depth);
        return;
    case VERDICT_TOO_FINE:
        text_append(words, "too fine to try: the contact takes %.2g steps", row->steps_a_contact);
        return;
    case VERDICT_PAST_END:
        text_append(words, "the pin goes past the end of the law: %.3g um, and it holds to %.3g um",
                    1e6 * figures->past_end_depth, 1e6 * law_end(contact));
        return;
    case VERDICT_STICKS:
        text_append(words, "sticks: the contact does not end");
        return;
    case VERDICT_TOO_COARSE:
        text_append(words, "too coarse: the contact takes %.2g steps", row->steps_a_contact);
        return;
    case VERDICT_GAINS:
        text_append(words, "gains speed: asked %.3g, delivers up to %.3g", asked->restitution,
                    figures->restitution.most);
        return;
    case VERDICT_OVER_DAMPED:
    case VERDICT_UNDER_DAMPED:
        text_append(words, "%s: asked %.3g, delivers %.3g", VERDICT_NAMES[row->verdict],
                    asked->restitution, figures->restitution.mean);
        return;
    case VERDICT_PEAK:
        text_append(words, "sees the peak only to %.0f %%",
                    100.0 * figures->force_max.mean / asked->force_max);
        return;
    case VERDICT_DEPTH:
        text_append(words, "sees the depth only to %.0f %%",
                    100.0 * figures->penetration_max.mean / asked->penetration_max);
        return;
    default:
        text_append(
            words,
            "right in the mean, but scatters: restitution %.3g to %.3g, peak %.0f to %.0f %%",
            figures->restitution.least, figures->restitution.most,
            100.0 * figures->force_max.least / asked->force_max,
            100.0 * figures->force_max.most / asked->force_max);
        return;
    }
}

// Another map that is valid at the row's step, plain stepping first; the row's own where none is.
static OdeMap other_map(const MappingContact *contact, const MappingRow *row)
{
    static const OdeMap CHOICES[] = {ODE_MAP_CORRECTED, ODE_MAP_MIDPOINT, ODE_MAP_EXACT,
                                     ODE_MAP_TEXTBOOK, ODE_MAP_IMPULSE};
    static_assert(sizeof CHOICES / sizeof *CHOICES == ODE_MAP_COUNT, "each map has its turn");
    for (size_t i = 0; i < sizeof CHOICES / sizeof *CHOICES; i++) {
        if (CHOICES[i] != row->map && row->step_s <= contact->largest_s[CHOICES[i]]) {
            return CHOICES[i];
        }
    }
    return row->map;
}

static void say_advice(const MappingContact *contact, const MappingRow *row, Text *words)
{
    if (mapping_contact_is_poisson(contact)) {
        const double least = verdict_least_penalty(contact, row->step_s);
        text_append(words, "; use a penalty >= %.3g N s/mm, or h >= %.3g us", 1e-3 * least,
                    1e6 * row->step_s * least / contact->scenario.contact.penalty);
        return;
    }
    const OdeMap other = other_map(contact, row);
    const double largest_s = contact->largest_s[row->map];
    if (row->verdict == VERDICT_TOO_FINE) {
        if (largest_s > 0.0) {
            text_append(words, "; h = %.3g us is enough", 1e6 * largest_s);
        }
        return;
    }
    if (other != row->map) {
        text_append(words, "; use %s", OPTIONS_ODE_MAPS[other]);
    }
    if (largest_s > 0.0 && largest_s < row->step_s) {
        text_append(words, "%s h <= %.3g us", other != row->map ? ", or" : "; use",
                    1e6 * largest_s);
    }
}

void verdict_describe(const MappingContact *contact, MappingRow *row)
{
    if (row->verdict == VERDICT_VALID) {
        text_copy(row->words, sizeof row->words, "valid");
        return;
    }
    Text words;
    text_init(&words);
    say_fault(contact, row, &words);
    say_advice(contact, row, &words);
    text_copy(row->words, sizeof row->words, words.data);
    text_finish(&words);
}

// One impact of a single pin in ODE.
//
// Of a block between guides, a stop or the end of a coordinate a disc stands for the pin, and a
// line for the wall; what turns is run with its inertia for a mass and its angles for lengths.
//
// The pin starts so far from the wall that it overlaps it for the first time at a depth that the
// phase chooses: whole steps of flight, and a share of one more. The shares are the middles of
// equal parts, (i + 1/2) / 16. Plain stepping finds the first overlap at (1 - share) of a step's
// way, staggered stepping, half a step aside, at (1/2 - share) or (3/2 - share): over all i these
// are the same sixteen overlaps as those of the prediction.

// of flight before the wall, where there is room
static const double FLIGHT_STEPS = 10.0;

// of the way from wall to wall that the pin may fly, so that it meets but one of them
static const double FLIGHT_SHARE = 0.75;

// after the contact, so that the last sample stands behind it
static const double STEPS_BEHIND = 2.5;

// of one run: some tens of milliseconds of wall time
static const double STEPS_MOST = 1e5;

// The joint of the single body: its pin in its hole, or a disc against a line across the x axis
// that touches as far from the origin as the pin would.
static Joint single_joint(const Joint *from, double play)
{
    Joint joint = {
        .kind = JOINT_CLEARANCE,
        .body_a = LINKAGE_GROUND,
        .body_b = 0,
        .clearance = from->clearance,
        .contact = from->contact,
    };
    if (!joint_has_hole(from->kind)) {
        const double radius = law_touching_radius(from);
        joint.kind = JOINT_STOP;
        joint.stop.radius_b = isfinite(radius) ? radius : 0.0;
        joint.anchor_a.x = play + joint.stop.radius_b;
        joint.direction = M_PI;
    }
    memcpy(joint.name, from->name, sizeof from->name);
    return joint;
}

// How far the single body flies from the middle to the wall, m. A stop has no wall on the other
// side.
static double single_play(const Joint *from)
{
    if (from->limits.kind != LIMIT_NONE) {
        return coordinate_play(from);
    }
    return joint_has_disc(from->kind) ? INFINITY : linkage_radial_clearance(from);
}

// The scenario's world with nothing in it but the pin; for scenario_free.
static void single_pin(const Scenario *scenario, int joint, double mass, Scenario *single)
{
    const Joint *from = &scenario->linkage.joints[joint];
    const double radius = law_touching_radius(from);
    const double size = isfinite(radius) ? radius : 1e-2; // m: it does not turn
    *single = scenario_around(scenario, linkage_create((LinkageRoom){.bodies = 1, .joints = 1}));
    single->has_fourbar = false;
    single->has_slidercrank = false;
    single->point_count = 0;
    single->gravity = (Vec3){0.0, 0.0, 0.0};
    single->linkage.body_count = 1;
    single->linkage.bodies[0] = (Body){
        .name = "pin",
        .mass = mass,
        .inertia = 0.5 * mass * size * size,
    };
    const double play = single_play(from);
    single->linkage.joint_count = 1;
    single->linkage.joints[0] = single_joint(from, isfinite(play) ? play : 0.0);
    single->run.samples = 2;
}

// One run; false where it says nothing of one impact.
static bool run_phase(const Scenario *single, double speed, MapImpact *impact, char *message)
{
    Trajectory *run = run_scenario(single, registry_solver(BACKEND_ODE), (RunWatch){0});
    const JointExtremes *joint = &run->joints[0];
    const bool is_single = run->is_complete && joint->impacts == 1;
    if (!run->is_complete) {
        snprintf(message, ERR_TEXT_SIZE, "%s", run->message);
    } else if (!is_single) {
        snprintf(message, ERR_TEXT_SIZE, "the pin had %zu contacts and not one", joint->impacts);
    } else {
        const size_t last = run->sample_count - 1;
        const Spike *spike = &joint->spikes[0];
        *impact = (MapImpact){
            .restitution = -trajectory_motion(run, last, 0)->velocity.x / speed,
            .force_max = spike->force_max,
            .penetration_max = spike->penetration_max,
            .duration = spike->duration_s,
            .fallbacks = run->fallback_rows,
            .is_ended = !trajectory_state(run, last, 0)->is_touching,
        };
    }
    trajectory_destroy(run);
    return is_single;
}

ImpactDelivered impact_deliver(const Scenario *scenario, int joint, double mass, double speed,
                               double contact_s)
{
    ImpactDelivered delivered = {.figures = {.is_ended = true}};
    const double step_s = scenario->run.step;
    const double play = single_play(&scenario->linkage.joints[joint]);
    const double wall = isfinite(play) ? play : 0.0;                  // m
    const double room = 2.0 * FLIGHT_SHARE * play / (speed * step_s); // steps
    const double whole = fmin(FLIGHT_STEPS, floor(room) - 1.0);
    const double rest_s = contact_s + STEPS_BEHIND * step_s;
    // past the wall and back again, and some steps behind, without the wall on the other side
    if (!(room >= 2.0)) {
        snprintf(delivered.message, sizeof delivered.message,
                 "the pin flies %.3g of its play in one step", 1.5 / room);
        return delivered;
    }
    if (!(rest_s / step_s <= STEPS_MOST)) {
        snprintf(delivered.message, sizeof delivered.message, "it would take more than %.0e steps",
                 STEPS_MOST);
        return delivered;
    }
    Scenario single;
    single_pin(scenario, joint, mass, &single);
    delivered.is_measured = true;
    for (int i = 0; i < MAP_IMPACT_PHASES && delivered.is_measured; i++) {
        const double flight_s = (whole + map_impact_phase(i)) * step_s;
        Motion *start = &single.linkage.bodies[0].start;
        start->position.x = wall - speed * flight_s;
        start->velocity.x = speed;
        single.run.duration = flight_s + rest_s;
        MapImpact impact;
        delivered.is_measured = run_phase(&single, speed, &impact, delivered.message);
        if (delivered.is_measured) {
            impact_add_phase(&delivered.figures, i, &impact);
        }
    }
    scenario_free(&single);
    return delivered;
}
