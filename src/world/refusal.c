// Tells a caller of the library what was wrong with a call.
#include "world/refusal.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>

JpStatus refusal(JpError *error, JpStatus status, const char *format, ...)
{
    if (error != NULL) {
        va_list arguments;
        va_start(arguments, format);
        error->status = status;
        vsnprintf(error->text, sizeof error->text, format, arguments);
        va_end(arguments);
    }
    return status;
}

JpStatus refusal_none(JpError *error)
{
    if (error != NULL) {
        *error = (JpError){.status = JP_OK};
    }
    return JP_OK;
}

JpStatus refusal_of_finite(double value, const char *name, JpError *error)
{
    return isfinite(value) ? JP_OK
                           : refusal(error, JP_ERROR_ARGUMENT,
                                     "%s is %g, which is no finite number", name, value);
}

JpStatus refusal_of_positive(double value, const char *name, JpError *error)
{
    REFUSAL_TRY(refusal_of_finite(value, name, error));
    return value > 0.0
               ? JP_OK
               : refusal(error, JP_ERROR_ARGUMENT, "%s is %g; it must be above 0", name, value);
}

JpStatus refusal_of_negative(double value, const char *name, JpError *error)
{
    REFUSAL_TRY(refusal_of_finite(value, name, error));
    return value >= 0.0
               ? JP_OK
               : refusal(error, JP_ERROR_ARGUMENT, "%s is %g; it must not be below 0", name, value);
}

JpStatus refusal_of_result(double value, const char *name, JpError *error)
{
    return isfinite(value) ? JP_OK
                           : refusal(error, JP_ERROR_NONE,
                                     "%s is out of a double's range; are all numbers in the same "
                                     "units, such as m, kg and s?",
                                     name);
}

JpStatus refusal_of_null(const void *pointer, const char *name, JpError *error)
{
    return pointer != NULL ? JP_OK : refusal(error, JP_ERROR_ARGUMENT, "%s is NULL", name);
}
