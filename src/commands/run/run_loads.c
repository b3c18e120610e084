// Writes what pushes a mechanism beside its joints: springs, bushings, dampers, loads, a torque or
// force over time.
#include "commands/run/run_loads.h"

#include "model/loads.h"
#include "model/ranges.h"
#include "write/alike.h"
#include "write/units.h"

static void append_damping(Text *said, double damping, const char *unit)
{
    if (damping > 0.0) {
        text_append(said, "%sdamping %.4g %s", said->length > 0 ? ", " : "", damping, unit);
    } else if (said->length == 0) {
        text_append(said, "neither stiffness nor damping");
    }
}

static void run_text_write_springs(const Linkage *linkage, size_t width, Text *text)
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

// One number where both axes have it, else both.
static void append_pair(Text *said, Vec2 pair, const char *unit)
{
    text_append(said, pair.x == pair.y ? "%.4g %s" : "%.4g", pair.x, unit);
    if (pair.x != pair.y) {
        text_append(said, " and %.4g %s", pair.y, unit);
    }
}

static void say_bushing(const Bushing *bushing, Text *said)
{
    Text damping;
    text_init(&damping);
    const size_t points = bushing->force_x.count + bushing->force_y.count;
    if (points > 0) {
        text_append(said, "force by %zu points", points);
    } else if (bushing->stiffness.x > 0.0 || bushing->stiffness.y > 0.0) {
        append_pair(said, bushing->stiffness, "N/m");
    }
    const char *comma = said->length > 0 ? ", " : "";
    if (bushing->torque.count > 0) {
        text_append(said, "%storque by %zu points", comma, bushing->torque.count);
    } else if (bushing->torsional_stiffness > 0.0) {
        text_append(said, "%s%.4g N m/rad", comma, bushing->torsional_stiffness);
    }
    if (bushing->damping.x > 0.0 || bushing->damping.y > 0.0) {
        append_pair(&damping, bushing->damping, "N s/m");
    }
    if (bushing->torsional_damping > 0.0) {
        text_append(&damping, "%s%.4g N m s/rad", damping.length > 0 ? ", " : "",
                    bushing->torsional_damping);
    }
    if (damping.length > 0) {
        text_append(said, "%sdamping %s", said->length > 0 ? "; " : "", damping.data);
    }
    text_finish(&damping);
}

static void write_bushings(const Linkage *linkage, size_t width, Text *text)
{
    Alike *alike = alike_start();
    for (size_t i = 0; i < linkage->bushing_count; i++) {
        const Bushing *bushing = &linkage->bushings[i];
        Text said;
        text_init(&said);
        say_bushing(bushing, &said);
        text_append(&said, " between %s and %s", linkage_body_name(linkage, bushing->body_a),
                    linkage_body_name(linkage, bushing->body_b));
        alike_add(alike, bushing->name, said.data);
        text_finish(&said);
    }
    alike_end(alike, "  bushings    ", ": ", width, text);
}

void run_loads_write_wave(double mean, const Wave *wave, double scale, const char *unit, Text *text)
{
    text_append(text, "%.6g %s +- %.6g %s at %.6g Hz", scale * mean, unit, scale * wave->amplitude,
                unit, wave->rate / (2.0 * M_PI));
}

// What a soft drive follows.
static void write_followed(const Driver *driver, Text *text)
{
    const TimeTable *table = &driver->table;
    if (drive_is_held(driver)) {
        text_append(text, "holds %.6g deg", (driver->start + table->values[0]) * UNITS_DEG);
    } else if (table->count > 0 && wave_exists(&table->wave)) {
        text_append(text, "follows ");
        run_loads_write_wave(table->values[0], &table->wave,
                             driver->has_angles ? UNITS_DEG : UNITS_RPM,
                             driver->has_angles ? "deg" : "rpm", text);
    } else {
        text_append(text, "follows %.6g rpm", driver->speed * UNITS_RPM);
    }
}

// A motor, or a drive that follows its speed softly; false where the torque is neither.
static bool write_motor(const Linkage *linkage, Text *text)
{
    const Torque *torque = &linkage->torque;
    const char *name = linkage->joints[torque->joint].name;
    if (torque->no_load != 0.0) {
        text_append(text, "  drive       motor at %s, %.6g N m at rest, none at %.6g rpm\n", name,
                    torque->table.values[0], torque->no_load * UNITS_RPM);
    } else if (torque->followed.is_present) {
        text_append(text, "  drive       ");
        write_followed(&torque->followed, text);
        text_append(text, " at %s by %.4g N m/rad and %.4g N m s/rad", name, torque->stiffness,
                    torque->slope);
        if (torque->limit > 0.0) {
            text_append(text, ", at most %.4g N m", torque->limit);
        }
        text_append(text, "\n");
    } else {
        return false;
    }
    return true;
}

// From the smallest to the largest of some numbers.
static Range range_of(const double *values, size_t count)
{
    Range range = RANGE_EMPTY;
    for (size_t i = 0; i < count; i++) {
        range_add(&range, values[i]);
    }
    return range;
}

static void run_text_write_torque(const Linkage *linkage, Text *text)
{
    const TimeTable *table = &linkage->torque.table;
    if (table->count == 0 || write_motor(linkage, text)) {
        return;
    }
    const Joint *joint = &linkage->joints[linkage->torque.joint];
    const bool is_force = joint_has_position(joint->kind);
    const char *unit = is_force ? "N" : "N m";
    const Range values = range_of(table->values, table->count);
    text_append(text, "  drive       %s ", is_force ? "force" : "torque");
    if (wave_exists(&table->wave)) {
        run_loads_write_wave(table->values[0], &table->wave, 1.0, unit, text);
    } else if (values.least == values.most) {
        text_append(text, "%.6g %s", values.least, unit);
    } else {
        text_append(text, "%.6g to %.6g %s by %zu points over time", values.least, values.most,
                    unit, table->count);
    }
    text_append(text, " at %s\n", joint->name);
}

static void write_loads(const Linkage *linkage, size_t width, Text *text)
{
    static const char *const OVERS[] = {"time", "the crank's angle", "its position"};
    Alike *alike = alike_start();
    for (size_t i = 0; i < linkage->load_count; i++) {
        const Load *load = &linkage->loads[i];
        const LoadTable *table = &load->table;
        const char *unit = load_is_force(linkage, load) ? "N" : "N m";
        const Range values = range_of(table->values, table->count);
        Text said;
        text_init(&said);
        if (wave_exists(&table->wave)) {
            run_loads_write_wave(table->values[0], &table->wave, 1.0, unit, &said);
        } else {
            text_append(&said, "%.6g", values.least);
        }
        if (table->count > 1) {
            text_append(&said, " to %.6g %s by %zu points over %s", values.most, unit, table->count,
                        OVERS[load->over]);
        } else if (!wave_exists(&table->wave)) {
            text_append(&said, " %s", unit);
        }
        text_append(&said, load->kind == LOAD_ALONG ? " along %s" : " on %s",
                    load->kind == LOAD_ALONG ? linkage->joints[load->joint].name
                                             : linkage->bodies[load->body].name);
        alike_add(alike, load->name, said.data);
        text_finish(&said);
    }
    alike_end(alike, "  loads       ", ": ", width, text);
}

void run_loads_write(const Linkage *linkage, size_t width, Text *text)
{
    run_text_write_springs(linkage, width, text);
    write_bushings(linkage, width, text);
    run_text_write_torque(linkage, text);
    write_loads(linkage, width, text);
}
