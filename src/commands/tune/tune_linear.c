// Reduces a joint to the constant spring, damper and limits that Gazebo and MuJoCo have.
//
// secant spring        kp = F(d*) / d*             at a share d* of the deepest penetration
// equivalent damper    kd = 2 zeta sqrt(kp m)      zeta from the restitution e that the law
// delivers:
//                      e = exp(-2 zeta acos(zeta) / sqrt(1 - zeta^2)), force clamped at 0
// d penetration, m; F elastic force, N; m effective mass along the normal, kg.
// What comes of it is not derived but run, against the truth of the law itself.
#include "commands/tune/tune_linear.h"
#include "commands/tune/tune_runs.h"
#include "contact/damping.h"
#include "contact/law.h"
#include "contact/map_impact.h"
#include "contact/touch.h"
#include "model/coordinate.h"
#include "model/response.h"
#include "model/space.h"
#include "write/number.h"
#include "write/units.h"
#include "write/xml.h"

#include <assert.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

// A joint with stops or backlash in Gazebo and MuJoCo.
//
// Both have limits of a joint, counted from where its bodies stand at the start. Gazebo classic
// reads `stiffness` and `dissipation` of a limit for Simbody; with ODE it hands cfm and erp of
// physics/ode/limit to dParamStopCFM and dParamStopERP (ODEJoint::Load), the row of a stop:
//     erp = h k / (h k + c),  cfm = 1 / (h k + c)
// The row of a limit of MuJoCo is that of a contact (tune_export.c), where A is the joint's
// dof_invweight0: the mobility of its coordinate, of a tree of joints at qpos0.

// where there is no stop: MuJoCo's range has two ends, and nothing gets that far
static const double FAR = 1e10;

// Whether a case has that one joint with play and no other; its number.
static bool tune_limit_alone(const Linkage *linkage, size_t *joint)
{
    size_t count = 0;
    for (size_t i = 0; i < linkage->joint_count; i++) {
        if (linkage_has_play(&linkage->joints[i])) {
            *joint = i;
            count++;
        }
    }
    return count == 1 && joint_is_ideal(linkage->joints[*joint].kind);
}

// Of the coordinate as the bodies stand at the start.
typedef struct Ends {
    double low;
    double high;
} Ends;

static Ends tune_linear_range_of(const Linkage *linkage, size_t number)
{
    const Joint *joint = &linkage->joints[number];
    Motion *motions = calloc(linkage->body_count + 1, sizeof *motions);
    assert(motions != NULL);
    linkage_start(linkage, motions);
    const double start = coordinate_position(linkage, motions, (int)number);
    free(motions);
    return (Ends){coordinate_low(joint) - start, coordinate_high(joint) - start};
}

// Why no limit can be written, as a sentence without a full stop; NULL where one can be.
static const char *tune_limit_lacks(const Scenario *scenario, size_t number)
{
    const Joint *joint = &scenario->linkage.joints[number];
    const Ends range = tune_linear_range_of(&scenario->linkage, number);
    ForceLaw law;
    Err ignored = {ERR_NONE, ""};
    if (!law_of_joint(scenario, joint, &law, &ignored) || law.family != FORCE_LAW_POWER ||
        law.exponent != 1.0) {
        return "limits of Gazebo and MuJoCo have a linear spring, and this joint's has another "
               "exponent";
    }
    const bool is_beyond =
        (isfinite(range.low) && range.low < -M_PI) || (isfinite(range.high) && range.high > M_PI);
    return joint_has_angle(joint->kind) && is_beyond
               ? "ODE's hinge has its stops within half a turn of where it starts"
               : NULL;
}

const char *tune_limit_lacks_range(const Scenario *scenario, size_t number)
{
    const Ends range = tune_linear_range_of(&scenario->linkage, number);
    return range.low < range.high
               ? NULL
               : "MuJoCo has no range of length 0, which backlash of 0 would be: give the joint a "
                 "spring there";
}

// The mass or inertia, kg or kg m^2, with which the linkage meets a push along that coordinate;
// NAN where the ideal joints are redundant.
static double tune_limit_mass(const Scenario *scenario, const Motion *motions)
{
    Touch *places;
    size_t count;
    Response response;
    Err ignored = {ERR_NONE, ""};
    double mass = NAN;
    if (!touch_list(scenario, &places, &count, &ignored)) {
        return mass;
    }
    touch_response(&scenario->linkage, places, count, false, &response);
    if (response_place(&response, motions)) {
        mass = response_mass(&response, response_first_row(&response, 0), (Vec2){1.0, 0.0});
    }
    response_finish(&response);
    free(places);
    return mass;
}

// The joint of the report, and its constants.
typedef struct Limited {
    const Linkage *linkage;
    const Joint *joint;
    const JointUnits *units;
    const TuneLinear *linear;
    Ends range;
    int bodies[2]; // the one that its coordinate moves, and the other
} Limited;

static Limited limited_of(const TuneReport *report)
{
    const Tune *tune = report->tune;
    const size_t number = tune->contact.joint;
    Limited made = {
        .linkage = &report->scenario->linkage,
        .joint = &report->scenario->linkage.joints[number],
        .units = joint_units(&report->scenario->linkage.joints[number]),
        .linear = &tune->linears[tune->linear],
        .range = tune_linear_range_of(&report->scenario->linkage, number),
    };
    linkage_turning(made.linkage, (int)number, &made.bodies[0], &made.bodies[1]);
    return made;
}

static void tune_linear_write_body(const Linkage *linkage, const char *tag, int body, Text *text)
{
    text_append(text, "  <%s>", tag);
    xml_append(body == LINKAGE_GROUND ? "world" : linkage->bodies[body].name, text);
    text_append(text, "</%s>\n", tag);
}

// In the world as the bodies stand at the start.
static Vec2 tune_linear_axis_of(const Limited *limited, size_t number)
{
    Motion *motions = calloc(limited->linkage->body_count + 1, sizeof *motions);
    assert(motions != NULL);
    linkage_start(limited->linkage, motions);
    const Vec2 along = joint_rows_along(limited->linkage, motions, (int)number);
    free(motions);
    return vec2_scale(coordinate_sense(limited->joint), along);
}

static void write_axis(const Limited *limited, size_t number, Text *text)
{
    const Vec2 along = joint_has_position(limited->joint->kind)
                           ? tune_linear_axis_of(limited, number)
                           : (Vec2){0.0, 0.0};
    text_append(text, "%s %s %d", number_shortest(along.x).text, number_shortest(along.y).text,
                joint_has_position(limited->joint->kind) ? 0 : 1);
}

void tune_limit_sdf(const TuneReport *report, ErpCfm row, Text *text)
{
    const Limited limited = limited_of(report);
    text_append(text, "<joint name=\"");
    xml_append(limited.joint->name, text);
    text_append(text, "\" type=\"%s\">\n",
                joint_has_position(limited.joint->kind) ? "prismatic" : "revolute");
    tune_linear_write_body(limited.linkage, "parent", limited.bodies[1], text);
    tune_linear_write_body(limited.linkage, "child", limited.bodies[0], text);
    text_append(text, "  <axis>\n    <xyz expressed_in=\"__model__\">");
    write_axis(&limited, report->tune->contact.joint, text);
    text_append(text, "</xyz>\n    <limit>\n");
    if (isfinite(limited.range.low)) {
        text_append(text, "      <lower>%s</lower>\n", number_shortest(limited.range.low).text);
    }
    if (isfinite(limited.range.high)) {
        text_append(text, "      <upper>%s</upper>\n", number_shortest(limited.range.high).text);
    }
    text_append(text,
                "      <stiffness>%s</stiffness> <!-- %s; not read with ODE -->\n"
                "      <dissipation>%s</dissipation> <!-- %s; not read with ODE -->\n"
                "    </limit>\n  </axis>\n"
                "  <physics>\n    <ode>\n      <limit>\n"
                "        <cfm>%s</cfm> <!-- of spring and damper at this step -->\n"
                "        <erp>%s</erp>\n"
                "      </limit>\n    </ode>\n  </physics>\n</joint>\n",
                number_shortest(limited.linear->stiffness).text, limited.units->stiffness,
                number_shortest(limited.linear->damping).text, limited.units->damping,
                number_shortest(row.cfm).text, number_shortest(row.erp).text);
}

static const char *tune_linear_end_of(double value, NumberText *shortest)
{
    *shortest = number_shortest(isfinite(value) ? value : copysign(FAR, value));
    return shortest->text;
}

void tune_limit_mjcf(const TuneReport *report, const double solref[2], double impedance, Text *text)
{
    const Limited limited = limited_of(report);
    NumberText low;
    NumberText high;
    text_append(text, "<joint name=\"");
    xml_append(limited.joint->name, text);
    text_append(text, "\" type=\"%s\" axis=\"",
                joint_has_position(limited.joint->kind) ? "slide" : "hinge");
    write_axis(&limited, report->tune->contact.joint, text);
    text_append(text,
                "\" limited=\"true\" margin=\"0\"\n"
                "       range=\"%s %s\"\n"
                "       solreflimit=\"%s %s\"\n"
                "       solimplimit=\"%s %s 1 0.5 1\"/>\n",
                tune_linear_end_of(limited.range.low, &low),
                tune_linear_end_of(limited.range.high, &high), number_shortest(solref[0]).text,
                number_shortest(solref[1]).text, number_shortest(impedance).text,
                number_shortest(impedance).text);
}

// of the deepest penetration: a resting contact stays at the shallow end
static const double SHARES[] = {1.0, 0.5, 0.25};
// s; the first is Gazebo's default
static const double STEPS[] = {1e-3, 1e-4, 1e-5, 1e-6};

enum {
    SHARE_COUNT = sizeof SHARES / sizeof SHARES[0],
    STEP_COUNT = sizeof STEPS / sizeof STEPS[0],
};

// a step that comes as close to the least error as this is as good as the finest
static const double AS_GOOD = 1.2;

double tune_linear_damping(double stiffness, double mass, double restitution)
{
    return 2.0 * damping_linear_ratio(restitution) * sqrt(stiffness * mass);
}

Scenario tune_linear_scenario(const Scenario *scenario, const TuneLinear *linear)
{
    Scenario changed = *scenario;
    if (linear->is_row) {
        const ConstantsSetting setting = {.map = ODE_MAP_CORRECTED,
                                          .row = linear->row,
                                          .stiffness = linear->stiffness,
                                          .damping = linear->damping};
        constants_apply(&setting, &changed);
    } else {
        scenario_set_stiffness(&changed, linear->stiffness, 1.0);
        changed.contact.damping = DAMPING_VISCOUS;
        changed.contact.is_damping_for_all = true;
        changed.contact.viscous_coefficient = linear->damping;
    }
    changed.run.step = linear->step_s;
    changed.ode.solver = ODE_DIRECT;
    changed.ode.stepping = ODE_PLAIN;
    changed.ode.map = ODE_MAP_TEXTBOOK;
    return changed;
}

// The sample nearest to a time.
static size_t sample_near(const Trajectory *trajectory, double time_s)
{
    size_t nearest = 0;
    for (size_t k = 1; k < trajectory->sample_count; k++) {
        if (fabs(trajectory->times[k] - time_s) < fabs(trajectory->times[nearest] - time_s)) {
            nearest = k;
        }
    }
    return nearest;
}

static double tune_linear_find_mass(const Linkage *linkage, const Trajectory *trajectory,
                                    size_t joint, double time_s)
{
    Response response;
    double mass = NAN;
    const size_t sample = sample_near(trajectory, time_s);
    const Motion *motions = trajectory_motion(trajectory, sample, 0);
    if (!space_has_plane(linkage)) {
        return NAN;
    }
    const Vec2 offset = trajectory_state(trajectory, sample, joint)->eccentricity;
    const double length = vec2_length(offset);
    response_init(linkage, false, &response);
    const bool is_known = length > 0.0 && response_place(&response, motions);
    for (size_t row = 0; is_known && row < response_play_rows(&response); row += 2) {
        if (response_joint(&response, row) == (int)joint) {
            mass = response_mass(&response, row, vec2_scale(-1.0 / length, offset));
        }
    }
    response_finish(&response);
    return mass;
}

// The pin that goes deepest.
static void find_pin(const Scenario *scenario, const Trajectory *truth, TuneContact *contact)
{
    const Linkage *linkage = &scenario->linkage;
    for (size_t i = 0; i < linkage->joint_count; i++) {
        const JointExtremes *joint = &truth->joints[i];
        if (!joint_has_hole(linkage->joints[i].kind) ||
            !(joint->penetration_max.value > contact->depth)) {
            continue;
        }
        *contact = (TuneContact){
            .is_known = true,
            .joint = i,
            .depth = joint->penetration_max.value,
            .speed = joint->spike_count > 0 ? joint->spikes[0].approach_speed : 0.0,
            .mass = tune_linear_find_mass(linkage, truth, i, joint->penetration_max.time_s),
        };
    }
}

// The one joint with stops or backlash.
static void tune_linear_find_limit(const Scenario *scenario, const Trajectory *truth,
                                   TuneContact *contact)
{
    size_t number;
    if (!tune_limit_alone(&scenario->linkage, &number) ||
        tune_limit_lacks(scenario, number) != NULL) {
        return;
    }
    const JointExtremes *joint = &truth->joints[number];
    const size_t sample = sample_near(truth, joint->penetration_max.time_s);
    *contact = (TuneContact){
        .is_known = joint->penetration_max.value > 0.0,
        .is_limit = true,
        .joint = number,
        .depth = joint->penetration_max.value,
        .speed = joint->spike_count > 0 ? joint->spikes[0].approach_speed : 0.0,
        .mass = tune_limit_mass(scenario, trajectory_motion(truth, sample, 0)),
    };
}

static void tune_linear_find_contact(const Scenario *scenario, const Trajectory *truth,
                                     TuneContact *contact)
{
    *contact = (TuneContact){.is_known = false};
    find_pin(scenario, truth, contact);
    if (!contact->is_known) {
        tune_linear_find_limit(scenario, truth, contact);
    }
    contact->is_known = contact->is_known && isfinite(contact->mass);
}

const char *tune_linear_lacks_case(const Scenario *scenario)
{
    size_t number = 0;
    bool has_pin = false;
    for (size_t i = 0; i < scenario->linkage.joint_count; i++) {
        has_pin = has_pin || joint_has_hole(scenario->linkage.joints[i].kind);
    }
    if (!scenario_has_clearance(scenario)) {
        return "no joint of the case has play";
    }
    if (!space_has_plane(&scenario->linkage)) {
        return "Gazebo and MuJoCo get constants of joints whose axes stand upright alone";
    }
    const bool is_alone = tune_limit_alone(&scenario->linkage, &number);
    if (!has_pin && !is_alone) {
        return "Gazebo and MuJoCo get constants of pins in holes, or of the stops or backlash of "
               "one pivot or slider that alone has play";
    }
    return is_alone ? tune_limit_lacks(scenario, number) : NULL;
}

const char *tune_linear_lacks_range(const Scenario *scenario)
{
    size_t number = 0;
    const char *lacks = tune_linear_lacks_case(scenario);
    return lacks != NULL || !tune_limit_alone(&scenario->linkage, &number)
               ? lacks
               : tune_limit_lacks_range(scenario, number);
}

const char *tune_linear_lacks(const Scenario *scenario, const Tune *tune)
{
    const char *lacks = tune_linear_lacks_case(scenario);
    return lacks != NULL            ? lacks
           : tune->contact.is_known ? tune->contact.unstable
                                    : "nothing touches in a joint with play";
}

static void add_linear(Tune *tune, double depth, double stiffness, double damping, double step_s)
{
    const double sum = step_s * stiffness + damping;
    tune->linears[tune->linear_count++] = (TuneLinear){
        .row = {.erp = step_s * stiffness / sum, .cfm = 1.0 / sum},
        .depth = depth,
        .stiffness = stiffness,
        .damping = damping,
        .step_s = step_s,
    };
}

// The restitution that a law delivers in an impact, 1; NAN of a viscous damper, which stays what it
// is, and where the pin is not let go.
static double tune_linear_restitution(const ForceLaw *law, const TuneContact *contact)
{
    if (!(law->viscous > 0.0)) {
        return law_restitution(law, contact->speed);
    }
    const MapImpactCase impact = {.law = *law, .mass = contact->mass, .speed = contact->speed};
    const MapImpact made =
        law->full_damping_depth > 0.0 ? map_impact_law(&impact) : (MapImpact){.is_ended = false};
    return made.is_ended && made.restitution > 0.0 ? made.restitution : NAN;
}

// Lists the constants to run: a law that is linear already has one spring.
static void list_linears(const TuneSearch *search, const ForceLaw *law, Tune *tune)
{
    const Scenario *scenario = search->scenario;
    TuneContact *contact = &tune->contact;
    const bool is_linear = law->family == FORCE_LAW_POWER && law->exponent == 1.0;
    contact->restitution = tune_linear_restitution(law, contact);
    for (size_t i = 0; i < (is_linear ? 1 : SHARE_COUNT); i++) {
        const double depth = SHARES[i] * contact->depth;
        const double stiffness = force_law_secant(law, depth);
        const double damping =
            isnan(contact->restitution)
                ? law->viscous
                : tune_linear_damping(stiffness, contact->mass, contact->restitution);
        if (tune->held_s > 0.0) {
            add_linear(tune, depth, stiffness, damping, tune->held_s);
            continue;
        }
        for (size_t k = 0; k < STEP_COUNT; k++) {
            if (STEPS[k] < 0.1 * scenario_duration(scenario)) {
                add_linear(tune, depth, stiffness, damping, STEPS[k]);
            }
        }
    }
}

// The coarsest step that meets the target, or that is as good as any.
static int choose_linear(const Tune *tune)
{
    double least = INFINITY;
    for (size_t i = 0; i < tune->linear_count; i++) {
        least = fmin(least, tune->linears[i].error); // fmin passes over NAN
    }
    const double enough = fmax(AS_GOOD * least, tune->target - tune->truth.uncertainty);
    int chosen = TUNE_NONE;
    for (size_t i = 0; i < tune->linear_count; i++) {
        const TuneLinear *linear = &tune->linears[i];
        const TuneLinear *best = chosen == TUNE_NONE ? NULL : &tune->linears[chosen];
        if (!linear->is_row && linear->error <= enough &&
            (best == NULL || linear->step_s > best->step_s ||
             (linear->step_s == best->step_s && linear->error < best->error))) {
            chosen = (int)i;
        }
    }
    return chosen;
}

// At a step that is held: the least error, of kp and kd alone or of any ERP and CFM.
static int choose_least(const Tune *tune, bool with_rows)
{
    int chosen = TUNE_NONE;
    for (size_t i = 0; i < tune->linear_count; i++) {
        const TuneLinear *linear = &tune->linears[i];
        if (isfinite(linear->error) && (with_rows || !linear->is_row) &&
            (chosen == TUNE_NONE || linear->error < tune->linears[chosen].error)) {
            chosen = (int)i;
        }
    }
    return chosen;
}

static void apply_linear(void *tune, size_t number, Scenario *scenario)
{
    *scenario = tune_linear_scenario(scenario, &((const Tune *)tune)->linears[number]);
}

static void take_linear(void *tune, size_t number, const LadderRun *run)
{
    TuneLinear *linear = &((Tune *)tune)->linears[number];
    linear->run = *run;
    linear->error = tune_error(tune, run, linear->reason);
}

// What is said where none is stable. The step at which one would be is not known: between 1 and 20
// times sqrt(m / k) was measured. That of the softest is named where it was not tried.
static void say_unstable(Tune *tune)
{
    TuneContact *contact = &tune->contact;
    double softest = INFINITY;
    double shortest = INFINITY;
    for (size_t i = 0; i < tune->linear_count; i++) {
        softest = fmin(softest, tune->linears[i].stiffness);
        shortest = fmin(shortest, tune->linears[i].step_s);
    }
    const double step_s = sqrt(contact->mass / softest);
    const int length = snprintf(contact->unstable, sizeof contact->unstable,
                                "no contact with constants that was tried is stable");
    if (step_s > 0.0 && step_s < shortest) {
        snprintf(contact->unstable + length, sizeof contact->unstable - (size_t)length,
                 "; try --at-step %.2gus or less, sqrt(mass / kp) of the softest",
                 step_s * UNITS_US);
    }
}

bool tune_linear_run(const TuneSearch *search, Err *err)
{
    Tune *tune = search->tune;
    ForceLaw law;
    tune_linear_find_contact(search->scenario, search->truth->trajectory, &tune->contact);
    if (!tune->contact.is_known) {
        return true;
    }
    const Joint *joint = &search->scenario->linkage.joints[tune->contact.joint];
    if (!law_of_joint(search->scenario, joint, &law, err)) {
        return false;
    }
    const bool is_held = tune->held_s > 0.0;
    list_linears(search, &law, tune);
    say_unstable(tune);
    if (is_held && !tune->contact.is_limit && !tune_held_constants(search, err)) {
        return false;
    }
    const TuneRuns runs = {"running a linear contact", tune->linear_count, apply_linear,
                           take_linear, .owner = tune};
    if (!tune_runs_make(search, &runs, err)) {
        return false;
    }
    tune->linear = is_held ? choose_least(tune, false) : choose_linear(tune);
    tune->row = is_held ? choose_least(tune, true) : TUNE_NONE;
    return true;
}
