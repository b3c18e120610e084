// The numbers of a run that a study keeps, by name.
//
// The names are those of the JSON output, joined: bodies.follower.omega_max_rad_s becomes
// follower_omega_max_rad_s. What was not measured, or is not finite, is NAN.
#include "commands/study/metrics.h"
#include "base/text.h"
#include "casefile/expect.h"
#include "measure/section.h"
#include "measure/spectrum.h"
#include "model/joint_numbers.h"
#include "write/json_value.h"

#include <assert.h>
#include <math.h>
#include <stdio.h>
#include <string.h>
#include <strings.h>

// What a number of a run is of; the columns stand in this order.
typedef enum Owner {
    OF_BODY,          // each whose motion is not prescribed: BodyExtremes
    OF_JOINT,         // each with play: model/joint_number_list.h, whole numbers first
    OF_RUN,           // Trajectory
    OF_SETTLED,       // SettledStart, in studies whose case is settled
    OF_SETTLED_JOINT, // each with play, likewise: SettledNumber of its force
    OF_ERROR,         // TrajectoryError, in studies with a truth
    OF_TRUTH,         // Truth, likewise
    OWNER_COUNT,
} Owner;

// What must hold for a number to be there.
typedef enum Need {
    NOTHING,
    FIXED_STEP,  // the solver has one
    TRIALS,      // the step was chosen for a tolerance
    CERTIFICATE, // the reference is certified
    FOLLOWED,    // the run started in the motion of its neighbour
    NEIGHBOUR,   // likewise, in a block of runs
    CHECKED,     // it was settled both ways
    GROWTH,      // the growth of small changes was looked for
    TURNS,       // the body does not slide on the ground
    SLIDES,      // it does
} Need;

// What the results of a run are taken from.
typedef struct Measured {
    const Linkage *linkage;
    const SettledStart *settled;
    const Trajectory *run;
    const Truth *truth;    // NULL where there is none
    TrajectoryError error; // known only where there is a truth to compare with
} Measured;

// One column for each owner.
typedef struct Metric {
    Owner owner;
    const char *name; // with its unit; of a joint that limits turn turned_key of it
    ColumnKind kind;
    Need need;
    size_t offset; // in its owner: of a size_t for COLUMN_WHOLE, of a double for COLUMN_REAL
    double (*find)(const Measured *measured, size_t member); // NULL: the value at the offset
    const char *words[2]; // what it is; the same on an axis, NULL where it is short enough for one
} Metric;

// In all joints; NAN where the solver let no play happen.
static double find_impacts(const Measured *measured, size_t unused)
{
    (void)unused;
    double impacts = NAN;
    for (size_t i = 0; i < measured->linkage->joint_count; i++) {
        if (trajectory_feels_play(measured->run, &measured->linkage->joints[i])) {
            impacts = (isnan(impacts) ? 0.0 : impacts) + (double)measured->run->joints[i].impacts;
        }
    }
    return impacts;
}

static double find_alpha_peak(const Measured *measured, size_t unused)
{
    (void)unused;
    double peak = 0.0;
    for (size_t i = 0; i < measured->linkage->body_count; i++) {
        const BodyExtremes *extremes = &measured->run->bodies[i];
        if (!linkage_is_driven(measured->linkage, (int)i)) {
            peak = fmax(peak, fmax(extremes->alpha_max.value, -extremes->alpha_min.value));
        }
    }
    return peak;
}

static double find_period(const Measured *measured, size_t unused)
{
    (void)unused;
    return (double)measured->settled->motions[0].period;
}

static double find_watched(const Measured *measured, size_t unused)
{
    (void)unused;
    return (double)measured->settled->motions[0].watched;
}

static double find_neighbour(const Measured *measured, size_t unused)
{
    (void)unused;
    return (double)measured->settled->neighbour;
}

static double find_order_1(const Measured *measured, size_t body)
{
    return spectrum_body_order(measured->run, body, 1);
}

static double find_order_2(const Measured *measured, size_t body)
{
    return spectrum_body_order(measured->run, body, 2);
}

static double find_between_orders(const Measured *measured, size_t body)
{
    return spectrum_body_between(measured->run, body);
}

// The sections that a row has, the last one first.
#define SECTION_LIST(member) member(1) member(2) member(3) member(4) member(5) member(6)

#define FIND_SECTION(number)                                                                       \
    static double find_section_##number(const Measured *measured, size_t body)                     \
    {                                                                                              \
        return section_omega(measured->run, body, (number)-1);                                     \
    }                                                                                              \
    static double find_slide_##number(const Measured *measured, size_t body)                       \
    {                                                                                              \
        return section_slide(measured->run, body, (number)-1);                                     \
    }
SECTION_LIST(FIND_SECTION)

static double find_section_period(const Measured *measured, size_t unused)
{
    (void)unused;
    return section_period(measured->run);
}

static double find_section_change(const Measured *measured, size_t unused)
{
    (void)unused;
    return section_find(measured->run).change;
}

// clang-format off
// behind the meaning may stand the title
#define ROW(owner, of, name, kind, need, field, ...) \
    {owner, name, COLUMN_##kind, need, offsetof(of, field), NULL, {__VA_ARGS__}}
#define BODY(...) ROW(OF_BODY, BodyExtremes, __VA_ARGS__)
#define RUN(...) ROW(OF_RUN, Trajectory, __VA_ARGS__)
#define SETTLED(...) ROW(OF_SETTLED, SettledStart, __VA_ARGS__)
#define FORCE(...) ROW(OF_SETTLED_JOINT, SettledNumber, __VA_ARGS__)
#define ERROR(...) ROW(OF_ERROR, TrajectoryError, __VA_ARGS__)
#define TRUTH(...) ROW(OF_TRUTH, Truth, __VA_ARGS__)
#define FOUND(owner, name, kind, need, find, ...) \
    {owner, name, COLUMN_##kind, need, 0, find, {__VA_ARGS__}}
#define SECTION(number) \
    FOUND(OF_BODY, "section_" #number "_rad_s", REAL, TURNS, find_section_##number, \
          (number) == 1 ? "angular velocity at the end of the last whole revolution" \
                        : "angular velocity at the ends of the revolutions before that", \
          "angular velocity at the end of revolution -" #number),
#define SLIDE(number) \
    FOUND(OF_BODY, "section_" #number "_m_s", REAL, SLIDES, find_slide_##number, \
          (number) == 1 ? "of a body that slides on the ground its velocity there, along its line" \
                        : "the same at the ends of the revolutions before that", \
          "velocity of the slider at the end of revolution -" #number),

static const Metric METRICS[] = {
    BODY("omega_max_rad_s", REAL, NOTHING, omega_max.value, "largest angular velocity"),
    BODY("omega_min_rad_s", REAL, NOTHING, omega_min.value, "smallest angular velocity"),
    BODY("alpha_max_rad_s2", REAL, NOTHING, alpha_max.value, "largest angular acceleration"),
    BODY("alpha_min_rad_s2", REAL, NOTHING, alpha_min.value, "smallest angular acceleration"),
    FOUND(OF_BODY, "omega_order_1_rad_s", REAL, NOTHING, find_order_1,
          "amplitude of the angular velocity at once the crank's speed",
          "amplitude of omega at the crank's speed"),
    FOUND(OF_BODY, "omega_order_2_rad_s", REAL, NOTHING, find_order_2,
          "the same at twice its speed",
          "amplitude of omega at twice the crank's speed"),
    FOUND(OF_BODY, "omega_between_orders_rad_s", REAL, NOTHING, find_between_orders,
          "its largest amplitude between whole multiples of the crank's speed",
          "largest amplitude of omega between orders"),
    SECTION_LIST(SECTION)
    SECTION_LIST(SLIDE)
    FOUND(OF_RUN, "impacts", WHOLE, NOTHING, find_impacts, "contacts begun in all joints"),
    FOUND(OF_RUN, "alpha_peak_rad_s2", REAL, NOTHING, find_alpha_peak,
          "largest magnitude of any body's angular acceleration",
          "largest angular acceleration of any body"),
    RUN("energy_drive_work_J", REAL, NOTHING, energy.drive_work, "work of the drive"),
    RUN("energy_dissipated_J", REAL, NOTHING, energy.dissipated,
        "lost in the damping of contacts and dampers",
        "energy lost in damping"),
    RUN("energy_residual_J", REAL, NOTHING, energy.residual,
        "unexplained by the balance: the solver's error",
        "residual of the energy balance"),
    RUN("step_s", REAL, FIXED_STEP, step_s, "step of ODE"),
    RUN("steps", WHOLE, NOTHING, steps, "steps of the solver"),
    RUN("evaluations", WHOLE, NOTHING, evaluations, "evaluations of the equations of motion"),
    RUN("fallback_rows", WHOLE, NOTHING, fallback_rows,
        "contact rows for which the requested map would have been unstable",
        "contact rows with the textbook map"),
    RUN("error_estimate", REAL, TRIALS, error_estimate,
        "upper bound of the error, for a step chosen for a tolerance", "upper bound of the error"),
    RUN("error_estimate_until_s", REAL, TRIALS, estimate_s, "time up to which that bound holds",
        "time up to which the bound of the error holds"),
    FOUND(OF_RUN, "section_period", WHOLE, NOTHING, find_section_period,
          "revolutions after which the run repeats; 0: it has not",
          "period of the run, revolutions"),
    FOUND(OF_RUN, "section_change", REAL, NOTHING, find_section_change,
          "by how much its last sections differ from those a period before",
          "change of the sections over a period"),
    FOUND(OF_SETTLED, "settled_period", WHOLE, NOTHING, find_period,
          "revolutions after which the settled motion repeats; 0: it does not",
          "period of the settled motion, revolutions"),
    SETTLED("settled_revolutions", WHOLE, NOTHING, revolutions,
            "revolutions that it took to settle", "revolutions until settled"),
    SETTLED("settled_motions", WHOLE, NOTHING, motion_count,
            "different motions that its starts came to", "number of settled motions"),
    FOUND(OF_SETTLED, "settled_watched", WHOLE, NOTHING, find_watched,
          "revolutions that each start of its motion was watched for, at least",
          "revolutions watched"),
    SETTLED("settled_growth", REAL, GROWTH, growth.factor,
            "growth of a small change of its motion in a revolution, or its bound",
            "growth of a small change in a revolution"),
    SETTLED("followed_from", REAL, FOLLOWED, followed_from,
            "value of the followed key at the run whose motion it started in",
          "value that the motion was followed from"),
    FOUND(OF_SETTLED, "settled_from_run", WHOLE, NEIGHBOUR, find_neighbour,
          "run in whose settled motion it started; none: it found its own",
          "run that the motion is from"),
    SETTLED("settled_apart", REAL, CHECKED, apart_from_followed,
            "relative difference of forces, settled by itself and from a neighbour",
            "difference of forces, settled both ways"),
    FORCE("settled_force_N", REAL, NOTHING, headline,
          "settled motion's largest force; 95 % quantile where it does not repeat",
          "largest force of the settled motion"),
    FORCE("settled_force_low_N", REAL, NOTHING, low,
          "low end of the 95 % interval of <joint>_settled_force_N",
          "largest force of the settled motion, low end"),
    FORCE("settled_force_high_N", REAL, NOTHING, high,
          "its high end; none where too few revolutions are known",
          "largest force of the settled motion, high end"),
    FORCE("settled_force_median_N", REAL, NOTHING, median,
          "median of the largest force in a revolution of the settled motion",
          "median of the largest force in a revolution"),
    FORCE("settled_force_largest_N", REAL, NOTHING, largest,
          "largest force in all revolutions that were counted"),
    ERROR("error_max", REAL, NOTHING, max,
          "largest error of any velocity of bodies and pins, over its own largest",
          "largest error of the velocities"),
    ERROR("error_max_in_horizon", REAL, NOTHING, max_in_horizon,
          "error_max up to the horizon",
          "largest error of the velocities up to the horizon"),
    ERROR("error_omega_max", REAL, NOTHING, omega_max,
          "largest error of omega, over each body's largest omega",
          "largest error of omega"),
    ERROR("error_omega_max_in_horizon", REAL, NOTHING, omega_max_in_horizon,
          "error_omega_max up to the horizon", "largest error of omega up to the horizon"),
    ERROR("error_omega_rms", REAL, NOTHING, omega_rms, "root mean square of the errors of omega",
        "rms error of omega"),
    ERROR("error_alpha_max", REAL, NOTHING, alpha_max,
          "largest error of alpha, relative to each body's largest alpha",
          "largest error of alpha"),
    ERROR("error_force_max", REAL, NOTHING, force_max,
          "largest error of a contact force at samples, over the joint's largest",
          "largest error of contact forces"),
    ERROR("error_force_max_in_horizon", REAL, NOTHING, force_max_in_horizon,
          "error_force_max up to the horizon",
          "largest error of contact forces up to the horizon"),
    ERROR("error_peak_force_max", REAL, NOTHING, peak_force_max,
          "largest error of the peak force of a contact, over the joint's largest",
          "largest error of peak forces"),
    ERROR("error_peak_force_max_in_horizon", REAL, NOTHING, peak_force_max_in_horizon,
          "error_peak_force_max of contacts that end within the horizon",
          "largest error of peak forces up to the horizon"),
    ERROR("error_peak_alpha_max", REAL, NOTHING, peak_alpha_max,
          "largest error of a body's extremes of alpha, over the larger of them",
          "largest error of the extremes of alpha"),
    ERROR("error_peak_alpha_max_in_horizon", REAL, NOTHING, peak_alpha_max_in_horizon,
          "error_peak_alpha_max up to the horizon",
          "largest error of the extremes of alpha up to the horizon"),
    TRUTH("error_horizon_s", REAL, CERTIFICATE, horizon_s, "predictability horizon"),
    TRUTH("error_reference_uncertainty", REAL, CERTIFICATE, uncertainty,
          "uncertainty of the reference, relative in the same way", "uncertainty of the reference"),
};
// clang-format on
enum { METRIC_COUNT = sizeof METRICS / sizeof *METRICS };

// Whether a name stands in the layout before a column; stores tell no small letters from large
// ones.
static bool is_taken(const Layout *layout, const Column *until)
{
    const Column *const columns[] = {layout->settings, layout->results};
    const size_t counts[] = {layout->setting_count, layout->result_count};
    for (size_t part = 0; part < 2; part++) {
        for (size_t i = 0; i < counts[part]; i++) {
            const Column *column = &columns[part][i];
            if (column != until && strcasecmp(column->name, until->name) == 0) {
                return true;
            }
        }
    }
    return false;
}

// Joins two words by _. Letters and digits stay, all else becomes _; rad/s^2 becomes rad_s2, as in
// the JSON output. Names that become one are numbered.
static void name_column(const Layout *layout, Column *column, const char *first, const char *last)
{
    static const char PLAIN[] = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789";
    enum { ROOM = RECORD_NAME_SIZE - 16 }; // the rest is for a number behind the name
    const bool is_joined = first[0] != '\0' && last[0] != '\0';
    char words[RECORD_NAME_SIZE];
    char name[ROOM];
    size_t length = 0;
    snprintf(words, sizeof words, "%s%s%s", first, is_joined ? "_" : "", last);
    for (const char *c = words; *c != '\0' && length < ROOM - 1; c++) {
        if (*c != '^') {
            name[length++] = (char)(strchr(PLAIN, *c) != NULL ? *c : '_');
        }
    }
    name[length] = '\0';
    text_copy(column->name, sizeof column->name, name);
    for (int number = 2; is_taken(layout, column); number++) {
        snprintf(column->name, sizeof column->name, "%s_%d", name, number);
    }
}

static void metrics_add_settings(const Spec *spec, Layout *layout)
{
    for (size_t i = 0; i < spec->variable_count; i++) {
        const Variable *variable = &spec->variables[i];
        Column *column = &layout->settings[layout->setting_count++];
        column->kind = variable->is_word    ? COLUMN_WORD
                       : variable->is_whole ? COLUMN_WHOLE
                                            : COLUMN_REAL;
        name_column(layout, column, variable->key, variable->is_word ? "" : variable->column_unit);
    }
}

// One result of a linkage.
typedef struct Result {
    const Metric *metric; // NULL: one of joints, which is the next
    JointNumberId number;
    size_t member;  // number of its body or joint
    const char *of; // name of that, or empty
} Result;

static bool metrics_find_member(const Linkage *linkage, Owner owner, size_t member,
                                const char **name)
{
    if (owner == OF_BODY) {
        *name = linkage->bodies[member].name;
        return !linkage_is_driven(linkage, (int)member);
    }
    if (owner == OF_JOINT || owner == OF_SETTLED_JOINT) {
        *name = linkage->joints[member].name;
        return linkage_has_play(&linkage->joints[member]);
    }
    *name = "";
    return true;
}

// The number of a joint that has a place among them, or JOINT_NUMBER_COUNT.
static JointNumberId number_at(size_t place)
{
    for (int pass = 0; pass < 2; pass++) {
        for (JointNumberId id = 0; id < JOINT_NUMBER_COUNT; id++) {
            const bool is_whole = JOINT_NUMBERS[id].kind == JOINT_NUMBER_OF_COUNT;
            if (is_whole == (pass == 0) && place-- == 0) {
                return id;
            }
        }
    }
    return JOINT_NUMBER_COUNT;
}

// Whether a body's way of moving is that which a number is for.
static bool metrics_moves(const Linkage *linkage, const Metric *metric, size_t body)
{
    return (metric->need != TURNS && metric->need != SLIDES) ||
           (section_slider(linkage, body) >= 0) == (metric->need == SLIDES);
}

// Of which results there are none in some studies.
typedef struct Lists {
    bool has_settled;
    bool is_following;
    bool has_growth;
    bool has_neighbours;
} Lists;

// Whether a study of these lists has a number.
static bool metrics_is_listed(const Metric *metric, Lists lists)
{
    return metric->need == FOLLOWED                               ? lists.is_following
           : metric->need == GROWTH                               ? lists.has_growth
           : metric->need == NEIGHBOUR || metric->need == CHECKED ? lists.has_neighbours
                                                                  : true;
}

// The results of one body, joint or whole.
static size_t list_member(const Linkage *linkage, Owner owner, size_t member, Lists lists,
                          Result *results)
{
    const char *name;
    size_t count = 0;
    if (!metrics_find_member(linkage, owner, member, &name)) {
        return 0;
    }
    for (size_t k = 0; owner == OF_JOINT && k < JOINT_NUMBER_COUNT; k++) {
        results[count++] = (Result){.number = number_at(k), .member = member, .of = name};
    }
    for (size_t k = 0; k < METRIC_COUNT; k++) {
        if (METRICS[k].owner == owner && metrics_is_listed(&METRICS[k], lists) &&
            metrics_moves(linkage, &METRICS[k], member)) {
            results[count++] = (Result){.metric = &METRICS[k], .member = member, .of = name};
        }
    }
    return count;
}

// All results of a linkage in the order of their columns.
static size_t list_results(const Linkage *linkage, Lists lists, Result results[RECORD_RESULT_MAX])
{
    const size_t members[OWNER_COUNT] = {
        linkage->body_count,
        linkage->joint_count,
        1,
        lists.has_settled ? 1 : 0,
        lists.has_settled ? linkage->joint_count : 0,
        1,
        1,
    };
    size_t count = 0;
    for (Owner owner = 0; owner < OWNER_COUNT; owner++) {
        for (size_t i = 0; i < members[owner]; i++) {
            assert(count + METRIC_COUNT + JOINT_NUMBER_COUNT <= RECORD_RESULT_MAX);
            count += list_member(linkage, owner, i, lists, results + count);
        }
    }
    return count;
}

bool metrics_fit(const Scenario *scenario, Err *err)
{
    const Linkage *linkage = &scenario->linkage;
    size_t of_body = 0;
    size_t of_joint = JOINT_NUMBER_COUNT;
    for (size_t k = 0; k < METRIC_COUNT; k++) {
        // a body either turns or slides, and has as many numbers for both
        of_body += METRICS[k].owner == OF_BODY && METRICS[k].need != SLIDES ? 1 : 0;
        of_joint += METRICS[k].owner == OF_SETTLED_JOINT ? 1 : 0;
    }
    size_t count = METRIC_COUNT + JOINT_NUMBER_COUNT + of_body * linkage->body_count;
    for (size_t i = 0; i < linkage->joint_count; i++) {
        count += linkage_has_play(&linkage->joints[i]) ? of_joint : 0;
    }
    return count <= RECORD_RESULT_MAX ||
           err_set(err, ERR_CASE,
                   "the mechanism has %zu bodies, and a row of a study has room for %d numbers of "
                   "bodies and joints; 'jointplay run --json' has them all",
                   linkage->body_count, RECORD_RESULT_MAX);
}

// The key of a number, which is turned where it is of a joint that limits turn.
static const char *metric_key(const Linkage *linkage, const Result *result,
                              char turned[TURNED_KEY_SIZE])
{
    if (result->metric->owner != OF_SETTLED_JOINT ||
        !linkage_is_torsional(&linkage->joints[result->member])) {
        return result->metric->name;
    }
    turned_key(result->metric->name, turned);
    return turned;
}

void metrics_layout(const Spec *spec, const Scenario *scenario, Layout *layout)
{
    Result results[RECORD_RESULT_MAX];
    const Lists lists = {scenario_settles(scenario), spec->follow[0] != '\0', spec->has_growth,
                         spec->has_neighbours};
    const size_t count = list_results(&scenario->linkage, lists, results);
    char turned[TURNED_KEY_SIZE];
    *layout = (Layout){0};
    metrics_add_settings(spec, layout);
    for (size_t i = 0; i < count; i++) {
        const Result *result = &results[i];
        const Metric *metric = result->metric;
        const JointNumber *number = &JOINT_NUMBERS[result->number];
        if (metric == NULL) {
            const Joint *joint = &scenario->linkage.joints[result->member];
            Column *column = &layout->results[layout->result_count++];
            column->kind = number->kind == JOINT_NUMBER_OF_COUNT ? COLUMN_WHOLE : COLUMN_REAL;
            name_column(layout, column, result->of, number->keys[linkage_is_torsional(joint)]);
        } else if (metric->owner < OF_ERROR || spec->has_truth) {
            Column *column = &layout->results[layout->result_count++];
            column->kind = metric->kind;
            name_column(layout, column, result->of, metric_key(&scenario->linkage, result, turned));
        }
    }
}

// Whether a column is of a number with that key: its whole name, or with the name of a body or
// joint before it, whose length is then told.
static bool has_key(const char *column, const char *key, bool has_owner, size_t *owner_length)
{
    const size_t length = strlen(column);
    const size_t size = strlen(key);
    *owner_length = has_owner && length > size + 1 ? length - size - 1 : 0;
    return has_owner ? *owner_length > 0 && column[*owner_length] == '_' &&
                           strcmp(column + *owner_length + 1, key) == 0
                     : strcmp(column, key) == 0;
}

bool metrics_title(const char *column, const char **title, const char **key, size_t *owner_length)
{
    for (size_t i = 0; i < METRIC_COUNT; i++) {
        const Metric *metric = &METRICS[i];
        const bool is_of_joint = metric->owner == OF_SETTLED_JOINT;
        const bool has_owner = metric->owner == OF_BODY || is_of_joint;
        char turned[TURNED_KEY_SIZE];
        turned_key(metric->name, turned);
        if (has_key(column, metric->name, has_owner, owner_length) ||
            (is_of_joint && has_key(column, turned, true, owner_length))) {
            *title = metric->words[metric->words[1] != NULL ? 1 : 0];
            *key = metric->name;
            return true;
        }
    }
    for (size_t i = 0; i < 2 * JOINT_NUMBER_COUNT; i++) {
        const JointNumber *number = &JOINT_NUMBERS[i / 2];
        if (has_key(column, number->keys[i % 2], true, owner_length)) {
            const bool is_torque = number->kind == JOINT_NUMBER_OF_FORCE && i % 2 == 1;
            *title = is_torque ? "largest torque" : number->meaning;
            *key = number->keys[i % 2];
            return true;
        }
    }
    return false;
}

static bool is_there(const Metric *metric, const Measured *measured)
{
    if ((metric->owner >= OF_ERROR && !measured->error.is_known) ||
        ((metric->owner == OF_SETTLED || metric->owner == OF_SETTLED_JOINT) &&
         measured->settled->motion_count == 0) ||
        (metric->owner == OF_SETTLED_JOINT && measured->settled->is_brief)) {
        return false;
    }
    switch (metric->need) {
    case FIXED_STEP:
        return measured->run->step_s > 0.0;
    case TRIALS:
        return measured->run->trials > 0;
    case CERTIFICATE:
        return measured->truth->message[0] == '\0';
    case FOLLOWED:
    case NEIGHBOUR:
        return measured->settled->is_followed;
    case CHECKED:
        return measured->settled->is_checked;
    case GROWTH:
        return measured->settled->has_growth;
    default:
        return true;
    }
}

static double metrics_read_value(const Metric *metric, const Measured *measured, size_t member)
{
    const void *const owners[OWNER_COUNT] = {
        &measured->run->bodies[metric->owner == OF_BODY ? member : 0],
        NULL,
        measured->run,
        measured->settled,
        metric->owner == OF_SETTLED_JOINT ? &measured->settled->motions[0].joints[member].force
                                          : NULL,
        &measured->error,
        measured->truth,
    };
    const void *value = (const char *)owners[metric->owner] + metric->offset;
    return metric->find != NULL           ? metric->find(measured, member)
           : metric->kind == COLUMN_WHOLE ? (double)*(const size_t *)value
                                          : *(const double *)value;
}

// NAN where it is not known.
static double metrics_read_result(const Result *result, const Measured *measured)
{
    if (result->metric == NULL) {
        return joint_numbers_find(result->number, measured->run, result->member).value;
    }
    return is_there(result->metric, measured)
               ? metrics_read_value(result->metric, measured, result->member)
               : NAN;
}

// Whether the columns of a study have one of a name.
static bool metrics_has(const Layout *layout, const char *name)
{
    for (size_t i = 0; i < layout->result_count; i++) {
        if (strcmp(layout->results[i].name, name) == 0) {
            return true;
        }
    }
    return false;
}

bool metrics_take(const Layout *layout, const Scenario *scenario, Trajectory *trajectory,
                  const Truth *truth, double results[RECORD_RESULT_MAX])
{
    assert(trajectory->is_complete);
    Measured measured = {
        .linkage = &scenario->linkage,
        .settled = &scenario->settled,
        .run = trajectory,
        .truth = truth,
    };
    if (truth != NULL && truth->trajectory->is_complete) {
        measured.error = error_against(trajectory, truth->trajectory, truth->horizon_s);
        if (error_fail_unstable(trajectory, truth->trajectory, &measured.error)) {
            return false;
        }
    }
    Result list[RECORD_RESULT_MAX];
    const Lists lists = {
        metrics_has(layout, "settled_period"), metrics_has(layout, "followed_from"),
        metrics_has(layout, "settled_growth"), metrics_has(layout, "settled_from_run")};
    const size_t count = list_results(measured.linkage, lists, list);
    for (size_t i = 0; i < RECORD_RESULT_MAX; i++) {
        const double value = i < count ? metrics_read_result(&list[i], &measured) : NAN;
        results[i] = isfinite(value) ? value : NAN;
    }
    return true;
}

static void describe_one(bool is_markdown, const char *owner, const char *name, const char *meaning,
                         Text *text)
{
    text_append(text, is_markdown ? "- `%s%s`: %s\n" : "    %s%s\n        %s\n", owner, name,
                meaning);
}

// Whether a limit of a case has the same meaning.
static bool is_expectable(const char *meaning)
{
    for (int i = 0; i < EXPECTED_NUMBER_COUNT; i++) {
        if (strcmp(EXPECT_ROWS[i].doc, meaning) == 0) {
            return true;
        }
    }
    return false;
}

static const char *before_name(Owner owner)
{
    return owner == OF_BODY ? "<body>_" : owner == OF_SETTLED_JOINT ? "<joint>_" : "";
}

// The columns whose meanings the page of a case has.
static void list_expectable(Text *text)
{
    text_append(text, "- with the meanings in [`expect`](case-format.md#expect)");
    for (size_t i = 0; i < METRIC_COUNT; i++) {
        if (is_expectable(METRICS[i].words[0])) {
            text_append(text, ", `%s%s`", before_name(METRICS[i].owner), METRICS[i].name);
        }
    }
    for (size_t k = 0; k < JOINT_NUMBER_COUNT; k++) {
        text_append(text, ", `<joint>_%s`", JOINT_NUMBERS[number_at(k)].keys[false]);
    }
    text_append(text, "\n");
}

// The numbers of an owner; on the page those of one meaning are a range, and those of `expect`
// stand before.
static void describe_owner(Owner owner, bool is_markdown, Text *text)
{
    const char *before = before_name(owner);
    for (size_t i = 0; i < METRIC_COUNT; i++) {
        const char *meaning = METRICS[i].words[0];
        if (METRICS[i].owner != owner || (is_markdown && is_expectable(meaning))) {
            continue;
        }
        size_t last = i;
        while (is_markdown && last + 1 < METRIC_COUNT && METRICS[last + 1].owner == owner &&
               strcmp(METRICS[last + 1].words[0], meaning) == 0) {
            last++;
        }
        if (last == i) {
            describe_one(is_markdown, before, METRICS[i].name, meaning, text);
            continue;
        }
        text_append(text, "- `%s%s` to `%s%s`: %s\n", before, METRICS[i].name, before,
                    METRICS[last].name, meaning);
        i = last;
    }
}

void metrics_describe(bool is_markdown, Text *text)
{
    if (is_markdown) {
        list_expectable(text);
    }
    for (Owner owner = 0; owner < OWNER_COUNT; owner++) {
        for (size_t k = 0; owner == OF_JOINT && !is_markdown && k < JOINT_NUMBER_COUNT; k++) {
            const JointNumber *number = &JOINT_NUMBERS[number_at(k)];
            describe_one(is_markdown, "<joint>_", number->keys[false], number->meaning, text);
        }
        describe_owner(owner, is_markdown, text);
    }
}
