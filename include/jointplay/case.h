/* jointplay's cases from a program: open a case, set its keys, run it on a backend, and read what
 * came of it. What the commands of jointplay print can be asked for here, by the same names.
 *
 *     JpCaseError error;
 *     JpCase *pin = jp_case_open("impact-k66", &error);
 *     jp_case_set(pin, "joints.crank-coupler.radial-clearance", "20 um", &error);
 *     JpRunOptions options = jp_run_options_default();
 *     options.backends = "reference";
 *     JpAnswer *answer = jp_case_run(pin, &options, &error);
 *     JpNumber force;
 *     jp_answer_number(answer, "joints.crank-coupler.force_max_N", &force, &error);
 *
 * C17 and C++17. Numbers are in SI and radians unless a name or a unit says otherwise; NaN stands
 * for what is not known, where JSON has null. Link with libjointplay-case (pkg-config
 * jointplay-case). It is a library of its own: libjointplay, for worlds of ODE that you build
 * yourself, has the header jointplay.h.
 *
 * Errors. What can fail returns a JpCaseStatus, or NULL in place of what it makes, and fills in the
 * JpCaseError behind its last argument, which may be NULL. The text is the sentence of the command
 * line, with the place in the case, or behind the key that was set. What a call was to change or
 * fill in is untouched then. NULL for a handle, a name or a target is an error of the call and not
 * of the program, and every `free` accepts it. No function prints, ends the process, or changes its
 * signals or its locale.
 *
 * Owners. What open, parse, copy, run, settle and map give back is yours, to be freed once. Texts,
 * numbers and columns belong to the case or answer that they came from: those of a case live until
 * it is changed or freed, those of an answer until that is freed. An answer needs its case no more.
 *
 * Threads. A case or an answer belongs to one thread at a time; different ones may be used in
 * different threads at once, and give the same bits as one after the other. While a case is being
 * run every other call with it is refused with JP_CASE_ERROR_USAGE, from the callback too; freed
 * there, it goes when the run ends. Answers other than the one under way may be read in a callback.
 *
 * Memory. Where there is none a call fails with JP_CASE_ERROR_MEMORY and gives back what it had
 * taken itself; what the libraries below it (ODE, yaml, jansson) hold of that call is lost, and
 * counted by jp_case_lost. The process and all other cases and answers go on.
 *
 * ODE's handlers of errors and of memory are the process's. From the first run on ODE to its end
 * the library has its own among them, which hand on whatever is not of its own steps. If you set
 * some, set them before. Cases with ode.solver quick run one at a time, for its seed is the
 * process's, too. */
#ifndef JOINTPLAY_CASE_H
#define JOINTPLAY_CASE_H

#include <stdbool.h>
#include <stddef.h>

#ifdef __cplusplus
extern "C" {
#endif

#if defined(__GNUC__)
#define JP_CASE_API __attribute__((visibility("default")))
#else
#define JP_CASE_API
#endif

/* 2 to 5 are the exit status that the command line has for the same mistake. */
typedef enum JpCaseStatus {
    JP_CASE_OK = 0,
    JP_CASE_ERROR_USAGE = 2,     /* the call, or a value in it, is wrong */
    JP_CASE_ERROR_CASE = 3,      /* the case is wrong, or cannot be run so */
    JP_CASE_ERROR_SOLVER = 4,    /* a run failed */
    JP_CASE_ERROR_FILE = 5,      /* a file could not be read */
    JP_CASE_ERROR_MEMORY = 6,    /* there is no memory */
    JP_CASE_ERROR_CANCELLED = 7, /* the callback asked for it */
    JP_CASE_ERROR_INTERNAL = 8,  /* a mistake of the library, which it noticed: please report it */
} JpCaseStatus;

enum { JP_CASE_ERROR_SIZE = 2048 };

typedef struct JpCaseError {
    JpCaseStatus status;
    int line;   /* in the text of the case, from 1; 0 where it is not of a place */
    int column; /* likewise, in characters */
    /* one sentence, with a caret below it and what is allowed where it is of a place; UTF-8, empty
     * where there is no error */
    char text[JP_CASE_ERROR_SIZE];
} JpCaseError;

/* The version of the library that is running, such as "0.1.0". */
JP_CASE_API const char *jp_case_version(void);

/* ---- a case -------------------------------------------------------------------------------- */

/* What a case file says, and what was set since. */
typedef struct JpCase JpCase;

/* Reads a case: a path, or the name of one that came with the library, such as "impact-k66". Fails
 * with JP_CASE_ERROR_FILE or JP_CASE_ERROR_CASE. */
JP_CASE_API JpCase *jp_case_open(const char *path, JpCaseError *error);

/* The same from a text of `size` bytes, which is copied. The name, which may be NULL, stands in
 * messages for the path; files that the text names are looked for beside it. */
JP_CASE_API JpCase *jp_case_parse(const char *text, size_t size, const char *name,
                                  JpCaseError *error);

/* A case like another, with what was set in that. */
JP_CASE_API JpCase *jp_case_copy(const JpCase *of, JpCaseError *error);

JP_CASE_API void jp_case_free(JpCase *of);

/* Sets a key as --set does: the value as a case file has it, with its unit, such as "20 um", and
 * with the same checks of the whole case. NULL takes back what was set. Fails with
 * JP_CASE_ERROR_USAGE where key or value is wrong. */
JP_CASE_API JpCaseStatus jp_case_set(JpCase *of, const char *key, const char *value,
                                     JpCaseError *error);

/* The same with a number in SI, in the unit of jp_case_setting: of a diameter the diameter in m.
 * Refused where the key's value is no single number. */
JP_CASE_API JpCaseStatus jp_case_set_number(JpCase *of, const char *key, double value,
                                            JpCaseError *error);

/* Sets several keys at once, for values that are right only together. All of them, or none. */
JP_CASE_API JpCaseStatus jp_case_set_all(JpCase *of, const char *const *keys,
                                         const char *const *values, size_t count,
                                         JpCaseError *error);

/* A key as the case has it, resolved: what is not given has its default. */
typedef struct JpSetting {
    const char *key;       /* with names in it: "joints.crank-coupler.hole" */
    const char *text;      /* the value, as a case file may have it; 0 of a key that is left out and
                              has no default, which a file may not say */
    const char *unit;      /* SI, of the numbers; empty where they have none */
    size_t count;          /* numbers; 0 of words */
    const double *numbers; /* SI; of a length with a tolerance nominal, lower and upper deviation */
    bool is_used;          /* the case as it is makes use of it */
    const char *doc;       /* what the key means */
} JpSetting;

/* All settings, in the order of the pages; with a star for the name of a joint, body or spring that
 * the case does not have. */
JP_CASE_API size_t jp_case_setting_count(JpCase *of);
JP_CASE_API JpCaseStatus jp_case_setting_at(JpCase *of, size_t index, JpSetting *setting,
                                            JpCaseError *error);

/* One of them by its key; also a signal, such as "signals.gust", and a part of a sinusoid, such as
 * "signals.gust.phase" or "drive.speed.phase", which are not in the list. Fails with
 * JP_CASE_ERROR_USAGE, and says which key may have been meant. */
JP_CASE_API JpCaseStatus jp_case_setting(JpCase *of, const char *key, JpSetting *setting,
                                         JpCaseError *error);

/* Whether its backends, or those given ("reference, ode"), can run it: what jp_case_run would
 * refuse before it begins. What the case gives and makes no use of stands in `notes`, a line each,
 * empty where there is none; `notes` may be NULL. */
JP_CASE_API JpCaseStatus jp_case_check(JpCase *of, const char *backends, const char **notes,
                                       JpCaseError *error);

/* ---- runs ---------------------------------------------------------------------------------- */

/* What came of a run, of settling, or of a mapping. */
typedef struct JpAnswer JpAnswer;

/* Called now and then, at most 50 times a second, in the thread of the call: what is being done,
 * such as "reference", and its share, 0 to 1. A value other than 0 cancels the call, which fails
 * with JP_CASE_ERROR_CANCELLED within some steps. It must return: neither longjmp nor an exception
 * may leave it. */
typedef int (*JpProgress)(const char *doing, double share, void *context);

typedef struct JpRunOptions {
    size_t size; /* of this struct, set by jp_run_options_default */
    /* "reference, ode": instead of the case's run.backends; NULL: those */
    const char *backends;
    /* as --uncertified: the reference alone, in a fifth of the time, without knowing how sure it
     * is */
    bool is_uncertified;
    bool is_quick; /* as --quick: without the range over the inputs' limits */
    /* starts beside the run where the motion cannot be predicted, and growth of small changes: what
     * `run --json` has beyond the first screen */
    bool is_whole;
    /* processors at a time; 0: all that there are. No number depends on it. */
    size_t threads;
    const char *const *drivers; /* NAME=PROGRAM each, as --driver; NULL where there are none */
    size_t driver_count;
    double time_limit_s; /* of a run on another engine; 0: the usual limit */
    JpProgress progress; /* NULL: nobody watches */
    void *context;       /* of progress */
    /* what happens between samples is kept: the series has its smallest and largest values, and the
     * picture marks what was there */
    bool has_ranges;
    /* every contact is kept, as with --contacts, for the table of that name; the peak of each is
     * looked for, which takes evaluations */
    bool has_contacts;
} JpRunOptions;

/* Those of `jointplay run --json`. Set fields in it. */
JP_CASE_API JpRunOptions jp_run_options_default(void);

/* Runs the case as it is, as `jointplay run` does. With NULL for the options: the default. A
 * backend that fails is an error only where all do; jp_answer_word of "ode.message" says why. */
JP_CASE_API JpAnswer *jp_case_run(JpCase *of, const JpRunOptions *options, JpCaseError *error);

/* Finds the motion that is left of the case's start, and nothing else: `settled` of `run --json`.
 * Of the options progress and threads count. */
JP_CASE_API JpAnswer *jp_case_settle(JpCase *of, const JpRunOptions *options, JpCaseError *error);

/* What `jointplay map` has options for, each as there, or NULL. */
typedef struct JpMapOptions {
    size_t size;         /* of this struct, set by jp_map_options_default */
    const char *steps;   /* "10 us, 3 us, 1 us"; NULL: 30 to 0.1 us and the case's own */
    const char *at_step; /* a step that cannot be changed; not with steps */
    const char *maps;    /* "textbook, corrected"; NULL: all */
    const char *laws;    /* "hertz-socket, johnson", or "all"; NULL: the case's */
    const char *mass;    /* "median", "most", or "0.1 kg" */
    const char *speed;   /* "median", "most", or "0.1 m/s" */
    size_t threads;
    JpProgress progress;
    void *context;
} JpMapOptions;

JP_CASE_API JpMapOptions jp_map_options_default(void);

/* Finds ERP, CFM and step of each joint with play: numbers and JSON are those of `map --json`. */
JP_CASE_API JpAnswer *jp_case_map(JpCase *of, const JpMapOptions *options, JpCaseError *error);

/* ---- answers ------------------------------------------------------------------------------- */

JP_CASE_API void jp_answer_free(JpAnswer *of);

/* What the command prints with --json, of `length` bytes and a 0 behind them. `length` may be NULL.
 * NULL on failure. */
JP_CASE_API const char *jp_answer_json(JpAnswer *of, size_t *length, JpCaseError *error);

/* The same for people: "screen", what the command prints, in 80 columns without colours; "full",
 * with --full; "picture", what --plot draws, as SVG. Of settling there is "screen" alone. */
JP_CASE_API const char *jp_answer_text(JpAnswer *of, const char *form, size_t *length,
                                       JpCaseError *error);

/* A number of an answer. */
typedef struct JpNumber {
    const char *name;
    double value;     /* NaN: not known; a flag is 0 or 1 */
    const char *unit; /* SI, or "deg"; empty where it has none */
    const char *doc;  /* what it means; empty where only docs/output.md says it */
    /* by how much it may be off, in its unit: of speeds of the certified reference; NaN: not known,
     * or only of the run as a whole ("truth.uncertainty", "ode.error.max") */
    double uncertainty;
} JpNumber;

/* A number by its name on docs/output.md, with a point between keys, and from 0 the place in a
 * list: "joints.crank-coupler.force_max_N", "truth.uncertainty", "settled.motions.0.period". What
 * stands in `runs` there is that of the first backend that was asked for; with its name in front it
 * is that of another, "ode.error.max". Fails with JP_CASE_ERROR_USAGE where there is no such name,
 * and says which may have been meant. */
JP_CASE_API JpCaseStatus jp_answer_number(JpAnswer *of, const char *name, JpNumber *number,
                                          JpCaseError *error);

/* All of them, each under a name that jp_answer_number takes, those of every run with its backend
 * in front. 0 on failure. */
JP_CASE_API size_t jp_answer_number_count(JpAnswer *of, JpCaseError *error);
JP_CASE_API JpCaseStatus jp_answer_number_at(JpAnswer *of, size_t index, JpNumber *number,
                                             JpCaseError *error);

/* A word of an answer by the same kind of name, such as "status", "message", "ode.error.against";
 * null there is the empty word. */
JP_CASE_API JpCaseStatus jp_answer_word(JpAnswer *of, const char *name, const char **word,
                                        JpCaseError *error);

/* A column of a table. */
typedef struct JpColumn {
    const char *name;      /* such as "follower_omega_rad_s" */
    const char *unit;      /* SI; empty where it has none */
    const char *doc;       /* what it means; may be empty */
    size_t count;          /* rows */
    const double *numbers; /* `count`, contiguous; NULL: the column has words */
    const char *const *words;
} JpColumn;

/* Tables of a run: "series", a row a sample, columns as --series writes them; "contacts", as
 * --contacts does (has_contacts); "spikes", of accelerations and joint forces, columns by the names
 * of docs/output.md. As with numbers those of the first backend, or "ode.series". A column is made
 * when it is first asked for, and is the answer's from then on: nothing is copied to hand it out.
 * The count is 0 on failure, of a table that does not exist, and of a run that failed. */
JP_CASE_API size_t jp_answer_column_count(JpAnswer *of, const char *table, JpCaseError *error);
JP_CASE_API JpCaseStatus jp_answer_column_at(JpAnswer *of, const char *table, size_t index,
                                             JpColumn *column, JpCaseError *error);
JP_CASE_API JpCaseStatus jp_answer_column(JpAnswer *of, const char *table, const char *name,
                                          JpColumn *column, JpCaseError *error);

/* ---- what there is ------------------------------------------------------------------------- */

/* A key of case files. All of it lives as long as the library. */
typedef struct JpKey {
    const char *path; /* with a star for a name: "joints.*.hole" */
    const char *unit; /* SI, of its number; empty where it has none */
    const char *doc;  /* what it means */
    double low;       /* SI: the least number that is allowed; NaN of words */
    double high;      /* the largest */
    const char *const
        *words; /* that it allows, behind the last NULL; NULL where it takes no word */
} JpKey;

/* The keys of case files, in the order of docs/case-format.md. */
JP_CASE_API size_t jp_key_count(void);
JP_CASE_API JpCaseStatus jp_key_at(size_t index, JpKey *key);

/* A number that runs have. */
typedef struct JpQuantity {
    const char *path; /* with a star for a name, as in docs/output.md: "joints.*.force_max_N" */
    const char *name; /* without the unit: "force_max" */
    const char *unit; /* SI; empty where it has none */
    const char *doc;  /* what it means */
    bool is_timed;    /* <name>_crank_deg beside it says where it stood */
} JpQuantity;

/* The numbers of a run that JSON has, those of joints once for forces and once for torques where
 * limits turn them. */
JP_CASE_API size_t jp_quantity_count(void);
JP_CASE_API JpCaseStatus jp_quantity_at(size_t index, JpQuantity *quantity);

/* Calls that broke off without memory, or on a mistake of the library, since the process began, and
 * in `bytes`, unless it is NULL, what ODE had taken in them and keeps. */
JP_CASE_API size_t jp_case_lost(size_t *bytes);

#ifdef __cplusplus
}
#endif

#endif
