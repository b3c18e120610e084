// Random cases from a seed, for measurements on mechanisms that nobody tuned anything for: written
// to a stream as YAML, one kind of mechanism a file.
#pragma once

#include <stdint.h>
#include <stdio.h>

typedef struct CaseKind {
    const char *name;
    const char *summary;
    void (*write)(uint64_t seed, FILE *file);
} CaseKind;

extern const CaseKind CASE_FOUR_BAR;
extern const CaseKind CASE_BODIES;
extern const CaseKind CASE_SPRUNG;
extern const CaseKind CASE_SLIDERS;
extern const CaseKind CASE_BALLS;
extern const CaseKind CASE_LIMITS;
extern const CaseKind CASE_ROTORS;
extern const CaseKind CASE_RACKS;
extern const CaseKind CASE_GEARS;
extern const CaseKind CASE_CAMS;
extern const CaseKind CASE_SLOTS;
extern const CaseKind CASE_HOLES;
extern const CaseKind CASE_GROWING;
extern const CaseKind CASE_RUN_UPS;
extern const CaseKind CASE_SERVOS;
extern const CaseKind CASE_SPACE;
extern const CaseKind CASE_SPACE_DRIVEN;

extern const CaseKind CASE_PENDULA;
extern const CaseKind CASE_FOUR_BARS;
extern const CaseKind CASE_LOCK;
extern const CaseKind CASE_CHANGE_POINT;
extern const CaseKind CASE_TOUCHING;
extern const CaseKind CASE_SEPARATING;
