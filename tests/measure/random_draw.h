// Draws for random cases, and the groups of keys that every kind of case has.
#pragma once

#include <math.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

// Random numbers from a seed: the same on every machine.
typedef struct Draw {
    uint64_t state;
} Draw;

typedef struct Point {
    double x;
    double y;
} Point;

Draw draw_start(uint64_t seed);
double draw_between(Draw *draw, double low, double high);     // uniform
double draw_log_between(Draw *draw, double low, double high); // uniform in the logarithm
size_t draw_below(Draw *draw, size_t count);                  // 0 .. count - 1
bool draw_chance(Draw *draw, double probability);

// The sizes of a joint with play: radial clearance 1 to 500 um, width 5 to 30 mm; mostly centred,
// else a start anywhere in the play, or on the wall.
void draw_play(Draw *draw, FILE *file);

// contact: any law or stiffness, any damping, restitution .2 to .98, friction 0 or up to .3.
void draw_contact(Draw *draw, FILE *file);

// gravity and run: step auto, on the reference and ode; the length as given, e.g. "revolutions: 1".
void draw_run(Draw *draw, const char *length, FILE *file);

// A speed of the drive from 30 to 3000 rpm, either way.
double draw_speed_rpm(Draw *draw);

// Where two links meet that turn about two points: to the left of the line from a to b, or to the
// right. False where they do not reach.
bool draw_meet(Point a, double from_a, Point b, double from_b, bool is_left, Point *met);
