// How does a study go past one machine?
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

#include <inttypes.h>
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

// What both jobs ask of Slurm.
static void write_head(const SlurmJob *job, const char *ending, uint64_t cpus, Text *text)
{
    char name[NAME_SIZE];
    find_name(job->stem, name);
    text_append(text, "#SBATCH --job-name=%s%s\n#SBATCH --cpus-per-task=%" PRIu64 "\n", name,
                ending, cpus);
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
    text_append(text, "#SBATCH --requeue\n#SBATCH --open-mode=append\n");
}

static void write_variable(const char *name, const char *value, Text *text)
{
    text_append(text, "%s=", name);
    shell_append_word(text, value);
    text_append(text, "\n");
}

static void write_variables(const SlurmJob *job, Text *text)
{
    text_append(text, "\nset -u\n");
    write_variable("program", job->program, text);
    write_variable("folder", job->folder, text);
    text_append(text, "shards=%" PRIu64 "\n", job->shards);
}

// What a task does.
static const char ARRAY_BODY[] =
    "\n"
    "# By its place in the array: one of the tasks has the number of the whole array.\n"
    "task=${SLURM_ARRAY_JOB_ID}_$SLURM_ARRAY_TASK_ID\n"
    "restarts=${SLURM_RESTART_COUNT:-0}\n"
    "say() { printf '%s %s: %s\\n' \"$(date '+%F %T')\" \"$task\" \"$*\"; }\n"
    "\n"
    "# Slurm tells this shell alone, a minute before the time limit; the study ends in good\n"
    "# order when it is told.\n"
    "child=\n"
    "is_told=\n"
    "tell() { is_told=yes; [ -z \"$child\" ] || kill -TERM \"$child\" 2>/dev/null; }\n"
    "trap tell TERM\n"
    "\n"
    "cd \"$folder\" || exit 5\n"
    "say \"shard $SLURM_ARRAY_TASK_ID of $shards on ${SLURMD_NODENAME:-?}, try "
    "$((restarts + 1))\"\n"
    "\"$program\" study \"$study\" --shard \"$SLURM_ARRAY_TASK_ID/$shards\" \\\n"
    "    --jobs \"$SLURM_CPUS_PER_TASK\" &\n"
    "child=$!\n"
    "[ -z \"$is_told\" ] || tell\n"
    "# a signal ends the wait, but not yet the study\n"
    "while kill -0 \"$child\" 2>/dev/null; do wait \"$child\"; done\n"
    "wait \"$child\"\n"
    "status=$?\n"
    "[ \"$status\" != 0 ] || { say complete; exit 0; }\n"
    "# nothing to be tried again: the gather job says what is missing, if anything is\n"
    "[ \"$status\" != 4 ] || { say 'over, but no run went well'; exit 4; }\n"
    "\n"
    "if [ -n \"$is_told\" ]; then\n"
    "    reason='told to end'\n"
    "elif [ \"$status\" -gt 128 ]; then\n"
    "    reason=\"killed (status $status)\"\n"
    "elif [ \"$status\" = 5 ] && [ \"$restarts\" -gt 0 ]; then\n"
    "    reason='could not use its store, which an earlier try may still hold'\n"
    "else\n"
    "    say \"failed with status $status; another try would end the same\"\n"
    "    exit \"$status\"\n"
    "fi\n"
    "# whoever is cancelled or put back already is no longer running: that is left as it is\n"
    "if [ \"$(squeue --noheader --jobs=\"$task\" --format=%T)\" != RUNNING ]; then\n"
    "    say \"$reason\"\n"
    "    exit \"$status\"\n"
    "fi\n"
    "if [ \"$restarts\" -ge \"$requeues\" ]; then\n"
    "    say \"$reason after $restarts requeues, the most; submit the study again to go on\"\n"
    "    exit \"$status\"\n"
    "fi\n"
    "say \"$reason; back in the queue\"\n"
    "scontrol requeue \"$task\"\n"
    "exit \"$status\"\n";

void slurm_write_array(const SlurmJob *job, Text *text)
{
    char name[NAME_SIZE];
    find_name(job->stem, name);
    text_append(text, "#!/bin/bash\n"
                      "# One shard of a study: a task of a job array. "
                      "Written by 'jointplay study slurm'.\n");
    write_head(job, "", job->cpus, text);
    text_append(text,
                "#SBATCH --array=1-%" PRIu64 "\n"
                "#SBATCH --signal=B:TERM@60\n"
                "#SBATCH --output=%s.%%a-of-%" PRIu64 ".log\n",
                job->shards, name, job->shards);
    write_variables(job, text);
    write_variable("study", job->study, text);
    text_append(text, "requeues=%" PRIu64 "\n", job->requeues);
    text_append(text, "%s", ARRAY_BODY);
}

// A task that has failed leaves gaps and not a job that waits for ever: the gather job follows
// whatever became of the array (afterany, not afterok), and looks for itself what is missing.
static const char GATHER_BODY[] =
    "\n"
    "cd \"$folder\" || exit 5\n"
    "stores=()\n"
    "for ((i = 1; i <= shards; i++)); do\n"
    "    store=./$stem.$i-of-$shards.sqlite\n"
    "    if [ -e \"$store\" ]; then stores+=(\"$store\"); else echo \"there is no $store\"; fi\n"
    "done\n"
    "words=$(\"$program\" study merge \"./$stem.sqlite\" \"${stores[@]}\" 2>&1)\n"
    "status=$?\n"
    "printf '%s\\n' \"$words\"\n"
    "[ $status = 0 ] || exit $status\n"
    "\"$program\" study status \"./$stem.sqlite\" || exit\n"
    "[[ $words =~ holds\\ ([0-9]+)\\ of\\ ([0-9]+) ]]\n"
    "if [ \"${BASH_REMATCH[1]-0}\" != \"${BASH_REMATCH[2]-all}\" ]; then\n"
    "    echo \"runs are missing; the logs of the shards say why, and ./$stem.submit.sh once more "
    "\"\\\n"
    "        \"makes them\"\n"
    "    exit 1\n"
    "fi\n";

void slurm_write_gather(const SlurmJob *job, Text *text)
{
    char name[NAME_SIZE];
    find_name(job->stem, name);
    text_append(text, "#!/bin/bash\n"
                      "# Gathers the shards of a study. Written by 'jointplay study slurm'.\n");
    write_head(job, ".gather", 1, text);
    text_append(text, "#SBATCH --output=%s.gather.log\n", name);
    write_variables(job, text);
    write_variable("stem", job->stem, text);
    text_append(text, "%s", GATHER_BODY);
}

static const char SUBMIT_BODY[] =
    "\n"
    "# Options given here go to both jobs. Runs that are there already are not made again, so "
    "that\n"
    "# whatever is missing is made by submitting once more.\n"
    "cd \"$folder\"\n"
    "array=$(sbatch --parsable \"$@\" \"./$stem.array.sh\")\n"
    "array=${array%%;*}\n"
    "if ! gather=$(sbatch --parsable --dependency=\"afterany:$array\" \"$@\" "
    "\"./$stem.gather.sh\"); then\n"
    "    scancel \"$array\"\n"
    "    exit 1\n"
    "fi\n"
    "echo \"array $array of $shards shards, then gather ${gather%%;*}\"\n";

void slurm_write_submit(const SlurmJob *job, Text *text)
{
    text_append(text, "#!/bin/bash\n"
                      "# Submits a study to Slurm: its shards, and what gathers them. "
                      "Written by 'jointplay study slurm'.\n"
                      "set -eu\n");
    write_variable("folder", job->folder, text);
    write_variable("stem", job->stem, text);
    text_append(text, "shards=%" PRIu64 "\n%s", job->shards, SUBMIT_BODY);
}
