// Writes sentences about many things: what holds of several is said once, with their names.
#include "write/alike.h"
#include "base/room.h"

enum {
    SENTENCES_MOST = 40, // more than these are not read one by one
    SENTENCES_SHOWN = 10,
    NAMES_MOST = 5, // more than these are counted
    NAMES_SHOWN = 3,
};

typedef struct Sentence {
    char *said;
    size_t length;
    char **names; // of the things of which it is said
    size_t count;
    size_t room;
} Sentence;

struct Alike {
    Sentence *sentences;
    size_t count;
    size_t room;
};

Alike *alike_start(void)
{
    Alike *alike = calloc(1, sizeof *alike);
    assert(alike != NULL);
    return alike;
}

static Sentence *alike_find(Alike *alike, const char *said)
{
    const size_t length = strlen(said);
    // what is said of neighbours is alike more often than of any other two
    for (size_t i = alike->count; i-- > 0;) {
        Sentence *sentence = &alike->sentences[i];
        if (sentence->length == length && memcmp(sentence->said, said, length) == 0) {
            return sentence;
        }
    }
    alike->sentences =
        room_grow(alike->sentences, &alike->room, alike->count + 1, sizeof *alike->sentences);
    Sentence *sentence = &alike->sentences[alike->count++];
    *sentence = (Sentence){.said = strdup(said), .length = length};
    assert(sentence->said != NULL);
    return sentence;
}

void alike_add(Alike *alike, const char *name, const char *said)
{
    Sentence *sentence = alike_find(alike, said);
    sentence->names =
        room_grow(sentence->names, &sentence->room, sentence->count + 1, sizeof *sentence->names);
    sentence->names[sentence->count] = strdup(name);
    assert(sentence->names[sentence->count] != NULL);
    sentence->count++;
}

static void alike_write_names(const Sentence *sentence, Text *text)
{
    const size_t shown = sentence->count > NAMES_MOST ? NAMES_SHOWN : sentence->count;
    for (size_t i = 0; i < shown; i++) {
        text_append(text, "%s%s", i == 0 ? "" : ", ", sentence->names[i]);
    }
    if (shown < sentence->count) {
        text_append(text, " and %zu more", sentence->count - shown);
    }
}

static void free_sentence(Sentence *sentence)
{
    for (size_t i = 0; i < sentence->count; i++) {
        free(sentence->names[i]);
    }
    free(sentence->names);
    free(sentence->said);
}

void alike_end(Alike *alike, const char *lead, const char *between, size_t width, Text *text)
{
    const size_t shown =
        width > 0 && alike->count > SENTENCES_MOST ? SENTENCES_SHOWN : alike->count;
    for (size_t i = 0; i < shown; i++) {
        text_append(text, "%s", lead);
        alike_write_names(&alike->sentences[i], text);
        text_append(text, "%s%s\n", between, alike->sentences[i].said);
    }
    if (shown < alike->count) {
        text_append(text, "%s... and %zu lines more, which --wide shows\n", lead,
                    alike->count - shown);
    }
    for (size_t i = 0; i < alike->count; i++) {
        free_sentence(&alike->sentences[i]);
    }
    free(alike->sentences);
    free(alike);
}
