// Follows one contact from step to step where each step gives it one row of ODE.
#include "ode/step_contact.h"

#include <math.h>

// It begins.
static void begin(StepContact *contact, const StepFound *found, StepKind step)
{
    contact->state =
        contact_state_begun(step.is_staggered ? onset_speed(&contact->onset, found->closing,
                                                            found->gap, found->inside, step.step_s)
                                              : found->closing);
    contact_peaks_begin(&contact->peaks,
                        force_law_viscous(&contact->law, 0.0) * contact->state.impact_speed,
                        0.5 * step.step_s - found->onset_s);
}

void step_contact_find(StepContact *contact, const StepFound *found, StepKind step)
{
    const bool was_touching = contact->state.is_touching;
    contact->found = *found;
    contact->state.is_touching = found->touches;
    if (!found->touches) {
        contact->state.impact_speed = found->closing;
    } else if (was_touching) {
        contact->state.age_s += step.step_s;
        contact_state_follow(&contact->state, found->closing, contact->law.resting_speed);
    } else {
        begin(contact, found, step);
    }
    onset_note(&contact->onset, found->touches, found->gap);
}

ErpCfm step_contact_soft(StepContact *contact, const Map *map, double step_s)
{
    const LawRow at = {
        .depth = contact->found.depth,
        .closing = contact->found.closing,
        .impact_speed = contact->state.damping_speed,
        .share = contact->found.share,
        .mass = contact->mass,
    };
    const double slope = force_law_tangent(&contact->law, at.depth);
    contact->falls_back = !isinf(map->stability_limit) &&
                          !law_row_is_stable(map, slope / contact->stiff_mass, step_s);
    const MapContact row = law_row_contact(&contact->law, &at, step_s);
    contact->damping = row.damping;
    return law_row_soft(map, contact->falls_back, &row);
}

void step_contact_book(StepContact *contact, ContactModel model, StepAfter after, StepKind step)
{
    const StepFound *before = &contact->found;
    const double mean = 0.5 * (before->closing + after.closing);
    if (model == CONTACT_POISSON) {
        contact->dissipated = after.pressing * mean * step.step_s;
        contact->elastic = 0.0;
        return;
    }
    // of a staggered world the step stands in the middle between its two speeds, and its end
    // between two positions
    const double closing = step.is_staggered ? mean : after.closing;
    const double depth = step.is_staggered ? 0.5 * (before->inside + after.depth) : after.depth;
    const double damped = after.pressing > 0.0 ? contact->damping * closing
                                               : -force_law_elastic(&contact->law, before->depth);
    contact->dissipated = damped * closing * step.step_s;
    contact->elastic = force_law_energy(&contact->law, fmax(0.0, depth));
}

void step_contact_add_energy(const StepContact *contact, ContactEnergy *sum)
{
    sum->dissipated += contact->dissipated;
    sum->friction += contact->friction;
    sum->elastic += contact->elastic;
}

void step_contact_raise(const StepContact *contact, JointPeak *top)
{
    if (contact->state.is_touching) {
        top->force = fmax(top->force, contact->peaks.force);
        top->depth = fmax(top->depth, contact->peaks.depth);
    }
}
