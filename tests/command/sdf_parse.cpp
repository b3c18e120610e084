// Loads a world by the parser of Gazebo, SDFormat 12, whose every warning is an error, and prints
// what it understood: of each link its pose, mass and moment of inertia about z; of each joint what it
// connects, its kind, axis and place, all in the frame of the model.
// Usage: sdf_parse WORLD. Exit status 1 where the parser has words.
#include <cstdio>
#include <sdf/sdf.hh>
#include <string>

namespace {

bool has_errors = false;

void say(const sdf::Errors &errors)
{
    for (const auto &error : errors) {
        std::printf("error %s\n", error.Message().c_str());
        has_errors = true;
    }
}

void print_link(const sdf::Link &link)
{
    ignition::math::Pose3d pose;
    say(link.SemanticPose().Resolve(pose, "__model__"));
    const auto inertia = link.Inertial();
    std::printf("link %s %.17g %.17g %.17g %.17g %.17g %zu\n", link.Name().c_str(), pose.Pos().X(),
                pose.Pos().Y(), pose.Rot().Yaw(), inertia.MassMatrix().Mass(),
                inertia.MassMatrix().Izz(), static_cast<size_t>(link.CollisionCount()));
}

void print_joint(const sdf::Joint &joint)
{
    std::string parent;
    std::string child;
    say(joint.ResolveParentLink(parent));
    say(joint.ResolveChildLink(child));
    ignition::math::Vector3d axis;
    if (joint.Axis(0) != nullptr) {
        say(joint.Axis(0)->ResolveXyz(axis, "__model__"));
    }
    ignition::math::Pose3d pose;
    say(joint.SemanticPose().Resolve(pose, "__model__"));
    std::printf("joint %s %s %s %d %.17g %.17g %.17g %.17g %.17g\n", joint.Name().c_str(),
                parent.c_str(), child.c_str(), static_cast<int>(joint.Type()), axis.X(), axis.Y(),
                axis.Z(), pose.Pos().X(), pose.Pos().Y());
}

} // namespace

int main(int count, char **words)
{
    if (count != 2) {
        return 2;
    }
    sdf::ParserConfig strict;
    strict.SetWarningsPolicy(sdf::EnforcementPolicy::ERR);
    strict.SetUnrecognizedElementsPolicy(sdf::EnforcementPolicy::ERR);
    sdf::Root root;
    say(root.Load(words[1], strict));
    for (uint64_t w = 0; w < root.WorldCount(); w++) {
        const sdf::World *world = root.WorldByIndex(w);
        std::printf("world %.17g %.17g\n", world->Gravity().Y(),
                    world->PhysicsByIndex(0)->MaxStepSize());
        for (uint64_t m = 0; m < world->ModelCount(); m++) {
            const sdf::Model *model = world->ModelByIndex(m);
            for (uint64_t i = 0; i < model->LinkCount(); i++) {
                print_link(*model->LinkByIndex(i));
            }
            for (uint64_t i = 0; i < model->JointCount(); i++) {
                print_joint(*model->JointByIndex(i));
            }
        }
    }
    return has_errors ? 1 : 0;
}
