// Random cases whose settled motion is known from outside: the sizes of a case, drawn from a seed
// or taken from a list by name, how it is written as a case file, and nothing of the program.
//
// Every size is rounded to a few decimal digits before anyone sees it, so that case file and truth
// have the same numbers.
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

enum { SETTLED_CASES = 60, SETTLED_POINTS = 30, SETTLED_NAME = 32 };

typedef enum SettledKind {
    SETTLED_CAM,          // eccentric disc under a flat follower with a spring
    SETTLED_ARM,          // arm on a stop by its weight, or rotor between stops, under a load
    SETTLED_BEAM,         // mass on a spring beside a stop, under a load
    SETTLED_GEARS,        // two gears, the first driven with a transmission error
    SETTLED_PIVOT,        // backlash between a rotor that is driven with a ripple and its output
    SETTLED_COUPLER_PIN,  // four-bar, play between crank and coupler
    SETTLED_FOLLOWER_PIN, // four-bar, play between coupler and follower
    SETTLED_CRANK_PIN,    // slider-crank, play between crank and rod
    SETTLED_WRIST_PIN,    // slider-crank, play between rod and slider
} SettledKind;

// A function that repeats: a load, or the angle of a drive.
typedef struct SettledTable {
    size_t count;
    bool is_smooth;                // of a load: Fritsch and Butland's cubic; else linear
    double at[SETTLED_POINTS];     // s, the first 0, all below the period
    double values[SETTLED_POINTS]; // N, N m or rad
} SettledTable;

typedef struct SettledLink {
    double length;  // m
    double mass;    // kg
    double inertia; // kg m^2, about the middle of the link
} SettledLink;

typedef struct SettledCase {
    char name[SETTLED_NAME];
    SettledKind kind;
    double period;  // s, of drive or load
    double speed;   // rpm, of cams and linkages
    double gravity; // m/s^2, downward

    // contact
    double stiffness;   // N/m, N m/rad or N/m^1.5; 0: the law hertz-socket
    double restitution; // 1: no damping
    double clearance;   // m, radial, of pins
    double pin;         // m, diameter
    double hole;        // m, diameter
    double low;         // m or rad, stops and flanks; -infinite where there is none
    double high;        // m or rad

    // one coordinate
    double mass;          // kg, of what moves
    double inertia;       // kg m^2, of what turns, about its centre of mass
    double reach;         // m, of an arm's centre of mass from the hinge
    double start;         // rad, of an arm at time zero
    double damping;       // N s/m or N m s/rad
    double spring;        // N/m
    double spring_length; // m, relaxed, of a cam's follower
    double load;          // N m, constant
    double eccentricity;  // m, of a cam
    double radius;        // m, of a cam
    double distance;      // m, of the gears' axes
    int teeth[2];
    SettledTable table; // drive angle of gears and pivots, else load

    // linkages
    double offset;       // m, of a slider's line
    double ground;       // m, of a four-bar
    SettledLink crank;   // its mass is carried by the drive
    SettledLink coupler; // or rod
    SettledLink last;    // follower; of a slider its mass and inertia
} SettledCase;

// A random case, number 1 to SETTLED_CASES: 1 to 20 cams, arms and beams, to 40 gears and pivots,
// to 60 linkages.
SettledCase settled_case_draw(uint64_t seed, int number);

// A case that is known elsewhere: A, B, C, G, or D300 to D2400. False where there is none.
bool settled_case_named(const char *name, SettledCase *found);

// Writes it as a case file.
void settled_case_write(const SettledCase *sizes, FILE *file);

// Seeded random numbers: splitmix64 (Steele, Lea and Flood, OOPSLA 2014).
typedef struct SettledDraw {
    uint64_t state;
} SettledDraw;

SettledDraw settled_draw_start(uint64_t seed, uint64_t stream);
// Uniform in [low, high).
double settled_draw(SettledDraw *draw, double low, double high);
