// Gives the bodies of a linkage in the plane the speeds that they start with.
#include "casefile/speeds.h"

#include "base/zeroed.h"
#include "model/nearest.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { REASON_SIZE = 192, NEAREST_LISTED = 4 };

static const double SPEED_PRINTED = 1e-12; // of m/s and rad/s, and of a speed: not printed

// A driven body moves as its drive says, unless the case says how it moves.
static void turn_driven_body(const Entries *entries, const Linkage *linkage, size_t drive,
                             Motion *motions)
{
    const int body = linkage_drive_body(linkage, drive);
    if (entries_find(entries, "bodies.*.velocity", (size_t)body) == NULL &&
        entries_find(entries, "bodies.*.spin", (size_t)body) == NULL) {
        const Vec2 pivot = linkage->joints[linkage_drive(linkage, drive)->joint].anchor_a;
        const Vec2 arm = vec2_sub(motions[body].position, pivot);
        const double speed = drive_at(linkage_drive(linkage, drive), 0.0).omega;
        motions[body].omega = speed;
        motions[body].velocity = vec2_scale(speed, vec2_perp(arm));
    }
}

// Whether a body has to move otherwise than it does, by more than what is left out in printing.
static bool has_to_change(const Motion *motion, const Motion *nearest)
{
    const double speed = vec2_length(vec2_sub(motion->velocity, nearest->velocity));
    return speed > SPEED_PRINTED * fmax(vec2_length(nearest->velocity), SPEED_PRINTED) ||
           fabs(motion->omega - nearest->omega) >
               SPEED_PRINTED * fmax(fabs(nearest->omega), SPEED_PRINTED);
}

// A speed that is rounding is none, and no speed is -0.
static double printed(double speed)
{
    return fabs(speed) > SPEED_PRINTED ? speed : 0.0;
}

// What to write, body by body: those without speeds in the case stand still, and may not either.
static void append_nearest(const Linkage *linkage, const Motion *motions, const Motion *nearest,
                           Text *words)
{
    size_t listed = 0;
    size_t left_out = 0;
    for (size_t i = 0; i < linkage->body_count; i++) {
        if (!has_to_change(&motions[i], &nearest[i])) {
            continue;
        }
        if (listed == NEAREST_LISTED) {
            left_out++;
            continue;
        }
        const Motion *motion = &nearest[i];
        text_append(words, "%s%s: {velocity: [%.12g m/s, %.12g m/s], spin: %.12g rad/s}",
                    listed++ > 0 ? ", " : " ", linkage->bodies[i].name, printed(motion->velocity.x),
                    printed(motion->velocity.y), printed(motion->omega));
    }
    if (left_out > 0) {
        text_append(words, ", and %zu more bodies", left_out);
    }
}

static bool refuse_speeds(const Entry *entry, const Linkage *linkage, int joint, double distance,
                          const Motion *motions, const Motion *nearest, Err *err)
{
    char reason[REASON_SIZE] = "a driven body does not turn as its drive does";
    if (joint >= 0) {
        snprintf(reason, sizeof reason,
                 "the speeds at the start pull the ideal joint '%s' apart by %.4g m/s",
                 linkage->joints[joint].name, distance);
    }
    Text words;
    text_init(&words);
    append_nearest(linkage, motions, nearest, &words);
    entries_refuse(entry, err,
                   "%s\nallowed: speeds that keep the joints closed, such as the nearest:%s",
                   reason, words.data);
    text_finish(&words);
    return false;
}

bool speeds_find(const Entries *entries, const Linkage *linkage, Motion *motions, Err *err)
{
    const Entry *given = entries_speed(entries, linkage->body_count);
    for (size_t i = 0; i < linkage_drive_count(linkage); i++) {
        turn_driven_body(entries, linkage, i, motions);
    }
    Motion *nearest = zeroed(linkage->body_count, sizeof *nearest);
    memcpy(nearest, motions, linkage->body_count * sizeof *motions);
    if (given == NULL && linkage->driver.is_present) {
        nearest_speeds(linkage, true, nearest);
    }
    nearest_speeds(linkage, false, nearest);
    nearest_speeds(linkage, false, nearest); // what rounding has left
    int joint;
    double distance;
    const bool is_right = given == NULL || nearest_check(linkage, motions, &joint, &distance);
    if (is_right) {
        memcpy(motions, nearest, linkage->body_count * sizeof *motions);
    } else {
        refuse_speeds(given, linkage, joint, distance, motions, nearest, err);
    }
    free(nearest);
    return is_right;
}
