// Writes random mechanisms with play whose contacts are damped the more the deeper they are: other
// kinds of cases, of which the contact's damping is another one.
#include "random_case.h"

#include "random_draw.h"

#include <assert.h>
#include <stdlib.h>
#include <string.h>

static const CaseKind *const BASES[] = {&CASE_FOUR_BAR, &CASE_BODIES, &CASE_SLIDERS, &CASE_BALLS,
                                        &CASE_PENDULA,  &CASE_HOLES,  &CASE_CAMS,    &CASE_SLOTS};

enum { BASE_COUNT = sizeof BASES / sizeof *BASES };

// Whether a part of a contact's line says how it is damped.
static bool is_of_damping(const char *part)
{
    static const char *const KEYS[] = {"damping:", "restitution:", "viscous-coefficient:"};
    for (size_t i = 0; i < sizeof KEYS / sizeof *KEYS; i++) {
        if (strncmp(part, KEYS[i], strlen(KEYS[i])) == 0) {
            return true;
        }
    }
    return false;
}

// Steel against steel of some hundred grams is damped critically by some 1e4 N s/m, and comes some
// micrometres deep.
static void write_contact(Draw *draw, char *parts, FILE *file)
{
    fprintf(file, "contact: {damping: step, viscous-coefficient: %.4g N s/m",
            draw_log_between(draw, 3e2, 3e4));
    fprintf(file, ", full-damping-depth: %.4g um", draw_log_between(draw, 0.3, 30.0));
    parts[strcspn(parts, "}")] = '\0';
    for (char *part = strtok(parts, ","); part != NULL; part = strtok(NULL, ",")) {
        part += strspn(part, " ");
        if (*part != '\0' && !is_of_damping(part)) {
            fprintf(file, ", %s", part);
        }
    }
    fprintf(file, "}\n");
}

static void growing_write(uint64_t seed, FILE *file)
{
    static const char CONTACT[] = "contact: {";
    Draw draw = draw_start(seed);
    char *text = NULL;
    size_t length = 0;
    FILE *base = open_memstream(&text, &length);
    assert(base != NULL);
    BASES[seed % BASE_COUNT]->write(seed, base);
    fclose(base);
    for (char *line = text; *line != '\0';) {
        const size_t width = strcspn(line, "\n");
        char *next = line + width + (line[width] == '\n' ? 1 : 0);
        if (strncmp(line, CONTACT, strlen(CONTACT)) == 0) {
            line[width] = '\0';
            write_contact(&draw, line + strlen(CONTACT), file);
        } else {
            fwrite(line, 1, (size_t)(next - line), file);
        }
        line = next;
    }
    free(text);
}

const CaseKind CASE_GROWING = {"growing", "mechanisms with play whose damping grows with the depth",
                               growing_write};
