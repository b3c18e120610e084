// A case as a study asks it: which keys has it, what does each take, what follows from all of them.
#pragma once

#include "casefile/casefile.h"
#include "casefile/entries.h"
#include "casefile/units.h"

typedef struct Probe Probe;

// What stands behind a key.
typedef enum ProbeKind {
    PROBE_NUMBER, // a quantity, or a plain number
    PROBE_WHOLE,  // a whole number
    PROBE_WORD,   // one of some words, or a name that the case gives
    PROBE_OTHER,  // a place, a pair of bodies, a list, a text
} ProbeKind;

typedef struct ProbeKey {
    char path[CASEFILE_KEY_SIZE];
    const SchemaRow *row;
    size_t index;   // of the member of the row's family
    EntryPart part; // of its value, where that may be a sinusoid
    ProbeKind kind;
    JointKind joint_kind; // of a joint's key
} ProbeKey;

// A number as a case file would give it with its unit: SI, of a diameter the diameter.
typedef struct ProbeNumber {
    double value;
    char unit[CASEFILE_UNIT_SIZE]; // SI; N/m^1.5 of a stiffness, empty for a plain number
    const Unit *given;             // that the value is written with; NULL: none of the table
} ProbeNumber;

// Reads the text of a case, which must outlive the probe, as must the name that stands in messages.
// NULL where the text is no case or has a key that is wrong; values are only looked at later.
Probe *probe_open(const char *name, const char *text, size_t size, Err *err);

// Accepts NULL.
void probe_close(Probe *probe);

// In all of these the source is of another file than the case, whose key of a value is one of the
// case's: "drive.speed". Messages point into that file. Source and nodes must outlive the probe.

// Says otherwise than the case about a key: of that key, and of its rivals from another source.
// Two rivals from one source are an error.
bool probe_set(Probe *probe, const Source *source, const Node *value, Err *err);

// Which key stands at a value. Fails where the case knows no such key, or it is that of a group.
bool probe_key(const Probe *probe, const Source *source, const Node *value, ProbeKey *key,
               Err *err);

// Whether a value, which need not have a key of its own, is one that the key takes by itself: of
// its unit and in its range. Values that do not go together show in a scenario only.
bool probe_check(const Probe *probe, const Source *source, const ProbeKey *key, const Node *value,
                 Err *err);

// The number of a value that is checked. Fails on a length with a tolerance, and on a word that
// stands for a number.
bool probe_number(const Source *source, const ProbeKey *key, const Node *value, ProbeNumber *number,
                  Err *err);

// Whether the keys that are there make a whole case, whatever their values. Fails on a missing one.
bool probe_is_whole(const Probe *probe, Err *err);

// The kind of a joint by the keys that are given of it.
JointKind probe_joint_kind(const Probe *probe, size_t joint);

// The scenario of the case with all that was set.
bool probe_scenario(const Probe *probe, Scenario *scenario, Err *err);
