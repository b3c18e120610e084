// How do flanks and stops of a joint's coordinate rebound in ODE, against the law of their contact?
//
// flank_impacts [FEWEST] [LEAST]
//   FEWEST  steps of a contact at least; each impact has up to ten times as many (default 10)
//   LEAST   restitution at least (default 0.2)
// 100 seeded impacts a scheme: of a hinge, of a slider and of a pair of gears in turns, with
// inertia, speed, stiffness, restitution and step at random. Prints how far the worst restitution,
// largest force and depth are off what the law gives. `impulse` takes steps of up to twenty
// contacts.
#include "limited_joint.h"

#include "contact/map_impact.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

typedef struct Scheme {
    const char *name;
    OdeStepping stepping;
    OdeMap map;
    OdeSolver solver;
} Scheme;

static const Scheme SCHEMES[] = {
    {"direct/plain/textbook", ODE_PLAIN, ODE_MAP_TEXTBOOK, ODE_DIRECT},
    {"direct/plain/corrected", ODE_PLAIN, ODE_MAP_CORRECTED, ODE_DIRECT},
    {"direct/staggered/midpoint", ODE_STAGGERED, ODE_MAP_MIDPOINT, ODE_DIRECT},
    {"quick/staggered/midpoint", ODE_STAGGERED, ODE_MAP_MIDPOINT, ODE_QUICK},
    {"direct/staggered/exact", ODE_STAGGERED, ODE_MAP_EXACT, ODE_DIRECT},
    {"direct/staggered/impulse", ODE_STAGGERED, ODE_MAP_IMPULSE, ODE_DIRECT},
};

enum { IMPACTS = 100, SCHEME_COUNT = sizeof SCHEMES / sizeof *SCHEMES };

int main(int argc, char **argv)
{
    const double fewest = argc > 1 ? atof(argv[1]) : 10.0;
    const double least = argc > 2 ? atof(argv[2]) : 0.2;
    printf("%-28s %12s %12s %12s\n", "scheme", "restitution", "force", "depth");
    for (size_t k = 0; k < SCHEME_COUNT; k++) {
        const Scheme *scheme = &SCHEMES[k];
        const bool is_impulse = scheme->map == ODE_MAP_IMPULSE;
        uint64_t random = lcg_stirred(7);
        LimitedOff worst = {0.0, 0.0, 0.0};
        for (int i = 0; i < IMPACTS; i++) {
            const LimitedImpact impact = limited_impact_draw(
                &random, (LimitedKind)(i % LIMITED_KINDS), is_impulse ? 0.05 * fewest : fewest,
                is_impulse ? 400.0 : 10.0, least);
            const LimitedOff off =
                limited_impact_run(&impact, scheme->stepping, scheme->map, scheme->solver);
            worst = limited_worse(worst, off);
        }
        printf("%-28s %12.2e %12.2e %12.2e\n", scheme->name, worst.restitution, worst.force,
               worst.depth);
    }
    return 0;
}
