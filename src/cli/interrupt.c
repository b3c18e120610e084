// Notes that the program was asked to stop.
#include "cli/interrupt.h"

#include <signal.h>
#include <stddef.h>

static const int SIGNALS[] = {SIGINT, SIGTERM, SIGHUP};
enum { SIGNAL_COUNT = sizeof SIGNALS / sizeof *SIGNALS };

// a signal handler receives nothing but the number
static volatile sig_atomic_t noted = 0;

static void note(int number)
{
    noted = number;
}

void interrupt_watch(void)
{
    struct sigaction action = {.sa_handler = note, .sa_flags = (int)SA_RESETHAND};
    sigemptyset(&action.sa_mask);
    for (int i = 0; i < SIGNAL_COUNT; i++) {
        struct sigaction known;
        // a signal that was ignored from the start, as by nohup, stays ignored
        if (sigaction(SIGNALS[i], NULL, &known) == 0 && known.sa_handler != SIG_IGN) {
            sigaction(SIGNALS[i], &action, NULL);
        }
    }
}

int interrupt_number(void)
{
    return noted;
}

void interrupt_obey(void)
{
    if (noted != 0) {
        signal(noted, SIG_DFL);
        raise(noted);
    }
}
