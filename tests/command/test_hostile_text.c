// Does anything that a user's text may hold reach a terminal or a file as it is?
//
// Each hostile text stands in every place where a text of a user's goes (the file name of a case,
// its title, keys and values on the command line, names of outputs, stores, baselines), and all
// that the program then prints and writes is looked at: valid UTF-8 without controls, marks of
// direction and invisible characters; JSON that gives the text back; XML that is well-formed; rows
// of CSV of one length.
#include "program.h"

#include <dirent.h>
#include <sys/stat.h>
#include <time.h>

enum { NAME_SIZE = 256 };

typedef struct Hostile {
    const char *name; // of the test
    const char *text; // without a slash, for it is a file's name as well
    bool is_text;     // valid UTF-8
    bool is_line;     // and may stand in a case: without controls
} Hostile;

static const Hostile HOSTILE[] = {
    {"controls",
     "\x1b[31mred\x1b]0;owned\x07\xc2\x9b"
     "2J\xc2\x85\x7f\r\tx",
     true, false},
    {"line breaks", "two\nlines\njointplay: done", true, false},
    {"marks of direction and invisible characters",
     "gnp.\xe2\x80\xaeyaml\xe2\x80\xac \xe2\x81\xa6x\xe2\x81\xa9 \xe2\x80\x8e\xe2\x80\x8f\xd8\x9c"
     "\xef\xbb\xbf\xe2\x80\x8b \xe2\x80\xa8 \xe2\x80\xa9 z",
     true, true},
    {"no UTF-8", "caf\xe9 \xff\xc0\xaf\xed\xa0\x80", false, false},
    {"markup", "<b onload=\"x\">&amp; 'it'<b>]]>--><!-- `a` | *b* _c_ [d](e) ~f~ #g @h ``i``", true,
     true},
    {"cells, formats and commands",
     "=1+1,\"two\";three %s%n%999999d \\x41 $(touch harm) `touch harm`", true, true},
    {"other languages",
     "Gr\xc3\xb6\xc3\x9f"
     "e \xe9\x80\xa3\xe6\xa1\xbf \xf0\x9f\x98\x80",
     true, true},
};
enum { HOSTILE_COUNT = sizeof HOSTILE / sizeof *HOSTILE };

// What the line break of a hostile text would begin a line with.
static const char FORGED[] = "\njointplay: done";

// What must not stand anywhere; below a blank only line breaks may.
static const char *const FORBIDDEN[] = {
    "\x7f",         "\xd8\x9c",     "\xe2\x80\x8b", "\xe2\x80\x8e", "\xe2\x80\x8f", "\xe2\x80\xa8",
    "\xe2\x80\xa9", "\xe2\x80\xaa", "\xe2\x80\xab", "\xe2\x80\xac", "\xe2\x80\xad", "\xe2\x80\xae",
    "\xe2\x81\xa6", "\xe2\x81\xa7", "\xe2\x81\xa8", "\xe2\x81\xa9", "\xef\xbb\xbf",
};

// Words of commands. The text stands in the environment, so that no shell takes it apart: $H is the
// hostile text, also as the name of a case or study; what is written goes to names without it, or
// is looked at where it is.
static const char *const COMMANDS[] = {
    "run \"$H.yaml\" --plot p.svg --series s.csv --out o",
    "run \"$H.yaml\" --json > run.json",
    "report \"$H.yaml\" --out r.html",
    "report case.yaml --set \"title=$H\" --out r.html",
    "report case.yaml --out \"$H.html\"",
    "run \"$H-none.yaml\"",
    "run case.yaml --set \"title=$H\" --plot p.svg --out o",
    "run case.yaml --set \"title=$H\" --json > run.json",
    "run case.yaml --set \"$H=1\"",
    "run case.yaml --set \"joints.$H.hole=1 mm\"",
    "run case.yaml --set \"run.step=$H\"",
    "run case.yaml --set \"run.backends=[$H]\"",
    "run case.yaml --step \"$H\"",
    "run case.yaml --backend \"$H\"",
    "run case.yaml \"--$H\"",
    "run case.yaml --plot \"$H.svg\" --series \"$H.csv\" --out \"$H\"",
    "run case.yaml --plot \"$H\"",
    "run case.yaml --out \"case.yaml/$H\"",
    "\"$H\"",
    "help \"$H\"",
    "map \"$H.yaml\" --out m --steps '20 us'",
    "map case.yaml --laws \"$H\"",
    ("compare \"$H.yaml\" --steps '20 us' --schemes direct/plain/textbook --repeats 5 --store j "
     "--out c"),
    "report c/*.json --out x.html",
    "compare case.yaml --store \"none/$H\"",
    "compare case.yaml --schemes \"$H\"",
    "tune \"$H.yaml\" --error 0.5 --schemes direct/plain --out t",
    "check \"$H.yaml\" --baselines b --quick --junit u.xml --markdown d.md",
    "check \"$H.yaml\" --baselines b --quick --json > check.json",
    "report check.json --out y.html",
    "check case.yaml --baselines \"$H\" --quick --junit u.xml --markdown d.md",
    "check case.yaml --baselines edited --quick --junit u.xml --markdown d.md",
    "check case.yaml --baselines edited --quick --json > check.json",
    "study \"$H-study.yaml\"",
    "study status \"$H-study.yaml\"",
    "report \"$H-study.sqlite\" --out z.html",
    "study export \"$H-study.sqlite\" --csv e.csv --jsonl e.jsonl",
    "study plot \"$H-study.sqlite\" e.svg --x step_s --title \"$H\"",
    "study plot \"$H-study.sqlite\" e.svg --x \"$H\"",
    "study merge \"$H-study.yaml\"",
    "study slurm \"$H-study.yaml\" --shards 2 --dry-run",
    "study hostile.yaml --dry-run",
    "study \"$H-study.yaml\" --dry-run",
};
enum { COMMAND_COUNT = sizeof COMMANDS / sizeof *COMMANDS };

static const char CASE[] =
    "title: A pin in its hole\n"
    "bodies:\n"
    "  pin: {mass: 0.1 kg, inertia: 2 kg mm^2, at: [0 mm, 0 mm]}\n"
    "joints:\n"
    "  hole: {between: [ground, pin], at: [0 mm, 0 mm], radial-clearance: 0.1 mm, pin: 10 mm, "
    "width: 15 mm}\n"
    "contact: {stiffness: 6.6e10 N/m^1.5, restitution: 0.9}\n"
    "run: {duration: 6 ms, samples: 20, step: 50 us, backends: [reference, ode]}\n";

static const char STUDY[] = "case: case.yaml\nvary: {run.step: [50 us, 100 us]}\ntruth: false\n";

static void write_file(const Program *program, const char *name, const char *content)
{
    char path[PROGRAM_PATH_SIZE];
    program_path(program, name, path);
    FILE *file = fopen(path, "w");
    assert_non_null(file);
    fputs(content, file);
    assert_int_equal(fclose(file), 0);
}

static void give_up(const char *where, const char *what, const char *text)
{
    print_error("%s: %s in:\n%.800s\n", where, what, text);
    fail();
}

// Valid UTF-8, by jansson's word, with nothing in it that is obeyed or hidden.
static void check_text(const char *where, const char *text)
{
    json_t *value = json_string(text);
    if (value == NULL) {
        give_up(where, "what is no UTF-8", text);
    }
    json_decref(value);
    for (const char *c = text; *c != '\0'; c++) {
        const unsigned char byte = (unsigned char)*c;
        if ((byte < ' ' && byte != '\n') || (byte == 0xc2 && (unsigned char)c[1] < 0xa0)) {
            give_up(where, "a control character", text);
        }
    }
    // a line of the text's own
    if (strstr(text, FORGED) != NULL) {
        give_up(where, "a line that is not the program's", text);
    }
    for (size_t i = 0; i < sizeof FORBIDDEN / sizeof *FORBIDDEN; i++) {
        if (strstr(text, FORBIDDEN[i]) != NULL) {
            give_up(where, "an invisible character or a mark of direction", text);
        }
    }
}

// Every line has as many fields, by the quotes.
static void check_csv(const char *where, const char *text)
{
    size_t fields = 0;
    while (*text != '\0') {
        size_t count = 1;
        bool is_quoted = false;
        for (; *text != '\0' && (is_quoted || *text != '\n'); text++) {
            is_quoted = is_quoted != (*text == '"');
            count += *text == ',' && !is_quoted ? 1 : 0;
        }
        if (is_quoted || (fields > 0 && count != fields)) {
            give_up(where, "a row of another length", text);
        }
        fields = count;
        text += *text == '\n' ? 1 : 0;
    }
}

static void check_json(const char *where, const char *text, bool is_lines)
{
    while (*text != '\0') {
        const size_t length = is_lines ? strcspn(text, "\n") : strlen(text);
        json_t *root = json_loadb(text, length, JSON_REJECT_DUPLICATES, NULL);
        if (root == NULL) {
            give_up(where, "no JSON", text);
        }
        json_decref(root);
        text += length + (text[length] == '\n' ? 1 : 0);
    }
}

static void check_xml(const char *where, const char *path, const char *text)
{
    const char *linter = getenv("JOINTPLAY_XMLLINT");
    if (linter == NULL || linter[0] == '\0') {
        return;
    }
    setenv("FILE", path, 1);
    char command[PROGRAM_PATH_SIZE];
    snprintf(command, sizeof command, "'%s' --noout \"$FILE\" 2>/dev/null", linter);
    if (system(command) != 0) {
        give_up(where, "no well-formed XML", text);
    }
}

// What of a hostile text stands outside of code would be a tag, a link or a name that is called.
static void check_markdown(const char *where, const char *text)
{
    const char *at = text;
    while (*at != '\0') {
        const size_t fence = strspn(at, "`");
        if (fence > 0) {
            // up to as many again
            const char *end = at + fence;
            while (*end != '\0' && strspn(end, "`") != fence) {
                end += strspn(end, "`") + 1;
            }
            at = *end != '\0' ? end + fence : end;
        } else if (strncmp(at, "<b", 2) == 0 || strncmp(at, "[d](", 4) == 0 ||
                   strncmp(at, " @h", 3) == 0) {
            give_up(where, "markup that is not the program's", text);
        } else {
            at++;
        }
    }
}

static bool ends_in(const char *name, const char *ending)
{
    const size_t length = strlen(name);
    const size_t size = strlen(ending);
    return length >= size && strcmp(name + length - size, ending) == 0;
}

static void check_file(const char *path)
{
    static char text[PROGRAM_OUTPUT_SIZE];
    program_read(path, text);
    check_text(path, text);
    if (ends_in(path, ".md")) {
        check_markdown(path, text);
    } else if (ends_in(path, ".csv")) {
        check_csv(path, text);
    } else if (ends_in(path, ".json") || ends_in(path, ".jsonl")) {
        check_json(path, text, ends_in(path, ".jsonl"));
    } else if (ends_in(path, ".svg") || ends_in(path, "u.xml")) {
        // what tune writes for MuJoCo is part of a file
        check_xml(path, path, text);
    }
}

static bool is_before(struct timespec first, struct timespec second)
{
    return first.tv_sec < second.tv_sec ||
           (first.tv_sec == second.tv_sec && first.tv_nsec < second.tv_nsec);
}

// All that was written into a folder since a time, but for what the test itself has put there, and
// for stores.
static void check_folder(const char *folder, struct timespec since)
{
    DIR *entries = opendir(folder);
    assert_non_null(entries);
    for (const struct dirent *entry; (entry = readdir(entries)) != NULL;) {
        char path[2 * PROGRAM_PATH_SIZE];
        struct stat status;
        snprintf(path, sizeof path, "%s/%s", folder, entry->d_name);
        const bool is_ours = entry->d_name[0] == '.' || ends_in(path, ".yaml") ||
                             ends_in(path, ".sqlite") || strcmp(entry->d_name, "edited") == 0;
        if (is_ours || stat(path, &status) != 0) {
            continue;
        }
        if (S_ISDIR(status.st_mode)) {
            check_folder(path, since);
        } else if (!is_before(status.st_mtim, since)) {
            check_file(path);
        }
    }
    closedir(entries);
}

// Puts the text into a baseline: into the values of settings, and names and reasons of numbers.
static void edit_baseline(const Program *program, const Hostile *hostile)
{
    char path[PROGRAM_PATH_SIZE];
    char target[PROGRAM_PATH_SIZE];
    program_path(program, "b/case.json", path);
    json_t *root = json_load_file(path, 0, NULL);
    assert_non_null(root);
    json_t *metrics = json_object_get(root, "metrics");
    json_t *metric = json_deep_copy(json_object_iter_value(json_object_iter(metrics)));
    if (hostile->is_text) {
        char why[256];
        snprintf(why, sizeof why, "exact: %s", hostile->text);
        json_t *settings = json_object_get(root, "settings");
        json_object_set_new(settings, json_object_iter_key(json_object_iter(settings)),
                            json_string(hostile->text));
        json_object_set_new(settings, hostile->text, json_string(hostile->text));
        json_object_set_new(metric, "value", json_integer(1));
        json_object_set_new(metric, "band", json_real(0.0));
        json_object_set_new(metric, "why", json_string(why));
        json_object_set(metrics, hostile->text, metric);
    }
    json_decref(metric);
    program_path(program, "edited", target);
    mkdir(target, 0777);
    program_path(program, "edited/case.json", target);
    assert_int_equal(json_dump_file(root, target, 0), 0);
    json_decref(root);
}

static void write_inputs(Program *program, const Hostile *hostile)
{
    char name[NAME_SIZE];
    char content[PROGRAM_PATH_SIZE];
    write_file(program, "case.yaml", CASE);
    snprintf(name, sizeof name, "%s.yaml", hostile->text);
    write_file(program, name, CASE);
    snprintf(name, sizeof name, "%s-study.yaml", hostile->text);
    write_file(program, name, STUDY);
    // as text of a study
    snprintf(content, sizeof content,
             "title: |-\n  %s\ncase: case.yaml\nvary: {scheme: [\"%s\"]}\n",
             hostile->is_line ? hostile->text : "x", hostile->is_line ? "x" : hostile->text);
    write_file(program, "hostile.yaml", content);
    program_run(program, "check case.yaml --bless --baselines b --quiet");
    assert_int_equal(program->status, 0);
    edit_baseline(program, hostile);
}

// The text comes back from JSON; what is no UTF-8 as it is shown.
static void check_back(Program *program, const Hostile *hostile)
{
    char name[NAME_SIZE];
    snprintf(name, sizeof name, "%s.yaml", hostile->text);
    program_run(program, "run \"$H.yaml\" --json");
    assert_int_equal(program->status, 0);
    json_t *root = program_json(program);
    const char *path = json_string_value(json_object_get(root, "case"));
    assert_string_equal(path,
                        hostile->is_text ? name : "caf\\xe9 \\xff\\xc0\\xaf\\xed\\xa0\\x80.yaml");
    json_decref(root);
}

static void no_output_holds_what_is_obeyed_or_hidden(void **state)
{
    const Hostile *hostile = *state;
    void *made = NULL;
    assert_int_equal(program_set_up(&made), 0);
    Program *program = made;
    setenv("H", hostile->text, 1);
    write_inputs(program, hostile);
    for (size_t i = 0; i < COMMAND_COUNT; i++) {
        // by the clock that files have their times from
        struct timespec began;
        clock_gettime(CLOCK_REALTIME_COARSE, &began);
        program_run(program, COMMANDS[i]);
        if (program->status < 0 || program->status > 5) {
            give_up(COMMANDS[i], "a status that there is not", program->errors);
        }
        check_text(COMMANDS[i], program->output);
        check_text(COMMANDS[i], program->errors);
        check_folder(program->folder, began);
    }
    check_back(program, hostile);
    char harm[PROGRAM_PATH_SIZE];
    program_path(program, "harm", harm);
    assert_int_not_equal(access(harm, F_OK), 0);
    program_tear_down(&made);
}

int main(void)
{
    struct CMUnitTest tests[HOSTILE_COUNT];
    for (size_t i = 0; i < HOSTILE_COUNT; i++) {
        tests[i] = (struct CMUnitTest){.name = HOSTILE[i].name,
                                       .test_func = no_output_holds_what_is_obeyed_or_hidden,
                                       .initial_state = (void *)&HOSTILE[i]};
    }
    return cmocka_run_group_tests_name("hostile_text", tests, NULL, NULL);
}
