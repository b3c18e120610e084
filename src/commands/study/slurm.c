// How does a study go past one machine?
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
#include "commands/study/slurm.h"

#include "base/shell.h"

#include <assert.h>
#include <regex.h>
#include <stdio.h>
#include <string.h>

enum { NAME_SIZE = 128 };

// A name for what Slurm reads by rules of its own, where % and quotes mean something.
static void find_name(const char *stem, char name[NAME_SIZE])
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
        find_name(job->stem, name);
        text_append(text, "%s", name);
        return true;
    }
    if (strncmp(word, "asked@", length + 1) == 0) {
        append_asked(job, text);
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
