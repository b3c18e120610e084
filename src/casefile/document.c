// Reads YAML into a tree of nodes with their places; the one file that knows libyaml.
//
// The tree is built from the parser's events and not by libyaml's own loader, because events still
// show anchors, aliases and tags, which are refused here with their place.
#include "casefile/document.h"

#include "base/text.h"

#include <assert.h>
#include <stdlib.h>
#include <string.h>
#include <yaml.h>

enum { DEPTH_MAX = 8 }; // a case needs 4: document, group, link, list; a study one more

typedef struct Builder {
    yaml_parser_t parser;
    const Source *source;
    Err *err;
} Builder;

static Span event_span(const yaml_event_t *event)
{
    return (Span){event->start_mark.index, event->end_mark.index};
}

static bool refuse_syntax(const Builder *builder)
{
    const yaml_parser_t *parser = &builder->parser;
    const char *context = parser->context != NULL ? parser->context : "";
    const char *problem = parser->problem != NULL ? parser->problem : "unknown problem";
    const Span span = {parser->problem_mark.index, parser->problem_mark.index + 1};
    const char *hint = NULL;
    if (strstr(problem, "cannot start any token") != NULL) {
        hint = "blanks for indentation (no tabs), and quotes around text that begins with a "
               "special character";
    }
    return source_error(builder->source, span, hint, builder->err, "not valid YAML: %s%s%s",
                        context, context[0] != '\0' ? ": " : "", problem);
}

static bool next_event(Builder *builder, yaml_event_t *event)
{
    if (yaml_parser_parse(&builder->parser, event) != 1) {
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
    Builder builder = {.source = source, .err = err};
    const int is_initialised = yaml_parser_initialize(&builder.parser);
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
