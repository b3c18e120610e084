// The files that `jointplay map` leaves behind.
#pragma once

#include "commands/map/map_options.h"
#include "commands/map/mapping_report.h"

// Whether all of that can be written, before anything runs. Leaves nothing behind; the folder is
// there. ERR_FILE.
bool map_files_claim(const Scenario *scenario, const MapOptions *options, Err *err);

// Writes what the options name: the rows, the picture, the folder. ERR_FILE.
bool map_files_write(const MappingReport *report, const MapOptions *options, Err *err);
