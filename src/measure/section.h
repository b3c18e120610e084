// The sections of a run (Poincare's): its state once a revolution, always at one crank angle, and
// after how many revolutions it comes back.
//
// A revolution is a period of the drive (linkage_period): of one of constant speed a turn; without
// such a drive a period of all that acts (model/common_period.h).
#pragma once

#include "model/trajectory.h"

// revolutions after which a motion is seen to repeat, at most
enum { SECTION_PERIOD_MAX = 12 };

// 1: what two sections of one motion differ by at most, of the fastest point of all bodies: the
// five digits that a settled motion is told by (docs/settled.md)
extern const double SECTION_TOLERANCE;

typedef struct Sections {
    size_t count;         // 0: there is no drive with a period, or no sample where it ends
    size_t first;         // sample of the first section: the first one that is reported
    size_t stride;        // samples from one section to the next
    bool is_period_known; // there are two revolutions or more: a period takes twice as many
    size_t period;        // revolutions after which the run repeats; 0: it has not within its
                          // revolutions
    double change;        // 1: by how much sections of a period apart differ in the last one, or
                          // where none repeats the least of any period; NAN where none is known
} Sections;

Sections section_find(const Trajectory *run);

// The sample that a section stands at.
static inline size_t section_sample(const Sections *sections, size_t number)
{
    return sections->first + number * sections->stride;
}

// After how many revolutions a run repeats; 0: it has not. NAN of too few revolutions to tell.
double section_period(const Trajectory *run);

// The angular velocity of a body at the end of a whole revolution, rad/s: 0 is the last, 1 the one
// before it. NAN where there is none.
double section_omega(const Trajectory *run, size_t body, size_t before);

// The joint by which a body slides on the ground, of a prismatic joint or guides; -1: it turns.
int section_slider(const Linkage *linkage, size_t body);

// The same of the velocity of a body that slides, along its line, m/s.
double section_slide(const Trajectory *run, size_t body, size_t before);

// The largest difference of the velocities of all bodies' points at two samples, m/s.
double section_difference(const Trajectory *run, size_t a, size_t b);
