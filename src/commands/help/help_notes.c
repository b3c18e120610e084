// What the manual says of commands and options beside their tables: what is too long for --help.
//
// The program's own page is not printed while a line is of a command or option that does not exist.
#include "commands/help/help.h"

#include <string.h>

typedef struct HelpNote {
    const char *command; // NULL: any command that has the option
    const char *option;  // NULL: the command itself
    const char *words;
} HelpNote;

static const HelpNote HELP_NOTES[] = {
    {"new", NULL, "Nothing is ever asked. A file that is there stays as it is."},
    {"run", NULL,
     "All cases are read before the first one runs. A run longer than two seconds shows its "
     "progress on standard error: on a terminal one line, which disappears at the end; elsewhere a "
     "plain line every ten seconds. If a run takes more than a minute, or with -q more than 20 s, "
     "an estimate of its time is printed before it begins, if one can be made."},
    {"run", "backend", "May be given more than once."},
    {"run", "step",
     "Or auto: chosen by trial runs so that the error is at most run.tolerance (of the motion, or "
     "of what run.tolerance-of says), with at most run.most-steps world steps."},
    {"run", "uncertified",
     "The tighter and the perturbed runs that certify the reference are left out, and the output "
     "says so. Not with a step of ODE that is chosen: that needs a certified reference."},
    {"run", "json", "With several cases it is {\"cases\": [...]}, with one object a case."},
    {"run", "columns",
     "In the order of the series. In a name * stands for any letters and ? for one."},
    {"run", "contacts",
     "A row has joint, onset, duration, largest force, impulse, approach speed, depth, and where "
     "on the wall of its hole a pin was."},
    {"report", NULL,
     "The page has the first screen of 'jointplay run', the mechanism moving with its play "
     "magnified, plots that can be zoomed, the spikes, what was assumed, all settings, and the "
     "data."},
    {"report", "out", "A file there that is no page of report is not replaced."},
    {"compare", NULL,
     "Prints error and time of each run, the frontier (the points that no other point beats in "
     "both), the observed order, and the cheapest setting for an error. Runs are separate "
     "processes; a point that fails is shown as failed. A comparison that was stopped resumes."},
    {"compare", "steps",
     "The usual steps are 30 to 0.1 us for a run of 60 ms, ten times longer for one of 0.6 s. "
     "What those that are left out would take is said."},
    {"compare", "time-limit",
     "An ensemble may use it for each of its members, and the reference for each of its runs."},
    {"compare", "store", "A store of another comparison is refused."},
    {"map", NULL,
     "For each joint with play, map and step: ERP and CFM; restitution, peak force, depth and "
     "duration of an impact as predicted and as measured in ODE; the verdict with advice; and the "
     "longest valid step."},
    {"map", "erp", "The CFM is in m/(N s). With --mass, or for the masses of a case's joints."},
    {"map", "mass",
     "The median is over the case's run and all directions. Where all that touches are limits of "
     "pivots it is an inertia such as '100 kg mm^2'."},
    {"map", "speed", "At limits of pivots it is such as '1 rad/s'."},
    {"check", NULL,
     "Peaks, spikes, impulses, errors, energy and cost are each in a band with a reason. A folder "
     "stands for all cases in it. The baseline of cases/a.yaml is DIR/a.json. Under expect: a case "
     "can also say how its runs end: 'agrees within' an error, 'detected as' or 'refused with' a "
     "message."},
    {"check", "bless",
     "For the cases named or for all that have a baseline. A case with a run that fails keeps its "
     "old one. If stopped, the same command resumes."},
    {"check", "expect-only",
     "Without it a case is judged by both, and only by its limits if it has no baseline."},
    {"check", "set", "A setting that differs from the baseline's counts as a difference."},
    {"check", "shake", "Hashes are not checked then."},
    {"check", "junit", "One suite per case."},
    {"tune", NULL,
     "Prints the setting as numbers, as ODE C code, and, as far as they can represent it, for "
     "Gazebo and MuJoCo, with all settings that were tried."},
    {"tune", "error",
     "Of any body's angular velocity or velocity, and of any pin's in its hole, each relative to "
     "its own largest value, such as 1e-3."},
    {"tune", "max-cost",
     "If nothing meets the error within it, the smallest error within it and the cheapest setting "
     "that meets the error are printed, and the exit status is 1."},
    {"tune", "at-step",
     "Every scheme is run at it and the one with the smallest error is named, together with the "
     "best kp and kd, and ERP and CFM, for the whole mechanism. If --error is given and nothing at "
     "the step meets it, the longest step that does is searched, and the exit status is 1."},
    {"tune", "code",
     "Its numbers are those of the library, not of run: it is run before it is written, its step "
     "shortened until its own error is within --error. Blocks between guides, discs at walls, "
     "gears, polygons in place of round holes, extrapolated steps and cases in space are refused "
     "before the search."},
    {"tune", "sdf", "What the case has no such form of is refused before the search."},
    {"tune", "mjcf", "What the case has no such form of is refused before the search."},
    {"tune", "out", "Those that do not apply to the case are named in a warning."},
    {"study", NULL,
     "It prints how the runs ended and how each result is distributed. A run that fails, hangs, "
     "dies or needs too much memory is a row with its reason, and the others continue. The exit "
     "status is 0 when all runs have ended, even if some failed, and 4 if every one did."},
    {"study", "store",
     "Of a shard <study>.I-of-N.sqlite. A store of another study, case or program "
     "is refused."},
    {"study", "dry-run",
     "How many runs there would be, the first of them, whether they make valid cases, and how "
     "large the store would become."},
    {"study slurm", "shards", "Slurm takes 1000 unless its MaxArraySize is raised."},
    {"study slurm", "time",
     "The minimum is five minutes, because a task is signalled to end a minute or two before its "
     "limit."},
    {NULL, "set",
     "A setting that the case does not use, and a key of the file, are named on standard error "
     "with what would use them. Keys of the file are left out beside which the command line chose "
     "otherwise."},
    {NULL, "wide",
     "Otherwise a table that is wider than the terminal, or than 80 columns without one, omits its "
     "least important columns and names them."},
};

static bool is_of(const HelpNote *note, const char *command, const char *option)
{
    if (note->command != NULL && strcmp(note->command, command) != 0) {
        return false;
    }
    return option == NULL ? note->option == NULL
                          : note->option != NULL && strcmp(note->option, option) == 0;
}

const char *help_notes_find(const char *command, const char *option)
{
    for (size_t i = 0; i < sizeof HELP_NOTES / sizeof *HELP_NOTES; i++) {
        if (is_of(&HELP_NOTES[i], command, option)) {
            return HELP_NOTES[i].words;
        }
    }
    return NULL;
}

// A note that no command or option has had yet.
typedef struct Search {
    const HelpNote *note;
    bool is_found;
} Search;

static void look(const Command *command, const char *name, void *target)
{
    Search *search = target;
    const HelpNote *note = search->note;
    if (note->command != NULL && strcmp(note->command, name) != 0) {
        return;
    }
    search->is_found = search->is_found || note->option == NULL;
    for (size_t i = 0; note->option != NULL && i < command->arguments->option_count; i++) {
        search->is_found =
            search->is_found || strcmp(command->arguments->options[i].name, note->option) == 0;
    }
}

bool help_notes_are_of_options(void)
{
    for (size_t i = 0; i < sizeof HELP_NOTES / sizeof *HELP_NOTES; i++) {
        Search search = {.note = &HELP_NOTES[i]};
        help_visit(look, &search);
        if (!search.is_found) {
            return false;
        }
    }
    return true;
}
