// Every choice and every default of the program. Options are SI and radians.
#pragma once

#include <stdbool.h>
#include <stddef.h>

// Families of alternatives that are meant to grow: one line a member, its enumerator, its word in a
// case and, where the member is an object, that. The enumeration, the list of words and the
// registry follow from it, in this order.

// clang-format off

// The elastic laws, F(penetration); see contact/law.h.
#define OPTIONS_LAW_LIST(member) \
    member(LAW_HERTZ_SOCKET, "hertz-socket", law_hertz_socket) \
    member(LAW_JOHNSON, "johnson", law_johnson) \
    member(LAW_RADZIMOVSKY, "radzimovsky", law_radzimovsky) \
    member(LAW_ESDU_78035, "esdu-78035", law_esdu_78035) \
    member(LAW_DUBOWSKY_FREUDENSTEIN, "dubowsky-freudenstein", law_dubowsky_freudenstein) \
    member(LAW_PAPER_TABLE_2, "paper-table-2", law_paper_table_2) \
    member(LAW_PAPER_TABLE_3, "paper-table-3", law_paper_table_3)

// Where the energy of an impact goes; see contact/damping.h. The name follows DAMPING_ here and
// JP_DAMPING_ in the library; the function is that of contact/damping.c that gives the factor.
#define OPTIONS_DAMPING_LIST(member) \
    member(NONE, "none", none) \
    member(LANKARANI_NIKRAVESH, "lankarani-nikravesh", lankarani_nikravesh) \
    member(HUNT_CROSSLEY, "hunt-crossley", hunt_crossley) \
    member(FLORES, "flores", flores) \
    member(GONTHIER, "gonthier", gonthier) \
    member(HU_GUO, "hu-guo", hu_guo) \
    member(EXACT, "exact", exact) \
    member(VISCOUS, "viscous", none)

// How stiffness and damping become ERP and CFM; see contact/map.h. Last the one that makes no row:
// with ODE_STAGGERED the contact is integrated within the step.
#define OPTIONS_ODE_MAP_LIST(member) \
    member(ODE_MAP_TEXTBOOK, "textbook") \
    member(ODE_MAP_CORRECTED, "corrected") \
    member(ODE_MAP_MIDPOINT, "midpoint") \
    member(ODE_MAP_EXACT, "exact") \
    member(ODE_MAP_IMPULSE, "impulse")

// When ODE's positions and speeds are taken to be; see ode/stepping.h. Plain: both at the end of the
// step, as ODE's manual has it. Staggered: positions half a step behind, a leapfrog. Extrapolated:
// several staggered worlds of different steps, for ideal joints.
#define OPTIONS_ODE_STEPPING_LIST(member) \
    member(ODE_PLAIN, "plain", STEPPING_PLAIN) \
    member(ODE_STAGGERED, "staggered", STEPPING_STAGGERED) \
    member(ODE_EXTRAPOLATED, "extrapolated", STEPPING_EXTRAPOLATED)

// How ODE learns that a pin touches the wall of its hole; see ode/plane/collider.h. First the exact one;
// all others take the hole for a polygon.
#define OPTIONS_ODE_COLLIDER_LIST(member) \
    member(ODE_COLLIDER_PIN_HOLE, "pin-hole", collider_pin_hole) \
    member(ODE_COLLIDER_STAVES, "staves", collider_staves) \
    member(ODE_COLLIDER_STAVES_GJK, "staves-gjk", collider_staves_gjk) \
    member(ODE_COLLIDER_CONVEX, "ode-convex", collider_convex) \
    member(ODE_COLLIDER_TRIMESH, "trimesh", collider_trimesh)

// The solvers, see model/solver.h, and whether they model play: others take every joint as ideal.
#define OPTIONS_BACKEND_LIST(member) \
    member(BACKEND_ANALYTIC, "analytic", ANALYTIC_SOLVER, false) \
    member(BACKEND_REFERENCE, "reference", REFERENCE_SOLVER, true) \
    member(BACKEND_ODE, "ode", ODE_SOLVER, true)

// clang-format on
#define OPTIONS_ENUMERATOR(id, ...) id,

typedef enum LawKind { OPTIONS_LAW_LIST(OPTIONS_ENUMERATOR) LAW_COUNT } LawKind;
#define OPTIONS_DAMPING_ENUMERATOR(name, word, factor) DAMPING_##name,
typedef enum DampingKind {
    OPTIONS_DAMPING_LIST(OPTIONS_DAMPING_ENUMERATOR) DAMPING_COUNT
} DampingKind;
typedef enum OdeMap { OPTIONS_ODE_MAP_LIST(OPTIONS_ENUMERATOR) ODE_MAP_COUNT } OdeMap;
typedef enum OdeStepping {
    OPTIONS_ODE_STEPPING_LIST(OPTIONS_ENUMERATOR) ODE_STEPPING_COUNT
} OdeStepping;
typedef enum OdeCollider {
    OPTIONS_ODE_COLLIDER_LIST(OPTIONS_ENUMERATOR) ODE_COLLIDER_COUNT
} OdeCollider;
typedef enum BackendKind { OPTIONS_BACKEND_LIST(OPTIONS_ENUMERATOR) BACKEND_COUNT } BackendKind;

// The model of what happens where pin and hole overlap.
typedef enum ContactModel {
    CONTACT_IMPACT,  // spring and damper: force from penetration and its rate
    CONTACT_POISSON, // velocity-level penalty with restitution: force from closing speed
} ContactModel;

typedef enum OdeSolver { ODE_DIRECT, ODE_QUICK } OdeSolver;

// The polygon that a collider takes a round hole for.
typedef enum OdePolygon {
    ODE_CIRCUMSCRIBED, // its sides touch the circle at their middles
    ODE_INSCRIBED,     // its corners lie on the circle, as those of meshes from CAD do
} OdePolygon;

// The words that stand for the choices above, in their order; each list ends in NULL.
extern const char *const OPTIONS_CONTACT_MODELS[];
extern const char *const OPTIONS_LAWS[];
extern const char *const OPTIONS_DAMPINGS[];
extern const char *const OPTIONS_ODE_SOLVERS[];
extern const char *const OPTIONS_ODE_STEPPINGS[];
extern const char *const OPTIONS_ODE_MAPS[];
extern const char *const OPTIONS_ODE_COLLIDERS[];
extern const char *const OPTIONS_ODE_POLYGONS[];
extern const char *const OPTIONS_BACKENDS[];

// By BackendKind, and by the backend's name.
extern const bool OPTIONS_BACKEND_HAS_PLAY[];
bool options_backend_has_play(const char *backend);

typedef struct MaterialOptions {
    double youngs_modulus; // Pa, of pin and hole alike
    double poisson_ratio;  // 1
} MaterialOptions;

typedef struct ContactOptions {
    ContactModel model;
    LawKind law;
    double stiffness; // N/m^exponent; 0: from the law, the material and the joint
    double exponent;  // 1, of a given stiffness
    bool is_for_all;  // whether it holds for joints that have a stiffness of their own, too
    DampingKind damping;
    double viscous_coefficient; // N s/m, of DAMPING_VISCOUS
    double restitution;         // 1, asked for
    double friction;            // 1, Coulomb's coefficient; 0 for none
    double friction_speed;      // m/s, sliding speed over which the reference's friction sets in
    double impact_speed_floor;  // m/s, smallest impact speed the damping laws divide by
    double penalty;             // N s/m, of CONTACT_POISSON; 0: the paper's Eq. (9) at the speed
    double bounce_speed;        // m/s, CONTACT_POISSON: slower impacts do not bounce
} ContactOptions;

typedef struct RunOptions {
    double revolutions;     // of a driver of constant speed
    double duration;        // s, where there is none
    size_t samples;         // per revolution of that driver, or in the whole run without it
    double interval;        // no key, s: samples stand so far apart, as many as the run has room
                            // for; 0: as `samples` says
    double step;            // s; 0: chosen for the tolerance
    double tolerance;       // 1, largest error wanted of a step that is chosen
    size_t most_steps;      // world steps of all trials of a step that is chosen
    double spike_threshold; // 1, least prominence of a spike over what ideal joints show
    double report_from;     // s, or turns of the driver; what is before is not reported
    bool is_report_from_in_turns;
    size_t backend_count;
    BackendKind backends[BACKEND_COUNT];
    bool keeps_ranges; // no key: whether somebody reads what signals did between the samples
    bool is_lean; // no key: extremes and contacts are all that is read; energies, the forces of
                  // ideal joints and the hash are left out where that saves anything
} RunOptions;

typedef struct ReferenceOptions {
    double tolerance; // 1, of each step's error, relative to the size of each coordinate and speed
} ReferenceOptions;

// The loosest tolerance that the reference works with, and the one that it works with where so much
// is asked for, 1.
extern const double OPTIONS_REFERENCE_LOOSEST;
double options_reference_tolerance(const ReferenceOptions *options);

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

// s, the step where a case names a way of stepping but no step: one that is chosen has its own way.
extern const double OPTIONS_GIVEN_STEP;

MaterialOptions material_options_default(void);
ContactOptions contact_options_default(void);
RunOptions run_options_default(void);
ReferenceOptions reference_options_default(void);
OdeOptions ode_options_default(void);
