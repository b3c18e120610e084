# Is the world that tune writes for Gazebo a mechanism? Its elements are those of SDF 1.6, each in its
# place; the speeds of its state fit its joints, which say where the parts of the file put them; its
# ring of boxes is the hole; and what it leaves out is named. Each has a control.
# Usage: sdf_world.py PROGRAM CASES. Prints TAP.
import math
import pathlib
import subprocess
import sys
import tempfile
import xml.etree.ElementTree as xml

program, cases = sys.argv[1], pathlib.Path(sys.argv[2])
number = 0


def report(what, passed):
    global number
    number += 1
    print(f"{'ok' if passed else 'not ok'} {number} - {what}", flush=True)


# What may stand in an element (SDFormat 1.6, http://sdformat.org/spec), of those that are used.
INSIDE = {
    "sdf": {"world"},
    "world": {"physics", "gravity", "model", "state"},
    "physics": {"max_step_size", "ode"},
    "solver": {"type"},
    "constraints": {"cfm", "erp", "contact_max_correcting_vel", "contact_surface_layer"},
    "link": {"pose", "inertial", "collision", "velocity"},
    "inertial": {"mass", "inertia"},
    "inertia": {"ixx", "iyy", "izz", "ixy", "ixz", "iyz"},
    "collision": {"pose", "geometry", "surface"},
    "geometry": {"box", "cylinder"},
    "box": {"size"},
    "cylinder": {"radius", "length"},
    "surface": {"contact", "friction"},
    "contact": {"ode"},
    "joint": {"pose", "parent", "child", "axis"},
    "axis": {"xyz", "dynamics"},
    "dynamics": {"damping", "friction", "spring_reference", "spring_stiffness"},
    "state": {"model"},
    "model": {"link", "joint"},
}
ODE_IN = {"physics": {"solver", "constraints"}, "contact": {"soft_erp", "soft_cfm", "kp", "kd", "min_depth", "max_vel"},
          "friction": {"mu", "mu2"}}
NAMED = {"world": "name", "model": "name", "link": "name", "joint": "name", "collision": "name"}


def misplaced(element, around=""):
    allowed = ODE_IN[around] if element.tag == "ode" else INSIDE.get(element.tag, set())
    if element.tag == "friction" and around == "surface":
        allowed = {"ode"}
    found = [f"{element.tag}/{child.tag}" for child in element if child.tag not in allowed]
    if element.tag in NAMED and not element.get(NAMED[element.tag]):
        found.append(f"{element.tag} without a name")
    for child in element:
        found += misplaced(child, element.tag)
    return found


def numbers(element, tag):
    return [float(word) for word in element.findtext(tag).split()]


def turned(angle, x, y):
    return x * math.cos(angle) - y * math.sin(angle), x * math.sin(angle) + y * math.cos(angle)


# How fast the point of a joint, or across a slider, parts at the start, over the largest speed.
def parting(root):
    world = root.find("world")
    state = {link.get("name"): (numbers(link, "pose"), numbers(link, "velocity")) for link in world.find("state/model")}
    worst, largest = 0.0, max(math.hypot(v[0], v[1]) for _, v in state.values())
    at_rest = ([0] * 6, [0] * 6)
    for joint in world.findall("model/joint"):
        if joint.get("type") == "fixed":
            continue
        at, going = state[joint.findtext("child")]
        pose = numbers(joint, "pose")
        arm = turned(at[5], pose[0], pose[1])
        point = at[0] + arm[0], at[1] + arm[1]
        speeds = []
        for where, v in ((at, going), state.get(joint.findtext("parent"), at_rest)):
            speeds.append((v[0] - v[5] * (point[1] - where[1]), v[1] + v[5] * (point[0] - where[0]), v[5]))
        dx, dy, dw = (a - b for a, b in zip(*speeds))
        if joint.get("type") == "prismatic":
            along = turned(at[5], *numbers(joint.find("axis"), "xyz")[:2])
            across = abs(dy * along[0] - dx * along[1])
            worst = max(worst, across / largest, abs(dw) / largest)
        else:
            worst = max(worst, math.hypot(dx, dy) / largest)
    return worst


def tune(folder, case, *more):
    file = folder / "world.sdf"
    done = subprocess.run([program, "tune", cases / case, "--error", "0.5", "--sdf", file, "--quiet", *more],
                          capture_output=True, text=True)
    return (xml.parse(file).getroot() if file.exists() else None), done.stderr, file


def moved(root, path, what):
    element = root.find(path)
    words = element.text.split()
    words[0] = str(float(words[0]) + what)
    element.text = " ".join(words)
    return root


SHORT = ["--set", "run.start=centred", "--schemes", "direct/plain/corrected"]
with tempfile.TemporaryDirectory() as name:
    folder = pathlib.Path(name)
    root, said, file = tune(folder, "paper/impact-k66.yaml", *SHORT, "--set", "run.revolutions=0.05")
    report("its elements are those of SDF", root is not None and misplaced(root) == [])
    report("a joint fits the speeds of its bodies", parting(root) < 1e-9)
    model = root.find("world/model")
    masses = [float(link.findtext("inertial/mass")) for link in model.findall("link")]
    report("its masses are those of the case", masses == [0.12, 0.29, 0.28])
    boxes = [c for c in model.find("link[@name='crank']").findall("collision")]
    faces = []
    for box in boxes:
        pose, size = numbers(box, "pose"), numbers(box, "geometry/box/size")
        faces.append(math.hypot(pose[0] - 0.054, pose[1]) - size[0] / 2)
    pin = float(model.find("link[@name='coupler']").findtext("collision/geometry/cylinder/radius"))
    corner = max(faces) / math.cos(math.pi / len(boxes)) - max(faces)
    report("its ring of boxes is the hole, to a twentieth of the play",
           max(abs(f - 5.0145e-3) for f in faces) < 1e-12 and pin == 5e-3 and corner < 14.5e-6 / 20)
    report("the drive that SDF has not is named, in it and on standard error",
           "left out: a plugin has to drive the joint ground-crank" in file.read_text()
           and "--sdf leaves out: a plugin has to drive the joint ground-crank" in said)
    # the controls
    report("a joint beside its place is found", parting(moved(root, "world/model/joint/pose", 1e-4)) > 1e-6)
    xml.SubElement(model.find("link"), "spring")
    report("an element that SDF has not is found", misplaced(root) == ["link/spring"])
    root, said, file = tune(folder, "mechanisms/run-up.yaml", "--schemes", "direct/staggered/impulse",
                            "--set", "run.duration=5 ms")
    dynamics = root.find("world/model/joint[@name='ground-crank']/axis/dynamics")
    report("dampers of joints are in it, and a spring between points is named",
           float(dynamics.findtext("damping")) == 0.002 and "--sdf leaves out: SDF has no spring between two points, as return" in said)
    root, said, file = tune(folder, "mechanisms/slider-crank-pin.yaml", *SHORT, "--set", "run.revolutions=0.02")
    report("sliders fit their speeds", root is not None and misplaced(root) == [] and parting(root) < 1e-9
           and root.find("world/model/joint[@type='prismatic']") is not None)
    root, said, file = tune(folder, "mechanisms/stop-rebound.yaml", "--schemes", "direct/plain/corrected")
    report("of what it has no words for it says why there is no whole world",
           "limits of joints are elements to paste" in file.read_text() and root.find("world") is None)
print(f"1..{number}")
