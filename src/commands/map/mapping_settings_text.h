// The rows of a contact for people.
#pragma once

#include "base/text.h"
#include "commands/map/mapping_report.h"
#include "write/style.h"

// Appends the settings with their verdicts, what is wrong with those that are not valid, and what
// they deliver.
void mapping_settings_text_write(const MappingReport *report, const MappingContact *contact,
                                 const Style *style, Text *text);
