// Which library is this?
#include "version.h"

#include <jointplay/jointplay.h>

const char *jp_version(void)
{
    return JOINTPLAY_VERSION;
}
