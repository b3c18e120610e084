// Has the words of the kinds of joints, and which kind another is without its play.
#include "model/joint.h"

#define JOINT_WORDS(with, id, holds, touches, coordinate, in_space, words) words,

JointKind joint_without_play(JointKind kind)
{
    for (JointKind ideal = 0; ideal < JOINT_KIND_COUNT; ideal++) {
        if (joint_is_ideal(ideal) && joint_slides(ideal) == joint_slides(kind) &&
            joint_pivots(ideal) == joint_pivots(kind)) {
            return ideal;
        }
    }
    return kind;
}

const char *joint_words(JointKind kind)
{
    static const char *const WORDS[] = {JOINT_KIND_LIST(JOINT_WORDS, _)};
    return WORDS[kind];
}
