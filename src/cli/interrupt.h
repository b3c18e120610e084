// Being told to stop, by Ctrl-C or whoever ends processes, and doing so in good order.
#pragma once

// From now on SIGINT, SIGTERM and SIGHUP are noted; a second one ends the program at once.
void interrupt_watch(void);

// The number of the signal that was noted; 0 where there was none.
int interrupt_number(void);

// Ends the program by the signal that was noted, once all is in order, so that whoever started it
// sees that it was stopped. Returns where there was none.
void interrupt_obey(void);
