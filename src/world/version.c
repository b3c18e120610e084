// Says which library this is.
#include "version.h"

#include <jointplay/jointplay.h>

const char *jp_version(void)
{
    return JOINTPLAY_VERSION;
}
