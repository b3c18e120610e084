// A YAML document as a tree of nodes that know where they stand.
//
// Anchors, aliases and tags are refused: a case or a study has no use for them, and without them a
// tree is never larger than its text. So are documents nested deeper than any of these.
#pragma once

#include "casefile/source.h"

typedef enum NodeKind { NODE_SCALAR, NODE_LIST, NODE_MAP } NodeKind;

typedef struct Node Node;

struct Node {
    NodeKind kind;
    Span span;
    char *text;  // of a scalar, without control characters; else NULL
    Node *key;   // of a value in a map: its key, a scalar; else NULL
    Node *first; // of a list or map: its first item or value, or NULL
    Node *next;  // in the list or map that holds it
};

// Parses one document. `text` is what the spans count from: the source's text, less its shift.
// *root is NULL where the text holds no document (it is empty, or has comments only). On failure
// *root is untouched and the error points at the place.
bool document_parse(const Source *source, const char *text, size_t size, Node **root, Err *err);

// Frees the tree; accepts NULL.
void document_destroy(Node *root);
