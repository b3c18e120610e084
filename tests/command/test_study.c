// Does `jointplay study` say, write and refuse what it should?
#include "program.h"

#include <math.h>

// Two speeds, and the steps; a revolution takes 120 and 40 ms, which no step may be longer than.
static void write_study(const Program *program, const char *name, const char *steps,
                        const char *truth)
{
    char path[PROGRAM_PATH_SIZE];
    program_path(program, name, path);
    FILE *stream = fopen(path, "w");
    assert_non_null(stream);
    fprintf(stream,
            "title: Four runs\ncase: %s/paper/ideal-nominal.yaml\nset: {run.samples: 36}\n"
            "vary:\n  drive.speed: [500 rpm, 1500 rpm]\n  run.step: [%s]\ntruth: %s\n",
            getenv("JOINTPLAY_CASES"), steps, truth);
    fclose(stream);
}

static void run_well(Program *program, const char *words)
{
    program_run(program, words);
    if (program->status != 0) {
        fail_msg("%s: status %d: %s", words, program->status, program->errors);
    }
}

static int set_up(void **state)
{
    const int status = program_set_up(state);
    write_study(*state, "s.yaml", "50 us, 100 us", "true");
    return status;
}

static void a_dry_run_tells_all_and_writes_nothing(void **state)
{
    Program *program = *state;
    run_well(program, "study s.yaml --dry-run");
    assert_says(program->output, "2 variables, 4 runs, 2 truths");
    assert_says(program->output, "drive_speed_rad_s");
    assert_says(program->output, "of them no valid case: 0.");
    assert_says(program->output, "It would take some ");
    assert_says(program->output, ", by the first ");
    run_well(program, "study s.yaml --dry-run --shard 2/2");
    assert_says(program->output, "4 runs, 2 of them in part 2 of 2");
    char path[PROGRAM_PATH_SIZE];
    program_path(program, "s.sqlite", path);
    assert_int_not_equal(access(path, F_OK), 0);
    write_study(program, "long.yaml", "50 us, 200 ms", "true");
    run_well(program, "study long.yaml --dry-run");
    assert_says(program->output, "of them no valid case: 2; the first is run 1: ");
}

// Whether a study of friction at 0 and at another value says that its friction speed has no use.
static bool says_unused(Program *program, const char *vary)
{
    char path[PROGRAM_PATH_SIZE];
    program_path(program, "friction.yaml", path);
    FILE *stream = fopen(path, "w");
    assert_non_null(stream);
    fprintf(stream,
            "title: Friction\ncase: %s/paper/impact-k66.yaml\n"
            "set: {run.revolutions: 0.01, contact.friction-speed: 1 mm/s}\n"
            "vary: {%s}\ntruth: false\n",
            getenv("JOINTPLAY_CASES"), vary);
    fclose(stream);
    run_well(program, "study friction.yaml --dry-run");
    return strstr(program->errors, "contact.friction-speed of the study has no effect in any run; "
                                   "it would with a friction above 0") != NULL;
}

static void a_key_that_no_run_uses_is_said(void **state)
{
    Program *program = *state;
    assert_true(says_unused(program, "run.step: [1 us, 2 us]"));
    // one run of two makes use of it
    assert_false(says_unused(program, "contact.friction: [0, 0.1]"));
}

static void what_came_of_it_is_printed(void **state)
{
    Program *program = *state;
    run_well(program, "study s.yaml --jobs 2");
    assert_says(program->output, "4 of 4 runs are over");
    assert_says(program->output, "They are kept in s.sqlite.");
    assert_says(program->output, "error_max");
    assert_string_equal(program->errors, "");
    run_well(program, "study s.yaml --json");
    json_t *root = program_json(program);
    assert_int_equal(json_integer_value(json_object_get(root, "runs")), 4);
    assert_int_equal(json_integer_value(json_object_get(root, "done")), 4);
    assert_true(json_is_null(json_object_get(json_object_get(root, "now"), "inside_share")));
    json_decref(root);
    run_well(program, "study s.yaml --retry-failed");
    assert_says(program->errors, "making 0 failed or damaged runs again");
}

// Reads a file of the program's folder.
static void read_file(const Program *program, const char *name, char *content, size_t size)
{
    char path[PROGRAM_PATH_SIZE];
    program_path(program, name, path);
    FILE *stream = fopen(path, "r");
    assert_non_null(stream);
    content[fread(content, 1, size - 1, stream)] = '\0';
    fclose(stream);
}

// Where the dots of the three runs of a study of steps stand in its picture.
static void draw_steps(Program *program, const char *steps, const char *store, double places[3],
                       char *svg, size_t size)
{
    char path[PROGRAM_PATH_SIZE];
    char words[PROGRAM_PATH_SIZE];
    program_path(program, "steps.yaml", path);
    FILE *stream = fopen(path, "w");
    assert_non_null(stream);
    fprintf(stream,
            "title: Steps\ncase: %s/paper/ideal-nominal.yaml\nset: {run.samples: 36}\n"
            "vary: {run.step: %s}\ntruth: false\n",
            getenv("JOINTPLAY_CASES"), steps);
    fclose(stream);
    run_well(program, "study steps.yaml --fresh -q");
    snprintf(words, sizeof words, "study plot %s --x run_step_s --y steps p.svg -q", store);
    run_well(program, words);
    read_file(program, "p.svg", svg, size);
    size_t count = 0;
    for (const char *c = svg; (c = strstr(c, "<circle cx=\"")) != NULL; c++) {
        assert_true(count < 3);
        places[count++] = strtod(c + strlen("<circle cx=\""), NULL);
    }
    assert_int_equal(count, 3);
}

static void a_picture_has_the_units_and_scales_of_its_study(void **state)
{
    Program *program = *state;
    static char svg[1 << 16];
    double at[3];
    // half a decade apart each, a span that no axis would be logarithmic for by itself
    draw_steps(program, "{from: 20 us, to: 80 us, count: 3, scale: log}", "steps.yaml", at, svg,
               sizeof svg);
    assert_says(svg, ">step, us<");
    assert_says(svg, ">steps of the solver<");
    assert_says(svg, ">Steps<");
    assert_true(fabs((at[2] - at[1]) - (at[1] - at[0])) < 0.2);
    // the controls: an even scale, on which 20, 40 and 80 are not evenly apart, and a store alone,
    // which has other words
    draw_steps(program, "[20 us, 40 us, 80 us]", "steps.yaml", at, svg, sizeof svg);
    assert_true(fabs((at[2] - at[1]) - 2.0 * (at[1] - at[0])) < 0.2);
    draw_steps(program, "{from: 20 us, to: 80 us, count: 3, scale: log}", "steps.sqlite", at, svg,
               sizeof svg);
    // with a prefix, for it is small in SI
    assert_says(svg, ">run step, us<");
    assert_true(fabs((at[2] - at[1]) - 2.0 * (at[1] - at[0])) < 0.2);
}

static void rows_are_exported_and_drawn(void **state)
{
    Program *program = *state;
    run_well(program, "study s.yaml");
    run_well(program, "study export s.sqlite");
    assert_int_equal(
        strncmp(program->output, "run,drive_speed_rad_s,run_step_s,outcome,reason,", 45), 0);
    run_well(program, "study export s.yaml --csv a.csv --jsonl a.jsonl");
    assert_string_equal(program->output, "");
    assert_says(program->errors, "wrote a.csv");
    assert_says(program->errors, "wrote a.jsonl");
    run_well(program, "study plot s.yaml --x run_step_s --y error_max --by drive_speed_rad_s "
                      "a.svg --title Words -q");
    assert_string_equal(program->errors, "");
    program_run(program, "study plot s.yaml --x nothing a.svg");
    assert_int_equal(program->status, 2);
    run_well(program, "study status s.yaml s.sqlite");
    assert_says(program->output, "4 of 4 runs are over");
}

// Every command finds the store beside the study file from another folder, and says where it is.
static void a_store_beside_its_study_is_found_from_elsewhere(void **state)
{
    Program *program = *state;
    char words[2 * PROGRAM_PATH_SIZE];
    run_well(program, "study s.yaml");
    snprintf(words, sizeof words, "mkdir '%s/b'", program->folder);
    assert_int_equal(system(words), 0);
    strcat(program->folder, "/b");
    run_well(program, "study status ../s.yaml");
    assert_says(program->output, "4 of 4 runs are over");
    assert_says(program->output, "Store ../s.sqlite");
    run_well(program, "study ../s.yaml");
    assert_says(program->output, "Nothing was left to run; the runs are kept in ../s.sqlite.");
    run_well(program, "study export ../s.yaml --csv a.csv");
    run_well(program, "study plot ../s.yaml --x run_step_s --y error_max a.svg");
    // what is not there was looked for in both folders
    snprintf(words, sizeof words, "cp '%s/../s.yaml' '%s/../t.yaml'", program->folder,
             program->folder);
    assert_int_equal(system(words), 0);
    run_well(program, "study status ../t.yaml");
    assert_says(program->output, "There is no t.sqlite in the working folder or in ../.");
    program_run(program, "study export ../t.yaml");
    assert_int_equal(program->status, 5);
    assert_says(program->errors, "there is no t.sqlite in the working folder or in ../");
    *strrchr(program->folder, '/') = '\0';
}

static void a_study_of_which_every_run_fails_ends_with_status_4(void **state)
{
    Program *program = *state;
    write_study(program, "s.yaml", "200 ms", "false");
    program_run(program, "study s.yaml");
    assert_int_equal(program->status, 4);
    assert_says(program->output, "refused");
    assert_says(program->errors, "every run of the study failed");
    // one that goes well is enough
    write_study(program, "t.yaml", "50 us, 200 ms", "true");
    run_well(program, "study t.yaml");
    assert_says(program->output, "refused");
}

// Of an export without the time that each run took: the rows, one after another.
static void read_rows(Program *program, const char *store, char *rows, size_t size)
{
    char words[PROGRAM_PATH_SIZE];
    snprintf(words, sizeof words, "study export %s", store);
    run_well(program, words);
    size_t length = 0;
    for (char *line = strtok(program->output, "\n"); line != NULL; line = strtok(NULL, "\n")) {
        *strrchr(line, ',') = '\0';
        length += (size_t)snprintf(rows + length, size - length, "%s\n", line);
        assert_true(length < size);
    }
}

// What a run follows is found by its own process: in whatever order, and on whatever machine, the
// runs are made, they are the same.
static void a_study_that_follows_a_key_has_the_same_rows_in_parts(void **state)
{
    Program *program = *state;
    char path[PROGRAM_PATH_SIZE];
    program_path(program, "f.yaml", path);
    FILE *stream = fopen(path, "w");
    assert_non_null(stream);
    fprintf(stream,
            "case: %s/paper/impact-k66.yaml\n"
            "set: {run.samples: 36, run.step: 20 us, contact.resting-speed: none, "
            "run.settle-starts: 2}\n"
            "vary:\n  drive.speed: [900 rpm, 950 rpm, 1000 rpm]\n"
            "follow: {key: drive.speed, direction: both}\ntruth: false\n",
            getenv("JOINTPLAY_CASES"));
    fclose(stream);
    static char whole[PROGRAM_OUTPUT_SIZE];
    static char parts[PROGRAM_OUTPUT_SIZE];
    run_well(program, "study f.yaml -q --jobs 1");
    read_rows(program, "f.sqlite", whole, sizeof whole);
    assert_non_null(strstr(whole, "followed_from"));
    assert_non_null(strstr(whole, "backward"));
    run_well(program, "study f.yaml -q --shard 1/2 --store a.sqlite");
    run_well(program, "study f.yaml -q --shard 2/2 --store b.sqlite");
    run_well(program, "study merge m.sqlite a.sqlite b.sqlite");
    read_rows(program, "m.sqlite", parts, sizeof parts);
    assert_string_equal(whole, parts);
}

static void shards_of_several_divisions_are_not_guessed_at(void **state)
{
    Program *program = *state;
    run_well(program, "study s.yaml --shard 1/2");
    run_well(program, "study s.yaml --shard 1/3");
    program_run(program, "study merge s.yaml");
    assert_int_equal(program->status, 5);
    assert_says(program->errors, "there are stores of 2 and of 3 parts of s.yaml here");
    run_well(program, "study s.yaml --shard 2/2");
    run_well(program, "study merge out.sqlite s.1-of-2.sqlite s.2-of-2.sqlite");
    assert_says(program->errors, "merged 4 runs into out.sqlite, which holds 4 of 4");
}

static void a_division_into_more_parts_than_there_can_be_is_refused(void **state)
{
    Program *program = *state;
    program_fails_usage(program, "study s.yaml --shard 1/9007199254740992", "at most 100000 parts");
    program_fails_usage(program, "study s.yaml --shard 100001/100001", "at most 100000 parts");
    run_well(program, "study s.yaml --shard 100000/100000");
    program_run(program, "study merge s.yaml");
    assert_int_equal(program->status, 5);
    assert_says(program->errors, "there is no s.1-of-100000.sqlite");
    run_well(program, "study status s.yaml");
    // a file of such a name is none of ours
    char path[PROGRAM_PATH_SIZE];
    program_path(program, "s.100000-of-100000.sqlite", path);
    assert_int_equal(unlink(path), 0);
    program_path(program, "s.1-of-9007199254740992.sqlite", path);
    fclose(fopen(path, "w"));
    program_run(program, "study merge s.yaml");
    assert_int_equal(program->status, 5);
    assert_says(program->errors, "there are no parts of s.yaml");
    run_well(program, "study status s.yaml");
}

static void what_is_wrong_on_the_command_line_is_told(void **state)
{
    Program *program = *state;
    program_fails_usage(program, "study", "no study given");
    program_fails_usage(program, "study statsu", "did you mean 'jointplay study status'?");
    program_fails_usage(program, "study s.yaml t.yaml", "study takes one file");
    program_fails_usage(program, "study s.yaml --shard 0/3", "the I-th of N parts");
    program_fails_usage(program, "study s.yaml --shard 4/3", "--shard is 4/3");
    program_fails_usage(program, "study s.yaml --shard 1", "--shard is 1;");
    program_fails_usage(program, "study s.yaml --jobs 0", "--jobs is 0; allowed: a whole number");
    program_fails_usage(program, "study s.yaml --fresh --retry-failed", "not both");
    program_fails_usage(program, "study status", "no study given");
    program_fails_usage(program, "study export", "no store given");
    program_fails_usage(program, "study export a b", "export takes one store");
    program_fails_usage(program, "study export a --csv b --jsonl b", "would both write b");
    program_fails_usage(program, "study merge a.sqlite", "nothing to merge given");
    program_fails_usage(program, "study plot a", "a store and a file are needed");
    program_fails_usage(program, "study plot a b", "no --x given");
    program_fails_usage(program, "study plot a b c", "'c' is one more");
    program_run(program, "study nothing.yaml");
    assert_int_equal(program->status, 5);
    program_run(program, "study status nothing.sqlite");
    assert_int_equal(program->status, 5);
}

static void each_part_has_its_help(void **state)
{
    Program *program = *state;
    const char *const parts[] = {"", "status ", "export ", "merge ", "plot ", "slurm "};
    for (int i = 0; i < 6; i++) {
        char words[64];
        snprintf(words, sizeof words, "study %s--help", parts[i]);
        run_well(program, words);
        assert_says(program->output, "Usage: jointplay study");
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
#define STUDY_TEST(name) cmocka_unit_test_setup_teardown(name, set_up, program_tear_down)
        STUDY_TEST(a_dry_run_tells_all_and_writes_nothing),
        STUDY_TEST(a_key_that_no_run_uses_is_said),
        STUDY_TEST(what_came_of_it_is_printed),
        STUDY_TEST(a_picture_has_the_units_and_scales_of_its_study),
        STUDY_TEST(rows_are_exported_and_drawn),
        STUDY_TEST(a_store_beside_its_study_is_found_from_elsewhere),
        STUDY_TEST(a_study_of_which_every_run_fails_ends_with_status_4),
        STUDY_TEST(a_study_that_follows_a_key_has_the_same_rows_in_parts),
        STUDY_TEST(shards_of_several_divisions_are_not_guessed_at),
        STUDY_TEST(a_division_into_more_parts_than_there_can_be_is_refused),
        STUDY_TEST(what_is_wrong_on_the_command_line_is_told),
        STUDY_TEST(each_part_has_its_help),
#undef STUDY_TEST
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
