// Finds what small changes of a settled motion become: in one period, or where that does not tell
// it in many.
#include "base/side_by_side.h"
#include "run/settle_parts.h"

void settle_growth(Scenario *scenario, RunWatch watch)
{
    TurnWatch all = turn_watch_begin(watch);
    MonodromyRuns *monodromy = monodromy_runs_begin(scenario, &all);
    if (monodromy != NULL) {
        const SideBySideTasks tasks = monodromy_runs_tasks(monodromy);
        side_by_side_tasks(&tasks, side_by_side_processors());
        if (monodromy_runs_end(monodromy, scenario)) {
            return;
        }
    }
    BesideRuns *beside = beside_runs_begin(scenario, &all);
    if (beside != NULL) {
        const SideBySideTasks tasks = beside_runs_tasks(beside);
        side_by_side_tasks(&tasks, side_by_side_processors());
        beside_runs_end(beside, scenario);
    }
}
