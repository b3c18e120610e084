// What `jointplay study --json` prints.
#pragma once

#include "commands/study/study_report.h"

#include <jansson.h>

json_t *study_json_build(const StudyReport *report);
