// Looks into a step whose contacts the kernel has integrated: samples, records and totals.
#include "drivers/common/within.h"

#include <math.h>

void within_add_contacts(const DriverCase *of, Kernel *kernel, size_t *joints)
{
    size_t contacts = 0;
    for (size_t i = 0; i < of->joint_count; i++) {
        const DriverJoint *joint = &of->joints[i];
        if (joint->kind != DRIVER_PIN_IN_HOLE) {
            continue;
        }
        const KernelContact contact = {.law = joint->law,
                                       .shape = KERNEL_HOLE,
                                       .radial_clearance = joint->clearance,
                                       .hole_radius = joint->clearance,
                                       .joint = (int)i,
                                       .state = joint->contact};
        joints[contacts++] = i;
        kernel_add(kernel, &contact, KERNEL_ROWS_PLAIN);
    }
    if (contacts == 0) {
        driver_refuse("contacts within the step without a pin that has play");
    }
    kernel_make_room(kernel, kernel_rows(kernel));
    kernel_make_drift(kernel);
}

static void make_samples(const WithinStep *step, DriverRun *run)
{
    const Kernel *kernel = step->kernel;
    while (!driver_run_is_full(run) && driver_run_next(run) <= step->start_s + step->step_s) {
        const double since_s = driver_run_next(run) - step->start_s;
        kernel_at(kernel, kernel_node(kernel, since_s), since_s, step->sums);
        step->motions(step->adapter, since_s, step->sums, driver_run_motions(run));
        for (size_t i = 0; i < kernel->contact_count; i++) {
            driver_run_forces(run)[step->joints[i]] =
                (Vec2){step->sums->force[2 * i], step->sums->force[2 * i + 1]};
        }
        driver_run_sampled(run);
    }
}

// A node: what of each contact stands for the part of the step that ends there.
static void look_at(const WithinStep *step, size_t node, double time_s, DriverRun *run)
{
    const Kernel *kernel = step->kernel;
    for (size_t i = 0; i < kernel->contact_count; i++) {
        const size_t joint = step->joints[i];
        DriverTotals *totals = &run->totals[joint];
        ContactState *state = &step->states[joint].state;
        const bool touches = kernel_touches(kernel, node, i);
        const PinHole pose = kernel_pose(kernel, i, node, time_s, step->sums).pose;
        if (touches && !state->is_touching) {
            totals->begun++;
            totals->approach = pose.approach_speed;
        }
        state->is_touching = touches;
        const double *force = kernel_node_forces(kernel, node) + 2 * i;
        const double size = hypot(force[0], force[1]);
        totals->force_max = fmax(totals->force_max, size);
        totals->depth_max = fmax(totals->depth_max, pose.penetration);
        run->touches[joint] =
            (DriverTouch){.eccentricity = pose.eccentricity,
                          .force_max = size,
                          .depth_max = touches ? fmax(pose.penetration, 0.0) : 0.0,
                          .approach = totals->approach};
    }
}

// Records the part from a node to the next.
static void record_part(const WithinStep *step, size_t node, DriverRun *run)
{
    const Kernel *kernel = step->kernel;
    const double start_s = kernel->times[node];
    const double end_s = kernel->times[node + 1];
    const double *before = kernel_node_values(kernel, node);
    const double *after = kernel_node_values(kernel, node + 1);
    for (size_t i = 0; i < kernel->contact_count; i++) {
        run->touches[step->joints[i]].force =
            vec2_scale(1.0 / (end_s - start_s),
                       (Vec2){after[2 * i] - before[2 * i], after[2 * i + 1] - before[2 * i + 1]});
    }
    step->motions(step->adapter, end_s, step->sums, step->room);
    driver_run_record(run, step->start_s + start_s, step->start_s + end_s, step->room,
                      run->touches);
}

void within_look(const WithinStep *step, DriverRun *run)
{
    const Kernel *kernel = step->kernel;
    make_samples(step, run);
    for (size_t node = 0; node < kernel->node_count; node++) {
        const double time_s = kernel->times[node];
        kernel_at(kernel, node, time_s, step->sums);
        look_at(step, node, time_s, run);
        if (node > 0 && run->of->record_s > 0.0 && time_s > kernel->times[node - 1]) {
            record_part(step, node - 1, run);
        }
    }
}
