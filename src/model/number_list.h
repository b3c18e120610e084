// The numbers of a run: one row each says all that is to be known of it.
//
// Text and JSON of `run`, the columns of a study and of its store, the metrics of `check`, the
// limits of `expect`, the tables of a report and those of the pages follow from these rows.
#pragma once

#include <stdbool.h>

// Where a number is shown.
enum {
    NUMBER_JSON = 1,
    NUMBER_TEXT = 2, // in a table of `run`
    NUMBER_STUDY = 4,
    NUMBER_CHECK = 8,
    NUMBER_EXPECT = 16,
    NUMBER_REPORT = 32,
    NUMBER_CSV = 64,   // of `compare` and of contacts, which write a table of their own
    NUMBER_MAIN = 128, // with NUMBER_STUDY: at the end of a study without --full
    NUMBER_SHOWN = NUMBER_JSON | NUMBER_TEXT | NUMBER_REPORT,
    NUMBER_JUDGED = NUMBER_STUDY | NUMBER_EXPECT,
    NUMBER_EVERYWHERE = NUMBER_SHOWN | NUMBER_JUDGED | NUMBER_CHECK,
};

// What else is to be known of it; 0: nothing.
enum {
    NUMBER_TIMED = 1,        // its value is an Extreme with the time at which it stood
    NUMBER_DETAIL = 2,       // its column is left out where there is no room
    NUMBER_PLAY = 4,         // of joints with play alone, where the solver lets it happen
    NUMBER_STEPS = 8,        // of a solver that chooses its steps `check` takes it at the samples
    NUMBER_LACKED = 16,      // a complete run need not have it: `check` then leaves it out
    NUMBER_TURNS = 32,       // of bodies that do not slide on the ground
    NUMBER_SLIDES = 64,      // of those that do
    NUMBER_SPATIAL = 128,    // in space
    NUMBER_LOADED = 256,     // of mechanisms with loads
    NUMBER_RUBBED = 512,     // in `check` where there is friction
    NUMBER_GROWTH = 1024,    // of studies that look for the growth of small changes
    NUMBER_FOLLOWED = 2048,  // of studies that follow a motion
    NUMBER_OF_ALPHA = 4096,  // it has the rounding of an acceleration
    NUMBER_OF_FORCES = 8192, // an error of forces: in `check` where the tolerance is of those
    NUMBER_OF_PEAKS = 16384, // an error of peaks, likewise
    NUMBER_MINOR = 32768,    // its column goes below the others where it is narrow
    NUMBER_HORIZON = 65536,  // of a certified reference alone
    NUMBER_INSTANT = 131072, // an Extreme whose value is the time: when something happens
    NUMBER_NEIGHBOURS = 262144, // of studies whose runs begin in the motion of a neighbour
};

// clang-format off
// What a number is of: the unit of SI behind its name in keys, and that for people; the same where
// the limits of a joint turn it; the same of a signal that is an acceleration; what the name of a
// metric of `check` has behind that.
#define NUMBER_UNITS_COUNT          "", "", "", "", "", "", ""
#define NUMBER_UNITS_EFFORT         "", "", "", "", "", "", ""
#define NUMBER_UNITS_SHARE          "", "%", "", "%", "", "%", "_1"
#define NUMBER_UNITS_RATIO          "", "1", "", "1", "", "1", "_1"
#define NUMBER_UNITS_FORCE          "_N", "N", "_N_m", "N m", "_N", "N", ""
#define NUMBER_UNITS_IMPULSE        "_N_s", "N s", "_N_m_s", "N m s", "_N_s", "N s", ""
#define NUMBER_UNITS_DEPTH          "_m", "um", "_rad", "mrad", "_m", "um", ""
#define NUMBER_UNITS_APPROACH       "_m_s", "mm/s", "_rad_s", "rad/s", "_m_s", "mm/s", ""
#define NUMBER_UNITS_SIGNAL         "_N", "N", "_N_m", "N m", "_rad_s2", "rad/s^2", ""
#define NUMBER_UNITS_SIGNAL_IMPULSE "_N_s", "N s", "_N_m_s", "N m s", "_rad_s", "rad/s", ""
#define NUMBER_UNITS_ALIKE(key, unit) key, unit, key, unit, key, unit, ""
#define NUMBER_UNITS_LENGTH         NUMBER_UNITS_ALIKE("_m", "mm")
#define NUMBER_UNITS_ANGLE          NUMBER_UNITS_ALIKE("_rad", "deg")
#define NUMBER_UNITS_SPEED          NUMBER_UNITS_ALIKE("_m_s", "m/s")
#define NUMBER_UNITS_ANGULAR_SPEED  NUMBER_UNITS_ALIKE("_rad_s", "rad/s")
#define NUMBER_UNITS_ANGULAR_ACCELERATION NUMBER_UNITS_ALIKE("_rad_s2", "rad/s^2")
#define NUMBER_UNITS_ENERGY         NUMBER_UNITS_ALIKE("_J", "J")
#define NUMBER_UNITS_TIME           NUMBER_UNITS_ALIKE("_s", "ms")
#define NUMBER_UNITS_SPAN           NUMBER_UNITS_ALIKE("_s", "us")
#define NUMBER_UNITS_MICROSECONDS   NUMBER_UNITS_ALIKE("", "us")
#define NUMBER_UNITS_PRESSURE       NUMBER_UNITS_ALIKE("_Pa", "MPa")
#define NUMBER_UNITS_PRESSURE_SPEED NUMBER_UNITS_ALIKE("_Pa_m_s", "MPa m/s")

#define NUMBER_KIND_LIST(kind) \
    kind(COUNT)  /* a whole number */ \
    kind(EFFORT) /* likewise, of what a solver spent */ \
    kind(SHARE) kind(RATIO) kind(FORCE) kind(IMPULSE) kind(DEPTH) kind(APPROACH) \
    kind(SIGNAL)         /* the value of a signal: a force, a torque or an acceleration */ \
    kind(SIGNAL_IMPULSE) /* its integral */ \
    kind(LENGTH) kind(ANGLE) kind(SPEED) kind(ANGULAR_SPEED) kind(ANGULAR_ACCELERATION) \
    kind(ENERGY) kind(TIME) \
    kind(SPAN)           /* a short time */ \
    kind(MICROSECONDS)   /* its name says so */ \
    kind(PRESSURE) kind(PRESSURE_SPEED)

// What names of columns of a study have before that of a number, behind that of its member.
#define NUMBER_COLUMN_BODY          ""
#define NUMBER_COLUMN_BODY_SPIKE    "alpha_spike_"
#define NUMBER_COLUMN_JOINT         ""
#define NUMBER_COLUMN_JOINT_SPIKE   "force_spike_"
#define NUMBER_COLUMN_JOINT_CONTACT "contact_"
#define NUMBER_COLUMN_JOINT_WEAR    "wear_"
#define NUMBER_COLUMN_RUN           ""
#define NUMBER_COLUMN_ENERGY        "energy_"
#define NUMBER_COLUMN_COST          ""
#define NUMBER_COLUMN_SECTION       "section_"
#define NUMBER_COLUMN_SETTLED       "settled_"
#define NUMBER_COLUMN_SETTLED_JOINT "settled_"
#define NUMBER_COLUMN_SETTLED_BODY  "settled_"
#define NUMBER_COLUMN_ERROR         "error_"
#define NUMBER_COLUMN_TRUTH         "error_"

// Whose a number is: who has one each; the words of its paths in `expect`; what stands there, and
// in names of `check`, before its name; its part of these names, empty where that is a member's.
#define NUMBER_OWNER_LIST(owner) \
    owner(BODY, BODIES, "bodies", "", "") \
    owner(BODY_SPIKE, BODIES, "bodies", "alpha_spike_", "") \
    owner(JOINT, JOINTS, "joints", "", "") \
    owner(JOINT_SPIKE, JOINTS, "joints", "force_spike_", "") \
    owner(JOINT_CONTACT, JOINTS, "joints", "contact_", "") \
    owner(JOINT_WEAR, JOINTS, "joints", "wear_", "") \
    owner(RUN, WHOLE, "run", "", "run") \
    owner(ENERGY, WHOLE, "energy", "", "energy") \
    owner(COST, WHOLE, "cost", "", "cost") \
    owner(SECTION, WHOLE, "section", "", "section") \
    owner(SETTLED, WHOLE, "settled", "", "settled") \
    owner(SETTLED_JOINT, JOINTS, "settled.joints", "", "") \
    owner(SETTLED_BODY, BODIES, "settled.bodies", "", "") \
    owner(ERROR, WHOLE, "error", "", "error") \
    owner(TRUTH, WHOLE, "error", "", "error")

// The rows: owner and id; name in keys, kind; heading of its column, the same where limits turn the
// joint (NULL: alike), format for people (NULL: four digits); where it is shown; traits; value;
// meaning; the same on an axis, where that is too long; the name in a study, where it is another.
//
// The value is that of one member in SI, a number, or of NUMBER_TIMED an Extreme, from what
// LOCALS_... in measure/number_values.c names; NAN where a run does not have it. Without
// NUMBER_LACKED it is finite in every complete run, or `check` refuses the run.

// Of a body: `run`, `member`, and `extremes` over all steps.
#define NUMBERS_OF_BODY_LIST(row) \
    row(BODY, OMEGA_MAX, "omega_max", ANGULAR_SPEED, "omega max", NULL, "%.6g", \
        NUMBER_EVERYWHERE, NUMBER_TIMED | NUMBER_STEPS, extremes->omega_max, \
        "largest angular velocity") \
    row(BODY, OMEGA_MIN, "omega_min", ANGULAR_SPEED, "omega min", NULL, "%.6g", \
        NUMBER_EVERYWHERE, NUMBER_TIMED | NUMBER_STEPS, extremes->omega_min, \
        "smallest angular velocity") \
    row(BODY, ALPHA_MAX, "alpha_max", ANGULAR_ACCELERATION, "alpha max", NULL, "%.6g", \
        NUMBER_EVERYWHERE, NUMBER_TIMED | NUMBER_STEPS | NUMBER_OF_ALPHA, extremes->alpha_max, \
        "largest angular acceleration") \
    row(BODY, ALPHA_MIN, "alpha_min", ANGULAR_ACCELERATION, "alpha min", NULL, "%.6g", \
        NUMBER_EVERYWHERE, NUMBER_TIMED | NUMBER_STEPS | NUMBER_OF_ALPHA, extremes->alpha_min, \
        "smallest angular acceleration") \
    row(BODY, ALPHA_SPIKES, "alpha_spikes", COUNT, "spikes", NULL, NULL, \
        NUMBER_CHECK | NUMBER_EXPECT, NUMBER_STEPS | NUMBER_LACKED, \
        spikes_counted(&run->alpha_spikes[member], of), \
        "number of spikes of the angular acceleration") \
    row(BODY, ALPHA_SPIKES_MEAN, "alpha_spikes_mean", ANGULAR_ACCELERATION, "mean spike", NULL, \
        NULL, NUMBER_CHECK, NUMBER_STEPS | NUMBER_LACKED, \
        spikes_mean(&run->alpha_spikes[member], of), \
        "mean size of the strongest spikes of the angular acceleration") \
    row(BODY, OMEGA_ORDER_1, "omega_order_1", ANGULAR_SPEED, "order 1", NULL, NULL, \
        NUMBER_JUDGED, NUMBER_LACKED, spectrum_body_order(run, member, 1), \
        "amplitude of the angular velocity at once the crank's speed", \
        "amplitude of omega at the crank's speed") \
    row(BODY, OMEGA_ORDER_2, "omega_order_2", ANGULAR_SPEED, "order 2", NULL, NULL, \
        NUMBER_JUDGED, NUMBER_LACKED, spectrum_body_order(run, member, 2), \
        "the same at twice its speed", "amplitude of omega at twice the crank's speed") \
    row(BODY, OMEGA_BETWEEN_ORDERS, "omega_between_orders", ANGULAR_SPEED, "between", NULL, NULL, \
        NUMBER_JUDGED, NUMBER_LACKED, spectrum_body_between(run, member), \
        "its largest amplitude between whole multiples of the crank's speed", \
        "largest amplitude of omega between orders") \
    row(BODY, OMEGA_SECTION, "omega_section", ANGULAR_SPEED, "section", NULL, NULL, \
        NUMBER_EXPECT, NUMBER_LACKED, section_omega(run, member, 0), \
        "angular velocity at the end of the last whole revolution") \
    NUMBERS_OF_SECTIONS_LIST(row)

// The states of a body at the ends of the last revolutions, the last one first: of one that turns,
// and of one that slides.
#define NUMBERS_OF_SECTION(row, number, last) \
    row(BODY, SECTION_##number, "section_" #number, ANGULAR_SPEED, "section", NULL, NULL, \
        NUMBER_STUDY, NUMBER_LACKED | NUMBER_TURNS, section_omega(run, member, (number)-1), \
        last ? "angular velocity at the end of the last whole revolution" \
             : "angular velocity at the ends of the revolutions before that", \
        "angular velocity at the end of revolution -" #number)
#define NUMBERS_OF_SLIDE(row, number, last) \
    row(BODY, SLIDE_##number, "section_" #number, SPEED, "section", NULL, NULL, \
        NUMBER_STUDY, NUMBER_LACKED | NUMBER_SLIDES, section_slide(run, member, (number)-1), \
        last ? "of a body that slides on the ground its velocity there, along its line" \
             : "the same at the ends of the revolutions before that", \
        "velocity of the slider at the end of revolution -" #number)
#define NUMBERS_OF_SECTIONS_LIST(row) \
    NUMBERS_OF_SECTION(row, 1, true) \
    NUMBERS_OF_SECTION(row, 2, false) \
    NUMBERS_OF_SECTION(row, 3, false) \
    NUMBERS_OF_SECTION(row, 4, false) \
    NUMBERS_OF_SECTION(row, 5, false) \
    NUMBERS_OF_SECTION(row, 6, false) \
    NUMBERS_OF_SLIDE(row, 1, true) \
    NUMBERS_OF_SLIDE(row, 2, false) \
    NUMBERS_OF_SLIDE(row, 3, false) \
    NUMBERS_OF_SLIDE(row, 4, false) \
    NUMBERS_OF_SLIDE(row, 5, false) \
    NUMBERS_OF_SLIDE(row, 6, false)

// Of a joint: `run`, `member`, and `extremes` of it.
#define NUMBERS_OF_JOINT_LIST(row) \
    row(JOINT, IMPACTS, "impacts", COUNT, "impacts", NULL, NULL, \
        NUMBER_EVERYWHERE | NUMBER_MAIN, NUMBER_PLAY, (double)extremes->impacts, "contacts begun") \
    row(JOINT, FORCE_MAX, "force_max", FORCE, "force max", "torque max", NULL, \
        NUMBER_EVERYWHERE | NUMBER_MAIN, NUMBER_TIMED | NUMBER_STEPS, force_max(of, member), \
        "largest force") \
    row(JOINT, FORCE_SPIKES, "force_spikes", COUNT, "spikes", NULL, NULL, \
        NUMBER_CHECK | NUMBER_EXPECT, NUMBER_STEPS | NUMBER_LACKED, \
        spikes_counted(&run->force_spikes[member], of), "number of spikes of the force") \
    row(JOINT, FORCE_SPIKES_MEAN, "force_spikes_mean", FORCE, "mean spike", NULL, NULL, \
        NUMBER_CHECK, NUMBER_STEPS | NUMBER_LACKED, \
        spikes_mean(&run->force_spikes[member], of), \
        "mean size of the strongest spikes of the force") \
    row(JOINT, IMPULSE, "impulse", IMPULSE, "impulse", NULL, NULL, \
        NUMBER_EVERYWHERE, NUMBER_PLAY | NUMBER_DETAIL, extremes->impulse, \
        "impulse of all contacts") \
    row(JOINT, PENETRATION_MAX, "penetration_max", DEPTH, "deepest", NULL, NULL, \
        NUMBER_EVERYWHERE | NUMBER_MAIN, NUMBER_PLAY, extremes->penetration_max.value, "deepest penetration") \
    row(JOINT, TILT_MAX, "tilt_max", ANGLE, "tilt max", NULL, NULL, \
        NUMBER_JSON, NUMBER_PLAY | NUMBER_SPATIAL, extremes->tilt_max.value, \
        "largest angle between the axes of pin and hole") \
    row(JOINT, AXIAL_MAX, "axial_max", LENGTH, "slid max", NULL, NULL, \
        NUMBER_JSON, NUMBER_PLAY | NUMBER_SPATIAL, extremes->axial_max.value, \
        "largest distance of the pin's middle from the hole's, along the axis") \
    row(JOINT, CONTACT_FRACTION, "contact_fraction", SHARE, "in contact", NULL, "%.1f", \
        NUMBER_EVERYWHERE, NUMBER_PLAY, trajectory_contact_share(run, member), \
        "share of the time in contact") \
    row(JOINT, CREEP_FRACTION, "creep_fraction", SHARE, "creeping", NULL, "%.1f", \
        NUMBER_JSON | NUMBER_EXPECT, NUMBER_PLAY | NUMBER_LACKED, \
        creep_share(of->scenario, run, member), \
        "share of the loaded time in which it slides slower than regularized friction sets in")

// Of what wears a pin in its hole: `wear`, whose names have wear_ before them in
// checks, limits and studies.
#define NUMBERS_OF_WEAR_LIST(row) \
    row(JOINT_WEAR, FRICTION_WORK, "friction_work", ENERGY, "friction work", NULL, NULL, \
        NUMBER_SHOWN | NUMBER_JUDGED, NUMBER_LACKED, wear.friction_work, \
        "work of friction in the pin, a revolution or, without one, in the run", \
        "work of friction a revolution") \
    row(JOINT_WEAR, DISTANCE, "sliding_distance", LENGTH, "slides", NULL, NULL, \
        NUMBER_SHOWN | NUMBER_JUDGED, NUMBER_LACKED, wear.distance, \
        "way that pin and hole slide on each other while they touch, a revolution or in the run", \
        "sliding distance a revolution") \
    row(JOINT_WEAR, PRESSURE, "pressure_mean", PRESSURE, "pressure", NULL, NULL, \
        NUMBER_SHOWN | NUMBER_JUDGED, NUMBER_LACKED, wear.pressure, \
        "force over width times diameter of the pin, mean of the time in contact", \
        "mean pressure") \
    row(JOINT_WEAR, PRESSURE_SPEED, "pv_mean", PRESSURE_SPEED, "p v", NULL, NULL, \
        NUMBER_SHOWN | NUMBER_JUDGED, NUMBER_LACKED, wear.pressure_speed, \
        "that pressure times the sliding speed, mean of the whole time", "mean p v") \
    row(JOINT_WEAR, ANGLE, "angle", ANGLE, "worn at", NULL, "%.1f", \
        NUMBER_SHOWN | NUMBER_JUDGED, NUMBER_LACKED, wear.angle, \
        "middle of the 15 deg of the wall that wear most, from the x axis of the hole's body", \
        "angle of the most worn wall") \
    row(JOINT_WEAR, SHARE, "share", SHARE, "share there", NULL, "%.1f", \
        NUMBER_SHOWN | NUMBER_EXPECT, NUMBER_LACKED, wear.share, \
        "share of all wear (force times sliding distance) in those 15 deg")

// Of a spike of a signal, of a body or of a joint: `spike`. In checks and limits that of the
// strongest, with alpha_spike_ or force_spike_ before the name; studies look for no spikes.
#define NUMBERS_OF_SPIKE_LIST(row, owner) \
    row(owner, ONSET, "onset", TIME, "onset", NULL, "%.4f", NUMBER_JSON, NUMBER_LACKED, \
        spike->onset_s, "when a spike begins") \
    row(owner, PEAK, "peak", TIME, "peak", NULL, "%.4f", NUMBER_SHOWN, \
        NUMBER_LACKED | NUMBER_INSTANT, \
        ((Extreme){spike->time_s, spike->time_s, spike->crank_rad}), \
        "when it is highest") \
    row(owner, END, "end", TIME, "end", NULL, "%.4f", NUMBER_JSON, NUMBER_LACKED, \
        spike->end_s, "when it ends") \
    row(owner, VALUE, "value", SIGNAL, "value", NULL, NULL, NUMBER_SHOWN, NUMBER_LACKED, \
        spike->value, "signal at the peak of a spike, with its sign") \
    row(owner, PROMINENCE, "prominence", SIGNAL, "height", NULL, NULL, NUMBER_SHOWN, \
        NUMBER_LACKED | NUMBER_DETAIL, spike->prominence, "how far a spike stands out") \
    row(owner, WIDTH, "width", SPAN, "width", NULL, NULL, NUMBER_SHOWN, NUMBER_LACKED, \
        spike->width_s, "width of a spike where half of its prominence is left") \
    row(owner, DURATION, "duration", SPAN, "duration", NULL, NULL, NUMBER_TEXT | NUMBER_REPORT, \
        NUMBER_LACKED, spike->end_s - spike->onset_s, "time from the onset of a spike to its end") \
    row(owner, IMPULSE, "impulse", SIGNAL_IMPULSE, "impulse", NULL, NULL, NUMBER_SHOWN, \
        NUMBER_LACKED, spike->impulse, "integral of the signal over a spike, with its sign")

// Of a contact: `contact`. In studies, checks and limits that of the strongest of a joint.
#define NUMBERS_OF_CONTACT_LIST(row) \
    row(JOINT_CONTACT, ONSET, "onset", TIME, "onset", NULL, "%.4f", NUMBER_SHOWN | NUMBER_CSV, \
        NUMBER_LACKED | NUMBER_INSTANT, \
        ((Extreme){contact->onset_s, contact->onset_s, contact->crank_rad}), \
        "when a contact begins") \
    row(JOINT_CONTACT, DURATION, "duration", SPAN, "duration", NULL, NULL, \
        NUMBER_SHOWN | NUMBER_CSV, NUMBER_LACKED, contact->duration_s, "how long it lasts") \
    row(JOINT_CONTACT, PEAK, "peak", TIME, "peak", NULL, "%.4f", NUMBER_CSV, NUMBER_LACKED, \
        contact->peak_s, "when its force is largest") \
    row(JOINT_CONTACT, FORCE_MAX, "force_max", FORCE, "force max", "torque max", NULL, \
        NUMBER_SHOWN | NUMBER_CSV, NUMBER_LACKED, contact->force_max, "largest force of it") \
    row(JOINT_CONTACT, IMPULSE, "impulse", IMPULSE, "impulse", NULL, NULL, \
        NUMBER_SHOWN | NUMBER_CSV, NUMBER_LACKED, contact->impulse, "impulse of it") \
    row(JOINT_CONTACT, APPROACH, "approach_speed", APPROACH, "approach", NULL, NULL, \
        NUMBER_SHOWN | NUMBER_CSV, NUMBER_LACKED, contact->approach_speed, \
        "closing speed at its onset") \
    row(JOINT_CONTACT, PENETRATION_MAX, "penetration_max", DEPTH, "deepest", NULL, NULL, \
        NUMBER_SHOWN | NUMBER_CSV, NUMBER_LACKED, contact->penetration_max, \
        "deepest penetration in it")

// Of a run as a whole: `run`.
#define NUMBERS_OF_RUN_LIST(row) \
    row(RUN, IMPACTS, "impacts", COUNT, "impacts", NULL, NULL, \
        NUMBER_SHOWN | NUMBER_JUDGED, NUMBER_LACKED, impacts_of_all(run), \
        "contacts begun in all joints") \
    row(RUN, ALPHA_PEAK, "alpha_peak", ANGULAR_ACCELERATION, "alpha peak", NULL, "%.6g", \
        NUMBER_SHOWN | NUMBER_JUDGED | NUMBER_MAIN, NUMBER_STEPS | NUMBER_OF_ALPHA, alpha_peak(of), \
        "largest magnitude of any body's angular acceleration", \
        "largest angular acceleration of any body")

// Of the energy of a run: `energy`.
#define NUMBERS_OF_ENERGY_LIST(row) \
    row(ENERGY, DRIVE_WORK, "drive_work", ENERGY, "drive work", NULL, NULL, \
        NUMBER_EVERYWHERE, 0, energy->drive_work, "work of the drive") \
    row(ENERGY, LOAD_WORK, "load_work", ENERGY, "load work", NULL, NULL, \
        NUMBER_EVERYWHERE, NUMBER_LOADED, energy->load_work, "work of the loads") \
    row(ENERGY, CHANGE, "change", ENERGY, "change", NULL, NULL, \
        NUMBER_EVERYWHERE, 0, energy->change, \
        "change of kinetic, potential and elastic energy") \
    row(ENERGY, DISSIPATED, "dissipated", ENERGY, "dissipated", NULL, NULL, \
        NUMBER_EVERYWHERE, 0, energy->dissipated, \
        "lost in the damping of contacts and dampers", "energy lost in damping") \
    row(ENERGY, FRICTION, "friction", ENERGY, "friction", NULL, NULL, \
        NUMBER_EVERYWHERE, NUMBER_RUBBED, energy->friction, "lost in the friction of contacts", \
        "energy lost in friction") \
    row(ENERGY, RESIDUAL, "residual", ENERGY, "residual", NULL, NULL, \
        NUMBER_EVERYWHERE, 0, energy->residual, \
        "what the balance leaves unexplained: the solver's error", \
        "residual of the energy balance") \
    row(ENERGY, RESIDUAL_SHARE, "residual_share", RATIO, "residual/energy", NULL, NULL, \
        NUMBER_SHOWN | NUMBER_JUDGED, NUMBER_LACKED, residual_share(of->run), \
        "size of that over the largest energy of the run: drive work, loss or kinetic", \
        "residual over the largest energy")

// Of what a run took: `run`.
#define NUMBERS_OF_COST_LIST(row) \
    row(COST, STEP, "step", SPAN, "step", NULL, NULL, NUMBER_JSON | NUMBER_STUDY, \
        NUMBER_LACKED, run->step_s > 0.0 ? run->step_s : NAN, "step of ODE") \
    row(COST, STEPS, "steps", EFFORT, "steps", NULL, NULL, NUMBER_EVERYWHERE, 0, \
        (double)run->steps, "steps of the solver") \
    row(COST, EVALUATIONS, "evaluations", EFFORT, "evaluations", NULL, NULL, NUMBER_EVERYWHERE, \
        NUMBER_LACKED, run->evaluations > 0 ? (double)run->evaluations : NAN, \
        "evaluations of the equations of motion") \
    row(COST, DURATION, "duration", TIME, "duration", NULL, NULL, NUMBER_JSON, 0, \
        run->duration_s, "simulated time") \
    row(COST, WALL, "wall", TIME, "wall time", NULL, NULL, NUMBER_SHOWN, 0, \
        run->wall_s, "time that the stepping took") \
    row(COST, US_PER_STEP, "us_per_step", MICROSECONDS, "a step", NULL, NULL, NUMBER_SHOWN, \
        NUMBER_LACKED, run->steps > 0 ? 1e6 * (run->wall_s / (double)run->steps) : NAN, \
        "time of a step") \
    row(COST, REAL_TIME, "real_time_factor", RATIO, "simulated/wall", NULL, NULL, NUMBER_SHOWN, \
        NUMBER_LACKED, run->duration_s / run->wall_s, "simulated time over that of the stepping") \
    row(COST, CONSTRAINT_ROWS, "constraint_rows", COUNT, "constraint rows", NULL, NULL, \
        NUMBER_JSON | NUMBER_CHECK, 0, (double)run->constraint_rows, "rows of the ideal joints") \
    row(COST, CONTACT_ROWS, "contact_rows", COUNT, "contact rows", NULL, NULL, \
        NUMBER_JSON | NUMBER_CHECK, 0, (double)run->contact_rows, \
        "most rows of contacts in a step") \
    row(COST, FALLBACK_ROWS, "fallback_rows", COUNT, "fallback rows", NULL, NULL, \
        NUMBER_JSON | NUMBER_CHECK | NUMBER_STUDY, 0, (double)run->fallback_rows, \
        "contact rows for which the requested map would have been unstable", \
        "contact rows with the textbook map") \
    row(COST, ERROR_ESTIMATE, "error_estimate", RATIO, "error at most", NULL, NULL, \
        NUMBER_JSON | NUMBER_STUDY, NUMBER_LACKED, run->trials > 0 ? run->error_estimate : NAN, \
        "upper bound of the error, for a step chosen for a tolerance", \
        "upper bound of the error") \
    row(COST, ESTIMATE_UNTIL, "error_estimate_until", TIME, "until", NULL, NULL, \
        NUMBER_JSON | NUMBER_STUDY, NUMBER_LACKED, run->trials > 0 ? run->estimate_s : NAN, \
        "time up to which that bound holds", "time up to which the bound of the error holds") \
    row(COST, BUDGET_WANTED, "budget_wanted", TIME, "wanted", NULL, NULL, NUMBER_JSON, \
        NUMBER_LACKED, run->trials > 0 ? run->wanted_s : NAN, \
        "processor time that the tolerance would take; 0: the budget allows it") \
    row(COST, TRIALS, "trials", COUNT, "trials", NULL, NULL, NUMBER_JSON, NUMBER_LACKED, \
        run->trials > 0 ? (double)run->trials : NAN, "runs made to choose the step")

// Of how a run repeats: `run`.
#define NUMBERS_OF_SECTION_LIST(row) \
    row(SECTION, PERIOD, "period", COUNT, "period", NULL, NULL, NUMBER_JUDGED, NUMBER_LACKED, \
        section_period(run), "revolutions after which the run repeats; 0: it has not", \
        "period of the run, revolutions") \
    row(SECTION, CHANGE, "change", RATIO, "change", NULL, NULL, NUMBER_JUDGED, NUMBER_LACKED, \
        section_find(run).change, \
        "by how much the sections of the last period differ from those before, of the fastest " \
        "point", "change of the sections over a period")

// Of the settled motion of the case: `settled`, and `motion`, in which runs start.
#define NUMBERS_OF_SETTLED_LIST(row) \
    row(SETTLED, PERIOD, "period", COUNT, "period", NULL, NULL, NUMBER_JUDGED, NUMBER_LACKED, \
        (double)motion->period, \
        "revolutions after which the settled motion repeats; 0: it does not", \
        "period of the settled motion, revolutions") \
    row(SETTLED, REVOLUTIONS, "revolutions", COUNT, "revolutions", NULL, NULL, NUMBER_STUDY, \
        NUMBER_LACKED, (double)settled->revolutions, "revolutions that it took to settle", \
        "revolutions until settled") \
    row(SETTLED, MOTIONS, "motions", COUNT, "motions", NULL, NULL, NUMBER_JUDGED, \
        NUMBER_LACKED, (double)settled->motion_count, "different motions that starts settle in", \
        "number of settled motions") \
    row(SETTLED, WATCHED, "watched", COUNT, "watched", NULL, NULL, NUMBER_STUDY, NUMBER_LACKED, \
        (double)motion->watched, \
        "revolutions that each start of its motion was watched for, at least", \
        "revolutions watched") \
    row(SETTLED, SHARE, "share", RATIO, "share", NULL, NULL, NUMBER_EXPECT, NUMBER_LACKED, \
        (double)motion->starts / (double)settled->starts, \
        "share of the starts that come to the settled motion, of those whose motion is known") \
    row(SETTLED, GROWTH, "growth", RATIO, "growth", NULL, NULL, NUMBER_JUDGED, \
        NUMBER_LACKED | NUMBER_GROWTH, settled->has_growth ? settled->growth.factor : NAN, \
        "by what a small change of the settled motion is multiplied in a revolution, or its " \
        "bound where it is gone", "growth of a small change in a revolution") \
    row(SETTLED, FOLLOWED_FROM, "followed_from", RATIO, "followed from", NULL, NULL, \
        NUMBER_STUDY, NUMBER_LACKED | NUMBER_FOLLOWED, \
        settled->is_followed ? settled->followed_from : NAN, \
        "value of the followed key at the run whose motion it started in", \
        "value that the motion was followed from", "followed_from") \
    row(SETTLED, FROM_RUN, "from_run", COUNT, "from run", NULL, NULL, NUMBER_STUDY, \
        NUMBER_LACKED | NUMBER_NEIGHBOURS, \
        settled->is_followed ? (double)settled->neighbour : NAN, \
        "run in whose settled motion it started; none: it found its own", \
        "run that the motion is from") \
    row(SETTLED, APART, "apart", RATIO, "apart", NULL, NULL, NUMBER_STUDY, \
        NUMBER_LACKED | NUMBER_NEIGHBOURS, \
        settled->is_checked ? settled->apart_from_followed : NAN, \
        "relative difference of forces, settled by itself and from a neighbour", \
        "difference of forces, settled both ways")

// Of a joint in it: `did`.
#define NUMBERS_OF_SETTLED_JOINT_LIST(row) \
    row(SETTLED_JOINT, FORCE_MAX, "force_max", FORCE, "force max", NULL, NULL, \
        NUMBER_JUDGED | NUMBER_MAIN, NUMBER_LACKED | NUMBER_PLAY, did->force.headline, \
        "settled motion's largest force; 95 % quantile where it does not repeat", \
        "largest force of the settled motion", "settled_force") \
    row(SETTLED_JOINT, FORCE_LOW, "force_low", FORCE, "low", NULL, NULL, \
        NUMBER_STUDY, NUMBER_LACKED | NUMBER_PLAY, did->force.low, \
        "low end of the 95 % interval of <joint>_settled_force_N", \
        "largest force of the settled motion, low end") \
    row(SETTLED_JOINT, FORCE_HIGH, "force_high", FORCE, "high", NULL, NULL, \
        NUMBER_STUDY, NUMBER_LACKED | NUMBER_PLAY, did->force.high, \
        "its high end; none where too few revolutions are known", \
        "largest force of the settled motion, high end") \
    row(SETTLED_JOINT, FORCE_MEDIAN, "force_median", FORCE, "median", NULL, NULL, \
        NUMBER_JUDGED, NUMBER_LACKED | NUMBER_PLAY, did->force.median, \
        "median of the largest force in a revolution of the settled motion", \
        "median of the largest force in a revolution") \
    row(SETTLED_JOINT, FORCE_LARGEST, "force_largest", FORCE, "most", NULL, NULL, \
        NUMBER_JUDGED, NUMBER_LACKED | NUMBER_PLAY, did->force.largest, \
        "largest force in all revolutions that were counted")

// Of a body in it: `alpha`, the size of its angular acceleration.
#define NUMBERS_OF_SETTLED_BODY_LIST(row) \
    row(SETTLED_BODY, ALPHA_MAX, "alpha_size_max", ANGULAR_ACCELERATION, "alpha", NULL, NULL, \
        NUMBER_JUDGED, NUMBER_LACKED, alpha->headline, \
        "settled motion's largest angular acceleration; 95 % quantile where it does not repeat", \
        "largest angular acceleration of the settled motion") \
    row(SETTLED_BODY, ALPHA_MEDIAN, "alpha_size_median", ANGULAR_ACCELERATION, "median", NULL, \
        NULL, NUMBER_JUDGED, NUMBER_LACKED, alpha->median, \
        "median of the largest angular acceleration in a revolution of it", \
        "median of the largest angular acceleration") \
    row(SETTLED_BODY, ALPHA_LARGEST, "alpha_size_largest", ANGULAR_ACCELERATION, "most", NULL, \
        NULL, NUMBER_JUDGED, NUMBER_LACKED, alpha->largest, \
        "largest angular acceleration in all revolutions that were counted", \
        "largest angular acceleration of all revolutions")

// Errors against the reference: members of a TrajectoryError, and among them words of one.
#define NUMBERS_OF_ERROR_LIST(row, words) \
    row(ERROR, MAX, "max", RATIO, "largest", NULL, NULL, NUMBER_EVERYWHERE | NUMBER_MAIN | NUMBER_CSV, 0, max, \
        "largest error of any velocity of bodies and pins, over its own largest", \
        "largest error of the velocities") \
    row(ERROR, MAX_TIME, "max_time", TIME, "at time", NULL, NULL, NUMBER_SHOWN, NUMBER_DETAIL, \
        max_time_s, "time of error_max") \
    row(ERROR, MAX_IN_HORIZON, "max_in_horizon", RATIO, "in horizon", NULL, NULL, \
        NUMBER_SHOWN | NUMBER_STUDY, NUMBER_HORIZON, max_in_horizon, \
        "error_max up to the horizon", "largest error of the velocities up to the horizon") \
    words("in", "in", NUMBER_SHOWN | NUMBER_CSV, 0, in) \
    row(ERROR, OMEGA_MAX, "omega_max", RATIO, "omega max", NULL, NULL, \
        NUMBER_EVERYWHERE | NUMBER_CSV, NUMBER_MINOR, omega_max, \
        "largest error of omega, over each body's largest omega", "largest error of omega") \
    row(ERROR, OMEGA_MAX_IN_HORIZON, "omega_max_in_horizon", RATIO, "in horizon", NULL, NULL, \
        NUMBER_JSON | NUMBER_STUDY, NUMBER_HORIZON, omega_max_in_horizon, \
        "error_omega_max up to the horizon", "largest error of omega up to the horizon") \
    row(ERROR, OMEGA_RMS, "omega_rms", RATIO, "omega rms", NULL, NULL, \
        NUMBER_EVERYWHERE | NUMBER_CSV, NUMBER_DETAIL, omega_rms, \
        "root mean square of the errors of omega", "rms error of omega") \
    row(ERROR, ALPHA_MAX, "alpha_max", RATIO, "alpha max", NULL, NULL, \
        NUMBER_EVERYWHERE | NUMBER_CSV, NUMBER_DETAIL | NUMBER_OF_ALPHA, alpha_max, \
        "largest error of alpha, relative to each body's largest alpha", "largest error of alpha") \
    row(ERROR, ANGLE_MAX, "angle_max", ANGLE, "angle max", NULL, NULL, \
        NUMBER_SHOWN | NUMBER_CSV, NUMBER_DETAIL, angle_max_rad, "largest error of an angle") \
    row(ERROR, ENERGY_LOST, "energy_lost", RATIO, "energy", NULL, NULL, NUMBER_JSON, 0, \
        energy_lost, "residual of the energy over the largest energy of the reference") \
    row(ERROR, FORCE_MAX, "force_max", RATIO, "forces", NULL, NULL, NUMBER_EVERYWHERE | NUMBER_MAIN, \
        NUMBER_LACKED | NUMBER_OF_FORCES, force_max, \
        "largest error of a contact force at samples, over the joint's largest", \
        "largest error of contact forces") \
    row(ERROR, FORCE_MAX_IN_HORIZON, "force_max_in_horizon", RATIO, "in horizon", NULL, NULL, \
        NUMBER_SHOWN | NUMBER_STUDY, NUMBER_LACKED | NUMBER_OF_FORCES, force_max_in_horizon, \
        "error_force_max up to the horizon", "largest error of contact forces up to the horizon") \
    words("force_in", "in", NUMBER_SHOWN, NUMBER_OF_FORCES, force_in) \
    row(ERROR, PEAK_FORCE_MAX, "peak_force_max", RATIO, "peak forces", NULL, NULL, \
        NUMBER_EVERYWHERE, NUMBER_LACKED | NUMBER_OF_PEAKS, peak_force_max, \
        "largest error of the peak force of a contact, over the joint's largest", \
        "largest error of peak forces") \
    row(ERROR, PEAK_FORCE_MAX_IN_HORIZON, "peak_force_max_in_horizon", RATIO, "in horizon", NULL, \
        NULL, NUMBER_SHOWN | NUMBER_STUDY, NUMBER_LACKED | NUMBER_OF_PEAKS | NUMBER_MINOR, \
        peak_force_max_in_horizon, "error_peak_force_max of contacts that end within the horizon", \
        "largest error of peak forces up to the horizon") \
    words("peak_force_in", "in", NUMBER_SHOWN, NUMBER_OF_PEAKS | NUMBER_MINOR, peak_force_in) \
    row(ERROR, PEAK_ALPHA_MAX, "peak_alpha_max", RATIO, "peak alpha", NULL, NULL, \
        NUMBER_EVERYWHERE, NUMBER_LACKED | NUMBER_OF_PEAKS | NUMBER_OF_ALPHA, peak_alpha_max, \
        "largest error of a body's extremes of alpha, over the larger of them", \
        "largest error of the extremes of alpha") \
    row(ERROR, PEAK_ALPHA_MAX_IN_HORIZON, "peak_alpha_max_in_horizon", RATIO, "in horizon", NULL, \
        NULL, NUMBER_SHOWN | NUMBER_STUDY, NUMBER_LACKED | NUMBER_OF_PEAKS | NUMBER_MINOR, \
        peak_alpha_max_in_horizon, "error_peak_alpha_max up to the horizon", \
        "largest error of the extremes of alpha up to the horizon") \
    words("peak_alpha_in", "in", NUMBER_SHOWN, NUMBER_OF_PEAKS | NUMBER_MINOR, peak_alpha_in)

// Of the reference: `truth`.
#define NUMBERS_OF_TRUTH_LIST(row) \
    row(TRUTH, HORIZON, "horizon", TIME, "horizon", NULL, NULL, NUMBER_JSON | NUMBER_STUDY, \
        NUMBER_LACKED, truth->message[0] == '\0' ? truth->horizon_s : NAN, \
        "predictability horizon") \
    row(TRUTH, UNCERTAINTY, "reference_uncertainty", RATIO, "reference +-", NULL, NULL, \
        NUMBER_JSON | NUMBER_STUDY | NUMBER_REPORT, NUMBER_LACKED, \
        truth->message[0] == '\0' ? truth->uncertainty : NAN, \
        "uncertainty of the reference, relative in the same way", "uncertainty of the reference")
// clang-format on

#define NUMBERS_NO_WORDS(...)

// All of them, owner by owner: the columns of a study stand in this order.
#define NUMBER_LIST(row)                                                                           \
    NUMBERS_OF_BODY_LIST(row)                                                                      \
    NUMBERS_OF_SPIKE_LIST(row, BODY_SPIKE)                                                         \
    NUMBERS_OF_JOINT_LIST(row)                                                                     \
    NUMBERS_OF_SPIKE_LIST(row, JOINT_SPIKE)                                                        \
    NUMBERS_OF_CONTACT_LIST(row)                                                                   \
    NUMBERS_OF_WEAR_LIST(row)                                                                      \
    NUMBERS_OF_RUN_LIST(row)                                                                       \
    NUMBERS_OF_ENERGY_LIST(row)                                                                    \
    NUMBERS_OF_COST_LIST(row)                                                                      \
    NUMBERS_OF_SECTION_LIST(row)                                                                   \
    NUMBERS_OF_SETTLED_LIST(row)                                                                   \
    NUMBERS_OF_SETTLED_JOINT_LIST(row)                                                             \
    NUMBERS_OF_SETTLED_BODY_LIST(row)                                                              \
    NUMBERS_OF_ERROR_LIST(row, NUMBERS_NO_WORDS)                                                   \
    NUMBERS_OF_TRUTH_LIST(row)

#define NUMBERS_ID(owner, id, ...) NUMBER_##owner##_##id,
#define NUMBERS_KIND(id)           NUMBER_OF_##id,
#define NUMBERS_OWNER(id, ...)     NUMBER_OWNER_##id,

typedef enum NumberId { NUMBER_LIST(NUMBERS_ID) NUMBER_COUNT } NumberId;
typedef enum NumberKind { NUMBER_KIND_LIST(NUMBERS_KIND) NUMBER_KIND_COUNT } NumberKind;
typedef enum NumberOwner { NUMBER_OWNER_LIST(NUMBERS_OWNER) NUMBER_OWNER_COUNT } NumberOwner;
