// What the targets share: a claim that stops the fuzzer where it does not hold, and the rules that
// every error keeps.
#pragma once

#include "base/err.h"
#include "casefile/source.h"

#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

// What libFuzzer calls; a target defines them.
int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);
int LLVMFuzzerInitialize(int *argc, char ***argv);

static inline void fuzz_check(bool is_right, const char *claim)
{
    if (!is_right) {
        fprintf(stderr, "not so: %s\n", claim);
        abort();
    }
}

// An error has a kind, and words that a terminal and a log can show.
static inline void fuzz_check_err(const Err *err)
{
    const size_t length = strlen(err->text);
    fuzz_check(err->kind != ERR_NONE, "what fails says so");
    fuzz_check(length > 0, "an error has words");
    fuzz_check(source_text_length(err->text, length) == length, "an error is text");
}

// A zero-ended copy of the input; the caller frees it.
static inline char *fuzz_copy(const uint8_t *data, size_t size)
{
    char *text = malloc(size + 1);
    fuzz_check(text != NULL, "there is memory");
    memcpy(text, data, size);
    text[size] = '\0';
    return text;
}
