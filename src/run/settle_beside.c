// Finds what lies beside a settled motion: other damping, and what small changes become.
#include "base/side_by_side.h"
#include "run/settle_parts.h"

// The runs of both, or of one alone. Growth is first looked for in one period; where that does not
// tell it, in many.
static void find_beside(Scenario *scenario, bool is_damping, bool is_growth, RunWatch watch)
{
    TurnWatch all = turn_watch_begin(watch);
    DampingRuns *damping = is_damping ? damping_runs_begin(scenario, &all) : NULL;
    MonodromyRuns *monodromy = is_growth ? monodromy_runs_begin(scenario, &all) : NULL;
    BesideRuns *beside = is_growth && monodromy == NULL ? beside_runs_begin(scenario, &all) : NULL;
    SideBySideTasks tasks[2];
    size_t count = 0;
    if (damping != NULL) {
        tasks[count++] = damping_runs_tasks(damping);
    }
    if (monodromy != NULL) {
        tasks[count++] = monodromy_runs_tasks(monodromy);
    }
    if (beside != NULL) {
        tasks[count++] = beside_runs_tasks(beside);
    }
    side_by_side_lists(tasks, count, side_by_side_processors());
    if (damping != NULL) {
        damping_runs_end(damping, scenario);
    }
    if (monodromy != NULL && !monodromy_runs_end(monodromy, scenario)) {
        beside = beside_runs_begin(scenario, &all);
        tasks[0] = beside_runs_tasks(beside);
        side_by_side_lists(tasks, 1, side_by_side_processors());
    }
    if (beside != NULL) {
        beside_runs_end(beside, scenario);
    }
}

void settle_damping(Scenario *scenario, RunWatch watch)
{
    find_beside(scenario, true, false, watch);
}

void settle_growth(Scenario *scenario, RunWatch watch)
{
    find_beside(scenario, false, true, watch);
}

void settle_beside(Scenario *scenario, RunWatch watch)
{
    find_beside(scenario, true, true, watch);
}
