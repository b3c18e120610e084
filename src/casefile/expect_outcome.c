// Reads how a run of a case is expected to end.
//
//     path    = [backend | scheme .] outcome
//     scheme  = word { / word }, of those in the names of ODE's schemes: direct/plain/textbook
//     outcome = agrees within X | reported above X | detected as "WORDS" | refused with "WORDS"
#include "casefile/expect_outcome.h"

#include "base/text.h"
#include "casefile/keys.h"
#include "casefile/quantity.h"
#include "model/options.h"

#include <stdio.h>
#include <string.h>

enum { WORD_MAX = 64 }; // words of schemes

const char EXPECT_OUTCOME_FORMS[] =
    "agrees within X, reported above X, detected as \"WORDS\", refused with \"WORDS\"";

const char *const EXPECT_OUTCOME_WORDS[OUTCOME_KIND_COUNT] = {
    [OUTCOME_AGREES] = "agrees",
    [OUTCOME_REPORTED] = "reported",
    [OUTCOME_DETECTED] = "detected",
    [OUTCOME_REFUSED] = "refused",
};

// What a value begins with, by kind.
static const char *const BEGINNINGS[OUTCOME_KIND_COUNT] = {
    [OUTCOME_AGREES] = "agrees within ",
    [OUTCOME_REPORTED] = "reported above ",
    [OUTCOME_DETECTED] = "detected as ",
    [OUTCOME_REFUSED] = "refused with ",
};

static const char LAST[] = "outcome"; // segment of a path

// The length of the path before ".outcome", or before "outcome" where nothing is.
static size_t length_before(const char *path)
{
    const size_t length = strlen(path) - strlen(LAST);
    return length > 0 ? length - 1 : 0;
}

bool expect_outcome_is(const Node *node)
{
    const char *path = node->key->text;
    const size_t length = strlen(path);
    return length >= strlen(LAST) && strcmp(path + length - strlen(LAST), LAST) == 0 &&
           (length == strlen(LAST) || path[length - strlen(LAST) - 1] == '.');
}

static size_t add_words(const char *const *words, const char **choices, size_t count)
{
    for (size_t i = 0; words[i] != NULL && count < WORD_MAX; i++) {
        choices[count++] = words[i];
    }
    return count;
}

// The words of a scheme: "auto" with its tolerance among them.
static size_t list_words(const char **choices)
{
    static const char *const CHOSEN[] = {"auto", "1e-3", "1e-4", "1e-5", "1e-6", NULL};
    size_t count = add_words(OPTIONS_ODE_SOLVERS, choices, 0);
    count = add_words(OPTIONS_ODE_STEPPINGS, choices, count);
    count = add_words(OPTIONS_ODE_MAPS, choices, count);
    count = add_words(OPTIONS_ODE_COLLIDERS, choices, count);
    return add_words(CHOSEN, choices, count);
}

static bool has_word(const char *const *choices, size_t count, const char *word, size_t length)
{
    for (size_t i = 0; i < count; i++) {
        if (strlen(choices[i]) == length && strncmp(choices[i], word, length) == 0) {
            return true;
        }
    }
    return false;
}

// Whose outcome it is: a backend, or words of a scheme.
static bool read_of(const Source *source, const Node *node, ExpectedOutcome *outcome, Err *err)
{
    const size_t length = length_before(node->key->text);
    if (length >= sizeof outcome->of) {
        return source_error(source, keys_span(node), "a backend or a scheme", err,
                            "the path of an outcome is too long");
    }
    snprintf(outcome->of, sizeof outcome->of, "%.*s", (int)length, node->key->text);
    const char *choices[WORD_MAX + BACKEND_COUNT];
    const size_t words = list_words(choices);
    const bool is_of_all = length == 0 && node->key->text[0] != '.';
    if (is_of_all || has_word(OPTIONS_BACKENDS, BACKEND_COUNT, outcome->of, length)) {
        return true;
    }
    for (const char *word = outcome->of;; word++) {
        const size_t part = strcspn(word, "/");
        if (!has_word(choices, words, word, part)) {
            char name[EXPECTATION_PATH_SIZE];
            snprintf(name, sizeof name, "%.*s", (int)part, word);
            for (size_t i = 0; i < BACKEND_COUNT; i++) {
                choices[words + i] = OPTIONS_BACKENDS[i];
            }
            return keys_refuse(source, keys_span(node), "backend or word of a scheme", name,
                               choices, words + BACKEND_COUNT, err);
        }
        word += part;
        if (*word == '\0') {
            return true;
        }
    }
}

static bool refuse_value(const Source *source, const Node *node, Err *err)
{
    return source_error(source, node->span, EXPECT_OUTCOME_FORMS, err, "'%.60s' is no outcome",
                        node->text);
}

static bool read_outcome_limit(const Source *source, const Node *node, const char *rest,
                               ExpectedOutcome *outcome, Err *err)
{
    Complaint complaint = {.allowed = ""};
    if (!quantity_number(rest, &outcome->limit, &complaint)) {
        return source_error(source, node->span, complaint.allowed, err, "%s", complaint.text);
    }
    return outcome->limit > 0.0 || source_error(source, node->span, "an error above 0", err,
                                                "no run is known to agree within 0");
}

// Words of a message between quotes.
static bool read_message(const Source *source, const Node *node, const char *rest,
                         ExpectedOutcome *outcome, Err *err)
{
    const size_t length = strlen(rest);
    if (length < 3 || rest[0] != '"' || rest[length - 1] != '"') {
        return refuse_value(source, node, err);
    }
    snprintf(outcome->message, sizeof outcome->message, "%.*s", (int)(length - 2), rest + 1);
    return true;
}

bool expect_outcome_read(const Source *source, const Node *node, ExpectedOutcome *outcome, Err *err)
{
    *outcome = (ExpectedOutcome){.limit = 0.0};
    if (node->kind != NODE_SCALAR || node->text[0] == '\0') {
        return source_error(source, node->kind != NODE_SCALAR ? node->span : keys_span(node),
                            EXPECT_OUTCOME_FORMS, err, "%.100s %s", node->key->text,
                            node->kind != NODE_SCALAR ? "takes one outcome" : "has no outcome");
    }
    if (strlen(node->text) >= sizeof outcome->words) {
        return source_error(source, node->span, EXPECT_OUTCOME_FORMS, err,
                            "an outcome has at most %d characters", OUTCOME_WORDS_SIZE - 1);
    }
    text_copy(outcome->words, sizeof outcome->words, node->text);
    int kind = 0;
    while (kind < OUTCOME_KIND_COUNT &&
           strncmp(node->text, BEGINNINGS[kind], strlen(BEGINNINGS[kind])) != 0) {
        kind++;
    }
    if (kind == OUTCOME_KIND_COUNT) {
        return refuse_value(source, node, err);
    }
    outcome->kind = (OutcomeKind)kind;
    const char *rest = node->text + strlen(BEGINNINGS[kind]);
    const bool has_limit = kind == OUTCOME_AGREES || kind == OUTCOME_REPORTED;
    return read_of(source, node, outcome, err) &&
           (has_limit ? read_outcome_limit(source, node, rest, outcome, err)
                      : read_message(source, node, rest, outcome, err));
}
