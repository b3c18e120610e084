// The equations of motion of a random case in closed form, in coordinates of its own.
//
// One coordinate x against a wall that moves as w(t), with u = x + w
//     M x'' = Q(t) - k (u - u0) - c u' - c_rel x' - G cos(u) + N_low - N_high - M w''
// (x and not u: a step is then as long as the contact asks for, however far the wall moves)
// Two coordinates q of a linkage whose joint with play is cut open, e (m) from hole to pin
//     M(q) q'' = Q(q, q') + J^T f,   e' = J q' + e_t,   e'' = J q'' + b
// with f the force on the pin.
#pragma once

#include "settled_case.h"

enum { MODEL_STATES = 4, MODEL_CONTACTS = 2 };

typedef struct ModelWall {
    double mass;                     // M, kg or kg m^2
    double spring;                   // k, N/m
    double rest;                     // u0, m
    double damping;                  // c, N s/m or N m s/rad
    double relative;                 // c_rel, likewise, against the wall
    double push;                     // N or N m, constant part of Q
    double weight;                   // G, N m
    double amplitude;                // m, of w = -amplitude cos(omega t), of a cam
    double omega;                    // rad/s
    double gain;                     // w over the angle of the table; 0: the table is a load
    double low, high;                // of x
    size_t pieces;                   // of the table
    double at[SETTLED_POINTS + 1];   // s
    double terms[SETTLED_POINTS][4]; // of the time since the piece's first point
} ModelWall;

typedef struct ModelPin {
    double crank, coupler, last; // m, lengths; last is 0 of a slider
    double ground, offset;       // m
    double omega;                // rad/s
    double mass, inertia;        // of the coupler, kg and kg m^2 about its middle
    double last_mass;            // kg
    double last_inertia;         // kg m^2
    double gravity;              // m/s^2
    bool is_hung;                // the coupler stays with the follower or slider, not the crank
} ModelPin;

// The offset across the play with its rates: x of a wall, e of a pin.
typedef struct ModelOffset {
    double x[2], v[2], a[2]; // m, m/s, m/s^2, or rad of a pivot; the second is 0 of a wall
} ModelOffset;

typedef struct Model {
    bool is_pin;
    int coordinates;
    double period;                      // s
    double stiffness, exponent;         // K, n
    double hysteresis;                  // chi, 1
    double clearance;                   // m, radial, of a pin
    double reach[2];                    // m, by which coordinates count as lengths
    size_t stops;                       // times in the period at which a step has to end
    double stop_at[SETTLED_POINTS + 1]; // s, the last the period
    ModelWall wall;
    ModelPin pin;
} Model;

// What a contact does in a step, which its law depends on.
typedef struct ModelTouch {
    bool is_touching;
    bool is_released;
    bool is_resting;
    double rate; // s/m, chi / v0
} ModelTouch;

Model model_make(const SettledCase *sizes);

// How many contacts: a wall has two ends, a pin one.
int model_contacts(const Model *model);

// The depth of a contact, and its first two rates.
void model_depth(const Model *model, int contact, const ModelOffset *offset, double depth[3]);

// The force of a touching contact at a depth and its rate.
double model_force(const Model *model, const ModelTouch *touch, double depth, double closing);

// The rates of the state y = (x, x') or (q, q') at a time of the period, and the offset.
void model_rates(const Model *model, double time, const double *y, const ModelTouch *touches,
                 double *rates, ModelOffset *offset);

// The state at the start of a period with an offset and its rate; false where there is none.
bool model_place(const Model *model, const double x[2], const double v[2], double *y);

// The state as the case is written.
void model_written(const Model *model, const SettledCase *sizes, double *y);
