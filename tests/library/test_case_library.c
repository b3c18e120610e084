// What programs do with the library of cases, right and wrong.
#include "close.h"
#include "sample.h"

#include <jointplay/case.h>

#include <malloc.h>
#include <math.h>
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

// The paper's four-bar for a twentieth of a revolution from a centred pin.
static const char SHORT[] =
    "title: A pin with play\n"
    "four-bar:\n"
    "  ground:   {length: 254 mm}\n"
    "  crank:    {length: 108 mm, mass: 0.12 kg, inertia: 174 kg mm^2}\n"
    "  coupler:  {length: 279.4 mm, mass: 0.29 kg, inertia: 2070 kg mm^2}\n"
    "  follower: {length: 270.5 mm, mass: 0.28 kg, inertia: 1988 kg mm^2}\n"
    "joints:\n"
    "  crank-coupler: {radial-clearance: 14.5 um, pin: 10 mm, width: 13 mm}\n"
    "drive: {speed: 1000 rpm}\n"
    "contact: {stiffness: 6.6e10 N/m^1.5, restitution: 0.9}\n"
    "run: {revolutions: 0.05, samples: 3600, step: 5 us, start: centred,\n"
    "      backends: [reference, ode]}\n";

static const char PLAY[] = "joints.crank-coupler.radial-clearance";
static const char FORCE[] = "joints.crank-coupler.force_max_N";

static JpCase *open_text(const char *text)
{
    JpCaseError error;
    JpCase *of = jp_case_parse(text, strlen(text), "mine.yaml", &error);
    if (of == NULL) {
        print_message("%s\n", error.text);
    }
    assert_non_null(of);
    return of;
}

static JpAnswer *run(JpCase *of, const JpRunOptions *options)
{
    JpCaseError error;
    JpAnswer *answer = jp_case_run(of, options, &error);
    if (answer == NULL) {
        print_message("%s\n", error.text);
    }
    assert_non_null(answer);
    return answer;
}

static double number(JpAnswer *answer, const char *name)
{
    JpCaseError error;
    JpNumber found;
    if (jp_answer_number(answer, name, &found, &error) != JP_CASE_OK) {
        print_message("%s\n", error.text);
        fail();
    }
    return found.value;
}

// Settings.

static void a_setting_reads_back_in_si(void **state)
{
    (void)state;
    JpCaseError error;
    JpSetting setting;
    JpCase *of = open_text(SHORT);
    assert_int_equal(jp_case_set(of, PLAY, "20 um", &error), JP_CASE_OK);
    assert_int_equal(jp_case_setting(of, PLAY, &setting, &error), JP_CASE_OK);
    assert_near(setting.numbers[0], 20e-6, 1e-16);
    assert_int_equal(setting.count, 1);
    assert_string_equal(setting.unit, "m");
    assert_int_equal(jp_case_set_number(of, "drive.speed", 100.0, &error), JP_CASE_OK);
    assert_int_equal(jp_case_setting(of, "drive.speed", &setting, &error), JP_CASE_OK);
    assert_true(setting.numbers[0] == 100.0);
    // a stiffness keeps its exponent
    assert_int_equal(jp_case_set_number(of, "contact.stiffness", 1e10, &error), JP_CASE_OK);
    assert_int_equal(jp_case_setting(of, "contact.stiffness", &setting, &error), JP_CASE_OK);
    assert_string_equal(setting.unit, "N/m^1.5");
    assert_true(setting.numbers[0] == 1e10);
    // NULL takes it back
    assert_int_equal(jp_case_set(of, PLAY, NULL, &error), JP_CASE_OK);
    assert_int_equal(jp_case_setting(of, PLAY, &setting, &error), JP_CASE_OK);
    assert_true(fabs(setting.numbers[0] - 14.5e-6) < 1e-18);
    jp_case_free(of);
}

// A signal, its parts, and parts of what uses it.
static void a_signal_reads_back_as_it_was_set(void **state)
{
    (void)state;
    static const struct {
        const char *key;
        const char *text;
        double number; // NAN: none
        const char *unit;
    } READ[] = {
        {"signals.shaker", "{amplitude: 6 N, frequency: 20 Hz}", NAN, ""},
        {"signals.shaker.amplitude", "6 N", 6.0, "N"},
        {"signals.shaker.frequency", "20 Hz", 20.0, "Hz"},
        {"signals.shaker.mean", "0 N", 0.0, "N"},
        {"loads.end.force.phase", "0 rad", 0.0, "rad"},
    };
    JpCaseError error;
    JpSetting setting;
    JpCase *of = jp_case_open("shaken-lever", &error);
    assert_non_null(of);
    for (size_t i = 0; i < sizeof READ / sizeof *READ; i++) {
        assert_int_equal(jp_case_setting(of, READ[i].key, &setting, &error), JP_CASE_OK);
        assert_string_equal(setting.text, READ[i].text);
        assert_string_equal(setting.unit, READ[i].unit);
        assert_int_equal(setting.count, isnan(READ[i].number) ? 0 : 1);
        assert_true(setting.count == 0 || setting.numbers[0] == READ[i].number);
        assert_true(setting.doc[0] != '\0');
        // what it says can be set
        assert_int_equal(jp_case_set(of, READ[i].key, setting.text, &error), JP_CASE_OK);
    }
    // one part of one user alone
    assert_int_equal(jp_case_set_number(of, "loads.end.force.phase", 0.5, &error), JP_CASE_OK);
    assert_int_equal(jp_case_setting(of, "loads.end.force.phase", &setting, &error), JP_CASE_OK);
    assert_true(setting.numbers[0] == 0.5);
    assert_int_equal(jp_case_setting(of, "loads.across.force.phase", &setting, &error), JP_CASE_OK);
    assert_true(setting.numbers[0] == 0.0);
    // a part that there is not, and a whole that is no number
    static const char *const NONE[] = {"signals.no-such", "signals.shaker.no-such",
                                       "drive.speed.phase", "signals"};
    for (size_t i = 0; i < sizeof NONE / sizeof *NONE; i++) {
        assert_int_equal(jp_case_setting(of, NONE[i], &setting, &error), JP_CASE_ERROR_USAGE);
    }
    assert_int_equal(jp_case_set_number(of, "signals.shaker", 3.0, &error), JP_CASE_ERROR_USAGE);
    jp_case_free(of);
}

static void a_setting_that_is_wrong_says_why_and_changes_nothing(void **state)
{
    (void)state;
    JpCaseError error;
    JpSetting setting;
    JpCase *of = open_text(SHORT);
    assert_int_equal(jp_case_set(of, PLAY, "20 um", &error), JP_CASE_OK);
    static const char *const WRONG[][2] = {
        {PLAY, "20 lm"}, {PLAY, ""}, {PLAY, "-3 um"}, {"joints.crank-coupler.holes", "1 mm"},
        {"", "1"},       {"=", "1"}, {PLAY, "[1, 2"}, {"nothing.like.that", "1"},
    };
    for (size_t i = 0; i < sizeof WRONG / sizeof *WRONG; i++) {
        assert_int_equal(jp_case_set(of, WRONG[i][0], WRONG[i][1], &error), JP_CASE_ERROR_USAGE);
        assert_true(error.text[0] != '\0' && error.status == JP_CASE_ERROR_USAGE);
        // no option stands before the key, for there was none
        assert_null(strstr(error.text, "--set"));
    }
    assert_int_equal(jp_case_set_number(of, "run.backends", 1.0, &error), JP_CASE_ERROR_USAGE);
    assert_int_equal(jp_case_set_number(of, PLAY, NAN, &error), JP_CASE_ERROR_USAGE);
    assert_int_equal(jp_case_setting(of, "drive.sped", &setting, &error), JP_CASE_ERROR_USAGE);
    assert_non_null(strstr(error.text, "did you mean 'drive.speed'?"));
    assert_int_equal(jp_case_setting(of, PLAY, &setting, &error), JP_CASE_OK);
    assert_true(fabs(setting.numbers[0] - 20e-6) < 1e-18);
    // of several, none
    const char *keys[] = {"drive.speed", PLAY};
    const char *values[] = {"900 rpm", "1 kg"};
    assert_int_equal(jp_case_set_all(of, keys, values, 2, &error), JP_CASE_ERROR_USAGE);
    assert_int_equal(jp_case_setting(of, "drive.speed", &setting, &error), JP_CASE_OK);
    assert_true(fabs(setting.numbers[0] - 1000.0 * M_PI / 30.0) < 1e-9);
    jp_case_free(of);
}

static void a_mistake_in_a_text_has_its_place(void **state)
{
    (void)state;
    JpCaseError error;
    char text[sizeof SHORT];
    memcpy(text, SHORT, sizeof SHORT);
    memcpy(strstr(text, "108 mm"), "108 kg", 6);
    assert_null(jp_case_parse(text, strlen(text), "mine.yaml", &error));
    assert_int_equal(error.status, JP_CASE_ERROR_CASE);
    assert_int_equal(error.line, 4);
    assert_int_equal(error.column, 22);
    // also where messages show the name otherwise than it is
    assert_null(jp_case_parse(text, strlen(text), "my\tcase\n", &error));
    assert_int_equal(error.line, 4);
    assert_int_equal(error.column, 22);
    assert_null(jp_case_open("no-such-case", &error));
    assert_int_equal(error.status, JP_CASE_ERROR_FILE);
}

// Tables.

// A name or a number in the place of a star.
static bool is_of_path(const char *name, const char *path)
{
    for (; *path != '\0'; path++) {
        if (*path == '*') {
            name += strcspn(name, ".");
        } else if (*name++ != *path) {
            return false;
        }
    }
    return *name == '\0';
}

static void every_key_is_a_setting_of_a_case(void **state)
{
    (void)state;
    JpCaseError error;
    JpCase *of = open_text(SHORT);
    size_t settings = 0;
    assert_true(jp_key_count() > 200);
    for (size_t i = 0; i < jp_key_count(); i++) {
        JpKey key;
        JpSetting setting;
        assert_int_equal(jp_key_at(i, &key), JP_CASE_OK);
        assert_true(key.path[0] != '\0' && key.doc[0] != '\0');
        if (jp_case_setting(of, key.path, &setting, &error) == JP_CASE_OK) {
            settings++;
            assert_string_equal(setting.doc, key.doc);
        } else if (strncmp(key.path, "expect", 6) != 0 && strncmp(key.path, "signals", 7) != 0) {
            // a limit is no setting, the case has no signal, and there is nothing else
            print_message("%s\n", key.path);
            fail();
        }
    }
    assert_true(settings > 200);
    JpKey beyond;
    assert_int_equal(jp_key_at(jp_key_count(), &beyond), JP_CASE_ERROR_USAGE);
    jp_case_free(of);
}

static void every_setting_takes_its_own_number(void **state)
{
    (void)state;
    JpCaseError error;
    JpCase *of = open_text(SHORT);
    size_t taken = 0;
    for (size_t i = 0; i < jp_case_setting_count(of); i++) {
        JpSetting setting;
        assert_int_equal(jp_case_setting_at(of, i, &setting, &error), JP_CASE_OK);
        JpCase *copy = jp_case_copy(of, &error);
        assert_non_null(copy);
        if (setting.count == 1 && setting.is_used && strchr(setting.key, '*') == NULL &&
            jp_case_set_number(copy, setting.key, setting.numbers[0], &error) == JP_CASE_OK) {
            JpSetting again;
            assert_int_equal(jp_case_setting(copy, setting.key, &again, &error), JP_CASE_OK);
            if (!(fabs(again.numbers[0] - setting.numbers[0]) <=
                  1e-15 * fabs(setting.numbers[0]))) {
                print_message("%s: %.17g, %.17g\n", setting.key, setting.numbers[0],
                              again.numbers[0]);
                fail();
            }
            taken++;
        }
        jp_case_free(copy);
    }
    assert_true(taken > 30);
    jp_case_free(of);
}

// Marks the quantities that are among the numbers of a run.
static void meet(JpAnswer *answer, bool *met)
{
    JpCaseError error;
    const size_t count = jp_answer_number_count(answer, &error);
    for (size_t i = 0; i < jp_quantity_count(); i++) {
        JpQuantity quantity;
        assert_int_equal(jp_quantity_at(i, &quantity), JP_CASE_OK);
        assert_true(quantity.doc[0] != '\0');
        for (size_t k = 0; k < count && !met[i]; k++) {
            JpNumber found;
            assert_int_equal(jp_answer_number_at(answer, k, &found, &error), JP_CASE_OK);
            const bool is_of_run =
                strncmp(found.name, "ode.", 4) == 0 || strncmp(found.name, "reference.", 10) == 0;
            if (is_of_run && is_of_path(strchr(found.name, '.') + 1, quantity.path)) {
                assert_string_equal(found.doc, quantity.doc);
                assert_string_equal(found.unit, quantity.unit);
                met[i] = true;
            }
        }
    }
}

static void every_quantity_is_a_number_of_some_run(void **state)
{
    (void)state;
    // of forces, of a step that is chosen, in space, of torques, of loads
    static const char *const CASES[][7] = {
        {"impact-k66", "run.start", "centred", "run.revolutions", "0.05", "contact.friction",
         "0.1"},
        {"impact-k66", "run.start", "centred", "run.revolutions", "0.02", "space", "spatial"},
        {"compressor", "run.start", "centred", "run.revolutions", "0.02", "run.backends",
         "reference"},
        {"servo-backlash"},
    };
    JpCaseError error;
    const size_t count = jp_quantity_count();
    bool *met = calloc(count, sizeof *met);
    for (size_t i = 0; i < sizeof CASES / sizeof *CASES; i++) {
        JpCase *of = jp_case_open(CASES[i][0], &error);
        assert_non_null(of);
        for (size_t k = 1; k < 7 && CASES[i][k] != NULL; k += 2) {
            assert_int_equal(jp_case_set(of, CASES[i][k], CASES[i][k + 1], &error), JP_CASE_OK);
        }
        if (i == 0) {
            assert_int_equal(jp_case_set(of, "run.step", "auto", &error), JP_CASE_OK);
            assert_int_equal(jp_case_set(of, "run.tolerance", "1e-2", &error), JP_CASE_OK);
        }
        JpRunOptions options = jp_run_options_default();
        options.is_quick = true;
        JpAnswer *answer = run(of, &options);
        meet(answer, met);
        jp_answer_free(answer);
        jp_case_free(of);
    }
    for (size_t i = 0; i < count; i++) {
        JpQuantity quantity;
        assert_int_equal(jp_quantity_at(i, &quantity), JP_CASE_OK);
        if (!met[i]) {
            print_message("%s is no number of any\n", quantity.path);
        }
        assert_true(met[i]);
    }
    free(met);
}

static void a_number_is_the_same_by_itself_and_in_the_list(void **state)
{
    (void)state;
    JpCaseError error;
    JpCase *of = open_text(SHORT);
    JpAnswer *first = run(of, NULL);
    JpAnswer *listed = run(of, NULL);
    const size_t count = jp_answer_number_count(listed, &error);
    assert_true(count > 500);
    for (size_t i = 0; i < count; i++) {
        JpNumber one;
        JpNumber other;
        assert_int_equal(jp_answer_number_at(listed, i, &one, &error), JP_CASE_OK);
        // before anything is listed those of the table are found by themselves
        if (i % 7 == 0) {
            jp_answer_free(first);
            first = run(of, NULL);
        }
        assert_int_equal(jp_answer_number(first, one.name, &other, &error), JP_CASE_OK);
        const bool is_of_time = strstr(one.name, "wall") != NULL ||
                                strstr(one.name, "us_per_step") != NULL ||
                                strstr(one.name, "real_time") != NULL;
        if (!is_of_time && memcmp(&one.value, &other.value, sizeof one.value) != 0 &&
            !(isnan(one.value) && isnan(other.value))) {
            print_message("%s: %.17g, %.17g\n", one.name, one.value, other.value);
            fail();
        }
        assert_string_equal(one.name, other.name);
        assert_string_equal(one.unit, other.unit);
        if (i > 400) {
            break; // the rest are lists
        }
    }
    jp_answer_free(first);
    jp_answer_free(listed);
    jp_case_free(of);
}

static void columns_are_the_series(void **state)
{
    (void)state;
    JpCaseError error;
    JpColumn column;
    JpColumn again;
    JpCase *of = open_text(SHORT);
    JpRunOptions options = jp_run_options_default();
    options.has_ranges = options.has_contacts = true;
    JpAnswer *answer = run(of, &options);
    jp_case_free(of); // an answer needs its case no more
    static const char *const TABLES[] = {"series",     "contacts",     "spikes",
                                         "ode.series", "ode.contacts", "ode.spikes"};
    for (size_t i = 0; i < sizeof TABLES / sizeof *TABLES; i++) {
        const size_t count = jp_answer_column_count(answer, TABLES[i], &error);
        assert_true(count > 5);
        for (size_t k = 0; k < count; k++) {
            assert_int_equal(jp_answer_column_at(answer, TABLES[i], k, &column, &error),
                             JP_CASE_OK);
            assert_true((column.numbers != NULL) != (column.words != NULL));
            assert_int_equal(jp_answer_column(answer, TABLES[i], column.name, &again, &error),
                             JP_CASE_OK);
            assert_ptr_equal(again.numbers, column.numbers);
            assert_ptr_equal(again.words, column.words);
        }
    }
    assert_int_equal(jp_answer_column(answer, "series", "crank_deg", &column, &error), JP_CASE_OK);
    assert_int_equal(column.count, 181);
    assert_true(fabs(column.numbers[180] - 18.0) < 1e-9);
    assert_int_equal(jp_answer_column(answer, "contacts", "force_max_N", &column, &error),
                     JP_CASE_OK);
    double most = 0.0;
    for (size_t i = 0; i < column.count; i++) {
        most = fmax(most, column.numbers[i]);
    }
    assert_true(column.count > 0 && most == number(answer, FORCE));
    assert_int_equal(jp_answer_column(answer, "series", "crank_dg", &column, &error),
                     JP_CASE_ERROR_USAGE);
    assert_non_null(strstr(error.text, "did you mean 'crank_deg'?"));
    assert_int_equal(jp_answer_column(answer, "serie", "crank_deg", &column, &error),
                     JP_CASE_ERROR_USAGE);
    static const char *const FORMS[] = {"screen", "full", "picture"};
    for (size_t i = 0; i < 3; i++) {
        size_t length = 0;
        const char *text = jp_answer_text(answer, FORMS[i], &length, &error);
        assert_non_null(text);
        assert_true(length > 100 && strlen(text) == length);
    }
    assert_null(jp_answer_text(answer, "song", NULL, &error));
    jp_answer_free(answer);
}

static void a_case_is_mapped_and_settled(void **state)
{
    (void)state;
    JpCaseError error;
    JpCase *of = open_text(SHORT);
    JpMapOptions options = jp_map_options_default();
    options.steps = "10 us, 1 us";
    options.maps = "textbook, corrected";
    JpAnswer *map = jp_case_map(of, &options, &error);
    assert_non_null(map);
    assert_true(number(map, "contacts.0.rows.0.step_s") == 10e-6);
    assert_true(number(map, "contacts.0.rows.1.erp") > 0.0);
    assert_int_equal(jp_answer_column_count(map, "series", &error), 0);
    jp_answer_free(map);
    options.at_step = "1 us";
    assert_null(jp_case_map(of, &options, &error));
    assert_int_equal(error.status, JP_CASE_ERROR_USAGE);
    JpAnswer *settled = jp_case_settle(of, NULL, &error);
    assert_non_null(settled);
    assert_non_null(jp_answer_json(settled, NULL, &error));
    jp_answer_free(settled);
    jp_case_free(of);
}

// Hostile calls.

// What a callback does with the case that is run, and with others.
typedef struct Prank {
    JpCase *of;
    int calls;
    int cancel_at; // 0: never
    bool frees;
    int refused;
} Prank;

static int play_pranks(const char *doing, double share, void *context)
{
    Prank *prank = context;
    JpCaseError error;
    JpSetting setting;
    assert_non_null(doing);
    assert_true(share >= 0.0 && share <= 1.0);
    prank->calls++;
    prank->refused += jp_case_set(prank->of, PLAY, "10 um", &error) == JP_CASE_ERROR_USAGE;
    prank->refused += jp_case_run(prank->of, NULL, &error) == NULL;
    prank->refused += jp_case_copy(prank->of, &error) == NULL;
    prank->refused += jp_case_setting(prank->of, PLAY, &setting, &error) == JP_CASE_ERROR_USAGE;
    // another case is as good as ever
    JpCase *other = open_text(SHORT);
    assert_int_equal(jp_case_set(other, PLAY, "10 um", &error), JP_CASE_OK);
    jp_case_free(other);
    if (prank->frees) {
        jp_case_free(prank->of);
    }
    return prank->calls == prank->cancel_at;
}

static JpRunOptions with_pranks(Prank *prank)
{
    JpRunOptions options = jp_run_options_default();
    options.progress = play_pranks;
    options.context = prank;
    return options;
}

static void a_case_that_is_run_is_left_alone(void **state)
{
    (void)state;
    JpCaseError error;
    Prank prank = {.of = open_text(SHORT)};
    assert_int_equal(jp_case_set(prank.of, "run.revolutions", "0.5", &error), JP_CASE_OK);
    JpRunOptions options = with_pranks(&prank);
    JpAnswer *answer = run(prank.of, &options);
    assert_true(prank.calls > 0);
    assert_int_equal(prank.refused, 4 * prank.calls);
    JpAnswer *quiet = run(prank.of, NULL);
    assert_true(number(answer, FORCE) == number(quiet, FORCE));
    jp_answer_free(answer);
    jp_answer_free(quiet);
    // freed in a callback it goes when the run is over
    prank.frees = true;
    jp_answer_free(run(prank.of, &options));
}

static void a_run_is_cancelled(void **state)
{
    (void)state;
    JpCaseError error;
    Prank prank = {.of = open_text(SHORT), .cancel_at = 1};
    JpRunOptions options = with_pranks(&prank);
    assert_int_equal(jp_case_set(prank.of, "run.revolutions", "200", &error), JP_CASE_OK);
    assert_null(jp_case_run(prank.of, &options, &error));
    assert_int_equal(error.status, JP_CASE_ERROR_CANCELLED);
    prank.calls = 0;
    assert_int_equal(jp_case_set(prank.of, "run.start", "settled", &error), JP_CASE_OK);
    assert_null(jp_case_settle(prank.of, &options, &error));
    assert_int_equal(error.status, JP_CASE_ERROR_CANCELLED);
    assert_int_equal(jp_case_set(prank.of, "run.revolutions", NULL, &error), JP_CASE_OK);
    assert_int_equal(jp_case_set(prank.of, "run.start", NULL, &error), JP_CASE_OK);
    jp_answer_free(run(prank.of, NULL));
    jp_case_free(prank.of);
}

static void null_is_an_error_everywhere(void **state)
{
    (void)state;
    JpCaseError error;
    JpSetting setting;
    JpNumber found;
    JpColumn column;
    const char *word;
    const char *keys[] = {NULL};
    JpCase *of = open_text(SHORT);
    JpAnswer *answer = run(of, NULL);
    const int refused = JP_CASE_ERROR_USAGE;
    assert_null(jp_case_open(NULL, &error));
    assert_null(jp_case_open(NULL, NULL));
    assert_null(jp_case_parse(NULL, 3, NULL, &error));
    assert_null(jp_case_parse("", 0, NULL, NULL));
    assert_null(jp_case_copy(NULL, NULL));
    assert_int_equal(jp_case_set(NULL, PLAY, "1 um", &error), refused);
    assert_int_equal(jp_case_set(of, NULL, "1 um", NULL), refused);
    assert_int_equal(jp_case_set(of, PLAY, NULL, NULL), JP_CASE_OK);
    assert_int_equal(jp_case_set_all(of, NULL, NULL, 2, &error), refused);
    assert_int_equal(jp_case_set_all(of, keys, keys, 1, &error), refused);
    assert_int_equal(jp_case_set_number(NULL, PLAY, 1.0, &error), refused);
    assert_int_equal(jp_case_set_number(of, NULL, 1.0, &error), refused);
    assert_int_equal(jp_case_setting_count(NULL), 0);
    assert_int_equal(jp_case_setting_at(of, 0, NULL, &error), refused);
    assert_int_equal(jp_case_setting_at(of, 1u << 30, &setting, &error), refused);
    assert_int_equal(jp_case_setting(of, PLAY, NULL, &error), refused);
    assert_int_equal(jp_case_check(NULL, NULL, NULL, &error), refused);
    assert_int_equal(jp_case_check(of, "nobody", NULL, &error), refused);
    assert_int_equal(jp_case_check(of, "reference", NULL, NULL), JP_CASE_OK);
    assert_null(jp_case_run(NULL, NULL, &error));
    assert_null(jp_case_settle(NULL, NULL, &error));
    assert_null(jp_case_map(NULL, NULL, &error));
    JpRunOptions options = {.size = 0};
    assert_null(jp_case_run(of, &options, &error));
    options = jp_run_options_default();
    options.driver_count = 1;
    const char *none[] = {NULL};
    options.drivers = none;
    assert_null(jp_case_run(of, &options, &error));
    options.drivers = NULL;
    assert_null(jp_case_run(of, &options, &error));
    options.driver_count = 0;
    options.time_limit_s = -1.0;
    assert_null(jp_case_run(of, &options, &error));
    options.time_limit_s = NAN;
    assert_null(jp_case_run(of, &options, &error));
    assert_null(jp_answer_json(NULL, NULL, &error));
    assert_null(jp_answer_text(answer, NULL, NULL, &error));
    assert_int_equal(jp_answer_number(NULL, FORCE, &found, &error), refused);
    assert_int_equal(jp_answer_number(answer, NULL, &found, &error), refused);
    assert_int_equal(jp_answer_number(answer, FORCE, NULL, &error), refused);
    assert_int_equal(jp_answer_number(answer, "status", &found, &error), refused);
    assert_int_equal(jp_answer_number(answer, "", &found, &error), refused);
    assert_int_equal(jp_answer_number_count(NULL, NULL), 0);
    assert_int_equal(jp_answer_number_at(answer, 1u << 30, &found, &error), refused);
    assert_int_equal(jp_answer_number_at(answer, 0, NULL, &error), refused);
    assert_int_equal(jp_answer_word(answer, FORCE, &word, &error), refused);
    assert_int_equal(jp_answer_word(answer, "status", NULL, &error), refused);
    assert_int_equal(jp_answer_word(answer, "status", &word, &error), JP_CASE_OK);
    assert_string_equal(word, "ok");
    assert_int_equal(jp_answer_column_count(NULL, "series", &error), 0);
    assert_int_equal(jp_answer_column_count(answer, NULL, &error), 0);
    assert_int_equal(jp_answer_column_at(answer, "series", 1u << 30, &column, &error), refused);
    assert_int_equal(jp_answer_column_at(answer, "series", 0, NULL, &error), refused);
    assert_int_equal(jp_answer_column(answer, "series", NULL, &column, &error), refused);
    assert_int_equal(jp_key_at(0, NULL), refused);
    assert_int_equal(jp_quantity_at(0, NULL), refused);
    jp_case_free(NULL);
    jp_answer_free(NULL);
    jp_answer_free(answer);
    jp_case_free(of);
}

static void a_run_that_fails_is_no_crash(void **state)
{
    (void)state;
    JpCaseError error;
    JpColumn column;
    const char *word;
    JpCase *of = open_text(SHORT);
    JpRunOptions options = jp_run_options_default();
    options.backends = "ode";
    assert_int_equal(jp_case_set(of, "run.step", "1 s", &error), JP_CASE_ERROR_USAGE);
    assert_int_equal(jp_case_set(of, "run.step", "0.9 ms", &error), JP_CASE_OK);
    assert_int_equal(jp_case_set(of, "contact.stiffness", "1e18 N/m", &error), JP_CASE_OK);
    JpAnswer *answer = jp_case_run(of, &options, &error);
    if (answer != NULL) {
        // it got through: then there is nothing to say
        assert_int_equal(jp_answer_word(answer, "ode.status", &word, &error), JP_CASE_OK);
        jp_answer_free(answer);
    } else {
        assert_int_equal(error.status, JP_CASE_ERROR_SOLVER);
    }
    options.backends = "reference, mujoco=";
    assert_null(jp_case_run(of, &options, &error));
    options.backends = "";
    assert_null(jp_case_run(of, &options, &error));
    (void)column;
    jp_case_free(of);
}

// Several at once.

enum { THREADS = 8 };

typedef struct Part {
    int index;
    char *json;
} Part;

// What comes out of a run, but for how long it took.
static char *without_times(const char *json)
{
    char *kept = calloc(1, strlen(json) + 1);
    size_t length = 0;
    while (*json != '\0') {
        const size_t size = strcspn(json, "\n") + 1;
        char line[512] = "";
        snprintf(line, sizeof line, "%.*s", (int)(size < sizeof line ? size : sizeof line - 1),
                 json);
        if (strstr(line, "\"wall_s\"") == NULL && strstr(line, "\"us_per_step\"") == NULL &&
            strstr(line, "\"real_time_factor\"") == NULL) {
            memcpy(kept + length, json, size);
            length += size;
        }
        json += json[size - 1] == '\0' ? size - 1 : size;
    }
    return kept;
}

static void *run_part(void *context)
{
    Part *part = context;
    JpCaseError error;
    char play[32];
    JpCase *of = jp_case_parse(SHORT, strlen(SHORT), "mine.yaml", &error);
    snprintf(play, sizeof play, "%d um", 10 + part->index);
    JpRunOptions options = jp_run_options_default();
    options.threads = 1 + (size_t)part->index % 2;
    if (of != NULL && jp_case_set(of, PLAY, play, &error) == JP_CASE_OK &&
        (part->index != 3 || jp_case_set(of, "ode.solver", "quick", &error) == JP_CASE_OK)) {
        JpAnswer *answer = jp_case_run(of, &options, &error);
        const char *json = answer != NULL ? jp_answer_json(answer, NULL, &error) : NULL;
        part->json = json != NULL ? without_times(json) : NULL;
        jp_answer_free(answer);
    }
    jp_case_free(of);
    return NULL;
}

static void eight_threads_are_one_after_the_other(void **state)
{
    (void)state;
    Part alone[THREADS];
    Part beside[THREADS];
    pthread_t threads[THREADS];
    for (int i = 0; i < THREADS; i++) {
        beside[i] = (Part){.index = i};
        assert_int_equal(pthread_create(&threads[i], NULL, run_part, &beside[i]), 0);
    }
    for (int i = 0; i < THREADS; i++) {
        pthread_join(threads[i], NULL);
    }
    for (int i = 0; i < THREADS; i++) {
        alone[i] = (Part){.index = i};
        run_part(&alone[i]);
        assert_non_null(alone[i].json);
        assert_non_null(beside[i].json);
        assert_string_equal(alone[i].json, beside[i].json);
        // the control: another play is another answer
        assert_true(i == 0 || strcmp(alone[i].json, alone[0].json) != 0);
    }
    for (int i = 0; i < THREADS; i++) {
        free(alone[i].json);
        free(beside[i].json);
    }
}

// A sanitizer has a malloc of its own, and says itself at the end what was left.
#if defined(__SANITIZE_ADDRESS__)
#define HAS_OWN_MALLOC 1
#elif defined(__has_feature)
#if __has_feature(address_sanitizer)
#define HAS_OWN_MALLOC 1
#endif
#endif
#ifdef HAS_OWN_MALLOC
static const bool IS_COUNTED = false;
#else
static const bool IS_COUNTED = true;
#endif

static size_t taken(void)
{
    malloc_trim(0);
    const struct mallinfo2 info = mallinfo2();
    return info.uordblks + info.hblkhd;
}

static void a_thousand_cases_leave_nothing(void **state)
{
    (void)state;
    JpCaseError error;
    JpSetting setting;
    size_t before = 0;
    const size_t count = sample_size(1000);
    for (size_t i = 0; i < count; i++) {
        JpCase *of = open_text(SHORT);
        assert_int_equal(jp_case_set(of, PLAY, i % 2 == 0 ? "20 um" : "21 um", &error), JP_CASE_OK);
        assert_int_equal(jp_case_set(of, PLAY, "21 lm", &error), JP_CASE_ERROR_USAGE);
        assert_int_equal(jp_case_setting(of, PLAY, &setting, &error), JP_CASE_OK);
        if (i % (count / 5) == 0) {
            JpAnswer *answer = run(of, NULL);
            assert_true(jp_answer_number_count(answer, &error) > 0);
            assert_non_null(jp_answer_json(answer, NULL, &error));
            assert_true(jp_answer_column_count(answer, "series", &error) > 0);
            jp_answer_free(answer);
        }
        jp_case_free(of);
        if (i == count / 5) {
            before = taken();
        }
    }
    // valgrind's malloc counts nothing, and has its own list of what is left
    const bool is_counted = IS_COUNTED && before > 0;
    assert_true(!is_counted || taken() < before + 16384);
    size_t bytes;
    assert_int_equal(jp_case_lost(&bytes), 0);
    assert_int_equal(bytes, 0);
    // the control: one case that is kept is seen
    JpCase *kept = open_text(SHORT);
    assert_true(!is_counted || taken() > before + 16384);
    jp_case_free(kept);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_setting_reads_back_in_si),
        cmocka_unit_test(a_signal_reads_back_as_it_was_set),
        cmocka_unit_test(a_setting_that_is_wrong_says_why_and_changes_nothing),
        cmocka_unit_test(a_mistake_in_a_text_has_its_place),
        cmocka_unit_test(every_key_is_a_setting_of_a_case),
        cmocka_unit_test(every_setting_takes_its_own_number),
        cmocka_unit_test(every_quantity_is_a_number_of_some_run),
        cmocka_unit_test(a_number_is_the_same_by_itself_and_in_the_list),
        cmocka_unit_test(columns_are_the_series),
        cmocka_unit_test(a_case_is_mapped_and_settled),
        cmocka_unit_test(a_case_that_is_run_is_left_alone),
        cmocka_unit_test(a_run_is_cancelled),
        cmocka_unit_test(null_is_an_error_everywhere),
        cmocka_unit_test(a_run_that_fails_is_no_crash),
        cmocka_unit_test(eight_threads_are_one_after_the_other),
        cmocka_unit_test(a_thousand_cases_leave_nothing),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
