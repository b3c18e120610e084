// Does docs/output.md list every key of the JSON that each command prints, and every column of the
// tables that it writes?
//
// A key is listed if a code span in the command's section of the page has it as a whole word. Keys
// that are names of the case (bodies, joints, settings) are not looked for. Each command has a
// control: with one of its keys erased from the page, that key is found missing, and no other.
#include "program.h"

#include <ctype.h>

enum { PAGE_SIZE = 1 << 17, KEY_SIZE = 64, MISSING_SIZE = 4096 };

// objects whose keys are names, not words of the format
static const char *const NAMED[] = {"bodies", "joints", "reactions",  "corner",
                                    "alone",  "keys",   "spike_match"};

// objects that are those of a run, which has their keys
static const char *const SHARED[] = {"error", "ensemble", "truth"};

// objects whose contents are the user's own
static const char *const FREE[] = {"settings", "setting_units"};

static bool is_among(const char *const *words, size_t count, const char *word)
{
    for (size_t i = 0; i < count; i++) {
        if (word != NULL && strcmp(words[i], word) == 0) {
            return true;
        }
    }
    return false;
}

// The page, and where the command's part of it begins and ends.
typedef struct Section {
    char *begin;
    char *end;
} Section;

static Section find_section(char *page, const char *command)
{
    char heading[KEY_SIZE];
    snprintf(heading, sizeof heading, "# What `jointplay %s` writes\n", command);
    Section section = {.begin = strstr(page, heading)};
    assert_non_null(section.begin);
    char *next = strstr(section.begin, "\n# ");
    section.end = next == NULL ? section.begin + strlen(section.begin) : next;
    return section;
}

static bool is_word_part(char letter)
{
    return isalnum((unsigned char)letter) || letter == '_';
}

// The first place at which a code span has the key as a whole word; NULL where none does.
static char *find_key(Section section, const char *key)
{
    const size_t length = strlen(key);
    bool is_code = false;
    for (char *at = section.begin; at < section.end; at++) {
        is_code = *at == '`' ? !is_code : is_code;
        if (is_code && strncmp(at, key, length) == 0 && !is_word_part(at[-1]) &&
            !is_word_part(at[length])) {
            return at;
        }
    }
    return NULL;
}

// What the page lacks: each key once, with a blank behind it.
typedef struct Missing {
    Section section;
    Section of_run;   // where objects are described that other commands share with it
    size_t key_count; // keys looked for
    char keys[MISSING_SIZE];
} Missing;

static void note_key(Missing *missing, const char *key, bool is_listed)
{
    char word[KEY_SIZE + 2];
    snprintf(word, sizeof word, " %s ", key);
    missing->key_count++;
    if (!is_listed && strstr(missing->keys, word) == NULL) {
        const size_t length = strlen(missing->keys);
        snprintf(missing->keys + length, MISSING_SIZE - length, "%s%s ", length == 0 ? " " : "",
                 key);
    }
}

// Looks for the keys of an object and of all within it; name is the key under which it stands.
static void look_for_keys(Missing *missing, json_t *value, const char *name, bool is_shared)
{
    size_t index = 0;
    const char *key = NULL;
    json_t *child = NULL;
    json_array_foreach(value, index, child)
    {
        look_for_keys(missing, child, NULL, is_shared);
    }
    const bool has_names = is_among(NAMED, sizeof NAMED / sizeof *NAMED, name);
    json_object_foreach(value, key, child)
    {
        if (!has_names) {
            note_key(missing, key,
                     find_key(missing->section, key) != NULL ||
                         (is_shared && find_key(missing->of_run, key) != NULL));
        }
        if (!is_among(FREE, sizeof FREE / sizeof *FREE, key)) {
            look_for_keys(missing, child, has_names ? NULL : key,
                          is_shared || is_among(SHARED, sizeof SHARED / sizeof *SHARED, key));
        }
    }
}

static void assert_listed(const Missing *missing, const char *command)
{
    if (missing->keys[0] != '\0') {
        fail_msg("docs/output.md lacks these in its part on `jointplay %s`:%s", command,
                 missing->keys);
    }
}

// Keys shared by all commands are listed once, as those of a run.
static void look_for_tool(json_t *root, char *page)
{
    Missing missing = {.section = find_section(page, "run")};
    look_for_keys(&missing, json_object_get(root, "tool"), NULL, false);
    assert_listed(&missing, "run");
}

// Erases a key from every code span of a section.
static void erase_key(Section section, const char *key)
{
    for (char *at; (at = find_key(section, key)) != NULL;) {
        memset(at, '#', strlen(key));
    }
}

static void read_page(char page[PAGE_SIZE])
{
    FILE *stream = fopen(getenv("JOINTPLAY_PAGE"), "r");
    assert_non_null(stream);
    const size_t length = fread(page, 1, PAGE_SIZE - 1, stream);
    assert_in_range(length, 1, PAGE_SIZE - 2);
    page[length] = '\0';
    fclose(stream);
}

// Runs one command and holds its JSON against its section; then the control, with one key erased.
static void check_keys(void **state, const char *command, const char *words, const char *erased)
{
    static char page[PAGE_SIZE];
    Program *program = *state;
    read_page(page);
    program_run(program, words);
    json_t *root = json_loads(program->output, 0, NULL);
    if (root == NULL) {
        print_error("%s: no JSON, status %d:\n%s\n", words, program->status, program->errors);
    }
    assert_non_null(root);
    look_for_tool(root, page);
    json_object_clear(json_object_get(root, "tool"));

    Missing missing = {.section = find_section(page, command), .of_run = find_section(page, "run")};
    look_for_keys(&missing, root, NULL, false);
    assert_listed(&missing, command);
    assert_true(missing.key_count > 10);

    Missing control = {.section = missing.section, .of_run = missing.of_run};
    char only[KEY_SIZE + 2];
    snprintf(only, sizeof only, " %s ", erased);
    erase_key(control.section, erased);
    look_for_keys(&control, root, NULL, false);
    assert_string_equal(control.keys, only);
    json_decref(root);
}

// Whole, or behind the name of a body or joint (`<body>_omega_rad_s`), or in two parts (`asked_`
// and `restitution`).
static bool is_column_listed(Section section, const char *column)
{
    const char *rest = strchr(column, '_');
    char first[KEY_SIZE];
    if (find_key(section, column) != NULL || rest == NULL) {
        return find_key(section, column) != NULL;
    }
    snprintf(first, sizeof first, "%.*s", (int)(rest + 1 - column), column);
    return find_key(section, rest) != NULL ||
           (find_key(section, first) != NULL && find_key(section, rest + 1) != NULL);
}

static void look_for_columns(Missing *missing, const char *head)
{
    while (*head != '\0' && *head != '\n') {
        const size_t length = strcspn(head, ",\n");
        char column[KEY_SIZE];
        assert_in_range(length, 1, KEY_SIZE - 1);
        snprintf(column, sizeof column, "%.*s", (int)length, head);
        note_key(missing, column, is_column_listed(missing->section, column));
        head += length;
        head += *head == ',' ? 1 : 0;
    }
}

// The same for the columns of the table that a command writes as table.csv.
static void check_columns(void **state, const char *command, const char *words, const char *erased,
                          const char *lost)
{
    static char page[PAGE_SIZE];
    static char table[PROGRAM_OUTPUT_SIZE];
    char path[PROGRAM_PATH_SIZE];
    Program *program = *state;
    read_page(page);
    program_run(program, words);
    assert_int_equal(program->status, 0);
    program_path(program, "table.csv", path);
    program_read(path, table);

    Missing missing = {.section = find_section(page, command)};
    look_for_columns(&missing, table);
    assert_listed(&missing, command);
    assert_true(missing.key_count > 7);

    Missing control = {.section = missing.section};
    erase_key(control.section, erased);
    look_for_columns(&control, table);
    assert_string_equal(control.keys, lost);
}

#define FIRST_CONTACTS "\"$cases\"/paper/impact-k66.yaml --set run.revolutions=0.02"

static void every_key_of_run_is_listed(void **state)
{
    check_keys(state, "run", "run -q --json " FIRST_CONTACTS, "transmission_angle_min_rad");
    // beyond the horizon: ensembles
    check_keys(state, "run",
               "run -q --json \"$cases\"/literature/four-bar-half-mm.yaml --step '4 us' "
               "--set run.revolutions=0.18",
               "deviation");
    // torques and angles at the stops of a pivot
    check_keys(state, "run",
               "run -q --json --backend reference \"$cases\"/mechanisms/stop-rebound.yaml "
               "--set 'run.duration=0.2 s'",
               "coordinate_max_rad");
    check_keys(state, "run",
               "run -q --json --backend reference \"$cases\"/mechanisms/gear-pair.yaml "
               "--set 'run.duration=5 ms'",
               "coordinate_max_m");
    // a slider with ideal joints, and a block between guides
    check_keys(state, "run",
               "run -q --json \"$cases\"/mechanisms/slider-crank.yaml "
               "--set run.backends=analytic",
               "slider_velocity_max_crank_deg");
    check_keys(state, "run",
               "run -q --json --backend reference \"$cases\"/mechanisms/slider-crank-guide.yaml "
               "--set 'run.duration=3 ms'",
               "tilt_limit_rad");
}

static void every_key_of_compare_is_listed(void **state)
{
    check_keys(state, "compare",
               "compare -q --json \"$cases\"/literature/pin-in-hole-drop.yaml --store kept "
               "--steps '20 us, 10 us, 5 us' --set 'run.duration=10 ms'",
               "on_frontier");
}

static void every_key_of_map_is_listed(void **state)
{
    check_keys(state, "map", "map -q --json " FIRST_CONTACTS " --steps '1 us' --penalty",
               "penalty_cfm_m_N_s");
    check_keys(state, "map", "map -q --json " FIRST_CONTACTS " --at-step '1 ms'", "flight_m");
    // torques and angles at the stops of a pivot
    check_keys(state, "map",
               "map -q --json \"$cases\"/mechanisms/stop-rebound.yaml --at-step '1 ms'",
               "cfm_rad_N_m_s");
    check_keys(state, "map", "map -q --json --erp 0.5 --cfm 1e-3 --step '1 us' --mass '0.1 kg'",
               "damping_ratio");
}

static void every_key_of_tune_is_listed(void **state)
{
    check_keys(state, "tune", "tune -q --json --error 1e-2 " FIRST_CONTACTS, "inverse_mass_1_kg");
    check_keys(state, "tune", "tune -q --json --at-step '100 us' " FIRST_CONTACTS, "is_row");
}

static void every_key_of_check_is_listed(void **state)
{
    check_keys(state, "check",
               "check -q --quick --json --baselines \"$cases\"/../results/baseline "
               "\"$cases\"/paper/ideal-nominal.yaml",
               "bands_off");
}

static void every_key_of_study_is_listed(void **state)
{
    char path[PROGRAM_PATH_SIZE];
    program_path(*state, "some.yaml", path);
    FILE *stream = fopen(path, "w");
    assert_non_null(stream);
    fprintf(stream,
            "case: %s/paper/impact-k66.yaml\n"
            "set: {run.revolutions: 0.01}\n"
            "vary: {run.step: [4 us, 2 us]}\n",
            getenv("JOINTPLAY_CASES"));
    fclose(stream);
    check_keys(state, "study", "study -q --json some.yaml", "inside_share");
}

static void every_key_of_paper_is_listed(void **state)
{
    check_keys(state, "paper", "paper -q --json", "contact_half_angle_rad");
}

static void every_column_of_a_table_is_listed(void **state)
{
    check_columns(state, "run",
                  "run -q --backend reference --series table.csv "
                  "\"$cases\"/literature/pin-in-hole-drop.yaml --set 'run.duration=1 ms'",
                  "_gap_max_m", " hole_gap_max_m ");
    check_columns(state, "run",
                  "run -q --backend reference --series table.csv "
                  "\"$cases\"/mechanisms/slider-crank-guide.yaml --set 'run.duration=1 ms'",
                  "_moment_N_m", " slider-guide_moment_N_m ");
    // what a linkage in space has more than one in the plane
    check_columns(state, "run",
                  "run -q --backend reference --series table.csv "
                  "\"$cases\"/space/overhung-pin.yaml --set 'run.duration=1 ms'",
                  "_axial_force_N", " hole_axial_force_N ");
    check_columns(state, "run",
                  "run -q --backend reference --contacts table.csv "
                  "\"$cases\"/mechanisms/slider-crank-pin.yaml --set 'run.revolutions=0.05'",
                  "onset_crank_deg", " onset_crank_deg ");
    check_columns(state, "run",
                  "run -q --backend reference --contacts table.csv "
                  "\"$cases\"/mechanisms/stop-rebound.yaml --set 'run.duration=0.2 s'",
                  "impulse_N_m_s", " impulse_N_m_s ");
    check_columns(state, "map", "map -q --csv table.csv --steps '1 us' " FIRST_CONTACTS,
                  "longest_valid_step_s", " longest_valid_step_s ");
    check_columns(state, "compare",
                  "compare -q --csv table.csv --store kept --steps '20 us, 10 us' "
                  "\"$cases\"/literature/pin-in-hole-drop.yaml --set 'run.duration=10 ms'",
                  "wall_min_s", " wall_min_s ");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(every_key_of_run_is_listed, program_set_up,
                                        program_tear_down),
        cmocka_unit_test_setup_teardown(every_key_of_compare_is_listed, program_set_up,
                                        program_tear_down),
        cmocka_unit_test_setup_teardown(every_key_of_map_is_listed, program_set_up,
                                        program_tear_down),
        cmocka_unit_test_setup_teardown(every_key_of_tune_is_listed, program_set_up,
                                        program_tear_down),
        cmocka_unit_test_setup_teardown(every_key_of_check_is_listed, program_set_up,
                                        program_tear_down),
        cmocka_unit_test_setup_teardown(every_key_of_study_is_listed, program_set_up,
                                        program_tear_down),
        cmocka_unit_test_setup_teardown(every_key_of_paper_is_listed, program_set_up,
                                        program_tear_down),
        cmocka_unit_test_setup_teardown(every_column_of_a_table_is_listed, program_set_up,
                                        program_tear_down),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
