// Is a driver that lies refused by the name of what it lied about, and believed only where it may
// be right?
//
// The driver is a file that says one answer. The honest one is made of a run of the reference, with
// records of steps; the seed chooses what of it is replaced by which lie. An answer that is refused
// is so in one sentence, with the driver's name and the key's; one that is taken has the honest
// numbers, or at the place of the lie a number that is possible there.
#include "engine/driver.h"

#include "close.h"
#include "load_case.h"
#include "sample.h"

#include "base/lcg.h"
#include "run/registry.h"
#include "run/run.h"

#include <jansson.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

enum {
    LINE_COUNT_MAX = 64,
    LONG_LINE_SIZE = 20000000,
    NOISE_SIZE = 300,
    NUMBERS_OF_BODY = 6,
};

// s
static const double LIMIT_S = 20.0;

static const RunWatch NOBODY = {NULL, NULL};

// what stands for the lie until the line is written
static const char MARK[] = "\"@lie@\"";

static const char *const LIES[] = {
    "NaN",       "Infinity",
    "-Infinity", "1e300",
    "1e400",     "1e15",
    "-5",        "-1e-9",
    ".5",        "0.5",
    "2.5",       "0",
    "1e14",      "-1e300",
    "\"x\"",     "\"\"",
    "null",      "true",
    "[]",        "[1]",
    "{}",        "99999999999999999999",
    "9e14",      "1e9",
};

// what a message may call the value of a key: where it is of the right form the sentence is about
// what it means
static const struct {
    const char *key;
    const char *words[8];
} WORDS[] = {
    {"sample", {"sample"}},
    {"step", {"step"}},
    {"bodies", {"bodies", "suddenly", "its drive", "the joint"}},
    {"joints", {"joints", "largest force", "deepest penetration", "contacts begun"}},
    {"done", {"done"}},
    {"steps", {"steps"}},
    {"wall_s", {"wall_s"}},
    {"settings", {"settings"}},
    {"jointplay-driver", {"jointplay-driver", "first line"}},
    {"engine", {"engine"}},
    {"version", {"version"}},
    {"precision", {"precision"}},
    {"ways", {"ways"}},
};

typedef struct Answer {
    size_t count;
    char *lines[LINE_COUNT_MAX]; // owned, without their ends
} Answer;

// A lie and what it is about.
typedef struct Lie {
    const char *key; // NULL: a line, and no value
    const char *value;
    bool is_missing;
    char text[256]; // all of it, for a message
} Lie;

static size_t choose(uint64_t *seed, size_t count)
{
    const size_t chosen = (size_t)(0.5 * (1.0 + lcg_draw(seed)) * (double)count);
    return chosen < count ? chosen : count - 1;
}

static json_t *row_of(const double *numbers, size_t count)
{
    json_t *row = json_array();
    for (size_t i = 0; i < count; i++) {
        json_array_append_new(row, json_real(numbers[i]));
    }
    return row;
}

static json_t *sample_of(const Trajectory *run, size_t sample)
{
    json_t *bodies = json_array();
    json_t *joints = json_array();
    for (size_t i = 0; i < run->body_count; i++) {
        const Motion *of = trajectory_motion(run, sample, i);
        const double numbers[NUMBERS_OF_BODY] = {of->position.x, of->position.y, of->angle,
                                                 of->velocity.x, of->velocity.y, of->omega};
        json_array_append_new(bodies, row_of(numbers, NUMBERS_OF_BODY));
    }
    for (size_t i = 0; i < run->joint_count; i++) {
        const Vec2 force = trajectory_state(run, sample, i)->force_on_b;
        json_array_append_new(joints, row_of((const double[]){force.x, force.y}, 2));
    }
    return json_pack("{s:f, s:o, s:o}", "sample", run->times[sample], "bodies", bodies, "joints",
                     joints);
}

static json_t *record_of(const Trajectory *run, size_t sample)
{
    json_t *bodies = json_array();
    json_t *joints = json_array();
    const double start_s = run->times[sample - 1];
    const double end_s = run->times[sample];
    for (size_t i = 0; i < run->body_count; i++) {
        const Motion *of = trajectory_motion(run, sample, i);
        json_array_append_new(
            bodies, row_of((const double[]){of->velocity.x, of->velocity.y, of->omega}, 3));
    }
    for (size_t i = 0; i < run->joint_count; i++) {
        const JointState *of = trajectory_state(run, sample, i);
        const double numbers[] = {of->eccentricity.x,
                                  of->eccentricity.y,
                                  of->force_on_b.x,
                                  of->force_on_b.y,
                                  of->force,
                                  1e-6,
                                  of->force * (end_s - start_s),
                                  0.1};
        json_array_append_new(joints, linkage_has_play(&run->linkage.joints[i])
                                          ? row_of(numbers, sizeof numbers / sizeof *numbers)
                                          : json_null());
    }
    return json_pack("{s:[f, f], s:o, s:o}", "step", start_s, end_s, "bodies", bodies, "joints",
                     joints);
}

static json_t *done_of(const Trajectory *run)
{
    json_t *joints = json_array();
    for (size_t i = 0; i < run->joint_count; i++) {
        const bool has_play = linkage_has_play(&run->linkage.joints[i]);
        json_array_append_new(
            joints, json_pack("[f, f, i]", has_play ? 10.0 : 0.0, has_play ? 1e-6 : 0.0, has_play));
    }
    return json_pack("{s:{s:i, s:f, s:o, s:s}}", "done", "steps", 1000, "wall_s", 1e-5, "joints",
                     joints, "settings", "none");
}

// What an honest driver says, line by line; the caller frees them.
static size_t honest_lines(const Trajectory *run, json_t *lines[LINE_COUNT_MAX])
{
    size_t count = 0;
    assert_true(2 * run->sample_count + 1 <= LINE_COUNT_MAX);
    lines[count++] = json_pack("{s:i, s:s, s:s, s:s, s:[s]}", "jointplay-driver", 2, "engine",
                               "Liar", "version", "1.0", "precision", "double", "ways", "native");
    for (size_t i = 0; i < run->sample_count; i++) {
        lines[count++] = sample_of(run, i);
    }
    for (size_t i = 1; i < run->sample_count; i++) {
        lines[count++] = record_of(run, i);
    }
    lines[count++] = done_of(run);
    return count;
}

// Puts the mark at a random place of a line's value, which may be all of it.
static void mark_within(json_t *value, uint64_t *seed)
{
    static const char MARK_TEXT[] = "@lie@";
    while (true) {
        const size_t index = choose(seed, json_array_size(value));
        json_t *within = json_array_get(value, index);
        if (json_array_size(within) == 0 || choose(seed, 4) == 0) {
            json_array_set_new(value, index, json_string(MARK_TEXT));
            return;
        }
        value = within;
    }
}

// Marks a value of a line, or takes it out; its key becomes that of the lie.
static void mark_value(json_t *line, uint64_t *seed, Lie *lie)
{
    json_t *done = json_object_get(line, "done");
    json_t *object = done != NULL && choose(seed, 8) > 0 ? done : line;
    void *at = json_object_iter(object);
    for (size_t left = choose(seed, json_object_size(object)); left > 0; left--) {
        at = json_object_iter_next(object, at);
    }
    for (size_t i = 0; i < sizeof WORDS / sizeof *WORDS; i++) {
        if (strcmp(WORDS[i].key, json_object_iter_key(at)) == 0) {
            lie->key = WORDS[i].key;
        }
    }
    assert_non_null(lie->key);
    json_t *value = json_object_iter_value(at);
    lie->is_missing = choose(seed, 12) == 0;
    if (lie->is_missing) {
        json_object_del(object, lie->key);
    } else if (json_array_size(value) > 0 && choose(seed, 6) > 0) {
        mark_within(value, seed);
    } else {
        json_object_set_new(object, lie->key, json_string("@lie@"));
    }
}

// The text of a line, with the lie at its mark.
static char *line_text(const json_t *line, const Lie *lie)
{
    char *text = json_dumps(line, JSON_COMPACT);
    char *mark = lie->value != NULL ? strstr(text, MARK) : NULL;
    if (mark == NULL) {
        return text;
    }
    const size_t size = strlen(text) + strlen(lie->value) + 1;
    char *whole = malloc(size);
    assert_non_null(whole);
    snprintf(whole, size, "%.*s%s%s", (int)(mark - text), text, lie->value, mark + strlen(MARK));
    free(text);
    return whole;
}

static char *filled(size_t size, uint64_t *seed)
{
    char *text = malloc(size + 1);
    assert_non_null(text);
    memset(text, '[', size);
    for (size_t i = 0; seed != NULL && i < size; i++) {
        text[i] = (char)(1 + choose(seed, 255));
    }
    text[size] = '\0';
    return text;
}

static void swap_lines(char **a, char **b)
{
    char *kept = *a;
    *a = *b;
    *b = kept;
}

static void add_line(Answer *answer, size_t at, char *text)
{
    assert_true(answer->count < LINE_COUNT_MAX);
    memmove(answer->lines + at + 1, answer->lines + at,
            (answer->count - at) * sizeof *answer->lines);
    answer->lines[at] = text;
    answer->count++;
}

// Changes the lines of an answer, and not what is in them.
static void lie_by_lines(Answer *answer, uint64_t *seed, Lie *lie)
{
    const size_t at = choose(seed, answer->count - 1);
    const size_t kind = choose(seed, 9);
    const size_t honest = answer->count;
    static const char *const KINDS[] = {"without it", "twice",     "swapped with the next",
                                        "cut",        "empty",     "noise before it",
                                        "a list",     "all again", "a long line before it"};
    snprintf(lie->text, sizeof lie->text, "line %zu: %s", at, KINDS[kind]);
    switch (kind) {
    case 0:
        free(answer->lines[at]);
        answer->count--;
        memmove(answer->lines + at, answer->lines + at + 1,
                (answer->count - at) * sizeof *answer->lines);
        break;
    case 1:
        add_line(answer, at, strdup(answer->lines[at]));
        break;
    case 2:
        swap_lines(&answer->lines[at], &answer->lines[at + 1]);
        break;
    case 3:
        answer->lines[at][strlen(answer->lines[at]) / 2] = '\0';
        break;
    case 4:
        answer->lines[at][0] = '\0';
        break;
    case 5:
        add_line(answer, at, filled(NOISE_SIZE, seed));
        break;
    case 6:
        add_line(answer, at, strdup("[1, 2]"));
        break;
    case 7:
        for (size_t i = 0; i < honest && answer->count < LINE_COUNT_MAX; i++) {
            add_line(answer, answer->count, strdup(answer->lines[i]));
        }
        break;
    default:
        add_line(answer, at, filled(LONG_LINE_SIZE, NULL));
        break;
    }
}

// The answer of a seed; of 0 the honest one.
static Answer answer_of(const Trajectory *honest, unsigned number, Lie *lie)
{
    json_t *lines[LINE_COUNT_MAX];
    Answer answer = {.count = honest_lines(honest, lines)};
    uint64_t seed = lcg_stirred(number);
    const bool is_value = number > 0 && choose(&seed, 5) > 0;
    // the first and the last line as often as all samples, and as all records
    const size_t samples = honest->sample_count;
    const size_t groups[] = {0, 1 + choose(&seed, samples),
                             1 + samples + choose(&seed, samples - 1), answer.count - 1};
    const size_t at = groups[choose(&seed, 4)];
    *lie = (Lie){.text = "none"};
    if (is_value) {
        mark_value(lines[at], &seed, lie);
        lie->value = lie->is_missing ? NULL : LIES[choose(&seed, sizeof LIES / sizeof *LIES)];
        snprintf(lie->text, sizeof lie->text, "line %zu: '%s' is %s", at, lie->key,
                 lie->is_missing ? "missing" : lie->value);
    }
    for (size_t i = 0; i < answer.count; i++) {
        answer.lines[i] = line_text(lines[i], lie);
        json_decref(lines[i]);
    }
    if (!is_value && number > 0) {
        lie_by_lines(&answer, &seed, lie);
    }
    return answer;
}

// Writes a program that says an answer and heeds nothing.
static void write_driver(Answer *answer, const char *path)
{
    FILE *file = fopen(path, "w");
    assert_non_null(file);
    fprintf(file, "#!/usr/bin/tail -n+2\n");
    for (size_t i = 0; i < answer->count; i++) {
        fprintf(file, "%s\n", answer->lines[i]);
        free(answer->lines[i]);
    }
    assert_int_equal(fclose(file), 0);
    chmod(path, 0700);
}

static bool names(const char *message, const char *key)
{
    for (size_t i = 0; i < sizeof WORDS / sizeof *WORDS; i++) {
        for (size_t k = 0; strcmp(WORDS[i].key, key) == 0 && WORDS[i].words[k] != NULL; k++) {
            if (strstr(message, WORDS[i].words[k]) != NULL) {
                return true;
            }
        }
    }
    return false;
}

// Whether numbers that cannot be are among what was taken.
static bool is_possible(const Trajectory *run, const EngineRecords *records)
{
    bool is =
        run->steps >= 1 && run->steps < 10000000 && run->wall_s > 0.0 && run->wall_s < LIMIT_S;
    for (size_t i = 0; i < run->joint_count; i++) {
        const JointExtremes *of = &run->joints[i];
        is = is && of->force_max.value >= 0.0 && of->force_max.value <= 1e15 &&
             of->penetration_max.value >= 0.0 && of->penetration_max.value < 1.0 &&
             of->impacts < 10000000;
    }
    for (size_t i = 0; i < records->count; i++) {
        is = is && engine_records_end(records, i) > engine_records_begin(records, i) &&
             engine_records_end(records, i) <= 2.0 * run->duration_s;
        for (size_t k = 0; k < run->joint_count; k++) {
            const EngineTouch touch = engine_records_joint(records, i, k);
            is = is && !(touch.force_max < 0.0) && !(touch.depth_max < 0.0) &&
                 !(touch.impulse < 0.0);
        }
    }
    return is;
}

// Whether all bodies go as slowly as what is stepped can.
static bool is_slow(const Trajectory *run)
{
    bool is = true;
    for (size_t i = 0; i < run->sample_count * run->body_count; i++) {
        is = is && vec2_length(run->motions[i].velocity) * run->step_s < 1e3 &&
             fabs(run->motions[i].omega) * run->step_s <= 1e3;
    }
    return is;
}

// How many numbers of samples are others than the honest ones.
static size_t count_others(const Trajectory *run, const Trajectory *honest)
{
    size_t count = 0;
    for (size_t i = 0; i < run->sample_count * run->body_count; i++) {
        const Motion *a = &run->motions[i];
        const Motion *b = &honest->motions[i];
        const double off[] = {a->position.x - b->position.x, a->position.y - b->position.y,
                              a->velocity.x - b->velocity.x, a->velocity.y - b->velocity.y,
                              a->angle - b->angle,           a->omega - b->omega};
        for (size_t k = 0; k < sizeof off / sizeof *off; k++) {
            count += off[k] != 0.0 ? 1 : 0;
        }
    }
    for (size_t i = 0; i < run->sample_count * run->joint_count; i++) {
        const Vec2 a = run->states[i].force_on_b;
        const Vec2 b = honest->states[i].force_on_b;
        count += (a.x != b.x ? 1 : 0) + (a.y != b.y ? 1 : 0);
    }
    return count;
}

static void judge(const Trajectory *run, const EngineRecords *records, const Trajectory *honest,
                  const Lie *lie)
{
    static const char LABEL[] = "liar native: ";
    if (!run->is_complete) {
        const bool is_sentence = strncmp(run->message, LABEL, strlen(LABEL)) == 0 &&
                                 strchr(run->message, '\n') == NULL && strlen(run->message) < 400;
        if (!is_sentence || (lie->key != NULL && !names(run->message, lie->key))) {
            fail_msg("%s: '%s' does not name it", lie->text, run->message);
        }
        return;
    }
    // what is believed is one number that another motion could have
    const bool is_number = lie->value != NULL && strtod(lie->value, NULL) < INFINITY &&
                           strchr("-0123456789", lie->value[0]) != NULL;
    if (!is_possible(run, records) || !is_slow(run) ||
        count_others(run, honest) > (is_number ? 1 : 0)) {
        fail_msg("%s: is believed", lie->text);
    }
}

static Scenario played(void)
{
    static const char *const SET[] = {"run.start=centred", "run.revolutions=0.02",
                                      "run.samples=600", "run.step=10us"};
    return load("cases/paper/impact-k66.yaml", SET, sizeof SET / sizeof *SET);
}

// so many lies
static unsigned lie_count = 200;

static void lies_are_refused_by_name_or_do_no_harm(void **state)
{
    (void)state;
    char path[] = "/tmp/jointplay-liar-XXXXXX";
    const Scenario scenario = played();
    Trajectory *honest = run_scenario(&scenario, registry_solver(BACKEND_REFERENCE), NOBODY);
    EngineDriver driver = {.name = "liar", .protocol = 2, .way_count = 1, .ways = {"native"}};
    assert_true(honest->is_complete);
    close(mkstemp(path));
    snprintf(driver.program, sizeof driver.program, "%s", path);
    unsigned refused = 0;
    for (unsigned number = 0; number <= lie_count; number++) {
        Lie lie;
        Answer answer = answer_of(honest, number, &lie);
        write_driver(&answer, path);
        EngineRecords records =
            engine_records_start(scenario.linkage.body_count, scenario.linkage.joint_count, 1e-9,
                                 scenario_duration(&scenario));
        Trajectory *run =
            engine_run_recorded(&driver, "native", &scenario, LIMIT_S, NULL, &records);
        if (getenv("JOINTPLAY_SHOW_LIES") != NULL) {
            fprintf(stderr, "# %u %s: %s\n", number, lie.text,
                    run->is_complete ? "taken" : run->message);
        }
        // the control: what is honest is taken
        if (number == 0 && !run->is_complete) {
            fail_msg("%s", run->message);
        }
        judge(run, &records, honest, &lie);
        refused += run->is_complete ? 0 : 1;
        engine_records_finish(&records);
        trajectory_destroy(run);
    }
    assert_true(refused > lie_count / 2);
    trajectory_destroy(honest);
    unlink(path);
}

int main(int argc, char **argv)
{
    lie_count = argc > 1 ? (unsigned)strtoul(argv[1], NULL, 10) : lie_count;
    lie_count = (unsigned)sample_size(lie_count);
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(lies_are_refused_by_name_or_do_no_harm),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
