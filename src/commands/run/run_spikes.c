// Writes the spikes of accelerations and forces, as tables and as JSON.
#include "commands/run/run_report.h"
#include "write/json_value.h"
#include "write/units.h"

#include <math.h>
#include <stdio.h>

// Spikes in the bands of the crank's angle where the paper saw its own.

static const double SECTOR_DEG = 360.0 / SIGNAL_SECTOR_COUNT;

const size_t SPIKE_BANDS[SPIKE_BAND_COUNT] = {12, 29};

// The paper's mechanism, m: Tables VI and IV.
static const double PAPER_GROUND = 0.254;
static const double PAPER_CRANK = 0.108;
static const double PAPER_COUPLER = 0.2794;
static const double PAPER_FOLLOWER = 0.2705;
static const double PAPER_CLEARANCE = 14.5e-6;
static const double LENGTH_ROUNDING =
    1e-6;                 // relative: above rounding, below any tolerance of a length
enum { PAPER_JOINT = 1 }; // crank-coupler

static bool is_inside(size_t sector)
{
    for (size_t i = 0; i < SPIKE_BAND_COUNT; i++) {
        if (SPIKE_BANDS[i] == sector) {
            return true;
        }
    }
    return false;
}

static SpikeBandSums spike_bands_sums(const SignalSpikes *spikes)
{
    SpikeBandSums sums = {0};
    for (size_t i = 0; i < SIGNAL_SECTOR_COUNT; i++) {
        SignalSector *sum = is_inside(i) ? &sums.inside : &sums.outside;
        sum->count += spikes->sectors[i].count;
        sum->largest = fmax(sum->largest, spikes->sectors[i].largest);
    }
    return sums;
}

static bool run_spikes_is_near(double value, double wanted)
{
    return fabs(value - wanted) <= LENGTH_ROUNDING * wanted;
}

// Whether the only play is that of Table IV in the joint between crank and coupler.
static bool has_papers_play(const Linkage *linkage)
{
    bool is_so = false;
    for (size_t i = 0; i < linkage->joint_count; i++) {
        const Joint *joint = &linkage->joints[i];
        if (linkage_has_play(joint)) {
            is_so = i == PAPER_JOINT &&
                    run_spikes_is_near(linkage_radial_clearance(joint), PAPER_CLEARANCE);
            if (!is_so) {
                break;
            }
        }
    }
    return is_so;
}

// Whether the bands mean anything: in the paper's four-bar with the paper's play, and in no other.
static bool spike_bands_apply(const RunReport *report)
{
    const FourBar *fourbar = &report->scenario->fourbar;
    return report->scenario->has_fourbar &&
           run_spikes_is_near(fourbar->ground.nominal, PAPER_GROUND) &&
           run_spikes_is_near(fourbar->crank.nominal, PAPER_CRANK) &&
           run_spikes_is_near(fourbar->coupler.nominal, PAPER_COUPLER) &&
           run_spikes_is_near(fourbar->follower.nominal, PAPER_FOLLOWER) &&
           has_papers_play(&report->scenario->linkage);
}

static double spike_bands_first_deg(size_t band)
{
    return SECTOR_DEG * (double)SPIKE_BANDS[band];
}

// The two ends of a band, degrees.
static double spike_bands_last_deg(size_t band)
{
    return SECTOR_DEG * (double)(SPIKE_BANDS[band] + 1);
}

// Tables of the spikes.

static bool run_spikes_has_joint(const RunReport *report, const Trajectory *run, size_t joint)
{
    return run->is_complete && run->force_spikes[joint].is_known &&
           linkage_has_play(&report->scenario->linkage.joints[joint]);
}

static bool looked_for_any(const RunReport *report, const Trajectory *run)
{
    for (size_t i = 0; i < report->scenario->linkage.body_count; i++) {
        if (run_report_has_body_spikes(report, run, i)) {
            return true;
        }
    }
    return false;
}

static void run_spikes_count_row(Table *table, const RunReport *report, const Trajectory *run,
                                 const char *quantity, const char *name, const char *unit,
                                 const SignalSpikes *spikes)
{
    table_cell(table, "%s %s", quantity, name);
    table_cell(table, "%s", unit);
    table_cell(table, "%s", run->backend);
    section_number(table, spikes->threshold);
    table_cell(table, "%zu", spikes->count);
    section_number_or_dash(table, spikes->kept > 0, spikes->spikes[0].value);
    if (spikes->kept > 0) {
        run_when_cell(table, report, spikes->spikes[0].time_s, spikes->spikes[0].crank_rad);
    } else {
        table_cell(table, "-");
    }
    if (spike_bands_apply(report)) {
        const SpikeBandSums sums = spike_bands_sums(spikes);
        table_cell(table, "%zu", sums.inside.count);
        section_number_or_dash(table, sums.inside.count > 0, sums.inside.largest);
    }
}

static void run_spikes_write_counts(const RunReport *report, const Style *style, Text *text)
{
    static const SectionHead HEADS[] = {
        {"signal", "", TABLE_LEFT},     {"unit", "", TABLE_LEFT},
        {"backend", "", TABLE_LEFT},    {"threshold", "", TABLE_RIGHT},
        {"spikes", "", TABLE_RIGHT},    {"strongest", "", TABLE_RIGHT},
        {"", "", TABLE_RIGHT},          {"in bands", "", TABLE_RIGHT},
        {"strongest", "", TABLE_RIGHT},
    };
    const Linkage *linkage = &report->scenario->linkage;
    const bool has_bands = spike_bands_apply(report);
    Table *table = section_begin("Spikes of the signals", has_bands ? 9 : 7, HEADS, style, text);
    run_when_head(table, 6, report);
    for (size_t body = 0; body < linkage->body_count; body++) {
        for (size_t i = 0; i < report->run_count; i++) {
            const Trajectory *run = report->runs[i];
            if (run_report_has_body_spikes(report, run, body)) {
                run_spikes_count_row(table, report, run, "alpha", linkage->bodies[body].name,
                                     "rad/s^2", &run->alpha_spikes[body]);
            }
        }
    }
    for (size_t joint = 0; joint < linkage->joint_count; joint++) {
        for (size_t i = 0; i < report->run_count; i++) {
            const Trajectory *run = report->runs[i];
            if (run_spikes_has_joint(report, run, joint)) {
                const Joint *of = &linkage->joints[joint];
                run_spikes_count_row(table, report, run,
                                     linkage_is_torsional(of) ? "torque" : "force", of->name,
                                     joint_units(of)->force, &run->force_spikes[joint]);
            }
        }
    }
    section_end(table, text);
    if (has_bands) {
        text_append(text, "  The paper's bands: crank at %.0f to %.0f and %.0f to %.0f deg.\n",
                    spike_bands_first_deg(0), spike_bands_last_deg(0), spike_bands_first_deg(1),
                    spike_bands_last_deg(1));
    }
}

static size_t count_kept(const RunReport *report, const Trajectory *run)
{
    size_t count = 0;
    for (size_t i = 0; i < report->scenario->linkage.body_count; i++) {
        count += run_report_has_body_spikes(report, run, i) ? run->alpha_spikes[i].kept : 0;
    }
    return count;
}

// The numbers of a spike; a linkage without a drive has no angle of a crank.
static NumberRecord record_of(NumberOwner owner, const Trajectory *run, size_t member,
                              const SignalSpike *spike)
{
    const NumberSource source = {.run = run, .spike = spike};
    NumberRecord record = number_record(owner, &source, member);
    for (NumberId id = 0; !run->linkage.driver.is_present && id < NUMBER_COUNT; id++) {
        record.values[id].crank_rad = NAN;
    }
    return record;
}

static void run_spikes_write_strongest(const RunReport *report, const Trajectory *run, size_t limit,
                                       const Style *style, Text *text)
{
    const Linkage *linkage = &report->scenario->linkage;
    NumberFields fields = {.count = 0};
    number_fields_label(&fields, "body", "", TABLE_LEFT);
    number_fields_add(&fields, NUMBER_OWNER_BODY_SPIKE, NUMBER_SPED, 0,
                      run_report_has_crank(report));
    number_fields_label(&fields, "joint", "", TABLE_LEFT);
    char heading[128];
    snprintf(heading, sizeof heading, "Strongest spikes of the accelerations, %s", run->backend);
    Table *table = fields_table(heading, fields.rows, FIELD_TABLE, style, text);
    for (size_t body = 0; body < linkage->body_count; body++) {
        const SignalSpikes *spikes = &run->alpha_spikes[body];
        for (size_t i = 0;
             run_report_has_body_spikes(report, run, body) && i < spikes->kept && i < limit; i++) {
            const int joint = spikes->spikes[i].joint;
            const NumberRecord record =
                record_of(NUMBER_OWNER_BODY_SPIKE, run, body, &spikes->spikes[i]);
            table_cell(table, "%s", linkage->bodies[body].name);
            fields_table_row(fields.rows, FIELD_TABLE, &record, table);
            table_cell(table, "%s", joint >= 0 ? linkage->joints[joint].name : "-");
        }
    }
    section_end(table, text);
}

void spike_tables_write(const RunReport *report, size_t limit, const Style *style, Text *text)
{
    const Trajectory *last = NULL;
    for (size_t i = 0; i < report->run_count; i++) {
        last = looked_for_any(report, report->runs[i]) ? report->runs[i] : last;
    }
    if (last == NULL) {
        return;
    }
    run_spikes_write_counts(report, style, text);
    if (count_kept(report, last) > 0) {
        run_spikes_write_strongest(report, last, limit, style, text);
    }
}

// The spikes in JSON.

static void set_with_unit(json_t *object, const char *name, const char *unit, double value)
{
    char key[128];
    snprintf(key, sizeof key, "%s_%s", name, unit);
    json_value_set(object, key, value);
}

void spike_json_set(json_t *object, NumberOwner owner, const Trajectory *run, size_t member)
{
    const Linkage *linkage = &run->linkage;
    const bool is_alpha = owner == NUMBER_OWNER_BODY_SPIKE;
    const SignalSpikes *spikes = is_alpha ? &run->alpha_spikes[member] : &run->force_spikes[member];
    const char *name = is_alpha ? "alpha" : "force";
    const char *unit = is_alpha ? "rad_s2" : joint_units(&linkage->joints[member])->force_key;
    NumberFields fields = {.count = 0};
    number_fields_add(&fields, owner, number_turn(owner, linkage, member), 0, true);
    char key[64];
    json_t *array = spikes->is_known ? json_array() : json_null();
    for (size_t i = 0; spikes->is_known && i < spikes->kept; i++) {
        const int joint = spikes->spikes[i].joint;
        const NumberRecord record = record_of(owner, run, member, &spikes->spikes[i]);
        json_t *spike = fields_json(fields.rows, FIELD_JSON, &record);
        json_object_set_new(spike, "joint",
                            joint >= 0 ? json_string(linkage->joints[joint].name) : json_null());
        json_array_append_new(array, spike);
    }
    snprintf(key, sizeof key, "%s_spikes", name);
    json_object_set_new(object, key, array);
    snprintf(key, sizeof key, "%s_spike_count", name);
    json_object_set_new(object, key,
                        spikes->is_known ? json_integer((json_int_t)spikes->count) : json_null());
    snprintf(key, sizeof key, "%s_spike_threshold", name);
    set_with_unit(object, key, unit, spikes->is_known ? spikes->threshold : NAN);
    snprintf(key, sizeof key, "%s_spike_resolution", name);
    set_with_unit(object, key, unit, spikes->is_known ? spikes->resolution : NAN);
}

static json_t *band_object(const SignalSpikes *spikes, const char *unit)
{
    const SpikeBandSums sums = spike_bands_sums(spikes);
    json_t *object = json_object();
    json_object_set_new(object, "inside", json_integer((json_int_t)sums.inside.count));
    json_object_set_new(object, "outside", json_integer((json_int_t)sums.outside.count));
    set_with_unit(object, "largest_inside", unit,
                  sums.inside.count > 0 ? sums.inside.largest : NAN);
    set_with_unit(object, "largest_outside", unit,
                  sums.outside.count > 0 ? sums.outside.largest : NAN);
    return object;
}

json_t *spike_json_bands(const RunReport *report, const Trajectory *run)
{
    const Linkage *linkage = &report->scenario->linkage;
    if (!spike_bands_apply(report)) {
        return json_null();
    }
    json_t *bands = json_array();
    json_t *bodies = json_object();
    json_t *joints = json_object();
    for (size_t i = 0; i < SPIKE_BAND_COUNT; i++) {
        json_array_append_new(
            bands, json_pack("[f, f]", spike_bands_first_deg(i), spike_bands_last_deg(i)));
    }
    for (size_t i = 0; i < linkage->body_count; i++) {
        if (!linkage_is_driven(linkage, (int)i) && run->alpha_spikes[i].is_known) {
            json_object_set_new(bodies, linkage->bodies[i].name,
                                band_object(&run->alpha_spikes[i], "rad_s2"));
        }
    }
    for (size_t i = 0; i < linkage->joint_count; i++) {
        if (run->force_spikes[i].is_known) {
            json_object_set_new(joints, linkage->joints[i].name,
                                band_object(&run->force_spikes[i], "N"));
        }
    }
    return json_pack("{s:o, s:o, s:o}", "bands_deg", bands, "bodies", bodies, "joints", joints);
}
