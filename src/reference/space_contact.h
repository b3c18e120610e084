// The forces at the places where a pin in space presses on its hole, in the coordinates of a tree.
#pragma once

#include "contact/pin_space.h"
#include "reference/press.h"
#include "reference/space_tree.h"

// A place at the base of the tree.
typedef struct SpaceContact {
    PinSpace place; // of a pin; of an end of a limited angle its joint alone
    bool is_turn;   // whether it is one
    double sign;    // 1 of its low end, -1 of its high one
    double limit;   // rad, where that is
    Vec3 base_hole; // m, from the centre of body a to the place's point of the hole
    Vec3 base_pin;  // m, from the centre of body b to that point of the pin's axis which is nearest
                    // to it; of a collar to the pin's middle
    Vec3 base_axis; // of the pin; of a collar of the hole
    Vec3 base_gap;  // m, the pin's point less the hole's
} SpaceContact;

// A place at one instant.
typedef struct SpaceForce {
    Press press;
    Vec3 offset;   // e, m
    double size;   // m, |e|
    Vec3 outward;  // e / |e|; zero of a centred pin
    Vec3 axis;     // of the pin; of a collar of the hole
    Vec3 from_a;   // m, from body a's centre to the hole's point O, of a collar to M
    Vec3 from_b;   // m, from body b's centre to the axis' point P, of a collar to M
    Vec3 relative; // m/s, velocity of body b there less that of body a
    Vec3 force_a;  // m, from the bodies' centres to where the force acts on them, on its line
    Vec3 force_b;
    Vec3 force;  // N, on the pin, friction included
    Vec3 couple; // N m, on body b, of an end of a limited angle
} SpaceForce;

// The ends of a limited angle as contacts (reference/space_turn.c): which they are of a joint, each
// with its law; how many. The pose and the rest are found by the functions below.
size_t space_turn_list(const Scenario *scenario, const SpaceTree *tree, int joint,
                       SpaceContact *contacts, Contact *laws, Err *err);

// The angle of a limited joint, rad, its rate and its second rate.
double space_turn_angle(const SpaceTree *tree, const SpaceTreeState *state, int joint);
double space_turn_rate(const SpaceTree *tree, const SpaceTreeState *state, int joint);
double space_turn_second(const SpaceTree *tree, const SpaceTreeState *state, int joint);

// What an end presses with.
void space_turn_find(const SpaceContact *at, const Contact *contact, const SpaceTree *tree,
                     const SpaceTreeState *state, SpaceForce *force);

// Puts a place at the base of the tree.
void space_contact_rebase(const SpaceTree *tree, SpaceContact *contact);

// A place's quantities from the state of the tree. The mode is that of `contact`, the law's.
void space_contact_find(const SpaceContact *at, const Contact *contact, const SpaceTreeState *state,
                        SpaceForce *force);

// The second rate of the depth, m/s^2, of a place whose bodies have accelerations.
double space_contact_second(const SpaceContact *at, const SpaceTreeState *state,
                            const SpaceForce *force);
