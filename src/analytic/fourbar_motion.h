// The closed-form motion of a four-bar with ideal joints, for one crank angle or a whole grid.
#pragma once

#include "analytic/curve.h"
#include "model/fourbar.h"
#include "model/linkage.h"

#include <stddef.h>

// The four lengths without their tolerances, m, and how the loop is closed.
typedef struct FourBarLengths {
    double ground;
    double crank;
    double coupler;
    double follower;
    Assembly assembly;
} FourBarLengths;

FourBarLengths fourbar_motion_nominal(const FourBar *fourbar);

// Results over a grid of crank angles, each array of the grid's length or NULL where not wanted.
typedef struct FourBarGrid {
    double *follower_angle; // rad, in (-pi, pi], of the line from follower pivot to coupler pin
    double *coupler_omega;  // rad/s
    double *follower_omega; // rad/s
    double *coupler_alpha;  // rad/s^2
    double *follower_alpha; // rad/s^2
} FourBarGrid;

// Evaluates the motion at every crank angle of the grid for a crank turning at constant speed,
// rad/s. Where the loop does not close or is at a dead centre, the results are NaN.
void fourbar_motion_grid(const FourBarLengths *lengths, double speed, size_t count,
                         const double *crank_angles, const FourBarGrid *grid);

// The motion of the three bodies crank, coupler, follower, centres of mass at mid-link, at one
// crank angle. Returns false, motions untouched, where the loop does not close there.
bool fourbar_motion_bodies(const FourBarLengths *lengths, double speed, double crank_angle,
                           Motion motions[3]);

// What can be extreme over a turn.
typedef enum FourBarQuantity {
    FOURBAR_COUPLER_OMEGA,
    FOURBAR_FOLLOWER_OMEGA,
    FOURBAR_COUPLER_ALPHA,
    FOURBAR_FOLLOWER_ALPHA,
    FOURBAR_FOLLOWER_ANGLE, // from 0 to 2 pi
    FOURBAR_TRANSMISSION,
    FOURBAR_QUANTITY_COUNT,
} FourBarQuantity;

double fourbar_motion_quantity(const FourBarLengths *lengths, double speed,
                               FourBarQuantity quantity, double crank_angle);

// All of them with the crank along a unit vector, with the loop closed once.
void fourbar_motion_quantities(const FourBarLengths *lengths, double speed, Vec2 crank,
                               double values[FOURBAR_QUANTITY_COUNT]);

// The extremes of one quantity for crank angles from first to last: curve_extreme.
CurveExtreme fourbar_motion_extreme(const FourBarLengths *lengths, double speed,
                                    FourBarQuantity quantity, double first_angle,
                                    double last_angle);

enum { FOURBAR_TURN_MAX = 722 }; // half degrees, both ends, and one for rounding

// The crank's directions on the grid of a turn, for who asks for many extremes.
typedef struct FourBarTurn {
    CurveGrid grid;
    Vec2 cranks[FOURBAR_TURN_MAX]; // unit vectors
} FourBarTurn;

void fourbar_motion_turn(FourBarTurn *turn);

// The smallest or largest value of one quantity over a turn, as fourbar_motion_extreme's.
double fourbar_motion_bound(const FourBarLengths *lengths, double speed, FourBarQuantity quantity,
                            bool is_high, const FourBarTurn *turn);
