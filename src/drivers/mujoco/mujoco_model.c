// Makes MuJoCo's model of a case: a tree of bodies, and constraints where loops are left over.
//
// A driven body has an armature so large that nothing slows it down: its speed is kept to a
// rounding. Loops of ideal joints that the tree does not close are MuJoCo's `connect`, which is
// soft: the hardest that its steps bear is that of a time constant of two steps.
//
// A tendon's limit pushes with f = (a_ref - a0) / (W + R), R = A (1 - d) / d, where a0 is the
// acceleration without it, W the row's inverse mass and A MuJoCo's own estimate of that
// (documentation, "Computation"). With solref = (-s, -c) and d as small as is allowed, f = -(s r +
// c v) / A: a spring and a damper, s = A k and c = A b, whatever hangs on it. A is known once
// MuJoCo has made the model, which is therefore made twice.
#include "drivers/common/trial.h"
#include "drivers/mujoco/mujoco_actions.h"
#include "drivers/mujoco/mujoco_xml.h"

#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

// kg m^2: forces of 1e4 N at .1 m change the speed by 1e-6 a second
const double MUJOCO_ARMATURE = 1e9;

enum { XML_SIZE = 1 << 16, JOINT_NAME_SIZE = 32 };

void xml_add(Xml *xml, const char *format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    const int length =
        vsnprintf(xml->text + xml->length, XML_SIZE - xml->length, format, arguments);
    va_end(arguments);
    xml->length += length > 0 ? (size_t)length : 0;
    if (xml->length >= XML_SIZE) {
        driver_refuse("so large a mechanism");
    }
}

static void add_joint(Xml *xml, size_t coordinate, const char *type, Vec2 axis, Vec2 place)
{
    const bool is_hinge = strcmp(type, "hinge") == 0;
    xml_add(xml, "<joint name='c%zu' type='%s' axis='%.17g %.17g %d' pos='%.17g %.17g 0'",
            coordinate, type, is_hinge ? 0.0 : axis.x, is_hinge ? 0.0 : axis.y, is_hinge ? 1 : 0,
            place.x, place.y);
}

static void add_joints(const MujocoRun *run, const MujocoModel *how, Xml *xml, size_t number)
{
    const TreeBody *body = &run->tree.bodies[number];
    const double angle = run->of->bodies[number].start.angle;
    const Vec2 none = {0.0, 0.0};
    if (body->kind == TREE_FREE) {
        for (size_t i = 0; i < 2; i++) {
            const Vec2 axis = {i == 0 ? 1.0 : 0.0, i == 1 ? 1.0 : 0.0};
            add_joint(xml, body->first + i, "slide", vec2_rotate(-angle, axis), none);
            xml_add(xml, "/>\n");
        }
        add_joint(xml, body->first + 2, "hinge", none, none);
    } else if (body->kind == TREE_TURNS) {
        add_joint(xml, body->first, "hinge", none, body->anchor);
    } else {
        add_joint(xml, body->first, "slide", body->axis, none);
    }
    if (driver_drive_of(run->of, (int)number) != NULL) {
        xml_add(xml, " armature='%g'", MUJOCO_ARMATURE);
    }
    if (run->of->wants_model && body->kind == TREE_TURNS) {
        mujoco_add_torsions(run, body->first, xml);
    }
    mujoco_add_joint_limits(run, how, xml, body->first + body->count - 1);
    mujoco_add_friction(run, how, xml, body->joint);
    xml_add(xml, "/>\n");
}

// The points of the pins and holes on a body.
static void add_sites(const MujocoRun *run, Xml *xml, int body)
{
    for (size_t i = 0; i < run->of->joint_count; i++) {
        const DriverJoint *joint = &run->of->joints[i];
        for (int side = 0; side < 2; side++) {
            if (joint->kind == DRIVER_PIN_IN_HOLE && joint->bodies[side] == body) {
                xml_add(xml, "<site name='%s%zu' pos='%.17g %.17g 0'/>\n",
                        side == 0 ? "hole" : "pin", i, joint->anchors[side].x,
                        joint->anchors[side].y);
            }
        }
    }
    if (run->of->wants_model) {
        mujoco_add_points(run, body, xml);
    }
}

// A body with all that hangs on it.
static void add_body(const MujocoRun *run, const MujocoModel *how, Xml *xml, size_t number)
{
    const DriverBody *body = &run->of->bodies[number];
    const int parent = run->tree.bodies[number].parent;
    const DriverMotion still = {.omega = 0.0};
    const DriverMotion *from = parent == DRIVER_GROUND ? &still : &run->of->bodies[parent].start;
    const Vec2 place = vec2_rotate(-from->angle, vec2_sub(body->start.position, from->position));
    const double half = 0.5 * (body->start.angle - from->angle);
    xml_add(xml, "<body name='b%zu' pos='%.17g %.17g 0' quat='%.17g 0 0 %.17g'>\n", number, place.x,
            place.y, cos(half), sin(half));
    xml_add(xml, "<inertial pos='0 0 0' mass='%.17g' diaginertia='%.17g %.17g %.17g'/>\n",
            body->mass, body->inertia, body->inertia, body->inertia);
    add_joints(run, how, xml, number);
    add_sites(run, xml, (int)number);
    mujoco_add_shapes(run, xml, (int)number);
    for (size_t i = 0; i < run->of->body_count; i++) {
        if (run->tree.bodies[i].parent == (int)number) {
            add_body(run, how, xml, i);
        }
    }
    xml_add(xml, "</body>\n");
}

static void add_loops(const MujocoRun *run, const MujocoModel *how, Xml *xml)
{
    xml_add(xml, "<equality>\n");
    for (size_t i = 0; i < run->of->joint_count; i++) {
        const DriverJoint *joint = &run->of->joints[i];
        if (!run->tree.is_left[i] || trial_holds(&run->tree, i)) {
            continue;
        }
        // the anchor is in the frame of the first body, which is no ground
        const int first = joint->bodies[0] == DRIVER_GROUND ? 1 : 0;
        const int other = joint->bodies[1 - first];
        xml_add(xml, "<connect body1='b%d'", joint->bodies[first]);
        if (other != DRIVER_GROUND) {
            xml_add(xml, " body2='b%d'", other);
        }
        xml_add(xml, " anchor='%.17g %.17g 0' solref='%.17g 1' solimp='.9999 .9999 .001 .5 2'/>\n",
                joint->anchors[first].x, joint->anchors[first].y, how->hardness_s);
    }
    mujoco_add_couplings(run, how, xml);
    xml_add(xml, "</equality>\n");
}

// The limit of a tendon: as hard as can be, or the law's spring and damper, scaled by MuJoCo's own
// estimate of its inverse mass where that is known.
static void add_limit(const MujocoRun *run, const MujocoModel *how, Xml *xml, size_t joint,
                      size_t tendon)
{
    const DriverJoint *of = &run->of->joints[joint];
    const double weight = run->model != NULL ? run->model->tendon_invweight0[tendon] : 1.0;
    xml_add(xml, "<spatial limited='true' range='0 %.17g' ", of->clearance);
    if (how->has_springs) {
        xml_add(xml, "solreflimit='%.17g %.17g' solimplimit='.0001 .0001 1 .5 1'",
                -weight * of->law.stiffness, -weight * of->law.viscous);
    } else {
        xml_add(xml, "solreflimit='%.17g 1' solimplimit='.9999 .9999 .001 .5 2'", how->hardness_s);
    }
    xml_add(xml, "><site site='hole%zu'/><site site='pin%zu'/></spatial>\n", joint, joint);
}

static void add_tendons(const MujocoRun *run, const MujocoModel *how, Xml *xml)
{
    size_t tendon = 0;
    xml_add(xml, "<tendon>\n");
    for (size_t i = 0; how->has_tendons && i < run->of->joint_count; i++) {
        if (run->of->joints[i].kind == DRIVER_PIN_IN_HOLE) {
            add_limit(run, how, xml, i, tendon++);
        }
    }
    mujoco_add_rows(run, how, xml);
    if (run->of->wants_model) {
        mujoco_add_springs(run, xml);
    }
    xml_add(xml, "</tendon>\n");
}

// The start, for who runs the file: velocities by MuJoCo's coordinates.
static void add_start(const MujocoRun *run, Xml *xml)
{
    xml_add(xml, "<keyframe><key name='start' qvel='");
    for (int i = 0; i < run->model->nv; i++) {
        double rate = 0.0;
        for (size_t k = 0; k < run->tree.coordinates; k++) {
            rate = run->addresses[k] == i ? run->rates[k] : rate;
        }
        xml_add(xml, "%s%.17g", i > 0 ? " " : "", rate);
    }
    xml_add(xml, "'/></keyframe>\n");
}

static void add_model(const MujocoRun *run, const MujocoModel *how, Xml *xml)
{
    xml_add(xml,
            "<mujoco><compiler angle='radian'/>\n"
            "<option timestep='%.17g' integrator='%s' gravity='%.17g %.17g 0' tolerance='1e-14' "
            "iterations='200'><flag contact='%s'/></option>\n<worldbody>\n",
            run->of->step_s, how->integrator, run->of->gravity.x, run->of->gravity.y,
            run->native.face_count > 0 ? "enable" : "disable");
    add_sites(run, xml, DRIVER_GROUND);
    mujoco_add_shapes(run, xml, DRIVER_GROUND);
    for (size_t i = 0; i < run->of->body_count; i++) {
        if (run->tree.bodies[i].parent == DRIVER_GROUND) {
            add_body(run, how, xml, i);
        }
    }
    xml_add(xml, "</worldbody>\n");
    add_loops(run, how, xml);
    add_tendons(run, how, xml);
    mujoco_add_pairs(run, how, xml);
    if (run->of->wants_model) {
        mujoco_add_loads(run, xml);
        mujoco_add_left_out(run, xml);
    }
    if (run->model != NULL) {
        add_start(run, xml);
    }
    xml_add(xml, "</mujoco>\n");
}

// MuJoCo reads a model from a file: here one in memory.
static mjModel *load(const Xml *xml)
{
    static const char NAME[] = "case.xml";
    char words[512] = "";
    mjVFS *files = calloc(1, sizeof *files);
    if (files == NULL) {
        driver_fail("there is no memory");
    }
    mj_defaultVFS(files);
    if (mj_makeEmptyFileVFS(files, NAME, (int)xml->length) != 0) {
        driver_fail("MuJoCo does not take a model of %zu bytes", xml->length);
    }
    memcpy(files->filedata[mj_findFileVFS(files, NAME)], xml->text, xml->length);
    mjModel *model = mj_loadXML(NAME, files, words, sizeof words);
    mj_deleteVFS(files);
    free(files);
    if (model == NULL) {
        driver_fail("MuJoCo does not take the model: %s", words);
    }
    return model;
}

static void *room(size_t count, size_t size)
{
    void *memory = calloc(count + 1, size);
    if (memory == NULL) {
        driver_fail("there is no memory");
    }
    return memory;
}

void mujoco_make(const DriverCase *of, const MujocoModel *how, MujocoRun *run)
{
    *run = (MujocoRun){.of = of, .tree = tree_make(of), .run = driver_run_start(of)};
    tree_check_drives(&run->tree);
    if (of->wants_model) {
        mujoco_check_drives(of);
    }
    if (how->has_tendons) {
        mujoco_native(run);
    }
    Xml xml = {.text = room(XML_SIZE, 1)};
    add_model(run, how, &xml);
    run->model = load(&xml);
    const size_t count = run->tree.coordinates;
    run->addresses = room(count, sizeof *run->addresses);
    run->coordinates = room(count, sizeof *run->coordinates);
    run->rates = room(count, sizeof *run->rates);
    run->motions = room(of->body_count, sizeof *run->motions);
    run->contacts = places_start(of);
    run->pressed = room(of->joint_count, sizeof *run->pressed);
    run->acted = room(of->body_count, sizeof *run->acted);
    run->actions = room(of->body_count, sizeof *run->actions);
    run->turning = room(of->body_count, sizeof *run->turning);
    tree_start(&run->tree, run->rates);
    for (size_t i = 0; i < count; i++) {
        char name[JOINT_NAME_SIZE];
        snprintf(name, sizeof name, "c%zu", i);
        const int joint = mj_name2id(run->model, mjOBJ_JOINT, name);
        run->addresses[i] = run->model->jnt_dofadr[joint];
    }
    // once more, with what only the model itself says
    xml.length = 0;
    add_model(run, how, &xml);
    mj_deleteModel(run->model);
    run->model = load(&xml);
    run->run.model = xml.text;
    run->data = mj_makeData(run->model);
    mj_resetDataKeyframe(run->model, run->data, 0);
    mujoco_read(run, run->data->qpos, run->data->qvel, run->motions);
}

void mujoco_read(MujocoRun *run, const double *qpos, const double *qvel, DriverMotion *motions)
{
    for (size_t i = 0; i < run->tree.coordinates; i++) {
        run->coordinates[i] = qpos[run->addresses[i]];
        run->rates[i] = qvel[run->addresses[i]];
    }
    tree_motions(&run->tree, run->coordinates, run->rates, motions);
}

void mujoco_check(const MujocoRun *run)
{
    for (int i = 0; i < mjNWARNING; i++) {
        if (run->data->warning[i].number > 0) {
            driver_fail("MuJoCo warned after %.6g s: %s", run->data->time,
                        mju_warningText(i, (int)run->data->warning[i].lastinfo));
        }
    }
}
