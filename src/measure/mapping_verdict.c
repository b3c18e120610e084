// Is a setting right, what is wrong with it, and what would be right?
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
#include "measure/mapping_verdict.h"

#include "base/text.h"
#include "contact/law.h"

#include <math.h>

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
static double rounded(double value, double (*round_to)(double))
{
    const double unit = pow(10.0, floor(log10(value)) - 2.0);
    return round_to(value / unit) * unit;
}

static double find_step(const MappingContact *contact, OdeMap map)
{
    const StepTrial trial = {contact, map};
    const double longest_s = impact_longest_step(contact->half_period_s, is_step_valid, &trial);
    return longest_s > 0.0 ? rounded(longest_s, floor) : 0.0;
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
    return rounded(contact->impact.mass / (ratio * step_s), ceil);
}

static double law_end(const MappingContact *contact)
{
    const Joint *at = &contact->scenario.linkage.joints[contact->joint.joint];
    return law_depth_max(&contact->impact.law, law_touching_radius(at));
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
