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
                     bool (*work)(void *words, Err *err), Err *err)
{
    // no command line has more words than it has arguments
    StudyWords words = {.words = calloc((size_t)argc, sizeof *words.words)};
    assert(words.words != NULL);
    const bool is_done = arguments_run(arguments, argc, argv, &words, work, err);
    free(words.words);
    return is_done;
}
