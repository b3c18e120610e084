// Finds what impacts give on ODE's contact row, wherever the steps fall, and the step that will
// do.
//
// A step is searched from two steps a contact down to ten thousand, in ratios of 2^(1/4): the
// longest from which on every step tried over a factor of two is valid, and from there by bisection
// towards the next longer one. Finer steps than that factor are taken to be no worse.
#include "contact/impact_figures.h"

#include <math.h>

const double IMPACT_COARSE_STEPS = 2.0;

static const double SEARCH_RATIO = 1.189207115002721; // 2^(1/4)
static const double SEARCH_FINEST = 1e4;              // steps a contact
enum { SEARCH_STREAK = 5, SEARCH_BISECTIONS = 12 };   // over a factor of two; to 1e-4 of the step

static void widen(ImpactSpread *spread, int number, double value)
{
    spread->mean += value / MAP_IMPACT_PHASES;
    spread->least = number == 0 ? value : fmin(spread->least, value);
    spread->most = number == 0 ? value : fmax(spread->most, value);
}

void impact_add_phase(ImpactFigures *figures, int number, const MapImpact *impact)
{
    widen(&figures->restitution, number, impact->restitution);
    widen(&figures->force_max, number, impact->force_max);
    widen(&figures->penetration_max, number, impact->penetration_max);
    widen(&figures->duration, number, impact->duration);
    figures->fallbacks += impact->fallbacks;
    if (impact->omega_h_max > figures->omega_h_max) {
        figures->omega_h_max = impact->omega_h_max;
        figures->omega_h_depth = impact->omega_h_depth;
    }
    if (impact->is_past_end) {
        figures->is_past_end = true;
        figures->past_end_depth = fmax(figures->past_end_depth, impact->penetration_max);
    }
    figures->is_ended = (number == 0 || figures->is_ended) && impact->is_ended;
}

ImpactFigures impact_figures_of(const MapImpact *impact)
{
    const double values[] = {impact->restitution, impact->force_max, impact->penetration_max,
                             impact->duration};
    return (ImpactFigures){
        .restitution = {values[0], values[0], values[0]},
        .force_max = {values[1], values[1], values[1]},
        .penetration_max = {values[2], values[2], values[2]},
        .duration = {values[3], values[3], values[3]},
        .is_past_end = impact->is_past_end,
        .is_ended = impact->is_ended,
    };
}

ImpactFigures impact_predict(const MapImpactCase *impact)
{
    ImpactFigures figures = {.is_ended = true};
    for (int i = 0; i < MAP_IMPACT_PHASES; i++) {
        const MapImpact phase = map_impact(impact, map_impact_phase(i));
        impact_add_phase(&figures, i, &phase);
        if (!phase.is_ended && !phase.is_past_end) {
            break; // nor would the others
        }
    }
    return figures;
}

bool impact_is_near(double value, double asked, double share)
{
    return fabs(value - asked) <= share * asked;
}

bool impact_is_restitution_near(double value, double asked, double share)
{
    return fabs(value - asked) <= share * fmax(asked, share);
}

bool impact_bounces_right(const ImpactFigures *figures, const MapImpact *asked, double share)
{
    return impact_is_restitution_near(figures->restitution.least, asked->restitution, share) &&
           impact_is_restitution_near(figures->restitution.most, asked->restitution, share);
}

static bool is_spread_near(const ImpactSpread *spread, double asked, double share)
{
    return impact_is_near(spread->least, asked, share) &&
           impact_is_near(spread->most, asked, share);
}

bool impact_is_right(const ImpactFigures *figures, const MapImpact *asked, double share)
{
    return impact_bounces_right(figures, asked, share) &&
           is_spread_near(&figures->force_max, asked->force_max, share) &&
           is_spread_near(&figures->penetration_max, asked->penetration_max, share);
}

double impact_longest_step(double contact_s, ImpactStepCheck is_valid, const void *context)
{
    double step_s = contact_s / IMPACT_COARSE_STEPS;
    double first_s = 0.0; // of the streak of valid steps
    int streak = 0;
    while (streak < SEARCH_STREAK) {
        if (contact_s > SEARCH_FINEST * step_s) {
            return 0.0;
        }
        if (is_valid(step_s, context)) {
            first_s = streak == 0 ? step_s : first_s;
            streak++;
        } else {
            streak = 0;
        }
        step_s /= SEARCH_RATIO;
    }
    double valid_s = first_s;
    double wrong_s = first_s * SEARCH_RATIO;
    for (int i = 0; i < SEARCH_BISECTIONS; i++) {
        const double middle_s = sqrt(valid_s * wrong_s);
        *(is_valid(middle_s, context) ? &valid_s : &wrong_s) = middle_s;
    }
    return valid_s;
}
