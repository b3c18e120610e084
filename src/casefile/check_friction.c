// Checks that the keys of an ideal joint's friction go together, and that what solves it knows it.
#include "casefile/check_friction.h"

#include "model/joint_friction.h"

static const char STEADY[] = "joints.*.friction-torque joints.*.friction-force";
static const char OF_IDEAL[] = "joints.*.friction joints.*.friction-torque joints.*.friction-force";
static const char OF_BRISTLE[] =
    "joints.*.presliding-damping joints.*.presliding joints.*.breakaway-ratio";
static const char OF_ANY[] = "joints.*.friction-law joints.*.friction-speed "
                             "joints.*.friction-length joints.*.friction-radius "
                             "joints.*.presliding-damping joints.*.presliding "
                             "joints.*.breakaway-ratio";

// One that has what presses on it times a coefficient, or a value of its own.
static bool check_kinds(const Entries *entries, size_t index, const Joint *joint, Err *err)
{
    const Entry *steady = entries_blame(entries, STEADY, index);
    const Entry *friction = entries_find(entries, "joints.*.friction", index);
    const bool slides = joint_slides(joint->kind);
    if (steady != NULL && friction != NULL) {
        return entries_refuse(steady, err,
                              "joint '%s' has a friction coefficient and a friction that does not "
                              "depend on what presses\nallowed: one of the two",
                              joint->name);
    }
    if (friction != NULL && !slides && joint->contact.friction > 0.0 &&
        joint->friction.radius == 0.0) {
        return entries_refuse(friction, err,
                              "the friction of the ideal pivot '%s' needs the radius of its pin\n"
                              "allowed: friction-radius: 10 mm beside it, friction-torque: 0.1 N m "
                              "instead, or a joint with play",
                              joint->name);
    }
    const Entry *length = entries_find(entries, "joints.*.friction-length", index);
    if (length != NULL && friction == NULL) {
        return entries_refuse(length, err,
                              "joint '%s' has no friction of what presses over that "
                              "length\nallowed: friction: 0.1 beside it",
                              joint->name);
    }
    return true;
}

static bool check_law(const Entries *entries, size_t index, const Joint *joint, Err *err)
{
    const Entry *any = entries_blame(entries, OF_ANY, index);
    const bool is_given = entries_find(entries, "joints.*.friction", index) != NULL ||
                          entries_blame(entries, STEADY, index) != NULL;
    if (any != NULL && !is_given) {
        return entries_refuse(
            any, err, "joint '%s' has no friction\nallowed: %s beside it", joint->name,
            joint_slides(joint->kind) ? "friction: 0.1, or friction-force: 1 N"
                                      : "friction: 0.1 and friction-radius: 10 mm, or "
                                        "friction-torque: 0.1 N m");
    }
    return true;
}

// A joint with play, of which nothing slides against friction.
static bool check_sliding(const Entries *entries, size_t index, const Scenario *scenario, Err *err)
{
    const Joint *joint = &scenario->linkage.joints[index];
    const Entry *any = entries_blame(entries, OF_ANY, index);
    return any == NULL || scenario_friction(scenario, joint) > 0.0 ||
           entries_refuse(any, err, "joint '%s' has no friction\nallowed: friction: 0.1 beside it",
                          joint->name);
}

// What a law of friction has no use for.
static bool check_bristle(const Entries *entries, size_t index, const Scenario *scenario, Err *err)
{
    const Joint *joint = &scenario->linkage.joints[index];
    const Entry *bristle = entries_blame(entries, OF_BRISTLE, index);
    if (bristle != NULL && joint->friction.law == BRISTLE_REGULARIZED) {
        return entries_refuse(bristle, err,
                              "regularized friction, as that of joint '%s', has no "
                              "bristle\nallowed: friction-law: stick, or lugre, beside it",
                              joint->name);
    }
    const Entry *speed = entries_find(entries, "joints.*.friction-speed", index);
    if (speed != NULL && joint->friction.law == BRISTLE_STICK &&
        joint_friction_whole(&scenario->contact, joint).ratio == 1.0) {
        return entries_refuse(speed, err,
                              "the friction of joint '%s' does not change with the speed: it "
                              "sticks, and its breakaway-ratio is 1\nallowed: a breakaway-ratio "
                              "above 1, or no friction-speed",
                              joint->name);
    }
    return true;
}

// Whether ODE does: where contacts are integrated within the step.
static bool knows_bristles(const Scenario *scenario)
{
    const Scenario chosen = scenario_with_step(scenario, 1.0);
    return scenario_integrates_contacts(scenario->run.step > 0.0 ? scenario : &chosen);
}

// Where the bristles of contacts are not known.
static bool check_contacts(const Entries *entries, const Scenario *scenario, Err *err)
{
    for (size_t i = 0; i < scenario->linkage.joint_count; i++) {
        const Joint *joint = &scenario->linkage.joints[i];
        if (joint_is_ideal(joint->kind) || joint->friction.law == BRISTLE_REGULARIZED) {
            continue;
        }
        const Entry *own = entries_find(entries, "joints.*.friction-law", i);
        const Entry *law = own != NULL ? own : entries_find(entries, "contact.friction-law", 0);
        const char *word = OPTIONS_FRICTION_LAWS[joint->friction.law];
        if (joint->friction.law == BRISTLE_LUGRE) {
            return entries_refuse(
                law, err,
                "LuGre's model is for ideal joints, and joint '%s' has play: in an "
                "impact its bristle's damper alone would hold many times the "
                "friction\nallowed: friction-law: regularized, stick",
                joint->name);
        }
        if (scenario->linkage.is_spatial) {
            return entries_refuse(law, err,
                                  "in space the friction of joint '%s' is regularized\nallowed: "
                                  "friction-law: regularized, or space: planar",
                                  joint->name);
        }
        for (size_t k = 0; k < scenario->run.backend_count; k++) {
            const BackendKind backend = scenario->run.backends[k];
            if (backend == BACKEND_ODE && !knows_bristles(scenario)) {
                return entries_refuse(law, err,
                                      "ODE knows friction-law %s, as of joint '%s', only where it "
                                      "integrates contacts\nallowed: regularized, or ode.stepping: "
                                      "staggered with ode.map: impulse",
                                      word, joint->name);
            }
        }
    }
    return true;
}

// What ODE knows of the friction of ideal joints: all but LuGre's where it integrates contacts
// (ode/plane/impulse_rubs.c), else that of pivots that have rows (ode/plane/rubbing.c).
static bool check_ode(const Entries *entries, const Scenario *scenario, const Entry *culprit,
                      Err *err)
{
    const OdeOptions *ode = &scenario->ode;
    const Linkage *linkage = &scenario->linkage;
    const bool is_within = knows_bristles(scenario);
    const bool has_rows =
        ode->solver == ODE_DIRECT && (ode->stepping == ODE_PLAIN || ode->stepping == ODE_STAGGERED);
    for (size_t i = 0; i < linkage->joint_count; i++) {
        const Joint *joint = &linkage->joints[i];
        if (!joint_friction_is(joint)) {
            continue;
        }
        if (joint->friction.law == BRISTLE_LUGRE) {
            return entries_refuse(entries_blame(entries, OF_IDEAL, i), err,
                                  "ODE does not know LuGre's friction, as of joint '%s'\nallowed: "
                                  "friction-law: stick, or run.backends: [reference]",
                                  joint->name);
        }
        if (!is_within && (joint_slides(joint->kind) || !has_rows)) {
            const Entry *way =
                entries_blame(entries, "ode.map ode.stepping ode.solver run.backends", 0);
            return entries_refuse(way != NULL ? way : culprit, err,
                                  "ODE does not know the friction of the ideal joint '%s' in this "
                                  "way\nallowed: ode.stepping: staggered with map: impulse, of "
                                  "pivots plain or staggered with solver: direct and any map, or "
                                  "run.backends: [reference]",
                                  joint->name);
        }
    }
    return true;
}

// What other engines know of it, of which each driver says more (engine/features.h).
static bool check_engine(const Entries *entries, const Scenario *scenario, BackendKind backend,
                         Err *err)
{
    for (size_t i = 0; i < scenario->linkage.joint_count; i++) {
        const Joint *joint = &scenario->linkage.joints[i];
        if (joint_friction_is(joint) && joint->friction.law == BRISTLE_LUGRE) {
            return entries_refuse(entries_blame(entries, OF_IDEAL, i), err,
                                  "the backend %s does not know LuGre's friction, as of joint "
                                  "'%s'\nallowed: friction-law: regularized, stick, or "
                                  "run.backends: [reference]",
                                  OPTIONS_BACKENDS[backend], joint->name);
        }
    }
    return true;
}

// Where friction of ideal joints is not known.
static bool check_solvers(const Entries *entries, const Scenario *scenario, Err *err)
{
    const int first = joint_friction_first(&scenario->linkage);
    if (first < 0) {
        return true;
    }
    const char *name = scenario->linkage.joints[first].name;
    const Entry *culprit = entries_blame(entries, OF_IDEAL, (size_t)first);
    if (scenario->linkage.is_spatial) {
        return entries_refuse(culprit, err,
                              "in space the ideal joint '%s' has no friction\nallowed: space: "
                              "planar, or a joint with play",
                              name);
    }
    for (size_t i = 0; i < scenario->run.backend_count; i++) {
        const BackendKind backend = scenario->run.backends[i];
        if ((backend == BACKEND_ODE && !check_ode(entries, scenario, culprit, err)) ||
            (options_is_engine(backend) && !check_engine(entries, scenario, backend, err))) {
            return false;
        }
        if (backend == BACKEND_ANALYTIC) {
            const Entry *asked = entries_find(entries, "run.backends", 0);
            return entries_refuse(asked != NULL ? asked : culprit, err,
                                  "the backend %s does not know the friction of ideal joints, as "
                                  "of joint '%s'\nallowed: run.backends: [reference, ode]",
                                  OPTIONS_BACKENDS[backend], name);
        }
    }
    return true;
}

bool check_friction(const Entries *entries, const Scenario *scenario, Err *err)
{
    for (size_t i = 0; i < scenario->linkage.joint_count; i++) {
        const Joint *joint = &scenario->linkage.joints[i];
        if (joint_is_ideal(joint->kind) &&
            (!check_kinds(entries, i, joint, err) || !check_law(entries, i, joint, err))) {
            return false;
        }
        if (!joint_is_ideal(joint->kind) && !check_sliding(entries, i, scenario, err)) {
            return false;
        }
        if (!check_bristle(entries, i, scenario, err)) {
            return false;
        }
    }
    return check_contacts(entries, scenario, err) && check_solvers(entries, scenario, err);
}
