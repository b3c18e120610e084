// The cases, studies and baselines that came with the program: found from any folder.
//
// They stand in ../share/jointplay as seen from the program's own folder, below the names that they
// have in the sources: cases/paper/stackup-impact.yaml, results/baseline.
#pragma once

#include <stdbool.h>
#include <stddef.h>

// Where the file or folder of a path is. `found` becomes the path itself where something is there,
// or where nothing is anywhere; else what stands below the program's data under that path or, for a
// bare name without an ending such as "stackup-impact", in one of the folders of cases. True where
// it is one of those that came with the program. A path that does not fit counts as not there.
bool shipped_find(const char *path, char *found, size_t size);

// The same, whatever stands here: only what came with the program is looked for.
bool shipped_find_own(const char *path, char *found, size_t size);
