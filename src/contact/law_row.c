// Makes ERP and CFM of a contact in a step.
//
// k = F(d) / d, c = D(d, v0) - c_v (1 - share): in a step in which the contact begins or ends, what
// damps at the wall already, c_v, acts for a part (contact/overlap.h). A map is stable below its
// limit of omega h, omega^2 = (dF/dd) / m.
#include "contact/law_row.h"

#include <math.h>

MapContact law_row_contact(const ForceLaw *law, const LawRow *row, double step_s)
{
    const double damping = force_law_damping(law, row->depth, row->impact_speed);
    return (MapContact){
        .stiffness = force_law_secant(law, row->depth),
        .damping = damping - force_law_viscous(law, 0.0) * (1.0 - row->share),
        .step = step_s,
        .mass = row->mass,
        .depth = row->depth,
        .closing = row->closing,
    };
}

bool law_row_is_stable(const Map *map, double slope_by_mass, double step_s)
{
    return sqrt(slope_by_mass) * step_s < map->stability_limit;
}

ErpCfm law_row_soft(const Map *map, bool falls_back, const MapContact *contact)
{
    return (falls_back ? map_get(ODE_MAP_TEXTBOOK) : map)->convert(contact);
}
