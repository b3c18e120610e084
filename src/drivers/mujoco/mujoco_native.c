// What touches, by MuJoCo's own means.
//
//     a pin in its hole     a spatial tendon that is limited (mujoco_model.c)
//     limits                those of the joint that has the coordinate, or of a fixed tendon: a sum
//                           of coordinates
//     teeth, a rack         a fixed tendon, whose range is the play; without play an equality
//     a stop, a guide       pairs of shapes: spheres, and boxes whose one side is the line
//     friction that holds   a loss of the joint, where it is steady
//
// All are as hard as the steps bear, a time constant of two steps, and no law is asked.
#include "drivers/mujoco/mujoco_xml.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

// where a coordinate has no end
static const double FAR = 1e6;

// m: half the length and half the thickness of a box behind a line
static const double LINE_REACH = 100.0;
static const double LINE_THICKNESS = 0.1;

enum { NAME_SIZE = 32 };

// MuJoCo knows the friction of a joint of its tree.
static void check_friction(const MujocoRun *run)
{
    for (size_t i = 0; i < run->of->drag_count; i++) {
        const DriverDrag *drag = &run->of->drags[i];
        if (drag->holds && run->tree.is_left[drag->joint]) {
            driver_refuse("friction that holds in the joint '%s', which closes a loop",
                          run->of->joints[drag->joint].name);
        }
    }
}

void mujoco_native(MujocoRun *run)
{
    static const NativeMeans MEANS = {.engine = "MuJoCo",
                                      .has_holes = true,
                                      .has_faces = true,
                                      .teeth = NATIVE_LOOSE_TEETH,
                                      .couples_any = true};
    check_friction(run);
    run->native = native_make(&run->tree, &MEANS);
}

static bool is_without_play(const NativeRow *row)
{
    return !(row->high > row->low);
}

// Whether a row is a limit of the one joint that has its coordinate.
static bool is_of_joint(const MujocoRun *run, const NativeRow *row)
{
    return !row->has_teeth && !is_without_play(row) &&
           native_only_share(&run->native, row) < run->tree.coordinates;
}

static double end_of(double end)
{
    return fmin(fmax(end, -FAR), FAR);
}

static void add_range(const MujocoModel *how, Xml *xml, double low, double high)
{
    xml_add(xml,
            " limited='true' range='%.17g %.17g' solreflimit='%.17g 1' "
            "solimplimit='.9999 .9999 .001 .5 2'",
            end_of(low), end_of(high), how->hardness_s);
}

void mujoco_add_joint_limits(const MujocoRun *run, const MujocoModel *how, Xml *xml,
                             size_t coordinate)
{
    for (size_t i = 0; i < run->native.row_count; i++) {
        const NativeRow *row = &run->native.rows[i];
        if (is_of_joint(run, row) && native_only_share(&run->native, row) == coordinate) {
            const double share = row->shares[coordinate];
            const double ends[2] = {row->low / share, row->high / share};
            add_range(how, xml, fmin(ends[0], ends[1]), fmax(ends[0], ends[1]));
        }
    }
}

void mujoco_add_friction(const MujocoRun *run, const MujocoModel *how, Xml *xml, int joint)
{
    for (size_t i = 0; i < run->of->drag_count; i++) {
        const DriverDrag *drag = &run->of->drags[i];
        if (drag->holds && drag->joint == joint) {
            xml_add(xml,
                    " frictionloss='%.17g' solreffriction='%.17g 1' "
                    "solimpfriction='.9999 .9999 .001 .5 2'",
                    drag->most, how->hardness_s);
        }
    }
}

void mujoco_add_rows(const MujocoRun *run, const MujocoModel *how, Xml *xml)
{
    for (size_t i = 0; i < run->native.row_count; i++) {
        const NativeRow *row = &run->native.rows[i];
        if (is_of_joint(run, row)) {
            continue;
        }
        xml_add(xml, "<fixed name='r%zu'", i);
        if (!is_without_play(row)) {
            add_range(how, xml, row->low, row->high);
        }
        xml_add(xml, ">");
        for (size_t k = 0; k < run->tree.coordinates; k++) {
            if (row->shares[k] != 0.0) {
                xml_add(xml, "<joint joint='c%zu' coef='%.17g'/>", k, row->shares[k]);
            }
        }
        xml_add(xml, "</fixed>\n");
    }
}

void mujoco_add_couplings(const MujocoRun *run, const MujocoModel *how, Xml *xml)
{
    for (size_t i = 0; i < run->native.row_count; i++) {
        if (is_without_play(&run->native.rows[i])) {
            xml_add(xml,
                    "<tendon name='e%zu' tendon1='r%zu' solref='%.17g 1' "
                    "solimp='.9999 .9999 .001 .5 2'/>\n",
                    i, i, how->hardness_s);
        }
    }
}

// The shape on body a of a place is behind its line or about its centre.
void mujoco_add_shapes(const MujocoRun *run, Xml *xml, int body)
{
    for (size_t i = 0; i < run->native.face_count; i++) {
        const NativeFace *face = &run->native.faces[i];
        const DriverPlace *place = &run->of->places[face->place];
        if (place->bodies[0] == body && face->is_line) {
            const Vec2 normal = vec2_rotate(place->direction, (Vec2){1.0, 0.0});
            const Vec2 at =
                vec2_add(place->anchors[0], vec2_scale(face->distance - LINE_THICKNESS, normal));
            const double half = 0.5 * place->direction;
            xml_add(xml,
                    "<geom name='f%zu' type='box' size='%.17g %.17g 1' pos='%.17g %.17g 0' "
                    "quat='%.17g 0 0 %.17g' contype='0' conaffinity='0'/>\n",
                    i, LINE_THICKNESS, LINE_REACH, at.x, at.y, cos(half), sin(half));
        } else if (place->bodies[0] == body) {
            xml_add(xml,
                    "<geom name='f%zu' type='sphere' size='%.17g' pos='%.17g %.17g 0' "
                    "contype='0' conaffinity='0'/>\n",
                    i, face->distance, place->anchors[0].x, place->anchors[0].y);
        }
        if (place->bodies[1] == body) {
            xml_add(xml,
                    "<geom name='d%zu' type='sphere' size='%.17g' pos='%.17g %.17g 0' "
                    "contype='0' conaffinity='0'/>\n",
                    i, face->radius, place->anchors[1].x, place->anchors[1].y);
        }
    }
}

void mujoco_add_pairs(const MujocoRun *run, const MujocoModel *how, Xml *xml)
{
    xml_add(xml, "<contact>\n");
    for (size_t i = 0; i < run->native.face_count; i++) {
        const double friction = run->native.faces[i].friction;
        xml_add(xml,
                "<pair geom1='f%zu' geom2='d%zu' condim='%d' friction='%.17g %.17g 0 0 0' "
                "solref='%.17g 1' solimp='.9999 .9999 .001 .5 2'/>\n",
                i, i, friction > 0.0 ? 3 : 1, friction, friction, how->hardness_s);
    }
    xml_add(xml, "</contact>\n");
}

static int number_of(const MujocoRun *run, int type, const char *word, size_t number)
{
    char name[NAME_SIZE];
    snprintf(name, sizeof name, "%s%zu", word, number);
    return mj_name2id(run->model, type, name);
}

// What MuJoCo pushes a row with along its coordinate.
static double push_of(const MujocoRun *run, size_t i)
{
    const NativeRow *row = &run->native.rows[i];
    const mjData *data = run->data;
    const size_t only = native_only_share(&run->native, row);
    const bool is_joint = is_of_joint(run, row);
    const int type = is_joint               ? mjCNSTR_LIMIT_JOINT
                     : is_without_play(row) ? mjCNSTR_EQUALITY
                                            : mjCNSTR_LIMIT_TENDON;
    const int id = is_joint               ? number_of(run, mjOBJ_JOINT, "c", only)
                   : is_without_play(row) ? number_of(run, mjOBJ_EQUALITY, "e", i)
                                          : number_of(run, mjOBJ_TENDON, "r", i);
    double sum = 0.0;
    for (int k = 0; k < data->nefc; k++) {
        if (data->efc_type[k] == (int)type && data->efc_id[k] == id) {
            sum += data->efc_force[k];
        }
    }
    return is_joint ? sum / fabs(row->shares[only]) : sum;
}

void mujoco_read_pushes(const MujocoRun *run, double *pushes)
{
    const Native *native = &run->native;
    const mjData *data = run->data;
    memset(pushes, 0, run->of->place_count * sizeof *pushes);
    for (size_t i = 0; i < native->hole_count; i++) {
        for (int k = 0; k < data->nefc; k++) {
            if (data->efc_type[k] == mjCNSTR_LIMIT_TENDON && data->efc_id[k] == (int)i) {
                pushes[native->holes[i]] = data->efc_force[k];
            }
        }
    }
    for (size_t i = 0; i < native->row_count; i++) {
        const NativeRow *row = &native->rows[i];
        const double push = push_of(run, i);
        const size_t up = is_without_play(row) && push > 0.0 ? row->places[0]
                          : is_without_play(row)             ? row->places[row->place_count - 1]
                                                 : native_pushing(native, row, run->motions);
        pushes[up] = fabs(push);
    }
    for (int k = 0; k < data->ncon; k++) {
        mjtNum force[6];
        mj_contactForce(run->model, data, k, force);
        for (size_t i = 0; i < native->face_count; i++) {
            if (data->contact[k].geom2 == number_of(run, mjOBJ_GEOM, "d", i) ||
                data->contact[k].geom1 == number_of(run, mjOBJ_GEOM, "d", i)) {
                pushes[native->faces[i].place] = force[0];
            }
        }
    }
}
