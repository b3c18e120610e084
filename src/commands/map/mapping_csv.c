// What does a spreadsheet read of a mapping?
#include "commands/map/mapping_csv.h"

#include "write/csv.h"
#include "write/file.h"

#include <math.h>
#include <stdio.h>

static const char HEAD[] =
    "joint,law,map,step_s,mass_kg,speed_m_s,stiffness_N_m,damping_N_s_m,steps_a_contact,omega_h,"
    "erp,cfm_m_N_s,asked_restitution,asked_force_max_N,asked_penetration_max_m,asked_duration_s,"
    "predicted_restitution,predicted_force_max_N,predicted_penetration_max_m,predicted_duration_s,"
    "delivered_restitution,delivered_force_max_N,delivered_penetration_max_m,delivered_duration_s,"
    "verdict,longest_valid_step_s,message\n";

static void write_number(FILE *stream, double value)
{
    csv_write_number(stream, value);
    fputc(',', stream);
}

static void write_figures(FILE *stream, const ImpactFigures *figures, bool is_known)
{
    const double means[] = {figures->restitution.mean, figures->force_max.mean,
                            figures->penetration_max.mean, figures->duration.mean};
    for (int i = 0; i < 4; i++) {
        write_number(stream, is_known ? means[i] : NAN);
    }
}

static void write_row(FILE *stream, const MappingReport *report, const MappingContact *contact,
                      const MappingRow *row)
{
    const bool is_poisson = mapping_report_is_poisson(report);
    const bool has_row = row->map != ODE_MAP_IMPULSE;
    fprintf(stream, "%s,%s,%s,", mapping_report_joint(report, contact)->name, contact->law_name,
            mapping_report_map(report, row));
    const double settings[] = {
        row->step_s,
        contact->impact.mass,
        contact->impact.speed,
        is_poisson ? NAN : contact->secant,
        is_poisson ? contact->scenario.contact.penalty : contact->damping,
        is_poisson ? NAN : row->steps_a_contact,
        is_poisson ? NAN : row->omega_h,
        has_row ? row->soft.erp : NAN,
        has_row ? row->soft.cfm : NAN,
        contact->asked.restitution,
        is_poisson ? NAN : contact->asked.force_max,
        is_poisson ? NAN : contact->asked.penetration_max,
        is_poisson ? NAN : contact->asked.duration,
    };
    for (size_t i = 0; i < sizeof settings / sizeof *settings; i++) {
        write_number(stream, settings[i]);
    }
    write_figures(stream, &row->predicted, row->predicted.is_ended);
    write_figures(stream, &row->delivered.figures, row->delivered.is_measured);
    fprintf(stream, "%s,", VERDICT_NAMES[row->verdict]);
    const double longest_s = contact->largest_s[row->map];
    write_number(stream, longest_s > 0.0 ? longest_s : NAN);
    csv_write_quoted(stream, row->delivered.is_measured ? row->words : row->delivered.message);
    fputc('\n', stream);
}

bool mapping_csv_write(const MappingReport *report, const char *path, Err *err)
{
    WholeFile file;
    if (!file_begin(&file, FILE_TABLE, path, err)) {
        return false;
    }
    fputs(HEAD, file.stream);
    for (size_t i = 0; i < report->mapping->contact_count; i++) {
        const MappingContact *contact = &report->mapping->contacts[i];
        for (size_t k = 0; k < contact->row_count; k++) {
            write_row(file.stream, report, contact, &report->mapping->rows[contact->first_row + k]);
        }
    }
    return file_end(&file, err);
}
