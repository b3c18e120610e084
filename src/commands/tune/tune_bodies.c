// Names bodies and joints in programs against libjointplay, and says where their points are.
#include "commands/tune/tune_bodies.h"

#include "model/joint_friction.h"

#include <string.h>

static void write_plain(const char *name, Text *text)
{
    for (const char *letter = name; *letter != '\0'; letter++) {
        const bool is_plain = (*letter >= 'a' && *letter <= 'z') ||
                              (*letter >= 'A' && *letter <= 'Z') ||
                              (*letter >= '0' && *letter <= '9');
        text_append(text, "%c", is_plain ? *letter : '_');
    }
}

// Whether two names are one where all but letters and digits is one sign.
static bool tune_bodies_are_alike(const char *a, const char *b)
{
    Text first;
    Text second;
    text_init(&first);
    text_init(&second);
    write_plain(a, &first);
    write_plain(b, &second);
    const bool is_same =
        first.length == second.length && strncmp(first.data, second.data, first.length) == 0;
    text_finish(&first);
    text_finish(&second);
    return is_same;
}

typedef enum Named { BODIES, JOINTS } Named;

static const char *tune_bodies_name_of(const Linkage *linkage, Named named, int number)
{
    return named == BODIES ? linkage->bodies[number].name : linkage->joints[number].name;
}

// The name in letters and digits, with the number behind it where another would be the same.
static void write_unique(const Linkage *linkage, Named named, int number, Text *text)
{
    const size_t count = named == BODIES ? linkage->body_count : linkage->joint_count;
    const char *name = tune_bodies_name_of(linkage, named, number);
    write_plain(name, text);
    for (int i = 0; i < (int)count; i++) {
        if (i != number && tune_bodies_are_alike(tune_bodies_name_of(linkage, named, i), name)) {
            text_append(text, "_%d", number);
            return;
        }
    }
}

void tune_bodies_name(const Linkage *linkage, int body, Text *text)
{
    if (body == LINKAGE_GROUND) {
        text_append(text, "NULL");
        return;
    }
    text_append(text, "body_");
    write_unique(linkage, BODIES, body, text);
}

void tune_bodies_joint_name(const Linkage *linkage, int joint, Text *text)
{
    text_append(text, "joint_");
    write_unique(linkage, JOINTS, joint, text);
}

bool tune_bodies_is_led(const Linkage *linkage, int body)
{
    return body != LINKAGE_GROUND && linkage_is_driven(linkage, body) &&
           drive_is_steady(&linkage->driver);
}

Vec2 tune_bodies_local(const Linkage *linkage, int body, Vec2 local)
{
    const int joint = linkage->driver.joint;
    return tune_bodies_is_led(linkage, body)
               ? vec2_sub(local, linkage_end(&linkage->joints[joint], 1).anchor)
               : local;
}

double tune_bodies_bristle_mass(const Linkage *linkage, const Joint *joint)
{
    bool is_other = false;
    for (int side = 0; side < 2; side++) {
        const int body = linkage_end(joint, side).body;
        is_other =
            is_other || (body != LINKAGE_GROUND && linkage_drive_of_body(linkage, body) >= 0 &&
                         !tune_bodies_is_led(linkage, body));
    }
    return is_other ? joint_friction_mass(linkage, joint) : 0.0;
}
