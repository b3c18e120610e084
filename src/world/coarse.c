// Keeps why a step is too long for what happens in it, from where that is found to the step's end.
#include "world/coarse.h"

#include <stdarg.h>
#include <stdio.h>

void coarse_begin(JpWorld *world)
{
    world->work = 0.0;
    refusal_none(&world->coarse);
}

void coarse_note(JpWorld *world, const char *format, ...)
{
    if (world->coarse.status == JP_COARSE) {
        return;
    }
    va_list arguments;
    va_start(arguments, format);
    world->coarse.status = JP_COARSE;
    vsnprintf(world->coarse.text, sizeof world->coarse.text, format, arguments);
    va_end(arguments);
}

JpStatus coarse_end(JpWorld *world, JpError *error)
{
    if (error != NULL) {
        *error = world->coarse;
    }
    world->stats.coarse += world->coarse.status == JP_COARSE ? 1 : 0;
    return world->coarse.status;
}
