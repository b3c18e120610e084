// The points of a comparison as a table of numbers: a row a scheme and step.
#pragma once

#include "commands/compare/compare_report.h"

// Writes the file, whole or not at all. A point that failed has its reason and no numbers.
// Numbers have 17 significant digits. ERR_FILE.
bool compare_csv_write(const CompareReport *report, const char *path, Err *err);
