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

void driver_refuse_friction(const DriverCase *of)
{
    for (size_t i = 0; i < of->joint_count; i++) {
        if (of->joints[i].law.friction > 0.0) {
            driver_refuse("friction in '%s', for a hole of the engine's own has none",
                          of->joints[i].name);
        }
    }
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
