// What goes into the near callback and the loop of someone who steps ODE plainly.
#pragma once

#include "base/text.h"
#include "commands/tune/tune_report.h"

// Appends C lines for the plain setting of a trial: the surface of a contact of each joint with
// play, worked out anew at each step, and the loop. Returns false, with nothing appended, where the
// law does not fit a joint.
bool tune_snippet_write(const TuneReport *report, const TuneTrial *trial, Text *text);
