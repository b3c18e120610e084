// What touches, by Chipmunk's own means.
//
//     a pin in its hole       a slide joint between the two centres, from 0 to the play
//     limits of a pivot       a rotary limit
//     limits of a slider      a row of Chipmunk's kind (chipmunk_line.c): it has none of its own
//     teeth                   a gear joint, which has no play: they stay where they start
//     a stop, a guide         circles, and segments whose one side is the line
//
// Shapes collide by pairs, each of a category of its own. Overlaps are removed in the next step,
// as errors of joints are; nothing bounces.
#include "drivers/chipmunk/chipmunk_driver.h"
#include "drivers/chipmunk/chipmunk_line.h"

#include <chipmunk/chipmunk_private.h>
#include <math.h>
#include <stdint.h>

// m: half the length and the thickness of a segment behind a line. Chipmunk finds distances from
// its middle, so that a thicker one costs digits; nothing gets through it in a step.
static const double LINE_REACH = 100.0;
static const double LINE_THICKNESS = 0.1;

// m, of an overlap that stays: without it what rests would touch in every second step alone
static const double SLOP = 1e-7;

enum { FACE_MOST = 32 }; // categories of shapes

static void add_row(ChipmunkRun *run, size_t i)
{
    const NativeRow *row = &run->native.rows[i];
    const DriverPlace *place = &run->of->places[row->places[0]];
    cpBody *a = chipmunk_body(run, place->bodies[0]);
    cpBody *b = chipmunk_body(run, place->bodies[1]);
    if (row->has_teeth) {
        const TreeBody *hung = run->tree.bodies;
        const double ratio =
            -row->shares[hung[place->bodies[1]].first] / row->shares[hung[place->bodies[0]].first];
        run->rows[i] = cpGearJointNew(a, b, ratio * cpBodyGetAngle(b) - cpBodyGetAngle(a), ratio);
    } else if (place->shape == DRIVER_TURN) {
        const double turned = cpBodyGetAngle(b) - cpBodyGetAngle(a);
        const bool is_along = native_turn_sign(&run->native, row) > 0.0;
        run->rows[i] = cpRotaryLimitJointNew(a, b, turned + (is_along ? row->low : -row->high),
                                             turned + (is_along ? row->high : -row->low));
    } else {
        run->rows[i] = chipmunk_ends_new(a, b, cpvforangle(place->direction), row->low, row->high);
    }
    chipmunk_add(run, run->rows[i]);
}

static void add_shape(ChipmunkRun *run, const NativeFace *face, unsigned bit, cpShape *shape)
{
    if (shape == NULL) {
        driver_fail("there is no memory");
    }
    const cpBitmask own = (cpBitmask)1 << bit;
    cpShapeSetFilter(shape, cpShapeFilterNew(CP_NO_GROUP, own, own));
    cpShapeSetElasticity(shape, 0.0);
    cpShapeSetFriction(shape, sqrt(face->friction)); // the product of both is that of a pair
    cpShapeSetUserData(shape, &run->pushes[face->place]);
    cpSpaceAddShape(run->space, shape);
}

static void add_face(ChipmunkRun *run, size_t i)
{
    const NativeFace *face = &run->native.faces[i];
    const DriverPlace *place = &run->of->places[face->place];
    const int *bodies = place->bodies;
    const cpVect on_a = chipmunk_point(run, bodies[0], place->anchors[0]);
    const cpVect on_b = chipmunk_point(run, bodies[1], place->anchors[1]);
    cpBody *a = chipmunk_body(run, bodies[0]);
    cpShape *behind = NULL;
    if (face->is_line) {
        const cpVect normal = cpvforangle(place->direction);
        const cpVect middle = cpvadd(on_a, cpvmult(normal, face->distance - LINE_THICKNESS));
        const cpVect along = cpvmult(cpvperp(normal), LINE_REACH);
        behind = cpSegmentShapeNew(a, cpvsub(middle, along), cpvadd(middle, along), LINE_THICKNESS);
    } else {
        behind = cpCircleShapeNew(a, face->distance, on_a);
    }
    add_shape(run, face, (unsigned)i, behind);
    add_shape(run, face, (unsigned)i,
              cpCircleShapeNew(chipmunk_body(run, bodies[1]), face->radius, on_b));
}

// Forgets what a pair has pushed with before it came apart: Chipmunk adds to that when it touches
// anew, without having let it act, so that it would grow from contact to contact, and friction too.
static cpBool forget_push(cpArbiter *arbiter, cpSpace *space, cpDataPointer data)
{
    (void)space;
    (void)data;
    for (int i = 0; cpArbiterIsFirstContact(arbiter) && i < arbiter->count; i++) {
        arbiter->contacts[i].jnAcc = 0.0;
        arbiter->contacts[i].jtAcc = 0.0;
    }
    return cpTrue;
}

// Notes what a pair of shapes has pushed with.
static void note_push(cpArbiter *arbiter, cpSpace *space, cpDataPointer data)
{
    const ChipmunkRun *run = cpSpaceGetUserData(space);
    CP_ARBITER_GET_SHAPES(arbiter, first, second)
    (void)second;
    (void)data;
    double *push = cpShapeGetUserData(first);
    const cpVect impulse = cpArbiterTotalImpulse(arbiter);
    *push = fabs(cpvdot(impulse, cpArbiterGetNormal(arbiter))) / run->of->step_s;
}

void chipmunk_make_native(ChipmunkRun *run)
{
    static const NativeMeans MEANS = {
        .engine = "Chipmunk", .has_holes = true, .has_faces = true, .teeth = NATIVE_RIGID_TEETH};
    run->native = native_make(&run->tree, &MEANS);
    const Native *native = &run->native;
    if (native->face_count > FACE_MOST) {
        driver_refuse("more than %d places at which shapes touch", FACE_MOST);
    }
    run->rows = driver_room(native->row_count, sizeof *run->rows);
    run->slides = driver_room(native->hole_count, sizeof *run->slides);
    for (size_t i = 0; i < native->row_count; i++) {
        add_row(run, i);
    }
    for (size_t i = 0; i < native->hole_count; i++) {
        const DriverPlace *place = &run->of->places[native->holes[i]];
        const int *bodies = place->bodies;
        run->slides[i] = cpSlideJointNew(
            chipmunk_body(run, bodies[0]), chipmunk_body(run, bodies[1]),
            chipmunk_point(run, bodies[0], place->anchors[0]),
            chipmunk_point(run, bodies[1], place->anchors[1]), 0.0, place->clearance);
        chipmunk_add(run, run->slides[i]);
    }
    for (size_t i = 0; i < native->face_count; i++) {
        add_face(run, i);
    }
    cpSpaceSetCollisionSlop(run->space, SLOP);
    cpSpaceSetCollisionBias(run->space, 0.0);
    cpCollisionHandler *handler = cpSpaceAddDefaultCollisionHandler(run->space);
    handler->preSolveFunc = forget_push;
    handler->postSolveFunc = note_push;
}

void chipmunk_clear_native(ChipmunkRun *run)
{
    for (size_t i = 0; i < run->of->place_count; i++) {
        run->pushes[i] = 0.0;
    }
}

void chipmunk_read_native(ChipmunkRun *run)
{
    const Native *native = &run->native;
    const double step_s = run->of->step_s;
    for (size_t i = 0; i < native->hole_count; i++) {
        run->pushes[native->holes[i]] = cpConstraintGetImpulse(run->slides[i]) / step_s;
    }
    for (size_t i = 0; i < native->row_count; i++) {
        const NativeRow *row = &native->rows[i];
        // which flank a gear joint stands for cannot be known
        if (!row->has_teeth) {
            run->pushes[native_pushing(native, row, run->motions)] =
                cpConstraintGetImpulse(run->rows[i]) / step_s;
        }
    }
    native_follow(native, run->motions, run->pushes, run->contacts, &run->run, run->forces);
}
