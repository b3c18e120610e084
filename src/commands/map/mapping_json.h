// A mapping as one JSON object, for other programs.
#pragma once

#include "commands/map/mapping_report.h"

#include <jansson.h>

// New reference. Keys as docs/output.md lists them.
json_t *mapping_json_build(const MappingReport *report);

// Mean, least and most of a figure over the phases; the caller owns the object.
json_t *mapping_spread_object(const ImpactSpread *spread);
