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

#include <stdint.h>
#include <stdio.h>
#include <string.h>

enum { NAME_SIZE = 128, FIELD_MAX = 3, DIGIT_MAX = 6 };

// A name for what Slurm reads by rules of its own, where % and quotes mean something.
static void find_name(const char *stem, char name[NAME_SIZE])
{
    static const char PLAIN[] = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789._-";
    text_copy(name, NAME_SIZE, stem);
    for (char *letter = name; *letter != '\0'; letter++) {
        *letter = strchr(PLAIN, *letter) != NULL ? *letter : '_';
    }
}

// Whether a word is of letters, digits and a few marks, the first a letter or digit.
static bool is_plain(const char *word, const char *marks)
{
    static const char PLAIN[] = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789";
    size_t length = strspn(word, PLAIN);
    if (length == 0) {
        return false;
    }
    while (word[length] != '\0' &&
           (strchr(PLAIN, word[length]) != NULL || strchr(marks, word[length]) != NULL)) {
        length++;
    }
    return word[length] == '\0';
}

// Reads whole numbers between colons, at most so many; 0 where it is anything else.
static size_t read_fields(const char *text, size_t most, uint64_t fields[FIELD_MAX])
{
    for (size_t count = 0; count < most; count++) {
        const size_t digits = strspn(text, "0123456789");
        if (digits == 0 || digits > DIGIT_MAX) {
            return 0;
        }
        fields[count] = 0;
        for (size_t i = 0; i < digits; i++) {
            fields[count] = 10 * fields[count] + (uint64_t)(text[i] - '0');
        }
        text += digits;
        if (*text == '\0') {
            return count + 1;
        }
        if (*text++ != ':') {
            return 0;
        }
    }
    return 0;
}

// The time limit in seconds: M, M:S, H:M:S, D-H, D-H:M or D-H:M:S; 0 where it is none of these.
static uint64_t read_time(const char *text)
{
    uint64_t days[FIELD_MAX] = {0};
    uint64_t fields[FIELD_MAX] = {0};
    char day[DIGIT_MAX + 1];
    const size_t length = strcspn(text, "-");
    const bool has_days = text[length] == '-';
    text_copy(day, sizeof day, text);
    if (has_days && length <= DIGIT_MAX) {
        day[length] = '\0';
    }
    const size_t count = read_fields(has_days ? text + length + 1 : text, FIELD_MAX, fields);
    if (count == 0 || (has_days && read_fields(day, 1, days) == 0)) {
        return 0;
    }
    // hours come first, but for M and M:S
    const bool has_hours = has_days || count == FIELD_MAX;
    return has_hours ? 86400 * days[0] + 3600 * fields[0] + 60 * fields[1] + fields[2]
                     : 60 * fields[0] + fields[1];
}

static bool memory_is_right(const char *text)
{
    const size_t digits = strspn(text, "0123456789");
    const char *unit = text + digits;
    return digits > 0 && strspn(text, "0") < digits &&
           (*unit == '\0' || (strchr("KMGTkmgt", *unit) != NULL && unit[1] == '\0'));
}

bool slurm_check(const SlurmJob *job, Err *err)
{
    if (job->time != NULL && read_time(job->time) == 0) {
        return err_set(err, ERR_USAGE,
                       "--time is %s; allowed: what Slurm takes, MINUTES, MINUTES:SECONDS, "
                       "HOURS:MINUTES:SECONDS, DAYS-HOURS, DAYS-HOURS:MINUTES or "
                       "DAYS-HOURS:MINUTES:SECONDS",
                       job->time);
    }
    if (job->time != NULL && read_time(job->time) < 60 * SLURM_TIME_LEAST_MINUTES) {
        return err_set(err, ERR_USAGE,
                       "--time is %s; allowed: %d minutes and more, for a job is told to end a "
                       "minute or two before",
                       job->time, SLURM_TIME_LEAST_MINUTES);
    }
    if (job->memory != NULL && !memory_is_right(job->memory)) {
        return err_set(err, ERR_USAGE,
                       "--mem is %s; allowed: what Slurm takes, a whole number above 0 with K, M, "
                       "G or T behind it, or nothing for megabytes",
                       job->memory);
    }
    if (job->partition != NULL && !is_plain(job->partition, "._-,")) {
        return err_set(err, ERR_USAGE,
                       "--partition is %s; allowed: names of letters, digits and ._-, with commas "
                       "between them",
                       job->partition);
    }
    return job->account == NULL || is_plain(job->account, "._-") ||
           err_set(err, ERR_USAGE, "--account is %s; allowed: letters, digits and ._-",
                   job->account);
}

// What both jobs ask of Slurm beyond their names and processors.
static void append_asked(const SlurmJob *job, Text *text)
{
    const struct {
        const char *option;
        const char *value;
    } asked[] = {{"time", job->time},
                 {"mem", job->memory},
                 {"partition", job->partition},
                 {"account", job->account}};
    for (size_t i = 0; i < sizeof asked / sizeof *asked; i++) {
        if (asked[i].value != NULL) {
            text_append(text, "#SBATCH --%s=%s\n", asked[i].option, asked[i].value);
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
