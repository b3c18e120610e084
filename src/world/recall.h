// Answers to pushes that need not be found in every step, because they change with the bodies'
// motion alone.
#pragma once

#include "world/answer.h"

typedef struct Recall Recall;

void recall_free(Recall *recall);

// Fills in the answers of all active places from those of the steps before, where these are recent
// and of the same places, rows and bodies; says so in the answer.
void recall_columns(Answer *answer);

// Whether the world answered to a step as it was recalled to: where it did not, the steps to come
// are not recalled for a while.
void recall_note(JpWorld *world, bool is_promised);

// Keeps the answers of a step that have been found in it. Forgets all and returns false where there
// is no memory.
bool recall_keep(const Answer *answer);
