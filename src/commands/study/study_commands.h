// The commands behind `jointplay study`, each listed by its first word.
#pragma once

#include "cli/command.h"

extern const Command study_command_status;
extern const Command study_command_export;
extern const Command study_command_merge;
extern const Command study_command_plot;
extern const Command study_command_slurm;
