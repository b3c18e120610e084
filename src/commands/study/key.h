// What makes the rows of a store those of one study and one program, so that results never mix.
//
// The machine is no part of it, for shards are made on many; nor are the limits, which decide
// whether a run comes to its end, and not to which.
#pragma once

#include "commands/study/spec.h"
#include "commands/study/store.h"
#include "write/build_print.h"

enum { KEY_PRINT_SIZE = 17 };

typedef struct StudyKey {
    StoreHead head; // points into this StudyKey, which must not be moved, and at the layout
    char print[KEY_PRINT_SIZE];
    char build[BUILD_PRINT_SIZE];
} StudyKey;

void key_make(const Spec *spec, const Layout *layout, StudyKey *key);
