// What acts in a case beside its joints, as MuJoCo's own elements: of a file that runs by itself.
#pragma once

#include "drivers/mujoco/mujoco_xml.h"

// The stiffness and damping of the joint of a coordinate of the tree, as attributes.
void mujoco_add_torsions(const MujocoRun *run, size_t coordinate, Xml *xml);

// The points of springs and loads on a body.
void mujoco_add_points(const MujocoRun *run, int body, Xml *xml);

// Springs, as tendons; and what is constant, as actuators without a control.
void mujoco_add_springs(const MujocoRun *run, Xml *xml);
void mujoco_add_loads(const MujocoRun *run, Xml *xml);

// What MuJoCo has no words for, or ours has not, a comment each.
void mujoco_add_left_out(const MujocoRun *run, Xml *xml);

// Refuses drives that only this driver could turn: a file has a speed at the start, which stays.
void mujoco_check_drives(const DriverCase *of);
