// Which words was a command of `jointplay study` given?
#include "commands/study/study_words.h"

#include <assert.h>
#include <stdlib.h>

bool study_words_read(const char *word, void *target, Err *err)
{
    (void)err;
    StudyWords *words = target;
    words->words[words->count++] = word;
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
