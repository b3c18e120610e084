// What happens where the program has no memory: one sentence, and the status of a run that failed.
#pragma once

// From now on. Call it first of all.
void no_memory_begin(void);
