// What touches, in the words that engines themselves have for it: a point that stays in a circle, a
// coordinate between two ends, a coupling of coordinates, a disc that stays off a line or another
// disc. What is none of these, or what an engine lacks, is refused by name before anything runs.
//
// The engine's own file makes of each what the engine calls it, and says after a step what that has
// pushed with; all else is here. Laws of contacts have no part in it.
#pragma once

#include "drivers/common/place.h"
#include "drivers/common/tree.h"

typedef enum NativeTeeth {
    NATIVE_NO_TEETH,
    NATIVE_RIGID_TEETH, // a coupling without play
    NATIVE_LOOSE_TEETH,
} NativeTeeth;

// What an engine has words for.
typedef struct NativeMeans {
    const char *engine;
    bool has_holes;
    bool has_faces;
    NativeTeeth teeth;
    bool couples_any; // teeth on bodies that do not turn about the ground, and racks
} NativeMeans;

// A coordinate that places keep between two ends: of a pivot, a slider, teeth or a rack. With x the
// coordinates of the tree, 0 at the start,
//     low <= shares . x <= high
typedef struct NativeRow {
    size_t places[2]; // that push it up, and down
    size_t place_count;
    bool has_teeth;
    double *shares; // by coordinate; owned
    double low;     // m, rad of a turn
    double high;    // INFINITY where nothing pushes down
} NativeRow;

// A disc of body b that stays off what body a has there: a half-plane that ends at a line, or
// another disc.
typedef struct NativeFace {
    size_t place;
    bool is_line;
    double radius;   // m, of the disc on body b about its anchor
    double distance; // m, of the line from anchor a, or the radius of the disc on body a
    double friction;
} NativeFace;

typedef struct Native {
    const Tree *tree;
    size_t row_count;
    NativeRow *rows; // owned, as the next
    size_t face_count;
    NativeFace *faces;
    size_t hole_count;
    size_t *holes;        // places
    bool has_rigid_teeth; // teeth, by an engine that couples them without play
    const NativeMeans *means;
} Native;

// Of all places of a case. Refuses what the engine cannot say.
Native native_make(const Tree *tree, const NativeMeans *means);

// The only coordinate that a row has a share of; the number of coordinates where there are several.
size_t native_only_share(const Native *native, const NativeRow *row);

// How fast the place that pushes a row up opens as body b turns against body a, in rows of a turn
// 1 or -1; and of a slider the direction along which it opens, in the frame of body a.
double native_turn_sign(const Native *native, const NativeRow *row);

// Which place pushes a row, N: that of the smaller gap.
size_t native_pushing(const Native *native, const NativeRow *row, const DriverMotion *motions);

// Follows all places to the end of a step, in which the engine has pushed with so much, N or N m by
// place, and writes the forces on body b by joint.
void native_follow(const Native *native, const DriverMotion *motions, const double *pushes,
                   DriverContact *contacts, DriverRun *run, Vec2 *forces);

// Adds words to the settings of a run.
void native_tell(DriverRun *run, const char *words);
