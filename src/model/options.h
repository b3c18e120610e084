// Every choice and every default of the program. Options are SI and radians.
#pragma once

#include <stdbool.h>
#include <stddef.h>

// The model of what happens where pin and hole overlap.
typedef enum ContactModel {
    CONTACT_IMPACT,  // spring and damper: force from penetration and its rate
    CONTACT_POISSON, // velocity-level penalty with restitution: force from closing speed
} ContactModel;

// The elastic law, F(penetration).
typedef enum LawKind {
    LAW_HERTZ_SOCKET,          // sphere in a spherical socket, the paper's Eq. (3)
    LAW_JOHNSON,               // cylinder in a cylindrical hole
    LAW_RADZIMOVSKY,           // cylinders
    LAW_ESDU_78035,            // cylinder in a hole
    LAW_DUBOWSKY_FREUDENSTEIN, // cylinder in a hole
    LAW_PAPER_TABLE_2,         // linear, k = 2 a E* with the paper's a
    LAW_PAPER_TABLE_3,         // the power law behind the paper's Table III
} LawKind;

// Where the energy of an impact goes.
typedef enum DampingKind {
    DAMPING_NONE,
    DAMPING_LANKARANI_NIKRAVESH,
    DAMPING_HUNT_CROSSLEY,
    DAMPING_FLORES,
    DAMPING_GONTHIER,
    DAMPING_HU_GUO,
    DAMPING_EXACT,   // the factor that delivers the restitution asked for
    DAMPING_VISCOUS, // a constant coefficient
} DampingKind;

typedef enum OdeSolver { ODE_DIRECT, ODE_QUICK } OdeSolver;
typedef enum OdeCollider { ODE_COLLIDER_PIN_HOLE } OdeCollider;

// When ODE's positions and speeds are taken to be.
typedef enum OdeStepping {
    ODE_PLAIN,        // both at the end of the step, as ODE's manual has it
    ODE_STAGGERED,    // positions half a step behind: a leapfrog
    ODE_EXTRAPOLATED, // several staggered worlds of different steps, for ideal joints
} OdeStepping;

// How stiffness and damping become ERP and CFM, or the contact's impulse a force.
typedef enum OdeMap {
    ODE_MAP_TEXTBOOK,
    ODE_MAP_CORRECTED,
    ODE_MAP_MIDPOINT,
    ODE_MAP_EXACT,
    ODE_MAP_IMPULSE, // no row: the contact is integrated within the step; of ODE_STAGGERED
} OdeMap;

typedef enum BackendKind {
    BACKEND_ANALYTIC,
    BACKEND_REFERENCE,
    BACKEND_ODE,
    BACKEND_COUNT,
} BackendKind;

// The words that stand for the choices above, in their order; each list ends in NULL.
extern const char *const OPTIONS_CONTACT_MODELS[];
extern const char *const OPTIONS_LAWS[];
extern const char *const OPTIONS_DAMPINGS[];
extern const char *const OPTIONS_ODE_SOLVERS[];
extern const char *const OPTIONS_ODE_STEPPINGS[];
extern const char *const OPTIONS_ODE_MAPS[];
extern const char *const OPTIONS_ODE_COLLIDERS[];
extern const char *const OPTIONS_BACKENDS[];

typedef struct MaterialOptions {
    double youngs_modulus; // Pa, of pin and hole alike
    double poisson_ratio;  // 1
} MaterialOptions;

typedef struct ContactOptions {
    ContactModel model;
    LawKind law;
    double stiffness; // N/m^exponent; 0: from the law, the material and the joint
    double exponent;  // 1, of a given stiffness
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
    double revolutions;     // of the driver
    double duration;        // s, where there is no driver
    size_t samples;         // per revolution of the driver, or in the whole run without one
    double step;            // s; 0: chosen for the tolerance
    double tolerance;       // 1, largest error in omega wanted of a step that is chosen
    size_t most_steps;      // world steps of all trials of a step that is chosen
    double spike_threshold; // 1, least prominence of a spike over what ideal joints show
    double report_from;     // s, or turns of the driver; what is before is not reported
    bool is_report_from_in_turns;
    size_t backend_count;
    BackendKind backends[BACKEND_COUNT];
} RunOptions;

typedef struct ReferenceOptions {
    double tolerance; // 1, of each step's error, relative to the size of each coordinate and speed
} ReferenceOptions;

typedef struct OdeOptions {
    OdeSolver solver;
    OdeStepping stepping;
    OdeMap map;
    OdeCollider collider;
    double erp;             // 1, of the ideal joints' rows, per step
    double cfm;             // s/kg = m/(N s), of the ideal joints' rows
    double push_out;        // 1, ERP of CONTACT_POISSON rows
    size_t iterations;      // of ODE_QUICK
    double over_relaxation; // 1, of ODE_QUICK
    size_t seed;            // of the order in which ODE_QUICK visits rows
    size_t settle_steps;    // of ODE_PLAIN: run before time zero where every joint is ideal
    size_t levels;          // of ODE_EXTRAPOLATED: worlds side by side
    size_t gear;            // of ODE_MAP_IMPULSE: steps so many times finer near a wall
    double contact_phase;   // rad, of ODE_MAP_IMPULSE: a contact's own oscillation in a local step
} OdeOptions;

// s, the step where a case names a way of stepping but no step: one that is chosen has its own way.
extern const double OPTIONS_GIVEN_STEP;

MaterialOptions material_options_default(void);
ContactOptions contact_options_default(void);
RunOptions run_options_default(void);
ReferenceOptions reference_options_default(void);
OdeOptions ode_options_default(void);
