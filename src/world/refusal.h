// Errors as values: one sentence for whoever called.
#pragma once

#include <jointplay/jointplay.h>

// Fills in the error, which may be NULL, and returns the status.
JpStatus refusal(JpError *error, JpStatus status, const char *format, ...)
    __attribute__((format(printf, 3, 4)));

// The return of a call that went well.
JpStatus refusal_none(JpError *error);

// Fail with JP_ERROR_ARGUMENT and the number's name where it is no finite number, is not above 0,
// or is below 0.
JpStatus refusal_of_finite(double value, const char *name, JpError *error);
JpStatus refusal_of_positive(double value, const char *name, JpError *error);
JpStatus refusal_of_negative(double value, const char *name, JpError *error);

// Fails with JP_ERROR_NONE where what was found is no finite number.
JpStatus refusal_of_result(double value, const char *name, JpError *error);

// Fails where a pointer is NULL.
JpStatus refusal_of_null(const void *pointer, const char *name, JpError *error);

// Leaves the function with a call's status where that is an error.
#define REFUSAL_TRY(call)                                                                          \
    do {                                                                                           \
        const JpStatus refusal_status = (call);                                                    \
        if (refusal_status != JP_OK) {                                                             \
            return refusal_status;                                                                 \
        }                                                                                          \
    } while (0)
