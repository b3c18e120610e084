// The text of a model, and the parts of it that are what touches by MuJoCo's own means.
#pragma once

#include "drivers/mujoco/mujoco_driver.h"

typedef struct Xml {
    char *text;
    size_t length;
} Xml;

void xml_add(Xml *xml, const char *format, ...) __attribute__((format(printf, 2, 3)));

// In a joint, the limits of its coordinate where it has any, and friction of it that holds; in a
// body, the shapes on it.
void mujoco_add_joint_limits(const MujocoRun *run, const MujocoModel *how, Xml *xml,
                             size_t coordinate);
void mujoco_add_friction(const MujocoRun *run, const MujocoModel *how, Xml *xml, int joint);
void mujoco_add_shapes(const MujocoRun *run, Xml *xml, int body);

// Among tendons, behind those of holes, the coordinates that are of several joints; those without
// play among the equalities; and the pairs of shapes that touch.
void mujoco_add_rows(const MujocoRun *run, const MujocoModel *how, Xml *xml);
void mujoco_add_couplings(const MujocoRun *run, const MujocoModel *how, Xml *xml);
void mujoco_add_pairs(const MujocoRun *run, const MujocoModel *how, Xml *xml);
