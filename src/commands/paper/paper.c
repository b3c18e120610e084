// Recomputes what the paper prints, and says what it should have been.
#include "commands/paper/paper.h"
#include "analytic/fourbar_motion.h"
#include "analytic/inverse_dynamics.h"
#include "base/side_by_side.h"
#include "base/text.h"
#include "casefile/casefile.h"
#include "contact/law.h"
#include "contact/penalty.h"
#include "measure/number_values.h"
#include "run/registry.h"
#include "run/tracer.h"

#include <assert.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

// The paper's cases inside the program.
//
// The build puts each YAML file into the program byte for byte, between two symbols, and does so
// again when the file changes.

extern const char embedded_ideal_nominal[];
extern const char embedded_ideal_nominal_end[];
extern const char embedded_ideal_stackup[];
extern const char embedded_ideal_stackup_end[];
extern const char embedded_stackup_poisson[];
extern const char embedded_stackup_poisson_end[];
extern const char embedded_stackup_impact[];
extern const char embedded_stackup_impact_end[];

typedef struct EmbeddedText {
    const char *name; // for messages
    const char *begin;
    const char *end;
} EmbeddedText;

static const EmbeddedText TEXTS[EMBEDDED_COUNT] = {
    [EMBEDDED_IDEAL_NOMINAL] = {"paper/ideal-nominal.yaml", embedded_ideal_nominal,
                                embedded_ideal_nominal_end},
    [EMBEDDED_IDEAL_STACKUP] = {"paper/ideal-stackup.yaml", embedded_ideal_stackup,
                                embedded_ideal_stackup_end},
    [EMBEDDED_STACKUP_POISSON] = {"paper/stackup-poisson.yaml", embedded_stackup_poisson,
                                  embedded_stackup_poisson_end},
    [EMBEDDED_STACKUP_IMPACT] = {"paper/stackup-impact.yaml", embedded_stackup_impact,
                                 embedded_stackup_impact_end},
};

bool embedded_load(EmbeddedCase which, Scenario *scenario, Err *err)
{
    // The paper starts with pins in the middle of their holes, and its law knows no other speed
    // than that of the impact.
    static const char *const AS_IN_PAPER[] = {"drive.speed=-1000 rpm", "run.start=centred",
                                              "contact.resting-speed=none"};
    const EmbeddedText *text = &TEXTS[which];
    return casefile_load_text(text->name, text->begin, (size_t)(text->end - text->begin),
                              AS_IN_PAPER, 3, scenario, err);
}

// The extremes of coupler and follower, by the paper and recomputed.
//
// Ideal rows      the closed form, extremes at their exact crank angles
// Analytical row  the same curve sampled at whole degrees of crank angle, as the paper must have
// Stack-up rows   ODE on the case with play; peaks over every step. IMPACT with contacts that are
//                 integrated within the step: at 10 us its peaks are right to 5e-5, where textbook
//                 use of ODE is off by a tenth at 1 us. POISSON's forces are impulses over a step.
//                 It takes longest: a thread makes all else meanwhile.
//
// The crank turns clockwise, which flips the signs of omega and leaves those of alpha. The paper
// gives no step, damping, restitution, friction or sampling for its stack-up rows, and a peak of
// acceleration depends on all of them: those rows are orders of magnitude.

enum { DEGREES = 360 };

static const double IMPACT_STEP_S = 1e-5;

static const RunWatch NOBODY = {NULL, NULL};

static const char *const BODY_NAMES[] = {"coupler", "follower"};

// The row's own numbers: what they are made of, and how far from the printed ones.
static void finish_row(ExtremesRow *row)
{
    row->is_known = true;
    for (int i = 0; i < PRINTED_QUANTITY_COUNT; i++) {
        const double difference = fabs(row->ours[i] - row->printed[i]) / fabs(row->printed[i]);
        row->difference_max = fmax(row->difference_max, difference);
        row->as_printed +=
            printed_agrees(row->ours[i], row->printed[i], PRINTED_COLUMNS[i].decimals) ? 1 : 0;
    }
}

static void take_joint(const Scenario *scenario, const Trajectory *run, ExtremesRow *row)
{
    for (size_t i = 0; i < run->joint_count; i++) {
        if (joint_has_hole(scenario->linkage.joints[i].kind)) {
            row->impacts += run->joints[i].impacts;
            row->force_max = fmax(row->force_max, run->joints[i].force_max.value);
        }
    }
}

static void take_bodies(const Scenario *scenario, const Trajectory *run, ExtremesRow *row)
{
    const NumberSource source = {.scenario = scenario, .run = run};
    for (size_t i = 0; i < PRINTED_QUANTITY_COUNT; i++) {
        const PrintedColumn *column = &PRINTED_COLUMNS[i];
        const int body = linkage_find_body(&scenario->linkage, column->body);
        if (body < 0) {
            snprintf(row->message, sizeof row->message, "the case has no body %s", column->body);
            return;
        }
        row->ours[i] = number_find(column->number, &source, (size_t)body).value;
    }
    finish_row(row);
}

// Takes every so many samples of the first revolution, so that they are a degree apart.
static void take_curve(const Scenario *scenario, const Trajectory *run, PaperCurve *curve)
{
    const int bodies[2] = {linkage_find_body(&scenario->linkage, BODY_NAMES[0]),
                           linkage_find_body(&scenario->linkage, BODY_NAMES[1])};
    const double turn = 2.0 * M_PI * (1.0 + 1e-9);
    for (size_t i = 0; i < run->sample_count && curve->count < PAPER_CURVE_POINTS; i++) {
        const double turned = fabs(run->crank_angles[i] - run->crank_angles[0]);
        const double next = 2.0 * M_PI * (double)curve->count / (PAPER_CURVE_POINTS - 1);
        if (turned < next * (1.0 - 1e-9) || turned > turn) {
            continue;
        }
        const Motion *motions = &run->motions[i * run->body_count];
        curve->crank_deg[curve->count] = turned * 180.0 / M_PI;
        for (int k = 0; k < 2; k++) {
            curve->values[k][curve->count] = motions[bodies[k]].omega;
            curve->values[2 + k][curve->count] = motions[bodies[k]].alpha;
        }
        curve->count++;
    }
}

// Takes a run, which it destroys, into a row.
static void fill_by_run(const Scenario *scenario, Trajectory *run, ExtremesRow *row)
{
    text_copy(row->label, sizeof row->label, run->label);
    row->step_s = run->step_s;
    if (run->is_complete) {
        take_joint(scenario, run, row);
        take_bodies(scenario, run, row);
        if (row->is_known) {
            take_curve(scenario, run, &row->curve);
        }
    } else {
        text_copy(row->message, sizeof row->message, run->message);
    }
    trajectory_destroy(run);
}

static bool paper_fill_ideal(EmbeddedCase which, ExtremesRow *row, Err *err)
{
    Scenario scenario;
    if (!embedded_load(which, &scenario, err)) {
        return false;
    }
    fill_by_run(&scenario, run_scenario(&scenario, registry_solver(BACKEND_ANALYTIC), NOBODY), row);
    scenario_free(&scenario);
    return true;
}

static bool fill_impact(ExtremesRow *row, Err *err)
{
    Scenario scenario;
    if (!embedded_load(EMBEDDED_STACKUP_IMPACT, &scenario, err)) {
        return false;
    }
    scenario.ode.stepping = ODE_STAGGERED;
    scenario.ode.map = ODE_MAP_IMPULSE;
    scenario.run.step = IMPACT_STEP_S;
    scenario.run.keeps_ranges = false;
    // peaks inside the steps count
    fill_by_run(&scenario, tracer_run(&scenario, registry_solver(BACKEND_ODE), NOBODY), row);
    scenario_free(&scenario);
    return true;
}

static bool fill_poisson(RunWatch watch, ExtremesRow *row, Err *err)
{
    Scenario scenario;
    if (!embedded_load(EMBEDDED_STACKUP_POISSON, &scenario, err)) {
        return false;
    }
    // nothing else of it is read than extremes and curve
    scenario.run.is_lean = true;
    fill_by_run(&scenario, run_scenario(&scenario, registry_solver(BACKEND_ODE), watch), row);
    scenario_free(&scenario);
    return true;
}

// Largest and smallest of a curve sampled at whole degrees.
static void sampled_range(const double *values, double *high, double *low)
{
    *high = values[0];
    *low = values[0];
    for (int i = 1; i < DEGREES; i++) {
        *high = fmax(*high, values[i]);
        *low = fmin(*low, values[i]);
    }
}

static bool fill_by_sampling(ExtremesRow *row, Err *err)
{
    Scenario scenario;
    if (!embedded_load(EMBEDDED_IDEAL_NOMINAL, &scenario, err)) {
        return false;
    }
    double angles[DEGREES];
    double curves[4][DEGREES]; // coupler omega, follower omega, coupler alpha, follower alpha
    for (int i = 0; i < DEGREES; i++) {
        angles[i] = 2.0 * M_PI * i / DEGREES;
    }
    const FourBarLengths lengths = fourbar_motion_nominal(&scenario.fourbar);
    const FourBarGrid grid = {
        .coupler_omega = curves[0],
        .follower_omega = curves[1],
        .coupler_alpha = curves[2],
        .follower_alpha = curves[3],
    };
    fourbar_motion_grid(&lengths, scenario.linkage.driver.speed, DEGREES, angles, &grid);
    scenario_free(&scenario);
    for (int i = 0; i < 4; i++) {
        sampled_range(curves[i], &row->ours[2 * i], &row->ours[2 * i + 1]);
    }
    text_copy(row->label, sizeof row->label, "analytic, sampled at whole degrees");
    finish_row(row);
    return true;
}

// A row with nothing of ours yet.
static ExtremesRow empty_row(int number)
{
    ExtremesRow row = {
        .name = PRINTED_EXTREMES[number].name,
        .is_target = number != PRINTED_POISSON && number != PRINTED_IMPACT,
    };
    for (int j = 0; j < PRINTED_QUANTITY_COUNT; j++) {
        row.printed[j] = PRINTED_EXTREMES[number].values[j];
    }
    return row;
}

// Makes the row that takes longest, PRINTED_POISSON; the watch follows it. Fails where an embedded
// case cannot be loaded; of a run that fails the row says so.
static bool extremes_longest(RunWatch watch, ExtremesRow *row, Err *err)
{
    *row = empty_row(PRINTED_POISSON);
    return fill_poisson(watch, row, err);
}

// Makes the other rows, likewise.
static bool extremes_others(ExtremesRow rows[PRINTED_ROW_COUNT], Err *err)
{
    for (int i = 0; i < PRINTED_ROW_COUNT; i++) {
        if (i != PRINTED_POISSON) {
            rows[i] = empty_row(i);
        }
    }
    return paper_fill_ideal(EMBEDDED_IDEAL_NOMINAL, &rows[PRINTED_IDEAL_NOMINAL], err) &&
           paper_fill_ideal(EMBEDDED_IDEAL_STACKUP, &rows[PRINTED_IDEAL_STACKUP], err) &&
           fill_impact(&rows[PRINTED_IMPACT], err) &&
           fill_by_sampling(&rows[PRINTED_IDEAL_ANALYTICAL], err);
}

double extremes_difference_max(const ExtremesRow rows[PRINTED_ROW_COUNT])
{
    double difference = 0.0;
    for (int i = 0; i < PRINTED_ROW_COUNT; i++) {
        if (rows[i].is_target) {
            difference = rows[i].is_known ? fmax(difference, rows[i].difference_max) : INFINITY;
        }
    }
    return difference;
}

static int extremes_as_printed(const ExtremesRow rows[PRINTED_ROW_COUNT], int *cell_count)
{
    int count = 0;
    *cell_count = 0;
    for (int i = 0; i < PRINTED_ROW_COUNT; i++) {
        if (rows[i].is_target) {
            count += rows[i].as_printed;
            *cell_count += PRINTED_QUANTITY_COUNT;
        }
    }
    return count;
}

// The pin forces and what contact mechanics gives under them.
//
// Pin forces     Newton and Euler for each link with every joint ideal; the largest size over a
//                turn. Twice the speed is four times the inertia forces; gravity stays:
//                R(phi, w) = (w / w0)^2 R_inertia(phi) + R_gravity(phi)
// Approach       the laws of contact/law under that force, static
// Half width     b = sqrt(4 F R / (pi L E*)), half-angle = asin(b / Rj)   (Hertz, line contact)
//
// phi crank angle; w crank speed, w0 = 1000 rpm; F force, N; R = Ri Rj / (Ri - Rj), m; L width, m.
// Hertz takes the contact as narrow. At the paper's speed the half-angle is 17 degrees, so every
// law here is an approximation there, good to some ten per cent.
//
// Source: Johnson, Contact Mechanics (1985), ch. 4.

static const double RAD_PER_S_PER_RPM = 3.14159265358979323846 / 30.0;

// forces are smooth over the turn: a tenth of a degree finds a maximum to some 1e-6 of it
enum { ANGLE_COUNT = 3600 };

static const double BASE_RPM = 1000.0;

// The reactions at one crank angle in two parts, N.
typedef struct ForceParts {
    Vec2 inertia; // at BASE_RPM
    Vec2 gravity;
} ForceParts;

static bool split_forces(const Scenario *fourbar, double angle, ForceParts parts[PRINTED_PIN_COUNT],
                         Err *err)
{
    const Linkage *linkage = &fourbar->linkage;
    const FourBarLengths lengths = fourbar_motion_nominal(&fourbar->fourbar);
    Motion motions[3];
    Reactions weightless;
    Reactions whole;
    if (!fourbar_motion_bodies(&lengths, BASE_RPM * RAD_PER_S_PER_RPM, angle, motions)) {
        return err_set(err, ERR_SOLVER, "the crank of the paper's four-bar does not turn fully");
    }
    if (!inverse_dynamics_solve(linkage, motions, (Vec2){0.0, 0.0}, (InverseTime){0.0, 0.0},
                                &weightless, err) ||
        !inverse_dynamics_solve(linkage, motions, scenario_gravity(fourbar),
                                (InverseTime){0.0, 0.0}, &whole, err)) {
        return false;
    }
    for (int pin = 0; pin < PRINTED_PIN_COUNT; pin++) {
        const int joint = linkage_find_joint(linkage, PRINTED_PIN_NAMES[pin]);
        if (joint < 0) {
            return err_set(err, ERR_SOLVER, "the four-bar has no joint %s", PRINTED_PIN_NAMES[pin]);
        }
        parts[pin].inertia = weightless.force_on_b[joint];
        parts[pin].gravity = vec2_sub(whole.force_on_b[joint], weightless.force_on_b[joint]);
    }
    return true;
}

// The largest forces at many speeds, from one walk round the turn.
static bool largest_forces(const Scenario *fourbar, int speed_count, const double *rpm,
                           double (*forces)[PRINTED_PIN_COUNT], Err *err)
{
    for (int i = 0; i < ANGLE_COUNT; i++) {
        ForceParts parts[PRINTED_PIN_COUNT];
        const double angle = 2.0 * M_PI * i / ANGLE_COUNT;
        if (!split_forces(fourbar, angle, parts, err)) {
            return false;
        }
        for (int row = 0; row < speed_count; row++) {
            const double share = rpm[row] / BASE_RPM * (rpm[row] / BASE_RPM);
            for (int pin = 0; pin < PRINTED_PIN_COUNT; pin++) {
                const Vec2 inertia = vec2_scale(share, parts[pin].inertia);
                const double size = vec2_length(vec2_add(inertia, parts[pin].gravity));
                forces[row][pin] = i == 0 ? size : fmax(forces[row][pin], size);
            }
        }
    }
    return true;
}

bool physical_force(const Scenario *fourbar, double rpm, double forces[PRINTED_PIN_COUNT], Err *err)
{
    double row[1][PRINTED_PIN_COUNT];
    if (!largest_forces(fourbar, 1, &rpm, row, err)) {
        return false;
    }
    for (int pin = 0; pin < PRINTED_PIN_COUNT; pin++) {
        forces[pin] = row[0][pin];
    }
    return true;
}

static ContactPair paper_pair(const MaterialOptions *material)
{
    const Clearance clearance = {
        .hole_radius = 0.5 * PRINTED_HOLE_DIAMETER,
        .pin_radius = 0.5 * PRINTED_PIN_DIAMETER,
        .width = PRINTED_PIN_WIDTH,
    };
    return law_pair(&clearance, material, BASE_RPM * RAD_PER_S_PER_RPM);
}

static double half_angle(const ContactPair *pair, double force)
{
    const double difference = pair->hole_radius - pair->pin_radius;
    const double radius = pair->hole_radius * pair->pin_radius / difference;
    const double stiffness = M_PI * pair->width * law_effective_modulus(pair);
    return asin(fmin(1.0, sqrt(4.0 * force * radius / stiffness) / pair->pin_radius));
}

static bool fill_pin(const ContactPair *pair, double force, PhysicalPin *made, Err *err)
{
    ForceLaw hertz;
    ForceLaw johnson;
    if (!law_make(LAW_HERTZ_SOCKET, pair, &hertz, err) ||
        !law_make(LAW_JOHNSON, pair, &johnson, err)) {
        return false;
    }
    made->force = force;
    made->hertz_approach = force_law_penetration(&hertz, force);
    made->johnson_approach = force_law_penetration(&johnson, force);
    made->johnson_tangent = force_law_tangent(&johnson, made->johnson_approach);
    made->half_angle = half_angle(pair, force);
    return true;
}

static bool fill_laws(const ContactPair *pair, double force, PhysicalLaw laws[PHYSICAL_LAW_COUNT],
                      Err *err)
{
    for (int i = 0; i < PHYSICAL_LAW_COUNT; i++) {
        const LawKind kind = (LawKind)(LAW_AUTO + 1 + i);
        ForceLaw law;
        if (!law_make(kind, pair, &law, err)) {
            return false;
        }
        const double approach = force_law_penetration(&law, force);
        laws[i] = (PhysicalLaw){
            .name = OPTIONS_LAWS[kind],
            .approach = approach,
            .tangent = force_law_tangent(&law, approach),
        };
    }
    return true;
}

bool physical_compute(const Scenario *fourbar, Physical *physical, Err *err)
{
    double rpm[PRINTED_SPEED_COUNT];
    double forces[PRINTED_SPEED_COUNT][PRINTED_PIN_COUNT];
    for (int row = 0; row < PRINTED_SPEED_COUNT; row++) {
        rpm[row] = printed_speed_rpm(row);
    }
    if (!largest_forces(fourbar, PRINTED_SPEED_COUNT, rpm, forces, err)) {
        return false;
    }
    Physical made = {0};
    const ContactPair pair = paper_pair(&fourbar->material);
    for (int row = 0; row < PRINTED_SPEED_COUNT; row++) {
        for (int pin = 0; pin < PRINTED_PIN_COUNT; pin++) {
            made.pins[row][pin] = (PhysicalPin){.name = PRINTED_PIN_NAMES[pin], .rpm = rpm[row]};
            if (!fill_pin(&pair, forces[row][pin], &made.pins[row][pin], err)) {
                return false;
            }
        }
    }
    made.estimated_force = pair.reference_force;
    made.real_force = forces[PHYSICAL_BASE_ROW][PRINTED_CRANK_COUPLER];
    if (!fill_laws(&pair, made.estimated_force, made.estimated, err) ||
        !fill_laws(&pair, made.real_force, made.real, err)) {
        return false;
    }
    *physical = made;
    return true;
}

static bool compute_physical(Physical *physical, Err *err)
{
    Scenario nominal;
    if (!embedded_load(EMBEDDED_IDEAL_NOMINAL, &nominal, err)) {
        return false;
    }
    const bool is_computed = physical_compute(&nominal, physical, err);
    scenario_free(&nominal);
    return is_computed;
}

// What is made at the same time.
enum { PIECE_LONGEST, PIECE_OTHERS, PIECE_COUNT };

typedef struct Making {
    PaperResult made;
    RunWatch watch;
    Err errors[PIECE_COUNT];
    bool is_made[PIECE_COUNT];
} Making;

static void make_piece(size_t index, bool is_callers, void *context)
{
    (void)is_callers;
    Making *making = context;
    PaperResult *made = &making->made;
    Err *err = &making->errors[index];
    making->is_made[index] =
        index == PIECE_LONGEST
            ? extremes_longest(making->watch, &made->extremes[PRINTED_POISSON], err)
            : compute_physical(&made->physical, err) && extremes_others(made->extremes, err);
}

bool paper_compute(PaperResult *result, RunWatch watch, Err *err)
{
    Making making = {.made = {.inputs = estimate_inputs_printed()}, .watch = watch};
    PaperResult *made = &making.made;
    // what takes longest goes first, and is the caller's
    side_by_side_run(PIECE_COUNT, side_by_side_processors(), make_piece, &making);
    for (int i = 0; i < PIECE_COUNT; i++) {
        if (!making.is_made[i]) {
            *err = making.errors[i];
            return false;
        }
    }
    estimate_compute(&made->inputs, made->tables);
    for (int i = 0; i < PRINTED_TABLE_COUNT; i++) {
        made->cell_count += made->tables[i].cell_count;
        made->as_printed += made->tables[i].as_printed;
    }
    made->ideal_difference_max = extremes_difference_max(made->extremes);
    made->ideal_as_printed = extremes_as_printed(made->extremes, &made->ideal_cell_count);
    *result = *made;
    return true;
}

bool paper_check(const PaperResult *result, Err *err)
{
    // the printed digits of the ideal rows are good to 1e-4; the combination of lengths behind the
    // stack-up row, which the paper does not name, fits them to 2.1e-4, the next best to 1e-3
    const double ideal_limit = 3e-4;
    if (result->as_printed != result->cell_count) {
        return err_set(err, ERR_DIFFERS, "only %d of %d cells of Tables I to III are as printed",
                       result->as_printed, result->cell_count);
    }
    if (!(result->ideal_difference_max <= ideal_limit)) {
        return err_set(err, ERR_DIFFERS,
                       "the ideal rows of Tables VII and VIII differ by %.2g, more than %.2g",
                       result->ideal_difference_max, ideal_limit);
    }
    return true;
}

// Where the paper does not mean what it prints.
//
// Each reading was found by recomputing the paper's own numbers; what stayed a guess says so.

const Typo TYPOS[] = {
    {TYPO_TABLES_7_8, "Table V", "input speed 1000 rad/sec",
     "1000 rpm = 104.7198 rad/s, crank turning clockwise",
     "the ideal rows of Tables VII and VIII come out so; clockwise the signs of omega change, "
     "those "
     "of alpha do not"},
    {TYPO_TABLES_7_8, "Table VI", "moments of inertia in mm^4",
     "kg mm^2, about the link's centre of mass, which sits at mid-link",
     "as kg mm^2 they have the size of m l^2 / 12 of each link"},
    {TYPO_TABLE_2, "section IV.A", "maximum clearance 42 micron",
     "Table IV gives 10.015 - 9.986 = 0.029 mm in diameter, 14.5 micron in radius",
     "Table II needs 0.042 mm; contact runs here use 14.5 micron"},
    {TYPO_TABLE_2, "Eq. (9)", "force exponent e = 1.5", "e = 1",
     "every cell of Table II comes out with 1; with 1.5 each is 4.9 times smaller"},
    {TYPO_TABLES_7_8, "Table VIII", "POISSON, coupler, maximum 74069000", "most likely 7406900",
     "a guess: its neighbours are 7.1e6 to 1.0e7; never a target"},
    {TYPO_TABLES_7_8, "section IV.B", "16.72 % variation in angular acceleration of coupler",
     "in angular velocity of the follower", "94.018 / 80.553 is 1.1672"},
    {TYPO_TABLE_3, "section V", "mutual approach 0.02 micron at 100 rpm, 0.4 micron at 1500 rpm",
     "0.0090 and 0.333 micron", "its own Table III"},
    {TYPO_MODEL, "section IV.A", "material in Table IV, linkage in Table V, tolerances in Table VI",
     "Tables V, VI and IV", "the tables' own headings"},
    {TYPO_MODEL, "Eq. (6)", "D = 3 K (1 - e^2) delta_n / (4 delta)",
     "Lankarani and Nikravesh: F = K d^n (1 + 3 (1 - e^2) / 4 d' / d'_0)",
     "the printed form lacks d^n and the initial impact speed"},
    {TYPO_MODEL, "Eq. (3)", "two spheres", "a sphere in a spherical socket",
     "the minus sign in R1 R2 / (R1 - R2)"},
    {TYPO_TABLE_3, "Eq. (8)", "mutual approach with a zero-load radius a0", "a0 = 0",
     "a0 belongs to adhesive contact; Table III needs no such term, but has the 3/4 of Hertz's law "
     "outside the power 2/3, which makes it 9 % low"},
};

const size_t TYPOS_COUNT = sizeof TYPOS / sizeof *TYPOS;
