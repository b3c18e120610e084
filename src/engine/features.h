// What a case can have that a driver need not take: words of the protocol, which a driver lists by
// way as it says what it is (docs/drivers.md).
#pragma once

#include "base/err.h"
#include "model/scenario.h"

// The words: a row each, its enumerator and the word.
#define ENGINE_FEATURE_LIST(member)                                                                \
    member(ENGINE_TAKES_LIMITS, "limits") member(ENGINE_TAKES_STOPS, "stops")                      \
        member(ENGINE_TAKES_CAMS, "cams") member(ENGINE_TAKES_SLOTS, "slots")                      \
            member(ENGINE_TAKES_GUIDES, "guides") member(ENGINE_TAKES_GEARS, "gears")              \
                member(ENGINE_TAKES_RACKS, "racks") member(ENGINE_TAKES_DRIVES, "drives")          \
                    member(ENGINE_TAKES_SERVOS, "servos") member(ENGINE_TAKES_WAVES, "waves")      \
                        member(ENGINE_TAKES_STICK, "stick") member(ENGINE_TAKES_RUBS, "rubs")      \
                            member(ENGINE_TAKES_DRAGS, "drags")
#define ENGINE_FEATURE(id, word) id,
typedef enum EngineFeature {
    ENGINE_FEATURE_LIST(ENGINE_FEATURE) ENGINE_FEATURE_COUNT
} EngineFeature;

// The number of a word; ENGINE_FEATURE_COUNT of one that is not known.
EngineFeature engine_feature_of(const char *word);
const char *engine_feature_word(EngineFeature feature);

// The first thing in a scenario that has a word which is not among some, as bits by their number:
// "stops (joint 'beak')"; false where there is none.
enum { ENGINE_LACK_SIZE = 96 };
bool engine_features_lack(const Scenario *scenario, unsigned among, char what[ENGINE_LACK_SIZE]);

// Whether its drives are more than one that turns a body at a constant speed; whether its torque is
// more than loads and torsion springs can say.
bool engine_has_drives(const Linkage *linkage);
bool engine_has_servo(const Linkage *linkage);

// Whether the friction of an ideal joint is to be told of. Of one that a drive turns it is not:
// nothing moves by it.
bool engine_rubs(const Linkage *linkage, size_t joint);
