// The maps by the names that callers have for them.
#pragma once

#include "contact/map.h"
#include "world/refusal.h"

// Fails where there is no such map.
JpStatus mapping_of(JpMap kind, const Map **map, JpError *error);
