// Does `jointplay map` answer for every law that it is asked about, also where one of them ends?
//
// A logarithmic law holds to a depth, and steps that are too long take the pin past it. There the
// law has no force, and a prediction that went on had none either but NaN.
#include "program.h"

#include "model/options.h"

#include <stdbool.h>

// what --laws all stands for
#define ALL_LAWS (OPTIONS_LAWS + LAW_AUTO + 1)
enum { ALL_LAWS_COUNT = LAW_COUNT - 1 };

// of the table, see docs/output.md
enum { CELL_LAW = 1, CELL_PREDICTED = 16, CELL_VERDICT = 24, CELL_MESSAGE = 26, CELL_COUNT = 27 };

// Cuts a row into its cells; the last one is the message, which may have commas.
static void cut_row(char *row, const char *cells[CELL_COUNT])
{
    for (size_t i = 0; i < CELL_COUNT; i++) {
        cells[i] = row;
        if (i < CELL_MESSAGE) {
            row = strchr(row, ',');
            assert_non_null(row);
            *row++ = '\0';
        }
    }
}

// A prediction has all its numbers, or says that the pin goes past the end and has none. Returns
// whether it does.
static bool check_prediction(const char *cells[CELL_COUNT])
{
    const bool is_past_end = strcmp(cells[CELL_VERDICT], "past-end") == 0;
    for (size_t i = 0; i < 4; i++) {
        const char *cell = cells[CELL_PREDICTED + i];
        assert_true(is_past_end ? *cell == '\0' : strtod(cell, NULL) > 0.0);
    }
    return is_past_end;
}

static const char EVERY[] = "every law";

typedef struct Question {
    const char *words;
    const char *const *laws;
    size_t law_count;
    size_t row_count;    // of a law: its maps and steps
    const char *reaches; // the law past whose end some of the steps take the pin; EVERY of all laws
} Question;

// Each law has its part of the text, which says whether the pin goes past its end, and its rows in
// the table.
static void check_answer(Program *program, const Question *question)
{
    static char table[PROGRAM_OUTPUT_SIZE];
    char path[PROGRAM_PATH_SIZE];
    size_t rows[ALL_LAWS_COUNT] = {0};
    size_t past_end[ALL_LAWS_COUNT] = {0};
    program_path(program, "rows.csv", path);
    program_read(path, table);
    char *rest = NULL;
    strtok_r(table, "\n", &rest); // the head
    for (char *row; (row = strtok_r(NULL, "\n", &rest)) != NULL;) {
        const char *cells[CELL_COUNT];
        size_t law = 0;
        cut_row(row, cells);
        while (law < question->law_count && strcmp(question->laws[law], cells[CELL_LAW]) != 0) {
            law++;
        }
        assert_true(law < question->law_count);
        rows[law]++;
        past_end[law] += check_prediction(cells) ? 1 : 0;
    }
    for (size_t i = 0; i < question->law_count; i++) {
        const bool is_reached =
            question->reaches == EVERY || strcmp(question->reaches, question->laws[i]) == 0;
        char heading[128];
        snprintf(heading, sizeof heading, "\ncrank-coupler, %s\n", question->laws[i]);
        const char *part = strstr(program->output, heading);
        assert_non_null(part);
        const char *next = strstr(part + 1, "\ncrank-coupler, ");
        const char *said = strstr(part, " past-end\n");
        const bool is_said = said != NULL && (next == NULL || said < next);
        assert_int_equal(is_said, is_reached);
        assert_int_equal(rows[i], question->row_count);
        assert_int_equal(past_end[i] > 0, is_reached);
        // map impulse has no steps within a contact, and holds
        assert_true(past_end[i] < rows[i]);
    }
}

// What once ended in an assertion: steps that take the pin past the end of a law.
static void every_law_asked_for_has_its_rows(void **state)
{
    Program *program = *state;
    static const char *const JOHNSON[] = {"johnson"};
    static const char *const ESDU[] = {"esdu-78035"};
    static const Question QUESTIONS[] = {
        {"stackup-impact.yaml --laws all --set 'drive.speed=3000 rpm'", ALL_LAWS, ALL_LAWS_COUNT,
         6 * ODE_MAP_COUNT, "johnson"},
        {"impact-k66.yaml --laws johnson --steps '100 us'", JOHNSON, 1, ODE_MAP_COUNT, "johnson"},
        {"impact-k66.yaml --steps '1 ms, 10 us' --set contact.law=esdu-78035", ESDU, 1,
         2 * ODE_MAP_COUNT, "esdu-78035"},
        {"impact-k66.yaml --steps '1 s' --laws all", ALL_LAWS, ALL_LAWS_COUNT, ODE_MAP_COUNT,
         EVERY},
    };
    for (size_t i = 0; i < sizeof QUESTIONS / sizeof *QUESTIONS; i++) {
        char words[PROGRAM_PATH_SIZE];
        snprintf(words, sizeof words,
                 "map --full -q --csv rows.csv --set run.start=centred "
                 "--set contact.resting-speed=none $cases/paper/%s",
                 QUESTIONS[i].words);
        program_run(program, words);
        assert_int_equal(program->status, 0);
        check_answer(program, &QUESTIONS[i]);
    }
}

static const char *word(const json_t *object, const char *key)
{
    return json_string_value(json_object_get(object, key));
}

// A law that has no such impact at all is said to.
static void a_law_that_ends_hides_no_other(void **state)
{
    Program *program = *state;
    program_run(program, "map $cases/paper/impact-k66.yaml -q --laws all --step '1 us' "
                         "--mass '5 kg' --speed '2 m/s' --maps corrected --json");
    assert_int_equal(program->status, 0);
    json_t *root = program_json(program);
    const json_t *contacts = json_object_get(root, "contacts");
    assert_int_equal(json_array_size(contacts), ALL_LAWS_COUNT);
    size_t mapped = 0;
    for (size_t i = 0; i < ALL_LAWS_COUNT; i++) {
        const json_t *contact = json_array_get(contacts, i);
        const bool is_mapped = strcmp(word(contact, "status"), "ok") == 0;
        mapped += is_mapped ? 1 : 0;
        assert_string_equal(word(contact, "law"), ALL_LAWS[i]);
        assert_int_equal(json_array_size(json_object_get(contact, "rows")), is_mapped ? 1 : 0);
        if (!is_mapped) {
            assert_says(word(contact, "message"), "goes past the end of the law");
        }
    }
    assert_true(mapped >= 3 && mapped < ALL_LAWS_COUNT);
    json_decref(root);
    // where no law has it, there is nothing to map
    program_run(program, "map $cases/paper/impact-k66.yaml -q --laws johnson --mass '200 kg' "
                         "--speed '9 m/s'");
    assert_int_equal(program->status, 4);
    assert_says(program->errors, "goes past the end of the law johnson");
    assert_string_equal(program->output, "");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(every_law_asked_for_has_its_rows, program_set_up,
                                        program_tear_down),
        cmocka_unit_test_setup_teardown(a_law_that_ends_hides_no_other, program_set_up,
                                        program_tear_down),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
