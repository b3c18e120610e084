// Runs a case with other inputs and other assumptions, and sums up what they do to its forces.
//
// A draw is the case read once more with other numbers, so that all that follows from them is
// theirs. It starts in the case's settled motion, moved as little as its numbers need
// (run/settle_follow.c), and is turned until it repeats; from the start as written where that is no
// start of it, or comes to nothing.
#include "run/spread.h"

#include "base/clock.h"
#include "base/side_by_side.h"
#include "base/zeroed.h"
#include "contact/law.h"
#include "run/settle_parts.h"

#include <assert.h>
#include <math.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

const char *const SPREAD_FORM_KINDS[] = {"laws", "damping", "resting speed", "friction"};

// Of the reference: its peaks are off by less than a thousandth, and the range has two digits.
static const double DRAW_REFERENCE = 1e-6;

// 1: what may still be to come of forces of which three digits are shown; and where the case itself
// does not repeat, for chance brings such a motion as near as that to an earlier revolution
static const double DRAW_REPEATS = 2e-4;
static const double RANDOM_REPEATS = 2e-5;

enum {
    TURNS_MOST = 32,  // revolutions of a draw: what has not repeated by then does not
    MOTIONS_MOST = 4, // that draws start from: those of most starts
    NARROWINGS = 4,   // of where a touch begins: to a sixteenth
    FORMS_MOST = LAW_COUNT + 6,
};

// 1: of an input to either side: touches are looked for that far away, or to its limits
static const double TOUCH_SHARE = 0.01;

// 1: of impacts in a revolution, another number of them
static const double OTHER_IMPACTS = 0.05;

// 1: a force that changes by so much where a touch begins is not firm, and how much of that change
// lies in the last sixteenth of the way, where it is a jump
static const double JUMP_LEAST = 0.01;
static const double JUMP_SHARE = 0.25;

static const double FRICTION_MOST = 0.15; // 1, of steel on steel without much oil
static const double RESTING_TIMES = 3.0;  // by which the resting speed is changed to either side

SpreadOptions spread_options_default(void)
{
    return (SpreadOptions){.draws = SPREAD_DRAWS, .has_forms = true};
}

bool spread_is_of(const Scenario *scenario)
{
    return scenario->settled.motion_count > 0 && !scenario->settled.is_pressed &&
           scenario->settled.motions[0].joints != NULL && scenario_has_clearance(scenario);
}

// The work: pieces are pairs of a run and a motion that it starts from.
typedef struct Work {
    const SpreadCase *of;
    const Scenario *scenario; // settled
    Scenario written;         // the case as it is written; owned
    SpreadInputs *inputs;
    size_t motion_count;
    SpreadRun **runs; // owned, the list
    size_t run_count;
    double repeats; // 1: what may still be to come of a motion that repeats
    double began_s;
    double budget_s;
    TurnWatch watch;
} Work;

static bool is_over_budget(const Work *work)
{
    return work->budget_s > 0.0 && clock_processor_s() - work->began_s > work->budget_s;
}

// Reading the case with a run's numbers.

static void append_value(const SpreadInput *input, double value, Text *text)
{
    const bool is_vector = input->item_count > 1;
    text_append(text, "%s=%s", input->key, is_vector ? "[" : "");
    for (size_t i = 0; i < input->item_count; i++) {
        const bool is_it = i == input->item;
        text_append(text, "%s%.17g%s%s", i > 0 ? ", " : "", is_it ? value : input->items[i],
                    (is_it ? input->unit : input->item_unit)[0] != '\0' ? " " : "",
                    is_it ? input->unit : input->item_unit);
    }
    text_append(text, "%s", is_vector ? "]" : "");
}

// Another input of the same vector, whose number goes into this one's list.
static bool is_same_vector(const SpreadInput *a, const SpreadInput *b)
{
    return a->item_count > 1 && strcmp(a->key, b->key) == 0;
}

// The settings of a run beyond those of the command line; returns how many.
static size_t add_settings(const Work *work, const SpreadRun *run, Text *texts)
{
    size_t count = 0;
    for (size_t i = 0; run->values != NULL && i < work->inputs->count; i++) {
        SpreadInput input = work->inputs->inputs[i];
        bool is_first = true;
        for (size_t k = 0; k < work->inputs->count; k++) {
            const SpreadInput *other = &work->inputs->inputs[k];
            if (k != i && is_same_vector(&input, other)) {
                // numbers of one vector share their unit in a case: the first has all of them
                is_first = is_first && k > i;
                const double per_unit =
                    other->nominal != 0.0 ? other->items[other->item] / other->nominal : 1.0;
                input.items[other->item] = run->values[k] * per_unit;
            }
        }
        if (is_first) {
            text_init(&texts[count]);
            append_value(&input, run->values[i], &texts[count++]);
        }
    }
    if (run->key[0] != '\0') {
        text_init(&texts[count]);
        text_append(&texts[count++], "%s=%s", run->key, run->value);
    }
    return count;
}

// The scenario of a run, not settled. Fails where its numbers make no case.
static bool read_run(const Work *work, const SpreadRun *run, Scenario *scenario, Err *err)
{
    const SpreadCase *of = work->of;
    const size_t most = of->override_count + work->inputs->count + 1;
    const char **overrides = zeroed(most, sizeof *overrides);
    Text *texts = zeroed(work->inputs->count + 1, sizeof *texts);
    const size_t added = add_settings(work, run, texts);
    for (size_t i = 0; i < of->override_count; i++) {
        overrides[i] = of->overrides[i];
    }
    for (size_t i = 0; i < added; i++) {
        overrides[of->override_count + i] = texts[i].data;
    }
    const bool is_read = casefile_load_text(of->name, of->text, of->size, overrides,
                                            of->override_count + added, scenario, err);
    for (size_t i = 0; i < added; i++) {
        text_finish(&texts[i]);
    }
    free(texts);
    free(overrides);
    return is_read;
}

// One start.

// Turns it until it repeats or has been turned for long enough. False where it cannot be turned; it
// is not done where the budget ends.
static bool turn(Work *work, Settling *settling, bool is_callers, bool *is_done)
{
    Err unused = {ERR_NONE, ""};
    settling->watch = &work->watch;
    settling->is_callers = is_callers;
    *is_done = false;
    while (settling->count < TURNS_MOST && settling->period == 0) {
        if (is_over_budget(work)) {
            return true;
        }
        if (!settling_turn(settling, &unused)) {
            return false;
        }
        settling_repeats(settling, work->repeats);
    }
    *is_done = true;
    return true;
}

static void take_answer(const Settling *settling, SpreadAnswer *answer)
{
    const size_t joints = settling->scenario.linkage.joint_count;
    SettledMotion motion = settle_motion_of(&settling, 1, 1);
    answer->is_there = true;
    answer->period = motion.period;
    answer->forces = zeroed(joints, sizeof *answer->forces);
    answer->impacts = zeroed(joints, sizeof *answer->impacts);
    for (size_t i = 0; i < joints; i++) {
        answer->forces[i] = motion.joints[i].force.headline;
        answer->impacts[i] = motion.joints[i].impacts.mean;
    }
    settled_motion_free(&motion);
}

// From the start that a scenario has.
static bool answer_from(Work *work, const Scenario *scenario, bool is_callers, SpreadAnswer *answer)
{
    Settling settling = settling_start(scenario);
    ReferenceOptions *reference = &settling.scenario.reference;
    reference->tolerance = fmax(reference->tolerance, DRAW_REFERENCE);
    bool is_done;
    const bool is_turned = turn(work, &settling, is_callers, &is_done);
    if (is_turned && is_done) {
        take_answer(&settling, answer);
    }
    answer->is_made = !is_turned || is_done;
    settling_finish(&settling);
    return is_turned;
}

// The linkage where a motion of the case starts.
static const Linkage *motion_start(const Work *work, size_t motion)
{
    return motion == 0 ? &work->scenario->linkage : &work->scenario->settled.others[motion - 1];
}

static void run_piece(size_t index, bool is_callers, void *context)
{
    Work *work = context;
    SpreadRun *run = work->runs[index / work->motion_count];
    const size_t motion = index % work->motion_count;
    SpreadAnswer *answer = &run->answers[motion];
    Scenario drawn;
    if (is_over_budget(work)) {
        return;
    }
    Err err = {ERR_NONE, ""};
    if (!read_run(work, run, &drawn, &err)) {
        answer->is_made = true;
        // the same from every motion: one of them says it
        if (motion == 0) {
            text_copy(run->why, sizeof run->why, err.text);
        }
        return;
    }
    drawn.contact.damping_scale *= run->damping_scale;
    Scenario lent = scenario_copy(&drawn);
    const bool has_start = settle_lend(&work->written.linkage, motion_start(work, motion), &lent);
    if (scenario_settling_period(&drawn) > 0.0 &&
        !(has_start && answer_from(work, &lent, is_callers, answer))) {
        answer_from(work, &drawn, is_callers, answer);
    }
    scenario_free(&lent);
    scenario_free(&drawn);
}

// Makes runs side by side.
static void make_runs(Work *work, SpreadRun **runs, size_t count)
{
    work->runs = runs;
    work->run_count = count;
    side_by_side_run(count * work->motion_count, side_by_side_processors(), run_piece, work);
}

static void run_init(const Work *work, SpreadRun *run)
{
    *run = (SpreadRun){.damping_scale = 1.0};
    run->answers = zeroed(work->motion_count, sizeof *run->answers);
}

static void run_free(SpreadRun *run, size_t motion_count)
{
    for (size_t i = 0; i < motion_count && run->answers != NULL; i++) {
        free(run->answers[i].forces);
        free(run->answers[i].impacts);
    }
    free(run->answers);
    free(run->values);
}

// Whether the budget left a run undone, and whether it came to anything from any motion.
static bool is_undone(const SpreadRun *run, size_t motion_count)
{
    bool is_any = false;
    for (size_t i = 0; i < motion_count; i++) {
        is_any = is_any || !run->answers[i].is_made;
    }
    return is_any;
}

static bool has_answer(const SpreadRun *run, size_t motion_count)
{
    bool has = false;
    for (size_t i = 0; i < motion_count; i++) {
        has = has || run->answers[i].is_there;
    }
    return has;
}

// The assumptions of form.

static SpreadRun *add_form(const Work *work, Spread *spread, SpreadFormKind kind)
{
    assert(spread->form_count < FORMS_MOST);
    SpreadRun *form = &spread->forms[spread->form_count++];
    run_init(work, form);
    form->kind = kind;
    return form;
}

static void add_setting_form(const Work *work, Spread *spread, SpreadFormKind kind, const char *key,
                             const char *value, const char *word)
{
    SpreadRun *form = add_form(work, spread, kind);
    snprintf(form->key, sizeof form->key, "%s", key);
    snprintf(form->value, sizeof form->value, "%s", value);
    snprintf(form->name, sizeof form->name, "%s %s", word, value);
}

// Whether a law is another one that the pins of a case might have: one of cylinders, for pins with
// a width. That a pin is a sphere, or the paper's tables hold, nobody assumes.
static bool is_other_law(const Scenario *scenario, LawKind law)
{
    bool is_other = false;
    for (size_t i = 0; i < scenario->linkage.joint_count; i++) {
        const Joint *joint = &scenario->linkage.joints[i];
        const ContactOptions own = law_options(&scenario->contact, joint);
        if (!joint_has_hole(joint->kind) || own.stiffness > 0.0) {
            continue;
        }
        if (!law_get(law)->needs_width || joint->clearance.width == 0.0) {
            return false;
        }
        is_other = is_other || own.law != law;
    }
    return is_other;
}

// Whether a key of the whole case is made use of and not given: then it is an assumption.
static bool is_assumed(const Scenario *scenario, const char *key)
{
    CasefileSetting setting;
    CasefileWalk walk = casefile_walk(scenario);
    bool applies = false;
    while (casefile_next(&walk, &setting)) {
        applies = applies || (setting.applies && strcmp(setting.key, key) == 0);
    }
    return applies && !casefile_gives(scenario, key);
}

static void add_forms(const Work *work, Spread *spread)
{
    const Scenario *scenario = work->scenario;
    const ContactOptions *contact = &scenario->contact;
    spread->forms = zeroed(FORMS_MOST, sizeof *spread->forms);
    if (contact->model != CONTACT_IMPACT) {
        return;
    }
    static const double SCALES[2] = {0.5, 2.0};
    static const char *const SCALE_NAMES[2] = {"half the damping", "twice the damping"};
    for (int i = 0; i < 2 && law_has_damping(scenario); i++) {
        SpreadRun *form = add_form(work, spread, SPREAD_DAMPING);
        form->damping_scale = SCALES[i];
        snprintf(form->name, sizeof form->name, "%s", SCALE_NAMES[i]);
    }
    for (LawKind law = LAW_AUTO + 1; law < LAW_COUNT && law_is_asked(scenario); law++) {
        if (is_other_law(scenario, law)) {
            add_setting_form(work, spread, SPREAD_LAW, "contact.law", OPTIONS_LAWS[law], "law");
        }
    }
    char value[SPREAD_FORM_SIZE];
    if (is_assumed(scenario, "contact.resting-speed")) {
        for (int i = 0; i < 2; i++) {
            snprintf(value, sizeof value, "%.3g mm/s",
                     1e3 * contact->resting_speed * (i == 0 ? 1.0 / RESTING_TIMES : RESTING_TIMES));
            add_setting_form(work, spread, SPREAD_RESTING_SPEED, "contact.resting-speed", value,
                             "resting speed");
        }
    }
    if (is_assumed(scenario, "contact.friction") && contact->friction == 0.0) {
        for (int i = 1; i <= 2; i++) {
            snprintf(value, sizeof value, "%.3g", 0.5 * i * FRICTION_MOST);
            add_setting_form(work, spread, SPREAD_FRICTION, "contact.friction", value, "friction");
        }
    }
}

static void widen(SpreadRange *range, double value)
{
    range->low = fmin(range->low, value);
    range->high = fmax(range->high, value);
}

static void widen_all(const Spread *spread, const SpreadRun *run, SpreadRange *ranges)
{
    for (size_t m = 0; m < spread->motion_count; m++) {
        for (size_t k = 0; run->answers[m].is_there && k < spread->scenario->linkage.joint_count;
             k++) {
            widen(&ranges[k], run->answers[m].forces[k]);
        }
    }
}

static SpreadRange *spread_ranges_create(size_t count)
{
    SpreadRange *ranges = zeroed(count, sizeof *ranges);
    for (size_t i = 0; i < count; i++) {
        ranges[i] = (SpreadRange){INFINITY, -INFINITY};
    }
    return ranges;
}

static void sum_up_forms(Spread *spread)
{
    const Linkage *linkage = &spread->scenario->linkage;
    spread->form_ranges = spread_ranges_create(linkage->joint_count);
    for (size_t i = 0; i < spread->form_count; i++) {
        if (has_answer(&spread->forms[i], spread->motion_count)) {
            widen_all(spread, &spread->forms[i], spread->form_ranges);
            spread->has_form[spread->forms[i].kind] = true;
        }
    }
    for (size_t k = 0; k < linkage->joint_count; k++) {
        widen(&spread->form_ranges[k],
              spread->scenario->settled.motions[0].joints[k].force.headline);
    }
}

// The draws.

static void add_draws(const Work *work, const SpreadOptions *options, Spread *spread)
{
    spread->draws = zeroed(options->draws, sizeof *spread->draws);
    spread->asked = options->draws;
    for (size_t i = 0; i < options->draws; i++) {
        SpreadRun *draw = &spread->draws[i];
        run_init(work, draw);
        draw->values = zeroed(spread->inputs.count, sizeof *draw->values);
        for (size_t k = 0; k < spread->inputs.count; k++) {
            draw->values[k] = spread_drawn(&spread->inputs.inputs[k], options->first + (unsigned)i);
        }
    }
}

static void sum_up_draws(Spread *spread)
{
    spread->ranges = spread_ranges_create(spread->scenario->linkage.joint_count);
    for (size_t i = 0; i < spread->asked; i++) {
        const SpreadRun *draw = &spread->draws[i];
        if (has_answer(draw, spread->motion_count)) {
            spread->draw_count++;
            widen_all(spread, draw, spread->ranges);
        } else if (!is_undone(draw, spread->motion_count)) {
            spread->without++;
            spread->why_without = spread->why_without == NULL && draw->why[0] != '\0'
                                      ? draw->why
                                      : spread->why_without;
        }
        spread->is_spent = spread->is_spent || is_undone(draw, spread->motion_count);
    }
}

// A number and its rank among others.
typedef struct Ranked {
    double value;
    size_t number;
} Ranked;

static int by_value(const void *a, const void *b)
{
    const double first = ((const Ranked *)a)->value;
    const double second = ((const Ranked *)b)->value;
    return (first > second) - (first < second);
}

// The ranks of some numbers, the mean one of those that are equal.
static void find_ranks(const double *values, size_t count, double *ranks)
{
    Ranked *sorted = zeroed(count, sizeof *sorted);
    for (size_t i = 0; i < count; i++) {
        sorted[i] = (Ranked){values[i], i};
    }
    qsort(sorted, count, sizeof *sorted, by_value);
    for (size_t i = 0; i < count;) {
        size_t end = i + 1;
        while (end < count && sorted[end].value == sorted[i].value) {
            end++;
        }
        for (size_t k = i; k < end; k++) {
            ranks[sorted[k].number] = 0.5 * (double)(i + end - 1);
        }
        i = end;
    }
    free(sorted);
}

// Spearman's correlation of two lists: that of their ranks.
static double rank_correlation(const double *a, const double *b, size_t count)
{
    double *ranks_a = zeroed(count, sizeof *ranks_a);
    double *ranks_b = zeroed(count, sizeof *ranks_b);
    find_ranks(a, count, ranks_a);
    find_ranks(b, count, ranks_b);
    const double mean = 0.5 * ((double)count - 1.0);
    double both = 0.0;
    double own_a = 0.0;
    double own_b = 0.0;
    for (size_t i = 0; i < count; i++) {
        both += (ranks_a[i] - mean) * (ranks_b[i] - mean);
        own_a += (ranks_a[i] - mean) * (ranks_a[i] - mean);
        own_b += (ranks_b[i] - mean) * (ranks_b[i] - mean);
    }
    free(ranks_a);
    free(ranks_b);
    return own_a > 0.0 && own_b > 0.0 ? both / sqrt(own_a * own_b) : NAN;
}

// How each input goes with the force of the loudest joint over the draws from the first motion.
static void correlate(Spread *spread)
{
    double *values = zeroed(spread->asked, sizeof *values);
    double *forces = zeroed(spread->asked, sizeof *forces);
    spread->ranks = zeroed(spread->inputs.count, sizeof *spread->ranks);
    for (size_t k = 0; k < spread->inputs.count; k++) {
        size_t count = 0;
        for (size_t i = 0; i < spread->asked; i++) {
            const SpreadAnswer *answer = &spread->draws[i].answers[0];
            if (answer->is_there) {
                values[count] = spread->draws[i].values[k];
                forces[count++] = answer->forces[spread->joint];
            }
        }
        spread->ranks[k] = count > 2 ? rank_correlation(values, forces, count) : NAN;
    }
    free(values);
    free(forces);
}

// Touches nearby.

// One input changed alone, from the first motion.
typedef struct Probe {
    size_t input;
    double value;
    SpreadRun run;
} Probe;

static void probes_make(Work *work, Probe *probes, size_t count)
{
    SpreadRun **runs = zeroed(count, sizeof *runs);
    const size_t motion_count = work->motion_count;
    work->motion_count = 1;
    for (size_t i = 0; i < count; i++) {
        SpreadRun *run = &probes[i].run;
        run_init(work, run);
        run->values = zeroed(work->inputs->count, sizeof *run->values);
        for (size_t k = 0; k < work->inputs->count; k++) {
            run->values[k] = work->inputs->inputs[k].nominal;
        }
        run->values[probes[i].input] = probes[i].value;
        runs[i] = run;
    }
    make_runs(work, runs, count);
    work->motion_count = motion_count;
    free(runs);
}

// Whether a probe has another number of impacts in any joint than the case.
static bool has_other_impacts(const Spread *spread, const SpreadAnswer *answer)
{
    const Linkage *linkage = &spread->scenario->linkage;
    bool has = false;
    for (size_t i = 0; answer->is_there && i < linkage->joint_count; i++) {
        const double was = spread->scenario->settled.motions[0].joints[i].impacts.mean;
        has = has || fabs(answer->impacts[i] - was) > OTHER_IMPACTS;
    }
    return has;
}

// One end of a part of the way from the case to a probe.
typedef struct TouchEnd {
    double value;
    double force;   // N, of the loudest joint
    double impacts; // a revolution, likewise
} TouchEnd;

static TouchEnd end_of(const Spread *spread, double value, const SpreadAnswer *answer)
{
    return (TouchEnd){value, answer->forces[spread->joint], answer->impacts[spread->joint]};
}

// Narrows the way from the case to a probe with other impacts down to where the force changes most.
// False where it does not jump there.
static bool narrow(Work *work, const Spread *spread, const Probe *probe, SpreadTouch *touch)
{
    const SettledJoint *joint = &spread->scenario->settled.motions[0].joints[spread->joint];
    TouchEnd near = {spread->inputs.inputs[probe->input].nominal, joint->force.headline,
                     joint->impacts.mean};
    TouchEnd far = end_of(spread, probe->value, &probe->run.answers[0]);
    const double whole = fabs(far.force - near.force);
    for (int i = 0; i < NARROWINGS; i++) {
        Probe half = {.input = probe->input, .value = 0.5 * (near.value + far.value)};
        probes_make(work, &half, 1);
        const bool is_there = half.run.answers[0].is_there;
        const TouchEnd middle = is_there ? end_of(spread, half.value, &half.run.answers[0]) : near;
        run_free(&half.run, 1);
        if (!is_there) {
            return false;
        }
        if (fabs(middle.force - near.force) > fabs(far.force - middle.force)) {
            far = middle;
        } else {
            near = middle;
        }
    }
    const double jump = fabs(far.force - near.force);
    *touch = (SpreadTouch){
        .is_there = true,
        .input = probe->input,
        .at = 0.5 * (near.value + far.value),
        .force = far.force,
        .impacts = far.impacts,
        .was_impacts = near.impacts,
    };
    return jump > JUMP_LEAST * joint->force.headline && jump > JUMP_SHARE * whole;
}

// Whether any draw has other impacts than the case.
static bool have_other_impacts(const Spread *spread)
{
    bool have = false;
    for (size_t i = 0; i < spread->asked; i++) {
        have = have || has_other_impacts(spread, &spread->draws[i].answers[0]);
    }
    return have;
}

// Looks to either side of the case along each input, and keeps the nearest touch at which the force
// jumps. Where no draw has other impacts there is none.
static void find_touch(Work *work, Spread *spread)
{
    if (!have_other_impacts(spread)) {
        return;
    }
    const size_t count = 2 * spread->inputs.count;
    Probe *probes = zeroed(count, sizeof *probes);
    for (size_t i = 0; i < count; i++) {
        const SpreadInput *input = &spread->inputs.inputs[i / 2];
        const double reach = TOUCH_SHARE * fabs(input->nominal);
        probes[i].input = i / 2;
        probes[i].value =
            input->nominal + (i % 2 == 0 ? -fmin(reach, -input->lower) : fmin(reach, input->upper));
    }
    probes_make(work, probes, count);
    double nearest = INFINITY;
    for (size_t i = 0; i < count; i++) {
        const SpreadInput *input = &spread->inputs.inputs[probes[i].input];
        SpreadTouch touch;
        if (probes[i].value != input->nominal &&
            has_other_impacts(spread, &probes[i].run.answers[0]) &&
            narrow(work, spread, &probes[i], &touch)) {
            const double share = fabs(touch.at - input->nominal) / (input->upper - input->lower);
            if (share < nearest) {
                nearest = share;
                spread->touch = touch;
            }
        }
    }
    for (size_t i = 0; i < count; i++) {
        run_free(&probes[i].run, 1);
    }
    free(probes);
}

static size_t loudest_joint(const Scenario *scenario)
{
    size_t loudest = 0;
    double most = -1.0;
    for (size_t i = 0; i < scenario->linkage.joint_count; i++) {
        const double force = scenario->settled.motions[0].joints[i].force.headline;
        if (linkage_has_play(&scenario->linkage.joints[i]) && force > most) {
            most = force;
            loudest = i;
        }
    }
    return loudest;
}

// A form after so many draws: where the budget ends, something of both is known.
enum { DRAWS_A_FORM = 3 };

static void make_draws_and_forms(Work *work, Spread *spread)
{
    SpreadRun **runs = zeroed(spread->asked + spread->form_count, sizeof *runs);
    size_t count = 0;
    size_t form = 0;
    for (size_t draw = 0; draw < spread->asked || form < spread->form_count;) {
        for (int k = 0; k < DRAWS_A_FORM && draw < spread->asked; k++) {
            runs[count++] = &spread->draws[draw++];
        }
        if (form < spread->form_count) {
            runs[count++] = &spread->forms[form++];
        }
    }
    make_runs(work, runs, count);
    free(runs);
}

// To what a draw has to repeat: a motion that does to fewer digits does so with other numbers, too.
static double repeats_of(const Scenario *scenario)
{
    const SettledMotion *motion = &scenario->settled.motions[0];
    return motion->period > 0 ? fmax(DRAW_REPEATS, 2.0 * motion->change) : RANDOM_REPEATS;
}

Spread spread_find(const SpreadCase *of, const Scenario *scenario, const SpreadOptions *options,
                   RunWatch watch)
{
    const size_t motions = scenario->settled.motion_count;
    Spread spread = {.scenario = scenario};
    if (!spread_is_of(scenario)) {
        return spread;
    }
    spread.motion_count = motions < MOTIONS_MOST ? motions : MOTIONS_MOST;
    spread.inputs = spread_inputs(scenario);
    spread.joint = loudest_joint(scenario);
    Work work = {
        .of = of,
        .scenario = scenario,
        .inputs = &spread.inputs,
        .motion_count = spread.motion_count,
        .repeats = repeats_of(scenario),
        .began_s = clock_processor_s(),
        .budget_s = options->budget_s,
        .watch = turn_watch_begin(watch),
    };
    const SpreadRun none = {.damping_scale = 1.0};
    Err unused = {ERR_NONE, ""};
    if (!read_run(&work, &none, &work.written, &unused)) {
        return spread;
    }
    if (options->has_forms) {
        add_forms(&work, &spread);
    }
    add_draws(&work, options, &spread);
    work.watch.budget_s = options->budget_s;
    work.watch.most = (spread.asked + spread.form_count) * spread.motion_count * TURNS_MOST;
    make_draws_and_forms(&work, &spread);
    sum_up_forms(&spread);
    sum_up_draws(&spread);
    correlate(&spread);
    if (options->has_forms && scenario->settled.motions[0].period > 0) {
        find_touch(&work, &spread);
    }
    spread.is_there = spread.draw_count > 1;
    spread.spent_s = clock_processor_s() - work.began_s;
    scenario_free(&work.written);
    return spread;
}

void spread_free(Spread *spread)
{
    for (size_t i = 0; i < spread->asked; i++) {
        run_free(&spread->draws[i], spread->motion_count);
    }
    for (size_t i = 0; i < spread->form_count; i++) {
        run_free(&spread->forms[i], spread->motion_count);
    }
    free(spread->draws);
    free(spread->forms);
    free(spread->ranges);
    free(spread->form_ranges);
    free(spread->ranks);
    spread_inputs_free(&spread->inputs);
    *spread = (Spread){.is_there = false};
}
