// Of which order is a step beside ODE's own contacts with friction, and how often does it fall
// back? Prints the tables of docs/library.md.
//
// A cart (tests/support/cart.h) that rests throughout, slides one way throughout, or is knocked
// loose and comes to rest again, against its equations of motion: root mean squares over starts.
// ODE alone, whose box is pushed by a force that sets in at a step's start or within a step,
// against the closed form. A box that its load presses onto three corners
// (tests/support/pressed_base.h), with and without ODE's surface layer, against rows at two fine
// steps, extrapolated.
#include "cart.h"
#include "pressed_base.h"
#include "pushed_box.h"

#include <math.h>
#include <ode/ode.h>
#include <stdio.h>

enum { HALVINGS = 7 };

static const double LONGEST_S = 4e-3;

typedef struct Regime {
    const char *name;
    CartOptions options;
} Regime;

static const Regime REGIMES[] = {
    {"rests", {.mass = 30, .friction = 0.8, .restitution = 0.8, .duration = 0.4}},
    {"slides one way", {20, 0.1, 2.0, 0.0, 0.8, 0.4}},
    {"knocked loose, stops without damper", {20, 0.1, 0.0, 0.0, 1.0, 0.4}},
    {"knocked loose, stops give back .8", {20, 0.1, 0.0, 0.0, 0.8, 0.4}},
};

enum { ORDER_SIZE = 16 };

// The order from an error at twice the step; of the first step, which has none, a dash.
static void print_order(double coarse, double fine, char *words)
{
    if (isfinite(coarse)) {
        snprintf(words, ORDER_SIZE, "%.1f", log2(coarse / fine));
    } else {
        snprintf(words, ORDER_SIZE, "-");
    }
}

// Not known where the library refuses a start.
static CartErrors measure_cart(const CartOptions *cart, JpStepping stepping, double step)
{
    CartErrors errors;
    JpError error;
    if (!cart_errors(*cart, stepping, step, &errors, &error)) {
        fprintf(stderr, "%s\n", error.text);
        errors = (CartErrors){.position = NAN, .angle = NAN};
    }
    return errors;
}

static void print_cart(const Regime *regime)
{
    printf("\n%s\n\n", regime->name);
    printf("| step, ms | box, m | order | arm, rad | order | world steps a step | fallbacks | "
           "steps | arm by rows, rad |\n|---|---|---|---|---|---|---|---|---|\n");
    CartErrors before = {.position = NAN, .angle = NAN};
    for (int i = 0; i <= HALVINGS; i++) {
        const double step = LONGEST_S / (1 << i);
        const CartErrors now = measure_cart(&regime->options, JP_STEPPING_IMPULSE, step);
        const CartErrors rows = measure_cart(&regime->options, JP_STEPPING_STAGGERED, step);
        char orders[2][ORDER_SIZE];
        print_order(before.position, now.position, orders[0]);
        print_order(before.angle, now.angle, orders[1]);
        printf("| %.4g | %.1e | %s | %.1e | %s | %.2f | %zu | %zu | %.1e |\n", 1e3 * step,
               now.position, orders[0], now.angle, orders[1],
               (double)now.stats.world_steps / (double)now.stats.steps, now.stats.fallbacks,
               now.stats.steps, rows.angle);
        before = now;
    }
    printf("changes of friction in all starts: %d\n", before.changes);
}

static void print_pushed(void)
{
    printf("\nODE alone, a box pushed by a force\n\n");
    printf("| step, ms | from a step's start on, m | from 3/4 of a step on, m | order |\n"
           "|---|---|---|---|\n");
    double before = NAN;
    for (int i = 0; i <= HALVINGS; i++) {
        const double step = LONGEST_S / (1 << i);
        const double within = pushed_box_error(step, 0.02 + 0.75 * step);
        char words[ORDER_SIZE];
        print_order(before, within, words);
        printf("| %.4g | %.1e | %.1e | %s |\n", 1e3 * step, pushed_box_error(step, 0.02), within,
               words);
        before = within;
    }
}

static PressedBase press(JpStepping stepping, double layer, double step)
{
    PressedBase end = {.position = {{NAN}}};
    JpError error;
    if (!pressed_base_run(stepping, layer, step, 0.04, &end, &error)) {
        fprintf(stderr, "%s\n", error.text);
    }
    return end;
}

static void print_pressed(void)
{
    static const double LAYERS[2] = {1e-4, 0.0};
    // order 1 by rows
    PressedBase truth = press(JP_STEPPING_STAGGERED, LAYERS[0], 0.5e-6);
    const PressedBase half = press(JP_STEPPING_STAGGERED, LAYERS[0], 1e-6);
    for (int i = 0; i < 6; i++) {
        truth.position[i / 3][i % 3] += truth.position[i / 3][i % 3] - half.position[i / 3][i % 3];
    }
    printf("\na box pressed onto three corners\n\n");
    printf("| step, us | layer 1e-4 m, m | contacts | world steps a step | fallbacks | "
           "no layer, m | contacts | world steps a step | fallbacks | no layer, by rows, m |\n"
           "|---|---|---|---|---|---|---|---|---|---|\n");
    for (double step = 400e-6; step > 5e-6; step *= 0.5) {
        printf("| %.4g ", 1e6 * step);
        for (int i = 0; i < 2; i++) {
            const PressedBase end = press(JP_STEPPING_IMPULSE, LAYERS[i], step);
            printf("| %.1e | %.2f | %.1f | %zu ", pressed_base_apart(&end, &truth), end.contacts,
                   (double)end.stats.world_steps / (double)end.stats.steps, end.stats.fallbacks);
        }
        const PressedBase rows = press(JP_STEPPING_STAGGERED, LAYERS[1], step);
        printf("| %.1e |\n", pressed_base_apart(&rows, &truth));
    }
}

int main(void)
{
    dInitODE2(0);
    for (size_t i = 0; i < sizeof REGIMES / sizeof *REGIMES; i++) {
        print_cart(&REGIMES[i]);
    }
    print_pushed();
    print_pressed();
    dCloseODE();
    return 0;
}
