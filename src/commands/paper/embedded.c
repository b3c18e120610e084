// How does the program carry the paper's cases?
//
// The build puts each YAML file into the program byte for byte, between two symbols, and does so
// again when the file changes.
#include "commands/paper/embedded.h"

#include "casefile/casefile.h"

extern const char embedded_ideal_nominal[];
extern const char embedded_ideal_nominal_end[];
extern const char embedded_ideal_stackup[];
extern const char embedded_ideal_stackup_end[];
extern const char embedded_stackup_poisson[];
extern const char embedded_stackup_poisson_end[];
extern const char embedded_stackup_impact[];
extern const char embedded_stackup_impact_end[];

typedef struct EmbeddedText {
    const char *name; // for messages
    const char *begin;
    const char *end;
} EmbeddedText;

static const EmbeddedText TEXTS[EMBEDDED_COUNT] = {
    [EMBEDDED_IDEAL_NOMINAL] = {"paper/ideal-nominal.yaml", embedded_ideal_nominal,
                                embedded_ideal_nominal_end},
    [EMBEDDED_IDEAL_STACKUP] = {"paper/ideal-stackup.yaml", embedded_ideal_stackup,
                                embedded_ideal_stackup_end},
    [EMBEDDED_STACKUP_POISSON] = {"paper/stackup-poisson.yaml", embedded_stackup_poisson,
                                  embedded_stackup_poisson_end},
    [EMBEDDED_STACKUP_IMPACT] = {"paper/stackup-impact.yaml", embedded_stackup_impact,
                                 embedded_stackup_impact_end},
};

bool embedded_load(EmbeddedCase which, Scenario *scenario, Err *err)
{
    static const char *const CLOCKWISE[] = {"drive.speed=-1000 rpm"};
    const EmbeddedText *text = &TEXTS[which];
    return casefile_load_text(text->name, text->begin, (size_t)(text->end - text->begin), CLOCKWISE,
                              1, scenario, err);
}
