// How hard a contact presses: its law in the mode that it is in, as a function of depth and closing
// speed alone. The same in the plane and in space.
//
//     N = F_el(d) (1 + chi d'/v0) + c d'
#pragma once

#include "kernel/force_law.h"

#include <math.h>
#include <stdbool.h>

// What a contact is doing. It changes at events only.
typedef enum ContactMode {
    CONTACT_APART,    // the pin is within its play
    CONTACT_PRESSING, // it overlaps the wall and is pressed
    CONTACT_SLACK,    // it overlaps the wall, but leaves it faster than the spring follows
} ContactMode;

typedef struct Contact {
    int joint;
    int partner; // of a limited coordinate: by how many contacts the one at its other end comes
                 // later; 0: there is none
    ForceLaw law;
    double clearance;   // m, radial, or of a collar in space axial; 0 of a stop
    double arm;         // m, by which an angle counts as a length and a torque as a force; 1 of
                        // what is a length already
    double flight;      // m, by which it may come nearer between two looks while it is apart
    double hole_radius; // m, of a pin in space
    bool is_collar;     // of a pin in space: it stops the pin along its axis
    ContactMode mode;
    double onset_s;      // when the contact under way began
    double impact_speed; // m/s, closing speed when the contact under way began
    double damping_rate; // s/m, chi / v0 of it, v0 not below the law's floor
} Contact;

// A contact's force along its normal at one instant.
typedef struct Press {
    double depth;          // m, negative in the free play
    double closing;        // m/s, rate of the depth
    double elastic;        // N, of the law's spring, continued as an odd function below zero depth
    double normal;         // N, what presses in the present mode
    double pressing;       // N, what would press in the pressing mode, not clamped at zero
    double release;        // turns negative where a pressing contact goes slack
    double damping_power;  // W, lost along the normal
    double friction_power; // W, lost in sliding; friction is added by who knows the geometry
} Press;

// What the law of a contact makes of a depth and its rate.
static inline Press press_find(const Contact *contact, double depth, double closing)
{
    const ForceLaw *law = &contact->law;
    Press press = {.depth = depth, .closing = closing};
    if (contact->mode == CONTACT_APART) {
        return press;
    }
    // odd below zero depth: a step that overshoots the end of a contact stays smooth
    press.elastic = copysign(force_law_elastic(law, fabs(depth)), depth);
    const double rise = 1.0 + contact->damping_rate * closing;
    press.pressing = press.elastic * rise + law->viscous * closing;
    press.release = law->viscous > 0.0 ? press.pressing : rise;
    // a slack spring relaxes by itself: what it had stored is lost like the damper's work
    press.normal = contact->mode == CONTACT_PRESSING ? press.pressing : 0.0;
    press.damping_power = (press.normal - press.elastic) * closing;
    return press;
}

// How strongly a contact is damped, N s/m.
static inline double press_damping(const Contact *contact, const Press *press)
{
    return press->elastic * contact->damping_rate + contact->law.viscous;
}

// The rate of the normal force, N/s, of a contact that presses, from the second rate of its depth.
static inline double press_rate(const Contact *contact, const Press *press, double second)
{
    const double rise = 1.0 + contact->damping_rate * press->closing;
    return force_law_tangent(&contact->law, press->depth) * press->closing * rise +
           press_damping(contact, press) * second;
}
