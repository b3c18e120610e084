// Starts of a mechanism that differ by what its play allows.
#pragma once

#include "run/settling.h"

// Gives a scenario another start: every pin and block anywhere in its play, every limited
// coordinate and stop anywhere in its gap (where that has no end as far as the motion goes), and
// relative speeds up to those that cross the play within a revolution or with which the motion
// closes it. Numbers give other starts, spread evenly (low discrepancy); `number` counts from 0 of
// `count`. `reach` is how far some motion of it goes, by joint. False where there is none without
// bodies that overlap.
bool settle_draw(Scenario *scenario, const SettleReach *reach, size_t number, size_t count);
