// How a picture of a study names a column, and in which unit and on which scale it shows it.
#pragma once

#include "commands/study/spec.h"

enum { STUDY_LABEL_SIZE = 2 * RECORD_NAME_SIZE };

typedef struct StudyLabel {
    char words[STUDY_LABEL_SIZE];  // "radial clearance of crank-coupler"
    char unit[CASEFILE_UNIT_SIZE]; // empty where there is none
    double per_si;                 // what a value in SI is multiplied by
    bool is_linear;                // the study spreads its values evenly, or
    bool is_log;                   // evenly in their logarithm; neither: as the values ask for
} StudyLabel;

// Of a column of a store. With the study (or NULL) the words of a setting are those of its key, and
// the unit is that of its values in the study file; without, they are made of the column's name.
StudyLabel study_label(const Layout *layout, const Spec *spec, size_t column);
