// Where does a pin touch a ring of staves, by libccd's GJK and expanding polytopes?
#include "contact/facets.h"
#include "ode/staves.h"

const Collider collider_staves_gjk = {
    .check = facets_check,
    .open = staves_open,
    .find = staves_find_gjk,
    .close = staves_close,
};
