// Stores of studies as somebody who means harm would hand them on.
#pragma once

#include "random_draw.h"

// Changes a store by a statement of SQL, or puts a journal beside it that SQLite would take for one
// of a write that was cut short. 0, also where there is no store.
int random_store_damage(Draw *draw, const char *path);
