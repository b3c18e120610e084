// Why can a motion not be followed?
//
// Masses, kg, and inertias, kg m^2, stand in one matrix. Where one of them is less than 1e-14 of
// another, elimination takes it for rounding (base/dense.h).
#include "reference/refusal.h"

#include <math.h>

static const double TOLD_APART = 1e14;

bool refusal_undetermined(const Linkage *linkage, Err *err)
{
    const Body *heaviest = NULL;
    const Body *lightest = NULL;
    for (size_t i = 0; i < linkage->body_count; i++) {
        const Body *body = &linkage->bodies[i];
        if ((int)i == linkage_driven_body(linkage)) {
            continue;
        }
        heaviest = heaviest == NULL || body->mass > heaviest->mass ? body : heaviest;
        lightest = lightest == NULL || body->inertia < lightest->inertia ? body : lightest;
    }
    if (heaviest != NULL && heaviest->mass > 0.1 * TOLD_APART * lightest->inertia) {
        return err_set(err, ERR_SOLVER,
                       "the accelerations are not determined: the mass of %s, %.3g kg, and the "
                       "inertia of %s, %.3g kg m^2, are further apart than a double has digits "
                       "for; allowed: a ratio below 1e13",
                       heaviest->name, heaviest->mass, lightest->name, lightest->inertia);
    }
    return err_set(err, ERR_SOLVER,
                   "the accelerations are not determined: the ideal joints stand at a change "
                   "point, or hold each other up; give one of them play, or start elsewhere");
}
