// Worlds of the library at random: bodies, ODE's joints and the library's, from a seed.
#pragma once

#include <jointplay/jointplay.h>

#include <stdint.h>

enum { RANDOM_BODIES = 12, RANDOM_PLAYS = 24, RANDOM_SIDES = 4 };

// A joint with play, and what its peaks are held against.
typedef struct RandomPlay {
    JpJoint *joint;
    JpContact contact;
    bool is_pin;
    double rotor_inertia; // 0: no rotor
    bool is_driven;       // its rotor, while the world is not passive
    dBodyID bodies[2];    // of a pin: the hole's and the pin's; NULL is the world
    double point[3];      // m, of the pin in its body's frame
    double width;         // m, of the pin
} RandomPlay;

typedef struct RandomWorld {
    dWorldID world;
    JpWorld *play;
    dBodyID bodies[RANDOM_BODIES];
    size_t body_count;
    RandomPlay plays[RANDOM_PLAYS];
    size_t play_count;
    double step;      // s
    double resolved;  // s: longer steps are too long for rows
    bool is_wild;     // of sizes that nobody builds
    bool is_plain;    // of sizes that are neither wild nor too stiff for the step
    bool is_sticking; // pins without a width have friction that sticks
    bool is_rubbing;  // hinges and sliders have friction
    size_t rub_count; // joints that were given some
    bool is_passive;  // nothing drives it and nothing rubs: its energy cannot grow
    uint64_t random;  // goes on with drives
} RandomWorld;

// Of every three worlds one is passive, of every five one is wild; in every second one with
// impulses friction of pins sticks where it can, and in one of four that are not passive joints
// have friction. With rows, the others are stepped so that their contacts are resolved, but for one
// of four, which is as stiff as it comes. No world is refused: what the library refuses to make is
// left out.
RandomWorld random_world(unsigned number, JpStepping stepping);
void random_world_finish(RandomWorld *made);

// Moves the rotors that are driven.
void random_world_drive(RandomWorld *made);

// J: of bodies, rotors, gravity and what is stored in contacts.
double random_world_energy(const RandomWorld *made);

// J, stored in contacts.
double random_world_stored(const RandomWorld *made);

// J, of bodies and rotors.
double random_world_kinetic(const RandomWorld *made);

// The sides of a joint, and how fast each can close as the bodies go, m/s or rad/s.
size_t random_world_sides(const RandomPlay *of, JpSide sides[RANDOM_SIDES], double *closing);

// Of the contact's force what one of its sides takes.
double random_world_share(const RandomPlay *of, size_t side);
