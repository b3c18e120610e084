// Integrates the contacts of joints with play within a step of the world.
//
// An active place is one joint of a kernel (kernel/kernel.h), or two: each side of a line
// meets a line of its own, whose gap is s (q - limit), s the side's sign, so that what acts in it
// acts in the place's row times s. The mobility between rows is what the trials gave, and of a line
// with a rotor of inertia J another s s' / J.
//
// Works are found from the poses between the nodes, by Lobatto's rule on four points. The largest
// force and depth are those of the law at such poses, searched for where they lie: a curve through
// forces at uneven distances could be at any height.
#include "world/inside.h"

#include "base/memory.h"
#include "kernel/internal.h"
#include "world/coarse.h"
#include "world/joints.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

static const double LOCAL_PHASE = 0.05; // rad: leaves about 1e-7 of an impact

enum {
    READ_COUNT = 4, // instants of an interval
    HALVINGS = 12,  // of the time in which a depth is largest: leaves 1e-7 of what is left of it
    SECTIONS = 12,  // likewise of a force: a share of 3e-3 of the time leaves 1e-5 of the same
};

static const double GOLDEN = 0.6180339887498949; // (sqrt(5) - 1) / 2

// of the largest force so far: what is below at the instants is not above between them, which are a
// small share of a contact's oscillation apart
static const double WORTH_SEARCHING = 0.5;

static bool has_side(const Place *place, size_t side)
{
    return side < place_side_count(place) && isfinite(place->sides[side].limit);
}

static size_t rows_of_side(const Place *place)
{
    return place->shape == PLACE_LINE ? KERNEL_ROWS_PLAIN : place->row_count;
}

// Calls a function for the active sides, in order, until it says no.
typedef bool (*SideVisit)(WorldResponse *response, const ResponsePlace *of, size_t side,
                          size_t number);

static bool visit_sides(WorldResponse *response, SideVisit visit)
{
    size_t number = 0;
    for (size_t i = 0; i < response->place_count; i++) {
        const ResponsePlace *of = &response->places[i];
        for (size_t k = 0; of->is_active && k < SIDE_COUNT; k++) {
            if (has_side(of->place, k) && !visit(response, of, k, number++)) {
                return false;
            }
        }
    }
    return true;
}

// Whether a side is of the same form as a joint of the kernel.
static bool is_laid_out(WorldResponse *response, const ResponsePlace *of, size_t side,
                        size_t number)
{
    (void)side;
    const Kernel *kernel = response->world->kernel;
    return number < kernel->contact_count &&
           kernel->contacts[number].row_count == rows_of_side(of->place);
}

static bool lay_out(WorldResponse *response, const ResponsePlace *of, size_t side, size_t number)
{
    (void)number;
    kernel_add(response->world->kernel, &of->place->inside[side], rows_of_side(of->place));
    return true;
}

static bool count_side(WorldResponse *response, const ResponsePlace *of, size_t side, size_t number)
{
    (void)side;
    response->side_count = number + 1;
    response->inside_count += rows_of_side(of->place);
    return true;
}

// rows of the kernel up to which their mobility changes in a step: what each of them moves by takes
// twice as long then
enum { FEW_ROWS = 16 };

bool inside_may_drift(WorldResponse *response)
{
    response->inside_count = 0;
    visit_sides(response, count_side);
    return response->is_linear && response->inside_count <= FEW_ROWS;
}

// The world's kernel with a joint for each active side. What it keeps is laid out by its rows.
static Kernel *make_kernel(WorldResponse *response)
{
    JpWorld *world = response->world;
    if (world->kernel == NULL) {
        world->kernel = memory_zeroed(1, sizeof *world->kernel);
    }
    Kernel *kernel = world->kernel;
    const bool may_drift = inside_may_drift(response);
    if (kernel->contact_count != response->side_count || !visit_sides(response, is_laid_out) ||
        (kernel->drift != NULL) != may_drift) {
        kernel_finish(kernel);
        *kernel = kernel_start(LOCAL_PHASE);
        visit_sides(response, lay_out);
        kernel_make_room(kernel, kernel->row_count);
        if (may_drift) {
            kernel_make_drift(kernel);
        }
        if (world->pace.is_set) {
            memcpy(kernel->longest_s, world->pace.longest_s, sizeof kernel->longest_s);
            kernel->duration_before_s = world->pace.duration_before_s;
            kernel->stiff_width_s = world->pace.stiff_width_s;
        }
    }
    world->pace.is_set = false;
    return kernel;
}

// Fills in the rows of a side, of which a line's second moves nothing.
static void fill_rows(WorldResponse *response, const ResponsePlace *of, size_t number, size_t first)
{
    Kernel *kernel = response->world->kernel;
    const Place *place = of->place;
    const Side *side = &place->sides[number];
    const bool is_line = place->shape == PLACE_LINE;
    for (size_t own = 0; own < rows_of_side(place); own++) {
        const size_t row = first + own;
        if (is_line && own > 0) {
            response->inside[row] = 0;
            kernel->position[row] = kernel->speed[row] = kernel->free[row] = 0.0;
            continue;
        }
        const double sign = is_line ? side->sign : 1.0;
        response->inside[row] = of->first_row + own + 1;
        response->signs[row] = sign;
        kernel->speed[row] = sign * place->start_rate[own];
        kernel->free[row] = sign * response->free[of->first_row + own];
        kernel->position[row] = is_line                  ? side_gap(side, place->start[0])
                                : own < PLACE_ROWS_PLANE ? place->start[own]
                                                         : 0.0;
    }
}

// The friction that holds at a place, of the bodies as they are now.
static BristlePair bristle_now(const ResponsePlace *of)
{
    BristlePair bristle = of->place->bristle;
    if (bristle.law == BRISTLE_STICK && bristle.mass == 0.0) {
        bristle.mass = play_mass(of->joint);
    }
    return bristle;
}

// Fills in one side, as the step before left it.
static bool fill_side(WorldResponse *response, const ResponsePlace *of, size_t side, size_t number)
{
    Kernel *kernel = response->world->kernel;
    KernelContact *joint = &kernel->contacts[number];
    const KernelContact laid_out = *joint;
    const Place *place = of->place;
    const Side *from = &place->sides[side];
    *joint = place->inside[side];
    joint->law = force_law_with_friction(from->law, place->friction,
                                         place->friction > 0.0 ? place->friction_speed : 1.0);
    joint->shape = place->shape == PLACE_LINE ? KERNEL_LINE : KERNEL_HOLE;
    joint->radial_clearance = place->clearance;
    joint->hole_radius = place->hole_radius;
    joint->law.bristle = bristle_now(of);
    joint->has_friction = place->friction > 0.0;
    joint->has_bristle = joint->has_friction && joint->law.bristle.law == BRISTLE_STICK;
    kernel->has_bristles = kernel->has_bristles || joint->has_bristle;
    joint->first_row = laid_out.first_row;
    joint->row_count = laid_out.row_count;
    const double age_s = joint->state.age_s; // as the kernel counts it
    joint->state = from->state;
    joint->state.age_s = age_s;
    fill_rows(response, of, side, joint->first_row);
    return true;
}

// The mobility between two rows of the kernel.
static double mobility_between(const WorldResponse *response, size_t i, size_t k)
{
    const size_t n = response->row_count;
    const size_t row = response->inside[i];
    const size_t other = response->inside[k];
    if (row == 0 || other == 0) {
        return 0.0;
    }
    const double there = response->columns[(other - 1) * n + row - 1];
    const double back = response->columns[(row - 1) * n + other - 1];
    const double rotor = row == other ? response->rotors[row - 1] : 0.0;
    return response->signs[i] * response->signs[k] * (0.5 * (there + back) + rotor);
}

static void fill_mobility(WorldResponse *response)
{
    Kernel *kernel = response->world->kernel;
    for (size_t i = 0; i < kernel->row_count; i++) {
        for (size_t k = 0; k < kernel->row_count; k++) {
            *kernel_mobility(kernel, i, k) = mobility_between(response, i, k);
        }
    }
}

// How that mobility changes in the step.
static void fill_drift(WorldResponse *response, double step)
{
    Kernel *kernel = response->world->kernel;
    const size_t rows = kernel->row_count;
    double drift[FEW_ROWS * FEW_ROWS];
    for (size_t i = 0; i < rows; i++) {
        for (size_t k = 0; k < rows; k++) {
            const size_t row = response->inside[i];
            const size_t other = response->inside[k];
            drift[i * rows + k] =
                response->has_rates && row > 0 && other > 0
                    ? response->signs[i] * response->signs[k] *
                          response->drift[(row - 1) * response->row_count + other - 1]
                    : 0.0;
        }
    }
    kernel_set_drift(kernel, drift, step);
}

// Sums what the kernel's rows did by row here.
static void add_totals(WorldResponse *response, double step)
{
    const Kernel *kernel = response->world->kernel;
    const KernelSums *total = &response->sums;
    kernel_at(kernel, kernel->node_count - 1, step, &response->sums);
    memset(response->net, 0, response->row_count * sizeof(double));
    memset(response->moment, 0, 2 * response->row_count * sizeof(double));
    for (size_t i = 0; i < kernel->row_count; i++) {
        if (response->inside[i] > 0) {
            const size_t row = response->inside[i] - 1;
            const double sign = response->signs[i];
            response->net[row] += sign * total->impulse[i];
            response->moment[row] += sign * total->moment[i];
            response->moment[response->row_count + row] +=
                sign * total->moment[kernel->row_count + i];
        }
    }
}

// Numbers of rows above this are out of any use, and what is integrated from them may not end.
static const double LARGEST_NUMBER = 1e50;

static bool are_in_range(const double *numbers, size_t count)
{
    double sum = 0.0;
    for (size_t i = 0; i < count; i++) {
        sum += fabs(numbers[i]);
    }
    return sum <= LARGEST_NUMBER;
}

static bool is_in_range(const Kernel *kernel)
{
    const size_t rows = kernel->row_count;
    return are_in_range(kernel->position, rows) && are_in_range(kernel->speed, rows) &&
           are_in_range(kernel->free, rows) && are_in_range(kernel->mobility, rows * rows);
}

// Of a side between two nodes and a row: read at some instants, with searches now and then.
static const double READING_WORK = 80.0;

// What needs memory: all of it belongs to the world's kernel or to the response.
static bool run(WorldResponse *response, double step)
{
    Kernel *kernel = make_kernel(response);
    kernel->has_bristles = false;
    visit_sides(response, fill_side);
    fill_mobility(response);
    if (kernel->drift != NULL) {
        fill_drift(response, step);
    }
    kernel_sums_free(&response->sums);
    response->sums = kernel_sums(kernel->row_count);
    JpWorld *world = response->world;
    kernel->work_done = 0.0;
    kernel->work_most = world->work_most - world->work;
    bool is_done = kernel->work_most > 0.0 && is_in_range(kernel) && kernel_run(kernel, step);
    const double reading = READING_WORK * (double)kernel->node_count *
                           (double)kernel->contact_count * (double)kernel->row_count;
    world->work += kernel->work_done;
    is_done = is_done && world->work + reading <= world->work_most;
    if (is_done) {
        add_totals(response, step);
    }
    return is_done;
}

// What was under way is of no use, and the next step begins anew.
static JpStatus forget(JpWorld *world, JpError *error)
{
    if (world->kernel != NULL) {
        kernel_finish(world->kernel);
    }
    return refusal(error, JP_ERROR_MEMORY, "there is no memory for the contacts of a step");
}

JpStatus inside_run(WorldResponse *response, double step, bool *is_found, JpError *error)
{
    MemoryGuard guard;
    memory_guard_begin(&guard);
    if (setjmp(guard.left) == 0) {
        *is_found = run(response, step);
        memory_guard_end(&guard);
        return JP_OK;
    }
    memory_guard_end(&guard);
    return forget(response->world, error);
}

// A side at an instant.
typedef struct Instant {
    double time;
    double closing; // rate of the depth
    double force;
    double power;   // W, done by the contact there along its normal
    double slipped; // W, lost in friction there
} Instant;

// A side while what happened to it in the step is read.
typedef struct Reading {
    const Kernel *kernel;
    KernelSums *sums;
    size_t number; // of its joint there
    Side *side;
    double impulse;
    double slid; // J
} Reading;

// What friction takes: what all rows take less what the normal does.
static double slipping_power(const Reading *reading, double time, double normal)
{
    const KernelContact *joint = &reading->kernel->contacts[reading->number];
    double power = 0.0;
    for (size_t i = 0; joint->has_friction && i < joint->row_count; i++) {
        const size_t row = joint->first_row + i;
        power += reading->sums->force[row] * kernel_motion_speed(reading->kernel, row, time,
                                                                 reading->sums->impulse,
                                                                 reading->sums->moment);
    }
    return joint->has_friction ? normal - power : 0.0;
}

// How the side is at a time behind a node, by its law; a damper presses from the first touch on, at
// no depth yet. What is found is noted, so that no peak is above the law's force.
static Instant read_at(Reading *reading, size_t node, double time)
{
    Side *side = reading->side;
    kernel_at(reading->kernel, node, time, reading->sums);
    const PinHole pose =
        kernel_pose(reading->kernel, reading->number, node, time, reading->sums).pose;
    side->inside = fmax(pose.penetration, 0.0);
    Instant at = {.time = time, .closing = pose.approach_speed};
    at.force = force_law_force(&side->law, fmax(side->inside, DBL_MIN), at.closing,
                               side->state.damping_speed);
    at.power = -at.force * at.closing;
    side_note(side, at.force);
    side->step_force = fmax(side->step_force, at.force);
    return at;
}

// The same with what friction takes.
static Instant read_powers(Reading *reading, size_t node, double time)
{
    Instant at = read_at(reading, node, time);
    at.slipped = slipping_power(reading, time, at.power);
    return at;
}

// The depth is largest where its rate changes its sign.
static void search_depth(Reading *reading, size_t node, double first, double last)
{
    for (int i = 0; i < HALVINGS; i++) {
        const double middle = first + 0.5 * (last - first);
        if (read_at(reading, node, middle).closing > 0.0) {
            first = middle;
        } else {
            last = middle;
        }
    }
}

// Golden section, between the neighbours of the largest force that was read.
static void search_force(Reading *reading, size_t node, double first, double last)
{
    double low = last - GOLDEN * (last - first);
    double high = first + GOLDEN * (last - first);
    double low_force = read_at(reading, node, low).force;
    double high_force = read_at(reading, node, high).force;
    for (int i = 0; i < SECTIONS; i++) {
        if (low_force < high_force) {
            first = low;
            low = high;
            low_force = high_force;
            high = first + GOLDEN * (last - first);
            high_force = read_at(reading, node, high).force;
        } else {
            last = high;
            high = low;
            high_force = low_force;
            low = last - GOLDEN * (last - first);
            low_force = read_at(reading, node, low).force;
        }
    }
}

// Looks between the instants of an interval for what is larger than at them.
static void search_peaks(Reading *reading, size_t node, const Instant at[READ_COUNT])
{
    size_t largest = 0;
    for (size_t i = 1; i < READ_COUNT; i++) {
        if (at[i - 1].closing > 0.0 && at[i].closing <= 0.0) {
            search_depth(reading, node, at[i - 1].time, at[i].time);
        }
        largest = at[i].force > at[largest].force ? i : largest;
    }
    if (at[largest].force > WORTH_SEARCHING * reading->side->force_max) {
        const size_t after = largest + 1 < READ_COUNT ? largest + 1 : largest;
        search_force(reading, node, at[largest > 0 ? largest - 1 : 0].time, at[after].time);
    }
}

// Adds what a side did between a node and the next. Between nodes so near to each other that
// others' events make them, rounding in the motion could be all there is: then only they are read.
static void read_interval(Reading *reading, size_t node)
{
    static const double SHARES[READ_COUNT] = {0.0, 0.27639320225002103, 0.72360679774997897, 1.0};
    static const double WEIGHTS[READ_COUNT] = {1.0 / 12.0, 5.0 / 12.0, 5.0 / 12.0, 1.0 / 12.0};
    static const double ENDS[READ_COUNT] = {0.5, 0.0, 0.0, 0.5};
    const Kernel *kernel = reading->kernel;
    const double start = kernel->times[node];
    const double width = kernel->times[node + 1] - start;
    const bool is_short = width < KERNEL_LINEAR_WIDTH * kernel->times[kernel->node_count - 1];
    const double *weights = is_short ? ENDS : WEIGHTS;
    Instant at[READ_COUNT];
    double work = 0.0;
    for (int i = 0; i < READ_COUNT; i++) {
        if (weights[i] == 0.0) {
            continue;
        }
        const bool is_last = i + 1 == READ_COUNT;
        at[i] = read_powers(reading, is_last ? node + 1 : node, start + SHARES[i] * width);
        reading->impulse += width * weights[i] * at[i].force;
        reading->slid += width * weights[i] * at[i].slipped;
        work += weights[i] * at[i].power;
    }
    reading->side->work += width * work;
    if (!is_short) {
        search_peaks(reading, node, at);
    }
}

static void read_side(Reading *reading)
{
    const Kernel *kernel = reading->kernel;
    Side *side = reading->side;
    for (size_t node = 0; node < kernel->node_count; node++) {
        const double start = kernel->times[node];
        const bool was_touching = side->state.is_touching;
        side->state.is_touching = kernel_touches(kernel, node, reading->number);
        if (side->state.is_touching && !was_touching) {
            // the very speed by which the contact was damped
            side_begin(side, kernel->closings[node * kernel->contact_count + reading->number]);
        }
        if (side->state.is_touching && node + 1 < kernel->node_count &&
            kernel->times[node + 1] > start) {
            read_interval(reading, node);
        }
    }
}

// A side of a place, from its joint in the kernel.
static bool book_side(WorldResponse *response, const ResponsePlace *of, size_t number, size_t joint)
{
    const Kernel *kernel = response->world->kernel;
    Side *side = &of->place->sides[number];
    KernelSums *sums = &response->sums;
    Reading reading = {.kernel = kernel, .sums = sums, .number = joint, .side = side};
    of->place->inside[number] = kernel->contacts[joint];
    side->step_force = 0.0;
    read_side(&reading);
    if (side->state.is_touching) {
        side->state = kernel->contacts[joint].state;
    }
    if (of->place->shape == PLACE_LINE) {
        // to rounding
        const double end = kernel->times[kernel->node_count - 1];
        kernel_at(kernel, kernel->node_count - 1, end, sums);
        reading.impulse = sums->impulse[kernel->contacts[joint].first_row];
    }
    of->place->slid += reading.slid;
    side->impulse += reading.impulse;
    side->force = fmax(reading.impulse, 0.0) / response->step; // rounding may be below 0
    side->share = 1.0;
    return true;
}

void inside_book(WorldResponse *response)
{
    for (size_t i = 0; i < response->place_count; i++) {
        const ResponsePlace *of = &response->places[i];
        for (size_t k = 0; !of->is_active && k < SIDE_COUNT; k++) {
            of->place->sides[k].force = 0.0;
            of->place->sides[k].state.is_touching = false;
        }
    }
    visit_sides(response, book_side);
}

// What a contact's force may be wrong by at the step's end, of the largest in the step, or of a
// quarter of the largest that the side has seen: in a chain of three pins whose steps are all
// within this the largest force is right to some percent, and with twice as much it was wrong by a
// half.
static const double FORCE_SHARE = 0.01;
static const double FORCE_SEEN = 0.25;

static Vec3 axis_of_row(const Direction *row)
{
    return (Vec3){row->axis[0], row->axis[1], row->axis[2]};
}

// How far a side is from where its contacts have brought it, along its first rows, m and m/s: what
// the world's response changes within the step.
static void find_drift(const WorldResponse *response, const ResponsePlace *of, size_t number,
                       double end, double drift[2])
{
    const Kernel *kernel = response->world->kernel;
    const Place *place = of->place;
    const size_t row = kernel->contacts[number].first_row;
    const PinHole pose =
        kernel_pose(kernel, number, kernel->node_count - 1, end, &response->sums).pose;
    double at[2];
    double rate[2];
    joints_now(of->joint, place, at, rate);
    drift[0] = drift[1] = 0.0;
    for (size_t i = 0; i < (place->shape == PLACE_LINE ? 1 : PLACE_ROWS_PLANE); i++) {
        const bool is_line = place->shape == PLACE_LINE;
        const double before = response->is_closed ? place->start[i]
                              : is_line           ? place->line_before
                                        : vec3_dot(axis_of_row(&place->rows[i]), place->offset);
        const double moved =
            is_line ? response->signs[row] * (-pose.penetration - kernel->position[row])
                    : (i == 0 ? pose.eccentricity.x : pose.eccentricity.y) - place->start[i];
        const double speed = response->signs[row + i] * kernel_motion_speed(kernel, row + i, end,
                                                                            response->sums.impulse,
                                                                            response->sums.moment);
        drift[0] = hypot(drift[0], at[i] - before - moved);
        drift[1] = hypot(drift[1], rate[i] - speed);
    }
}

static bool judge_side(WorldResponse *response, const ResponsePlace *of, size_t side, size_t number)
{
    JpWorld *world = response->world;
    const Kernel *kernel = world->kernel;
    const KernelContact *joint = &kernel->contacts[number];
    const Side *judged = &of->place->sides[side];
    if (judged->step_force == 0.0) {
        return true;
    }
    const size_t last = kernel->node_count - 1;
    const double end = kernel->times[last];
    double drift[2];
    kernel_at(kernel, last, end, &response->sums);
    find_drift(response, of, number, end, drift);
    const double slope =
        judged->state.is_touching ? force_law_tangent(&judged->law, judged->inside) : 0.0;
    const double wrong = slope * drift[0] + joint->force_per_speed * drift[1];
    const double force = fmax(judged->step_force, FORCE_SEEN * judged->force_max);
    if (!(wrong <= FORCE_SHARE * force)) {
        coarse_note(world,
                    "bodies turn too far in the step of %g s for the contacts in it: a force is "
                    "uncertain by %.2g of %.2g",
                    response->step, wrong, force);
    }
    return true;
}

void inside_judge(WorldResponse *response)
{
    visit_sides(response, judge_side);
}
