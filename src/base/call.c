// Keeps which call a thread works for.
#include "base/call.h"

static _Thread_local Call *current;

const char CALL_CANCELLED[] = "it was cancelled";

Call *call_current(void)
{
    return current;
}

void call_set_current(Call *call)
{
    current = call;
}

bool call_is_cancelled(void)
{
    return current != NULL && atomic_load_explicit(&current->is_cancelled, memory_order_relaxed);
}
