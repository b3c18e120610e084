// Restitution and peak force of one impact against the steps in its contact, by map.
//
// Each figure is over the law's own and a mean over 16 phases: where the steps fall by accident.
#include "one_impact.h"

#include "model/options.h"

#include <stdio.h>

static const double STEPS_A_CONTACT[] = {1000.0, 300.0, 100.0, 30.0, 10.0, 5.0};
enum { ROWS = sizeof STEPS_A_CONTACT / sizeof *STEPS_A_CONTACT };

static void print_map(const char *law, const Scenario *scenario)
{
    const double contact_s = one_impact_duration(scenario);
    const double restitution = one_impact_law_restitution(scenario);
    const double force_N = one_impact_law_force(scenario);
    for (int i = 0; i < ROWS; i++) {
        const OneImpact impact = one_impact_run(*scenario, contact_s / STEPS_A_CONTACT[i]);
        printf("%-8s %-10s %-10s %6g %12.5f %12.5f%s\n", law, OPTIONS_ODE_MAPS[scenario->ode.map],
               OPTIONS_ODE_STEPPINGS[scenario->ode.stepping], STEPS_A_CONTACT[i],
               impact.restitution / restitution, impact.force_max / force_N,
               impact.is_single ? "" : "  more than one contact");
    }
}

int main(void)
{
    printf("%-8s %-10s %-10s %6s %12s %12s\n", "law", "map", "stepping", "Tc/h", "restitution",
           "peak force");
    for (int map = ODE_MAP_TEXTBOOK; map <= ODE_MAP_IMPULSE; map++) {
        const Scenario linear = one_impact_linear((OdeMap)map, 0.9);
        print_map("linear", &linear);
    }
    for (int map = ODE_MAP_TEXTBOOK; map <= ODE_MAP_IMPULSE; map++) {
        const Scenario hertz = one_impact_hertz((OdeMap)map, DAMPING_LANKARANI_NIKRAVESH, 0.9);
        print_map("hertz", &hertz);
    }
    return 0;
}
