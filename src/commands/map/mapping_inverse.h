// Which spring and damper are an ERP and a CFM, and what do they give back?
#pragma once

#include "base/text.h"
#include "measure/impact.h"
#include "measure/mapping_joint.h"
#include "write/style.h"

#include <jansson.h>

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
