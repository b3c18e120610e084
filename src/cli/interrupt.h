// Stopping in good order on Ctrl-C and on signals that end processes.
#pragma once

// From now on SIGINT, SIGTERM and SIGHUP are noted; a second one ends the program at once.
void interrupt_watch(void);

// The number of the signal that was noted; 0 where there was none.
int interrupt_number(void);

// Ends the program by the signal that was noted, so that its parent sees how it ended. Returns
// where there was none.
void interrupt_obey(void);
