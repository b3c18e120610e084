// What is done to a model's text before MuJoCo reads it.
#pragma once

#include <stdbool.h>
#include <stddef.h>

enum { URDF_NAME_SIZE = 128, URDF_MIMIC_MOST = 64 };

// A joint that is to follow another, which MuJoCo passes over in a URDF.
typedef struct UrdfMimic {
    char joint[URDF_NAME_SIZE];
    char followed[URDF_NAME_SIZE];
    double multiplier;
    double offset;
} UrdfMimic;

typedef struct Urdf {
    bool is_urdf; // else another model
    size_t mimic_count;
    UrdfMimic mimics[URDF_MIMIC_MOST];
} Urdf;

// Looks at the text of a model, and in a URDF blanks what shapes are: links have their inertias by
// themselves, and most meshes are where MuJoCo does not find them. Line numbers stay. Fails as a
// driver does where the text is no model.
void urdf_prepare(char *text, size_t size, Urdf *urdf);
