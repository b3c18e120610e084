// Finds which words of an engine's own a place has.
//
// The gap of an end of a coordinate, of teeth and of a rack is linear in the coordinates of the
// tree where the centres of gears do not move against each other, and their teeth have no errors:
//     g = g_0 + J x
// J is what a push in the place does along the coordinates. That it is linear is tried elsewhere.
// Two places with opposite J are the ends of one row.
#include "drivers/common/native.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

// rad and m by which coordinates are apart where a gap is tried, and the share by which it may be
// off
static const double TRIED[] = {0.05, -0.08, 0.11};
static const double LINEAR = 1e-9;

// m, the radius of a disc in the place of a point: engines have none of 0, and the way that forces
// act along does not depend on it
static const double POINT_RADIUS = 1e-5;

// share of a distance that a disc without a radius of its own has
static const double DISC_SHARE = 1e-3;

static const char *name_of(const Native *native, size_t place)
{
    const DriverCase *of = native->tree->of;
    return of->joints[of->places[place].joint].name;
}

// The gap of a place, and what a push there does along the coordinates.
static double find_gap(const Native *native, size_t number, const double *x, double *shares)
{
    const Tree *tree = native->tree;
    const DriverPlace *place = &tree->of->places[number];
    DriverMotion *motions = driver_room(tree->of->body_count, sizeof *motions);
    DriverAction *actions = driver_room(tree->of->body_count, sizeof *actions);
    double *still = driver_room(tree->coordinates, sizeof *still);
    tree_motions(tree, x, still, motions);
    const PlaceRow row = place_row(place, motions, 0);
    for (int side = 0; side < 2; side++) {
        if (place->bodies[side] != DRIVER_GROUND) {
            DriverAction *on = &actions[place->bodies[side]];
            on->force = vec2_add(on->force, row.along[side]);
            on->moment += row.turn[side];
        }
    }
    memset(shares, 0, tree->coordinates * sizeof *shares);
    tree_act(tree, motions, actions, shares);
    const double gap = place_pose(place, motions).gap;
    free(still);
    free(actions);
    free(motions);
    return gap;
}

// Whether a gap is linear wherever it is tried.
static bool is_linear(const Native *native, size_t number, double gap, const double *shares)
{
    const size_t count = native->tree->coordinates;
    double *x = driver_room(count, sizeof *x);
    double *there = driver_room(count, sizeof *there);
    bool is = true;
    for (size_t k = 0; k < sizeof TRIED / sizeof *TRIED; k++) {
        double expected = gap;
        double size = 0.0;
        for (size_t i = 0; i < count; i++) {
            x[i] = TRIED[k] * (i % 2 == 0 ? 1.0 : -0.7) / (double)(i + 1);
            expected += shares[i] * x[i];
            size += fabs(shares[i]);
        }
        is = is && fabs(find_gap(native, number, x, there) - expected) <= LINEAR * size;
        for (size_t i = 0; i < count; i++) {
            is = is && fabs(there[i] - shares[i]) <= LINEAR * size;
        }
    }
    free(there);
    free(x);
    return is;
}

static bool has_teeth(const DriverPlace *place)
{
    return place->shape == DRIVER_TEETH || place->shape == DRIVER_RACK;
}

static void check_teeth(const Native *native, size_t number, const double *shares)
{
    const Tree *tree = native->tree;
    const DriverPlace *place = &tree->of->places[number];
    const char *name = name_of(native, number);
    const char *engine = native->means->engine;
    if (native->means->teeth == NATIVE_NO_TEETH) {
        driver_refuse("the teeth of '%s', for %s has no coupling for them", name, engine);
    }
    if (place->gear.error > 0 || place->gear.relief > 0) {
        driver_refuse("the teeth of '%s' with a transmission error or relief, for those of %s have "
                      "none",
                      name, engine);
    }
    for (int side = 0; side < 2 && !native->means->couples_any; side++) {
        const int body = place->bodies[side];
        const bool turns = body != DRIVER_GROUND && tree->bodies[body].kind == TREE_TURNS &&
                           tree->bodies[body].parent == DRIVER_GROUND;
        if (!turns || shares[tree->bodies[body].first] == 0.0) {
            driver_refuse(
                "the teeth of '%s', for %s couples only bodies that turn about the ground", name,
                engine);
        }
    }
}

// Whether a place is the other end of a row.
static bool is_other_end(const Native *native, const NativeRow *row, size_t number,
                         const double *shares)
{
    const DriverPlace *places = native->tree->of->places;
    bool is = row->place_count == 1 && places[row->places[0]].joint == places[number].joint;
    for (size_t i = 0; i < native->tree->coordinates; i++) {
        is = is && fabs(shares[i] + row->shares[i]) <= LINEAR * fabs(shares[i]);
    }
    return is;
}

static void add_row(Native *native, size_t number)
{
    const size_t count = native->tree->coordinates;
    const DriverPlace *place = &native->tree->of->places[number];
    double *still = driver_room(count, sizeof *still);
    double *shares = driver_room(count, sizeof *shares);
    const double gap = find_gap(native, number, still, shares);
    free(still);
    if (has_teeth(place)) {
        check_teeth(native, number, shares);
    }
    if (!is_linear(native, number, gap, shares)) {
        driver_refuse("what touches in '%s', for the centres of its bodies move against each other",
                      name_of(native, number));
    }
    NativeRow *last = native->row_count > 0 ? &native->rows[native->row_count - 1] : NULL;
    if (last != NULL && is_other_end(native, last, number, shares)) {
        last->places[last->place_count++] = number;
        last->high = gap;
        free(shares);
        return;
    }
    native->rows[native->row_count++] = (NativeRow){.places = {number, number},
                                                    .place_count = 1,
                                                    .has_teeth = has_teeth(place),
                                                    .shares = shares,
                                                    .low = -gap,
                                                    .high = INFINITY};
    native->has_rigid_teeth =
        native->has_rigid_teeth || (has_teeth(place) && native->means->teeth == NATIVE_RIGID_TEETH);
}

static void add_face(Native *native, size_t number)
{
    const DriverPlace *place = &native->tree->of->places[number];
    if (!native->means->has_faces) {
        driver_refuse("what touches in '%s', for %s's own limits are those of coordinates",
                      name_of(native, number), native->means->engine);
    }
    NativeFace face = {.place = number,
                       .is_line = place->shape == DRIVER_LINE,
                       .radius = fmax(place->radii[1], POINT_RADIUS),
                       .friction = place->law.friction};
    if (!face.is_line) {
        const double least = DISC_SHARE * place->clearance;
        face.distance = fmin(fmax(place->radii[0], least), place->clearance - least);
        face.radius = place->clearance - face.distance;
    } else {
        face.distance = place->clearance - face.radius;
    }
    native->faces[native->face_count++] = face;
}

static void add_hole(Native *native, size_t number)
{
    const DriverPlace *place = &native->tree->of->places[number];
    if (!native->means->has_holes) {
        driver_refuse("the pin in its hole '%s', for %s has no joint with round play",
                      name_of(native, number), native->means->engine);
    }
    if (place->law.friction > 0.0) {
        driver_refuse("friction in '%s', for a hole of the engine's own has none",
                      name_of(native, number));
    }
    native->holes[native->hole_count++] = number;
}

Native native_make(const Tree *tree, const NativeMeans *means)
{
    const DriverCase *of = tree->of;
    Native native = {.tree = tree,
                     .rows = driver_room(of->place_count, sizeof *native.rows),
                     .faces = driver_room(of->place_count, sizeof *native.faces),
                     .holes = driver_room(of->place_count, sizeof *native.holes),
                     .means = means};
    for (size_t i = 0; i < of->place_count; i++) {
        const DriverPlace *place = &of->places[i];
        const bool is_end =
            place->shape == DRIVER_LINE && driver_is_ideal(&of->joints[place->joint]);
        if (place->shape == DRIVER_HOLE) {
            add_hole(&native, i);
        } else if (is_end || place->shape == DRIVER_TURN || has_teeth(place)) {
            add_row(&native, i);
        } else if (place->shape == DRIVER_LINE || place->shape == DRIVER_DISC) {
            add_face(&native, i);
        } else {
            driver_refuse("what touches in '%s', for no shape of %s's own is that",
                          name_of(&native, i), means->engine);
        }
    }
    return native;
}

size_t native_only_share(const Native *native, const NativeRow *row)
{
    const size_t count = native->tree->coordinates;
    size_t only = count;
    for (size_t i = 0; i < count; i++) {
        if (row->shares[i] != 0.0 && only < count) {
            return count;
        }
        only = row->shares[i] != 0.0 ? i : only;
    }
    return only;
}

double native_turn_sign(const Native *native, const NativeRow *row)
{
    const DriverPlace *place = &native->tree->of->places[row->places[0]];
    return place_row(place, NULL, 0).turn[1];
}

size_t native_pushing(const Native *native, const NativeRow *row, const DriverMotion *motions)
{
    const DriverPlace *places = native->tree->of->places;
    const size_t other = row->places[row->place_count - 1];
    return place_pose(&places[other], motions).gap <
                   place_pose(&places[row->places[0]], motions).gap
               ? other
               : row->places[0];
}

void native_follow(const Native *native, const DriverMotion *motions, const double *pushes,
                   DriverContact *contacts, DriverRun *run, Vec2 *forces)
{
    const DriverCase *of = native->tree->of;
    places_follow(of, motions, contacts, run->totals);
    memset(forces, 0, of->joint_count * sizeof *forces);
    for (size_t i = 0; i < of->place_count; i++) {
        const DriverPlace *place = &of->places[i];
        const bool is_point = place_is_point(place);
        const PlaceRow row = place_row(place, motions, 0);
        const Vec2 force = is_point ? vec2_scale(pushes[i], place_pose(place, motions).normal)
                                    : place_force(place, &row, pushes[i]);
        forces[place->joint] = vec2_add(forces[place->joint], force);
        run->totals[place->joint].force_max =
            fmax(run->totals[place->joint].force_max, fabs(pushes[i]));
    }
}

void native_tell(DriverRun *run, const char *words)
{
    const size_t length = strlen(run->settings);
    snprintf(run->settings + length, sizeof run->settings - length, "%s", words);
}
