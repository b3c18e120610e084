// What does each collider get wrong, and what does it cost?
//
// colliders CASE [POSES [FOLDER]]
//   CASE    a mechanism with one joint with play, such as cases/paper/impact-k66.yaml
//   POSES   random poses a collider and play (default 100000; 0: none)
//   FOLDER  where colliders-facets.svg and colliders-cost.svg go (default: not drawn)
// Prints, at 2.5 um, 14.5 um and 0.5 mm of play: poses asked one by one, runs of the case against
// the reference; what is found by depth, also by libccd as it comes; the error of the polygon over
// the number of its sides. Ends with status 1 where a
// contact deeper than the collider's resolution is missed, one is invented, a normal points out of
// the hole, or libccd's depth is not the side's to 5e-10 m. Ten minutes, most of them the mesh's.
#include "colliders.h"

#include "collider_poses.h"
#include "naive_collider.h"

#include "../support/kept.h"
#include "base/clock.h"
#include "casefile/casefile.h"
#include "contact/facets.h"
#include "measure/error.h"
#include "measure/truth.h"
#include "run/registry.h"
#include "run/run.h"

#include <assert.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const char *const PLAYS[] = {"2.5 um", "14.5 um", "0.5 mm"};
enum { PLAY_COUNT = sizeof PLAYS / sizeof PLAYS[0] };

static const double STEP_S = 1e-6;
static const double STEPS_S[] = {1e-5, 5e-6, 2e-6, 1e-6, 5e-7};
enum { STEP_COUNT = sizeof STEPS_S / sizeof STEPS_S[0] };

// m, what libccd, asked by us, may be off a side's own depth
static const double CCD_LIMIT = 5e-10;

// the mesh takes seconds a run with more
static const size_t TRIMESH_FACETS_MOST = 256;

static Scenario load(const char *path, const char *play)
{
    char radial[64];
    snprintf(radial, sizeof radial, "joints.crank-coupler.radial-clearance=%s", play);
    const char *const overrides[] = {radial, "ode.stepping=staggered", "ode.map=midpoint",
                                     "run.step=1 us"};
    Scenario scenario;
    Err err = {ERR_NONE, ""};
    if (!casefile_load(path, overrides, sizeof overrides / sizeof overrides[0], &scenario, &err)) {
        fprintf(stderr, "%s\n", err.text);
        exit(3);
    }
    return kept_instead(&scenario);
}

static int joint_with_play(const Scenario *scenario)
{
    int joint = 0;
    while (scenario->linkage.joints[joint].kind != JOINT_CLEARANCE) {
        joint++;
    }
    return joint;
}

static void print_poses_head(void)
{
    printf("%79s%18s%18s\n", "depth: off the side's, m", "off the circle's", "normal, rad");
    printf("  %-12s %7s %9s %7s %8s %6s %4s", "collider", "facets", "contacts", "missed", "deepest",
           "false", "out");
    for (int i = 0; i < 3; i++) {
        printf(" %8s %8s", "median", "largest");
    }
    printf(" %8s\n", "us/query");
}

// Whether a collider kept what it states.
static bool is_kept(const PoseFigures *figures, OdeCollider collider, double limit)
{
    return figures->missed == 0 && figures->invented == 0 && figures->outward == 0 &&
           figures->polygon_max <= (collider == ODE_COLLIDER_STAVES ? CCD_LIMIT : limit);
}

static bool ask_all(const char *path, const char *play, size_t count)
{
    Scenario scenario = load(path, play);
    const int joint = joint_with_play(&scenario);
    Poses poses = collider_poses_make(&scenario, joint, count, 1);
    const Facets facets = facets_of_joint(&scenario, joint);
    bool is_right = true;
    printf("\n%s of radial play, depth to be expected %.3g um, %zu facets: sagitta %.3g m, pi/N "
           "%.3g rad; %zu poses\n",
           play, 1e6 * facets_expected_depth(&scenario, joint), facets.count, facets.sagitta,
           0.5 * facets.pitch, count);
    print_poses_head();
    for (int k = 0; k < ODE_COLLIDER_COUNT; k++) {
        scenario.ode.collider = (OdeCollider)k;
        Err err = {ERR_NONE, ""};
        const bool is_offered = facets_check(&scenario, joint, &err);
        const double radius = scenario.linkage.joints[joint].clearance.hole_radius;
        // the exact collider is held against the circle, which is in the polygon
        const double limit =
            k == ODE_COLLIDER_PIN_HOLE ? facets.sagitta : facets_resolution((OdeCollider)k, radius);
        const PoseFigures figures = collider_poses_ask(&poses, collider_get((OdeCollider)k), limit);
        is_right = is_right && (!is_offered || is_kept(&figures, (OdeCollider)k, limit));
        printf(
            "  %-12s %7zu %9zu %7zu %8.1e %6zu %4zu  %8.1e %8.1e %8.1e %8.1e %8.1e %8.1e %8.3f%s\n",
            OPTIONS_ODE_COLLIDERS[k], k == 0 ? 0 : facets.count, figures.contacts, figures.missed,
            figures.missed_depth, figures.invented, figures.outward, figures.polygon_median,
            figures.polygon_max, figures.circle_median, figures.circle_max, figures.normal_median,
            figures.normal_max, 1e6 * figures.query_s, is_offered ? "" : "  refused");
        fflush(stdout);
    }
    collider_poses_finish(&poses);
    return is_right;
}

static void print_decades(const char *name, const PoseFigures *figures)
{
    printf("  %-18s", name);
    for (size_t i = 0; i < POSE_DECADES; i++) {
        const PoseDecade *decade = &figures->decades[i];
        if (decade->found == 0) {
            printf("     none      -");
        } else {
            printf("  %6.1f%% %6.0e", 100.0 * (double)decade->found / (double)decade->asked,
                   decade->error);
        }
    }
    printf("\n");
    fflush(stdout);
}

// Which share of the contacts is found, and how far off their depths are, by depth. Many sides, so
// that nearly all of the contacts with the circle are some with the polygon.
static void print_depths(const char *path)
{
    enum { POSES = 20000, SLOW_POSES = 1000, FACETS = 4096 };
    Scenario scenario = load(path, "14.5 um");
    const int joint = joint_with_play(&scenario);
    scenario.ode.facets = FACETS;
    Poses poses = collider_poses_make(&scenario, joint, POSES, 3);
    printf(
        "\nContacts found, and the mean error of their depth over the depth, by depth in m; 14.5 "
        "um of play,\n%d facets\n  collider            1e-10 to 1e-9    to 1e-8         to 1e-7"
        "         to 1e-6         to 1e-5         to 1e-4\n",
        FACETS);
    for (int k = 0; k < ODE_COLLIDER_COUNT; k++) {
        poses.count = k == ODE_COLLIDER_TRIMESH ? SLOW_POSES : POSES;
        const PoseFigures figures =
            collider_poses_ask(&poses, collider_get((OdeCollider)k), INFINITY);
        print_decades(OPTIONS_ODE_COLLIDERS[k], &figures);
    }
    poses.count = POSES;
    const PoseFigures mpr = collider_poses_ask(&poses, &NAIVE_MPR, INFINITY);
    print_decades("libccd MPR, naive", &mpr);
    const PoseFigures gjk = collider_poses_ask(&poses, &NAIVE_GJK, INFINITY);
    print_decades("libccd EPA, naive", &gjk);
    collider_poses_finish(&poses);
}

// The largest error of the polygon's depth against what the formula says, by number of sides.
static void print_faceting(const char *path)
{
    static const OdePolygon POLYGONS[] = {ODE_INSCRIBED, ODE_CIRCUMSCRIBED};
    Scenario scenario = load(path, "0.5 mm");
    const int joint = joint_with_play(&scenario);
    const Clearance *clearance = &scenario.linkage.joints[joint].clearance;
    const double play = linkage_radial_clearance(&scenario.linkage.joints[joint]);
    printf("\nFaceting error of staves, 0.5 mm of play, largest of 20000 poses, m: inscribed over "
           "R (pi/N)^2 / 2,\ncircumscribed over e (pi/N)^2 / 2, e up to twice the play\n"
           "  facets  inscribed    ratio  circumscribed    ratio\n");
    for (size_t facets = 64; facets <= 4096; facets *= 2) {
        printf("  %6zu", facets);
        for (int k = 0; k < 2; k++) {
            scenario.ode.collider = ODE_COLLIDER_STAVES;
            scenario.ode.polygon = POLYGONS[k];
            scenario.ode.facets = facets;
            Poses poses = collider_poses_make(&scenario, joint, 20000, 2);
            const PoseFigures figures =
                collider_poses_ask(&poses, collider_get(ODE_COLLIDER_STAVES), INFINITY);
            const double half = M_PI / (double)facets;
            const double length =
                POLYGONS[k] == ODE_INSCRIBED ? clearance->hole_radius : 2.0 * play;
            printf(k == 0 ? "  %9.2e  %7.4f" : "  %13.2e  %7.4f", figures.circle_max,
                   figures.circle_max / (0.5 * length * half * half));
            collider_poses_finish(&poses);
        }
        printf("\n");
    }
}

// Runs a scenario against its truth; false where the collider refuses it or it fails.
static bool run_one(const Scenario *scenario, const Truth *truth, ColliderPoints *points)
{
    const double start_s = clock_processor_s();
    Trajectory *run = run_scenario(scenario, registry_solver(BACKEND_ODE), (RunWatch){NULL, NULL});
    const bool is_complete = run->is_complete;
    if (is_complete) {
        const double horizon_s = truth->is_limited ? truth->horizon_s : INFINITY;
        const TrajectoryError error = error_against(run, truth->trajectory, horizon_s);
        assert(points->count < COLLIDERS_POINT_MAX);
        points->points[points->count++] = (ColliderPoint){
            .collider = scenario->ode.collider,
            .polygon = scenario->ode.polygon,
            .facets = scenario->ode.collider == ODE_COLLIDER_PIN_HOLE
                          ? 0
                          : facets_of_joint(scenario, joint_with_play(scenario)).count,
            .step_s = scenario->run.step,
            .error = truth->is_limited ? error.omega_max_in_horizon : error.omega_max,
            .processor_s = clock_processor_s() - start_s,
        };
    } else {
        printf("  %-12s %s\n", OPTIONS_ODE_COLLIDERS[scenario->ode.collider], run->message);
    }
    trajectory_destroy(run);
    return is_complete;
}

static void print_last(const ColliderPoints *points)
{
    const ColliderPoint *point = &points->points[points->count - 1];
    printf("  %-12s %-13s %6zu %8.2f  %9.2e %10.1f\n", OPTIONS_ODE_COLLIDERS[point->collider],
           point->facets > 0 ? OPTIONS_ODE_POLYGONS[point->polygon] : "-", point->facets,
           1e6 * point->step_s, point->error, 1e3 * point->processor_s);
    fflush(stdout);
}

static void print_runs_head(const char *play, const Truth *truth)
{
    printf("\nRuns at %s of play against the reference (+- %.1e, horizon %.3g ms)\n"
           "  collider     polygon       facets  step,us      error   ms a turn\n",
           play, truth->uncertainty, 1e3 * truth->horizon_s);
}

// Every collider with its own number of facets, with both polygons.
static void run_all(const char *path, const char *play)
{
    Scenario scenario = load(path, play);
    Truth truth = truth_make(&scenario, (RunWatch){NULL, NULL});
    ColliderPoints points = {.count = 0};
    print_runs_head(play, &truth);
    for (int k = 0; k < ODE_COLLIDER_COUNT; k++) {
        // a mesh is the staves' polygon again, and slow
        const bool is_single = k == ODE_COLLIDER_PIN_HOLE || k == ODE_COLLIDER_TRIMESH;
        for (int polygon = 0; polygon < (is_single ? 1 : 2); polygon++) {
            scenario.ode.collider = (OdeCollider)k;
            scenario.ode.polygon = (OdePolygon)polygon;
            if (run_one(&scenario, &truth, &points)) {
                print_last(&points);
            }
        }
    }
    truth_finish(&truth);
}

static bool write_picture(const char *folder, const char *name, const ColliderPoints *points,
                          void (*draw)(const ColliderPoints *, Text *))
{
    char path[4096];
    snprintf(path, sizeof path, "%s/%s", folder, name);
    Text svg;
    text_init(&svg);
    draw(points, &svg);
    FILE *file = fopen(path, "w");
    const bool is_written = file != NULL && fputs(svg.data, file) >= 0 && fclose(file) == 0;
    text_finish(&svg);
    return is_written || (fprintf(stderr, "%s could not be written\n", path), false);
}

// Both pictures: over the number of facets at one step, over the time at the colliders' own number.
static bool draw_all(const char *path, const char *folder)
{
    Scenario scenario = load(path, "14.5 um");
    Truth truth = truth_make(&scenario, (RunWatch){NULL, NULL});
    static ColliderPoints over_facets;
    static ColliderPoints over_time;
    print_runs_head("14.5 um", &truth);
    for (int k = ODE_COLLIDER_STAVES; k < ODE_COLLIDER_COUNT; k++) {
        for (size_t facets = 64; facets <= 4096; facets *= 2) {
            for (int polygon = 0; polygon < 2; polygon++) {
                scenario.ode.collider = (OdeCollider)k;
                scenario.ode.polygon = (OdePolygon)polygon;
                scenario.ode.facets = facets;
                const bool is_slow = k == ODE_COLLIDER_TRIMESH && facets > TRIMESH_FACETS_MOST;
                // by portal refinement or by GJK is one and the same here
                if (!is_slow && k != ODE_COLLIDER_STAVES_GJK &&
                    run_one(&scenario, &truth, &over_facets)) {
                    print_last(&over_facets);
                }
            }
        }
    }
    scenario.ode.facets = 0;
    scenario.ode.polygon = ODE_CIRCUMSCRIBED;
    for (int k = 0; k < ODE_COLLIDER_COUNT; k++) {
        for (size_t i = 0; i < STEP_COUNT; i++) {
            scenario.ode.collider = (OdeCollider)k;
            scenario.run.step = STEPS_S[i];
            if (!(k == ODE_COLLIDER_TRIMESH && STEPS_S[i] < STEP_S) &&
                run_one(&scenario, &truth, &over_time)) {
                print_last(&over_time);
            }
        }
    }
    truth_finish(&truth);
    return write_picture(folder, "colliders-facets.svg", &over_facets, colliders_plot_facets) &&
           write_picture(folder, "colliders-cost.svg", &over_time, colliders_plot_cost);
}

int main(int argc, char **argv)
{
    if (argc < 2 || argc > 4) {
        fprintf(stderr, "usage: colliders CASE [POSES [FOLDER]]\n");
        return 2;
    }
    const size_t count = argc > 2 ? strtoul(argv[2], NULL, 10) : 100000;
    bool is_right = true;
    for (size_t i = 0; i < PLAY_COUNT && count > 0; i++) {
        is_right = ask_all(argv[1], PLAYS[i], count) && is_right;
    }
    print_depths(argv[1]);
    print_faceting(argv[1]);
    for (size_t i = 0; i < PLAY_COUNT; i++) {
        run_all(argv[1], PLAYS[i]);
    }
    if (argc > 3 && !draw_all(argv[1], argv[3])) {
        return 5;
    }
    return is_right ? 0 : 1;
}
