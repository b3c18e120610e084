// Says which keys of a case matter to a scenario.
#include "casefile/schema_needs.h"

#include "casefile/build.h"
#include "casefile/bushings.h"
#include "casefile/drives.h"
#include "casefile/loads.h"
#include "contact/damping.h"
#include "contact/law.h"

#include <math.h>
#include <string.h>

// ODE's quick solver draws a new order of the rows before every eighth iteration but the first.
enum { SHUFFLE_ITERATIONS = 8 };

// What a scenario must be for a bit to be met.
typedef struct Condition {
    unsigned bit;
    unsigned within; // bits without which it cannot be met
    SchemaLack lack;
} Condition;

// A key that lacks several is told the first. A mistake is what changes the mechanism or its
// contact and takes one word of another key; what chooses among ways to compute may well be kept
// for another setting. What a key asks of itself (OWN_STIFFNESS, VALUED and such) and what check.c
// refuses (FREE, DRIVE and such) has no row.
// clang-format off
static const Condition CONDITIONS[] = {
    {SPATIAL, 0, {"space: spatial", "space", true}},
    {PLAY, 0, {"a joint with play", "", false}},
    {TURNING, 0, {"a drive of constant speed", "", false}},
    {REPEATING, 0, {"a drive of constant speed, or a period of drive or loads", "", false}},
    {IDEAL, 0, {"a case whose joints are all ideal", "", false}},
    {IMPACT, PLAY, {"contact.model: impact", "contact.model", false}},
    {POISSON, PLAY, {"contact.model: poisson", "contact.model", true}},
    {STIFFNESS, IMPACT, {"contact.model: impact", "contact.model", false}},
    {LAW, IMPACT, {"a pin with play that has no stiffness of its own", "contact.stiffness", false}},
    {VISCOUS, IMPACT, {"contact.damping: viscous or step", "contact.damping contact.model", true}},
    {DISSIPATING, IMPACT, {"contact.damping: dissipation", "contact.damping contact.model", true}},
    {MATERIAL, PLAY, {"contact.law, or contact.model: poisson without contact.penalty", "contact.model", false}},
    {FRICTION, PLAY, {"a friction above 0", "contact.friction", false}},
    {REFERENCE, 0, {"reference among run.backends", "run.backends", false}},
    {ODE, 0, {"ode among run.backends", "run.backends", false}},
    {GIVEN_STEP, ODE, {"a given run.step, such as 1 us", "run.step", false}},
    {CHOSEN_STEP, ODE, {"run.step: auto", "run.step", false}},
    {LOCAL, ODE | IMPACT, {"ode.map: impulse", "ode.map", false}},
    {PLAIN, GIVEN_STEP, {"ode.stepping: plain", "ode.stepping", false}},
    {EXTRAPOLATED, ODE | IDEAL, {"ode.stepping: extrapolated", "ode.stepping", false}},
    {QUICK, ODE, {"ode.solver: quick", "ode.solver", false}},
    {FACETED, ODE | PLAY, {"any ode.collider but pin-hole", "ode.collider", false}},
};
// clang-format on

// clang-format off
static const Condition WANTS[] = {
    {COMMON_STIFFNESS, 0, {"a joint with play that has no stiffness of its own", "", false}},
    {COMMON_DAMPING, 0, {"a joint with play that has no viscous-coefficient or dissipation of its own", "", false}},
    {REBOUND, 0, {"a contact.damping but none, viscous and step, at a joint without values of its own", "contact.damping", false}},
    {OWN_REBOUND, 0, {"a contact.damping but none, viscous and step", "contact.damping", false}},
    {COMMON_FRICTION, 0, {"a joint with play whose sides slide and that has no friction of its own", "", false}},
    {PIN, 0, {"a pin with play in its hole", "", false}},
    {HELD_ROWS, 0, {"an ideal joint", "", false}},
    {ANY_ROWS, 0, {"an ideal joint, or any ode.map but impulse", "", false}},
    {SMOOTHED, 0, {"contact.model: impact, and reference among run.backends or ode.solver: direct", "", false}},
    {SHUFFLED, 0, {"ode.iterations above 8", "ode.iterations", false}},
    {SETTLED, 0, {"run.start: settled", "run.start", false}},
    {REMEMBERED, 0, {"a contact.damping but none, viscous, dissipation and step", "contact.damping", false}},
    {DERIVED, 0, {"no contact.dissipation", "contact.dissipation", false}},
    {GROWING, 0, {"contact.damping: step", "contact.damping contact.model", true}},
    {LENGTHWISE, 0, {"a contact.law of cylinders, run.start: settled, or space: spatial", "contact.law run.start", false}},
    {COMMON_DEPTH, 0, {"a joint with play that has no full-damping-depth of its own", "", false}},
    {UNSTEADY, 0, {"a drive.speed, angle, torque or force over time", "drive.speed", false}},
    {ELASTIC_PIN, 0, {"contact.law: elastic, or auto and a width, and no stiffness of its own", "contact.law", false}},
    {BRISTLED, 0, {"friction-law: stick or lugre", "contact.friction-law", true}},
    {MOVED, 0, {"a drive that determines the motion", "", false}},
};
// clang-format on

enum { WANT_COUNT = sizeof WANTS / sizeof *WANTS };

enum { CONDITION_COUNT = sizeof CONDITIONS / sizeof *CONDITIONS };

// What a key lacks whose backends do not run: a word for each, and one for all with steps.
static const SchemaLack BACKEND_LACKS[] = {
#define LACKS_BACKEND(id, word, ...) [id] = {word " among run.backends", "run.backends", false},
    OPTIONS_BACKEND_LIST(LACKS_BACKEND)};
static const SchemaLack STEPPED_LACK = {"ode or another engine among run.backends", "run.backends",
                                        false};

// Whether one of the backends that a key is of runs; where not, what is lacking.
static bool has_backend(const SchemaRow *row, const Scenario *scenario, SchemaLack *lack)
{
    bool runs = row->backends == 0;
    for (size_t i = 0; i < scenario->run.backend_count; i++) {
        runs = runs || (row->backends & SCHEMA_WITH(scenario->run.backends[i])) != 0;
    }
    if (!runs && lack != NULL) {
        int backend = 0;
        while (row->backends != SCHEMA_WITH(backend) && backend + 1 < BACKEND_COUNT) {
            backend++;
        }
        *lack = row->backends == SCHEMA_STEPPED ? STEPPED_LACK : BACKEND_LACKS[backend];
    }
    return runs;
}

// The bits of a row, and those without which they cannot be met.
static unsigned needs_of(const SchemaRow *row)
{
    unsigned needs = row->needs;
    for (size_t i = CONDITION_COUNT; i-- > 0;) {
        needs |= needs & CONDITIONS[i].bit ? CONDITIONS[i].within : 0;
    }
    // one that names its backends is not of ODE alone
    return row->backends != 0 ? needs & ~(unsigned)ODE : needs;
}

static unsigned bit(unsigned need, bool is_met)
{
    return is_met ? need : 0;
}

// How the steps are taken.
static unsigned step_bits(const Scenario *scenario, bool is_impact)
{
    const OdeOptions *ode = &scenario->ode;
    const bool is_given = scenario->run.step > 0.0;
    return bit(GIVEN_STEP, is_given) | bit(CHOSEN_STEP, !is_given) |
           bit(PLAIN, is_given && ode->stepping == ODE_PLAIN) |
           bit(EXTRAPOLATED,
               is_given ? ode->stepping == ODE_EXTRAPOLATED : scenario_is_extrapolable(scenario)) |
           bit(LOCAL, is_impact && (!is_given || ode->map == ODE_MAP_IMPULSE));
}

// Whether a key of a joint whose coordinate may be limited says how it is.
static bool limits_apply(const SchemaRow *row, const Joint *joint, const void *field)
{
    const LimitKind kind = joint->limits.kind;
    if (row->type == SCHEMA_COORDINATE) {
        return kind == (row->side == 0 ? LIMIT_BACKLASH : LIMIT_STOPS) &&
               isfinite(*(const double *)field);
    }
    return row->type != SCHEMA_START || kind == LIMIT_BACKLASH || joint_is_loose(joint->kind);
}

// Whether a key is the one that says where a joint is: one place, with its start, or two.
static bool places_apply(const SchemaRow *row, const Joint *joint)
{
    const bool is_of_both = row->rivalry == SCHEMA_PLACING && row->side == SCHEMA_PLACE_OF_BOTH;
    return !joint->is_apart || !(is_of_both || row->type == SCHEMA_START);
}

// Whether a key says what a stop is: a cam has a profile, and on it a roller or a flat; a slot has
// no discs.
static bool stops_apply(const SchemaRow *row, const Joint *joint)
{
    const bool is_cam = joint->stop.cam > 0;
    if (!joint_has_disc(joint->kind)) {
        return true;
    }
    switch (row->type) {
    case SCHEMA_PROFILE:
        return is_cam;
    case SCHEMA_SLOT:
        return joint->stop.slot > 0.0;
    case SCHEMA_DISCS:
        return !is_cam && joint->stop.slot == 0.0;
    case SCHEMA_HEADING:
        return !is_cam || joint->stop.is_flat;
    default:
        return true;
    }
}

// Whether a key of gears says something: how often tables repeat, where there are some.
static bool gears_apply(const SchemaRow *row, const Joint *joint)
{
    if (!joint_has_mesh(joint->kind)) {
        return true;
    }
    const char *key = strrchr(row->path, '.') + 1;
    return strcmp(key, "transmission-error") == 0 ? joint->gear.error > 0
           : strcmp(key, "relief") == 0           ? joint->gear.relief > 0
           : strcmp(key, "repeats") == 0          ? linkage_has_teeth_tables(joint)
                                                  : true;
}

// The form in which a case of the scenario is written.
static SchemaForm form_of(const Scenario *scenario)
{
    return scenario->has_fourbar       ? SCHEMA_FOUR_BAR
           : scenario->has_slidercrank ? SCHEMA_SLIDER_CRANK
                                       : SCHEMA_LONG;
}

static unsigned drive_bits(const Scenario *scenario)
{
    const Linkage *linkage = &scenario->linkage;
    const Joint *pushed = schema_member(scenario, SCHEMA_JOINT, (size_t)linkage->torque.joint);
    const bool is_force = joint_has_position(pushed->kind);
    const bool is_torque = linkage->torque.table.count > 0;
    const bool is_steady = drive_is_steady(&linkage->driver);
    const bool is_soft = linkage->torque.followed.is_present;
    const bool may_turn = is_steady || drive_is_steady(&linkage->torque.followed);
    return bit(DRIVE, linkage->driver.is_present || is_soft) | bit(TORQUE, is_torque && !is_force) |
           bit(FORCE, is_torque && is_force) |
           bit(DRIVEN, linkage->driver.is_present || is_torque) | bit(TURNING, may_turn) |
           bit(TIMED, !is_steady) | bit(REPEATING, scenario_settling_period(scenario) > 0.0);
}

static unsigned contact_bits(const Scenario *scenario)
{
    const ContactOptions *contact = &scenario->contact;
    const bool has_play = scenario_has_clearance(scenario);
    const bool is_impact = has_play && contact->model == CONTACT_IMPACT;
    const bool is_poisson = has_play && contact->model == CONTACT_POISSON;
    const bool has_law = is_impact && law_is_asked(scenario);
    return bit(PLAY, has_play) | bit(IDEAL, !has_play) | bit(IMPACT, is_impact) |
           bit(POISSON, is_poisson) | bit(LAW, has_law) |
           bit(STIFFNESS, is_impact && contact->stiffness > 0.0) |
           bit(MATERIAL, has_law || (is_poisson && contact->penalty == 0.0)) |
           bit(VISCOUS, is_impact && (contact->damping == DAMPING_VISCOUS ||
                                      contact->damping == DAMPING_STEP)) |
           bit(DISSIPATING, is_impact && contact->damping == DAMPING_DISSIPATION) |
           bit(FRICTION, law_has_friction(scenario)) | step_bits(scenario, is_impact);
}

unsigned schema_met(const Scenario *scenario)
{
    unsigned met = drive_bits(scenario) | contact_bits(scenario) |
                   bit(FREE, !build_is_determined(&scenario->linkage)) |
                   bit(QUICK, scenario->ode.solver == ODE_QUICK) |
                   bit(FACETED, scenario->ode.collider != ODE_COLLIDER_PIN_HOLE) |
                   bit(SPATIAL, scenario->linkage.is_spatial);
    for (size_t i = 0; i < scenario->run.backend_count; i++) {
        met |= bit(REFERENCE, scenario->run.backends[i] == BACKEND_REFERENCE);
        met |= bit(ODE, scenario->run.backends[i] == BACKEND_ODE);
    }
    return met;
}

static unsigned joint_bits(const Scenario *scenario, const Joint *joint)
{
    const bool is_own = joint->contact.stiffness > 0.0 &&
                        (!scenario->contact.is_for_all || linkage_is_torsional(joint));
    return bit(OWN_STIFFNESS, is_own);
}

// Whether a key of a drive by a torque says how it is: a torque over time, a motor, or a soft
// drive.
static bool torque_applies(const SchemaRow *row, const Linkage *linkage)
{
    const Torque *torque = &linkage->torque;
    const bool is_soft = torque->followed.is_present;
    if (!drives_apply(row, &linkage->driver)) {
        return false;
    }
    const bool is_motor = torque->no_load != 0.0;
    switch (row->offset) {
    case offsetof(Scenario, linkage.torque.table):
        return !is_soft && !is_motor;
    case offsetof(Scenario, linkage.torque.table.values[0]):
    case offsetof(Scenario, linkage.torque.no_load):
    case offsetof(Scenario, linkage.torque.inertia):
        return is_motor;
    case offsetof(Scenario, linkage.torque.stiffness):
    case offsetof(Scenario, linkage.torque.slope):
    case offsetof(Scenario, linkage.torque.limit):
        return is_soft;
    default:
        return true;
    }
}

bool schema_applies(const SchemaRow *row, const Scenario *scenario, size_t index, unsigned met)
{
    if (!schema_is_of_form(row, form_of(scenario))) {
        return false;
    }
    const bool is_member = index < schema_member_count(scenario, row->family);
    met |= bit(MEMBER, is_member);
    if (is_member && (row->needs & VALUED) != 0) {
        met |= bit(VALUED, *(const double *)schema_field_const(row, scenario, index) > 0.0);
    }
    if (row->family == SCHEMA_JOINT && is_member) {
        const Joint *joint = &scenario->linkage.joints[index];
        met |= joint_bits(scenario, joint);
        met |= bit(OWN, row->flag > 0 && *((const bool *)((const char *)joint + row->flag)));
        if (!limits_apply(row, joint, schema_field_const(row, scenario, index)) ||
            !places_apply(row, joint) || !stops_apply(row, joint) || !gears_apply(row, joint) ||
            !schema_is_of_kind(row, joint->kind)) {
            return false;
        }
    }
    if (strncmp(row->path, "drive.", strlen("drive.")) == 0 &&
        !torque_applies(row, &scenario->linkage)) {
        return false;
    }
    if (row->family == SCHEMA_DRIVE && is_member &&
        !drives_apply(row, &scenario->linkage.further[index])) {
        return false;
    }
    if (row->family == SCHEMA_BUSHING && is_member &&
        !bushings_apply(row, &scenario->linkage.bushings[index])) {
        return false;
    }
    if (row->family == SCHEMA_LOAD_FAMILY && is_member &&
        !loads_apply(row, &scenario->linkage, &scenario->linkage.loads[index])) {
        return false;
    }
    return (row->needs & ~met) == 0 && has_backend(row, scenario, NULL);
}

// Whether a joint's damping is that of the contact, at least in its kind.
static bool has_common_damping(const ContactOptions *contact, const Joint *joint)
{
    const JointContact *own = &joint->contact;
    const bool is_viscous = own->viscous > 0.0 && contact->damping != DAMPING_STEP;
    return !is_viscous && own->dissipation == 0.0 && own->full_depth == 0.0;
}

// What the joints of a scenario take from the contact that all share.
static unsigned shared_bits(const Scenario *scenario)
{
    const ContactOptions *contact = &scenario->contact;
    const bool is_poisson = contact->model == CONTACT_POISSON;
    unsigned met = 0;
    for (size_t i = 0; i < scenario->linkage.joint_count; i++) {
        const Joint *joint = &scenario->linkage.joints[i];
        if (!linkage_has_play(joint)) {
            continue;
        }
        const DampingKind damping = law_options(contact, joint).damping;
        met |= bit(COMMON_STIFFNESS, (joint_bits(scenario, joint) & OWN_STIFFNESS) == 0) |
               bit(COMMON_DAMPING, has_common_damping(contact, joint)) |
               bit(COMMON_DEPTH, joint->contact.full_depth == 0.0) |
               bit(COMMON_FRICTION, !joint->contact.has_friction && !linkage_is_torsional(joint)) |
               bit(REBOUND,
                   (damping_restores(damping) || is_poisson) && !joint->contact.has_restitution) |
               bit(REMEMBERED, damping_restores(damping) && damping != DAMPING_DISSIPATION) |
               bit(PIN, joint_has_hole(joint->kind));
    }
    return met;
}

// The rows that ODE has, and whether some solver smooths friction.
static unsigned row_bits(const Scenario *scenario)
{
    const RunOptions *run = &scenario->run;
    bool is_held = false;
    bool is_smoothed = scenario->ode.solver != ODE_QUICK;
    bool is_bristled = false;
    for (size_t i = 0; i < scenario->linkage.joint_count; i++) {
        is_held = is_held || joint_is_ideal(scenario->linkage.joints[i].kind);
        is_bristled =
            is_bristled || scenario->linkage.joints[i].friction.law != BRISTLE_REGULARIZED;
    }
    for (size_t i = 0; i < run->backend_count; i++) {
        is_smoothed = is_smoothed || run->backends[i] == BACKEND_REFERENCE;
    }
    const bool has_contacts = run->step > 0.0 && scenario->ode.map != ODE_MAP_IMPULSE;
    return bit(HELD_ROWS, is_held) | bit(ANY_ROWS, is_held || has_contacts) |
           bit(SMOOTHED, is_smoothed && scenario->contact.model == CONTACT_IMPACT) |
           bit(SHUFFLED, scenario->ode.iterations > SHUFFLE_ITERATIONS) |
           bit(BRISTLED, is_bristled) | bit(MOVED, build_is_determined(&scenario->linkage)) |
           bit(SETTLED, scenario->run.start == START_SETTLED) |
           bit(UNSTEADY, scenario->linkage.driver.table.count > 0 ||
                             scenario->linkage.torque.table.count > 1) |
           bit(GROWING, scenario->contact.damping == DAMPING_STEP) |
           bit(DERIVED, scenario->contact.damping != DAMPING_DISSIPATION ||
                            scenario->contact.dissipation == 0.0);
}

static bool has_elastic_law(const Scenario *scenario, const Joint *joint)
{
    const ContactOptions own = law_options(&scenario->contact, joint);
    return own.model == CONTACT_IMPACT && own.stiffness == 0.0 && own.law == LAW_ELASTIC;
}

// Whether the length over which a pin touches is felt, by its law or, of a settled motion, by the
// other laws that its force is held against (run/spread.h). A stiffness that is given holds for
// that of its pin.
static bool is_lengthwise(const Scenario *scenario, const Joint *joint)
{
    const ContactOptions own = law_options(&scenario->contact, joint);
    return scenario->contact.model != CONTACT_IMPACT || scenario->linkage.is_spatial ||
           scenario->ode.collider != ODE_COLLIDER_PIN_HOLE || own.stiffness > 0.0 ||
           law_get(own.law)->needs_width || scenario->run.start == START_SETTLED;
}

static unsigned wants_met(const SchemaRow *row, const Scenario *scenario, size_t index)
{
    const bool is_joint = row->family == SCHEMA_JOINT && index < scenario->linkage.joint_count;
    const Joint *joint = is_joint ? &scenario->linkage.joints[index] : NULL;
    const bool is_own =
        is_joint && (scenario->contact.model == CONTACT_POISSON ||
                     damping_restores(law_options(&scenario->contact, joint).damping));
    return shared_bits(scenario) | row_bits(scenario) | bit(OWN_REBOUND, is_own) |
           bit(LENGTHWISE, is_joint && is_lengthwise(scenario, joint)) |
           bit(ELASTIC_PIN, is_joint && has_elastic_law(scenario, joint));
}

// A start is one of play: without, nothing says where a joint starts but its bodies.
static bool lacks_gap(const SchemaRow *row, const Scenario *scenario, size_t index,
                      SchemaLack *lack)
{
    const bool is_start = row->type == SCHEMA_START && index < scenario->linkage.joint_count;
    if (!is_start || limits_apply(row, &scenario->linkage.joints[index],
                                  schema_field_const(row, scenario, index))) {
        return false;
    }
    *lack = (SchemaLack){"backlash of the joint", "joints.*.backlash", true};
    return true;
}

// A profile is one of angles: a speed has none.
static bool lacks_angles(const SchemaRow *row, const Scenario *scenario, size_t index,
                         SchemaLack *lack)
{
    const Linkage *linkage = &scenario->linkage;
    if (row->offset == offsetof(Scenario, linkage.driver.profile) && row->family == SCHEMA_SINGLE &&
        row->holder == SCHEMA_SINGLE) {
        *lack = (SchemaLack){"drive.angle", "drive.angle drive.speed", true};
        return !linkage->driver.has_angles;
    }
    if (row->family == SCHEMA_DRIVE && row->type == SCHEMA_CHOICE &&
        index < linkage->further_count) {
        *lack = (SchemaLack){"an angle of that drive", "drives.*.angle drives.*.speed", true};
        return !linkage->further[index].has_angles;
    }
    return false;
}

// Settings of how a run is computed and reported.
static bool is_of_computing(const SchemaRow *row)
{
    static const char *const GROUPS[] = {"run.", "reference.", "ode.", "engines."};
    for (size_t i = 0; i < sizeof GROUPS / sizeof *GROUPS; i++) {
        if (strncmp(row->path, GROUPS[i], strlen(GROUPS[i])) == 0) {
            return true;
        }
    }
    return false;
}

// Whether draws of the inputs make use of a row that is one of engines: run.budget.
static bool is_of_draws(const SchemaRow *row, const Scenario *scenario)
{
    return row->holder == SCHEMA_SINGLE && row->offset == offsetof(Scenario, run.budget) &&
           row->family == SCHEMA_SINGLE && scenario_settles(scenario) &&
           scenario_has_clearance(scenario);
}

bool schema_lacks(const SchemaRow *row, const Scenario *scenario, size_t index, unsigned met,
                  SchemaLack *lack)
{
    const unsigned missing = needs_of(row) & ~met;
    const bool applies = schema_applies(row, scenario, index, met);
    if (!has_backend(row, scenario, lack) && !is_of_draws(row, scenario)) {
        return true;
    }
    for (size_t i = 0; !applies && i < CONDITION_COUNT; i++) {
        if (missing & CONDITIONS[i].bit) {
            *lack = CONDITIONS[i].lack;
            lack->is_mistake = lack->is_mistake && !is_of_computing(row);
            return true;
        }
    }
    const unsigned unmet =
        applies && row->wants ? row->wants & ~wants_met(row, scenario, index) : 0;
    for (size_t i = 0; i < WANT_COUNT; i++) {
        if (unmet & WANTS[i].bit) {
            *lack = WANTS[i].lack;
            return true;
        }
    }
    return !applies &&
           (lacks_gap(row, scenario, index, lack) || lacks_angles(row, scenario, index, lack));
}

void schema_list_needs(const SchemaRow *row, Text *text)
{
    size_t count = 0;
    unsigned implied = 0;
    for (size_t i = 0; i < CONDITION_COUNT; i++) {
        implied |= row->needs & CONDITIONS[i].bit ? CONDITIONS[i].within : 0;
    }
    if (row->backends == SCHEMA_STEPPED) {
        text_append(text, "%s%s", count++ > 0 ? "; " : "", STEPPED_LACK.words);
    }
    for (int i = 0; i < BACKEND_COUNT; i++) {
        if (row->backends == SCHEMA_WITH(i)) {
            text_append(text, "%s%s", count++ > 0 ? "; " : "", BACKEND_LACKS[i].words);
        }
    }
    for (size_t i = 0; i < CONDITION_COUNT; i++) {
        if (row->needs & ~implied & CONDITIONS[i].bit) {
            text_append(text, "%s%s", count++ > 0 ? "; " : "", CONDITIONS[i].lack.words);
        }
    }
    for (size_t i = 0; i < WANT_COUNT; i++) {
        if (row->wants & WANTS[i].bit) {
            text_append(text, "%s%s", count++ > 0 ? "; " : "", WANTS[i].lack.words);
        }
    }
}
