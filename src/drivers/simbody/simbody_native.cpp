// What touches, by Simbody's own means.
//
//     limits             MobilityLinearStop, of the one joint that has the coordinate: a force
//                        k x (1 + d x') at a depth x
//     teeth, a rack      CoordinateCoupler, without play: they stay where they start
//     a pin in its hole, stops, guides: none
//
// No law is asked. With m the mass that the coordinate has at the start, k is so hard that a
// contact, pi sqrt(m / k), takes a number of steps, and d lets a share of the speed come back.
#include "drivers/simbody/simbody_world.hpp"

#include <cmath>
#include <cstdio>

// A lever that a torque presses against its stop, after an impact at 13 rad/s, comes back with 1.9
// rad/s for 4, 8 and 16 steps, and rests 4 times as deep for each doubling. Without dissipation it
// bounces for ever, with 0.1 for longer than 0.4 s; with 2 it comes back with 0.4 rad/s, but the
// stop damps so hard then that faster impacts do not run.
static const double STEPS_OF_CONTACT = 8.0;
static const double DISSIPATION_TURN = 0.5; // s/rad

// An estimate and not measured: that lever meets its stop with d x' = 6.5; a block that has fallen
// by 0.1 m comes with 1.4 m/s, and so with 4.2.
static const double DISSIPATION_WAY = 3.0; // s/m

static const NativeMeans MEANS = {.engine = "Simbody",
                                  .has_holes = false,
                                  .has_faces = false,
                                  .teeth = NATIVE_RIGID_TEETH,
                                  .couples_any = true};

// A coordinate of the tree, as Simbody has it.
struct Mobility {
    size_t body;
    MobilizerQIndex own;
    double start; // Simbody's value at the start
};

static Mobility mobility_of(const Tree &tree, size_t coordinate)
{
    size_t body = 0;
    while (coordinate - tree.bodies[body].first >= tree.bodies[body].count) {
        body++;
    }
    const TreeBody &hung = tree.bodies[body];
    const DriverMotion &start = tree.of->bodies[body].start;
    const size_t k = coordinate - hung.first;
    if (hung.count == 1) {
        return Mobility{body, MobilizerQIndex(0), 0.0};
    }
    const double at[3] = {start.position.x, start.position.y, start.angle};
    return Mobility{body, MobilizerQIndex(static_cast<int>((k + 1) % 3)), at[k]};
}

void World::stop_at_ends(const NativeRow &row, size_t coordinate)
{
    const Mobility of_row = mobility_of(tree, coordinate);
    const double share = row.shares[coordinate];
    const double ends[2] = {row.low / share, row.high / share};
    // of which stiffness and dissipation follow
    stops.push_back(std::make_unique<Force::MobilityLinearStop>(
        forces, bodies[of_row.body], of_row.own, 1.0, 0.0,
        of_row.start + std::min(ends[0], ends[1]), of_row.start + std::max(ends[0], ends[1])));
}

void World::couple(const NativeRow &row)
{
    std::vector<MobilizedBodyIndex> coupled;
    std::vector<MobilizerQIndex> owns;
    std::vector<double> factors;
    double offset = 0.0;
    for (size_t i = 0; i < tree.coordinates; i++) {
        if (row.shares[i] != 0.0) {
            const Mobility at = mobility_of(tree, i);
            coupled.push_back(bodies[at.body].getMobilizedBodyIndex());
            owns.push_back(at.own);
            factors.push_back(row.shares[i]);
            offset -= row.shares[i] * at.start;
        }
    }
    Vector all(static_cast<int>(factors.size()) + 1);
    for (size_t i = 0; i < factors.size(); i++) {
        all[static_cast<int>(i)] = factors[i];
    }
    all[static_cast<int>(factors.size())] = offset;
    Constraint::CoordinateCoupler(matter, new Function::Linear(all), coupled, owns);
    stops.push_back(nullptr);
}

void World::make_native()
{
    native = native_make(&tree, &MEANS);
    pushes.resize(of->place_count);
    for (size_t i = 0; i < native.row_count; i++) {
        const NativeRow &row = native.rows[i];
        const size_t only = native_only_share(&native, &row);
        if (row.has_teeth) {
            couple(row);
        } else if (only < tree.coordinates) {
            stop_at_ends(row, only);
        } else {
            driver_refuse("limits of '%s', which closes a loop: Simbody's stops are those of the "
                          "joints of its tree",
                          of->joints[of->places[row.places[0]].joint].name);
        }
    }
}

// Sets the stiffnesses, for which the masses have to be known.
void World::set_stops(State &state)
{
    const double rate = M_PI / (STEPS_OF_CONTACT * of->step_s);
    for (size_t i = 0; i < native.row_count; i++) {
        if (stops[i] == nullptr) {
            continue;
        }
        const Mobility at = mobility_of(tree, native_only_share(&native, &native.rows[i]));
        Vector push(state.getNU(), 0.0);
        Vector moved;
        const int own = bodies[at.body].getFirstUIndex(state) + at.own;
        push[own] = 1.0;
        matter.multiplyByMInv(state, push, moved);
        const double stiffness = rate * rate / std::max(moved[own], SignificantReal);
        const NativeRow &row = native.rows[i];
        const bool is_turn = of->places[row.places[0]].shape == DRIVER_TURN;
        stops[i]->setMaterialProperties(state, stiffness,
                                        is_turn ? DISSIPATION_TURN : DISSIPATION_WAY);
        stiffness_most = std::max(stiffness_most, stiffness);
    }
    system.realize(state, Stage::Velocity);
}

void World::tell_native()
{
    char words[128];
    if (stiffness_most > 0.0) {
        std::snprintf(
            words, sizeof words,
            ", MobilityLinearStop of %.3g N/m or N m/rad at most, dissipation %.3g s/m or "
            "%.3g s/rad",
            stiffness_most, DISSIPATION_WAY, DISSIPATION_TURN);
        native_tell(&answer, words);
    }
    if (native.has_rigid_teeth) {
        native_tell(&answer, ", teeth by CoordinateCoupler, without play");
    }
}

void World::read_native(const State &state, const DriverMotion *now, ::Vec2 *on_joints)
{
    std::fill(pushes.begin(), pushes.end(), 0.0);
    for (size_t i = 0; i < native.row_count; i++) {
        if (stops[i] == nullptr) {
            continue; // which flank a coupler stands for cannot be known
        }
        const NativeRow &row = native.rows[i];
        const size_t only = native_only_share(&native, &row);
        const size_t place = native_pushing(&native, &row, now);
        const PlacePose pose = place_pose(&of->places[place], now);
        const double depth = std::max(-pose.gap, 0.0);
        const double share = std::fabs(row.shares[only]);
        const double force = stops[i]->getStiffness(state) / (share * share) * depth *
                             (1.0 + stops[i]->getDissipation(state) * pose.approach / share);
        pushes[place] = std::max(force, 0.0);
    }
    native_follow(&native, now, pushes.data(), contacts, &answer, on_joints);
}
