// The kinds of joints: one table, of which each row is a kind and says what it is made of.
//
// The program asks for these traits and names no kind, so that a new one is what its row says and
// is taken for no other; tests/style/kinds.sh has the places that name one all the same, each with
// its reason. Where what is done differs from trait to trait, a switch without a default names what
// a new value of it lacks.
#pragma once

#include <stdbool.h>

// By what a joint holds its bodies, or would if it had no play; its rows are those of
// model/joint_rows.h.
typedef enum JointHolds {
    JOINT_HOLDS_NOTHING,
    JOINT_HOLDS_POINT, // the two anchors coincide, and the bodies pivot about them
    JOINT_HOLDS_LINE,  // the anchor on body b stays on the line of body a (Joint.direction), and
                       // the two bodies keep their angle to one another
} JointHolds;

// What touches in a joint, with play; at the ends of its coordinate limits touch beside it.
typedef enum JointTouches {
    JOINT_TOUCHES_NOTHING,
    JOINT_TOUCHES_HOLE,   // a pin on body b in a hole of body a
    JOINT_TOUCHES_GUIDES, // a block on body b between two guides of body a, or a sleeve on body b
                          // round a rod of body a
    JOINT_TOUCHES_DISC,   // a disc on body b and a line or a disc of body a, from outside; nothing
                          // while apart
    JOINT_TOUCHES_TEETH,  // of two gears on pivots, or of a rack on its guide and a pinion on its
                          // pivot, which are joints of their own and may have play: the ends of
                          // its coordinate
} JointTouches;

// The coordinate of a joint, which limits, drives and loads are for (model/coordinate.h).
typedef enum JointCoordinate {
    JOINT_COORDINATE_NONE,
    JOINT_COORDINATE_ANGLE,    // rad, of body b against body a
    JOINT_COORDINATE_POSITION, // m, of the anchor on body b along the line of body a
    JOINT_COORDINATE_TEETH,    // m, along the pitch circles
    JOINT_COORDINATE_RACK,     // m, of the pitch circle of body b along the pitch line of body a
} JointCoordinate;

// The kinds: a row each, its enumerator; by what it holds its bodies, what touches, and its
// coordinate; whether it is available in space; and what a message calls it. What is made of the
// list gets `with` beside each row.
// clang-format off
#define JOINT_KIND_LIST(member, with) \
    member(with, JOINT_REVOLUTE,  POINT,   NOTHING, ANGLE,    true,  "which has no play") \
    member(with, JOINT_CLEARANCE, POINT,   HOLE,    NONE,     true,  "a pin in a hole") \
    member(with, JOINT_PRISMATIC, LINE,    NOTHING, POSITION, false, "a prismatic joint without play") \
    member(with, JOINT_GUIDE,     LINE,    GUIDES,  NONE,     false, "a block between guides") \
    member(with, JOINT_STOP,      NOTHING, DISC,    NONE,     false, "a stop") \
    member(with, JOINT_GEAR,      NOTHING, TEETH,   TEETH,    false, "a pair of gears") \
    member(with, JOINT_RACK,      NOTHING, TEETH,   RACK,     false, "a rack and pinion")
// clang-format on
#define JOINT_KIND(with, id, ...) id,
typedef enum JointKind { JOINT_KIND_LIST(JOINT_KIND, _) JOINT_KIND_COUNT } JointKind;

// The kinds with a trait, as bits, so that tables can name them.
// clang-format off
#define JOINT_BIT(id, has) | ((has) ? 1 << (id) : 0)
#define JOINT_IF_HOLDS(with, id, holds, ...) \
    JOINT_BIT(id, JOINT_HOLDS_##holds == JOINT_HOLDS_##with)
#define JOINT_IF_TOUCHES(with, id, holds, touches, ...) \
    JOINT_BIT(id, JOINT_TOUCHES_##touches == JOINT_TOUCHES_##with)
#define JOINT_IF_COORDINATE(with, id, holds, touches, coordinate, ...) \
    JOINT_BIT(id, JOINT_COORDINATE_##coordinate == JOINT_COORDINATE_##with)
#define JOINT_IF_SPATIAL(with, id, holds, touches, coordinate, in_space, ...) \
    JOINT_BIT(id, (in_space) == (with))
typedef enum JointKinds {
    JOINTS_ALL = (1 << JOINT_KIND_COUNT) - 1,
    JOINTS_THAT_HOLD = JOINTS_ALL - (0 JOINT_KIND_LIST(JOINT_IF_HOLDS, NOTHING)),
    JOINTS_THAT_PIVOT = 0 JOINT_KIND_LIST(JOINT_IF_HOLDS, POINT),
    JOINTS_THAT_SLIDE = 0 JOINT_KIND_LIST(JOINT_IF_HOLDS, LINE),
    // beside that of limits
    JOINTS_WITH_PLAY = JOINTS_ALL - (0 JOINT_KIND_LIST(JOINT_IF_TOUCHES, NOTHING)),
    JOINTS_WITH_HOLE = 0 JOINT_KIND_LIST(JOINT_IF_TOUCHES, HOLE),
    JOINTS_WITH_GUIDES = 0 JOINT_KIND_LIST(JOINT_IF_TOUCHES, GUIDES),
    JOINTS_WITH_DISC = 0 JOINT_KIND_LIST(JOINT_IF_TOUCHES, DISC),
    JOINTS_WITH_TEETH = 0 JOINT_KIND_LIST(JOINT_IF_TOUCHES, TEETH),
    JOINTS_WITH_COORDINATE = JOINTS_ALL - (0 JOINT_KIND_LIST(JOINT_IF_COORDINATE, NONE)),
    JOINTS_WITH_ANGLE = 0 JOINT_KIND_LIST(JOINT_IF_COORDINATE, ANGLE),
    JOINTS_WITH_POSITION = 0 JOINT_KIND_LIST(JOINT_IF_COORDINATE, POSITION),
    JOINTS_WITH_RACK = 0 JOINT_KIND_LIST(JOINT_IF_COORDINATE, RACK),
    JOINTS_WITH_MESH = 0 JOINT_KIND_LIST(JOINT_IF_COORDINATE, TEETH),
    JOINTS_IN_SPACE = 0 JOINT_KIND_LIST(JOINT_IF_SPATIAL, true),
} JointKinds;
// clang-format on

static inline bool joint_is_among(JointKind kind, JointKinds kinds)
{
    return ((unsigned)kinds & (1U << kind)) != 0;
}

// Whether its rows are those of a point, about which its bodies pivot.
static inline bool joint_pivots(JointKind kind)
{
    return joint_is_among(kind, JOINTS_THAT_PIVOT);
}

// Whether its rows are those of a line: the distance from it and the tilt.
static inline bool joint_slides(JointKind kind)
{
    return joint_is_among(kind, JOINTS_THAT_SLIDE);
}

// Whether it has rows in which it holds its bodies, or would if it had no play.
static inline bool joint_holds(JointKind kind)
{
    return joint_is_among(kind, JOINTS_THAT_HOLD);
}

// Whether it holds its bodies in its rows without play; its own coordinate may have limits all the
// same.
static inline bool joint_is_ideal(JointKind kind)
{
    return joint_is_among(kind, JOINTS_THAT_HOLD & ~JOINTS_WITH_PLAY);
}

// Whether it holds its bodies with play to all sides, in which they start somewhere.
static inline bool joint_is_loose(JointKind kind)
{
    return joint_is_among(kind, JOINTS_THAT_HOLD & JOINTS_WITH_PLAY);
}

// Whether a pin plays in a hole.
static inline bool joint_has_hole(JointKind kind)
{
    return joint_is_among(kind, JOINTS_WITH_HOLE);
}

// Whether the corners of a block play between guides, or those of a sleeve round a rod.
static inline bool joint_has_guides(JointKind kind)
{
    return joint_is_among(kind, JOINTS_WITH_GUIDES);
}

// Whether a disc or point meets a line or disc from outside.
static inline bool joint_has_disc(JointKind kind)
{
    return joint_is_among(kind, JOINTS_WITH_DISC);
}

// Whether teeth touch; the joints by which it is known where they are stand in Joint.gear.
static inline bool joint_has_teeth(JointKind kind)
{
    return joint_is_among(kind, JOINTS_WITH_TEETH);
}

// Whether its coordinate is an angle, which can be driven, and a torque turns.
static inline bool joint_has_angle(JointKind kind)
{
    return joint_is_among(kind, JOINTS_WITH_ANGLE);
}

// Whether its coordinate is the position along a line, along which a force pushes.
static inline bool joint_has_position(JointKind kind)
{
    return joint_is_among(kind, JOINTS_WITH_POSITION);
}

// Whether teeth touch along a line that one of its bodies carries.
static inline bool joint_has_rack(JointKind kind)
{
    return joint_is_among(kind, JOINTS_WITH_RACK);
}

// Whether the teeth of two gears touch (base/mesh.h).
static inline bool joint_has_mesh(JointKind kind)
{
    return joint_is_among(kind, JOINTS_WITH_MESH);
}

// Whether it is available in space.
static inline bool joint_is_spatial(JointKind kind)
{
    return joint_is_among(kind, JOINTS_IN_SPACE);
}

// By what it holds its bodies, what touches in it, and its coordinate, for switches.
static inline JointHolds joint_held_by(JointKind kind)
{
#define JOINT_HELD_BY(with, id, holds, ...) JOINT_HOLDS_##holds,
    static const unsigned char HOLDS[] = {JOINT_KIND_LIST(JOINT_HELD_BY, _)};
    return (JointHolds)HOLDS[kind];
}

static inline JointTouches joint_touches(JointKind kind)
{
#define JOINT_TOUCHES(with, id, holds, touches, ...) JOINT_TOUCHES_##touches,
    static const unsigned char TOUCHES[] = {JOINT_KIND_LIST(JOINT_TOUCHES, _)};
    return (JointTouches)TOUCHES[kind];
}

static inline JointCoordinate joint_coordinate(JointKind kind)
{
#define JOINT_COORDINATE(with, id, holds, touches, coordinate, ...) JOINT_COORDINATE_##coordinate,
    static const unsigned char COORDINATES[] = {JOINT_KIND_LIST(JOINT_COORDINATE, _)};
    return (JointCoordinate)COORDINATES[kind];
}

// The ideal kind that holds its bodies by the same; itself of one that holds nothing.
JointKind joint_without_play(JointKind kind);

// What a message calls it: "a pin in a hole".
const char *joint_words(JointKind kind);
