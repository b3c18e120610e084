// How a world's response to pushes changes within a step, as its bodies turn.
#pragma once

#include "world/world_response.h"

// Finds that from the responses in this step and in those before, and says so in the response. It
// stays as at mid-step where it is not known, where bounds may be passed, and where a pin turns
// about another axis than its own, with which the rows across it turn.
JpStatus response_rate_find(WorldResponse *response, double step, JpError *error);

// Writes what the contacts of the step have done to the speeds and positions of all bodies that
// move, six each, and the part of the speeds that comes of the rows' turning.
void response_rate_push(const WorldResponse *response, double *speeds, double *positions,
                        double *turned);
