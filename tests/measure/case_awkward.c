// Mechanisms that stop a solver which takes the ordinary for granted: equal ones side by side,
// whose contacts all change at one instant; those that lock, pass change points, start on the wall,
// or are pulled apart.
#include "case_scene.h"
#include "random_case.h"

enum { EQUAL_LEAST = 2, EQUAL_KINDS = 4 }; // 2 to 5 equal mechanisms

static double draw_playing(Draw *draw)
{
    // a whole number of nanometres, so that what is written is what is meant
    return 1e-9 * round(1e9 * draw_log_between(draw, 5e-6, 2e-4));
}

static void write_contact(Draw *draw, FILE *file)
{
    fprintf(file, "contact: {law: hertz-socket, damping: lankarani-nikravesh, restitution: %.3g}\n",
            draw_between(draw, 0.3, 0.95));
}

static void write_equal(const Scene *scene, const char *title, size_t count, Draw *draw, FILE *file)
{
    char text[80];
    snprintf(text, sizeof text, "%zu equal %s", count, title);
    scene_write(scene, text, file);
    write_contact(draw, file);
    scene_write_run(scene, file);
}

static void write_pendula(uint64_t seed, FILE *file)
{
    Draw draw = draw_start(seed);
    const size_t count = EQUAL_LEAST + seed % EQUAL_KINDS;
    const double length = draw_log_between(&draw, 0.05, 0.5);
    const double angle = draw_chance(&draw, 0.5) ? 0.0 : draw_between(&draw, -M_PI, M_PI);
    const double play = draw_playing(&draw);
    const double apart = draw_between(&draw, 1.0, 3.0) * length;
    const double mass = draw_log_between(&draw, 0.01, 10.0);
    Scene scene = {.length_s = 0.3};
    for (size_t i = 0; i < count; i++) {
        const Point pivot = {apart * (double)i, 0.0};
        const Point end = {pivot.x + length * cos(angle), pivot.y + length * sin(angle)};
        scene_pin(&scene, SCENE_GROUND, scene_link(&scene, pivot, end, mass), pivot, play);
    }
    write_equal(&scene, "pendula, centred and let go", count, &draw, file);
}

static void write_four_bars(uint64_t seed, FILE *file)
{
    Draw draw = draw_start(seed);
    const size_t count = EQUAL_LEAST + seed % EQUAL_KINDS;
    const double size = draw_log_between(&draw, 0.05, 0.3);
    SceneLoop loop = {.ground = size * 2.35,
                      .crank = size,
                      .coupler = size * draw_between(&draw, 2.4, 2.7),
                      .follower = size * draw_between(&draw, 2.3, 2.6),
                      .angle = draw_between(&draw, -M_PI, M_PI),
                      .is_left = draw_chance(&draw, 0.5),
                      .play = draw_playing(&draw)};
    Scene scene = {.length_s = 0.1};
    for (size_t i = 0; i < count; i++) {
        loop.pivot.x = 6.0 * size * (double)i;
        scene_loop(&scene, &loop);
    }
    write_equal(&scene, "four-bars, let go", count, &draw, file);
}

// Whether a crank can turn through every angle.
static bool turns(const SceneLoop *loop)
{
    const double least = fabs(loop->ground - loop->crank);
    const double most = loop->ground + loop->crank;
    return least >= fabs(loop->coupler - loop->follower) && most <= loop->coupler + loop->follower;
}

// The longest way from the follower's end to a point over a turn of the crank.
static double longest_way(const SceneLoop *loop, Point pivot)
{
    double longest = 0.0;
    SceneLoop turned = *loop;
    for (int i = 0; i < 360; i++) {
        Scene scene = {.link_count = 0};
        turned.angle = i * M_PI / 180.0;
        scene_loop(&scene, &turned);
        const Point wrist = scene.pins[2].at;
        longest = fmax(longest, hypot(pivot.x - wrist.x, pivot.y - wrist.y));
    }
    return longest;
}

// A four-bar driven at a link that cannot turn, or a six-bar whose last two links are too short.
static void write_lock(uint64_t seed, FILE *file)
{
    Draw draw = draw_start(seed);
    const bool is_six_bar = seed % 2 == 1;
    Scene scene = {.turns = 1.0, .speed_rpm = draw_log_between(&draw, 30.0, 1000.0)};
    for (bool is_whole = false; !is_whole;) {
        const double size = 0.1;
        scene.link_count = scene.pin_count = 0;
        SceneLoop loop = {.ground = size * draw_between(&draw, 1.0, 4.0),
                          .crank = size,
                          .coupler = size * draw_between(&draw, 0.8, 4.0),
                          .follower = size * draw_between(&draw, 0.8, 4.0),
                          .angle = draw_between(&draw, -M_PI, M_PI),
                          .is_left = true,
                          .play = draw_playing(&draw)};
        if (turns(&loop) != is_six_bar || !scene_loop(&scene, &loop)) {
            continue;
        }
        is_whole = true;
        if (is_six_bar) {
            const Point wrist = scene.pins[2].at;
            const Point pivot = {loop.ground + size * draw_between(&draw, 1.0, 3.0), 0.0};
            const double apart = hypot(pivot.x - wrist.x, pivot.y - wrist.y);
            // two links of half the way between that at the start and the longest one each: the
            // follower pulls them straight
            const double reach = 0.25 * (apart + longest_way(&loop, pivot));
            Point knee = wrist;
            is_whole = longest_way(&loop, pivot) > 1.1 * apart &&
                       draw_meet(wrist, reach, pivot, reach, true, &knee);
            const int first = scene_link(&scene, wrist, knee, 0.1);
            const int second = scene_link(&scene, pivot, knee, 0.1);
            scene_pin(&scene, 2, first, wrist, 0.0);
            scene_pin(&scene, first, second, knee, 0.0);
            scene_pin(&scene, SCENE_GROUND, second, pivot, 0.0);
        }
    }
    scene.speed_rpm *= draw_chance(&draw, 0.5) ? 1.0 : -1.0;
    scene_write(&scene, is_six_bar ? "A six-bar that locks" : "A four-bar that locks", file);
    write_contact(&draw, file);
    scene_write_run(&scene, file);
}

// A parallelogram, an antiparallelogram, a kite, and a parallelogram that only its play lets pass.
static void write_change_point(uint64_t seed, FILE *file)
{
    static const char *const TITLES[] = {"A parallelogram", "An antiparallelogram", "A kite",
                                         "A parallelogram that its play lets pass"};
    Draw draw = draw_start(seed);
    const size_t which = seed % 4;
    const double crank = draw_log_between(&draw, 0.03, 0.2);
    const double ground = crank * draw_between(&draw, 1.5, 3.0);
    const double play = draw_playing(&draw);
    const SceneLoop loop = {
        .ground = which == 2 ? crank : ground,
        .crank = crank,
        .coupler = which == 3 ? ground - 0.3 * play : ground,
        .follower = which == 2 ? ground : crank,
        .angle = draw_between(&draw, 0.5, 2.5),
        // the left of the line from elbow to far pivot: parallel, the right: crossed
        .is_left = which != 1,
        .play = play,
    };
    Scene scene = {.turns = 2.0, .speed_rpm = draw_log_between(&draw, 60.0, 600.0)};
    scene_loop(&scene, &loop);
    scene_write(&scene, TITLES[which], file);
    write_contact(&draw, file);
    scene_write_run(&scene, file);
}

// Independent pins in holes of the ground, all on the wall from the start: at rest on the floor, at
// the ceiling, moving in, out, along, and rolling; the last kinds with a restitution of next to
// nothing.
static void write_touching(uint64_t seed, FILE *file)
{
    Draw draw = draw_start(seed);
    static const double ANGLES[] = {-90.0, 90.0, 180.0, 0.0, 37.0};
    const double play = draw_playing(&draw);
    const double speed = draw_log_between(&draw, 1e-3, 1.0);
    // moving out, in, along to either side, and not at all
    const double turned = 90.0 * (double)(seed % 5);
    Scene scene = {.length_s = 0.1};
    for (size_t i = 0; i < sizeof ANGLES / sizeof *ANGLES; i++) {
        const double angle = ANGLES[i] * M_PI / 180.0;
        const Point at = {0.1 * (double)i, 0.0};
        const int link = scene_link(&scene, at, at, 0.1);
        const int pin = scene_pin(&scene, SCENE_GROUND, link, at, play);
        // on the wall to rounding, and not outside the hole
        scene.pins[pin].start = (Point){(1.0 - 1e-15) * cos(angle), (1.0 - 1e-15) * sin(angle)};
        if (seed % 5 != 4) {
            const double towards = angle + turned * M_PI / 180.0;
            scene.links[link].velocity = (Point){speed * cos(towards), speed * sin(towards)};
        }
    }
    scene_write(&scene, "Pins that start on the wall", file);
    fprintf(file, "contact: {law: hertz-socket, damping: %s, restitution: %s}\n",
            seed % 2 == 0 ? "lankarani-nikravesh" : "flores", seed % 3 == 0 ? "1e-9" : "0.7");
    scene_write_run(&scene, file);
}

// What holds nothing together: a pin pressed through a soft wall, a body without a joint, a link of
// no length, masses that differ by twelve orders.
static void write_separating(uint64_t seed, FILE *file)
{
    static const char *const TITLES[] = {"A pin through a soft wall", "A body without a joint",
                                         "A link without a length", "A mote on a mountain"};
    Draw draw = draw_start(seed);
    const size_t which = seed % 4;
    Scene scene = {.length_s = 0.2};
    const Point pivot = {0.0, 0.0};
    const Point end = {draw_between(&draw, 0.1, 0.3), 0.0};
    const int link = scene_link(&scene, pivot, end, which == 3 ? 1e5 : 1.0);
    scene_pin(&scene, SCENE_GROUND, link, pivot, draw_playing(&draw));
    const Point tip = {which == 2 ? end.x : end.x + 0.1, 0.0};
    const int second = scene_link(&scene, end, tip, which == 3 ? 1e-7 : 0.5);
    if (which == 1) {
        scene.links[second].velocity = (Point){1.0, 2.0};
    } else {
        scene_pin(&scene, link, second, end, draw_playing(&draw));
    }
    if (which == 2) {
        const Point last = {end.x + 0.1, 0.0};
        scene_pin(&scene, second, scene_link(&scene, end, last, 0.5), end, 0.0);
    }
    scene_write(&scene, TITLES[which], file);
    if (which == 0) {
        fprintf(file, "contact: {stiffness: 1000 N/m, damping: none}\n");
    } else {
        write_contact(&draw, file);
    }
    scene_write_run(&scene, file);
}

const CaseKind CASE_PENDULA = {
    .name = "pendula",
    .summary = "2 to 5 equal pendula with equal play, centred and let go",
    .write = write_pendula,
};
const CaseKind CASE_FOUR_BARS = {
    .name = "four-bars",
    .summary = "2 to 5 equal four-bars side by side, let go",
    .write = write_four_bars,
};
const CaseKind CASE_LOCK = {
    .name = "lock",
    .summary = "driven four-bars and six-bars that lock",
    .write = write_lock,
};
const CaseKind CASE_CHANGE_POINT = {
    .name = "change-point",
    .summary = "parallelograms and kites through their change points",
    .write = write_change_point,
};
const CaseKind CASE_TOUCHING = {
    .name = "touching",
    .summary = "pins that start on the wall, moving any way or not at all",
    .write = write_touching,
};
const CaseKind CASE_SEPARATING = {
    .name = "separating",
    .summary = "pins through the wall, loose bodies, links without a length, tiny masses",
    .write = write_separating,
};
