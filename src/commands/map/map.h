// A mapping: everything there is to report of it, the forms of the report, and the ways back from
// ERP and CFM.
#pragma once

#include "base/text.h"
#include "measure/estimate.h"
#include "measure/mapping.h"
#include "measure/mapping_contact.h"
#include "write/fields.h"
#include "write/table.h"
#include "write/units.h"

#include <jansson.h>

// The paper's penalty parameter as rows of ODE, read both ways it can be, beside its approach.

// One of the paper's speeds.
typedef struct PenaltyMapRow {
    double rpm;
    double force;    // N, Table I
    double printed;  // N, Table II: P
    double approach; // m, Table III
    double mass;     // kg, of the joint's contacts
    double speed;    // m/s, likewise: median closing speed of the reference's run at this speed
    // read as a stiffness in N/mm, with the viscous damper of the restitution asked for
    Scenario turned; // owned: the case at this speed
    MappingContact stiffness;
    ErpCfm soft;               // of it at the step, by the case's map
    double rest_depth;         // m, force / stiffness
    ImpactDelivered by_spring; // what the engine delivered
    // read as a velocity-level penalty in N s/mm
    double cfm;                 // m/(N s)
    ImpactDelivered by_penalty; // what the engine delivered
} PenaltyMapRow;

typedef struct PenaltyMap {
    PrintedPin pin;
    OdeMap map;    // of the readings as a stiffness
    double step_s; // of all rows
    PenaltyMapRow rows[PRINTED_SPEED_COUNT];
} PenaltyMap;

// Whether a scenario has one of the paper's two pins with play, driven; its number if so.
bool penalty_map_fits(const Scenario *scenario, PrintedPin *pin);

// Works out all rows at a step, s. The map is for penalty_map_destroy. Fails with ERR_CASE where
// the scenario does not fit, with ERR_SOLVER where the reference fails at one of the speeds or
// there is no contact at one.
bool penalty_map_make(const Scenario *scenario, double step_s, RunWatch watch, PenaltyMap **map,
                      Err *err);

// Accepts NULL.
void penalty_map_destroy(PenaltyMap *map);

// Everything there is to say about a mapping, and the forms in which it is said.

enum { MAPPING_REPORT_LAW_SIZE = 64 };

typedef struct MappingReport {
    const Scenario *scenario;
    const Mapping *mapping;
    const PenaltyMap *penalty; // NULL: not asked for
} MappingReport;

// Whether rows are those of the velocity-level model, which has no law and no maps.
static inline bool mapping_report_is_poisson(const MappingReport *report)
{
    return report->scenario->contact.model == CONTACT_POISSON;
}

// The joint of a contact.
static inline const Joint *mapping_report_joint(const MappingContact *contact)
{
    return &contact->scenario.linkage.joints[contact->joint.joint];
}

// The units of a contact.
static inline const JointUnits *mapping_report_units(const MappingContact *contact)
{
    return joint_units(mapping_report_joint(contact));
}

// The law of a contact for people: a stiffness that the case gives shows its value.
void mapping_report_law(const MappingContact *contact, char law[MAPPING_REPORT_LAW_SIZE]);

// The forms, each of a MappingReport. The CSV is a file of its own, a row a joint, law, map and
// step: ERR_FILE.
void mapping_screen_write(const void *report, const Style *style, Text *text);
void mapping_text_write(const void *report, const Style *style, Text *text);
bool mapping_rows_write_csv(const void *report, const char *path, Err *err);
void mapping_plot_write(const void *report, Text *svg);
json_t *mapping_json_build(const void *report);

// New reference.
json_t *mapping_penalty_json(const PenaltyMap *map);

// Appends a row's map and step, blank where the map is that of the row above.
void mapping_rows_begin(const MappingRow *rows, size_t index, Table *table);

// Parts of the text: the settings of a contact with their verdicts, what is wrong with those that
// are not valid, and what they deliver; the best constants; the paper's penalty.
void mapping_rows_write_table(const MappingRow *rows, size_t count, const Style *style, Text *text);
void mapping_penalty_text_write(const PenaltyMap *map, const Style *style, Text *text);

// The fields of a MappingRow.
extern const Field MAPPING_ROW_FIELDS[];

// The fields of ImpactDelivered, and of the MapImpact that is asked for.
extern const Field DELIVERED_FIELDS[];
extern const Field ASKED_FIELDS[];

// The spring and damper that an ERP and a CFM are, and their restitution.

enum { INVERSE_READING_COUNT = 3 };

// The maps by which a row can be read that stays the same through a contact.
extern const OdeMap INVERSE_READINGS[INVERSE_READING_COUNT];

// A row read by one map.
typedef struct InverseReading {
    OdeMap map;
    bool is_there;      // some spring and damper make that row by this map; else all are NAN
    double stiffness;   // N/m
    double damping;     // N s/m
    double omega_h;     // 1, of that spring at the step; NaN without a mass
    double ratio;       // 1, of damping; NaN without a mass or a spring
    double restitution; // 1, of that spring and damper themselves; NaN likewise
} InverseReading;

// The row on one mass.
typedef struct InverseMass {
    const char *joint; // whose mass it is; empty where it was given
    double mass;       // kg; 0 where none is known
    InverseReading readings[INVERSE_READING_COUNT];
    ImpactFigures predicted; // of the row itself, for a contact at the speed below
    ImpactDelivered delivered;
    double speed; // m/s; a row that stays the same gives the same restitution at any
} InverseMass;

typedef struct Inverse {
    bool is_pair;  // kp and kd were given, else ERP and CFM
    double kp;     // N/m, as given
    double kd;     // N s/m, as given
    double step_s; //
    ErpCfm row;
    size_t mass_count;
    InverseMass *masses; // owned
} Inverse;

// An inverse from a pair as Gazebo has it, or from a row; no masses yet. Fails with ERR_USAGE where
// there is no row or none that stands for a spring and damper.
bool inverse_of_pair(double kp, double kd, double step_s, Inverse *inverse, Err *err);
bool inverse_of_row(double erp, double cfm, double step_s, Inverse *inverse, Err *err);

void inverse_finish(Inverse *inverse);

// Adds a mass, kg, of a joint; 0 kg for none known: then only readings that need none are there.
// The name must outlive the inverse.
void inverse_add_mass(Inverse *inverse, const char *joint, double mass);

// What is printed of an Inverse: as text, and as JSON, a new reference.
void mapping_inverse_text(const void *inverse, const Style *style, Text *text);
json_t *mapping_inverse_json(const void *inverse);
