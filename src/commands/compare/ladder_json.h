// The runs of a ladder as lines of a store, and back.
#pragma once

#include "measure/ladder.h"

#include <jansson.h>

// New reference: what must be equal for a stored run to count. The build is a fingerprint of the
// program.
json_t *ladder_json_key(const Ladder *ladder, const Scenario *scenario, const char *build);

// New references, a line each. Times carry the machine they were taken on.
json_t *ladder_json_truth(const LadderTruth *truth);
json_t *ladder_json_run(const Ladder *ladder, const LadderRun *run, const char *machine);
json_t *ladder_json_ensemble(const Ladder *ladder, const Linkage *linkage, size_t scheme,
                             const LadderEnsemble *ensemble);

// What became of a line that was taken.
typedef enum LadderJsonTaken {
    LADDER_JSON_TAKEN,
    LADDER_JSON_UNUSED,        // not of this ladder, or there already
    LADDER_JSON_OTHER_MACHINE, // a time of another machine
    LADDER_JSON_DAMAGED,       // a key is missing or has a value of another type
} LadderJsonTaken;

// Adds a line to the ladder; one that is damaged leaves it as it was.
LadderJsonTaken ladder_json_take(Ladder *ladder, const Linkage *linkage, const json_t *line,
                                 const char *machine);
