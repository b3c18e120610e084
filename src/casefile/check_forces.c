// Checks that springs, bushings, dampers and a torque go with the rest of a case.
#include "casefile/check_forces.h"

#include "casefile/bushings.h"

#define MOTOR "drive.no-load-speed drive.rotor-inertia"
#define SOFT  "drive.stiffness drive.damping"

static bool check_forces_in_space(const Entries *entries, const Linkage *linkage, Err *err)
{
    static const char FORMAT[] = "%s not available in space\nallowed: space: planar, or none";
    const EntryGroup *springs = entries_group(entries, "springs", 0);
    const EntryGroup *torsions = entries_group(entries, "torsion-springs", 0);
    const Entry *torque =
        entries_blame(entries, "drive.torque drive.force drive.stall-torque " SOFT, 0);
    if (!linkage->is_spatial) {
        return true;
    }
    if (linkage->spring_count > 0) {
        return entries_refuse_group(springs, err, FORMAT, "springs are");
    }
    if (linkage->torsion_count > 0) {
        return entries_refuse_group(torsions, err, FORMAT, "torsion springs are");
    }
    if (linkage->bushing_count > 0) {
        return entries_refuse_group(entries_group(entries, "bushings", 0), err, FORMAT,
                                    "bushings are");
    }
    for (size_t i = 0; linkage->gap_damper_count > 0 && i < linkage->joint_count; i++) {
        if (linkage->joints[i].contact.gap_damping > 0.0) {
            return entries_refuse(entries_find(entries, "joints.*.gap-damping", i), err, FORMAT,
                                  "damping in a gap is");
        }
    }
    if (linkage->load_count > 0) {
        return entries_refuse_group(entries_group(entries, "loads", 0), err, FORMAT, "loads are");
    }
    return torque == NULL ||
           entries_refuse(torque, err, FORMAT,
                          torque->row->dimension == DIMENSION_FORCE ? "a force is" : "a torque is");
}

// Points that coincide have no line between them, along which a spring could pull.
static bool check_lines(const Entries *entries, const Linkage *linkage, Err *err)
{
    for (size_t i = 0; i < linkage->spring_count; i++) {
        const Spring *spring = &linkage->springs[i];
        const Vec2 along = vec2_sub(spring->anchor_b, spring->anchor_a);
        if (!(vec2_length(along) > 0.0) && (spring->length > 0.0 || spring->damping > 0.0)) {
            return entries_refuse(entries_find(entries, "springs.*.at-b", i), err,
                                  "the ends of spring '%s' coincide: it has no direction\nallowed: "
                                  "two points, or length: 0 mm without damping",
                                  spring->name);
        }
    }
    return true;
}

// Bodies that keep their angle to one another have none that a spring could turn.
static bool check_turns(const Entries *entries, const Linkage *linkage, Err *err)
{
    for (size_t i = 0; i < linkage->torsion_count; i++) {
        const Joint *joint = &linkage->joints[linkage->torsions[i].joint];
        if (joint_is_ideal(joint->kind) && joint_slides(joint->kind)) {
            return entries_refuse(entries_find(entries, "torsion-springs.*.joint", i), err,
                                  "the bodies of the prismatic joint '%s' do not turn against each "
                                  "other\nallowed: a joint that turns, or springs along the line",
                                  joint->name);
        }
    }
    return true;
}

// A motor has a line of torque over speed that falls, and a soft drive a speed to follow.
static bool check_motor(const Entries *entries, const Linkage *linkage, Err *err)
{
    const Torque *torque = &linkage->torque;
    const Entry *stall = entries_find(entries, "drive.stall-torque", 0);
    const Entry *motor = entries_blame(entries, MOTOR, 0);
    const Entry *soft = entries_blame(entries, SOFT, 0);
    const Entry *limit = entries_find(entries, "drive.torque-limit", 0);
    if (stall == NULL && motor != NULL) {
        return entries_refuse(motor, err,
                              "only a motor has this\nallowed: with drive.stall-torque");
    }
    if (soft != NULL && entries_blame(entries, "drive.speed drive.angle", 0) == NULL) {
        return entries_refuse(soft, err,
                              "only a speed or an angle is followed softly\nallowed: with "
                              "drive.speed or drive.angle");
    }
    if (limit != NULL && soft == NULL) {
        return entries_refuse(limit, err,
                              "only a soft drive has this\nallowed: with drive.stiffness or "
                              "drive.damping");
    }
    if (stall == NULL) {
        return true;
    }
    if (entries_find(entries, "drive.no-load-speed", 0) == NULL) {
        return entries_refuse(stall, err,
                              "the speed at which the motor gives no torque is missing\nallowed: "
                              "with drive.no-load-speed");
    }
    if (!(torque->table.values[0] * torque->no_load > 0.0)) {
        return entries_refuse(motor != NULL ? motor : stall, err,
                              "the torque of a motor falls with its speed\nallowed: a "
                              "drive.no-load-speed of the sign of drive.stall-torque, neither 0");
    }
    const Joint *joint = &linkage->joints[torque->joint];
    return torque->inertia == 0.0 || joint->body_a == LINKAGE_GROUND ||
           joint->body_b == LINKAGE_GROUND ||
           entries_refuse(entries_find(entries, "drive.rotor-inertia", 0), err,
                          "the rotor turns with one body only where the other is the "
                          "ground\nallowed: a pivot with the ground, or no rotor-inertia");
}

bool check_forces(const Entries *entries, const Scenario *scenario, Err *err)
{
    return check_forces_in_space(entries, &scenario->linkage, err) &&
           check_lines(entries, &scenario->linkage, err) &&
           check_turns(entries, &scenario->linkage, err) &&
           bushings_check(entries, &scenario->linkage, err) &&
           check_motor(entries, &scenario->linkage, err);
}
