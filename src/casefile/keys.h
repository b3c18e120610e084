// The keys of a mapping in a case file or another one of its kind, and what is wrong with them.
#pragma once

#include "casefile/document.h"

// Where a message about a whole node points: at its key, or at itself where it has none.
Span keys_span(const Node *node);

// Where the text of a node's key begins: behind the quote of one that has quotes.
size_t keys_text_start(const Node *node);

// Refuses a word that is not one of the choices: says what it should have named, the nearest choice
// and all of them. False always.
bool keys_refuse(const Source *source, Span span, const char *what, const char *name,
                 const char *const *choices, size_t count, Err *err);

// The same with what is known of the word: said in place of the nearest choice, or, with
// `is_guess`, only where no choice is near. Empty: nothing.
typedef struct KeysHint {
    const char *words;
    bool is_guess;
} KeysHint;
bool keys_refuse_knowing(const Source *source, Span span, const char *what, const char *name,
                         const char *const *choices, size_t count, KeysHint hint, Err *err);

// Whether a node is a mapping, and whether the key of one of its values stands there for the first
// time.
bool keys_check_map(const Source *source, const Node *node, Err *err);
bool keys_check_single(const Source *source, const Node *map, const Node *node, Err *err);

// Sorts the values of a mapping by their keys: values[i] is that of names[i], NULL where it is not
// given. Fails where the node is no mapping, and on a key that is unknown or doubled.
bool keys_sort(const Source *source, const Node *map, const char *const *names, size_t count,
               const Node **values, Err *err);
