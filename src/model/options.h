// Every choice and every default of the program. Options are SI and radians.
#pragma once

#include "kernel/bristle.h"

#include <stdbool.h>
#include <stddef.h>

// Families of alternatives: one line a member, its enumerator, its word in a case and, where the
// member is an object or has properties, those. The enumeration, the list of words and the registry
// follow from it, in this order. Every other table of a family is made from its list, and a switch
// over one has no default: what a new member lacks does not compile.

// clang-format off

// The elastic laws, F(penetration); see contact/law.h.
#define OPTIONS_LAW_LIST(member) \
    member(LAW_AUTO, "auto", law_auto) \
    member(LAW_ELASTIC, "elastic", law_elastic) \
    member(LAW_HERTZ_SOCKET, "hertz-socket", law_hertz_socket) \
    member(LAW_JOHNSON, "johnson", law_johnson) \
    member(LAW_RADZIMOVSKY, "radzimovsky", law_radzimovsky) \
    member(LAW_ESDU_78035, "esdu-78035", law_esdu_78035) \
    member(LAW_DUBOWSKY_FREUDENSTEIN, "dubowsky-freudenstein", law_dubowsky_freudenstein) \
    member(LAW_PAPER_TABLE_2, "paper-table-2", law_paper_table_2) \
    member(LAW_PAPER_TABLE_3, "paper-table-3", law_paper_table_3)

// Where the energy of an impact goes: what hysteretic damping has for chi, 1, of the restitution
// asked for, e, in words and as contact/damping.c computes it. The name follows DAMPING_ here and
// JP_DAMPING_ in the library.
#define OPTIONS_DAMPING_LIST(member) \
    member(NONE, "none", "0", 0.0) \
    member(LANKARANI_NIKRAVESH, "lankarani-nikravesh", "3 (1 - e^2) / 4", 0.75 * (1.0 - e) * (1.0 + e)) \
    member(HUNT_CROSSLEY, "hunt-crossley", "3 (1 - e) / 2", 1.5 * (1.0 - e)) \
    member(FLORES, "flores", "8 (1 - e) / (5 e)", 1.6 * (1.0 - e) / e) \
    member(GONTHIER, "gonthier", "(1 - e^2) / e", (1.0 - e) * (1.0 + e) / e) \
    member(HU_GUO, "hu-guo", "3 (1 - e) / (2 e)", 1.5 * (1.0 - e) / e) \
    member(EXACT, "exact", "the root of chi (1 + e) = ln((1 + chi) / (1 - chi e))", exact_factor(e)) \
    member(VISCOUS, "viscous", "0, and viscous-coefficient in its place", 0.0) \
    member(DISSIPATION, "dissipation", "of exact at restitution-speed, by which it divides whatever the impact", exact_factor(e)) \
    member(STEP, "step", "0, and in its place viscous-coefficient times a cubic step from 0 at the wall to 1 at full-damping-depth", 0.0)

// How stiffness and damping become ERP and CFM of a row; see contact/map.h. The name follows
// ODE_MAP_ here and JP_MAP_ in the library; the row is that of contact/map.c. After them comes
// ODE_MAP_IMPULSE, which makes no row: with ODE_STAGGERED the contact is integrated within the step.
#define OPTIONS_ODE_ROW_MAP_LIST(member) \
    member(TEXTBOOK, "textbook", textbook_map) \
    member(CORRECTED, "corrected", corrected_map) \
    member(MIDPOINT, "midpoint", midpoint_map) \
    member(EXACT, "exact", exact_map)

// How ODE solves for the forces of a step.
#define OPTIONS_ODE_SOLVER_LIST(member) \
    member(ODE_DIRECT, "direct") \
    member(ODE_QUICK, "quick")

// When ODE's positions and speeds are taken to be; see ode/stepping.h. Plain: both at the end of the
// step, as ODE's manual has it. Staggered: positions half a step behind, a leapfrog. Extrapolated:
// several staggered worlds of different steps. Each with its solver in the plane and in space, and
// whether it is for every case; else for smooth motion in the plane alone: ideal joints, and a drive
// without kinks.
#define OPTIONS_ODE_STEPPING_LIST(member) \
    member(ODE_PLAIN, "plain", STEPPING_PLAIN, &SPACE_PLAIN, true) \
    member(ODE_STAGGERED, "staggered", STEPPING_STAGGERED, &SPACE_STAGGERED, true) \
    member(ODE_EXTRAPOLATED, "extrapolated", STEPPING_EXTRAPOLATED, NULL, false)

// How ODE learns that a pin touches the wall of its hole; see ode/plane/collider.h. First the exact one;
// all others take the hole for a polygon.
#define OPTIONS_ODE_COLLIDER_LIST(member) \
    member(ODE_COLLIDER_PIN_HOLE, "pin-hole", collider_pin_hole) \
    member(ODE_COLLIDER_STAVES, "staves", collider_staves) \
    member(ODE_COLLIDER_STAVES_GJK, "staves-gjk", collider_staves_gjk) \
    member(ODE_COLLIDER_CONVEX, "ode-convex", collider_convex) \
    member(ODE_COLLIDER_TRIMESH, "trimesh", collider_trimesh)

// How a run starts: in the motion that is left of its start once the mechanism has turned long
// enough; with pins in the middle of their holes unless the case says otherwise; or with each pin on
// the wall of its hole where the reaction of an ideal joint would hold it.
#define OPTIONS_RUN_START_LIST(member) \
    member(START_SETTLED, "settled") \
    member(START_CENTRED, "centred") \
    member(START_PRESSED, "pressed")

// Other engines, each run by a driver of that name (engine/engine_solver.c); the last one stands for
// any other driver, which --driver names.
#define OPTIONS_ENGINE_LIST(member) \
    member(BACKEND_MUJOCO, "mujoco", ENGINE_MUJOCO, true) \
    member(BACKEND_CHIPMUNK, "chipmunk", ENGINE_CHIPMUNK, true) \
    member(BACKEND_BULLET, "bullet", ENGINE_BULLET, true) \
    member(BACKEND_SIMBODY, "simbody", ENGINE_SIMBODY, true) \
    member(BACKEND_DRIVER, "driver", ENGINE_DRIVER, true)

// The solvers, see model/solver.h, and whether they model play: others take every joint as ideal.
#define OPTIONS_BACKEND_LIST(member) \
    member(BACKEND_ANALYTIC, "analytic", ANALYTIC_SOLVER, false) \
    member(BACKEND_REFERENCE, "reference", REFERENCE_SOLVER, true) \
    member(BACKEND_ODE, "ode", ODE_SOLVER, true) \
    OPTIONS_ENGINE_LIST(member)

// The way in which an engine runs a case, of those that its driver has; the first is whichever of
// these it has, in this order.
#define OPTIONS_ENGINE_WAY_LIST(member) \
    member(ENGINE_WAY_BEST, "best") \
    member(ENGINE_WAY_KERNEL, "kernel") \
    member(ENGINE_WAY_ADAPTIVE, "adaptive") \
    member(ENGINE_WAY_STAGGERED, "staggered") \
    member(ENGINE_WAY_FORCE, "force") \
    member(ENGINE_WAY_NATIVE, "native")

// The model of what happens where pin and hole overlap: spring and damper, force from penetration
// and its rate; or velocity-level penalty with restitution, force from closing speed.
#define OPTIONS_CONTACT_MODEL_LIST(member) \
    member(CONTACT_IMPACT, "impact") \
    member(CONTACT_POISSON, "poisson")

// The law of friction; its members are those of kernel/bristle.h, in their order.
#define OPTIONS_FRICTION_LAW_LIST(member) \
    member(BRISTLE_REGULARIZED, "regularized") \
    member(BRISTLE_STICK, "stick") \
    member(BRISTLE_LUGRE, "lugre")

// The polygon that a collider takes a round hole for: its sides touch the circle at their middles,
// or its corners lie on the circle, as those of meshes from CAD do.
#define OPTIONS_ODE_POLYGON_LIST(member) \
    member(ODE_CIRCUMSCRIBED, "circumscribed") \
    member(ODE_INSCRIBED, "inscribed")

// The error that a tolerance is of; see measure/error.h.
#define OPTIONS_TOLERANCE_OF_LIST(member) \
    member(TOLERANCE_OF_MOTION, "motion") \
    member(TOLERANCE_OF_FORCES, "forces") \
    member(TOLERANCE_OF_PEAKS, "peaks")

// clang-format on
#define OPTIONS_ENUMERATOR(id, ...) id,

typedef enum LawKind { OPTIONS_LAW_LIST(OPTIONS_ENUMERATOR) LAW_COUNT } LawKind;
#define OPTIONS_DAMPING_ENUMERATOR(name, ...) DAMPING_##name,
typedef enum DampingKind {
    OPTIONS_DAMPING_LIST(OPTIONS_DAMPING_ENUMERATOR) DAMPING_COUNT
} DampingKind;
#define OPTIONS_ODE_MAP_ENUMERATOR(name, word, row) ODE_MAP_##name,
typedef enum OdeMap {
    OPTIONS_ODE_ROW_MAP_LIST(OPTIONS_ODE_MAP_ENUMERATOR) ODE_MAP_IMPULSE,
    ODE_MAP_COUNT
} OdeMap;
typedef enum OdeSolver { OPTIONS_ODE_SOLVER_LIST(OPTIONS_ENUMERATOR) ODE_SOLVER_COUNT } OdeSolver;
typedef enum OdeStepping {
    OPTIONS_ODE_STEPPING_LIST(OPTIONS_ENUMERATOR) ODE_STEPPING_COUNT
} OdeStepping;
typedef enum OdeCollider {
    OPTIONS_ODE_COLLIDER_LIST(OPTIONS_ENUMERATOR) ODE_COLLIDER_COUNT
} OdeCollider;
typedef enum ToleranceOf {
    OPTIONS_TOLERANCE_OF_LIST(OPTIONS_ENUMERATOR) TOLERANCE_OF_COUNT
} ToleranceOf;
typedef enum BackendKind { OPTIONS_BACKEND_LIST(OPTIONS_ENUMERATOR) BACKEND_COUNT } BackendKind;
typedef enum EngineWay { OPTIONS_ENGINE_WAY_LIST(OPTIONS_ENUMERATOR) ENGINE_WAY_COUNT } EngineWay;
typedef enum ContactModel {
    OPTIONS_CONTACT_MODEL_LIST(OPTIONS_ENUMERATOR) CONTACT_MODEL_COUNT
} ContactModel;
typedef enum RunStart { OPTIONS_RUN_START_LIST(OPTIONS_ENUMERATOR) RUN_START_COUNT } RunStart;
typedef enum OdePolygon {
    OPTIONS_ODE_POLYGON_LIST(OPTIONS_ENUMERATOR) ODE_POLYGON_COUNT
} OdePolygon;

// The words that stand for the choices above, in their order; each list ends in NULL.
extern const char *const OPTIONS_CONTACT_MODELS[];
extern const char *const OPTIONS_LAWS[];
extern const char *const OPTIONS_FRICTION_LAWS[];
extern const char *const OPTIONS_DAMPINGS[];
extern const char *const OPTIONS_RUN_STARTS[];
extern const char *const OPTIONS_ODE_SOLVERS[];
extern const char *const OPTIONS_TOLERANCES_OF[];
extern const char *const OPTIONS_ODE_STEPPINGS[];
extern const char *const OPTIONS_ODE_MAPS[];
extern const char *const OPTIONS_ODE_COLLIDERS[];
extern const char *const OPTIONS_ODE_POLYGONS[];
extern const char *const OPTIONS_BACKENDS[];
extern const char *const OPTIONS_ENGINE_WAYS[];

// By OdeStepping: whether it is for every case.
extern const bool OPTIONS_ODE_STEPPING_IS_GENERAL[];

// By BackendKind, and by the backend's name.
extern const bool OPTIONS_BACKEND_HAS_PLAY[];
bool options_backend_has_play(const char *backend);

// Whether a backend is another engine; whether it takes steps of run.step, as ODE and engines do.
bool options_is_engine(BackendKind backend);
bool options_is_stepped(BackendKind backend);

typedef struct MaterialOptions {
    double youngs_modulus; // Pa, of pin and hole alike
    double poisson_ratio;  // 1
} MaterialOptions;

typedef struct ContactOptions {
    ContactModel model;
    LawKind law;
    double stiffness; // N/m^exponent; 0: from the law, the material and the joint
    double exponent;  // 1, of a given stiffness
    double for_depth; // m, the depth that the stiffness was given for; 0: it was not given so
    bool is_for_all;  // whether it holds for joints that have a stiffness of their own, too
    DampingKind damping;
    bool is_damping_for_all;    // no key: whether it holds for joints that have their own, too
    double viscous_coefficient; // N s/m, of DAMPING_VISCOUS, and of DAMPING_STEP at the depth of:
    double full_damping_depth;  // m
    double dissipation;         // s/m, c of DAMPING_DISSIPATION, F = F_el (1 + c d'); 0: that which
                                // gives back the restitution of an impact at the speed below
    double restitution_speed;   // m/s
    double restitution;         // 1, asked for
    double friction;            // 1, Coulomb's coefficient; 0 for none
    double damping_scale;       // no key, 1: times which hysteretic and viscous damping are taken
    double friction_speed;      // m/s, sliding speed over which the reference's friction sets in
    BristleLaw friction_law;    // of all joints without their own, like the next three
    double breakaway_ratio;     // 1, static over sliding friction
    double presliding;          // m, how far a bristle bends before it slides
    double presliding_damping;  // 1, damping ratio with which it does
    double impact_speed_floor;  // m/s, smallest impact speed the damping laws divide by
    double resting_speed;       // m/s, by which they divide where a contact has outlasted its
                          // impact (kernel/contact_state.h); 0: by that of its impact for ever
    double penalty;      // N s/m, of CONTACT_POISSON; 0: the paper's Eq. (9) at the speed
    double bounce_speed; // m/s, CONTACT_POISSON: slower impacts do not bounce
} ContactOptions;

enum { OPTIONS_REASON_SIZE = 256 }; // of a sentence with two names

typedef struct RunOptions {
    double revolutions; // of a driver of constant speed
    double duration;    // s, where there is none
    size_t samples;     // per revolution of that driver, or in the whole run without it
    RunStart start;
    // no key: why a case that does not name its start does not settle; empty: it settles, or names
    // it
    char centred_because[OPTIONS_REASON_SIZE];
    bool is_start_given;  // no key: whether the case names its start
    size_t settle_starts; // of START_SETTLED: from which it is looked for
    size_t settle_least;  // revolutions watched before a start is said not to repeat
    size_t settle_most;   // until it is taken as it is
    double settle_to;     // 1: the half width of the interval of a largest force, over it
    double settle_budget; // s of processor time
    double budget;        // s of processor time of each engine in `run`; 0: none
    double interval;      // no key, s: samples stand so far apart, as many as the run has room
                          // for; 0: as `samples` says
    double step;          // s; 0: chosen for the tolerance
    double tolerance;     // 1, largest error wanted of a step that is chosen
    ToleranceOf tolerance_of;
    size_t most_steps;      // world steps of all trials of a step that is chosen
    double spike_threshold; // 1, least prominence of a spike over what ideal joints show
    double report_from;     // s, or turns of the driver; what is before is not reported
    bool is_report_from_in_turns;
    size_t backend_count;
    BackendKind backends[BACKEND_COUNT];
    bool keeps_ranges;   // no key: whether somebody reads what signals did between the samples
    bool keeps_contacts; // no key: whether somebody reads all contacts, and not the strongest alone
    bool keeps_marks;    // no key: whether somebody draws contacts
    bool is_lean; // no key: extremes and contacts are all that is read; energies, the forces of
                  // ideal joints and the hash are left out where that saves anything
} RunOptions;

typedef struct ReferenceOptions {
    double tolerance; // 1, of each step's error, relative to the size of each coordinate and speed
} ReferenceOptions;

typedef struct OdeOptions {
    OdeSolver solver;
    OdeStepping stepping;
    OdeMap map;
    OdeCollider collider;
    OdePolygon polygon;     // of every collider but ODE_COLLIDER_PIN_HOLE
    size_t facets;          // likewise: sides of the polygon; 0: from play and depth
    double erp;             // 1, of the ideal joints' rows, per step
    double cfm;             // s/kg = m/(N s), of the ideal joints' rows
    double push_out;        // 1, ERP of CONTACT_POISSON rows
    size_t iterations;      // of ODE_QUICK
    double over_relaxation; // 1, of ODE_QUICK
    size_t seed;            // of the order in which ODE_QUICK visits rows
    size_t settle_steps;    // of ODE_PLAIN: run before time zero where every joint is ideal
    size_t levels;          // of ODE_EXTRAPOLATED: worlds side by side
    size_t gear;            // of ODE_MAP_IMPULSE: by how much steps are finer near a wall
    bool is_frozen;       // of ODE_MAP_IMPULSE: bodies answer contacts as at mid-step throughout a
                          // step, as in space and in worlds of callers; no key of a case
    double contact_phase; // rad, of ODE_MAP_IMPULSE: how accurate local steps of contacts are, as
                          // classical steps of that phase; 0: as the step of the world allows
} OdeOptions;

// How another engine runs a case.
typedef struct EngineOptions {
    EngineWay way;
    const char *driver;  // no key: NAME=PROGRAM, as --driver has it, in place of the driver that
                         // came with the program; NULL: none. Not owned
    double time_limit_s; // no key: of one run, by the clock on the wall; 0: the usual one
} EngineOptions;

// s, the step where a case names a way of stepping but no step: one that is chosen has its own way.
extern const double OPTIONS_GIVEN_STEP;

MaterialOptions material_options_default(void);
ContactOptions contact_options_default(void);
RunOptions run_options_default(void);
ReferenceOptions reference_options_default(void);
OdeOptions ode_options_default(void);
