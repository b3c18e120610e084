// Responses to pushes that need not be found in every step, because they change with the bodies'
// motion alone.
#pragma once

#include "world/world_response.h"

typedef struct ResponseCache ResponseCache;

void response_cache_free(ResponseCache *cache);

// Fills in the responses of all active places from those of the steps before, where these are
// recent and of the same places, rows and bodies; says so in the response.
void response_cache_fill(WorldResponse *response);

// Writes how the responses of all active places change with time at mid-step, from what they are
// there and in the steps before. Returns false where nothing is known of these.
bool response_cache_rates(WorldResponse *response);

// Notes whether the world responded to a step as the cache had promised: where it did not, the
// steps to come find their responses anew for a while.
void response_cache_note(JpWorld *world, bool is_promised);

// Keeps the responses of a step that have been found in it. Forgets all and returns false where
// there is no memory.
bool response_cache_keep(const WorldResponse *response);
