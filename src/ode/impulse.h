// Steps of ODE with contacts integrated inside them, as they are handed on, in the plane and in
// space: which instants stand out in a step, the parts that end there, those of islands, and the
// solver around them. What differs between plane and space is an ImpulseKind
// (ode/plane/impulse.c, ode/space/space_impulse.c).
#pragma once

#include "kernel/marks.h"
#include "kernel/step.h"
#include "model/response_groups.h"
#include "model/solver.h"

#include <ode/ode.h>

// places up to which all are integrated together: what islands save they cost as well
enum { IMPULSE_FEW_PLACES = 16 };

// Bodies, joints and places; all, or those of one island.
typedef struct ImpulseScope {
    bool is_whole;
    bool has_drive; // whether a driven body is among the bodies: then all drives are in it
    size_t body_count;
    size_t *bodies; // owned, as are all arrays
    size_t joint_count;
    size_t *joints;
    size_t place_count;  // of those below, the first, that are looked at
    ResponsePart part;   // the places; of an island also others of the groups of bodies that they
                         // move, and these groups
    ResponsePart placed; // where single bodies are asked for: the groups of which accelerations are
                         // wanted, with the first of the places above; not owned
} ImpulseScope;

// A time within a step.
typedef struct ImpulseTime {
    double since_s; // since the step's start
    size_t node;    // of the kernel; islands have been looked at then
    bool is_peak;   // whether accelerations are worked out where the bodies are, not at mid-step
} ImpulseTime;

// All bodies, joints and places of a linkage.
ImpulseScope impulse_scope_whole(const Linkage *linkage, size_t place_count);
void impulse_scope_finish(ImpulseScope *scope);

// How a place is at a time within the step, from the sums then: by its island, or where the islands
// are NULL by the kernel of all.
KernelPose impulse_scope_pose(const Kernel *kernel, const KernelIslands *islands, size_t place,
                              ImpulseTime at, const KernelSums *sums);

// The times at which steps end, but for kinks: n tick_s.
typedef struct ImpulseTicks {
    double tick_s; // the finest step
    size_t tick;   // at the end of the last step, or before it
} ImpulseTicks;

ImpulseTicks impulse_ticks(const Scenario *scenario);

// Sets where a step ends that has begun, a fine or a coarse one: on the ticks, but not beyond the
// run, nor beyond a kink of the drive's speed or a jump of a load.
void impulse_set_end(const Scenario *scenario, bool is_fine, ImpulseTicks *ticks, KernelStep *step);

// Takes such a step. Says what went wrong, and when.
bool impulse_take_scheme(const Scenario *scenario, KernelStep *step, Err *err);

// Carries the step, its contacts, and the tick at its end.
void impulse_carry_scheme(KernelStep *step, ImpulseTicks *ticks, Carry *carry);

// The parts in which a step with contacts integrated inside it is handed on: they end where a
// contact begins, ends, or shows a maximum, so that no peak is missed whatever the step.
typedef struct ImpulsePart {
    Marks marks; // of the step
    size_t most_rows;
    double start_s;
    double end_s;
    bool is_last;    // of its step
    KernelSums sums; // at its end; of these only the impulses are zero when a step begins
    KernelSums before;
    double *omega; // by body; owned, as are all arrays
    double *alpha;
    double *impulse; // by joint
    double *approach;
    double *since_s; // s, of the contact that is told
    bool *is_known;
    StepRecord record;
} ImpulsePart;

// For a kernel of so many rows.
void impulse_part_init(ImpulsePart *part, const Linkage *linkage, size_t rows);

// Whether the next part begins a new step, which is then to be taken and given to
// impulse_part_begin.
bool impulse_part_needs_step(const ImpulsePart *part);

// Begins a step that has been taken, at a time.
void impulse_part_begin(ImpulsePart *part, const Kernel *kernel, double start_s);

// Goes on to the next part of a step that began and ends then; returns the mark at its end.
const Mark *impulse_part_next(ImpulsePart *part, const Kernel *kernel, double step_start_s,
                              double step_end_s);

// Fills in the record, but for turning and joints, and what the joints do beside the contacts,
// whose states at the end of the part are given.
void impulse_part_record(ImpulsePart *part, const Linkage *linkage, const JointState *joints);

// Adds the contacts to the record: by joint their impulses and the speeds at which they began, of
// the place that touches since the shortest time; what is stored in them. By place: how deep it is,
// m, and whether it counts as a contact of its joint (NULL: all do).
void impulse_part_add_contacts(ImpulsePart *part, const Kernel *kernel, const Mark *mark,
                               const double *depths, const bool *counts);

// Adds one place with the impulse, N s, that came of it in the part.
void impulse_part_add_place(ImpulsePart *part, const KernelContact *place, bool is_touching,
                            double pushed);

void impulse_part_finish(ImpulsePart *part);

// A step that has been taken.
typedef struct ImpulseSpan {
    double start_s;
    double end_s;
    double width_s;
    double drive_work; // J
    double load_work;  // J
    double damped;     // J, in dampers
} ImpulseSpan;

// What is read of a mechanism and of its steps; it stays where it is from step to step.
typedef struct ImpulseView {
    const Scenario *scenario;
    dWorldID world;
    size_t constraint_rows; // of its ideal joints
    const Kernel *kernel;   // a joint of it is a place
    KernelIslands *islands; // of its places; NULL where they are few
    const ResponseGroups *groups;
    const ImpulseScope *whole;
    const bool *counts;       // by place: whether it is a contact of its joint; NULL: all
    const double *depths;     // m, by place, at the time that was looked at last
    const JointState *joints; // likewise
    const SpaceJointState *space_joints; // NULL in the plane
    bool is_flat; // a linkage in space that never leaves the plane: a place is both ends of a pin
} ImpulseView;

// How a mechanism is stepped and looked at, in the plane or in space. All but `open` are given what
// that made.
typedef struct ImpulseKind {
    // Builds the mechanism at its start. What it makes is to be closed after a failure too.
    bool (*open)(const Scenario *scenario, void **own, ImpulseView *view, Err *err);
    void (*close)(void *own);
    // Takes the next step.
    bool (*take)(void *own, ImpulseSpan *span, Err *err);
    // Looks at a scope of the step, from the contacts' sums up to then: its joints and depths, and
    // how its bodies turn, rad/s and rad/s^2, by body.
    void (*look)(void *own, const ImpulseScope *scope, ImpulseTime at, const KernelSums *sums,
                 double *omega, double *alpha);
    // Fills in bodies and joints of a sample, likewise.
    void (*observe)(const void *own, ImpulseTime at, const KernelSums *sums, Sample *sample);
    // The same of the bodies of a scope, with accelerations of the placed ones, and of its joints
    // where these are wanted. NULL: nobody can ask for some.
    void (*observe_some)(const void *own, const ImpulseScope *scope, ImpulseTime at,
                         const KernelSums *sums, bool wants_joints, Sample *sample);
    // The mean force of an ideal joint in the step, N.
    double (*mean)(const void *own, size_t joint);
    // Carries all that the next step depends on.
    void (*carry)(void *own, Carry *carry);
    // The number of a place in its joint.
    int (*place)(const void *own, size_t place);
} ImpulseKind;

// In the plane, and of a linkage in space that never leaves it (model/space_flat.h).
extern const ImpulseKind IMPULSE_PLANE;

// The parts in which a step is handed on whose contacts were integrated by islands: those of the
// islands in order of time, and the end of the step of all.
typedef struct ImpulseIslands ImpulseIslands;

// Both arguments and what they point to are kept.
ImpulseIslands *impulse_islands_create(const ImpulseView *view, const ImpulseKind *kind, void *own);
void impulse_islands_destroy(ImpulseIslands *islands);

// Begins a step that has been taken.
void impulse_islands_begin(ImpulseIslands *islands, const ImpulseSpan *span, ImpulsePart *part);

// Whether the next part begins a new step.
bool impulse_islands_need_step(const ImpulseIslands *islands);

// What the last part was of.
const ImpulseScope *impulse_islands_scope(const ImpulseIslands *islands);

// Fills in one body or joint of a sample at a time within the step. Returns false where that takes
// a look at all: of several, and of the joint of the drive.
bool impulse_islands_observe(ImpulseIslands *islands, double since_s, const SolverSome *some,
                             Sample *sample);

// Goes on to the next part, and fills in the record. What others than the island's bodies and
// joints do stays as it was at the last part that had them.
void impulse_islands_next(ImpulseIslands *islands, ImpulsePart *part);

// The functions of a Solver; the first is given the kind.
bool impulse_open(const ImpulseKind *kind, const Scenario *scenario, void **state, Err *err);
void impulse_close(void *state);
bool impulse_step(void *state, double stop_s, Err *err);
StepRecord impulse_record(const void *state);
void impulse_observe(const void *state, double time_s, Sample *sample);
void impulse_observe_some(const void *state, double time_s, const SolverSome *some, Sample *sample);
bool impulse_carry(void *state, Carry *carry);
void impulse_contacts(const void *state, ContactState (*states)[JOINT_PLACES]);
SolverModel impulse_model(const void *state);

// Opens mechanisms that share nothing but the ground (model/independent.h), each stepped by that
// solver, whose functions are those above.
bool impulse_parts_open(const Scenario *scenario, const Solver *solver, void **state, Err *err);
