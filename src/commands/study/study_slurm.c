// Writes the scripts that run a study on a cluster, and says what is to be typed then.
#include "commands/study/study_slurm.h"
#include "base/shell.h"
#include "base/shipped.h"
#include "cli/arguments.h"
#include "cli/common_options.h"
#include "cli/output.h"
#include "cli/written.h"
#include "commands/study/design.h"
#include "commands/study/study.h"
#include "write/file.h"

#include <assert.h>
#include <errno.h>
#include <inttypes.h>
#include <regex.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

// The scripts are slurm_*.sh beside this file, with @word@ where a job's own words go.
//
// The scripts are slurm_*.sh beside this file, with @word@ where a job's own values go.
//
// A task of a job array makes one shard into a store of its own, so that no two machines ever write
// to one file. A store keeps every run that was finished, so that a task which is put back in the
// queue goes on where it stood: the script only has to tell what is worth another try.
//   told to end (the time limit nears, the node is wanted): the study ends in good order; again
//   killed (status above 128: no memory, kill -9): again
//   its store could not be used (5), and it is not the first try: the first may be at it still, on
//   a node that only the controller lost sight of; again
//   any other status: it would be the same the next time; the task has failed
// SLURM_RESTART_COUNT bounds the tries. A node that dies needs nothing of this: Slurm itself puts
// its jobs back (--requeue).

enum { NAME_SIZE = 128 };

// A name for what Slurm reads by rules of its own, where % and quotes mean something.
static void study_slurm_find_name(const char *stem, char name[NAME_SIZE])
{
    static const char PLAIN[] = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789._-";
    text_copy(name, NAME_SIZE, stem);
    for (char *letter = name; *letter != '\0'; letter++) {
        *letter = strchr(PLAIN, *letter) != NULL ? *letter : '_';
    }
}

// What both jobs ask of Slurm where it is given, by regular expressions of what Slurm takes.
static const struct {
    const char *option;
    size_t offset; // in a SlurmJob
    const char *pattern;
    const char *allowed;
} ASKED[] = {
    {"time", offsetof(SlurmJob, time), "^([0-9]{1,6}-)?[0-9]{1,6}(:[0-9]{1,6}){0,2}$",
     "what Slurm takes, MINUTES, MINUTES:SECONDS, HOURS:MINUTES:SECONDS, DAYS-HOURS, "
     "DAYS-HOURS:MINUTES or DAYS-HOURS:MINUTES:SECONDS"},
    {"mem", offsetof(SlurmJob, memory), "^0*[1-9][0-9]*[KMGTkmgt]?$",
     "what Slurm takes, a whole number above 0 with K, M, G or T behind it, or nothing for "
     "megabytes"},
    {"partition", offsetof(SlurmJob, partition), "^[A-Za-z0-9][A-Za-z0-9._,-]*$",
     "names of letters, digits and ._-, with commas between them"},
    {"account", offsetof(SlurmJob, account), "^[A-Za-z0-9][A-Za-z0-9._-]*$",
     "letters, digits and ._-"},
};
enum { ASKED_COUNT = sizeof ASKED / sizeof *ASKED };

static const char *asked_value(const SlurmJob *job, size_t i)
{
    return *(const char *const *)(const void *)((const char *)job + ASKED[i].offset);
}

static bool is_match(const char *word, const char *pattern)
{
    regex_t compiled;
    const int status = regcomp(&compiled, pattern, REG_EXTENDED | REG_NOSUB);
    assert(status == 0);
    const bool is_found = regexec(&compiled, word, 0, NULL, 0) == 0;
    regfree(&compiled);
    return is_found;
}

// Hours come first, but for M and M:S.
static unsigned long seconds_of(const char *time)
{
    unsigned long days = 0, fields[3] = {0};
    const bool has_days = strchr(time, '-') != NULL;
    const int count = sscanf(has_days ? strchr(time, '-') + 1 : time, "%lu:%lu:%lu", &fields[0],
                             &fields[1], &fields[2]);
    if (has_days) {
        sscanf(time, "%lu", &days);
    }
    return has_days || count == 3 ? 86400 * days + 3600 * fields[0] + 60 * fields[1] + fields[2]
                                  : 60 * fields[0] + fields[1];
}

bool slurm_check(const SlurmJob *job, Err *err)
{
    for (size_t i = 0; i < ASKED_COUNT; i++) {
        const char *value = asked_value(job, i);
        if (value != NULL && !is_match(value, ASKED[i].pattern)) {
            return err_set(err, ERR_USAGE, "--%s is %s; allowed: %s", ASKED[i].option, value,
                           ASKED[i].allowed);
        }
    }
    return job->time == NULL || seconds_of(job->time) >= 60 * SLURM_TIME_LEAST_MINUTES ||
           err_set(err, ERR_USAGE,
                   "--time is %s; allowed: %d minutes and more, because a job is asked to end a "
                   "minute or two before",
                   job->time, SLURM_TIME_LEAST_MINUTES);
}

static void append_asked(const SlurmJob *job, Text *text)
{
    for (size_t i = 0; i < ASKED_COUNT; i++) {
        if (asked_value(job, i) != NULL) {
            text_append(text, "#SBATCH --%s=%s\n", ASKED[i].option, asked_value(job, i));
        }
    }
}

static void append_drivers(const SlurmJob *job, Text *text)
{
    for (size_t i = 0; i < job->driver_count; i++) {
        text_append(text, i == 0 ? "--driver " : " --driver ");
        shell_append_word(text, job->drivers[i]);
    }
}

// Appends what stands for a word between two @. False where it is none of them.
static bool append_value(const SlurmJob *job, const char *word, size_t length, Text *text)
{
    const struct {
        const char *word;
        const char *value; // as a word of the shell; NULL: the number
        size_t number;
    } VALUES[] = {
        {"program", job->program, 0},      {"study", job->study, 0},
        {"folder", job->folder, 0},        {"stem", job->stem, 0},
        {"cpus", NULL, job->cpus},         {"shards", NULL, job->shards},
        {"requeues", NULL, job->requeues},
    };
    char name[NAME_SIZE];
    for (size_t i = 0; i < sizeof VALUES / sizeof *VALUES; i++) {
        if (strlen(VALUES[i].word) == length && strncmp(VALUES[i].word, word, length) == 0) {
            if (VALUES[i].value != NULL) {
                shell_append_word(text, VALUES[i].value);
            } else {
                text_append(text, "%zu", VALUES[i].number);
            }
            return true;
        }
    }
    if (strncmp(word, "name@", length + 1) == 0) {
        study_slurm_find_name(job->stem, name);
        text_append(text, "%s", name);
        return true;
    }
    if (strncmp(word, "asked@", length + 1) == 0) {
        append_asked(job, text);
        return true;
    }
    if (strncmp(word, "drivers@", length + 1) == 0) {
        append_drivers(job, text);
        return true;
    }
    return false;
}

// slurm_array.sh, slurm_gather.sh and slurm_submit.sh, put into the program by the build.
extern const char embedded_slurm_array[];
extern const char embedded_slurm_gather[];
extern const char embedded_slurm_submit[];

void slurm_write(const SlurmJob *job, SlurmScript script, Text *text)
{
    static const char *const SCRIPTS[SLURM_SCRIPT_COUNT] = {
        embedded_slurm_array, embedded_slurm_gather, embedded_slurm_submit};
    const char *rest = SCRIPTS[script];
    while (*rest != '\0') {
        const size_t plain = strcspn(rest, "@");
        text_append(text, "%.*s", (int)plain, rest);
        rest += plain;
        if (*rest == '@') {
            const size_t length = strspn(rest + 1, "abcdefghijklmnopqrstuvwxyz");
            const bool is_value =
                rest[1 + length] == '@' && append_value(job, rest + 1, length, text);
            text_append(text, is_value ? "" : "@");
            rest += is_value ? length + 2 : 1;
        }
    }
}

enum { SCRIPT_RIGHTS = 0777 };

typedef struct SlurmOptions {
    const char *path;                       // of the study
    SlurmJob job;                           // its folder as given; the other paths are found
    const char *drivers[ENGINE_DRIVER_MAX]; // as given
    size_t driver_count;
    bool is_dry;
    bool is_quiet;
} SlurmOptions;

#define AT(field) .offset = offsetof(SlurmOptions, field)

static const OptionRow SLURM_OPTIONS[] = {
    {"shards", "N", "Tasks of the job array, each with a store of its own", 0, OPTION_COUNT,
     AT(job.shards), .low = SLURM_SHARD_LEAST, .high = SLURM_SHARD_MAX, .letter = 'n'},
    {"cpus", "N", "Runs at a time in each task (default: 1)", 0, OPTION_COUNT, AT(job.cpus),
     .low = 1, .high = SLURM_CPU_MAX, .letter = 'c'},
    {"time", "TIME", "Time limit of each task, as Slurm writes it: 4:00:00, 1-12", 0, OPTION_TEXT,
     AT(job.time), .letter = 't'},
    {"mem", "SIZE", "Memory of each task, as Slurm writes it: 4G", 0, OPTION_TEXT, AT(job.memory)},
    {"partition", "NAME", "Partition of both jobs", 0, OPTION_TEXT, AT(job.partition),
     .letter = 'p'},
    {"account", "NAME", "Account of both jobs", 0, OPTION_TEXT, AT(job.account), .letter = 'A'},
    {"driver", "NAME=PROGRAM", "A program that runs cases on the engine NAME; may be given often",
     0, OPTION_LIST, AT(drivers), .what = "drivers",
     .count_offset = offsetof(SlurmOptions, driver_count), .high = ENGINE_DRIVER_MAX},
    {"requeues", "N",
     "Times a task that is killed or runs out of time goes back in the queue (default: 10)", 0,
     OPTION_COUNT, AT(job.requeues), .low = 0, .high = SLURM_REQUEUE_MAX},
    {"out", "DIR", "Where scripts, logs and stores go (default: here)", 0, OPTION_TEXT,
     AT(job.folder), .letter = 'o'},
    {"dry-run", NULL, "Print the scripts and write nothing", 0, OPTION_FLAG, AT(is_dry)},
    {"quiet", NULL, "Nothing on standard error but errors", 0, OPTION_FLAG, AT(is_quiet),
     .letter = 'q'},
};

static bool study_slurm_check(void *target, Err *err)
{
    const SlurmOptions *options = target;
    if (options->path == NULL) {
        return err_set(err, ERR_USAGE, "no study given: jointplay study slurm FILE --shards N");
    }
    return options->job.shards > 0 ||
           err_set(err, ERR_USAGE,
                   "no number of shards given: --shards N, the tasks of the job array");
}

// A shard without a run would be a job for nothing.
static bool check_shards(const SlurmOptions *options, Err *err)
{
    Spec *spec = spec_open(options->path, err);
    const bool is_right = spec != NULL && (options->job.shards <= design_run_count(spec) ||
                                           err_set(err, ERR_USAGE,
                                                   "--shards is %zu; the study has %" PRIu64
                                                   " runs, and a shard has at least one",
                                                   options->job.shards, design_run_count(spec)));
    spec_close(spec);
    return is_right;
}

// A path that holds wherever a job begins.
static bool find_whole(const char *path, char target[FILE_PATH_SIZE], Err *err)
{
    char found[FILE_PATH_SIZE];
    shipped_find(path, found, sizeof found);
    char *whole = realpath(found, NULL);
    if (whole == NULL || strlen(whole) >= FILE_PATH_SIZE) {
        free(whole);
        return err_set(err, ERR_FILE, "cannot find %s: %s", path, strerror(errno));
    }
    text_copy(target, FILE_PATH_SIZE, whole);
    free(whole);
    return true;
}

// The drivers, whose programs are found from wherever a job begins. For free_drivers.
static bool find_drivers(const SlurmOptions *options, SlurmJob *job, Err *err)
{
    for (size_t i = 0; i < options->driver_count; i++) {
        const char *given = options->drivers[i];
        BackendKind backend;
        char program[FILE_PATH_SIZE];
        if (!common_options_driver(given, &backend, err) ||
            !find_whole(strchr(given, '=') + 1, program, err)) {
            return false;
        }
        Text text;
        text_init(&text);
        text_append(&text, "%.*s=%s", (int)strcspn(given, "="), given, program);
        job->drivers[job->driver_count++] = text.data;
    }
    return true;
}

static void free_drivers(SlurmJob *job)
{
    for (size_t i = 0; i < job->driver_count; i++) {
        free(job->drivers[i]);
    }
}

// What the names of the study's stores begin with.
static bool find_stem(const char *study, char stem[FILE_PATH_SIZE], Err *err)
{
    if (!study_path_name(study, (Shard){0, 1}, stem, err)) {
        return false;
    }
    *strrchr(stem, '.') = '\0';
    return true;
}

static const char *const ENDINGS[SLURM_SCRIPT_COUNT] = {"array.sh", "gather.sh", "submit.sh"};

// Makes a script executable for all who may read it, as far as the user's umask allows.
static bool let_run(const char *path, Err *err)
{
    const mode_t mask = umask(0);
    umask(mask);
    return chmod(path, SCRIPT_RIGHTS & ~mask) == 0 ||
           err_set(err, ERR_FILE, "cannot make %s a script: %s", path, strerror(errno));
}

static bool find_script(const SlurmJob *job, size_t number, char path[FILE_PATH_SIZE], Err *err)
{
    const char *ending = ENDINGS[number];
    const int length = snprintf(path, FILE_PATH_SIZE, "%s/%s.%s", job->folder, job->stem, ending);
    return (length >= 0 && length < FILE_PATH_SIZE) ||
           err_set(err, ERR_FILE, "the path of %s.%s is too long", job->stem, ending);
}

static bool claim_scripts(const SlurmJob *job, Err *err)
{
    for (size_t i = 0; i < SLURM_SCRIPT_COUNT; i++) {
        char path[FILE_PATH_SIZE];
        if (!find_script(job, i, path, err) || !file_claim("--out", FILE_SCRIPT, path, err)) {
            return false;
        }
    }
    return true;
}

static bool write_scripts(const SlurmJob *job, const SlurmOptions *options, Err *err)
{
    for (size_t i = 0; i < SLURM_SCRIPT_COUNT; i++) {
        char path[FILE_PATH_SIZE];
        if (!find_script(job, i, path, err)) {
            return false;
        }
        Text text;
        text_init(&text);
        slurm_write(job, (SlurmScript)i, &text);
        const bool is_written = written_text(FILE_SCRIPT, path, text.data, options->is_quiet, err);
        text_finish(&text);
        if (!is_written || !let_run(path, err)) {
            return false;
        }
    }
    return true;
}

static void print_scripts(const SlurmJob *job)
{
    Text text;
    text_init(&text);
    for (size_t i = 0; i < SLURM_SCRIPT_COUNT; i++) {
        text_append(&text, "%s==> ", i == 0 ? "" : "\n");
        text_append_shown(&text, job->stem);
        text_append(&text, ".%s <==\n", ENDINGS[i]);
        slurm_write(job, (SlurmScript)i, &text);
    }
    fputs(text.data, stdout);
    text_finish(&text);
}

// What to type, and what the cluster may have against it.
static void say_next(const SlurmJob *job, const SlurmOptions *options)
{
    char path[2 * FILE_PATH_SIZE];
    Text text;
    text_init(&text);
    snprintf(path, sizeof path, "%s/%s.submit.sh", job->folder, job->stem);
    shell_append_word(&text, path);
    printf("%s\n", text.data);
    text_finish(&text);
    if (!options->is_quiet && job->shards > SLURM_ARRAY_USUAL) {
        output_say("jointplay: %zu shards are more than a job array has tasks unless "
                   "MaxArraySize is raised ('scontrol show config'); %d is usual\n",
                   job->shards, SLURM_ARRAY_USUAL);
    }
}

static bool write_job(const SlurmJob *job, const SlurmOptions *options, Err *err)
{
    if (options->is_dry) {
        print_scripts(job);
        return true;
    }
    if (!claim_scripts(job, err) || !write_scripts(job, options, err)) {
        return false;
    }
    say_next(job, options);
    return true;
}

static bool make_scripts(void *target, Err *err)
{
    const SlurmOptions *options = target;
    char program[FILE_PATH_SIZE];
    char study[FILE_PATH_SIZE];
    char folder[FILE_PATH_SIZE];
    char stem[FILE_PATH_SIZE];
    char *drivers[ENGINE_DRIVER_MAX];
    SlurmJob job = options->job;
    job.program = program;
    job.study = study;
    job.folder = folder;
    job.stem = stem;
    job.drivers = drivers;
    const bool is_done =
        slurm_check(&job, err) && check_shards(options, err) && find_drivers(options, &job, err) &&
        (options->is_dry || file_make_folder(options->job.folder, err)) &&
        find_stem(options->path, stem, err) && find_whole("/proc/self/exe", program, err) &&
        find_whole(options->path, study, err) && find_whole(options->job.folder, folder, err) &&
        write_job(&job, options, err);
    free_drivers(&job);
    return is_done;
}

static const Arguments STUDY_SLURM_ARGUMENTS = {
    .program = "jointplay study slurm",
    .usage = "FILE --shards N",
    .doc = "Writes the scripts that make a study on a cluster: a job array of shards, a job "
           "that merges their stores, and a script that submits both."
           "\vA task that is killed, preempted or runs out of time goes back in the queue and "
           "resumes where it was.",
    .argument = {.type = OPTION_TEXT, AT(path), .what = "slurm takes one study"},
    OPTION_ROWS(SLURM_OPTIONS),
    .check = study_slurm_check,
};
#undef AT

static bool study_slurm_run(int argc, char **argv, Err *err)
{
    SlurmOptions options = {.job = {.folder = ".", .cpus = 1, .requeues = SLURM_REQUEUE_USUAL}};
    return arguments_run(&STUDY_SLURM_ARGUMENTS, argc, argv, &options, make_scripts, err);
}

const Command study_command_slurm = {
    .name = "slurm",
    .summary = "writes the scripts that make a study on a cluster",
    .run = study_slurm_run,
    .arguments = &STUDY_SLURM_ARGUMENTS,
};
