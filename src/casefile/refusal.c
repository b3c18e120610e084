// Checks whether a case file that is refused expects to be.
#include "casefile/casefile.h"
#include "casefile/expect_outcome.h"
#include "casefile/input.h"

#include <stdlib.h>
#include <string.h>

static const Node *find(const Node *map, const char *key)
{
    const Node *node = map != NULL && map->kind == NODE_MAP ? map->first : NULL;
    while (node != NULL && strcmp(node->key->text, key) != 0) {
        node = node->next;
    }
    return node;
}

bool casefile_expects_refusal(const char *path, char title[SCENARIO_TITLE_SIZE],
                              ExpectedOutcome *outcome)
{
    char *text;
    size_t size;
    Source source;
    Node *root = NULL;
    Err ignored = {0};
    if (!input_read("case", path, &text, &size, &ignored)) {
        return false;
    }
    bool is_expected = false;
    if (input_parse("case", path, text, size, &source, &root, &ignored)) {
        const Node *found = find(find(root, "expect"), "outcome");
        const Node *name = find(root, "title");
        is_expected = found != NULL && expect_outcome_read(&source, found, outcome, &ignored) &&
                      outcome->kind == OUTCOME_REFUSED;
        const bool has_title = name != NULL && name->kind == NODE_SCALAR;
        text_copy(title, SCENARIO_TITLE_SIZE, has_title ? name->text : "");
    }
    document_destroy(root);
    free(text);
    return is_expected;
}
