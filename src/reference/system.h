// Equations of motion with contacts, as those see them who step through them: events, peaks, the
// stepper and the solver. Those of the plane are in reference/plane/dynamics.c, those of space in
// reference/space/space_system.c; each puts a System first in a structure of its own.
//
// The integrator's vector holds the coordinates since the base (where the linkage stood at the
// start of the present step), their rates, how far bristles are bent (kernel/bristle.h), and what
// is added up over time. Times are those since the base, s.
#pragma once

#include "contact/pin_space.h"
#include "kernel/bristle.h"
#include "kernel/force_law.h"
#include "model/trajectory.h"
#include "reference/integrators.h"

#include <math.h>
#include <stdbool.h>

// How hard a contact presses: its law in the mode that it is in, as a function of depth and closing
// speed alone. The same in the plane and in space.
//
//     N = F_el(d) (1 + chi d'/v0) + c(d) d'

// What a contact is doing. It changes at events only.
typedef enum ContactMode {
    CONTACT_APART,    // the pin is within its play
    CONTACT_PRESSING, // it overlaps the wall and is pressed
    CONTACT_SLACK,    // it overlaps the wall, but leaves it faster than the spring follows
} ContactMode;

// Which wall of a slot a contact meets. While it touches that stays as it is until an event, so
// that its force is smooth: the curvature of the gap jumps where one goes over into another.
typedef enum ContactWall {
    WALL_NEAREST, // whichever is there: of a contact that is apart, and of all but slots
    WALL_BEHIND,  // the straight one that presses along the direction across the slot
    WALL_AHEAD,   // the straight one that presses against it
    WALL_LOW,     // the arc at the end of the slot that comes first along it
    WALL_HIGH,    // and the one that comes last
} ContactWall;

// How a contact is to the wall that it meets.
typedef struct WallPlace {
    ContactWall wall; // that one; of WALL_NEAREST the one that is there
    ContactWall next; // the one that follows where it ends
    double within;    // m, along the slot: how far its end is; negative beyond
    double leaving;   // m/s, how fast that gets less
} WallPlace;

typedef struct Contact {
    int joint;
    int place;   // of the joint: which of its contacts it is
    int partner; // of a limited coordinate: by how many contacts the one at its other end comes
                 // later; 0: there is none
    ForceLaw law;
    double clearance;   // m, radial, or of a collar in space axial; 0 of a stop but a slot
    double arm;         // m, by which an angle counts as a length and a torque as a force; 1 of
                        // what is a length already
    double flight;      // m, by which it may come nearer between two evaluations while it is apart
    double hole_radius; // m, of a pin in space
    bool is_collar;     // of a pin in space: it stops the pin along its axis
    bool has_walls;     // of a slot
    ContactMode mode;
    ContactWall wall;
    double onset_s;      // when the contact under way began
    double impact_speed; // m/s, closing speed when the contact under way began
    double damping_rate; // s/m, chi / v0, v0 not below the law's floor
    bool is_growing;     // its damping grows with the depth, and is not whole there
    bool is_released;    // as in kernel/contact_state.h
    bool is_resting;
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

// What its viscous damper has at a depth, N s/m, and how fast that grows, N s/m^2.
typedef struct PressViscous {
    double coefficient;
    double slope;
} PressViscous;

// by how much of itself a step goes on beyond its ends: no stage of a step that is kept lies
// further
static const double PRESS_STEP_BEYOND = 0.25;

// On either side of where it is whole, an event, it goes on smoothly.
static inline PressViscous press_viscous(const Contact *contact, double depth)
{
    const ForceLaw *law = &contact->law;
    if (!contact->is_growing) {
        return (PressViscous){law->viscous, 0.0};
    }
    const double share = depth / law->full_damping_depth;
    if (!(fabs(share - 0.5) < 0.5 + PRESS_STEP_BEYOND)) {
        const double end = share > 0.5 ? 1.0 + PRESS_STEP_BEYOND : -PRESS_STEP_BEYOND;
        return (PressViscous){law->viscous * end * end * (3.0 - 2.0 * end), 0.0};
    }
    return (PressViscous){law->viscous * share * share * (3.0 - 2.0 * share),
                          law->viscous * 6.0 * share * (1.0 - share) / law->full_damping_depth};
}

// What a contact's law has where it presses so, with a slope of its spring, N/m.
static inline ForceLawTerms press_terms(const Contact *contact, const Press *press, double tangent)
{
    const PressViscous viscous = press_viscous(contact, press->depth);
    return (ForceLawTerms){press->elastic, tangent, viscous.coefficient, viscous.slope};
}

// What it makes of that. Of the slope only the derivative by the depth depends.
static inline ForceLawDamped press_damped(const Contact *contact, const Press *press,
                                          double tangent)
{
    return force_law_damped(press_terms(contact, press, tangent), contact->damping_rate,
                            press->closing);
}

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
    press.pressing = press_damped(contact, &press, 0.0).force;
    press.release = law->viscous > 0.0 ? press.pressing : 1.0 + contact->damping_rate * closing;
    // a slack spring relaxes by itself: what it had stored is lost like the damper's work
    press.normal = contact->mode == CONTACT_PRESSING ? press.pressing : 0.0;
    press.damping_power = (press.normal - press.elastic) * closing;
    return press;
}

// Begins a contact at a time, s, with a closing speed.
static inline void contact_begin(Contact *contact, double onset_s, double impact_speed)
{
    contact->mode = CONTACT_PRESSING;
    contact->onset_s = onset_s;
    contact->impact_speed = impact_speed;
    contact->damping_rate = force_law_damping_rate(&contact->law, impact_speed);
    contact->is_growing = contact->law.full_damping_depth > 0.0;
    contact->is_released = contact->is_resting = false;
}

// Lets the impact of a contact be over.
static inline void contact_rest(Contact *contact)
{
    const ForceLaw *law = &contact->law;
    contact->is_resting = true;
    contact->damping_rate = force_law_damping_rate(law, law->resting_speed);
}

// How strongly a contact is damped, N s/m.
static inline double press_damping(const Contact *contact, const Press *press)
{
    return press_damped(contact, press, 0.0).by_rate;
}

// How fast the force of a contact that presses grows with its depth, N/m.
static inline double press_stiffness(const Contact *contact, const Press *press)
{
    return press_damped(contact, press, force_law_tangent(&contact->law, fabs(press->depth)))
        .by_depth;
}

// The rate of the normal force, N/s, of a contact that presses, from the second rate of its depth.
static inline double press_rate(const Contact *contact, const Press *press, double second)
{
    const double tangent = force_law_tangent(&contact->law, press->depth);
    return force_law_damped_rate(press_terms(contact, press, tangent), contact->damping_rate,
                                 press->closing, second);
}

// The friction of an ideal joint or of a contact, and its bristle. Its mode changes at events only,
// like that of a contact.
typedef struct Bristle {
    int joint;
    int contact;      // -1: of an ideal joint
    BristlePair pair; // in what the joint's coordinate is in: rad or m
    double arm;    // m, or 1: friction (a torque, or a force) over what presses times the sliding
                   // coefficient; 0: it is
    double steady; // N m or N, whatever presses
    double length; // m, of a guide, over which it takes a moment; 0: none does
    BristleMode mode;
    int face; // of a guide: what presses there (reference/plane/rub.c)
} Bristle;

// How a bristle is at one instant.
typedef struct BristleAt {
    double bend;     // rad or m
    double speed;    // rad/s or m/s, of the sliding
    double rounding; // of that
    double damping;  // s/rad or s/m
    bool is_idle;    // of a contact that does not press
} BristleAt;

// How the face of a guide that presses is to the others.
typedef struct BristleFace {
    double margin;   // N: by how much it presses more
    double rounding; // N, of that
    int next;        // the one that follows where it is used up
} BristleFace;

// What is added up, behind the bristles.
typedef enum SystemSum {
    SYSTEM_DRIVE_WORK, // J
    SYSTEM_DISSIPATED, // J
    SYSTEM_FRICTION,   // J
    SYSTEM_IMPULSES,   // N s, of each contact from here on; behind them the work of loads, J,
                       // where there are any
} SystemSum;

// What a coordinate is, for the sizes of errors.
typedef struct SystemCoordinate {
    int turning;    // the body that it turns; -1: it is a length
    double reach;   // m, of that body's points; 1 of a length
    double inertia; // kg m^2, or kg of a length: what resists it at the least
} SystemCoordinate;

typedef struct System System;

// What shows equations of the plane as those of a linkage in space (reference/space/flat_system.c).
typedef struct SystemFlat SystemFlat;

// Everything at one instant, in one piece of memory. What the equations have beyond it lies behind
// it.
typedef struct SystemState {
    Press *contacts; // by contact
} SystemState;

// The torque of a soft drive with a limit.
typedef struct DriveTorque {
    double unlimited; // N m, by stiffness and damping alone
    double terms;     // N m, sum of the sizes of what it is the sum of, for its rounding
} DriveTorque;

typedef struct SystemKind {
    // Room for a state of these equations; the caller frees it.
    SystemState *(*state_create)(const System *system);
    // Writes the integrator's vector at the scenario's start, with sums of zero.
    void (*start)(System *system, double *y);
    // The state at a time, with the rates of the integrator's vector where they are not NULL.
    // Returns false where the accelerations are not determined.
    bool (*evaluate)(const System *system, double since_s, const double *y, SystemState *state,
                     double *rates);
    // Rates of the integrator's vector; NaN where they are not determined. The context is a System.
    Dop853Rates rates;
    Dop853Slopes slopes; // or NULL
    // One contact at a time, for events: cheaper than the whole state.
    Press (*press)(const System *system, size_t contact, double since_s, const double *y);
    // The same of a bristle, and of the face of a guide with one, which takes as much as the whole
    // state. NULL where there are none.
    BristleAt (*bristle)(const System *system, size_t bristle, double since_s, const double *y);
    BristleFace (*face)(const System *system, size_t bristle, double since_s, const double *y);
    // Lets a bristle begin to stick at the base: finds its damping. That of a contact follows what
    // presses.
    void (*stick)(System *system, size_t bristle, const double *y);
    // Bends the bristles of joints that stand at the start so that they hold what acts there.
    void (*hold)(System *system, double *y);
    // The number of the joint whose friction had no single answer, where a state had none for that
    // reason; else -1.
    int (*jammed)(const System *system);
    // The torque of the drive before its limit; NULL where no drive has one.
    DriveTorque (*torque)(const System *system, double since_s, const double *y);
    // How a contact is to the walls of its slot; NULL where there are no slots.
    WallPlace (*wall)(const System *system, size_t contact, double since_s, const double *y);
    // Writes the coordinates that press depends on. Returns how many there are; 0 where it
    // depends on all.
    size_t (*needs)(const System *system, size_t contact, size_t *coordinates);
    // Sums of the lengths and speeds that the position and velocity of a contact come from.
    void (*sizes)(const System *system, const SystemState *state, size_t contact, double *length,
                  double *speed);
    // How fast a contact that is apart may come nearer over its flight, m/s.
    double (*crossing)(const System *system, const SystemState *state, size_t contact);
    // The greatest speed of any point of a free body, m/s.
    double (*fastest)(const System *system, const SystemState *state);
    // Of a contact that presses: force and depth whose maxima are asked for, and their rates.
    void (*peak)(const System *system, const SystemState *state, size_t contact, double values[2],
                 double rates[2]);
    // Closes the loops at a time; between its ends a long step keeps them to its tolerance only.
    void (*project)(const System *system, double since_s, double *y);
    // Moves the base on to a time and vector. Returns whether rates at the new base are others.
    bool (*rebase)(System *system, double since_s, double *y);
    // The time that lies so long after the base, and the other way round, s.
    double (*time)(const System *system, double since_s);
    double (*since)(const System *system, double time_s);
    // What people see of a state: speeds of turning about z and their rates, joints, bodies.
    void (*turning)(const System *system, const SystemState *state, double *omega, double *alpha);
    void (*joints)(const System *system, const SystemState *state, JointState *joints,
                   SpaceJointState *space_joints);
    void (*bodies)(const System *system, const SystemState *state, Sample *sample);
    // Where the bodies are at a time and how fast they move, without their accelerations: of
    // equations whose accelerations are always determined. NULL, or false, of others.
    bool (*motions)(const System *system, double since_s, const double *y, Sample *sample);
    // Carries the base, and what else of a state is not in the integrator's vector, nor of
    // contacts.
    void (*carry)(System *system, Carry *carry);
    // Rows of the joints that close loops.
    size_t (*rows)(const System *system);
    void (*destroy)(System *system);
} SystemKind;

struct System {
    const SystemKind *kind;
    const Scenario *scenario;
    double tolerance; // 1, of a step's errors: law_reference_tolerance of the scenario
    SystemFlat *flat; // of a linkage in space that never leaves the plane; NULL of others
    size_t coordinate_count;
    SystemCoordinate *coordinates;
    Coupling *coupling; // owned by the equations
    int side; // of a soft drive with a limit: +1 or -1 while its torque is at that; it changes at
              // events only
    bool has_loads; // whether their work is added up
    bool is_astray; // whether the loops' energy has jumped, as it does at a change point
    int torn;       // the number of an ideal joint that its loop could not keep closed; -1: none
    size_t contact_count;
    Contact *contacts;
    size_t bristle_count;
    Bristle *bristles; // owned by the equations
    // Of the integrator's vector, those that the press of a contact depends on: from its first in
    // the list to the next one's. One with none in the list depends on all.
    size_t *need_firsts; // by contact, and one more; owned, like the list
    size_t *needs;
};

// Where a sum is in the integrator's vector, and how long that is.
static inline size_t system_sum_index(const System *system, size_t sum)
{
    return 2 * system->coordinate_count + system->bristle_count + sum;
}

// Where a joint keeps the bend of a bristle: that of a contact with it, that of an ideal joint
// behind the places of its limits.
static inline int system_bristle_place(const System *system, size_t bristle)
{
    const int contact = system->bristles[bristle].contact;
    return contact >= 0 ? system->contacts[contact].place : JOINT_PLACES - 1;
}

// Likewise the bend of a bristle, rad or m.
static inline size_t system_bristle_index(const System *system, size_t bristle)
{
    return 2 * system->coordinate_count + bristle;
}

static inline size_t system_size(const System *system)
{
    return system_sum_index(system, SYSTEM_IMPULSES) + system->contact_count +
           (system->has_loads ? 1 : 0);
}

// Where the work of loads is, counted from the first sum.
static inline size_t system_load_sum(const System *system)
{
    return SYSTEM_IMPULSES + system->contact_count;
}

// Room for a state of these equations; the caller frees it.
SystemState *system_state_create(const System *system);

// Fills in what contacts need, once these are there, and frees it.
void system_find_needs(System *system);
void system_free_needs(System *system);

// One contact at a time in the tried step.
Press system_press(const System *system, Dop853 *integrator, size_t contact, double time);

// The same of the walls of its slot.
WallPlace system_wall(const System *system, Dop853 *integrator, size_t contact, double time);

// Finds where contacts are that touch at the start, from the integrator's vector there: the walls
// that they meet, and whether their damping is whole.
void system_find_places(System *system, const double *y);

// Lets contacts begin as the linkage has it, and the other way round: writes what they carry at a
// time, s, in the mode that they are in.
void system_take_contacts(System *system);
void system_give_contacts(const System *system, double time_s,
                          ContactState (*states)[JOINT_PLACES]);

// Carries all that steps from here on depend on, beside the integrator's vector.
void system_carry(System *system, Carry *carry);

// Fails with ERR_SOLVER where a pin is deeper in its wall than a share of what its law knows.
bool system_check_depth(const System *system, const SystemState *state, double share, Err *err);

// Makes the equations of motion of a scenario in the plane. Returns NULL with ERR_CASE where a
// contact law does not fit a joint. The caller frees them by their kind.
System *plane_system_create(const Scenario *scenario, Err *err);

// Makes the equations of motion of a scenario in space. Returns NULL with ERR_CASE where a contact
// law does not fit a joint. The caller frees them by their kind.
System *space_system_create(const Scenario *scenario, Err *err);

// The same of one that never leaves the plane: by the plane's equations.
System *flat_system_create(const Scenario *scenario, Err *err);
