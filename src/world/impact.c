// Finds what an impact gives, by the contact's own law and on ODE's rows, and the step that will
// do.
#include "contact/impact_figures.h"
#include "world/contact.h"
#include "world/mapping.h"

#include <float.h>
#include <math.h>

// to a contact in rows: every map is right long before
static const double STEPS_MOST = 1e5;

// An impact that was asked about, and what the law gives.
typedef struct Question {
    MapImpactCase impact;
    MapImpact asked;
    double contact_s; // of the same impact without damping
    double share;
} Question;

static JpStatus ask(const JpContact *contact, double mass, double speed, Question *question,
                    JpError *error)
{
    *question = (Question){.impact = {.mass = mass, .speed = speed}};
    REFUSAL_TRY(contact_law(contact, &question->impact.law, error));
    REFUSAL_TRY(refusal_of_positive(mass, "the mass", error));
    REFUSAL_TRY(refusal_of_positive(speed, "the speed", error));
    const double limit = force_law_depth_limit(&question->impact.law);
    question->impact.end = isfinite(limit) ? limit : 0.0;
    question->asked = map_impact_law(&question->impact);
    MapImpactCase undamped = question->impact;
    undamped.law.viscous = undamped.law.hysteresis = 0.0;
    question->contact_s = map_impact_law(&undamped).duration;
    const MapImpact *asked = &question->asked;
    const bool is_finite = isfinite(asked->restitution) && isfinite(asked->force_max) &&
                           isfinite(asked->penetration_max) && isfinite(asked->duration);
    return asked->is_ended && is_finite && question->contact_s >= DBL_MIN &&
                   isfinite(question->contact_s)
               ? JP_OK
               : refusal(
                     error, JP_ERROR_NONE,
                     "the contact has no impact of %g kg at %g m/s that ends; it is too heavily "
                     "damped or its law does not hold so deep",
                     mass, speed);
}

JpStatus jp_impact_of_law(const JpContact *contact, double mass, double speed, JpImpact *impact,
                          JpError *error)
{
    Question question;
    REFUSAL_TRY(refusal_of_null(impact, "the impact", error));
    REFUSAL_TRY(ask(contact, mass, speed, &question, error));
    const MapImpact *asked = &question.asked;
    *impact =
        (JpImpact){asked->restitution, asked->force_max, asked->penetration_max, asked->duration};
    return refusal_none(error);
}

static ImpactFigures predict(const Question *question, double step)
{
    MapImpactCase impact = question->impact;
    impact.step = step;
    return impact_predict(&impact);
}

static bool is_right(double step, const void *context)
{
    const Question *question = context;
    const ImpactFigures figures = predict(question, step);
    return figures.is_ended && !figures.is_past_end && figures.fallbacks == 0 &&
           impact_is_right(&figures, &question->asked, question->share);
}

static JpStatus ask_rows(JpMap map, const JpContact *contact, double mass, double speed,
                         Question *question, JpError *error)
{
    const Map *found = NULL;
    REFUSAL_TRY(mapping_of(map, &found, error));
    REFUSAL_TRY(ask(contact, mass, speed, question, error));
    question->impact.rows.map = found;
    return JP_OK;
}

static JpStatus check_step(const Question *question, double step, JpError *error)
{
    REFUSAL_TRY(refusal_of_positive(step, "the step", error));
    return question->asked.duration <= STEPS_MOST * step
               ? JP_OK
               : refusal(error, JP_ERROR_ARGUMENT,
                         "the step of %g s is below a hundred-thousandth of the contact, which "
                         "lasts %g s; every map is right there",
                         step, question->asked.duration);
}

JpStatus jp_impact_of_rows(JpMap map, const JpContact *contact, double mass, double speed,
                           double step, JpDelivered *delivered, JpError *error)
{
    Question question;
    REFUSAL_TRY(refusal_of_null(delivered, "what is delivered", error));
    REFUSAL_TRY(ask_rows(map, contact, mass, speed, &question, error));
    REFUSAL_TRY(check_step(&question, step, error));
    const ImpactFigures found = predict(&question, step);
    if (!found.is_ended || found.is_past_end) {
        return refusal(error, JP_ERROR_NONE,
                       "on rows of this map the impact does not end, or goes deeper than the "
                       "contact's law holds, at a step of %g s",
                       step);
    }
    const ImpactSpread *e = &found.restitution;
    const ImpactSpread *f = &found.force_max;
    const ImpactSpread *d = &found.penetration_max;
    const ImpactSpread *t = &found.duration;
    // what is widest of all: a sum that overflows is as good as one that is infinite
    const double all = e->mean + f->mean + d->mean + t->mean + e->most + f->most + d->most +
                       t->most + found.omega_h_max;
    REFUSAL_TRY(refusal_of_result(all, "what the rows deliver", error));
    *delivered = (JpDelivered){
        .mean = {e->mean, f->mean, d->mean, t->mean},
        .least = {e->least, f->least, d->least, t->least},
        .most = {e->most, f->most, d->most, t->most},
        .omega_h = found.omega_h_max,
        .fallbacks = found.fallbacks,
    };
    return refusal_none(error);
}

JpStatus jp_step_is_right(JpMap map, const JpContact *contact, double mass, double speed,
                          double step, double share, bool *response, JpError *error)
{
    Question question;
    REFUSAL_TRY(refusal_of_null(response, "the response", error));
    REFUSAL_TRY(refusal_of_positive(share, "the share", error));
    REFUSAL_TRY(ask_rows(map, contact, mass, speed, &question, error));
    REFUSAL_TRY(check_step(&question, step, error));
    question.share = share;
    *response = is_right(step, &question);
    return refusal_none(error);
}

JpStatus jp_step_longest(JpMap map, const JpContact *contact, double mass, double speed,
                         double share, double *step, JpError *error)
{
    Question question;
    REFUSAL_TRY(refusal_of_null(step, "the step", error));
    REFUSAL_TRY(refusal_of_positive(share, "the share", error));
    REFUSAL_TRY(ask_rows(map, contact, mass, speed, &question, error));
    question.share = share;
    const double longest = impact_longest_step(question.contact_s, is_right, &question);
    if (!(longest > 0.0)) {
        return refusal(error, JP_ERROR_NONE,
                       "no step down to a ten-thousandth of the contact is right within %g; take "
                       "another map or a larger share",
                       share);
    }
    *step = longest;
    return refusal_none(error);
}
