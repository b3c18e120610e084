#include "random_draw.h"

#include "base/lcg.h"
#include "model/options.h"

// the first draws of neighbouring seeds are alike
enum { STIR = 8 };

Draw draw_start(uint64_t seed)
{
    Draw draw = {seed * 2654435761u + 1u};
    for (int i = 0; i < STIR; i++) {
        lcg_draw(&draw.state);
    }
    return draw;
}

double draw_between(Draw *draw, double low, double high)
{
    return low + (high - low) * 0.5 * (1.0 + lcg_draw(&draw->state));
}

double draw_log_between(Draw *draw, double low, double high)
{
    return exp(draw_between(draw, log(low), log(high)));
}

size_t draw_below(Draw *draw, size_t count)
{
    const size_t drawn = (size_t)draw_between(draw, 0.0, (double)count);
    return drawn < count ? drawn : count - 1;
}

bool draw_chance(Draw *draw, double probability)
{
    return draw_between(draw, 0.0, 1.0) < probability;
}

void draw_play(Draw *draw, FILE *file)
{
    const double clearance_um = draw_log_between(draw, 1.0, 500.0);
    fprintf(file, "radial-clearance: %.9g um, pin: 10 mm, width: %.4g mm", clearance_um,
            draw_between(draw, 5.0, 30.0));
    if (draw_chance(draw, 0.3)) {
        // a little less than the play: rounding of the text must not put the pin into the wall
        const double share = draw_chance(draw, 0.3) ? 0.9999999 : draw_between(draw, 0.0, 0.99);
        const double angle = draw_between(draw, 0.0, 2.0 * M_PI);
        fprintf(file, ", start: [%.9g um, %.9g um]", share * clearance_um * cos(angle),
                share * clearance_um * sin(angle));
    }
}

// The word of a member of a list of alternatives.
#define DRAW_WORD(id, word, ...) word,

static void write_stiffness(Draw *draw, FILE *file)
{
    static const char *const LAWS[] = {OPTIONS_LAW_LIST(DRAW_WORD)};
    const size_t which = draw_below(draw, LAW_COUNT + 2);
    if (which < LAW_COUNT) {
        fprintf(file, "law: %s", LAWS[which]);
    } else if (which == LAW_COUNT) {
        fprintf(file, "stiffness: %.4g N/m^1.5", draw_log_between(draw, 1e9, 1e12));
    } else {
        fprintf(file, "stiffness: %.4g N/m", draw_log_between(draw, 1e7, 1e9));
    }
}

void draw_contact(Draw *draw, FILE *file)
{
    static const char *const DAMPINGS[] = {OPTIONS_DAMPING_LIST(DRAW_WORD)};
    const size_t damping = draw_below(draw, DAMPING_DISSIPATION); // the others lose by speed
    fprintf(file, "contact: {");
    write_stiffness(draw, file);
    fprintf(file, ", damping: %s, restitution: %.3g", DAMPINGS[damping],
            draw_between(draw, 0.2, 0.98));
    if (damping == DAMPING_VISCOUS) {
        fprintf(file, ", viscous-coefficient: %.4g N s/m", draw_log_between(draw, 10.0, 1e3));
    }
    const bool has_friction = draw_chance(draw, 0.4);
    fprintf(file, ", friction: %.3g}\n", has_friction ? draw_between(draw, 0.01, 0.3) : 0.0);
}

void draw_run(Draw *draw, const char *length, FILE *file)
{
    fprintf(file, "gravity: %s\n", draw_chance(draw, 0.15) ? "0 m/s^2" : "9.80665 m/s^2");
    fprintf(file, "run: {%s, samples: 720, step: auto, tolerance: 1e-4, ", length);
    fprintf(file, "backends: [reference, ode]}\n");
}

double draw_speed_rpm(Draw *draw)
{
    const double speed = draw_log_between(draw, 30.0, 3000.0);
    return draw_chance(draw, 0.5) ? speed : -speed;
}

bool draw_meet(Point a, double from_a, Point b, double from_b, bool is_left, Point *met)
{
    const double dx = b.x - a.x;
    const double dy = b.y - a.y;
    const double apart = hypot(dx, dy);
    const double along = (apart * apart + from_a * from_a - from_b * from_b) / (2.0 * apart);
    const double square = from_a * from_a - along * along;
    if (!(square > 0.0)) {
        return false;
    }
    const double aside = is_left ? sqrt(square) : -sqrt(square);
    met->x = a.x + (along * dx - aside * dy) / apart;
    met->y = a.y + (along * dy + aside * dx) / apart;
    return true;
}
