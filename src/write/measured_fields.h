// The field tables of what several commands measure: errors and distributions.
#pragma once

#include "measure/ensemble.h"
#include "measure/error.h"
#include "measure/ladder.h"
#include "write/fields.h"

// Of a TrajectoryError.
// Errors of contacts are in a table of their own.
enum { ERROR_OF_CONTACTS = FIELD_OWN << 12 }; // no bit of those who have groups of them
extern const Field ERROR_FIELDS[];
extern const Field ERROR_JOINT_FIELDS[];
extern const Field ERROR_BODY_FIELDS[];

// Of the Distributions of a joint, by EnsembleMetric: a group each, in the joint's units. Those of
// a joint with limits about which it turns are torques and angles.
const Field *measured_metric_fields(const Joint *joint);

// New reference: the distributions of the joints with play, by joint and metric.
json_t *ensemble_joints_json(const Linkage *linkage, const Ensemble *ensemble);

// Reads them back. False where a number is missing.
bool ensemble_joints_read(const Linkage *linkage, const json_t *joints, Ensemble *ensemble);

// Appends a line of a first screen: what the errors are against, how right that is, and up to when.
void screen_truth(const LadderTruth *truth, Text *text);
