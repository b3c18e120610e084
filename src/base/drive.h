// How a drive turns its body about its joint with the ground: at constant speed, or by a table over
// time, which may repeat in periods of whole turns. The table has speeds, linear between its
// points, or angles, between which one of the usual laws of motion turns the body. What jumps at
// the points, the speed's slope or the angle's second or third rate, are the kinks. A
// sinusoid is a table of one point with a wave; one angle alone is held.
#pragma once

#include "base/time_table.h"

#include <stdbool.h>

// How a drive gets from one angle of its table to the next: over a share tau of the time between
// them, by a share s of the way.
typedef enum DriveProfile {
    DRIVE_CYCLOID,    // s = tau - sin(2 pi tau) / (2 pi)
    DRIVE_POLYNOMIAL, // s = 10 tau^3 - 15 tau^4 + 6 tau^5
    DRIVE_TRAPEZOID,  // the speed rises for a third of the time, holds for one and falls for one
    DRIVE_SPLINE,     // a cubic spline through all points, at rest at both ends
} DriveProfile;

typedef struct Driver {
    bool is_present;
    bool is_one_of_several; // then a turn of this one is no period of the mechanism
    int joint;              // number of the driven joint, which is ideal; its body_a is the ground
    double speed;           // rad/s, counter-clockwise positive; with a table its largest in size
    double start;           // angle of the driven body at time zero, rad
    bool has_angles;        // whether its table has angles; else it has speeds
    DriveProfile profile;   // between angles
    TimeTable table; // over time: speeds, rad/s, or angles since the start, rad; without points the
                     // speed is constant
    double gain;     // rad by which angles grow in a period
    double slopes[TIME_TABLE_MAX]; // rad/s, of a spline at its points
} Driver;

// The driven body's angle, not wrapped, and its rates.
typedef struct DriveState {
    double angle; // rad
    double omega; // rad/s
    double alpha; // rad/s^2; at a kink that after it
} DriveState;

DriveState drive_at(const Driver *driver, double time_s);

// The same as the piece has it that holds from a time on, which is no later: at a kink or beyond it
// as before it.
DriveState drive_since(const Driver *driver, double from_s, double time_s);

// The angle alone, and to more digits.
double drive_angle(const Driver *driver, double time_s);
long double drive_angle_exact(const Driver *driver, long double time_s);

// How a drive goes on from an instant, up to its next kink: the angle turned since then, with all
// its digits, is c_1 s + .. + c_5 s^5 and the part of a cycloid that is no polynomial.
enum { DRIVE_TERMS = 5 };

typedef struct DrivePiece {
    bool is_uniform;           // its acceleration is constant: the first two terms are all
    double terms[DRIVE_TERMS]; // rad/s^k, of the first power of time on
    double wave;               // rad, the lift of a cycloid; 0: there is none
    double phase;              // 1, tau at the instant
    double width_s;            // s, between its two points
    Wave swing;                // of the angle, rad, its phase that at the instant
} DrivePiece;

DrivePiece drive_piece(const Driver *driver, double from_s);

// The angle turned since the piece's instant, and the rates.
DriveState drive_piece_at(const DrivePiece *piece, double since_s);

// The first kink after a time, s; INFINITY where there is none.
double drive_next_kink(const Driver *driver, double time_s);

// How far the driven body turns from its start up to a time, rad: the most to each side, `back` at
// most 0 and `forth` at least 0.
typedef struct DriveExtent {
    double back;
    double forth;
} DriveExtent;

DriveExtent drive_extent(const Driver *driver, double to_s);

// Whether there is a drive alone and its speed is constant: then it has revolutions and a period.
bool drive_is_steady(const Driver *driver);

// The angle by which a drive with a table turns in each period, rad.
double drive_turned_in_period(const Driver *driver);

// Whether it has no kinks: a constant speed, an angle that is held, or a sinusoid.
bool drive_is_smooth(const Driver *driver);

// Whether it prescribes one angle that stays.
bool drive_is_held(const Driver *driver);

// The period after which a drive that is not steady is the same again, whole turns away, s: that of
// its table or of its wave, or as many of the latter as its mean speed needs for whole turns; 0:
// there is none.
double drive_period(const Driver *driver);

// Takes the largest speed and a spline's slopes from the table, where there is one: after a change
// of it.
void drive_complete(Driver *driver);
