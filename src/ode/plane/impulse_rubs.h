// The friction of ideal joints in a step with contacts integrated inside it: each is a place of its
// own behind those at which bodies touch, whose rows are the joint's coordinate and nothing, and
// whose force the kernel finds from the joint's reaction (kernel/rubs.c). Of a joint that a drive
// turns nothing moves by it: it is booked once the step has been taken.
#pragma once

#include "contact/touch.h"
#include "kernel/step.h"
#include "model/response_drift.h"
#include "model/trajectory.h"

// The gap of such a place, m or rad, which no coordinate uses up in a step.
static const double IMPULSE_RUB_GAP = -1.0;

// The friction of a joint that is a place.
typedef struct ImpulseRub {
    int joint;
    size_t row;       // the first of its joint's two, among the ideal ones
    double weigh;     // 1/m, of a guide's couple: 2 over its length; of a pivot 1, N for N
    double before[2]; // its reaction in the step before, with what the impulses of that added
} ImpulseRub;

typedef struct ImpulseRubs {
    const Scenario *scenario;
    size_t count;
    ImpulseRub *rubs;  // owned, as the next
    double *answers;   // by rub and row of the kernel, two numbers each
    double *turning;   // likewise: how these change; zero without drift, as the next
    double *late;      // and what impulses add
    double *reactions; // by ideal row
    double *driven;    // likewise: those to what drives ask for
    double *unit;
    double *changes; // how the frictions grow with each other, and room
    Motion *motions; // room, by body, as the next two
    BodyLoad *loads; //
    double *speeds;  // three a body
} ImpulseRubs;

// Adds the places of a scenario's joints that rub and are not driven to a list, which has room for
// one of each joint; returns how many.
size_t impulse_rubs_list(const Scenario *scenario, Touch *places);

// What a kernel is given of such a place.
KernelContact impulse_rubs_contact(const Scenario *scenario, const Touch *place);

// Room, once the kernel and the response have all places; of the first the number is given.
void impulse_rubs_make(const Scenario *scenario, const Response *response, size_t first,
                       const Touch *places, Kernel *kernel, ImpulseRubs *rubs);
void impulse_rubs_finish(ImpulseRubs *rubs);
void impulse_rubs_carry(ImpulseRubs *rubs, const Kernel *kernel, Carry *carry);

// Before the response is placed anew: keeps the reactions of the step before, of which the impulses
// are given (NULL: there was none).
void impulse_rubs_keep(ImpulseRubs *rubs, const Kernel *kernel, const double *impulses);

// Finds what forces in the rows do to the reactions, by a response that has been placed, with drift
// (NULL: none). Returns -1, or the joint of which the friction has no single answer.
int impulse_rubs_respond(ImpulseRubs *rubs, const Response *response, const ResponseDrift *drift,
                         Kernel *kernel);

// Adds to what impulses do, of which the drift has been found, what springs' and other dampers do
// at the speeds that an impulse brings; the bodies are as given.
void impulse_rubs_damp(ImpulseRubs *rubs, const Response *response, const Motion *middle,
                       Kernel *kernel);

// Finds the reactions at mid-step, the bodies moving as given, and how they change since the middle
// of the step before, so many s ago; 0: that is not known.
void impulse_rubs_react(ImpulseRubs *rubs, const Response *response, const Motion *middle,
                        Vec2 gravity, const BodyLoad *loads, double since_s, Kernel *kernel);

// Adds what a place holds, N or N m, to what its joint does to its body b.
void impulse_rubs_add(const Linkage *linkage, const Touch *place, double held,
                      const Motion *motions, JointState *state);

// Adds the friction in the pivot of a drive, of which the force is known; returns the power that it
// takes, W.
double impulse_rubs_add_driven(const Scenario *scenario, size_t drive, const Motion *driven,
                               JointState *joints);
