// Ends a driver with an answer, and has what all files of drivers need: room, ways, points of
// bodies.
#include "drivers/common/driver.h"

#include <jansson.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

// Where answers go: the program's standard output, which engines are kept from, for some greet.

static FILE *answers;

FILE *driver_open_answers(void)
{
    const int channel = dup(STDOUT_FILENO);
    answers = channel >= 0 ? fdopen(channel, "w") : NULL;
    if (answers == NULL || dup2(STDERR_FILENO, STDOUT_FILENO) < 0) {
        _Exit(1);
    }
    return answers;
}

// Answers that end everything.

static _Noreturn void end_with(const char *key, const char *format, va_list arguments)
{
    char words[512];
    vsnprintf(words, sizeof words, format, arguments);
    json_t *line = json_pack("{s:s%}", key, words, strlen(words));
    char *text = line != NULL ? json_dumps(line, JSON_COMPACT) : NULL;
    if (text != NULL) {
        fprintf(answers, "%s\n", text);
    } else {
        fprintf(answers, "{\"%s\": \"for a reason that is no text\"}\n", key);
    }
    fflush(answers);
    _Exit(0);
}

void driver_fail(const char *format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    end_with("failed", format, arguments);
}

void driver_refuse(const char *format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    end_with("refused", format, arguments);
}

void driver_answer(const json_t *line)
{
    json_dumpf(line, answers, JSON_COMPACT | JSON_REAL_PRECISION(17));
    fputc('\n', answers);
    fflush(answers);
}

void *driver_room(size_t count, size_t size)
{
    void *room = calloc(count + 1, size);
    if (room == NULL) {
        driver_fail("there is no memory");
    }
    return room;
}

bool driver_is_way(const DriverCase *of, const char *way)
{
    return strcmp(of->way, way) == 0;
}

// Drives.

static size_t prescribed_count(const DriverCase *of)
{
    return driver_is_way(of, "kernel") ? 0 : of->drive_count;
}

const DriverDrive *driver_drive_of(const DriverCase *of, int body)
{
    if (of->has_drive && of->driven_body == body) {
        return &of->steady;
    }
    for (size_t i = 0; i < prescribed_count(of); i++) {
        if (of->drives[i].body == body) {
            return &of->drives[i];
        }
    }
    return NULL;
}

const DriverDrive *driver_drive_at_joint(const DriverCase *of, size_t joint)
{
    if (of->has_drive && of->drive_joint == (int)joint) {
        return &of->steady;
    }
    for (size_t i = 0; i < prescribed_count(of); i++) {
        if (of->drives[i].joint == (int)joint) {
            return &of->drives[i];
        }
    }
    return NULL;
}

double driver_drive_mean(const DriverDrive *drive, double from_s, double to_s)
{
    if (drive_is_steady(&drive->law)) {
        return drive->law.speed;
    }
    // exact: angles of many turns have few digits left for a step
    return (double)(drive_angle_exact(&drive->law, to_s) - drive_angle_exact(&drive->law, from_s)) /
           (to_s - from_s);
}

Vec2 driver_drive_pivot(const DriverCase *of, const DriverDrive *drive, Vec2 *on_body)
{
    const DriverJoint *joint = &of->joints[drive->joint];
    const int own = joint->bodies[1] == drive->body ? 1 : 0;
    if (joint->bodies[1 - own] != DRIVER_GROUND || joint->kind != DRIVER_REVOLUTE) {
        driver_refuse("a drive that does not turn a body about the ground");
    }
    *on_body = joint->anchors[own];
    return joint->anchors[1 - own];
}

// Points of bodies.

Vec2 driver_point(const DriverMotion *motions, int body, Vec2 local)
{
    return body == DRIVER_GROUND
               ? local
               : vec2_add(motions[body].position, vec2_rotate(motions[body].angle, local));
}

Vec2 driver_point_velocity(const DriverMotion *motions, int body, Vec2 local)
{
    if (body == DRIVER_GROUND) {
        return (Vec2){0.0, 0.0};
    }
    const Vec2 arm = vec2_rotate(motions[body].angle, local);
    return vec2_add(motions[body].velocity, vec2_scale(motions[body].omega, vec2_perp(arm)));
}
