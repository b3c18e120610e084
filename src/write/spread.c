// Says what the inputs and the assumptions of a case add to its forces.
#include "write/spread.h"

#include "write/json_value.h"
#include "write/table.h"
#include "write/units.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static const double COVERED = 0.9; // 1, of the distribution

// 1: a rank correlation that one in a hundred samples of 38 independent pairs exceeds
static const double RANK_LEAST = 0.41;

double spread_confidence(size_t draws)
{
    const double n = (double)draws;
    return draws < 2 ? 0.0 : 1.0 - n * pow(COVERED, n - 1.0) + (n - 1.0) * pow(COVERED, n);
}

static const char *unit_of(const Spread *spread, size_t joint)
{
    return joint_units(&spread->scenario->linkage.joints[joint])->force;
}

static double nominal_of(const Spread *spread, size_t joint)
{
    return spread->scenario->settled.motions[0].joints[joint].force.headline;
}

// A key as the first screen has it: a letter or word of its own, or the key without its group.
static void append_key(const char *key, Text *text)
{
    static const char *const WORDS[][2] = {
        {"material.youngs-modulus", "E"},
        {"contact.stiffness", "K"},
        {"drive.speed", "speed"},
    };
    static const char *const GROUPS[] = {"contact.", "material.", "joints."};
    const char *shown = key;
    for (size_t i = 0; i < sizeof GROUPS / sizeof *GROUPS; i++) {
        const size_t length = strlen(GROUPS[i]);
        shown = strncmp(key, GROUPS[i], length) == 0 ? key + length : shown;
    }
    for (size_t i = 0; i < sizeof WORDS / sizeof *WORDS; i++) {
        shown = strcmp(key, WORDS[i][0]) == 0 ? WORDS[i][1] : shown;
    }
    text_append_shown(text, shown);
}

// "laws, damping and friction"
static void append_forms(const Spread *spread, Text *text)
{
    size_t count = 0;
    size_t said = 0;
    for (size_t i = 0; i < SPREAD_FORM_KIND_COUNT; i++) {
        count += spread->has_form[i] ? 1 : 0;
    }
    for (size_t i = 0; i < SPREAD_FORM_KIND_COUNT; i++) {
        if (spread->has_form[i]) {
            text_append(text, "%s%s",
                        said == 0           ? ""
                        : said + 1 == count ? " and "
                                            : ", ",
                        SPREAD_FORM_KINDS[i]);
            said++;
        }
    }
}

static bool has_forms(const Spread *spread)
{
    bool has = false;
    for (size_t i = 0; i < SPREAD_FORM_KIND_COUNT; i++) {
        has = has || spread->has_form[i];
    }
    return has;
}

// How many draws have no answer, and why the first of them makes no case: in the first line of its
// message, behind the place that it names.
static void append_without(const Spread *spread, Text *text)
{
    const char *ending = spread->without == 1 ? "s" : "";
    text_append(text, " %zu of the draws ", spread->without);
    text_append(text, spread->why_without != NULL ? "make%s no case" : "fail%s", ending);
    if (spread->why_without != NULL) {
        const char *colon = strstr(spread->why_without, ": ");
        const char *why = colon != NULL ? colon + strlen(": ") : spread->why_without;
        text_append(text, ": ");
        Text first;
        text_init(&first);
        text_append(&first, "%.*s", (int)strcspn(why, "\n"), why);
        text_append_shown(text, first.data);
        text_finish(&first);
    }
    text_append(text, ".");
}

// "crank-coupler 2.4 kN: 2.0 to 2.5 within the inputs' limits (38 draws), 1.8 to 2.5 with other
// laws and damping."
static void append_ranges(const Spread *spread, Text *text)
{
    const size_t joint = spread->joint;
    const double nominal = nominal_of(spread, joint);
    const SpreadRange *range = &spread->ranges[joint];
    const SpreadRange *forms = &spread->form_ranges[joint];
    Text line;
    text_init(&line);
    text_append(&line, "  ");
    text_append_shown(&line, spread->scenario->linkage.joints[joint].name);
    text_append(&line, " ");
    units_append_spread(&line, nominal, range->low, range->high, unit_of(spread, joint));
    text_append(&line, ": ");
    units_append_ends(&line, nominal, range->low, range->high);
    text_append(&line, " within the inputs' limits (%zu", spread->draw_count);
    if (spread->draw_count < spread->asked) {
        text_append(&line, " of %zu", spread->asked);
    }
    text_append(&line, " draws)");
    if (has_forms(spread)) {
        text_append(&line, ", ");
        units_append_ends(&line, nominal, forms->low, forms->high);
        text_append(&line, " with other ");
        append_forms(spread, &line);
    }
    text_append(&line, ".");
    if (spread->is_spent) {
        text_append(&line, " run.budget ended the draws.");
    }
    if (spread->without > 0) {
        append_without(spread, &line);
    }
    screen_sentence(&line, text);
}

static void append_distance(const SpreadInput *input, Text *text)
{
    const double size = fmax(-input->lower, input->upper);
    const double share = input->nominal != 0.0 ? size / fabs(input->nominal) : 1.0;
    if (input->unit[0] == '\0' || input->nominal == 0.0) {
        text_append(text, "%.3g", size);
    } else if (share < 1e-3) {
        // of a size of which play is what is left
        units_append(text, size, input->unit);
    } else {
        text_append(text, "%.3g %%", share * UNITS_PERCENT);
    }
}

// What of a key of a joint stands behind its name: "hole"; the key itself of another.
static const char *last_word(const char *key)
{
    const char *dot = strrchr(key, '.');
    return strncmp(key, "joints.", strlen("joints.")) == 0 && dot != NULL ? dot + 1 : key;
}

// Whether two assumed limits are the same of the same key of two joints.
static bool is_alike(const SpreadInput *a, const SpreadInput *b)
{
    return !a->is_given && !b->is_given && last_word(a->key) != a->key &&
           last_word(b->key) != b->key && strcmp(last_word(a->key), last_word(b->key)) == 0 &&
           a->nominal == b->nominal && a->lower == b->lower && a->upper == b->upper;
}

// How many inputs have the limits of one; 0 where one before it has them.
static size_t count_alike(const SpreadInputs *inputs, size_t number)
{
    size_t count = 0;
    for (size_t i = 0; i < inputs->count; i++) {
        const bool is_one = i == number || is_alike(&inputs->inputs[i], &inputs->inputs[number]);
        if (is_one && i < number) {
            return 0;
        }
        count += is_one ? 1 : 0;
    }
    return count;
}

// What limits nobody gave, and on which input the range depends most.
static void append_inputs(const Spread *spread, Text *text)
{
    const SpreadInputs *inputs = &spread->inputs;
    size_t most = 0;
    size_t assumed = 0;
    Text line;
    text_init(&line);
    for (size_t i = 0; i < inputs->count; i++) {
        const SpreadInput *input = &inputs->inputs[i];
        most = fabs(spread->ranks[i]) > fabs(spread->ranks[most]) ? i : most;
        const size_t alike = count_alike(inputs, i);
        if (!input->is_given && alike > 0) {
            text_append(&line, assumed++ == 0 ? "  Assumed limits +-: " : ", ");
            if (alike > 1) {
                text_append(&line, "%s of %zu joints", last_word(input->key), alike);
            } else {
                append_key(input->key, &line);
            }
            text_append(&line, " ");
            append_distance(input, &line);
        }
    }
    text_append(&line, assumed > 0 ? "; " : "  ");
    const double rank = inputs->count > 0 ? spread->ranks[most] : NAN;
    if (fabs(rank) >= RANK_LEAST) {
        append_key(inputs->inputs[most].key, &line);
        text_append(&line, " matters most (correlation %.2f).", rank);
    } else {
        text_append(&line, "%s single input matters most.", assumed > 0 ? "no" : "No");
    }
    screen_sentence(&line, text);
}

// Where a contact begins or ends as one input changes, and the force jumps.
static void append_touch(const Spread *spread, Text *text)
{
    const SpreadTouch *touch = &spread->touch;
    if (!touch->is_there) {
        return;
    }
    const SpreadInput *input = &spread->inputs.inputs[touch->input];
    Text line;
    text_init(&line);
    const double way = touch->at / input->nominal - 1.0;
    text_append(&line, "  With ");
    append_key(input->key, &line);
    text_append(&line, " %.2g %% %s a contact %s: about ", fabs(way) * UNITS_PERCENT,
                way * input->nominal > 0.0 ? "higher" : "lower",
                touch->impacts >= touch->was_impacts ? "begins" : "ends");
    units_append(&line, touch->force, unit_of(spread, spread->joint));
    text_append(&line, " there.");
    screen_sentence(&line, text);
}

void spread_sentences(const Spread *spread, Text *text)
{
    if (spread == NULL || !spread->is_there) {
        return;
    }
    append_ranges(spread, text);
    append_inputs(spread, text);
    append_touch(spread, text);
}

// For programs.

static json_t *inputs_json(const Spread *spread)
{
    json_t *array = json_array();
    for (size_t i = 0; i < spread->inputs.count; i++) {
        const SpreadInput *input = &spread->inputs.inputs[i];
        json_t *object = json_object();
        json_object_set_new(object, "key", json_value_text(input->key));
        json_object_set_new(object, "item", json_integer((json_int_t)input->item));
        json_object_set_new(object, "unit", json_value_text(input->unit));
        json_value_set(object, "nominal", input->nominal);
        json_value_set(object, "lower", input->lower);
        json_value_set(object, "upper", input->upper);
        json_value_set(object, "share", fmax(-input->lower, input->upper) / fabs(input->nominal));
        json_object_set_new(object, "is_given", json_boolean(input->is_given));
        json_value_set(object, "rank_correlation", spread->ranks[i]);
        json_array_append_new(array, object);
    }
    return array;
}

static void set_force(json_t *object, const Spread *spread, size_t joint, const char *stem,
                      double value)
{
    char key[64];
    snprintf(key, sizeof key, "%s_%s", stem,
             joint_units(&spread->scenario->linkage.joints[joint])->force_key);
    json_value_set(object, key, value);
}

static json_t *joints_json(const Spread *spread)
{
    const Linkage *linkage = &spread->scenario->linkage;
    json_t *array = json_array();
    for (size_t i = 0; i < linkage->joint_count; i++) {
        if (!linkage_has_play(&linkage->joints[i])) {
            continue;
        }
        const char *stem = linkage_is_torsional(&linkage->joints[i]) ? "torque" : "force";
        const struct {
            const char *part;
            double value;
        } parts[] = {
            {"nominal", nominal_of(spread, i)},         {"low", spread->ranges[i].low},
            {"high", spread->ranges[i].high},           {"form_low", spread->form_ranges[i].low},
            {"form_high", spread->form_ranges[i].high},
        };
        json_t *object = json_object();
        json_object_set_new(object, "name", json_value_text(linkage->joints[i].name));
        for (size_t k = 0; k < sizeof parts / sizeof *parts; k++) {
            char part[32];
            snprintf(part, sizeof part, "%s_%s", stem, parts[k].part);
            set_force(object, spread, i, part, parts[k].value);
        }
        json_array_append_new(array, object);
    }
    return array;
}

// What a run came to from each motion: of the joints with play.
static json_t *answers_json(const Spread *spread, const SpreadRun *run)
{
    const Linkage *linkage = &spread->scenario->linkage;
    json_t *array = json_array();
    for (size_t m = 0; m < spread->motion_count; m++) {
        const SpreadAnswer *answer = &run->answers[m];
        if (!answer->is_there) {
            json_array_append_new(array, json_null());
            continue;
        }
        json_t *object = json_object();
        json_t *forces = json_array();
        json_object_set_new(object, "period", json_integer((json_int_t)answer->period));
        for (size_t i = 0; i < linkage->joint_count; i++) {
            if (linkage_has_play(&linkage->joints[i])) {
                json_array_append_new(forces, json_value_real(answer->forces[i]));
            }
        }
        json_object_set_new(object, "largest", forces);
        json_array_append_new(array, object);
    }
    return array;
}

static json_t *draws_json(const Spread *spread)
{
    json_t *array = json_array();
    for (size_t i = 0; i < spread->asked; i++) {
        json_t *object = json_object();
        json_t *values = json_array();
        for (size_t k = 0; k < spread->inputs.count; k++) {
            json_array_append_new(values, json_value_real(spread->draws[i].values[k]));
        }
        json_object_set_new(object, "values", values);
        json_object_set_new(object, "motions", answers_json(spread, &spread->draws[i]));
        json_array_append_new(array, object);
    }
    return array;
}

static json_t *forms_json(const Spread *spread)
{
    json_t *array = json_array();
    for (size_t i = 0; i < spread->form_count; i++) {
        json_t *object = json_object();
        json_object_set_new(object, "name", json_value_text(spread->forms[i].name));
        json_object_set_new(object, "motions", answers_json(spread, &spread->forms[i]));
        json_array_append_new(array, object);
    }
    return array;
}

static json_t *touch_json(const Spread *spread)
{
    const SpreadTouch *touch = &spread->touch;
    if (!touch->is_there) {
        return json_null();
    }
    json_t *object = json_object();
    json_object_set_new(object, "key", json_value_text(spread->inputs.inputs[touch->input].key));
    json_value_set(object, "at", touch->at);
    json_value_set(object, "share", touch->at / spread->inputs.inputs[touch->input].nominal - 1.0);
    set_force(object, spread, spread->joint, "force", touch->force);
    json_value_set(object, "impacts_per_revolution", touch->impacts);
    return object;
}

void spread_json(json_t *object, const Spread *spread)
{
    if (spread == NULL || !spread->is_there) {
        return;
    }
    json_t *made = json_object();
    json_object_set_new(made, "draws_asked", json_integer((json_int_t)spread->asked));
    json_object_set_new(made, "draws_made", json_integer((json_int_t)spread->draw_count));
    json_object_set_new(made, "draws_without", json_integer((json_int_t)spread->without));
    json_object_set_new(made, "without_because",
                        spread->why_without != NULL ? json_value_text(spread->why_without)
                                                    : json_null());
    json_object_set_new(made, "is_spent", json_boolean(spread->is_spent));
    json_value_set(made, "covered", COVERED);
    json_value_set(made, "confidence", spread_confidence(spread->draw_count));
    json_object_set_new(made, "inputs", inputs_json(spread));
    json_object_set_new(made, "joints", joints_json(spread));
    json_object_set_new(made, "touch", touch_json(spread));
    json_object_set_new(made, "forms", forms_json(spread));
    json_object_set_new(made, "draws", draws_json(spread));
    json_object_set_new(object, "spread", made);
}
