/* jointplay: joints with play and backlash for any world of the Open Dynamics Engine (ODE), and
 * what an ERP and a CFM stand for.
 *
 * C17 and C++17. Everything is in the units of your world, written here as SI: metres, kilograms,
 * seconds, radians. What is said of a mass, a force and a length holds of an inertia, a torque and
 * an angle alike.
 *
 * A function that can fail returns a JpStatus and fills in the JpError behind its last argument,
 * which may be NULL, with one sentence. Errors are above JP_OK, which is 0: what the function was
 * to fill in is untouched then, and a world is as it was before the call. JP_COARSE, below JP_OK,
 * is of jp_world_step alone and no error. With both of these all numbers are finite, but for gaps
 * to sides that do not exist. Sentences number the joints of a world from 1, in the order in which
 * they were created.
 *
 * No function prints, or ends your program. ODE does both where its own numbers go wrong. From the
 * first jp_world_create to the last jp_world_destroy the library has handlers of its own for that
 * (dSetDebugHandler, dSetErrorHandler, dSetMessageHandler), which turn what ODE finds wrong in
 * jp_world_step into a JpStatus, and hand on all else to the handlers that were there before; and
 * for ODE's memory (dSetAllocHandler, dSetReallocHandler), which ask those and turn a lack of it in
 * any call of the library into JP_ERROR_MEMORY. If you set handlers of your own, set them before
 * the first world. Nothing else is kept outside what you hand over.
 *
 * Threads: a thread may use one world while others use other worlds, each with the ODE data of its
 * own (dAllocateODEDataForThread). Worlds that share a space of geoms, and handlers of ODE, belong
 * to one thread at a time. dWorldQuickStep shuffles its rows by a seed of the whole process
 * (dRandSetSeed): its numbers depend on what other threads do. */
#ifndef JOINTPLAY_JOINTPLAY_H
#define JOINTPLAY_JOINTPLAY_H

#include <ode/ode.h>
#include <stdbool.h>
#include <stddef.h>

#ifdef __cplusplus
extern "C" {
#endif

#if defined(__GNUC__)
#define JP_API __attribute__((visibility("default")))
#else
#define JP_API
#endif

typedef enum JpStatus {
    /* the step was made, but it is too long for what happens in it: forces and motion may be wrong
     * by much; jp_world_undo takes it back */
    JP_COARSE = -1,
    JP_OK = 0,
    JP_ERROR_ARGUMENT, /* an argument that no call may have: NULL, NaN, out of range */
    JP_ERROR_NONE,     /* what is asked for does not exist: no such step, no such spring */
    JP_ERROR_MEMORY,   /* there is no memory */
    /* the world cannot be stepped: a number in it is too large or not finite, it has bodies that
     * are not known, a joint's body was destroyed, or ODE failed */
    JP_ERROR_WORLD,
    JP_ERROR_OUTSIDE, /* a pin is outside its hole, or would be after the step */
    JP_ERROR_WORK,    /* the step takes more than the limit of work, however it is made */
} JpStatus;

enum { JP_ERROR_SIZE = 256 };

typedef struct JpError {
    JpStatus status;
    char text[JP_ERROR_SIZE]; /* one sentence; empty where there is no error */
} JpError;

/* The version of the library that is running, such as "0.1.0". */
JP_API const char *jp_version(void);

/* ---- contacts -------------------------------------------------------------------------------
 *
 * Two sides that overlap by d press with F = F_el(d) + D(d) d', never below 0. */

/* How energy is lost. The hysteretic kinds have D = chi F_el / v, v the speed of the impact, with
 * chi from a restitution; JP_DAMPING_EXACT gives back just that restitution, whatever the mass, the
 * stiffness and the speed. */
typedef enum JpDamping {
    JP_DAMPING_NONE,
    JP_DAMPING_LANKARANI_NIKRAVESH,
    JP_DAMPING_HUNT_CROSSLEY,
    JP_DAMPING_FLORES,
    JP_DAMPING_GONTHIER,
    JP_DAMPING_HU_GUO,
    JP_DAMPING_EXACT,
    JP_DAMPING_VISCOUS,     /* D = damper: the spring and damper of kp and kd */
    JP_DAMPING_DISSIPATION, /* D = dissipation F_el: it has no memory of the impact */
    JP_DAMPING_STEP,        /* D = damper x^2 (3 - 2 x), x = min(1, d / full_damping_depth) */
} JpDamping;

enum { JP_SERIES_TERMS = 24 };

typedef struct JpContact {
    double stiffness;  /* K of F_el = K d^exponent, N/m^exponent; 0 of a logarithmic law; with a
                        * play k of F_el = k d / W, N/m */
    double exponent;   /* 1 */
    double compliance; /* A of d = A F (B - ln F), m/N: a cylinder in a hole; else 0 */
    double offset;     /* B, 1, F in N */
    JpDamping damping;
    double restitution; /* 1, 0 to 1, of the hysteretic kinds; some want more than 0 */
    double damper;      /* N s/m, of JP_DAMPING_VISCOUS and JP_DAMPING_STEP */
    double dissipation; /* s/m, of JP_DAMPING_DISSIPATION */
    double speed_floor; /* m/s, > 0: slower impacts are damped as if they had this speed */
    /* m/s, of the hysteretic kinds: a contact that has outlasted its impact (it was compressed,
     * released, and is compressed again) is damped as if it had this speed; 0: as at its impact */
    double resting_speed;
    /* m, of a pin in the hole of an eye, by elasticity, else 0: W = series[0] + series[1] x + .., x
     * linear in ln(1 + ln(1 + play / d)), -1 at 30 plays and 1 at 1e-8 (JP_PIN_ELASTIC) */
    double play;
    double series[JP_SERIES_TERMS];
    double full_damping_depth; /* m, > 0, of JP_DAMPING_STEP */
} JpContact;

/* No stiffness yet; exponent 1, JP_DAMPING_EXACT, restitution .5, speed floor 1e-6, no resting
 * speed. */
JP_API JpContact jp_contact_default(void);
JP_API JpStatus jp_contact_check(const JpContact *contact, JpError *error);

/* The elastic laws of a round pin in a round hole. JP_PIN_ELASTIC, of an eye that is clamped on its
 * outer circle, follows from elasticity; for others see docs/equations.md. */
typedef enum JpPinLaw {
    JP_PIN_HERTZ,
    JP_PIN_JOHNSON,
    JP_PIN_RADZIMOVSKY,
    JP_PIN_ESDU_78035,
    JP_PIN_DUBOWSKY_FREUDENSTEIN,
    JP_PIN_ELASTIC,
} JpPinLaw;

typedef struct JpPin {
    double hole_radius;    /* m */
    double pin_radius;     /* m, smaller */
    double width;          /* m, over which they touch; not of JP_PIN_HERTZ */
    double youngs_modulus; /* Pa */
    double poisson_ratio;  /* 1 */
    double eye_radius;     /* m, outer radius of what has the hole, of JP_PIN_ELASTIC: at least 1.2
                            * times hole_radius; 0: twice hole_radius */
    double pin_modulus;    /* Pa, of a pin of another material; 0: as above */
    double pin_ratio;      /* 1, likewise; of a pin_modulus above 0 alone */
} JpPin;

/* Fills in stiffness and exponent, compliance and offset, and play and series; the rest of the
 * contact stays. */
JP_API JpStatus jp_contact_of_pin(JpPinLaw law, const JpPin *pin, JpContact *contact,
                                  JpError *error);

/* The damper, N s/m, beside a linear spring, N/m, that gives back a restitution, 0 < e <= 1, of an
 * impact of a mass, kg; and the restitution that a spring and a damper give back. */
JP_API JpStatus jp_damper_of(double stiffness, double restitution, double mass, double *damper,
                             JpError *error);
JP_API JpStatus jp_restitution_of(double stiffness, double damper, double mass, double *restitution,
                                  JpError *error);

/* ---- from a contact to ERP and CFM, and back ------------------------------------------------
 *
 * One row of ODE, be it a contact's with soft_erp and soft_cfm or a joint stop's with dParamStopERP
 * and dParamStopCFM, F >= 0:  v_out + CFM F = (ERP / h) d,  v_out the speed with which the sides
 * part after the step of h. */

typedef enum JpMap {
    JP_MAP_TEXTBOOK,  /* ERP = h k / (h k + c), CFM = 1 / (h k + c): adds a damper h k; any step */
    JP_MAP_CORRECTED, /* ERP = h k / c, CFM = 1 / c: adds none; omega h < 2 */
    JP_MAP_MIDPOINT,  /* the damper on the mean of both speeds: for steps whose positions stand at
                         mid-step; omega h < 2 */
    JP_MAP_EXACT,     /* frequency and decay of that mass on that spring; omega h < pi */
} JpMap;

/* The contact as a step finds it. */
typedef struct JpInstant {
    double depth;        /* m, > 0 */
    double closing;      /* m/s, rate of the depth */
    double impact_speed; /* m/s, with which this contact began */
    double mass;         /* kg, effective along the normal; of JP_MAP_EXACT alone */
    double step;         /* s */
} JpInstant;

typedef struct JpRow {
    double erp;  /* 1; above 1 in every map but the textbook's where damping is weak */
    double cfm;  /* m/(N s) */
    double rest; /* 1: 1 - erp with the digits that are lost where erp rounds to 1 */
} JpRow;

/* The row of a contact at an instant. */
JP_API JpStatus jp_row(JpMap map, const JpContact *contact, const JpInstant *instant, JpRow *row,
                       JpError *error);

/* The row of an ERP and a CFM that come from elsewhere. */
JP_API JpRow jp_row_of(double erp, double cfm);

/* The spring and damper whose row this is. Depth and closing speed are looked at in
 * JP_MAP_MIDPOINT, the mass in JP_MAP_EXACT. JP_ERROR_NONE where no spring k >= 0 and damper c >= 0
 * make that row. */
typedef struct JpSpring {
    double stiffness; /* N/m */
    double damper;    /* N s/m */
} JpSpring;
JP_API JpStatus jp_spring_of(JpMap map, JpRow row, const JpInstant *instant, JpSpring *spring,
                             JpError *error);

/* The row that Gazebo makes of its kp and kd at its step, by the textbook's map. What spring and
 * damper ODE makes of that row jp_spring_of says by JP_MAP_CORRECTED: kp, and kd + h kp. */
JP_API JpStatus jp_row_of_gazebo(double kp, double kd, double step, JpRow *row, JpError *error);

/* The restitution that ODE's own bounce of a contact or a stop delivers beside a CFM, m/(N s):
 * (e - r) / (1 + r), r = CFM m / h. Negative: the sides stay together and sink in. */
JP_API JpStatus jp_bounce_of_row(double bounce, double cfm, double mass, double step,
                                 double *restitution, JpError *error);

/* ---- what that delivers ---------------------------------------------------------------------- */

/* One impact of a mass, at a speed. */
typedef struct JpImpact {
    double restitution; /* 1 */
    double peak;        /* N */
    double depth;       /* m, largest */
    double duration;    /* s, of the overlap */
} JpImpact;

/* What the contact's own law gives, to 1e-6; JP_ERROR_NONE where it gives no such impact. */
JP_API JpStatus jp_impact_of_law(const JpContact *contact, double mass, double speed,
                                 JpImpact *impact, JpError *error);

/* The same, stepped by ODE on rows of a map: over 16 phases, for it is an accident where steps
 * fall. A row beyond the map's limit is the textbook's, as it is in a world of this library. */
typedef struct JpDelivered {
    JpImpact mean;
    JpImpact least; /* each number by itself */
    JpImpact most;
    double omega_h;   /* 1, largest: the contact's own oscillation in a step, rad */
    size_t fallbacks; /* rows of all phases beyond the map's limit */
} JpDelivered;
JP_API JpStatus jp_impact_of_rows(JpMap map, const JpContact *contact, double mass, double speed,
                                  double step, JpDelivered *delivered, JpError *error);

/* Whether a step is short enough: restitution, peak and depth within a share of the law's in every
 * phase, and every row within the map's limit. */
JP_API JpStatus jp_step_is_right(JpMap map, const JpContact *contact, double mass, double speed,
                                 double step, double share, bool *is_right, JpError *error);

/* The longest such step, s, from which on shorter ones are right, too; JP_ERROR_NONE where none is
 * found down to a ten-thousandth of the contact. */
JP_API JpStatus jp_step_longest(JpMap map, const JpContact *contact, double mass, double speed,
                                double share, double *step, JpError *error);

/* ---- worlds ----------------------------------------------------------------------------------
 *
 * A JpWorld steps your world with the library's joints in it. The world, its bodies, joints and
 * contacts remain yours; destroy a JpJoint before the ODE joint that it acts on, and the JpWorld
 * before the world. A JpJoint whose body was destroyed is noticed: steps fail until it is
 * destroyed, too. Bodies of pins have one more joint each in ODE, without rows, for that. Between
 * two steps ODE's getters read all positions and velocities at the same time. */

typedef struct JpWorld JpWorld;
typedef struct JpJoint JpJoint;

typedef enum JpStepping {
    JP_STEPPING_PLAIN,     /* as ODE steps: order 1; rows of JP_MAP_MIDPOINT */
    JP_STEPPING_STAGGERED, /* forces at mid-step: order 2 at the same cost; rows of JP_MAP_MIDPOINT
                            */
    JP_STEPPING_IMPULSE,   /* the same with the library's contacts integrated within the step,
                              however short they are: n + 4 steps of ODE where joints touch in
                              n rows, one of a hinge or slider, two to nine of an end of a pin;
                              fewer where steps are short, more where bounds are passed */
} JpStepping;

typedef struct JpWorldOptions {
    JpStepping stepping;
    bool is_quick; /* dWorldQuickStep instead of dWorldStep: its rows are as accurate as its
                      iterations */
    /* Called once a step with the bodies where forces are evaluated, to make the step's contacts
     * there; with staggered steps that is half a step later. May be NULL. Contacts made before
     * the step are used as well, but are then half a step old. */
    void (*collide)(dWorldID world, void *data);
    void *collide_data;
    /* At that time the library makes the contacts of all pairs of geoms in this space, except of
     * bodies that a joint connects, and removes them after the step. It finds the bodies of the
     * geoms. NULL: none. */
    dSpaceID space;
    dSurfaceParameters surface; /* of all of these */
    /* The library gives the world a self-threaded implementation of its own
     * (dWorldSetStepThreadingImplementation), so that each thread may step a world;
     * jp_world_destroy puts back ODE's default. True: the world keeps the implementation that it
     * has, such as a pool of threads of yours, which no other world may use at the same time. */
    bool keeps_threading;
} JpWorldOptions;

/* Staggered, by dWorldStep, without contacts; a surface with ODE's friction of .5. */
JP_API JpWorldOptions jp_world_options_default(void);

/* Options may be NULL for the default. Destroying a world destroys the joints made in it. */
JP_API JpStatus jp_world_create(dWorldID world, const JpWorldOptions *options, JpWorld **created,
                                JpError *error);
JP_API void jp_world_destroy(JpWorld *world);

/* Add bodies that no chain of joints connects with a joint of the library, so that they are stepped
 * like all others, and remove them before they are destroyed. The library finds the others. */
JP_API JpStatus jp_world_add_body(JpWorld *world, dBodyID body, JpError *error);
JP_API JpStatus jp_world_remove_body(JpWorld *world, dBodyID body, JpError *error);

/* Adds all bodies that the world has now. JP_ERROR_NONE with a version of ODE that does not let
 * them be found; then add each. Not while another thread uses the world. */
JP_API JpStatus jp_world_add_all(JpWorld *world, JpError *error);

/* One step, s, from 1e-30 to 1e30, in place of dWorldStep. Forces that were added to bodies act in
 * it. Positions, velocities and forces above 1e50 are refused. Where it fails, bodies, forces and
 * joints are as before, so that it may be tried again, shorter or with the cause removed.
 *
 * JP_COARSE: the step was made, but one of these holds, which the sentence says:
 *  - a row of a contact is beyond the limit of its map and presses as the textbook's;
 *  - with rows, an impact or half an oscillation of a contact lasts less than three steps;
 *  - with rows, a joint crosses its play within the step;
 *  - but with JP_STEPPING_PLAIN, before a step that is longer than the one before, or the first,
 *    ODE's joints are open or forbid the speeds of bodies, so that they correct more than a
 *    hundredth of the kinetic energy at once. Speeds that you give to bodies are to be those that
 *    your joints allow: later on, nothing tells them from those of an impact;
 *  - ODE's solver says that it did not find all forces ("LCP internal error");
 *  - with JP_STEPPING_IMPULSE, the response of the world was not found in four rounds, or at the
 *    step's end the bodies are so far from where its contacts have brought them that a force is
 *    uncertain by a hundredth, or the contacts take more than the limit of work or local steps than
 *    make sense, and were made with rows.
 * JP_ERROR_OUTSIDE: a pin is further beyond the wall of its hole, or a collar, than jp_pin_create
 * allows, before the step or after it.
 * A step
 * that ODE breaks off costs the memory that ODE had in use for it, once each time. With a threading
 * implementation of yours (keeps_threading) ODE still ends the program where it fails in a thread
 * of that, and the world must not be stepped again after a step that ODE broke off. */
JP_API JpStatus jp_world_step(JpWorld *world, double step, JpError *error);

/* Takes back the last step, of any status, once: bodies, the forces on them, joints and counts are
 * as before it, so that it may be made anew in shorter ones. JP_ERROR_NONE where there is none, or
 * where bodies or joints were made known to the world or destroyed by functions of this library
 * since. Bodies must not have been destroyed since. What ODE alone counts, such as the time after
 * which a body is disabled, stays. */
JP_API JpStatus jp_world_undo(JpWorld *world, JpError *error);

/* What a world carries from step to step, as bytes that are yours: how its bodies move, what the
 * contacts of its joints remember (whether they touch, since when, at which speed they began), its
 * rotors, and how long the next local steps are to be. They are for a world of the same version of
 * the library on the same machine, with the same bodies and joints made known to it in the same
 * order, in another process if you like: it continues as the world that was saved does, at equal
 * steps bit for bit where the library makes the forces (JP_STEPPING_STAGGERED, JP_STEPPING_IMPULSE,
 * pins and stops that touch at one place), else to rounding, for what ODE keeps for itself is no
 * part of it. Nor are its random numbers, and what it counts, such as the time after which a body
 * is disabled.
 *
 * jp_world_save writes *size, and where `state` has so many bytes, the state; with `state` NULL the
 * size alone. The answers of bodies that were found in earlier steps are forgotten, so that both
 * worlds find them anew, and the last step can no longer be taken back. JP_ERROR_ARGUMENT where
 * `room` is too small; JP_ERROR_WORLD where a number of the world is none that it could go on with.
 *
 * jp_world_resume puts a state into a world; JP_ERROR_ARGUMENT, the world untouched, where it is
 * not one of a world like this, of another format than this library's, or damaged: its checksum
 * differs, or a number in it is none that a world can have, such as one that is not finite. */
JP_API JpStatus jp_world_save(JpWorld *world, void *state, size_t room, size_t *size,
                              JpError *error);
JP_API JpStatus jp_world_resume(JpWorld *world, const void *state, size_t size, JpError *error);

/* How much one step may take, in operations on one pair of rows or bodies; > 0. The default,
 * JP_WORK_DEFAULT, is below about half a second on a machine of 2020. It counts the same on every
 * machine. What would take more is made with rows (JP_COARSE), and fails with JP_ERROR_WORK if that
 * takes more, too. */
#define JP_WORK_DEFAULT 2e8
JP_API JpStatus jp_world_set_work_limit(JpWorld *world, double work, JpError *error);

typedef struct JpWorldStats {
    size_t steps;       /* of jp_world_step */
    size_t world_steps; /* of ODE, with those of trials */
    size_t rows;        /* contacts of the library's joints, summed over the steps */
    size_t fallbacks;   /* rows beyond the limit of their map, which used the textbook's; with
                           JP_STEPPING_IMPULSE steps in which the world did not respond linearly */
    size_t coarse;      /* steps with JP_COARSE */
} JpWorldStats;
JP_API JpStatus jp_world_stats(const JpWorld *world, JpWorldStats *stats, JpError *error);

/* ---- friction -------------------------------------------------------------------------------- */

/* Of what slides at a speed of v, against that, a coefficient of mu and a force F that presses. */
typedef enum JpFrictionLaw {
    /* mu F tanh(v / friction speed): at rest it creeps */
    JP_FRICTION_REGULARIZED,
    /* It holds at rest: at most mu F (1 + (breakaway ratio - 1) exp(-(v / friction speed)^2)). */
    JP_FRICTION_STICK,
} JpFrictionLaw;

/* The dry friction of one of your hinges or sliders, which is ideal but for it, in steps of every
 * JpStepping. Friction that sticks holds its coordinate, but for a slip of 1e-8 of the speed that
 * it would change in a step. With JP_STEPPING_IMPULSE the world's response has a bend where
 * friction begins to slide or to stick, as with a motor of ODE that has a bound: such steps take
 * more of ODE. What presses is ODE's feedback of the joint in the last two steps, extrapolated to
 * the step: of order 2 in smooth motion, and 1 where it jumps, as in impacts. A joint without
 * feedback gets one of the library's (dJointSetFeedback). Regularized friction that would change a
 * speed by more than half the friction speed in a step is a straight line up to mu F there. What
 * acts along the axis of a hinge, and moments across an axis, press on nothing. On a hinge, forces
 * and lengths are torques and angles; its coordinate is that of a joint with play, see below. */
typedef struct JpFriction {
    double steady;      /* N m or N, >= 0, that sliding holds whatever presses; or else */
    double coefficient; /* 1, mu, >= 0, of the joint's force across its axis: one of both is 0 */
    double radius;      /* m, > 0 of a hinge with a coefficient: of its pin, on which that acts */
    JpFrictionLaw law;
    double speed;           /* rad/s or m/s, > 0: the friction speed */
    double breakaway_ratio; /* 1, >= 1, of JP_FRICTION_STICK */
} JpFriction;

/* None yet, which sticks; a speed of 1e-3, a breakaway ratio of 1. */
JP_API JpFriction jp_friction_default(void);
JP_API JpStatus jp_friction_create(JpWorld *world, dJointID joint, const JpFriction *friction,
                                   JpJoint **created, JpError *error);

typedef struct JpFrictionState {
    double position; /* rad or m, of the coordinate */
    double speed;    /* rad/s or m/s */
    double force;    /* N m or N, mean of the last step: on the first body along the coordinate */
    double most;     /* N m or N, that sliding held in it */
    double slid;     /* J, lost since it was made */
    bool is_sticking;
} JpFrictionState;
JP_API JpStatus jp_friction_state(const JpJoint *joint, JpFrictionState *state, JpError *error);

/* ---- joints with play -------------------------------------------------------------------------
 *
 * They act on one of your hinges or sliders, which continues to constrain all but its coordinate:
 * the angle or position of dJointGetHingeAngle or dJointGetSliderPosition, counted beyond half a
 * turn if it turns by less than that in a step. On a hinge, forces and lengths are torques and
 * angles. */

/* Backlash: the teeth of one side are between those of the other with a gap. Without a rotor the
 * gap is between the two bodies. With a rotor (motor and gears, reflected to the joint by the
 * square of the ratio) the rotor's teeth are in the gap. The rotor is a number and not a body: it
 * is driven by jp_backlash_drive, or moved by jp_backlash_lead. The gears press on the two bodies
 * with equal and opposite forces. The rotor's reaction on its housing, smaller by the ratio, is
 * left out. */
typedef struct JpBacklash {
    double gap;           /* rad or m, from tooth to tooth, >= 0 */
    double offset;        /* rad or m: the coordinate less the rotor's where the gap is centred */
    double rotor_inertia; /* kg m^2 or kg; 0: no rotor */
    JpContact tooth;
} JpBacklash;

/* A gap of 0 about 0, no rotor, the default contact. */
JP_API JpBacklash jp_backlash_default(void);
JP_API JpStatus jp_backlash_create(JpWorld *world, dJointID joint, const JpBacklash *backlash,
                                   JpJoint **created, JpError *error);

/* Sets the torque or force on the rotor. A rotor that was moved by jp_backlash_lead is free again.
 * Fails without a rotor. */
JP_API JpStatus jp_backlash_drive(JpJoint *joint, double force, JpError *error);

/* A servo: drives the rotor in the next step towards a position, rad or m, with a stiffness, N
 * m/rad or N/m, and a damper, N m s/rad or N s/m, from where it is now. */
JP_API JpStatus jp_backlash_hold(JpJoint *joint, double position, double stiffness, double damper,
                                 JpError *error);

/* Prescribes the position of the rotor, or of the middle of the gap if there is no rotor, and the
 * speed with which it continues from there. */
JP_API JpStatus jp_backlash_lead(JpJoint *joint, double position, double speed, JpError *error);

/* Stops that rebound with a given restitution. Use them instead of dParamLoStop and dParamHiStop.
 */
typedef struct JpStops {
    double low;  /* rad or m; may be -infinity */
    double high; /* rad or m, above low; may be infinity */
    JpContact contact;
} JpStops;

/* No stops, the default contact. */
JP_API JpStops jp_stops_default(void);
JP_API JpStatus jp_stops_create(JpWorld *world, dJointID joint, const JpStops *stops,
                                JpJoint **created, JpError *error);

JP_API void jp_joint_destroy(JpJoint *joint);

/* How a contact began that is under way when its joint is made, because the bodies come from
 * elsewhere in the middle of it. */
typedef struct JpBegun {
    double impact_speed; /* rad/s or m/s, >= 0, with which it began */
    double age;          /* s, >= 0, since then */
    bool is_released;    /* it has been compressed and released since */
    bool is_resting;     /* and compressed again: it is damped by the contact's resting speed */
    double bend;         /* m, of the friction of a pin that sticks: see JpPinState */
} JpBegun;

/* Says that of one side, before the first step; without it the contact begins in that step, with
 * the speed that it has then. Sides of a hinge or slider: 0 the low, 1 the high one; of a pin: 0
 * and 1 its ends, 2 and 3 its collars. JP_ERROR_ARGUMENT where the joint has no such side,
 * JP_ERROR_NONE where it does not touch as the bodies stand. */
JP_API JpStatus jp_joint_begun(JpJoint *joint, size_t side, const JpBegun *begun, JpError *error);

/* One side of the gap. */
typedef struct JpSide {
    double gap;          /* rad or m to it; below 0 inside; infinite where there is none */
    double force;        /* N m or N, >= 0, mean of the last step */
    double force_max;    /* since the joint was made, as are all below */
    double depth_max;    /* rad or m */
    double impulse;      /* N m s or N s */
    double work;         /* J, done by the contact */
    double stored;       /* J, elastic, now; -work - stored was lost */
    double impact_speed; /* rad/s or m/s, of the last impact */
    size_t impacts;
    bool is_touching;
} JpSide;

typedef struct JpJointState {
    double position; /* rad or m, of the coordinate */
    double speed;    /* rad/s or m/s */
    double rotor_position;
    double rotor_speed;
    double force; /* N m or N, mean of the last step: on the first body along the coordinate */
    JpSide low;   /* pushes the coordinate up */
    JpSide high;
} JpJointState;
JP_API JpStatus jp_joint_state(const JpJoint *joint, JpJointState *state, JpError *error);

/* ---- pins in holes ----------------------------------------------------------------------------
 *
 * A round pin in a round hole of another body, or of the world. With a width the pin touches at the
 * two ends of its hole, each with half of the contact's force, and may tilt; without one it touches
 * at the hole's centre, for pins that stay parallel to their holes: your other joints hold all but
 * the play then. The force on the pin is along the line from its axis to the hole's centre.
 *
 * Friction that sticks is a bristle at the wall that bends with the sliding, up to presliding: of
 * mu F it holds breakaway_ratio bend / presliding and its damping. It is of steps with
 * JP_STEPPING_IMPULSE, and of pins without a width; in a step whose contacts are made with rows
 * (JP_COARSE) friction is regularized. */
typedef struct JpPinInHole {
    double hole_radius;
    double pin_radius;     /* m, smaller: the difference is the radial play */
    double width;          /* m, of the hole along its axis; 0: it touches at its centre alone */
    double axial_play;     /* m, to either side until a collar stops the pin; may be infinity */
    double hole[3];        /* m, the hole's centre in the frame of its body, or in the world */
    double pin[3];         /* m, the pin's centre in the frame of its body, or in the world */
    double axis[3];        /* of both, in the world as the bodies stand now; of any length */
    JpContact contact;     /* of the whole pin; jp_contact_of_pin has the laws */
    double friction;       /* 1, mu, of what presses, F */
    double friction_speed; /* m/s, > 0 */
    JpFrictionLaw friction_law;
    /* of JP_FRICTION_STICK */
    double presliding;         /* m, > 0: how far the bristle bends before the pin slides */
    double breakaway_ratio;    /* 1, >= 1: static over sliding friction */
    double presliding_damping; /* 1, > 0: damping ratio of what moves on the bristle */
    double presliding_mass;    /* kg, of that; 0: both bodies against each other, where one that is
                                * kinematic, or the world, does not move */
} JpPinInHole;

/* No radii yet; no width, no collars, at the centres of the bodies, about z; the default contact,
 * no friction, a friction speed of 1e-3, regularized; a presliding of 5e-6, a breakaway ratio and a
 * damping ratio of 1. */
JP_API JpPinInHole jp_pin_default(void);

/* One of the bodies may be NULL, the world. JP_ERROR_OUTSIDE where the pin is beyond the wall of
 * its hole, or a collar, by more than ten times the play there or the pin's diameter, whichever is
 * more. */
JP_API JpStatus jp_pin_create(JpWorld *world, dBodyID hole, dBodyID pin, const JpPinInHole *given,
                              JpJoint **created, JpError *error);

typedef struct JpPinState {
    double eccentricity[3]; /* m, in the world: of the pin's axis from the hole's centre */
    double axial;           /* m, of the pin's centre along the hole's axis */
    double tilt;            /* rad, of the pin's axis against the hole's */
    double force[3];        /* N, in the world, on the pin, mean of the last step */
    double gap;             /* m, of the end that is nearest to the wall; below 0 inside */
    double slid;            /* J, that friction took since the pin was made; with what bristles
                             * have not given back */
    bool is_touching;       /* anywhere */
    size_t end_count;       /* 1, or 2 of a hole with a width */
    JpSide ends[2];         /* along the line to the hole's centre; at -width/2 first */
    JpSide collars[2];      /* along the axis; the first pushes the pin up it */
    /* m, of the bristle of JP_FRICTION_STICK while the pin touches, at most presliding to either
     * side; above 0 where the pin has turned about its axis, against its hole, by the right hand */
    double bend;
} JpPinState;
JP_API JpStatus jp_pin_state(const JpJoint *joint, JpPinState *state, JpError *error);

#ifdef __cplusplus
}
#endif

#endif
