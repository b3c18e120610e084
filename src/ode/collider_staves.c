// Where does a pin touch a ring of staves, by libccd's Minkowski portal refinement?
#include "contact/facets.h"
#include "ode/staves.h"

const Collider collider_staves = {
    .check = facets_check,
    .open = staves_open,
    .find = staves_find_mpr,
    .close = staves_close,
};
