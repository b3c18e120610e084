// The ends of limited coordinates in ODE's world: where angles and teeth stand.
#pragma once

#include "contact/touch.h"

#include <ode/ode.h>

// What the world knows of its bodies with limited angles, or teeth.
typedef struct WorldEnds {
    const Linkage *linkage;
    const dBodyID *bodies; // of the world
    Motion *motions;       // of those bodies when last looked at; angles not wrapped; owned
    bool *is_followed;     // by body; owned
} WorldEnds;

// Makes the ends of a world whose bodies stand in the motions given; NULL where no joint limits an
// angle and there are no teeth. For ends_free.
WorldEnds *ends_make(const Linkage *linkage, const dBodyID *bodies, const Motion *motions);
void ends_free(WorldEnds *ends);

// How the bodies of a joint move now; other bodies' motions are not up to date.
const Motion *ends_look(WorldEnds *ends, int joint);

// An angle of a body that is known in one turn, with the turns it has made; without ends, or of
// other bodies, the angle as it is.
double ends_count_turns(const WorldEnds *ends, size_t body, double angle);
