// The instants of a contact that a picture must not miss, whatever its samples show.
#pragma once

#include "base/vec2.h"

#include <stdbool.h>
#include <stddef.h>

enum { MARKS_MOST = 16 }; // of a contact

typedef enum ContactMarkKind {
    CONTACT_MARK_ONSET,
    CONTACT_MARK_PEAK,
    CONTACT_MARK_DEEPEST,
    CONTACT_MARK_BETWEEN,
    CONTACT_MARK_END
} ContactMarkKind;

// A joint in contact at one instant, like JointState.
typedef struct ContactMark {
    ContactMarkKind kind;
    double time_s;
    Vec2 eccentricity; // m
    Vec2 force_on_b;   // N
    double force;      // N; of a joint whose limits turn it N m
    double gap;        // m or rad; NAN: not known at that instant
    double alpha_a;    // rad/s^2, of the joint's first body; NAN: not known, or the ground
    double alpha_b;    // likewise of its second
} ContactMark;

// One contact, or the part of it on one side of the time from which a run is reported.
typedef struct MarkedContact {
    size_t joint;
    bool is_reported;
    double force_max; // N
    double depth_max; // m
    size_t count;
    ContactMark marks[MARKS_MOST]; // in the order of time
} MarkedContact;
