// What pushes a mechanism beside its joints: springs, dampers, and a torque or force over time?
#include "commands/run/run_report.h"
#include "write/alike.h"
#include "write/units.h"

#include <math.h>

static void append_damping(Text *said, double damping, const char *unit)
{
    if (damping > 0.0) {
        text_append(said, "%sdamping %.4g %s", said->length > 0 ? ", " : "", damping, unit);
    } else if (said->length == 0) {
        text_append(said, "neither stiffness nor damping");
    }
}

static void write_springs(const Linkage *linkage, size_t width, Text *text)
{
    Alike *alike = alike_start();
    for (size_t i = 0; i < linkage->spring_count; i++) {
        const Spring *spring = &linkage->springs[i];
        Text said;
        text_init(&said);
        if (spring->stiffness > 0.0) {
            text_append(&said, "%.4g N/m, relaxed at %.6g mm", spring->stiffness,
                        spring->length * UNITS_MM);
        }
        append_damping(&said, spring->damping, "N s/m");
        alike_add(alike, spring->name, said.data);
        text_finish(&said);
    }
    for (size_t i = 0; i < linkage->torsion_count; i++) {
        const TorsionSpring *spring = &linkage->torsions[i];
        Text said;
        text_init(&said);
        if (spring->stiffness > 0.0) {
            text_append(&said, "%.4g N m/rad, relaxed at %.6g deg", spring->stiffness,
                        spring->angle * UNITS_DEG);
        }
        append_damping(&said, spring->damping, "N m s/rad");
        text_append(&said, " at %s", linkage->joints[spring->joint].name);
        alike_add(alike, spring->name, said.data);
        text_finish(&said);
    }
    alike_end(alike, "  springs     ", ": ", width, text);
}

static void write_torque(const Linkage *linkage, Text *text)
{
    const TimeTable *table = &linkage->torque.table;
    if (table->count == 0) {
        return;
    }
    const Joint *joint = &linkage->joints[linkage->torque.joint];
    const bool is_force = joint->kind == JOINT_PRISMATIC;
    const char *unit = is_force ? "N" : "N m";
    double low = table->values[0];
    double high = low;
    for (size_t i = 1; i < table->count; i++) {
        low = fmin(low, table->values[i]);
        high = fmax(high, table->values[i]);
    }
    text_append(text, "  drive       %s ", is_force ? "force" : "torque");
    if (low == high) {
        text_append(text, "%.6g %s", low, unit);
    } else {
        text_append(text, "%.6g to %.6g %s by %zu points over time", low, high, unit, table->count);
    }
    text_append(text, " at %s\n", joint->name);
}

void run_loads_write(const RunReport *report, size_t width, Text *text)
{
    const Linkage *linkage = &report->scenario->linkage;
    write_springs(linkage, width, text);
    write_torque(linkage, text);
}
