// A study's rows made by hand: the columns of the paper's case, numbers that look like any.
#pragma once

#include "base/hash.h"
#include "commands/study/store.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

enum { STUDY_RESULTS = 25, STUDY_SPEEDS = 15, STUDY_STEPS = 8 };

static const char *const STUDY_SCHEMES[3] = {"direct/plain/textbook", "direct/staggered/impulse",
                                             "auto/1e-4"};

static inline void study_add_column(Column *columns, size_t *count, const char *name,
                                    ColumnKind kind)
{
    snprintf(columns[*count].name, RECORD_NAME_SIZE, "%s", name);
    columns[(*count)++].kind = kind;
}

// What a study of speed, damping, scheme and step of the paper's case has.
static inline Layout study_layout(void)
{
    static const char *const MEASURES[] = {"omega_max_rad_s", "omega_min_rad_s", "alpha_max_rad_s2",
                                           "alpha_min_rad_s2"};
    static const char *const OTHERS[] = {"crank_coupler_force_max_N",
                                         "crank_coupler_impulse_N_s",
                                         "crank_coupler_penetration_max_m",
                                         "crank_coupler_contact_fraction",
                                         "error_max",
                                         "error_max_in_horizon",
                                         "error_omega_rms",
                                         "error_alpha_max",
                                         "error_angle_max_rad",
                                         "horizon_s",
                                         "uncertainty",
                                         "energy_drive_work_J",
                                         "energy_dissipated_J",
                                         "energy_change_J",
                                         "energy_residual_J",
                                         "crank_coupler_spike_force_N",
                                         "crank_coupler_spike_crank_rad"};
    static const char *const WHOLE[] = {"crank_coupler_impacts", "steps", "evaluations"};
    Layout layout = {0};
    study_add_column(layout.settings, &layout.setting_count, "drive_speed_rad_s", COLUMN_REAL);
    study_add_column(layout.settings, &layout.setting_count, "contact_damping", COLUMN_WORD);
    study_add_column(layout.settings, &layout.setting_count, "scheme", COLUMN_WORD);
    study_add_column(layout.settings, &layout.setting_count, "run_step_s", COLUMN_REAL);
    for (size_t i = 0; layout.result_count < STUDY_RESULTS; i++) {
        char name[RECORD_NAME_SIZE];
        if (i < 8) {
            snprintf(name, sizeof name, "%s_%s", i < 4 ? "coupler" : "follower", MEASURES[i % 4]);
        } else {
            snprintf(name, sizeof name, "%s", i < 22 ? OTHERS[i - 8] : WHOLE[i - 22]);
        }
        study_add_column(layout.results, &layout.result_count, name,
                         i < 22 ? COLUMN_REAL : COLUMN_WHOLE);
    }
    return layout;
}

// The number of a run and of one of its columns, mixed to one in [0, 1).
static inline double study_noise(uint64_t run, size_t column)
{
    const uint64_t hash = hash_number(hash_number(HASH_START, (double)run), (double)column);
    return (double)(hash >> 11) / 9007199254740992.0;
}

static inline Record study_record(const Layout *layout, uint64_t run)
{
    Record record = {.run = run, .hash = (uint64_t)(study_noise(run, 999) * 1.8e19)};
    for (size_t i = 0; i < layout->setting_count; i++) {
        Cell *cell = &record.settings[i];
        switch (i) {
        case 0:
            cell->number = 10.471975511965978 * (double)(1 + run / STUDY_STEPS % STUDY_SPEEDS);
            break;
        case 1:
            strcpy(cell->word, run / 1000 % 2 == 0 ? "lankarani-nikravesh" : "flores");
            break;
        case 2:
            strcpy(cell->word, STUDY_SCHEMES[run / 100 % 3]);
            break;
        default:
            cell->number = 3e-7 * pow(1.9, (double)(run % STUDY_STEPS));
        }
    }
    // one in fifty goes wrong, and has no results
    if (run % 50 == 7) {
        record.outcome = run % 100 == 7 ? RUN_OUTCOME_FAILED : RUN_OUTCOME_TIMED_OUT;
        strcpy(record.reason, run % 100 == 7 ? "a number is not finite at 0.0125 s"
                                             : "took longer than its limit of 60 s");
        record.hash = 0;
    }
    for (size_t i = 0; i < layout->result_count; i++) {
        const double value = exp(10.0 * study_noise(run, i) - 5.0);
        const bool is_whole = layout->results[i].kind == COLUMN_WHOLE;
        record.results[i] = record.outcome != RUN_OUTCOME_OK ? (double)NAN
                            : is_whole                       ? floor(1e4 * study_noise(run, i))
                                                             : value;
    }
    record.wall_s = 0.01 + 0.1 * study_noise(run, 1000);
    return record;
}

static inline StoreHead study_head(const Layout *layout, uint64_t run_count)
{
    return (StoreHead){.layout = layout,
                       .run_count = run_count,
                       .key_count = 2,
                       .keys = {{"study", "9cd1", "the study file has changed"},
                                {"program", "0.1.0-77aa", "the program is another one"}}};
}
