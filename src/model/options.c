// Has every default of the program, and why it is that number.
#include "model/options.h"

#include <string.h>

#define WORD(id, word)                                word,
#define MEMBER_WORD(id, word, ...)                    word,
#define MEMBER_HAS_PLAY(id, word, solver, is)         is,
#define MEMBER_IS_GENERAL(id, word, plane, space, is) is,

const char *const OPTIONS_CONTACT_MODELS[] = {OPTIONS_CONTACT_MODEL_LIST(WORD) NULL};
const char *const OPTIONS_LAWS[] = {OPTIONS_LAW_LIST(MEMBER_WORD) NULL};
const char *const OPTIONS_FRICTION_LAWS[] = {OPTIONS_FRICTION_LAW_LIST(WORD) NULL};
const char *const OPTIONS_DAMPINGS[] = {OPTIONS_DAMPING_LIST(MEMBER_WORD) NULL};
const char *const OPTIONS_RUN_STARTS[] = {OPTIONS_RUN_START_LIST(WORD) NULL};
const char *const OPTIONS_ODE_SOLVERS[] = {OPTIONS_ODE_SOLVER_LIST(WORD) NULL};
const char *const OPTIONS_TOLERANCES_OF[] = {OPTIONS_TOLERANCE_OF_LIST(WORD) NULL};
const char *const OPTIONS_ODE_STEPPINGS[] = {OPTIONS_ODE_STEPPING_LIST(MEMBER_WORD) NULL};
const char *const OPTIONS_ODE_MAPS[] = {OPTIONS_ODE_ROW_MAP_LIST(MEMBER_WORD) "impulse", NULL};
const char *const OPTIONS_ODE_COLLIDERS[] = {OPTIONS_ODE_COLLIDER_LIST(MEMBER_WORD) NULL};
const char *const OPTIONS_ODE_POLYGONS[] = {OPTIONS_ODE_POLYGON_LIST(WORD) NULL};
const char *const OPTIONS_BACKENDS[] = {OPTIONS_BACKEND_LIST(MEMBER_WORD) NULL};
const char *const OPTIONS_ENGINE_WAYS[] = {OPTIONS_ENGINE_WAY_LIST(WORD) NULL};
const bool OPTIONS_ODE_STEPPING_IS_GENERAL[] = {OPTIONS_ODE_STEPPING_LIST(MEMBER_IS_GENERAL)};
const bool OPTIONS_BACKEND_HAS_PLAY[] = {OPTIONS_BACKEND_LIST(MEMBER_HAS_PLAY)};

bool options_backend_has_play(const char *backend)
{
    bool has_play = true;
    for (int i = 0; i < BACKEND_COUNT; i++) {
        has_play =
            has_play && (OPTIONS_BACKEND_HAS_PLAY[i] || strcmp(OPTIONS_BACKENDS[i], backend) != 0);
    }
    return has_play;
}

bool options_is_engine(BackendKind backend)
{
    switch (backend) {
#define IS_ENGINE(id, ...) case id:
        OPTIONS_ENGINE_LIST(IS_ENGINE)
        return true;
    case BACKEND_ANALYTIC:
    case BACKEND_REFERENCE:
    case BACKEND_ODE:
    case BACKEND_COUNT:
        break;
    }
    return false;
}

bool options_is_stepped(BackendKind backend)
{
    return backend == BACKEND_ODE || options_is_engine(backend);
}

MaterialOptions material_options_default(void)
{
    return (MaterialOptions){
        .youngs_modulus = 2.07e11, // steel, as in the paper's Table V
        .poisson_ratio = 0.29,     // likewise
    };
}

ContactOptions contact_options_default(void)
{
    return (ContactOptions){
        .model = CONTACT_IMPACT,
        .law = LAW_AUTO,
        .stiffness = 0.0,
        .exponent = 1.5,
        .damping = DAMPING_EXACT, // the one that gives back what was asked for
        .damping_scale = 1.0,
        .viscous_coefficient = 0.0,
        .full_damping_depth = 0.0,
        .restitution = 0.9, // hard steel on hard steel at about 1 m/s
        .friction = 0.0,
        // a hundredth of the sliding speed of the pin in the paper's joint, 0.5 m/s, and more
        .friction_speed = 5e-3,
        .friction_law = BRISTLE_REGULARIZED,
        .breakaway_ratio = 1.0,
        // junctions of steel break away after some 2 to 5 um (Armstrong-Helouvry, Dupont, Canudas
        // de Wit, Automatica 30 (1994) 1083)
        .presliding = 5e-6,
        .presliding_damping = 1.0,
        // a pin that is let go a micron from the wall arrives at 4.4 mm/s; slower arrivals are
        // contact that begins rather than an impact
        .impact_speed_floor = 1e-3,
        .restitution_speed = 0.3, // as the resting speed below
        // Metals lose 0.08 to 0.32 s/m of their restitution with the impact's speed, e = 1 - alpha
        // v (Hunt and Crossley 1975); at the upper end, as of a joint that is greased, the default
        // of 0.9 is that of an impact at 0.3 m/s.
        .resting_speed = 0.3,
        .penalty = 0.0,
        .bounce_speed = 1e-3, // as the floor above
    };
}

RunOptions run_options_default(void)
{
    return (RunOptions){
        .revolutions = 1.0,
        .duration = 0.06, // one revolution at 1000 rpm
        .samples = 3600,  // a tenth of a degree
        .step = 0.0,      // chosen for the tolerance: no one step suits every mechanism
        .tolerance = 1e-4,
        .start = START_SETTLED,
        .settle_starts = 16,  // a motion of one start in five escapes one case in 35
        .settle_least = 200,  // twice the longest transient seen in cams, gears and linkages
        .settle_most = 2000,  // ten times that: the budget ends most searches before
        .settle_to = 0.1,     // a quantile of two digits
        .settle_budget = 2.0, // s: what somebody waits for, and of 60 random cases as right as 10
        .budget = 10.0,       // likewise
        .tolerance_of = TOLERANCE_OF_MOTION, // what of all errors is most sure of
        .most_steps = 3000000, // a minute of world steps that are full of contacts, 20 us each
        // as much as ideal joints show by themselves, so that they show no spike
        .spike_threshold = 1.0,
        .keeps_ranges = true,
        .backend_count = 3,
        .backends = {BACKEND_ANALYTIC, BACKEND_REFERENCE, BACKEND_ODE},
    };
}

ReferenceOptions reference_options_default(void)
{
    return (ReferenceOptions){
        // gives 2e-10 or better over a turn with play in up to three joints; below it, rounding of
        // positions of 0.3 m against depths of 10 micron takes over
        .tolerance = 3e-13,
    };
}

const double OPTIONS_GIVEN_STEP = 1e-6; // s, some 50 steps to a steel contact

OdeOptions ode_options_default(void)
{
    return (OdeOptions){
        .solver = ODE_DIRECT,
        .stepping = ODE_STAGGERED, // second order at the cost of plain stepping
        .map = ODE_MAP_IMPULSE,    // right at any step; see docs/stepping.md
        .collider = ODE_COLLIDER_PIN_HOLE,
        .polygon = ODE_CIRCUMSCRIBED, // smaller errors; see contact/facets.h
        .facets = 0,
        .erp = 0.2, // ODE's own default, set and not inherited
        .cfm = 0.0, // no joint row is redundant, so none needs softening
        // the paper's Eq. (2) has no term in the penetration, and at 0 the pin creeps into the
        // wall, deeper than its play within a turn; ODE's own default holds it
        .push_out = 0.2,
        .iterations = 20,
        .over_relaxation = 1.3,
        .seed = 1,
        .settle_steps = 100, // 0.8^100 = 2e-10 of the start's error is left at ERP 0.2
        .levels = 4,         // order 5; one more gains little before rounding shows
        .gear = 1,
        .contact_phase = 0.0, // as the step of the world allows
    };
}
