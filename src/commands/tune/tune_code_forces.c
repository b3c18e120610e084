// How are springs, dampers, a torque and limits of joints written as data of a C program?
#include "commands/tune/tune_code_forces.h"

#include "model/forces.h"
#include "write/number.h"

#include <math.h>

static void write_springs(const Linkage *linkage, Text *text)
{
    if (linkage->spring_count == 0) {
        return;
    }
    text_append(text, "    .linkage.spring_count = %zu,\n    .linkage.springs = (Spring[]){\n",
                linkage->spring_count);
    for (size_t i = 0; i < linkage->spring_count; i++) {
        const Spring *spring = &linkage->springs[i];
        text_append(text, "        {.body_a = %d, .body_b = %d,\n", spring->body_a, spring->body_b);
        text_append(text, "         .anchor_a = {%s, %s}", number_shortest(spring->anchor_a.x).text,
                    number_shortest(spring->anchor_a.y).text);
        text_append(text, ",\n         .anchor_b = {%s, %s}",
                    number_shortest(spring->anchor_b.x).text,
                    number_shortest(spring->anchor_b.y).text);
        text_append(text,
                    ",\n         .stiffness = %s, // N/m\n"
                    "         .length = %s, // m\n"
                    "         .damping = %s}, // N s/m\n",
                    number_shortest(spring->stiffness).text, number_shortest(spring->length).text,
                    number_shortest(spring->damping).text);
    }
    text_append(text, "    },\n");
}

static void write_torsions(const Linkage *linkage, Text *text)
{
    if (linkage->torsion_count == 0) {
        return;
    }
    text_append(text,
                "    .linkage.torsion_count = %zu,\n    .linkage.torsions = (TorsionSpring[]){\n",
                linkage->torsion_count);
    for (size_t i = 0; i < linkage->torsion_count; i++) {
        const TorsionSpring *spring = &linkage->torsions[i];
        text_append(text,
                    "        {.joint = %d,\n"
                    "         .stiffness = %s, // N m/rad\n"
                    "         .angle = %s, // rad\n"
                    "         .damping = %s}, // N m s/rad\n",
                    spring->joint, number_shortest(spring->stiffness).text,
                    number_shortest(spring->angle).text, number_shortest(spring->damping).text);
    }
    text_append(text, "    },\n");
}

void tune_code_table(const char *name, const TimeTable *table, const char *unit, Text *text)
{
    text_append(text, "    .%s.count = %zu,\n", name, table->count);
    for (size_t i = 0; i < table->count; i++) {
        text_append(text,
                    "    .%s.times[%zu] = %s, // s\n"
                    "    .%s.values[%zu] = %s, // %s\n",
                    name, i, number_shortest(table->times[i]).text, name, i,
                    number_shortest(table->values[i]).text, unit);
    }
}

static void write_torque(const Torque *torque, Text *text)
{
    text_append(text, "    .linkage.torque.joint = %d,\n", torque->joint);
    tune_code_table("linkage.torque.table", &torque->table, "N m", text);
}

void tune_code_forces(const Linkage *linkage, Text *text)
{
    if (forces_any(linkage)) {
        write_springs(linkage, text);
        write_torsions(linkage, text);
        write_torque(&linkage->torque, text);
    }
}

// One that may be infinite.
static void write_limit(const char *name, double value, Text *text)
{
    text_append(text, ", .%s = %s", name,
                isfinite(value) ? number_shortest(value).text
                : value < 0.0   ? "-INFINITY"
                                : "INFINITY");
}

void tune_code_limits(const Joint *joint, Text *text)
{
    const Limits *limits = &joint->limits;
    const Gear *gear = &joint->gear;
    if (limits->kind == LIMIT_NONE) {
        return;
    }
    // rad or m
    text_append(text, "         .limits = {.kind = %s",
                limits->kind == LIMIT_BACKLASH ? "LIMIT_BACKLASH" : "LIMIT_STOPS");
    write_limit("backlash", limits->backlash, text);
    write_limit("middle", limits->middle, text);
    write_limit("low", limits->low, text);
    write_limit("high", limits->high, text);
    text_append(text, "},\n");
    if (joint->kind == JOINT_GEAR) {
        text_append(text,
                    "         .gear = {.pivots = {%d, %d}, .carrier = %d,\n"
                    "                  .radius_a = %s, // m\n                  .radius_b = %s},\n",
                    gear->pivots[0], gear->pivots[1], gear->carrier,
                    number_shortest(gear->radius_a).text, number_shortest(gear->radius_b).text);
    }
}
