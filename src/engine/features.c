// Finds what of a case has a word that a driver may not know.
#include "engine/features.h"

#include "model/joint_friction.h"
#include "model/loads.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#define FEATURE_WORD(id, word) word,
static const char *const WORDS[] = {ENGINE_FEATURE_LIST(FEATURE_WORD)};

EngineFeature engine_feature_of(const char *word)
{
    int feature = 0;
    while (feature < ENGINE_FEATURE_COUNT && strcmp(WORDS[feature], word) != 0) {
        feature++;
    }
    return (EngineFeature)feature;
}

const char *engine_feature_word(EngineFeature feature)
{
    return WORDS[feature];
}

// A word that a joint or a linkage has, and what a message calls it; NULL: none.
typedef struct Found {
    EngineFeature word;
    const char *what;
} Found;

static Found found_in_stop(const Joint *joint)
{
    if (joint->stop.cam > 0) {
        return (Found){ENGINE_TAKES_CAMS, "cams"};
    }
    return linkage_has_slot(joint) ? (Found){ENGINE_TAKES_SLOTS, "a pin in a slot"}
                                   : (Found){ENGINE_TAKES_STOPS, "stops"};
}

static Found found_in_joint(const Joint *joint)
{
    switch (joint_touches(joint->kind)) {
    case JOINT_TOUCHES_GUIDES:
        return (Found){ENGINE_TAKES_GUIDES, "a block between guides"};
    case JOINT_TOUCHES_DISC:
        return found_in_stop(joint);
    case JOINT_TOUCHES_TEETH:
        return joint_has_rack(joint->kind) ? (Found){ENGINE_TAKES_RACKS, "a rack and pinion"}
                                           : (Found){ENGINE_TAKES_GEARS, "gears"};
    case JOINT_TOUCHES_NOTHING:
    case JOINT_TOUCHES_HOLE:
        break;
    }
    return joint->limits.kind != LIMIT_NONE ? (Found){ENGINE_TAKES_LIMITS, "limits of a joint"}
                                            : (Found){ENGINE_TAKES_LIMITS, NULL};
}

bool engine_has_drives(const Linkage *linkage)
{
    return linkage->driver.is_present && !drive_is_steady(&linkage->driver);
}

static Found found_in_drives(const Linkage *linkage)
{
    if (!engine_has_drives(linkage)) {
        return (Found){ENGINE_TAKES_DRIVES, NULL};
    }
    return (Found){ENGINE_TAKES_DRIVES, linkage->further_count > 0
                                            ? "several drives"
                                            : "a drive whose speed changes over time"};
}

static Found found_in_torque(const Linkage *linkage)
{
    const Torque *torque = &linkage->torque;
    const Driver *followed = &torque->followed;
    const bool is_line =
        torque->table.count > 0 && joint_has_position(linkage->joints[torque->joint].kind);
    const char *what = NULL;
    if (torque->table.count == 0) {
        what = NULL;
    } else if (torque->limit > 0.0) {
        what = "a soft drive with a torque limit";
    } else if (wave_exists(&torque->table.wave)) {
        what = "a torque that is a sinusoid";
    } else if (followed->is_present && !drive_is_steady(followed) && !drive_is_held(followed)) {
        what = "a soft drive whose speed changes over time";
    } else if (is_line && (torque->slope > 0.0 || followed->is_present)) {
        what = "a motor or soft drive along a line";
    }
    return (Found){ENGINE_TAKES_SERVOS, what};
}

bool engine_has_servo(const Linkage *linkage)
{
    return found_in_torque(linkage).what != NULL;
}

static Found found_in_loads(const Linkage *linkage)
{
    const bool is_any = isfinite(loads_shortest_wave(linkage));
    return (Found){ENGINE_TAKES_WAVES, is_any ? "a load that is a sinusoid" : NULL};
}

// Of what touches: that of an ideal joint is another matter.
static Found found_in_friction(const Scenario *scenario, const Joint *joint)
{
    const bool is_any = linkage_has_play(joint) && joint->friction.law == BRISTLE_STICK &&
                        scenario_friction(scenario, joint) > 0.0;
    return (Found){ENGINE_TAKES_STICK, is_any ? "friction that holds" : NULL};
}

bool engine_rubs(const Linkage *linkage, size_t joint)
{
    return linkage_is_ideal(linkage, joint) && joint_friction_is(&linkage->joints[joint]);
}

// Of an ideal joint: a steady one that does not hold is a torque like others.
static Found found_in_rubbing(const Scenario *scenario, size_t number)
{
    const Joint *joint = &scenario->linkage.joints[number];
    if (!engine_rubs(&scenario->linkage, number)) {
        return (Found){ENGINE_TAKES_RUBS, NULL};
    }
    const bool is_regularized =
        joint_friction_whole(&scenario->contact, joint).law == BRISTLE_REGULARIZED;
    if (joint->friction.steady > 0.0 && is_regularized) {
        return (Found){ENGINE_TAKES_DRAGS, "a steady friction of an ideal joint"};
    }
    return (Found){ENGINE_TAKES_RUBS, is_regularized ? "friction of an ideal joint"
                                                     : "friction of an ideal joint that holds"};
}

static bool lacks(Found found, unsigned among)
{
    return found.what != NULL && (among >> found.word & 1U) == 0;
}

bool engine_features_lack(const Scenario *scenario, unsigned among, char what[ENGINE_LACK_SIZE])
{
    const Linkage *linkage = &scenario->linkage;
    const Found of_all[] = {found_in_drives(linkage), found_in_torque(linkage),
                            found_in_loads(linkage)};
    for (size_t i = 0; i < sizeof of_all / sizeof *of_all; i++) {
        if (lacks(of_all[i], among)) {
            snprintf(what, ENGINE_LACK_SIZE, "%s", of_all[i].what);
            return true;
        }
    }
    for (size_t i = 0; i < linkage->joint_count; i++) {
        const Joint *joint = &linkage->joints[i];
        const Found found[] = {found_in_joint(joint), found_in_friction(scenario, joint),
                               found_in_rubbing(scenario, i)};
        for (size_t k = 0; k < sizeof found / sizeof *found; k++) {
            if (lacks(found[k], among)) {
                snprintf(what, ENGINE_LACK_SIZE, "%s (joint '%s')", found[k].what, joint->name);
                return true;
            }
        }
    }
    return false;
}
