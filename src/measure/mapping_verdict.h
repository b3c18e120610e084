// Is a setting right, what is wrong with it, and what would be right?
#pragma once

#include "measure/mapping.h"

// What figures, predicted or delivered, are to be called beside what the law asks.
VerdictKind verdict_judge(const MappingContact *contact, OdeMap map, double step_s,
                          const ImpactFigures *figures);

// Fills in the contact's longest valid steps, found by trying predictions.
void verdict_find_steps(MappingContact *contact);

// Words for a row whose prediction and verdict stand in it.
void verdict_describe(const MappingContact *contact, MappingRow *row);

// Of CONTACT_POISSON: the smallest penalty, N s/m, that is valid at a step, s.
double verdict_least_penalty(const MappingContact *contact, double step_s);
