// Writes what acts in a case beside its joints as MuJoCo's own elements.
//
// A spring is a tendon between two sites, - k (l - l_0) - c l'. A torsion spring is the stiffness
// and the damping of the joint of a coordinate q, which is 0 at the start: with s = 1 where the
// body that the joint of the case turns is the one that hangs on the other in the tree, else -1,
// its angle is s (q + turn), so that q is relaxed at s phi_0 - turn. What is constant is an
// actuator with a bias: along a joint, or at a site whose frame is the body's.
#include "drivers/mujoco/mujoco_actions.h"

#include <string.h>

// The coordinate along which a joint of the case acts, and its sign there; false where it closes a
// loop.
static bool coordinate_of(const MujocoRun *run, int number, size_t *coordinate, double *sign)
{
    const DriverJoint *joint = &run->of->joints[number];
    for (int side = 0; side < 2; side++) {
        const int body = joint->bodies[side];
        if (body == DRIVER_GROUND || run->tree.bodies[body].joint != number) {
            continue;
        }
        const bool is_turned = side == (joint->bodies[1] != DRIVER_GROUND ? 1 : 0);
        // along a line body b counts, wherever the ground is
        const bool is_forth = joint->slides ? side == 1 : is_turned;
        *coordinate = run->tree.bodies[body].first;
        *sign = is_forth ? 1.0 : -1.0;
        return true;
    }
    return false;
}

static const TreeBody *body_at(const MujocoRun *run, size_t coordinate)
{
    size_t body = 0;
    while (run->tree.bodies[body].first != coordinate || run->tree.bodies[body].joint < 0) {
        body++;
    }
    return &run->tree.bodies[body];
}

void mujoco_add_torsions(const MujocoRun *run, size_t coordinate, Xml *xml)
{
    double stiffness = 0.0;
    double damping = 0.0;
    double pulled = 0.0;
    for (size_t i = 0; i < run->of->torsion_count; i++) {
        const DriverTorsion *spring = &run->of->torsions[i];
        size_t own;
        double sign;
        if (coordinate_of(run, spring->joint, &own, &sign) && own == coordinate) {
            const double relaxed = sign * spring->angle - body_at(run, own)->turn;
            stiffness += spring->stiffness;
            damping += spring->damping;
            pulled += spring->stiffness * relaxed;
        }
    }
    if (stiffness > 0.0) {
        xml_add(xml, " stiffness='%.17g' springref='%.17g'", stiffness, pulled / stiffness);
    }
    if (damping > 0.0) {
        xml_add(xml, " damping='%.17g'", damping);
    }
}

// Whether a load is the same at all times and everywhere.
static bool is_constant(const DriverLoad *load)
{
    bool is = load->table.wave.amplitude == 0.0;
    for (size_t i = 1; i < load->table.count; i++) {
        is = is && load->table.values[i] == load->table.values[0];
    }
    return is;
}

// Whether the file has it: a force that does not turn with its body has no element.
static bool is_written(const MujocoRun *run, const DriverLoad *load)
{
    size_t coordinate;
    double sign;
    if (!is_constant(load)) {
        return false;
    }
    switch (load->kind) {
    case DRIVER_FORCE:
        return load->turns_along || load->body == DRIVER_GROUND;
    case DRIVER_TORQUE:
        return true;
    case DRIVER_ALONG:
        break;
    }
    return coordinate_of(run, load->joint, &coordinate, &sign);
}

void mujoco_add_points(const MujocoRun *run, int body, Xml *xml)
{
    for (size_t i = 0; i < run->of->spring_count; i++) {
        const DriverSpring *spring = &run->of->springs[i];
        for (int side = 0; side < 2; side++) {
            const Vec2 at = spring->anchors[side];
            if (spring->bodies[side] == body) {
                xml_add(xml, "<site name='spring%zu%c' pos='%.17g %.17g 0'/>\n", i, "ab"[side],
                        at.x, at.y);
            }
        }
    }
    for (size_t i = 0; body != DRIVER_GROUND && i < run->of->load_count; i++) {
        const DriverLoad *load = &run->of->loads[i];
        if (load->kind != DRIVER_ALONG && load->body == body && is_written(run, load)) {
            xml_add(xml, "<site name='load%zu' pos='%.17g %.17g 0'/>\n", i, load->anchor.x,
                    load->anchor.y);
        }
    }
}

void mujoco_add_springs(const MujocoRun *run, Xml *xml)
{
    for (size_t i = 0; i < run->of->spring_count; i++) {
        const DriverSpring *spring = &run->of->springs[i];
        xml_add(xml,
                "<spatial stiffness='%.17g' springlength='%.17g' damping='%.17g'>"
                "<site site='spring%zua'/><site site='spring%zub'/></spatial>\n",
                spring->stiffness, spring->length, spring->damping, i, i);
    }
}

static void add_load(const MujocoRun *run, size_t number, Xml *xml)
{
    const DriverLoad *load = &run->of->loads[number];
    const double value = load->table.values[0];
    size_t coordinate = 0;
    double sign = 1.0;
    if (load->kind == DRIVER_ALONG) {
        coordinate_of(run, load->joint, &coordinate, &sign);
        xml_add(xml, "<general joint='c%zu'", coordinate);
    } else if (load->kind == DRIVER_TORQUE) {
        xml_add(xml, "<general site='load%zu' gear='0 0 0 0 0 1'", number);
    } else {
        const Vec2 along = vec2_rotate(load->direction, (Vec2){1.0, 0.0});
        xml_add(xml, "<general site='load%zu' gear='%.17g %.17g 0 0 0 0'", number, along.x,
                along.y);
    }
    xml_add(xml, " gaintype='fixed' gainprm='0' biastype='affine' biasprm='%.17g 0 0'/>\n",
            sign * value);
}

void mujoco_add_loads(const MujocoRun *run, Xml *xml)
{
    xml_add(xml, "<actuator>\n");
    for (size_t i = 0; i < run->of->load_count; i++) {
        const DriverLoad *load = &run->of->loads[i];
        if (is_written(run, load) && (load->kind == DRIVER_ALONG || load->body != DRIVER_GROUND)) {
            add_load(run, i, xml);
        }
    }
    xml_add(xml, "</actuator>\n");
}

// A comment, in which no two '-' may stand beside each other.
static void leave_out(const char *what, const char *name, const char *why, Xml *xml)
{
    char plain[DRIVER_NAME_SIZE];
    size_t length = 0;
    for (; name[length] != '\0' && length + 1 < sizeof plain; length++) {
        const bool is_second = length > 0 && name[length] == '-' && plain[length - 1] == '-';
        plain[length] = is_second || (unsigned char)name[length] < ' ' ? '_' : name[length];
    }
    plain[length] = '\0';
    xml_add(xml, "<!-- left out: %s '%s', %s -->\n", what, plain, why);
}

static void leave_out_loads(const MujocoRun *run, Xml *xml)
{
    for (size_t i = 0; i < run->of->load_count; i++) {
        const DriverLoad *load = &run->of->loads[i];
        if (!is_written(run, load)) {
            leave_out("the load", load->name,
                      !is_constant(load)           ? "which is not constant"
                      : load->kind == DRIVER_ALONG ? "along a joint that closes a loop"
                                                   : "whose direction stays as its body turns",
                      xml);
        }
    }
}

void mujoco_check_drives(const DriverCase *of)
{
    for (size_t i = 0; i < of->drive_count; i++) {
        if (!drive_is_steady(&of->drives[i].law)) {
            driver_refuse("the drive at '%s' in a file that runs by itself, for its speed changes "
                          "over time",
                          of->joints[of->drives[i].joint].name);
        }
    }
}

void mujoco_add_left_out(const MujocoRun *run, Xml *xml)
{
    const DriverCase *of = run->of;
    size_t coordinate;
    double sign;
    leave_out_loads(run, xml);
    for (size_t i = 0; i < of->torsion_count; i++) {
        const int joint = of->torsions[i].joint;
        if (!coordinate_of(run, joint, &coordinate, &sign)) {
            leave_out("the torsion spring at", of->joints[joint].name, "a joint that closes a loop",
                      xml);
        }
    }
    for (size_t i = 0; i < of->bushing_count; i++) {
        leave_out("the bushing", of->bushings[i].name, "along two axes that turn", xml);
    }
    for (size_t i = 0; i < of->servo_count; i++) {
        leave_out("the servo at", of->joints[of->servos[i].joint].name,
                  "whose torque is bounded or changes over time", xml);
    }
    for (size_t i = 0; i < of->drag_count; i++) {
        if (of->drags[i].holds) {
            continue;
        }
        leave_out("the friction of", of->joints[of->drags[i].joint].name,
                  "which is regularized, and MuJoCo's frictionloss is not", xml);
    }
}
