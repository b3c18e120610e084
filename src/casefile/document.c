// Reads YAML into a tree of nodes with their places; the one file that knows libyaml.
//
// The tree is built from the parser's events and not by libyaml's own loader, because events still
// show anchors, aliases and tags, which are refused here with their place.
#include "casefile/document.h"

#include "base/memory.h"
#include "base/text.h"

#include <assert.h>
#include <stdlib.h>
#include <string.h>
#include <yaml.h>

enum { DEPTH_MAX = 8 }; // a case needs 4: document, group, link, list; a study one more

typedef struct Builder {
    yaml_parser_t parser;
    const Source *source;
    const char *text; // that is parsed
    size_t size;
    Err *err;
} Builder;

static Span event_span(const yaml_event_t *event)
{
    return (Span){event->start_mark.index, event->end_mark.index};
}

// What libyaml says of the commonest slips, and what a user is told instead. Without words of ours
// its own stay.
typedef struct SyntaxSlip {
    const char *problem; // part of libyaml's
    const char *context; // part of its context; "" any
    const char *words;   // NULL: its own
    const char *allowed;
    bool is_at_start; // the place is where what is not closed begins
} SyntaxSlip;

static const char TAB[] = "\t"; // in place of libyaml's problem, which is the same of any character

static const SyntaxSlip SYNTAX_SLIPS[] = {
    {TAB, "", "a tab", "blanks, where a line is indented", false},
    {"cannot start any token", "", NULL, "quotes around text that begins with a special character",
     false},
    {"mapping values are not allowed", "", "a second colon, or a line that is indented too far",
     "quotes around text that holds a colon, and keys of one mapping that begin in one column",
     false},
    {"did not find expected key", "block mapping", "a line is indented unlike those beside it",
     "keys of one mapping that begin in one column", false},
    {"unexpected end of stream", "quoted scalar", "the quote is not closed",
     "a quote of the same kind behind the text", true},
    {"did not find expected ',' or '}'", "flow mapping",
     "the { is not closed, or a comma is missing", "a comma between keys, and } behind the last",
     true},
    {"did not find expected ',' or ']'", "flow sequence",
     "the [ is not closed, or a comma is missing", "a comma between values, and ] behind the last",
     true},
};

// Whether a character of the text that is parsed is a tab.
static bool is_tab_at(const Builder *builder, size_t character)
{
    size_t byte = 0;
    for (size_t i = 0; byte < builder->size; byte++) {
        // the bytes that continue a character of UTF-8 are no characters
        if (((unsigned char)builder->text[byte] & 0xC0) != 0x80 && i++ == character) {
            return builder->text[byte] == '\t';
        }
    }
    return false;
}

static const SyntaxSlip *find_slip(const char *context, const char *problem)
{
    for (size_t i = 0; i < sizeof SYNTAX_SLIPS / sizeof *SYNTAX_SLIPS; i++) {
        const SyntaxSlip *slip = &SYNTAX_SLIPS[i];
        if (strstr(problem, slip->problem) != NULL && strstr(context, slip->context) != NULL) {
            return slip;
        }
    }
    return NULL;
}

static bool refuse_syntax(const Builder *builder)
{
    const yaml_parser_t *parser = &builder->parser;
    const char *context = parser->context != NULL ? parser->context : "";
    const char *problem = parser->problem != NULL ? parser->problem : "unknown problem";
    const SyntaxSlip *slip =
        find_slip(context, is_tab_at(builder, parser->problem_mark.index) ? TAB : problem);
    const bool is_at_start = slip != NULL && slip->is_at_start;
    const size_t at = is_at_start ? parser->context_mark.index : parser->problem_mark.index;
    const Span span = {at, at + 1};
    if (slip != NULL && slip->words != NULL) {
        return source_error(builder->source, span, slip->allowed, builder->err,
                            "not valid YAML: %s", slip->words);
    }
    return source_error(builder->source, span, slip != NULL ? slip->allowed : NULL, builder->err,
                        "not valid YAML: %s%s%s", context, context[0] != '\0' ? ": " : "", problem);
}

static bool next_event(Builder *builder, yaml_event_t *event)
{
    if (yaml_parser_parse(&builder->parser, event) != 1) {
        if (builder->parser.error == YAML_MEMORY_ERROR) {
            memory_leave(NULL);
        }
        return refuse_syntax(builder);
    }
    return true;
}

// What an event may not carry.
static bool check_event(const Builder *builder, const yaml_event_t *event, size_t depth)
{
    const Span span = event_span(event);
    const yaml_char_t *anchor = NULL;
    const yaml_char_t *tag = NULL;
    if (event->type == YAML_SCALAR_EVENT) {
        anchor = event->data.scalar.anchor;
        tag = event->data.scalar.tag;
    } else if (event->type == YAML_SEQUENCE_START_EVENT) {
        anchor = event->data.sequence_start.anchor;
        tag = event->data.sequence_start.tag;
    } else if (event->type == YAML_MAPPING_START_EVENT) {
        anchor = event->data.mapping_start.anchor;
        tag = event->data.mapping_start.tag;
    }
    if (anchor != NULL || event->type == YAML_ALIAS_EVENT) {
        return source_error(builder->source, span, "the value itself", builder->err,
                            "a %s has no anchors (&) and aliases (*)", builder->source->what);
    }
    if (tag != NULL) {
        return source_error(builder->source, span, "the value without its tag", builder->err,
                            "a %s has no tags (!)", builder->source->what);
    }
    if (depth > DEPTH_MAX) {
        return source_error(builder->source, span, NULL, builder->err, "nested deeper than any %s",
                            builder->source->what);
    }
    if (event->type == YAML_SCALAR_EVENT &&
        !source_is_one_line((const char *)event->data.scalar.value, event->data.scalar.length)) {
        return source_error(builder->source, span, "text on one line", builder->err,
                            "a value holds a line break, a tab or a control character");
    }
    return true;
}

static Node *build_node(Builder *builder, const yaml_event_t *event, size_t depth);

// The key whose event has been read; a key is a word.
static Node *build_key(Builder *builder, const yaml_event_t *event, size_t depth)
{
    if (event->type != YAML_SCALAR_EVENT && event->type != YAML_ALIAS_EVENT) {
        source_error(builder->source, event_span(event), "a word, such as title", builder->err,
                     "a key must be a word");
        return NULL;
    }
    return build_node(builder, event, depth);
}

// Reads one item of a list, or a key and its value of a map. *is_end is set at the end instead.
static Node *build_item(Builder *builder, const Node *parent, size_t depth, bool *is_end)
{
    yaml_event_t event;
    if (!next_event(builder, &event)) {
        return NULL;
    }
    *is_end = event.type == YAML_SEQUENCE_END_EVENT || event.type == YAML_MAPPING_END_EVENT;
    if (*is_end || parent->kind == NODE_LIST) {
        Node *item = *is_end ? NULL : build_node(builder, &event, depth + 1);
        yaml_event_delete(&event);
        return item;
    }
    Node *key = build_key(builder, &event, depth + 1);
    yaml_event_delete(&event);
    if (key == NULL || !next_event(builder, &event)) {
        document_destroy(key);
        return NULL;
    }
    Node *value = build_node(builder, &event, depth + 1);
    yaml_event_delete(&event);
    if (value == NULL) {
        document_destroy(key);
        return NULL;
    }
    value->key = key;
    return value;
}

static bool build_items(Builder *builder, Node *parent, size_t depth)
{
    Node **last = &parent->first;
    for (;;) {
        bool is_end = false;
        Node *item = build_item(builder, parent, depth, &is_end);
        if (is_end) {
            return true;
        }
        if (item == NULL) {
            return false;
        }
        *last = item;
        last = &item->next;
    }
}

static Node *build_node(Builder *builder, const yaml_event_t *event, size_t depth)
{
    if (!check_event(builder, event, depth)) {
        return NULL;
    }
    Node *node = calloc(1, sizeof *node);
    assert(node != NULL);
    node->span = event_span(event);
    if (event->type == YAML_SCALAR_EVENT) {
        node->kind = NODE_SCALAR;
        node->text = strdup((const char *)event->data.scalar.value);
        assert(node->text != NULL);
        return node;
    }
    node->kind = event->type == YAML_MAPPING_START_EVENT ? NODE_MAP : NODE_LIST;
    if (!build_items(builder, node, depth)) {
        document_destroy(node);
        return NULL;
    }
    return node;
}

// Reads the events around the document; there must be at most one.
static bool build_root(Builder *builder, Node **root)
{
    Node *built = NULL;
    yaml_event_type_t type = YAML_NO_EVENT;
    while (type != YAML_STREAM_END_EVENT) {
        yaml_event_t event;
        if (!next_event(builder, &event)) {
            goto done;
        }
        type = event.type;
        bool is_good = true;
        if (type == YAML_DOCUMENT_START_EVENT && built != NULL) {
            is_good = source_error(builder->source, event_span(&event), "one document a file",
                                   builder->err, "a second document begins here");
        } else if (type != YAML_STREAM_START_EVENT && type != YAML_STREAM_END_EVENT &&
                   type != YAML_DOCUMENT_START_EVENT && type != YAML_DOCUMENT_END_EVENT) {
            built = build_node(builder, &event, 0);
            is_good = built != NULL;
        }
        yaml_event_delete(&event);
        if (!is_good) {
            goto done;
        }
    }
    *root = built;
    return true;

done:
    document_destroy(built);
    return false;
}

bool document_parse(const Source *source, const char *text, size_t size, Node **root, Err *err)
{
    Builder builder = {.source = source, .text = text, .size = size, .err = err};
    const int is_initialised = yaml_parser_initialize(&builder.parser);
    if (is_initialised != 1) {
        memory_leave(NULL);
    }
    assert(is_initialised == 1);
    yaml_parser_set_encoding(&builder.parser, YAML_UTF8_ENCODING);
    yaml_parser_set_input_string(&builder.parser, (const unsigned char *)text, size);
    const bool is_good = build_root(&builder, root);
    yaml_parser_delete(&builder.parser);
    return is_good;
}

void document_destroy(Node *root)
{
    while (root != NULL) {
        Node *next = root->next;
        document_destroy(root->first);
        document_destroy(root->key);
        free(root->text);
        free(root);
        root = next;
    }
}
