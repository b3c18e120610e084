// Which commands does a seed stand for, and which files do they work on?
//
// random_command plan SEED OPTIONS    writes the files into the working folder and prints the plan
// random_command damage SEED FILE     flips, cuts or doubles some bytes of a file
//
// A plan is a list of steps with an empty line behind each: 'do' and the arguments of jointplay,
// one a line, or 'damage' and a file. Behind 'do' may stand which of the descriptors 0 to 2 are
// closed ('closed=02') and how large a file may grow, in kB ('limit=4'). A store is damaged byte by
// byte or by SQL, or a journal is put beside it. OPTIONS holds a line per option that the program
// has, 'COMMAND --name' or 'COMMAND --name=PLACEHOLDER', as its --help tells them.
// tests/measure/fuzz.sh makes all of it.
#include "casefile/schema.h"
#include "random_case.h"
#include "random_draw.h"
#include "random_store.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

enum { OPTION_MAX = 256, LINE_SIZE = 256 };

typedef struct Option {
    char command[LINE_SIZE];
    char name[LINE_SIZE];        // with its dashes
    char placeholder[LINE_SIZE]; // empty where it takes no value
} Option;

typedef struct Plan {
    Draw draw;
    size_t option_count;
    Option options[OPTION_MAX];
} Plan;

#define PICK(draw, words) ((words)[draw_below(draw, sizeof(words) / sizeof *(words))])

static const char *const UNITS[] = {"m", "mm",  "um",  "kg",      "g",   "ms", "us",
                                    "s", "rpm", "N/m", "N/m^1.5", "deg", ""};

// A number as people, and as nobody, would write it.
static void write_number(Draw *draw, double low, double high, FILE *file)
{
    static const char *const ODD[] = {"0",     "-1",      "nan",  "inf",
                                      "1e308", "-1e-320", "1e-9", "0x1p10",
                                      "1,5",   "",        "--2",  "99999999999999999999"};
    if (draw_chance(draw, 0.12)) {
        fprintf(file, "%s", PICK(draw, ODD));
    } else if (draw_chance(draw, 0.15)) {
        fprintf(file, "%.17g", draw_chance(draw, 0.5) ? low : high);
    } else {
        const double least = fmax(low, 1e-9);
        const double value = high > least && low >= 0.0 ? draw_log_between(draw, least, high)
                                                        : draw_between(draw, low, high);
        fprintf(file, "%.6g", value);
    }
}

static void write_unit(Draw *draw, Dimension dimension, FILE *file)
{
    const char *unit = draw_chance(draw, 0.05) ? PICK(draw, UNITS) : units_si(dimension);
    fprintf(file, "%s%s", *unit != '\0' ? " " : "", unit);
}

static void write_setting(Draw *draw, FILE *file)
{
    const SchemaRow *row = &SCHEMA_ROWS[draw_below(draw, SCHEMA_ROW_COUNT)];
    static const char *const MEMBERS[] = {
        "crank-coupler", "coupler-follower", "joint-1", "body-0", "crank", "--2", "nobody"};
    for (const char *c = row->path; *c != '\0'; c++) {
        if (*c == '*') {
            fprintf(file, "%s", PICK(draw, MEMBERS));
        } else {
            fputc(*c, file);
        }
    }
    fputc('=', file);
    if (row->words != NULL && draw_chance(draw, 0.95)) {
        size_t count = 0;
        while (row->words[count] != NULL) {
            count++;
        }
        fprintf(file, "%s", row->words[draw_below(draw, count)]);
    } else if (row->zero_word != NULL && draw_chance(draw, 0.3)) {
        fprintf(file, "%s", row->zero_word);
    } else if (row->type == SCHEMA_VECTOR || row->type == SCHEMA_ANCHOR ||
               (row->type == SCHEMA_GRAVITY && draw_chance(draw, 0.5))) {
        fputc('[', file);
        write_number(draw, row->low, row->high, file);
        write_unit(draw, row->dimension, file);
        fputs(", ", file);
        write_number(draw, row->low, row->high, file);
        write_unit(draw, row->dimension, file);
        fputc(']', file);
    } else if (row->type == SCHEMA_TEXT) {
        fprintf(file, "it's \"<&>\" $(x) %%s");
    } else if (row->type == SCHEMA_STIFFNESS) {
        write_number(draw, 1e3, 1e15, file);
        fputs(draw_chance(draw, 0.7) ? " N/m^1.5" : " N/m", file);
    } else {
        write_number(draw, row->low, row->high, file);
        write_unit(draw, row->dimension, file);
    }
}

static void write_time(Draw *draw, FILE *file)
{
    write_number(draw, 1e-1, 1e3, file);
    static const char *const TIMES[] = {" us", " us", " us", " ms", " s", "", " kg"};
    fputs(PICK(draw, TIMES), file);
}

static void write_list(Draw *draw, const char *option, FILE *file)
{
    static const char *const WORDS[] = {
        "all",
        "johnson",
        "hertz-socket",
        "esdu-78035",
        "textbook",
        "corrected",
        "direct/corrected",
        "auto/1e-3",
        "impulse",
        "direct/staggered/impulse",
        "quick/plain",
        "paper-table-2",
        "paper-table-3,",
        "",
        "textbook,textbook",
    };
    const size_t count = 1 + draw_below(draw, 3);
    for (size_t i = 0; i < count; i++) {
        fputs(i > 0 ? ", " : "", file);
        if (strcmp(option, "--steps") == 0) {
            write_time(draw, file);
        } else {
            fputs(PICK(draw, WORDS), file);
        }
    }
}

static void write_value(Draw *draw, const Option *option, FILE *file)
{
    static const char *const FILES[] = {"out.svg",   "out.csv",     "out.xml",  "out.c",
                                        "case.yaml", "-",           "a b.json", "none/x.svg",
                                        ".",         "study.sqlite"};
    static const char *const FOLDERS[] = {"out", "out", "out", ".", "case.yaml", "none/deep", ""};
    static const char *const COUNTS[] = {"0", "1", "1", "2", "3", "-1", "9007199254740992", "x"};
    static const char *const SHARDS[] = {"1/2", "2/2", "1/1", "0/3", "3/2", "1/9007199254740992"};
    static const char *const NAMES[] = {"reference", "ode", "analytic,ode", "mujoco", "ode,ode"};
    const char *what = option->placeholder;
    if (strstr(what, "KEY") != NULL) {
        write_setting(draw, file);
    } else if (strncmp(what, "FILE", 4) == 0) {
        fputs(PICK(draw, FILES), file);
    } else if (strncmp(what, "DIR", 3) == 0) {
        fputs(PICK(draw, FOLDERS), file);
    } else if (strcmp(what, "I/N") == 0) {
        fputs(PICK(draw, SHARDS), file);
    } else if (strncmp(what, "NAME", 4) == 0) {
        fputs(PICK(draw, NAMES), file);
    } else if (strcmp(what, "N") == 0 || strcmp(what, "SEED") == 0) {
        fputs(PICK(draw, COUNTS), file);
    } else if (strcmp(what, "TIME") == 0) {
        write_time(draw, file);
    } else if (strcmp(what, "LIST") == 0) {
        write_list(draw, option->name, file);
    } else {
        write_number(draw, 1e-6, 1e9, file);
        fputs(draw_chance(draw, 0.5) ? " " : "", file);
        fputs(PICK(draw, UNITS), file);
    }
}

// Begins a step that runs the program, now and then in an odd place.
static void print_do(Plan *plan)
{
    static const char *const CLOSED[] = {"0", "1", "2", "02", "12", "012"};
    printf("do");
    if (draw_chance(&plan->draw, 0.06)) {
        printf(" closed=%s", PICK(&plan->draw, CLOSED));
    }
    if (draw_chance(&plan->draw, 0.06)) {
        printf(" limit=%zu", draw_below(&plan->draw, 64));
    }
    printf("\n");
}

static void print_options(Plan *plan, const char *command, size_t most)
{
    const size_t count = draw_below(&plan->draw, most + 1);
    for (size_t i = 0; i < count; i++) {
        const Option *option = &plan->options[draw_below(&plan->draw, plan->option_count)];
        while (strcmp(option->command, command) != 0 && !draw_chance(&plan->draw, 0.001)) {
            option = &plan->options[draw_below(&plan->draw, plan->option_count)];
        }
        printf("%s", option->name);
        if (option->placeholder[0] != '\0') {
            putchar('=');
            write_value(&plan->draw, option, stdout);
        }
        putchar('\n');
    }
}

// One call of the program that looks at a case, short enough that thousands can be made.
static void print_case_command(Plan *plan, const char *command, const char *case_name)
{
    static const char *const LENGTHS[] = {"0.01", "0.05", "0.2", "1"};
    static const char *const ROWS[] = {"ode.map=midpoint",        "ode.map=textbook",
                                       "ode.collider=staves",     "ode.collider=trimesh",
                                       "ode.collider=staves-gjk", "ode.collider=ode-convex"};
    print_do(plan);
    printf("%s\n%s\n", command, case_name);
    if (draw_chance(&plan->draw, 0.9)) {
        printf("--set=run.revolutions=%s\n", PICK(&plan->draw, LENGTHS));
    }
    if (draw_chance(&plan->draw, 0.2)) {
        printf("--set=%s\n--set=contact.friction=0.2\n", PICK(&plan->draw, ROWS));
    }
    if (strcmp(command, "tune") == 0 && draw_chance(&plan->draw, 0.9)) {
        printf("--error=1e-%zu\n", 1 + draw_below(&plan->draw, 4));
    }
    print_options(plan, command, 4);
    putchar('\n');
}

static void write_case(Plan *plan, const char *name)
{
    static const CaseKind *const KINDS[] = {&CASE_FOUR_BAR, &CASE_BODIES};
    FILE *file = fopen(name, "w");
    if (file == NULL) {
        exit(EXIT_FAILURE);
    }
    PICK(&plan->draw, KINDS)->write(draw_below(&plan->draw, 1000000), file);
    fclose(file);
}

static void write_study(Plan *plan, const char *name)
{
    FILE *file = fopen(name, "w");
    if (file == NULL) {
        exit(EXIT_FAILURE);
    }
    Draw *draw = &plan->draw;
    fprintf(file, "title: Random\ncase: case.yaml\nset: {run.revolutions: 0.02}\nvary:\n");
    fprintf(file, "  drive.speed: [100 rpm, 1000 rpm]\n");
    fprintf(file, draw_chance(draw, 0.5) ? "  scheme: [direct/plain/textbook, auto/1e-2]\n"
                                         : "  run.step: [5 us, 20 us]\n");
    fprintf(file, "limits: {time: 5 s, memory: 1 GB}\n");
    fprintf(file, draw_chance(draw, 0.5) ? "truth: false\n" : "truth: true\n");
    fclose(file);
}

static void print_study(Plan *plan)
{
    static const char *const LATER[] = {"status", "export", "merge", "plot", "slurm", "", ""};
    write_study(plan, "study.yaml");
    if (draw_chance(&plan->draw, 0.3)) {
        printf("damage\nstudy.yaml\n\n");
    }
    print_do(plan);
    printf("study\nstudy.yaml\n-q\n\n");
    if (draw_chance(&plan->draw, 0.6)) {
        printf("damage\nstudy.sqlite\n\n");
    }
    const char *later = PICK(&plan->draw, LATER);
    print_do(plan);
    printf("study\n%s%sstudy.%s\n", later, *later != '\0' ? "\n" : "",
           draw_chance(&plan->draw, 0.5) ? "yaml" : "sqlite");
    printf("%s", strcmp(later, "plot") == 0 ? "picture.svg\n" : "");
    char command[LINE_SIZE];
    snprintf(command, sizeof command, "study%s%s", *later != '\0' ? "-" : "", later);
    print_options(plan, command, 3);
    printf("\n");
}

static void print_kept(Plan *plan, const char *first, const char *second, const char *kept)
{
    print_do(plan);
    printf("%s\n\n", first);
    if (draw_chance(&plan->draw, 0.6)) {
        printf("damage\n%s\n\n", kept);
    }
    print_do(plan);
    printf("%s\n", second);
    print_options(plan, strncmp(second, "check", 5) == 0 ? "check" : "compare", 2);
    printf("\n");
}

static int damage(Draw *draw, const char *path)
{
    FILE *file = fopen(path, "r+");
    if (file == NULL) {
        return 0; // there is nothing to damage
    }
    fseek(file, 0, SEEK_END);
    const long size = ftell(file);
    const size_t count = size > 0 ? 1 + draw_below(draw, 4) : 0;
    for (size_t i = 0; i < count; i++) {
        static const char ODD[] = "-:{}[],#&*\n\t0e9 \"'\\\xff\x80";
        fseek(file, (long)draw_below(draw, (size_t)size), SEEK_SET);
        const size_t length = 1 + draw_below(draw, draw_chance(draw, 0.2) ? 64 : 2);
        for (size_t k = 0; k < length; k++) {
            fputc(draw_chance(draw, 0.7) ? ODD[draw_below(draw, sizeof ODD - 1)]
                                         : (int)draw_below(draw, 256),
                  file);
        }
    }
    return fclose(file) == 0 ? 0 : EXIT_FAILURE;
}

static void print_plan(Plan *plan)
{
    static const char *const COMMANDS[] = {"run", "run", "run", "map", "map", "tune", "compare"};
    write_case(plan, "case.yaml");
    const size_t kind = draw_below(&plan->draw, 10);
    if (kind >= 8) {
        damage(&plan->draw, "case.yaml");
    }
    if (kind == 0) {
        print_study(plan);
    } else if (kind == 1) {
        print_kept(
            plan,
            "check\n--bless\n--quick\n--baselines=kept\n--set=run.revolutions=0.02\ncase.yaml",
            "check\n--quick\n--baselines=kept\n--set=run.revolutions=0.02\ncase.yaml",
            "kept/case.json");
    } else if (kind == 2) {
        print_kept(
            plan,
            "compare\n--steps=20 us, 10 us\n--store=kept\n--set=run.revolutions=0.01\ncase.yaml",
            "compare\n--steps=20 us, 10 us\n--store=kept\n--set=run.revolutions=0.01\ncase.yaml",
            "kept");
    } else if (kind == 3) {
        static const char *const REST[] = {"help",      "paper", "check", "study",
                                           "--version", "",      "runn"};
        print_do(plan);
        printf("%s\n", PICK(&plan->draw, REST));
        print_options(plan, PICK(&plan->draw, COMMANDS), 2);
        putchar('\n');
    } else {
        // a name that does harm, or is shown, as it is
        static const char *const NAMES[] = {"-h.yaml",
                                            "c'; touch harm; '.yaml",
                                            "$(touch harm).yaml",
                                            "\x1b[31mred\x07.yaml",
                                            "gnp.\xe2\x80\xaeyaml",
                                            "caf\xe9.yaml",
                                            "%s%n<b>`a`.yaml"};
        const char *name = draw_chance(&plan->draw, 0.15) ? PICK(&plan->draw, NAMES) : "case.yaml";
        char path[LINE_SIZE];
        snprintf(path, sizeof path, "%s%s", name[0] == '-' ? "./" : "", name);
        if (strcmp(name, "case.yaml") != 0 && rename("case.yaml", name) != 0) {
            exit(EXIT_FAILURE);
        }
        print_case_command(plan, PICK(&plan->draw, COMMANDS), path);
    }
}

static void read_options(const char *path, Plan *plan)
{
    FILE *file = fopen(path, "r");
    char line[LINE_SIZE];
    while (file != NULL && plan->option_count < OPTION_MAX && fgets(line, sizeof line, file)) {
        Option *option = &plan->options[plan->option_count];
        option->placeholder[0] = '\0';
        const int found = sscanf(line, "%255s %255[^=\n]=%255[^\n]", option->command, option->name,
                                 option->placeholder);
        plan->option_count += found >= 2 ? 1 : 0;
    }
    if (file == NULL || plan->option_count == 0) {
        fprintf(stderr, "random_command: no options in %s\n", path);
        exit(EXIT_FAILURE);
    }
    fclose(file);
}

int main(int argc, char **argv)
{
    if (argc != 4) {
        fprintf(stderr, "usage: random_command plan SEED OPTIONS | damage SEED FILE\n");
        return 2;
    }
    static Plan plan;
    plan.draw = draw_start(strtoull(argv[2], NULL, 10));
    if (strcmp(argv[1], "damage") == 0) {
        const char *ending = strrchr(argv[3], '.');
        const bool is_store = ending != NULL && strcmp(ending, ".sqlite") == 0;
        const bool is_odd = is_store && draw_chance(&plan.draw, 0.6);
        return is_odd ? random_store_damage(&plan.draw, argv[3]) : damage(&plan.draw, argv[3]);
    }
    read_options(argv[3], &plan);
    print_plan(&plan);
    return 0;
}
