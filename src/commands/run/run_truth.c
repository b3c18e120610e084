// How far are the runs from the truth, how sure is the truth, and where does it end?
#include "commands/run/run_floor.h"
#include "commands/run/run_report.h"
#include "model/linkage.h"
#include "write/measured_fields.h"
#include "write/units.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

// 1: a reference that is less sure than this holds nowhere
static const double HOLDS = 1e-3;

static void error_row(Table *table, const RunReport *report, size_t run)
{
    const TrajectoryError *error = &report->errors[run];
    const bool is_certified = run_report_is_certified(report, error);
    table_cell(table, "%s", report->runs[run]->backend);
    table_cell(table, "%s", error->against);
    section_number(table, error->max);
    section_number(table, error->max_time_s * UNITS_MS);
    section_number_or_dash(table, is_certified && isfinite(error->max_in_horizon),
                           error->max_in_horizon);
    section_number_or_dash(table, is_certified, is_certified ? report->truth->uncertainty : 0.0);
    table_cell(table, "%s%s", error->in, error->is_floor ? " (floor)" : "");
    section_number(table, error->omega_max);
    section_number(table, error->omega_rms);
    section_number(table, error->alpha_max);
    section_number(table, error->angle_max_rad * UNITS_DEG);
    table_cell(table,
               run_report_is_limited_by_reference(report, error) ? "limited by the reference" : "");
}

// What is to be known about the truth before an error is believed.
static void write_horizon(const RunReport *report, Text *text)
{
    const Truth *truth = report->truth;
    const double end_ms = scenario_duration(report->scenario) * UNITS_MS;
    if (truth->is_uncertified) {
        text_append(text, "  The reference is not certified (--uncertified): neither its own error "
                          "is known nor how far the motion can be predicted.\n");
    } else if (truth->message[0] != '\0') {
        text_append(text, "  The reference could not be certified: %s\n", truth->message);
    } else if (truth->is_limited) {
        text_append(text,
                    "  The motion cannot be predicted beyond %.4g of %.4g ms: by then a "
                    "perturbation of 1e-10 has grown %.3g times. Errors after it mean nothing; "
                    "distributions over many starts can be compared.\n",
                    truth->horizon_s * UNITS_MS, end_ms, truth->growth);
    } else if (!(truth->uncertainty <= HOLDS)) {
        text_append(text, "  The reference's own uncertainty is %.2g over the run of %.4g ms.\n",
                    truth->uncertainty, end_ms);
    } else {
        text_append(text,
                    "  The reference holds through the whole run, %.4g ms: a perturbation of 1e-10 "
                    "grows %.3g times.\n",
                    end_ms, truth->growth);
    }
}

// The reference knows no POISSON model.
static void write_other_model(const RunReport *report, Text *text)
{
    const ContactOptions *contact = &report->scenario->contact;
    if (run_report_mixes_models(report)) {
        text_append(text,
                    "  The reference has the elastic law (%s) in place of the POISSON model: "
                    "errors contain the difference of the two.\n",
                    contact->stiffness > 0.0 ? "given stiffness" : OPTIONS_LAWS[contact->law]);
    }
}

// Whether ODE ran at a step that was given, and nothing says how far it is off.
static bool has_unknown_error(const RunReport *report)
{
    for (size_t i = 0; i < report->run_count; i++) {
        const Trajectory *run = report->runs[i];
        if (run->is_complete && !report->errors[i].is_known && run->error_estimate == 0.0 &&
            strcmp(run->backend, OPTIONS_BACKENDS[BACKEND_ODE]) == 0) {
            return true;
        }
    }
    return false;
}

// What has to be said about the truth though nothing was compared with it.
static void write_truth_alone(const RunReport *report, const Style *style, Text *text)
{
    if (has_unknown_error(report)) {
        text_append(text,
                    "\n%sError%s\n\n  The error of ode is not known: there is no run of the "
                    "reference to compare it with. Add reference to run.backends.\n",
                    style->heading, style->end);
    }
    const bool is_doubtful = run_report_has_truth(report) && report->truth->message[0] != '\0';
    if (is_doubtful || run_report_mixes_models(report)) {
        text_append(text, "\n%sThe reference%s\n\n", style->heading, style->end);
        if (is_doubtful) {
            write_horizon(report, text);
        }
        write_other_model(report, text);
    }
}

void run_truth_errors(const RunReport *report, const Style *style, Text *text)
{
    static const SectionHead HEADS[] = {
        {"backend", "", TABLE_LEFT},
        {"against", "", TABLE_LEFT | TABLE_MINOR},
        {"largest", "1", TABLE_RIGHT},
        {"at time", "ms", TABLE_RIGHT | TABLE_DETAIL},
        {"in horizon", "1", TABLE_RIGHT},
        {"reference +-", "1", TABLE_RIGHT},
        {"in", "", TABLE_WRAP},
        {"omega max", "1", TABLE_RIGHT | TABLE_MINOR},
        {"omega rms", "1", TABLE_RIGHT | TABLE_DETAIL},
        {"alpha max", "1", TABLE_RIGHT | TABLE_DETAIL},
        {"angle max", "deg", TABLE_RIGHT | TABLE_DETAIL},
        {"", "", TABLE_LEFT},
    };
    Table *table = NULL;
    bool includes_play = false;
    bool has_floor = false;
    for (size_t i = 0; i < report->run_count; i++) {
        const TrajectoryError *error = &report->errors[i];
        if (!report->runs[i]->is_complete || !error->is_known) {
            continue;
        }
        if (table == NULL) {
            table = section_begin("Error at the samples, over the reference's largest value", 12,
                                  HEADS, style, text);
        }
        error_row(table, report, i);
        includes_play = includes_play || run_report_includes_play(report, i);
        has_floor = has_floor || error->is_floor;
    }
    if (table == NULL) {
        write_truth_alone(report, style, text);
        return;
    }
    section_end(table, text);
    if (includes_play) {
        text_append(text, "  The analytic solver takes every joint as ideal: an error of it, or "
                          "against it, contains the play itself.\n");
    }
    if (has_floor) {
        text_append(text,
                    "  (floor): that rate is next to nothing in the reference, and its error is "
                    "relative to %g of the speed of the fastest point.\n",
                    DISTANCE_FLOOR);
    }
    if (run_report_has_truth(report)) {
        write_horizon(report, text);
        write_other_model(report, text);
    }
}

void run_truth_energy(const RunReport *report, const Style *style, Text *text)
{
    Table *table = NULL;
    RunFloor *floors = run_floor_list(report);
    for (size_t i = 0; i < report->run_count; i++) {
        const Energy *energy = &report->runs[i]->energy;
        if (!report->runs[i]->is_complete) {
            continue;
        }
        if (table == NULL) {
            table = fields_table("Energy", RUN_ENERGY_FIELDS, FIELD_TABLE, style, text);
        }
        table_cell(table, "%s", report->runs[i]->backend);
        const Energy shown = run_floor_energy(energy, &floors[i]);
        fields_table_row(RUN_ENERGY_FIELDS, FIELD_TABLE, &shown, table);
        const double scale = error_energy(report->runs[i]);
        section_number_or_dash(table, scale > 0.0, fabs(shown.residual / scale));
    }
    free(floors);
    if (table != NULL) {
        section_end(table, text);
    }
}

static void match_rows(Table *table, const Joint *joint, const JointExtremes *truth,
                       const SpikeMatch *match)
{
    for (size_t i = 0; i < match->pair_count; i++) {
        const SpikePair *pair = &match->pairs[i];
        const Spike *spike = &truth->spikes[pair->reference_spike];
        table_cell(table, "%s", joint->name);
        table_cell(table, "%.4f", spike->onset_s * UNITS_MS);
        section_number(table, spike->force_max);
        section_number(table, pair->onset_delay_s * UNITS_US);
        table_cell(table, "%+.3g", pair->force_error * UNITS_PERCENT);
        table_cell(table, "%+.3g", pair->impulse_error * UNITS_PERCENT);
    }
}

// Of the largest forces, which are torques where the limits of pivots are met.
static const char *unit_of_forces(const Linkage *linkage)
{
    bool is_torsional[2] = {false, false};
    for (size_t i = 0; i < linkage->joint_count; i++) {
        if (linkage_has_play(&linkage->joints[i])) {
            is_torsional[linkage_is_torsional(&linkage->joints[i])] = true;
        }
    }
    return is_torsional[false] && is_torsional[true] ? "N, N m" : is_torsional[true] ? "N m" : "N";
}

void run_truth_matches(const RunReport *report, const Style *style, Text *text)
{
    const SectionHead heads[] = {
        {"joint", "", TABLE_LEFT},
        {"reference's onset", "ms", TABLE_RIGHT},
        {"force max", unit_of_forces(&report->scenario->linkage), TABLE_RIGHT},
        {"later by", "us", TABLE_RIGHT},
        {"force", "%", TABLE_RIGHT},
        {"impulse", "%", TABLE_RIGHT},
    };
    const Linkage *linkage = &report->scenario->linkage;
    for (size_t i = 0; report->matches != NULL && i < report->run_count; i++) {
        Table *table = NULL;
        size_t missed = 0;
        size_t extra = 0;
        for (size_t joint = 0; joint < linkage->joint_count; joint++) {
            const SpikeMatch *match = &report->matches[i].joints[joint];
            missed += match->missed;
            extra += match->extra;
            if (table == NULL && match->pair_count + match->missed + match->extra > 0) {
                char heading[128];
                snprintf(heading, sizeof heading, "Contacts matched within the horizon, %s",
                         report->runs[i]->backend);
                table = section_begin(heading, 6, heads, style, text);
            }
            match_rows(table, &linkage->joints[joint], &report->truth->trajectory->joints[joint],
                       match);
        }
        if (table != NULL) {
            section_end(table, text);
            text_append(text,
                        "  Of the strongest contacts kept, %zu of the reference and %zu of %s have "
                        "no match.\n",
                        missed, extra, report->runs[i]->backend);
        }
    }
}

static void distribution_cells(Table *table, const Distribution *distribution, double scale)
{
    section_number(table, distribution->low * scale);
    section_number(table, distribution->median * scale);
    section_number(table, distribution->high * scale);
    section_number(table, distribution->mean * scale);
    section_number(table, distribution->deviation * scale);
}

static void ensemble_rows(Table *table, const RunReport *report, size_t joint, size_t metric)
{
    for (size_t i = 0; i < report->run_count; i++) {
        const Ensemble *ensemble = &report->ensembles[i];
        if (ensemble->members > 0) {
            const Joint *of = &report->scenario->linkage.joints[joint];
            const Field *field = &measured_metric_fields(of)[metric];
            table_cell(table, "%s", report->scenario->linkage.joints[joint].name);
            table_cell(table, "%s%s%s", field->title, field->unit[0] != '\0' ? ", " : "",
                       field->unit);
            table_cell(table, "%s", report->runs[i]->backend);
            distribution_cells(table, &ensemble->joints[joint][metric], units_per_si(field->unit));
        }
    }
}

void run_truth_ensembles(const RunReport *report, const Style *style, Text *text)
{
    static const SectionHead HEADS[] = {
        {"joint", "", TABLE_LEFT}, {"what", "", TABLE_LEFT},    {"backend", "", TABLE_LEFT},
        {"low", "", TABLE_RIGHT},  {"median", "", TABLE_RIGHT}, {"high", "", TABLE_RIGHT},
        {"mean", "", TABLE_RIGHT}, {"+-", "", TABLE_RIGHT},
    };
    if (report->ensembles == NULL) {
        return;
    }
    const Linkage *linkage = &report->scenario->linkage;
    char heading[128];
    snprintf(heading, sizeof heading, "Over starts that differ by %g of the speeds",
             ENSEMBLE_PERTURBATION);
    Table *table = section_begin(heading, 8, HEADS, style, text);
    for (size_t joint = 0; joint < ensemble_joint_count(linkage); joint++) {
        const bool has_play = linkage_has_play(&linkage->joints[joint]);
        for (size_t metric = 0; has_play && metric < ENSEMBLE_METRIC_COUNT; metric++) {
            ensemble_rows(table, report, joint, metric);
        }
    }
    section_end(table, text);
    for (size_t i = 0; i < report->run_count; i++) {
        const Ensemble *ensemble = &report->ensembles[i];
        if (ensemble->members + ensemble->failed > 0) {
            text_append(text, "  %s: %zu starts", report->runs[i]->backend, ensemble->members);
            text_append(text, ensemble->failed > 0 ? ", and %zu that failed: %s\n" : "\n",
                        ensemble->failed, ensemble->message);
        }
    }
}
