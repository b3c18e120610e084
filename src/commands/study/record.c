// How are the fates of a run called?
#include "commands/study/record.h"

const char *const FATE_WORDS[FATE_COUNT] = {
    [FATE_OK] = "ok",       [FATE_REFUSED] = "refused",     [FATE_FAILED] = "failed",
    [FATE_ENDED] = "ended", [FATE_TIMED_OUT] = "timed out", [FATE_NO_MEMORY] = "no memory",
};
