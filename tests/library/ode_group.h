// ODE for a group of tests.
#pragma once

#include <ode/ode.h>

static inline int ode_group_setup(void **state)
{
    (void)state;
    return dInitODE2(0) ? 0 : 1;
}

static inline int ode_group_teardown(void **state)
{
    (void)state;
    dCloseODE();
    return 0;
}
