// How does a scene become a case?
#include "case_scene.h"

int scene_link(Scene *scene, Point from, Point to, double mass)
{
    scene->links[scene->link_count] = (SceneLink){.ends = {from, to}, .mass = mass};
    return (int)scene->link_count++;
}

int scene_pin(Scene *scene, int link_a, int link_b, Point at, double play)
{
    scene->pins[scene->pin_count] =
        (ScenePin){.link_a = link_a, .link_b = link_b, .at = at, .play = play};
    return (int)scene->pin_count++;
}

bool scene_loop(Scene *scene, const SceneLoop *loop)
{
    const Point far = {loop->pivot.x + loop->ground, loop->pivot.y};
    const Point elbow = {loop->pivot.x + loop->crank * cos(loop->angle),
                         loop->pivot.y + loop->crank * sin(loop->angle)};
    Point wrist;
    if (!draw_meet(elbow, loop->coupler, far, loop->follower, loop->is_left, &wrist)) {
        return false;
    }
    const int crank = scene_link(scene, loop->pivot, elbow, loop->crank);
    const int coupler = scene_link(scene, elbow, wrist, loop->coupler);
    const int follower = scene_link(scene, far, wrist, loop->follower);
    scene_pin(scene, SCENE_GROUND, crank, loop->pivot, 0.0);
    scene_pin(scene, crank, coupler, elbow, loop->play);
    scene_pin(scene, coupler, follower, wrist, 0.0);
    scene_pin(scene, SCENE_GROUND, follower, far, 0.0);
    return true;
}

static void write_link(const SceneLink *link, size_t number, FILE *file)
{
    const Point along = {link->ends[1].x - link->ends[0].x, link->ends[1].y - link->ends[0].y};
    const double length = fmax(hypot(along.x, along.y), 0.02);
    fprintf(file, "  link-%zu: {mass: %.9g kg, inertia: %.9g kg mm^2, at: [%.15g m, %.15g m], ",
            number, link->mass, 1e6 * link->mass * length * length / 12.0,
            0.5 * (link->ends[0].x + link->ends[1].x), 0.5 * (link->ends[0].y + link->ends[1].y));
    fprintf(file, "angle: %.12g deg", atan2(along.y, along.x) * 180.0 / M_PI);
    if (link->velocity.x != 0.0 || link->velocity.y != 0.0 || link->spin != 0.0) {
        fprintf(file, ", velocity: [%.15g m/s, %.15g m/s], spin: %.15g rad/s", link->velocity.x,
                link->velocity.y, link->spin);
    }
    fprintf(file, "}\n");
}

static void write_pin(const ScenePin *pin, size_t number, FILE *file)
{
    fprintf(file, "  pin-%zu: {between: [", number);
    if (pin->link_a == SCENE_GROUND) {
        fprintf(file, "ground");
    } else {
        fprintf(file, "link-%d", pin->link_a);
    }
    fprintf(file, ", link-%d], at: [%.15g m, %.15g m]", pin->link_b, pin->at.x, pin->at.y);
    if (pin->play > 0.0) {
        fprintf(file, ", radial-clearance: %.9g um, pin: 10 mm, width: 10 mm", 1e6 * pin->play);
    }
    if (pin->start.x != 0.0 || pin->start.y != 0.0) {
        // every digit counts: on the wall is not near it
        fprintf(file, ", start: [%.17g um, %.17g um]", 1e6 * pin->play * pin->start.x,
                1e6 * pin->play * pin->start.y);
    }
    fprintf(file, "}\n");
}

void scene_write(const Scene *scene, const char *title, FILE *file)
{
    fprintf(file, "title: %s\nbodies:\n", title);
    for (size_t i = 0; i < scene->link_count; i++) {
        write_link(&scene->links[i], i, file);
    }
    fprintf(file, "joints:\n");
    for (size_t i = 0; i < scene->pin_count; i++) {
        write_pin(&scene->pins[i], i, file);
    }
    if (scene->speed_rpm != 0.0) {
        fprintf(file, "drive: {joint: pin-0, speed: %.9g rpm}\n", scene->speed_rpm);
    }
}

void scene_write_run(const Scene *scene, FILE *file)
{
    fprintf(file, "gravity: 9.80665 m/s^2\nrun: {");
    if (scene->speed_rpm != 0.0) {
        fprintf(file, "revolutions: %.9g", scene->turns);
    } else {
        fprintf(file, "duration: %.9g s", scene->length_s);
    }
    fprintf(file, ", samples: 360, step: 1 us, backends: [reference, ode]}\n");
}
