// Do contacts at lines and outside discs do what the closed forms and the balances say?
#include "single_pin.h"

#include "kernel/internal.h"

static const double SHAPES_DURATION_S = 2e-4; // flight, contact of 60 us, and flight again
static const double RADIUS_A = 0.03;          // m
static const double RADIUS_B = 0.02;

static void run_shape(Kernel *kernel)
{
    assert_true(kernel_run(kernel, SHAPES_DURATION_S));
}

// The pin of single_pin.h against a line. Its rows: the gap, and sliding.
static Kernel at_line(ForceLaw law, double friction, double sliding)
{
    Kernel pin = kernel_start(LONE_PIN_PHASE);
    const KernelContact joint = {.law = force_law_with_friction(law, friction, 5e-3),
                                 .shape = KERNEL_LINE};
    kernel_add(&pin, &joint, KERNEL_ROWS_PLAIN);
    kernel_make_room(&pin, pin.row_count);
    pin.mobility[0] = 1.0 / ONE_IMPACT_MASS;
    pin.mobility[3] = 3.0 / ONE_IMPACT_MASS; // a disc, with its turning
    pin.position[0] = LONE_PIN_GAP;
    pin.speed[0] = -ONE_IMPACT_SPEED;
    pin.speed[1] = sliding;
    return pin;
}

// A disc that flies at one that stands still, along x, off the line of centres by a share of the
// sum of radii. Rows: x, y, and the turns of both where there is friction.
static Kernel at_disc(ForceLaw law, double friction, double off)
{
    const double reach = RADIUS_A + RADIUS_B;
    const size_t rows = friction > 0.0 ? KERNEL_ROWS_PLANE : KERNEL_ROWS_PLAIN;
    Kernel pin = kernel_start(LONE_PIN_PHASE);
    const KernelContact joint = {.law = force_law_with_friction(law, friction, 5e-3),
                                 .shape = KERNEL_DISC,
                                 .radial_clearance = -reach,
                                 .hole_radius = -RADIUS_A};
    kernel_add(&pin, &joint, rows);
    kernel_make_room(&pin, pin.row_count);
    for (size_t i = 0; i < rows; i++) {
        pin.mobility[i * rows + i] = 1.0 / ONE_IMPACT_MASS;
    }
    if (friction > 0.0) {
        pin.mobility[10] = 2.0 / (ONE_IMPACT_MASS * RADIUS_A * RADIUS_A);
        pin.mobility[15] = 2.0 / (ONE_IMPACT_MASS * RADIUS_B * RADIUS_B);
    }
    pin.position[0] = -reach * sqrt(1.0 - off * off) - LONE_PIN_GAP;
    pin.position[1] = off * reach;
    pin.speed[0] = ONE_IMPACT_SPEED;
    return pin;
}

static double span_of_contact(const Kernel *kernel)
{
    double begin_s = 0.0;
    double end_s = 0.0;
    for (size_t node = 0; node + 1 < kernel->node_count; node++) {
        if (kernel->times[node + 1] == kernel->times[node]) {
            (kernel_touches_any(kernel, node + 1) ? (begin_s = kernel->times[node])
                                                  : (end_s = kernel->times[node]));
        }
    }
    return end_s - begin_s;
}

static void head_on_all_shapes_are_hertz_closed_form(void **state)
{
    (void)state;
    Kernel pins[2] = {at_line(single_pin_hertz(0.0), 0.0, 0.0),
                      at_disc(single_pin_hertz(0.0), 0.0, 0.0)};
    for (int i = 0; i < 2; i++) {
        run_shape(&pins[i]);
        const PinSums end = single_pin_end(&pins[i]);
        const double pressed = 2.0 * ONE_IMPACT_MASS * ONE_IMPACT_SPEED;
        assert_close(fabs(end.impulse[0]), pressed, 1e-7);
        assert_near(end.impulse[1], 0.0, 1e-15);
        assert_close(span_of_contact(&pins[i]), single_pin_duration(), 1e-7);
        // a line pushes along its normal, the disc back where it came from
        assert_true(i == 0 ? end.impulse[0] > 0.0 : end.impulse[0] < 0.0);
        kernel_finish(&pins[i]);
    }
}

static void damping_gives_back_what_its_closed_form_says(void **state)
{
    (void)state;
    // the last is overdamped: implicit steps
    static const double FACTORS[3] = {0.3, 2.0, 1e3};
    for (int k = 0; k < 3; k++) {
        Kernel pins[2] = {at_line(single_pin_hertz(FACTORS[k]), 0.0, 0.0),
                          at_disc(single_pin_hertz(FACTORS[k]), 0.0, 0.0)};
        for (int i = 0; i < 2; i++) {
            run_shape(&pins[i]);
            const double pressed = fabs(single_pin_end(&pins[i]).impulse[0]);
            const double given = pressed / (ONE_IMPACT_MASS * ONE_IMPACT_SPEED) - 1.0;
            const double left = pins[i].contacts[0].state.is_touching ? 0.0 : 1.0;
            assert_near(given, damping_delivered(FACTORS[k]), left > 0.0 ? 2e-6 : 1e-3);
            kernel_finish(&pins[i]);
        }
    }
}

// A disc that slides on a line stops sliding where 3 mu P / m reaches its speed.
static void a_disc_on_a_line_is_braked_until_it_rolls(void **state)
{
    (void)state;
    int rolling = 0;
    for (double sliding = -0.3; sliding < 0.31; sliding += 0.2) {
        for (double friction = 0.02; friction < 0.7; friction *= 5.0) {
            Kernel pin = at_line(single_pin_hertz(0.3), friction, sliding);
            run_shape(&pin);
            const PinSums end = single_pin_end(&pin);
            const double needed = ONE_IMPACT_MASS / 3.0 * fabs(sliding);
            const double braked = fmin(friction * end.impulse[0], needed);
            // of friction's law near rest: a fifth of the least speed is its own
            const double tolerance = 5e-4 * end.impulse[0];
            assert_near(end.impulse[1], copysign(braked, -sliding), tolerance);
            const double left = fabs(sliding) - 3.0 * braked / ONE_IMPACT_MASS;
            assert_near(end.friction, 0.5 * braked * (fabs(sliding) + left),
                        tolerance * fabs(sliding));
            rolling += braked == needed ? 1 : 0;
            kernel_finish(&pin);
        }
    }
    assert_int_equal(rolling, 6);
}

// Off the line of centres: energy and angular momentum are those before, but for what friction
// took, and the impulse is along the centres without it.
static void discs_that_graze_keep_energy_and_angular_momentum(void **state)
{
    (void)state;
    static const double FRICTION[2] = {0.0, 0.3};
    for (int i = 0; i < 2; i++) {
        Kernel pin = at_disc(single_pin_hertz(0.0), FRICTION[i], 0.6);
        run_shape(&pin);
        const PinSums end = single_pin_end(&pin);
        assert_false(pin.contacts[0].state.is_touching);
        const double vx = ONE_IMPACT_SPEED + end.impulse[0] / ONE_IMPACT_MASS;
        const double vy = end.impulse[1] / ONE_IMPACT_MASS;
        const double turns = i == 0 ? 0.0
                                    : pin.mobility[10] * pow(end.impulse[2], 2.0) +
                                          pin.mobility[15] * pow(end.impulse[3], 2.0);
        const double before = 0.5 * ONE_IMPACT_MASS * ONE_IMPACT_SPEED * ONE_IMPACT_SPEED;
        const double behind = 0.5 * ONE_IMPACT_MASS * (vx * vx + vy * vy) + 0.5 * turns;
        assert_near(behind + end.friction, before, 1e-7 * before);
        assert_int_equal(end.friction > 0.01 * before, i);
        // about the centre of the disc that stands still: force times arm and both turns
        const double x = pin.position[0] + SHAPES_DURATION_S * ONE_IMPACT_SPEED +
                         end.moment[0] / ONE_IMPACT_MASS;
        const double y = pin.position[1] + end.moment[1] / ONE_IMPACT_MASS;
        const double spin = ONE_IMPACT_MASS * (x * vy - y * vx);
        const double first = -ONE_IMPACT_MASS * pin.position[1] * ONE_IMPACT_SPEED;
        const double own = i == 0 ? 0.0 : end.impulse[2] + end.impulse[3];
        assert_near(spin + own, first, 1e-7 * fabs(first));
        // control: without the turns it is another
        assert_int_equal(fabs(spin - first) > 1e-2 * fabs(first), i);
        if (i == 0) {
            // the centres' line turns by a few 1e-4 in the contact
            assert_close(end.impulse[1] / end.impulse[0], -0.6 / 0.8, 1e-3);
        } else {
            // the rims slide: disc b is turned by R_b times what turns disc a by R_a
            assert_close(end.impulse[3] / end.impulse[2], RADIUS_B / RADIUS_A, 1e-3);
        }
        kernel_finish(&pin);
    }
}

// Two corners of one light block that meet a line together: the block does not turn, and each feels
// half its mass.
static void two_corners_at_once_share_the_impact(void **state)
{
    (void)state;
    Kernel pin = kernel_start(LONE_PIN_PHASE);
    for (int i = 0; i < 2; i++) {
        const KernelContact joint = {
            .law = single_pin_hertz(0.0), .shape = KERNEL_LINE, .siblings = {-i, 1 - i}};
        kernel_add(&pin, &joint, KERNEL_ROWS_PLAIN);
    }
    kernel_make_room(&pin, pin.row_count);
    for (int i = 0; i < 2; i++) {
        pin.position[2 * i] = LONE_PIN_GAP;
        pin.speed[2 * i] = -ONE_IMPACT_SPEED;
    }
    // turning is fifty times as easy as moving
    pin.mobility[0] = pin.mobility[10] = 51.0 / ONE_IMPACT_MASS;
    pin.mobility[2] = pin.mobility[8] = -49.0 / ONE_IMPACT_MASS;
    run_shape(&pin);
    const PinSums end = single_pin_end(&pin);
    assert_near(end.impulse[0], end.impulse[2], 1e-15);
    assert_close(end.impulse[0], ONE_IMPACT_MASS * ONE_IMPACT_SPEED, 1e-7);
    // half the mass each: 2 / m of mobility
    assert_close(span_of_contact(&pin), single_pin_duration() * pow(0.5, 0.4), 1e-7);
    kernel_finish(&pin);
}

enum { BALL_PLACES = 100 };

// Balls of equal masses in a row, a gap apart, of which the first flies at the others. Rows of
// balls that do not meet do not move each other.
static Kernel balls_in_a_row(ForceLaw law, double gap, size_t reach)
{
    Kernel pin = kernel_start(LONE_PIN_PHASE);
    for (size_t i = 0; i < BALL_PLACES; i++) {
        const KernelContact joint = {.law = law, .shape = KERNEL_LINE};
        kernel_add(&pin, &joint, KERNEL_ROWS_PLAIN);
    }
    kernel_make_room(&pin, reach);
    for (size_t i = 0; i < BALL_PLACES; i++) {
        const size_t row = KERNEL_ROWS_PLAIN * i;
        *kernel_mobility(&pin, row, row) = 2.0 / ONE_IMPACT_MASS;
        if (i > 0) {
            *kernel_mobility(&pin, row, row - KERNEL_ROWS_PLAIN) = -1.0 / ONE_IMPACT_MASS;
            *kernel_mobility(&pin, row - KERNEL_ROWS_PLAIN, row) = -1.0 / ONE_IMPACT_MASS;
        }
        pin.position[row] = gap;
    }
    pin.speed[0] = -ONE_IMPACT_SPEED;
    return pin;
}

// What the balls have of energy at the end, and what was lost, of what they had.
static double energy_of_balls(const Kernel *balls, size_t *touching)
{
    const size_t last = balls->node_count - 1;
    const double *impulses = kernel_node_values(balls, last);
    const double *moments = impulses + balls->row_count;
    const double time_s = balls->times[last];
    double energy = balls->losses[2 * last];
    for (size_t i = 0; i <= BALL_PLACES; i++) {
        const double before = i > 0 ? impulses[KERNEL_ROWS_PLAIN * (i - 1)] : 0.0;
        const double behind = i < BALL_PLACES ? impulses[KERNEL_ROWS_PLAIN * i] : 0.0;
        const double speed =
            (i == 0 ? ONE_IMPACT_SPEED : 0.0) + (before - behind) / ONE_IMPACT_MASS;
        energy += 0.5 * ONE_IMPACT_MASS * speed * speed;
    }
    for (size_t i = 0; i < BALL_PLACES; i++) {
        const PinHole pose = kernel_motion_pose(balls, i, time_s, impulses, moments);
        energy += force_law_energy(&balls->contacts[i].law, pose.penetration);
        *touching += kernel_touches(balls, last, i) ? 1 : 0;
    }
    return energy / (0.5 * ONE_IMPACT_MASS * ONE_IMPACT_SPEED * ONE_IMPACT_SPEED);
}

// Balls that are in touch and damped so strongly that steps are implicit: many rows at once, with
// mobilities next to the diagonal and with all of them.
static void many_damped_balls_keep_the_balance_of_energy(void **state)
{
    (void)state;
    ForceLaw law = single_pin_hertz(0.0);
    law.viscous = 2e5;
    double ends[2];
    for (int i = 0; i < 2; i++) {
        Kernel balls = balls_in_a_row(law, -1e-9, i == 0 ? KERNEL_ROWS_PLAIN : 2 * BALL_PLACES);
        size_t touching = 0;
        assert_true(kernel_run(&balls, 3e-5));
        assert_non_null(balls.stages);
        const double energy = energy_of_balls(&balls, &touching);
        assert_near(energy, 1.0, 1e-4);
        // control: without what is lost it is not
        const double lost = balls.losses[2 * (balls.node_count - 1)];
        assert_true(lost > 0.1 * 0.5 * ONE_IMPACT_MASS * ONE_IMPACT_SPEED * ONE_IMPACT_SPEED);
        assert_true(touching > 40);
        ends[i] = kernel_node_values(&balls, balls.node_count - 1)[0];
        kernel_finish(&balls);
    }
    assert_true(ends[0] > 0.5 * ONE_IMPACT_MASS * ONE_IMPACT_SPEED);
    assert_close(ends[1], ends[0], 1e-9);
}

// Without damping each gives the next its speed.
static void a_hundred_balls_hand_an_impact_on(void **state)
{
    (void)state;
    enum { PLACES = BALL_PLACES };
    const double gap = 1e-3; // m, many times what they deform
    Kernel pin = balls_in_a_row(single_pin_hertz(0.0), gap, KERNEL_ROWS_PLAIN);
    // each ball has gone half a contact's way when it is let go
    const double contact_s = single_pin_duration() * pow(0.5, 0.4);
    const double next_s = gap / ONE_IMPACT_SPEED + 0.5 * contact_s;
    assert_true(kernel_run(&pin, PLACES * next_s + 0.4 * contact_s));
    const size_t last = pin.node_count - 1;
    const double *impulses = kernel_node_values(&pin, last);
    for (size_t i = 0; i + 1 < PLACES; i++) {
        assert_false(kernel_touches(&pin, last, i));
        assert_close(impulses[KERNEL_ROWS_PLAIN * i], ONE_IMPACT_MASS * ONE_IMPACT_SPEED, 1e-6);
    }
    // the last impact is under way, and no earlier than the law says
    assert_true(kernel_touches(&pin, last, PLACES - 1));
    assert_true(impulses[KERNEL_ROWS_PLAIN * (PLACES - 1)] >
                0.9 * ONE_IMPACT_MASS * ONE_IMPACT_SPEED);
    kernel_finish(&pin);
}

// Contacts that end a rounding apart leave an interval in which differences are rounding.
static void forces_between_nodes_are_no_rounding(void **state)
{
    (void)state;
    Kernel pin = kernel_start(LONE_PIN_PHASE);
    for (int i = 0; i < 2; i++) {
        const KernelContact joint = {.law = single_pin_hertz(0.3), .shape = KERNEL_LINE};
        kernel_add(&pin, &joint, KERNEL_ROWS_PLAIN);
    }
    kernel_make_room(&pin, pin.row_count);
    for (int i = 0; i < 2; i++) {
        pin.mobility[10 * i] = 1.0 / ONE_IMPACT_MASS;
        pin.position[2 * i] = LONE_PIN_GAP * (1.0 + i * 1e-8);
        pin.speed[2 * i] = -ONE_IMPACT_SPEED;
    }
    run_shape(&pin);
    double shortest_s = SHAPES_DURATION_S;
    double strongest = 0.0;
    for (size_t node = 0; node + 1 < pin.node_count; node++) {
        PinSums sums[5];
        const double width_s = pin.times[node + 1] - pin.times[node];
        shortest_s = width_s > 0.0 ? fmin(shortest_s, width_s) : shortest_s;
        for (int i = 0; i < 5; i++) {
            pin_sums_at(&pin, node, pin.times[node] + 0.25 * i * width_s, &sums[i]);
        }
        for (size_t row = 0; row < 4; row += 2) {
            const double most =
                fmax(kernel_node_forces(&pin, node)[row], kernel_node_forces(&pin, node + 1)[row]);
            strongest = fmax(strongest, most);
            for (int i = 0; i < 5; i++) {
                assert_true(fabs(sums[i].force[row]) <= 2.0 * most + 0.1);
            }
        }
    }
    // control: there is such an interval, whose differences of impulses are rounding
    assert_true(shortest_s < 1e-11 && strongest > 1000.0);
    kernel_finish(&pin);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(head_on_all_shapes_are_hertz_closed_form),
        cmocka_unit_test(damping_gives_back_what_its_closed_form_says),
        cmocka_unit_test(a_disc_on_a_line_is_braked_until_it_rolls),
        cmocka_unit_test(discs_that_graze_keep_energy_and_angular_momentum),
        cmocka_unit_test(forces_between_nodes_are_no_rounding),
        cmocka_unit_test(two_corners_at_once_share_the_impact),
        cmocka_unit_test(a_hundred_balls_hand_an_impact_on),
        cmocka_unit_test(many_damped_balls_keep_the_balance_of_energy),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
