// The moments at which a joint with play changes what it is doing.
#pragma once

#include "quad_step.h"

typedef enum QuadEventKind {
    QUAD_EVENT_NONE,
    QUAD_EVENT_ONSET,   // the pin meets the wall
    QUAD_EVENT_END,     // it leaves it
    QUAD_EVENT_CLAMP,   // the damping would begin to pull: the force ends with d > 0
    QUAD_EVENT_UNCLAMP, // and would no longer
} QuadEventKind;

typedef struct QuadEvent {
    QuadEventKind kind;
    size_t joint;
    Quad x; // of the step, 0 to 1
} QuadEvent;

// The first event in the solved step, all joints taken together.
QuadEvent quad_event_first(const QuadStep *step);

// Makes the step anew, from a first guess of its length, until it ends on the event to the last
// digits. Returns false where it cannot.
bool quad_event_meet(QuadStep *step, QuadMap map, Quad length_s, const QuadEvent *event);
