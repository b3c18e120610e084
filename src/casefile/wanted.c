// How is a key's value to be written?
#include "casefile/wanted.h"

void wanted_describe(const Entries *entries, const SchemaRow *row, Text *text)
{
    const bool is_speed = row->dimension == DIMENSION_SPEED;
    const EntryNames *names =
        &entries->names[row->type == SCHEMA_JOINT_NAME ? SCHEMA_JOINT : SCHEMA_BODY];
    switch (row->type) {
    case SCHEMA_CHOICE:
    case SCHEMA_BACKENDS:
        schema_list_words(row, text);
        break;
    case SCHEMA_BODY_NAME:
    case SCHEMA_JOINT_NAME:
        for (size_t i = 0; i < names->count; i++) {
            text_append(text, "%s%s", i > 0 ? ", " : "", names->names[i]);
        }
        break;
    case SCHEMA_BETWEEN:
        text_append(text, "two bodies such as [ground, pin]");
        break;
    case SCHEMA_VECTOR:
    case SCHEMA_ANCHOR:
        text_append(text, "%s[x, y] such as %s", row->default_words != NULL ? "centred, or " : "",
                    row->default_words != NULL ? "[5 um, 0 um]"
                    : is_speed                 ? "[0.5 m/s, 0 m/s]"
                                               : "[25 mm, 0 mm]");
        break;
    case SCHEMA_EXPECT:
        text_append(text, "a mapping of paths to limits");
        break;
    case SCHEMA_TEXT:
        text_append(text, "text on one line");
        break;
    case SCHEMA_SPAN:
        text_append(text, "a time such as 60 ms, or 1 revolution");
        break;
    case SCHEMA_INTEGER:
        text_append(text, "a whole number such as 100");
        break;
    default:
        text_append(text, "%s%s%s such as %s", row->zero_word != NULL ? row->zero_word : "",
                    row->zero_word != NULL ? ", or " : "", units_dimension_name(row->dimension),
                    units_example(row->dimension));
    }
}
