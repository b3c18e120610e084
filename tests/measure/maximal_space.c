// The equations in space are not written yet: a case in space is counted as not judged.
#include "maximal.h"

Maximal *maximal_space_create(const Scenario *scenario, const MaximalFlaw *flaw, Err *err)
{
    (void)scenario;
    (void)flaw;
    err_set(err, ERR_CASE, "there are no equations in maximal coordinates in space");
    return NULL;
}
