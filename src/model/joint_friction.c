// Finds the friction of ideal joints, and holds its defaults.
#include "model/joint_friction.h"

// A bearing of a usual hand-held or table-top mechanism: it only says how a speed and a bend at the
// pin count as angles.
const double JOINT_FRICTION_RADIUS = 1e-2;

// Junctions of steel break away after some 2 to 5 um (Armstrong-Helouvry, Dupont, Canudas de Wit,
// Automatica 30 (1994) 1083).
const double JOINT_FRICTION_PRESLIDING = 5e-6;

int joint_friction_first(const Linkage *linkage)
{
    for (int i = 0; i < (int)linkage->joint_count; i++) {
        if (joint_friction_is(&linkage->joints[i])) {
            return i;
        }
    }
    return -1;
}
