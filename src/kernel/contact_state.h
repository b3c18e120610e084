// What a contact carries from one step to the next: all of its past that its force depends on. Whoever
// owns a contact can save it and set it, and start a run with it.
#pragma once

#include <stdbool.h>

typedef struct ContactState {
    bool is_touching;
    bool is_slack;       // it overlaps, but leaves its wall faster than its spring follows
    double impact_speed; // m/s, closing speed where the contact began; rad/s at an angle
    double age_s;        // s, since then
} ContactState;
