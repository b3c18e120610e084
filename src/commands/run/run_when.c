// When was something, in a table: by the crank's angle, or by the time where no drive turns a crank
// at constant speed.
#include "commands/run/run_report.h"
#include "write/units.h"

void run_when_head(Table *table, size_t column, const RunReport *report)
{
    const bool is_steady = drive_is_steady(&report->scenario->linkage.driver);
    table_head(table, column, is_steady ? "at crank" : "at time", is_steady ? "deg" : "ms",
               TABLE_RIGHT);
}

void run_when_cell(Table *table, const RunReport *report, double time_s, double crank_rad)
{
    if (drive_is_steady(&report->scenario->linkage.driver)) {
        table_cell(table, "%.1f", crank_rad * UNITS_DEG);
    } else {
        table_cell(table, "%.4f", time_s * UNITS_MS);
    }
}
