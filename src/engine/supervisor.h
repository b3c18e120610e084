// Starts another program so that nothing of it outlives the conversation with it.
//
// A process of our own stands between: the supervisor. All that the program starts, in however many
// forks and sessions, becomes the supervisor's child once its own parent has gone. The supervisor
// kills all of them when the program ends, when it is asked to, or when the caller dies, however
// that happens.
#pragma once

#include <sys/types.h>

// Starts a program, run without a shell and without arguments, whose standard input, output and
// error are the given descriptors, which stay the caller's. Returns the supervisor, a child of the
// caller to be waited for: it ends as the program does, by the same exit status or signal, and with
// status 127 where the program cannot be run. -1, with errno, where the system has no process left.
// The calling thread must outlive the supervisor.
pid_t supervisor_start(const char *program, const int ends[3]);

// Ends the program and all that it has started, and waits for it: a supervisor that was not waited
// for yet.
void supervisor_end(pid_t supervisor);
