// Looks at the tags of a model's text, and takes the shapes out of a URDF.
#include "drivers/mujoco/mujoco_urdf.h"

#include "drivers/common/driver.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

// A tag: its text from behind '<' to before '>'.
typedef struct Tag {
    char *text;
    size_t size;
    char *end; // behind '>'
} Tag;

// Behind what is no element, which begins here: a comment, an instruction, text of its own.
static char *behind_aside(char *at)
{
    static const char *const ASIDES[][2] = {{"<!--", "-->"}, {"<![CDATA[", "]]>"}, {"<?", "?>"}};
    for (size_t i = 0; i < sizeof ASIDES / sizeof *ASIDES; i++) {
        if (strncmp(at, ASIDES[i][0], strlen(ASIDES[i][0])) == 0) {
            char *end = strstr(at + strlen(ASIDES[i][0]), ASIDES[i][1]);
            return end != NULL ? end + strlen(ASIDES[i][1]) : at + strlen(at);
        }
    }
    return NULL;
}

// The next tag, or one without text where there is none.
static Tag next_tag(char *at)
{
    while ((at = strchr(at, '<')) != NULL) {
        char *behind = behind_aside(at);
        if (behind != NULL) {
            at = behind;
            continue;
        }
        char quote = '\0';
        for (char *end = at + 1; *end != '\0'; end++) {
            if (quote != '\0') {
                quote = *end == quote ? '\0' : quote;
            } else if (*end == '"' || *end == '\'') {
                quote = *end;
            } else if (*end == '>') {
                return (Tag){at + 1, (size_t)(end - at - 1), end + 1};
            }
        }
        break;
    }
    return (Tag){.text = NULL};
}

static bool is_named(const Tag *tag, const char *name)
{
    const size_t length = strlen(name);
    return tag->size >= length && strncmp(tag->text, name, length) == 0 &&
           (tag->size == length || strchr(" \t\r\n/", tag->text[length]) != NULL);
}

// The value of an attribute; empty where there is none.
static void read_attribute(const Tag *tag, const char *name, char value[URDF_NAME_SIZE])
{
    const size_t length = strlen(name);
    value[0] = '\0';
    for (size_t i = 1; i + length < tag->size; i++) {
        const char *at = tag->text + i;
        if (strchr(" \t\r\n", at[-1]) == NULL || strncmp(at, name, length) != 0) {
            continue;
        }
        at += length;
        at += strspn(at, " \t\r\n");
        if (*at != '=') {
            continue;
        }
        at++;
        at += strspn(at, " \t\r\n");
        const char *end = *at == '"' || *at == '\'' ? strchr(at + 1, *at) : NULL;
        if (end != NULL) {
            snprintf(value, URDF_NAME_SIZE, "%.*s", (int)(end - at - 1), at + 1);
        }
        return;
    }
}

static double read_number(const Tag *tag, const char *name, double missing)
{
    char value[URDF_NAME_SIZE];
    read_attribute(tag, name, value);
    return value[0] != '\0' ? strtod(value, NULL) : missing;
}

// Blanks an element whose first tag is given; returns what is behind it.
static char *blank(const Tag *first, const char *name)
{
    char *end = first->end;
    if (first->size == 0 || first->text[first->size - 1] != '/') {
        char closing[URDF_NAME_SIZE];
        snprintf(closing, sizeof closing, "/%s", name);
        Tag tag = next_tag(first->end);
        while (tag.text != NULL && !is_named(&tag, closing)) {
            tag = next_tag(tag.end);
        }
        if (tag.text == NULL) {
            return first->end; // MuJoCo says what is wrong there
        }
        end = tag.end;
    }
    for (char *at = first->text - 1; at < end; at++) {
        *at = *at == '\n' ? '\n' : ' ';
    }
    return end;
}

static void note_mimic(const Tag *tag, const char *joint, Urdf *urdf)
{
    if (urdf->mimic_count == URDF_MIMIC_MOST) {
        driver_refuse("a model with more than %d joints that mimic others", URDF_MIMIC_MOST);
    }
    UrdfMimic *mimic = &urdf->mimics[urdf->mimic_count++];
    snprintf(mimic->joint, sizeof mimic->joint, "%s", joint);
    read_attribute(tag, "joint", mimic->followed);
    mimic->multiplier = read_number(tag, "multiplier", 1.0);
    mimic->offset = read_number(tag, "offset", 0.0);
}

// MuJoCo does not bear a kind of joint that it does not know.
static void check_joint(const Tag *tag, const char *name)
{
    static const char *const KINDS[] = {"revolute", "continuous", "prismatic",
                                        "fixed",    "floating",   "planar"};
    char kind[URDF_NAME_SIZE];
    bool is_known = false;
    read_attribute(tag, "type", kind);
    for (size_t i = 0; i < sizeof KINDS / sizeof *KINDS; i++) {
        is_known = is_known || strcmp(kind, KINDS[i]) == 0;
    }
    // those of transmissions have no type
    if (!is_known && kind[0] != '\0') {
        driver_refuse("joint '%s' of type '%s', which URDF has not", name, kind);
    }
}

void urdf_prepare(char *text, size_t size, Urdf *urdf)
{
    *urdf = (Urdf){.mimic_count = 0};
    if (strlen(text) < size) {
        driver_refuse("a file with zero bytes, which is no model");
    }
    Tag tag = next_tag(text);
    if (tag.text == NULL) {
        driver_refuse("a file without XML: a model is MJCF (<mujoco>) or URDF (<robot>)");
    }
    if (tag.text[0] == '!') {
        driver_refuse("a document type with entities, which no model needs");
    }
    urdf->is_urdf = is_named(&tag, "robot");
    if (!urdf->is_urdf && !is_named(&tag, "mujoco")) {
        driver_refuse("a file whose first element is <%.*s>: a model is MJCF (<mujoco>) or URDF "
                      "(<robot>)",
                      (int)strcspn(tag.text, " \t\r\n/>"), tag.text);
    }
    char joint[URDF_NAME_SIZE] = "";
    char *at = tag.end;
    while (urdf->is_urdf && (tag = next_tag(at)).text != NULL) {
        at = tag.end;
        if (strncmp(tag.text, "xacro:", 6) == 0) {
            driver_refuse("xacro, which is to be expanded first: xacro FILE.xacro > FILE.urdf");
        }
        if (is_named(&tag, "visual") || is_named(&tag, "collision")) {
            at = blank(&tag, is_named(&tag, "visual") ? "visual" : "collision");
        } else if (is_named(&tag, "joint")) {
            read_attribute(&tag, "name", joint);
            check_joint(&tag, joint);
        } else if (is_named(&tag, "mimic")) {
            note_mimic(&tag, joint, urdf);
        }
    }
}
