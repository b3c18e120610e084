// A mechanism of any number of equal parts, as a case: how do time and memory grow with it?
//
// growing_case KIND N [SEED [CLEARANCE_UM]] > case.yaml
//   chain      an open chain of N links that hangs on a pivot
//   pendula    N pendulums side by side, independent of one another
//   four-bars  N four-bars in a row; neighbours share an upright
//   separate   N four-bars side by side, independent of one another
//   scissors   a scissor linkage of N crossed pairs of bars, one foot of which is pinned
// All links are 1 m long and of 1 kg; the seed draws the angles at which they start, at rest. With
// a clearance all joints have play. The same numbers give the same case on every machine.
#include "random_draw.h"

#include <stdlib.h>
#include <string.h>

static const double INERTIA = 1.0 / 12.0; // kg m^2, of a uniform bar

typedef struct Case {
    size_t count;
    Draw draw;
    double clearance_um; // 0: ideal
} Case;

static void write_body(const char *kind, size_t number, Point middle, double angle)
{
    printf("  %s-%zu: {mass: 1 kg, inertia: %.17g kg m^2, at: [%.17g m, %.17g m], "
           "angle: %.17g rad}\n",
           kind, number, INERTIA, middle.x, middle.y, angle);
}

static void write_joint(const Case *made, const char *name, size_t number, const char *between,
                        Point at)
{
    printf("  %s-%zu: {between: [%s], at: [%.17g m, %.17g m]", name, number, between, at.x, at.y);
    if (made->clearance_um > 0.0) {
        printf(", radial-clearance: %.17g um, pin: 10 mm", made->clearance_um);
    }
    printf("}\n");
}

static Point along(Point from, double angle, double length)
{
    return (Point){from.x + length * cos(angle), from.y + length * sin(angle)};
}

// A half turn is more than an angle may be; hanging is a quarter turn clockwise.
static double hanging(Draw *draw)
{
    return -0.5 * M_PI + draw_between(draw, -0.3, 0.3);
}

static void write_chain(Case *made)
{
    const Case start = *made;
    Point end = {0.0, 0.0};
    printf("bodies:\n");
    for (size_t i = 0; i < made->count; i++) {
        const double angle = hanging(&made->draw);
        write_body("link", i, along(end, angle, 0.5), angle);
        end = along(end, angle, 1.0);
    }
    made->draw = start.draw;
    end = (Point){0.0, 0.0};
    printf("joints:\n");
    for (size_t i = 0; i < made->count; i++) {
        char between[64];
        snprintf(between, sizeof between, i == 0 ? "ground, link-0" : "link-%zu, link-%zu",
                 i == 0 ? 0 : i - 1, i);
        write_joint(made, "pin", i, between, end);
        end = along(end, hanging(&made->draw), 1.0);
    }
}

static void write_pendula(Case *made)
{
    printf("bodies:\n");
    for (size_t i = 0; i < made->count; i++) {
        const double angle = hanging(&made->draw);
        write_body("link", i, along((Point){0.1 * (double)i, 0.0}, angle, 0.5), angle);
    }
    printf("joints:\n");
    for (size_t i = 0; i < made->count; i++) {
        char between[64];
        snprintf(between, sizeof between, "ground, link-%zu", i);
        write_joint(made, "pin", i, between, (Point){0.1 * (double)i, 0.0});
    }
}

static void write_four_bars(Case *made)
{
    const double angle = 0.5 * M_PI + draw_between(&made->draw, -0.3, 0.3);
    const Point top = along((Point){0.0, 0.0}, angle, 1.0);
    printf("bodies:\n");
    for (size_t i = 0; i <= made->count; i++) {
        write_body("upright", i, along((Point){(double)i, 0.0}, angle, 0.5), angle);
        if (i < made->count) {
            write_body("coupler", i, (Point){(double)i + top.x + 0.5, top.y}, 0.0);
        }
    }
    printf("joints:\n");
    for (size_t i = 0; i <= made->count; i++) {
        char between[64];
        snprintf(between, sizeof between, "ground, upright-%zu", i);
        write_joint(made, "foot", i, between, (Point){(double)i, 0.0});
        if (i < made->count) {
            snprintf(between, sizeof between, "upright-%zu, coupler-%zu", i, i);
            write_joint(made, "left", i, between, (Point){(double)i + top.x, top.y});
            snprintf(between, sizeof between, "coupler-%zu, upright-%zu", i, i + 1);
            write_joint(made, "right", i, between, (Point){(double)i + 1.0 + top.x, top.y});
        }
    }
}

static void write_separate(Case *made)
{
    const Case start = *made;
    printf("bodies:\n");
    for (size_t i = 0; i < made->count; i++) {
        const double angle = 0.5 * M_PI + draw_between(&made->draw, -0.3, 0.3);
        const Point left = along((Point){2.0 * (double)i, 0.0}, angle, 0.5);
        const Point top = along(left, angle, 0.5);
        write_body("left", i, left, angle);
        write_body("right", i, (Point){left.x + 1.0, left.y}, angle);
        write_body("coupler", i, (Point){top.x + 0.5, top.y}, 0.0);
    }
    made->draw = start.draw;
    printf("joints:\n");
    for (size_t i = 0; i < made->count; i++) {
        const double angle = 0.5 * M_PI + draw_between(&made->draw, -0.3, 0.3);
        const Point foot = {2.0 * (double)i, 0.0};
        const Point top = along(foot, angle, 1.0);
        char between[64];
        snprintf(between, sizeof between, "ground, left-%zu", i);
        write_joint(made, "left-foot", i, between, foot);
        snprintf(between, sizeof between, "ground, right-%zu", i);
        write_joint(made, "right-foot", i, between, (Point){foot.x + 1.0, 0.0});
        snprintf(between, sizeof between, "left-%zu, coupler-%zu", i, i);
        write_joint(made, "left-pin", i, between, top);
        snprintf(between, sizeof between, "coupler-%zu, right-%zu", i, i);
        write_joint(made, "right-pin", i, between, (Point){top.x + 1.0, top.y});
    }
}

static void write_scissors(Case *made)
{
    const double angle = 0.25 * M_PI + draw_between(&made->draw, -0.2, 0.2);
    const double width = cos(angle);
    const double height = sin(angle);
    printf("bodies:\n");
    for (size_t i = 0; i < made->count; i++) {
        const Point middle = {0.5 * width, ((double)i + 0.5) * height};
        write_body("rising", i, middle, angle);
        write_body("falling", i, middle, -angle);
    }
    printf("joints:\n");
    write_joint(made, "foot", 0, "ground, rising-0", (Point){0.0, 0.0});
    for (size_t i = 0; i < made->count; i++) {
        char between[64];
        snprintf(between, sizeof between, "rising-%zu, falling-%zu", i, i);
        write_joint(made, "cross", i, between, (Point){0.5 * width, ((double)i + 0.5) * height});
        if (i + 1 < made->count) {
            const double top = ((double)i + 1.0) * height;
            snprintf(between, sizeof between, "rising-%zu, falling-%zu", i, i + 1);
            write_joint(made, "right", i, between, (Point){width, top});
            snprintf(between, sizeof between, "falling-%zu, rising-%zu", i, i + 1);
            write_joint(made, "left", i, between, (Point){0.0, top});
        }
    }
}

typedef struct Kind {
    const char *name;
    void (*write)(Case *made);
} Kind;

static const Kind KINDS[] = {
    {"chain", write_chain},       {"pendula", write_pendula},   {"four-bars", write_four_bars},
    {"separate", write_separate}, {"scissors", write_scissors},
};

int main(int argc, char **argv)
{
    const size_t count = argc > 2 ? strtoul(argv[2], NULL, 10) : 0;
    for (size_t i = 0; count > 0 && i < sizeof KINDS / sizeof *KINDS; i++) {
        if (strcmp(argv[1], KINDS[i].name) == 0) {
            Case made = {
                .count = count,
                .draw = draw_start(argc > 3 ? strtoull(argv[3], NULL, 10) : 1),
                .clearance_um = argc > 4 ? strtod(argv[4], NULL) : 0.0,
            };
            printf("title: %s, N = %zu\n", KINDS[i].name, count);
            KINDS[i].write(&made);
            printf("gravity: 9.81 m/s^2\n");
            if (made.clearance_um > 0.0) {
                printf("contact: {stiffness: 1e8 N/m^1.5, restitution: 0.6}\n");
            }
            printf("run: {duration: 50 ms, samples: 10, step: 0.5 ms}\n");
            return 0;
        }
    }
    fprintf(stderr, "usage: growing_case chain|pendula|four-bars|separate|scissors N [SEED "
                    "[CLEARANCE_UM]]\n");
    return 2;
}
