// A mapping as CSV: a row a contact, map and step.
#pragma once

#include "commands/map/mapping_report.h"

// Writes the file, whole or not at all. ERR_FILE.
bool mapping_csv_write(const MappingReport *report, const char *path, Err *err);
