// What a contact carries from one step to the next: all of its past that its force depends on.
// Whoever owns a contact can save it and set it, and start a run with it.
//
// Hysteretic damping divides by the speed at which its contact began, F = F_el (1 + chi d'/v0). A
// contact that is compressed, released and compressed again has outlasted its impact. Where a law
// has a resting speed, v0 is that from there on: the force has no jump, for d' is zero there, and
// what lasts does not depend on an impact of long ago.
#pragma once

#include <stdbool.h>

typedef struct ContactState {
    bool is_touching;
    bool is_slack;        // it overlaps, but leaves its wall faster than its spring follows
    bool is_released;     // it has moved out of its wall since it began
    bool is_resting;      // and has come back: its impact is over
    double impact_speed;  // m/s, closing speed where the contact began; rad/s at an angle
    double damping_speed; // m/s, v0 in the damping: that, or the law's resting speed
    double age_s;         // s, since then
    double bend;          // m, or rad, of the bristle of its friction (kernel/bristle.h)
} ContactState;

// One that begins with a closing speed.
static inline ContactState contact_state_begun(double speed)
{
    // every member in its order: C++ knows no other way
    return (ContactState){
        .is_touching = true,
        .is_slack = false,
        .is_released = false,
        .is_resting = false,
        .impact_speed = speed,
        .damping_speed = speed,
        .age_s = 0.0,
        .bend = 0.0,
    };
}

// Lets the impact of a contact be over.
static inline void contact_state_rest(ContactState *state, double resting_speed)
{
    state->is_resting = true;
    state->damping_speed = resting_speed;
}

// Follows a contact that touches at a step's end, where it closes at that speed; a resting speed of
// 0 is none. Returns whether its impact is over there.
static inline bool contact_state_follow(ContactState *state, double closing, double resting_speed)
{
    if (!(resting_speed > 0.0) || state->is_resting) {
        return false;
    }
    if (state->is_released && closing >= 0.0) {
        contact_state_rest(state, resting_speed);
        return true;
    }
    state->is_released = state->is_released || closing < 0.0;
    return false;
}
