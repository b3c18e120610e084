// Which words was a command of `jointplay study` given?
#include "commands/study/study_words.h"

#include "cli/common_options.h"

#include <assert.h>
#include <stdlib.h>

bool study_words_take(int key, const char *value, void *target, Err *err)
{
    (void)err;
    StudyWords *words = target;
    if (key == COMMON_QUIET) {
        words->is_quiet = true;
    } else if (key == COMMON_WIDE) {
        words->is_wide = true;
    } else {
        words->words[words->count++] = value;
    }
    return true;
}

bool study_words_run(const Arguments *arguments, int argc, char **argv,
                     bool (*work)(const StudyWords *words, Err *err), Err *err)
{
    // no command line has more words than it has arguments
    StudyWords words = {.words = calloc((size_t)argc, sizeof *words.words)};
    assert(words.words != NULL);
    bool is_answered;
    const bool is_done = arguments_parse(arguments, argc, argv, &words, &is_answered, err) &&
                         (is_answered || work(&words, err));
    free(words.words);
    return is_done;
}
