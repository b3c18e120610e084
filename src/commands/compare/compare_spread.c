// What can be said of a run beyond the time up to which its trajectory can be predicted?
//
// Beyond the horizon two starts that differ by nothing measurable part. What stays are
// distributions over many starts, and whether a scheme's agree with the reference's.
#include "commands/compare/compare_report.h"
#include "write/measured_fields.h"
#include "write/units.h"

#include <stdio.h>

static const EnsembleMetric COLUMNS[] = {
    ENSEMBLE_IMPACTS,         ENSEMBLE_FORCE_MAX,     ENSEMBLE_IMPULSE,
    ENSEMBLE_PENETRATION_MAX, ENSEMBLE_CONTACT_SHARE,
};
enum { COLUMN_COUNT = sizeof COLUMNS / sizeof COLUMNS[0] };

static void spread_row(Table *table, const CompareReport *report, size_t scheme, size_t joint)
{
    const LadderEnsemble *ensemble = &report->ladder->ensembles[scheme];
    const Field *metrics = measured_metric_fields(&report->scenario->linkage.joints[joint]);
    table_cell(table, "%s", report->ladder->schemes[scheme].name);
    table_cell(table, ensemble->step_s > 0.0 ? "%.4g" : "its own", ensemble->step_s * UNITS_US);
    for (int i = 0; i < COLUMN_COUNT; i++) {
        const Distribution *d = &ensemble->ensemble.joints[joint][COLUMNS[i]];
        if (ensemble->ensemble.members == 0) {
            table_cell(table, "failed");
        } else {
            const double scale = units_per_si(metrics[COLUMNS[i]].unit);
            table_cell(table, "%.4g [%.4g, %.4g]", d->median * scale, d->low * scale,
                       d->high * scale);
        }
    }
}

static void write_failures(const CompareReport *report, const Style *style, Text *text)
{
    for (size_t i = 0; i < report->ladder->scheme_count; i++) {
        const Ensemble *ensemble = &report->ladder->ensembles[i].ensemble;
        if (ensemble->failed > 0) {
            text_append(text, "\n  %s%s: %zu of the ensemble's runs failed: %s%s\n", style->failure,
                        report->ladder->schemes[i].name, ensemble->failed, ensemble->message,
                        style->end);
        }
    }
}

// One joint with play: the motion's spread by every scheme that has one.
static void write_joint(const CompareReport *report, size_t joint, const Style *style, Text *text)
{
    const Field *metrics = measured_metric_fields(&report->scenario->linkage.joints[joint]);
    Table *table = table_create(2 + COLUMN_COUNT);
    table_fit(table, style->width);
    table_head(table, 0, "scheme", "", TABLE_LEFT);
    table_head(table, 1, "step", "us", TABLE_RIGHT);
    for (int i = 0; i < COLUMN_COUNT; i++) {
        const Field *metric = &metrics[COLUMNS[i]];
        table_head(table, (size_t)(2 + i), metric->title, metric->unit, TABLE_RIGHT);
    }
    for (size_t i = 0; i < report->ladder->scheme_count; i++) {
        if (report->ladder->ensembles[i].is_known) {
            spread_row(table, report, i, joint);
        }
    }
    text_append(text, "\n  %s\n\n", report->scenario->linkage.joints[joint].name);
    table_write(table, text);
    table_destroy(table);
}

void compare_spread_write(const CompareReport *report, const Style *style, Text *text)
{
    const Linkage *linkage = &report->scenario->linkage;
    if (!report->ladder->truth.is_limited) {
        return;
    }
    text_append(
        text,
        "\n%sThe whole run from %d starts, their speeds a little apart: median [least, most]%s\n",
        style->heading, ENSEMBLE_MEMBERS, style->end);
    for (size_t joint = 0; joint < ensemble_joint_count(linkage); joint++) {
        if (linkage_has_play(&linkage->joints[joint])) {
            write_joint(report, joint, style, text);
        }
    }
    write_failures(report, style, text);
}
