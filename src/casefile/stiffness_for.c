// Finds the stiffness with which a contact bears a force at a depth.
//
//     K = F / d^n,   n = 1 where no exponent is given
#include "casefile/stiffness_for.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static const char STIFFNESS_FOR_AT[] = " at ";
static const char STIFFNESS_FOR_WITH[] = " with exponent ";
static const double STIFFNESS_FOR_MOST = 1e24;              // N/m^n, as of a stiffness
static const double STIFFNESS_FOR_EXPONENTS[] = {1.0, 3.0}; // as of its unit

static const char *example_of(bool is_turning)
{
    return is_turning ? "a depth at a torque such as 0.2 deg at 3 N m, or 0.2 deg at 3 N m with "
                        "exponent 1.5"
                      : "a depth at a force such as 0.1 mm at 500 N, or 0.1 mm at 500 N with "
                        "exponent 1.5";
}

static bool complain(Complaint *complaint, bool is_turning, const char *words)
{
    snprintf(complaint->text, sizeof complaint->text, "%s", words);
    snprintf(complaint->allowed, sizeof complaint->allowed, "%s", example_of(is_turning));
    return false;
}

bool stiffness_for_read(const char *text, bool is_turning, StiffnessFor *read, Complaint *complaint)
{
    char depth[QUANTITY_TEXT_SIZE];
    char force[QUANTITY_TEXT_SIZE];
    const char *at = strstr(text, STIFFNESS_FOR_AT);
    if (at == NULL || strlen(text) >= sizeof depth) {
        return complain(complaint, is_turning, "expected a depth, the word at, and a force");
    }
    snprintf(depth, sizeof depth, "%.*s", (int)(at - text), text);
    snprintf(force, sizeof force, "%s", at + strlen(STIFFNESS_FOR_AT));
    StiffnessFor found = {.exponent = 1.0};
    char *with = strstr(force, STIFFNESS_FOR_WITH);
    if (with != NULL) {
        if (!quantity_number(with + strlen(STIFFNESS_FOR_WITH), &found.exponent, complaint)) {
            return false;
        }
        *with = '\0';
    }
    if (!quantity_parse(depth, is_turning ? DIMENSION_ANGLE : DIMENSION_LENGTH, &found.depth,
                        complaint) ||
        !quantity_parse(force, is_turning ? DIMENSION_TORQUE : DIMENSION_FORCE, &found.force,
                        complaint)) {
        return false;
    }
    if (!(found.depth > 0.0) || !(found.force > 0.0)) {
        return complain(complaint, is_turning, "depth and force must be above 0");
    }
    if (!(found.exponent >= STIFFNESS_FOR_EXPONENTS[0] &&
          found.exponent <= STIFFNESS_FOR_EXPONENTS[1])) {
        return complain(complaint, is_turning, "the exponent must be from 1 to 3");
    }
    const double stiffness = found.force / pow(found.depth, found.exponent);
    if (!(stiffness > 0.0 && stiffness <= STIFFNESS_FOR_MOST)) {
        return complain(complaint, is_turning, "its stiffness is out of range");
    }
    *read = found;
    return true;
}

bool stiffness_for_store(const Target *target, Scenario *scenario)
{
    const Entry *entry = target->entry;
    const bool is_of_joint = entry->row->family == SCHEMA_JOINT;
    Joint *joint = is_of_joint ? &scenario->linkage.joints[entry->index] : NULL;
    StiffnessFor read;
    Complaint complaint = {.allowed = ""};
    if (!target_check_scalar(target, entry->node)) {
        return false;
    }
    if (!stiffness_for_read(entry->node->text, is_of_joint && joint_has_angle(joint->kind), &read,
                            &complaint)) {
        return source_error(entry->source, entry->node->span, complaint.allowed, target->err, "%s",
                            complaint.text);
    }
    const double stiffness = read.force / pow(read.depth, read.exponent);
    if (is_of_joint) {
        joint->contact.stiffness = stiffness;
        joint->contact.exponent = read.exponent;
        joint->contact.for_depth = read.depth;
    } else {
        scenario->contact.stiffness = stiffness;
        scenario->contact.exponent = read.exponent;
        scenario->contact.for_depth = read.depth;
    }
    return true;
}
