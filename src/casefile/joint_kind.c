// Finds the kind of joint that the keys of a case make, and checks that they go together.
#include "casefile/joint_kind.h"

#include "casefile/limits.h"

#include <assert.h>
#include <stdint.h>
#include <string.h>

enum { SLIDER_GUIDE = 3 }; // number of the slider-crank's joint that slides

static const char PLACES[] = "joints.*.at-a joints.*.at-b";

JointKind joint_kind_find(const Entries *entries, size_t joint)
{
    // the keys that only joints of a kind have; of several kinds the first counts
    static const struct {
        JointKind kind;
        const char *keys;
    } KINDS[] = {
        {JOINT_STOP, "joints.*.normal joints.*.radius joints.*.discs joints.*.profile "
                     "joints.*.slot"},
        {JOINT_GUIDE, "joints.*.guide joints.*.block joints.*.length"},
        {JOINT_PRISMATIC, "joints.*.along"},
        {JOINT_RACK, "joints.*.rack"},
        {JOINT_GEAR, "joints.*.gears joints.*.teeth"},
        {JOINT_REVOLUTE, "joints.*.backlash joints.*.low joints.*.high"},
        {JOINT_CLEARANCE, "joints.*.hole joints.*.pin joints.*.radial-clearance joints.*.width "
                          "joints.*.start"},
        {JOINT_STOP, PLACES}, // which pins in holes may have as well
    };
    static_assert(sizeof KINDS / sizeof *KINDS == JOINT_KIND_COUNT + 1, "each kind has its keys");
    if (entries->form != SCHEMA_LONG) {
        const bool is_named = entries_group(entries, "joints.*", joint) != NULL;
        const bool slides = entries->form == SCHEMA_SLIDER_CRANK && joint == SLIDER_GUIDE;
        return slides ? (is_named ? JOINT_GUIDE : JOINT_PRISMATIC)
                      : (is_named ? JOINT_CLEARANCE : JOINT_REVOLUTE);
    }
    for (size_t i = 0; i < sizeof KINDS / sizeof *KINDS; i++) {
        if (entries_blame(entries, KINDS[i].keys, joint) != NULL) {
            return KINDS[i].kind;
        }
    }
    return JOINT_REVOLUTE;
}

// Whether a key says how bodies touch, which those of an ideal joint do at its limits alone.
static bool is_of_play(const SchemaRow *row)
{
    return row->type == SCHEMA_STIFFNESS || row->type == SCHEMA_STIFFNESS_FOR ||
           row->type == SCHEMA_DAMPER || row->type == SCHEMA_START ||
           strcmp(row->path, "joints.*.restitution") == 0;
}

// Refuses a key of another kind with those that the joint may have.
static bool refuse_key(const Entries *entries, const Entry *entry, JointKind kind, Err *err)
{
    Text allowed;
    text_init(&allowed);
    for (size_t i = 0; i < SCHEMA_ROW_COUNT; i++) {
        const SchemaRow *row = &SCHEMA_ROWS[i];
        if (row->family == SCHEMA_JOINT && schema_is_of_kind(row, kind) &&
            schema_is_of_form(row, entries->form)) {
            text_append(&allowed, "%s%s", allowed.length > 0 ? ", " : "",
                        strrchr(row->path, '.') + 1);
        }
    }
    entries_refuse(entry, err, "'%s' is no key of joint '%s', %s\nallowed: %s",
                   strrchr(entry->row->path, '.') + 1,
                   entries_name(entries, entry->row, entry->index), joint_words(kind),
                   allowed.data);
    text_finish(&allowed);
    return false;
}

// Refuses a start of a pin in its hole, where the places of both say it.
static bool refuse_start(const Entries *entries, const Entry *start, Err *err)
{
    return entries_refuse(start, err,
                          "at-a and at-b of joint '%s' say already where its pin starts in its "
                          "hole\nallowed: at-a and at-b, or at and start",
                          entries_name(entries, start->row, start->index));
}

bool joint_kind_check(const Entries *entries, Err *err)
{
    // the keys of a joint stand together, so that its kind is found once
    size_t joint = SIZE_MAX;
    JointKind kind = JOINT_REVOLUTE;
    bool is_firm = false;
    for (size_t i = 0; i < entries->count; i++) {
        const Entry *entry = &entries->entries[i];
        if (entry->row->family != SCHEMA_JOINT) {
            continue;
        }
        if (entry->index != joint) {
            joint = entry->index;
            kind = joint_kind_find(entries, joint);
            is_firm = joint_is_ideal(kind) && !limits_are_given(entries, joint);
        }
        if (!schema_is_of_kind(entry->row, kind) || (is_firm && is_of_play(entry->row))) {
            return refuse_key(entries, entry, kind, err);
        }
        if (entry->row->type == SCHEMA_START && joint_has_hole(kind) &&
            entries_blame(entries, PLACES, joint) != NULL) {
            return refuse_start(entries, entry, err);
        }
    }
    return true;
}
