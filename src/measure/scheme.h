// The ways to run a scenario that are held against one another: each combination of ODE's choices
// that makes a difference, and the solvers that choose their own steps.
#pragma once

#include "engine/driver.h"
#include "model/scenario.h"

enum {
    SCHEME_CHOSEN = 4,      // steps that ODE chooses for an error: auto/1e-3 and finer
    SCHEME_ENGINE_MAX = 48, // ways of other engines
    // every combination of ODE's choices, those ways, and the solvers that choose their own steps
    SCHEME_MAX = ODE_SOLVER_COUNT * ODE_STEPPING_COUNT * ODE_MAP_COUNT * ODE_COLLIDER_COUNT +
                 SCHEME_CHOSEN + BACKEND_COUNT + SCHEME_ENGINE_MAX,
    SCHEME_NAME_SIZE = 64,
};

typedef struct Scheme {
    char name[SCHEME_NAME_SIZE]; // "direct/plain/textbook", "auto/1e-4", or the name of the backend
    BackendKind backend;         // BACKEND_COUNT: another engine, which has only the two below
    const EngineDriver *driver;  // NULL: none; not owned
    const char *way;             // of that driver, likewise
    bool is_usual;               // taken where no schemes are asked for
    bool is_asked;    // its collider is the exact one or the case's: taken where none is named
    double tolerance; // 1, of BACKEND_ODE with a step that it chooses; else 0
    OdeSolver solver; // of BACKEND_ODE with a given step, as the three below
    OdeStepping stepping;
    OdeMap map;
    OdeCollider collider;
} Scheme;

// Fails with ERR_CASE where no body moves but the one that is driven: nothing could be in error.
bool scheme_check(const Scenario *scenario, Err *err);

// Lists the schemes of a scenario, ODE's first, and returns their count. They come from the lists
// of words in model/options.h, less what does not go together: map impulse with another stepping
// than staggered or another collider than the exact one, extrapolated stepping with play. A choice
// that makes no difference stays as the case has it: the map where no joint has play or the contact
// is CONTACT_POISSON; without play the collider is the exact one. Then come steps chosen for a
// tolerance, the reference and, for a four-bar without play, the closed form.
size_t scheme_list(const Scenario *scenario, Scheme schemes[SCHEME_MAX]);

// Adds the ways of another engine to a list of such: "mujoco/kernel". All of them are taken,
// or those that the list names, separated by '+'; ERR_USAGE for one that the engine has not, or
// where that is more than there is room for.
bool scheme_add_engine(const EngineDriver *driver, const char *ways,
                       Scheme schemes[SCHEME_ENGINE_MAX], size_t *count, Err *err);

// Whether a name is of another engine, NAME or NAME/WAY, as a scheme of a study has it.
bool scheme_is_engine(const char *name, BackendKind *backend, EngineWay *way);

// The backend that a scheme runs on: of ours, or another engine's driver.
const char *scheme_backend(const Scheme *scheme);

// Whether the scheme is ODE with a step chosen for a tolerance.
bool scheme_is_chosen(const Scheme *scheme);

// Whether the scheme takes steps of a given length.
bool scheme_has_step(const Scheme *scheme);

// The scenario run by that scheme at that step, s.
void scheme_apply(const Scheme *scheme, double step_s, Scenario *scenario);

// Keeps the usual ones of those with a step, one or two of each kind, and all without.
void scheme_keep_usual(Scheme *schemes, size_t *count);

// Keeps those of ODE that the list names, separated by commas, and all other backends. An entry
// names every scheme that has all of its words: "direct/corrected" is any such stepping, with the
// exact collider and the case's, unless it names a collider; "all" is every one. Fails with
// ERR_USAGE for an entry that no scheme matches; the schemes are then untouched.
bool scheme_filter(const char *list, Scheme *schemes, size_t *count, Err *err);
