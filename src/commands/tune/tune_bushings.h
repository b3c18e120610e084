// Bushings in the programs against libjointplay that tune writes, and in the world it measures.
#pragma once

#include "base/text.h"
#include "model/linkage.h"

#include <jointplay/jointplay.h>

// Why the program cannot have the bushings of a linkage, as a sentence that ends without a full
// stop; NULL where it can.
const char *tune_bushings_lack(const Linkage *linkage);

// Append what holds them, what makes them, and what lets them push where a step evaluates forces.
void tune_bushings_write_functions(const Linkage *linkage, Text *text);
void tune_bushings_write_making(const Linkage *linkage, Text *text);
void tune_bushings_write_pushing(const Linkage *linkage, Text *text);

// The same in a world: a bushing's rows of dampers along its axes, NULL where it has none, and what
// it does in a step. Bodies are NULL for the ground.
typedef struct TuneBushing {
    dJointID rows[2];
    dBodyID a;
    dBodyID b;
} TuneBushing;

TuneBushing tune_bushing_make(dWorldID world, const Bushing *bushing, dBodyID a, dBodyID b);
void tune_bushing_push(const Linkage *linkage, const Bushing *bushing, const TuneBushing *made,
                       double step_s);
