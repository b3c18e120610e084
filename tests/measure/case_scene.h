// Scenes made of links and pins in the plane, written as bodies and joints.
#pragma once

#include "random_draw.h"

enum { SCENE_LINK_MAX = 16, SCENE_PIN_MAX = 24, SCENE_GROUND = -1 };

typedef struct SceneLink {
    Point ends[2]; // m
    double mass;   // kg
    Point velocity;
    double spin; // rad/s
} SceneLink;

typedef struct ScenePin {
    int link_a; // or SCENE_GROUND
    int link_b;
    Point at;
    double play; // m, radial; 0: none
    Point start; // eccentricity, as a share of the play
} ScenePin;

typedef struct Scene {
    size_t link_count;
    SceneLink links[SCENE_LINK_MAX];
    size_t pin_count;
    ScenePin pins[SCENE_PIN_MAX];
    double speed_rpm; // of a drive in the first pin; 0: none
    double turns;     // of it, or
    double length_s;  // of a run without
} Scene;

// Add a link or a pin and return its number.
int scene_link(Scene *scene, Point from, Point to, double mass);
int scene_pin(Scene *scene, int link_a, int link_b, Point at, double play);

// A four-bar whose crank starts at an angle: three links and four pins, the crank's pivot first and
// play in the pin between crank and coupler. Returns false where it does not close.
typedef struct SceneLoop {
    Point pivot;
    double ground; // m, along x
    double crank;
    double coupler;
    double follower;
    double angle; // rad
    bool is_left;
    double play; // m
} SceneLoop;

bool scene_loop(Scene *scene, const SceneLoop *loop);

// Writes title, bodies, joints and drive; contact and run are the caller's.
void scene_write(const Scene *scene, const char *title, FILE *file);

// Writes gravity and the run.
void scene_write_run(const Scene *scene, FILE *file);
