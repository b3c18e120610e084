# Does 'jointplay new --from' answer files that are no models, or models that no case can carry, with
# one sentence, and write nothing then; and do its comments hold where they are uncommented? The
# control is a model that it takes.
# Usage: new_from.py PROGRAM MODELS, with the driver of MuJoCo in JOINTPLAY_DRIVERS. Prints TAP.
import os, re, subprocess, sys, tempfile

program, models = os.path.abspath(sys.argv[1]), os.path.abspath(sys.argv[2])


def call(*words, **environment):
    done = subprocess.run([program, *words], capture_output=True, text=True, timeout=60,
                          env={**os.environ, **environment})
    return done.returncode, done.stdout, done.stderr


def write(path, text):
    with open(path, "w", encoding="utf-8") as file:
        file.write(text)
    return path


def read(path):
    with open(path, encoding="utf-8") as file:
        return file.read()


def mjcf(inside, after=""):
    return f"<mujoco><worldbody>{inside}</worldbody>{after}</mujoco>"


HINGE = '<joint axis="0 1 0"/>'
BALL = '<geom size=".1"/>'
ROBOT = '<robot name="r"><link name="base"/>{}</robot>'
MOVING = ('<link name="a"/><joint name="j" type="continuous"><parent link="base"/><child link="a"/>'
          '<axis xyz="0 1 0"/></joint>')
BOMB = ('<?xml version="1.0"?><!DOCTYPE lolz [<!ENTITY a "lol"><!ENTITY b "&a;&a;&a;&a;&a;&a;&a;&a;">'
        '<!ENTITY c "&b;&b;&b;&b;&b;&b;&b;&b;">]><mujoco model="&c;"/>')
DEEP = "<body>" * 5000 + "</body>" * 5000
MANY = "".join(f'<body name="b{i}" pos="{i} 0 0">{HINGE}{BALL}</body>' for i in range(3))

# text of the file, exit status, words of the one sentence
HOSTILE = {
    "empty.xml": ("", 3, "without XML"),
    "words.xml": ("four bars, please", 3, "without XML"),
    "page.xml": ("<html><body>robot</body></html>", 3, "whose first element is <html>"),
    "world.sdf": ('<sdf version="1.6"><model name="m"/></sdf>', 3, "whose first element is <sdf>"),
    "zero.xml": ("<mujoco>\0</mujoco>", 3, "zero bytes"),
    "cut.xml": ("<mujoco><worldbody><body>", 3, "XML"),
    "bomb.xml": (BOMB, 3, "entities"),
    "itself.xml": ('<mujoco><include file="itself.xml"/></mujoco>', 3, "include"),
    "missing.xml": ('<mujoco><include file="nowhere.xml"/></mujoco>', 3, "nowhere.xml"),
    "mesh.xml": (mjcf(f'<body>{HINGE}<geom type="mesh" mesh="m"/></body>',
                      '<asset><mesh name="m" file="m.stl"/></asset>'), 3, "m.stl"),
    "deep.xml": (mjcf(DEEP), 3, ""),
    "still.xml": (mjcf(f"<body>{BALL}</body>"), 3, "nothing moves"),
    "nothing.xml": ("<mujoco/>", 3, "nothing moves"),
    "massless.xml": (mjcf(f"<body>{HINGE}</body>"), 3, "mass and inertia"),
    "doubled.xml": (mjcf(f'<body name="a">{HINGE}{BALL}</body><body name="a">{HINGE}{BALL}</body>'), 3,
                    "repeated name"),
    "unknown.xml": (mjcf(f'<body><joint type="screw"/>{BALL}</body>'), 3, "screw"),
    "ball.xml": (mjcf(f'<body name="b"><joint type="ball"/>{BALL}</body>'), 3, "'b' has a ball joint"),
    "two.xml": (mjcf(f'<body name="b"><joint axis="0 1 0"/><joint axis="0 1 0" pos="1 0 0"/>{BALL}</body>'),
                3, "'b' has 2 joints"),
    "slide.xml": (mjcf(f'<body name="b">{HINGE}{BALL}<body name="c"><joint type="slide" axis="1 1 0"/>'
                       f'{BALL}</body></body>'), 3, "'c' slides"),
    "huge.xml": (mjcf(f'<body pos="1e300 0 0">{HINGE}{BALL}</body>'), 3, ""),
    "memory.xml": (f'<mujoco><size njmax="2000000000" nconmax="2000000000"/><worldbody><body>{HINGE}{BALL}'
                   '</body></worldbody></mujoco>', 3, ""),
    "no-inertia.urdf": (ROBOT.format(MOVING), 3, "every link of a URDF that moves needs <inertial>"),
    "no-link.urdf": (ROBOT.format(MOVING.replace('child link="a"', 'child link="b"')), 3, ""),
    "circle.urdf": (ROBOT.format(MOVING.replace('parent link="base"', 'parent link="a"')), 3, ""),
    "macro.urdf": (ROBOT.format('<xacro:macro name="m"/>'), 3, "xacro FILE.xacro > FILE.urdf"),
    "type.urdf": (ROBOT.format(MOVING.replace("continuous", "magnetic")), 3, ""),
}


def files_that_no_case_is_of_get_one_sentence():
    for name, (text, status, words) in HOSTILE.items():
        write(name, text)
        before = sorted(os.listdir("."))
        code, output, errors = call("new", "--from", name, "out.yaml")
        assert code == status, (name, code, errors)
        assert output == "" and errors.startswith("jointplay: ") and words in errors, (name, errors)
        assert errors.count("\n") <= 4 and len(errors) < 700, (name, errors)
        assert sorted(os.listdir(".")) == before, (name, os.listdir("."))


def what_is_no_file_is_said():
    os.mkdir("folder")
    os.mkfifo("pipe")
    for name, words in (("nowhere.xml", "No such file"), ("folder", "is no file"), ("pipe", "is no file")):
        code, _, errors = call("new", "--from", name, "out.yaml")
        assert code == 5 and words in errors and not os.path.exists("out.yaml"), (name, code, errors)
    code, _, errors = call("new", "--from", "a.xml", "--kind", "gears")
    assert code == 2 and "give one of them" in errors, errors


def without_mujoco_it_says_so():
    code, _, errors = call("new", "--from", f"{models}/four-bar.xml", "out.yaml", JOINTPLAY_DRIVERS="/nowhere")
    assert code == 2 and "MuJoCo is installed" in errors and not os.path.exists("out.yaml"), errors


def odd_names_become_names():
    write("odd.xml", mjcf(f'<body name="ground">{HINGE}{BALL}</body><body name="a b&#10;# c: {{}}">{HINGE}{BALL}'
                          f'<body name="a-b---c-----">{HINGE}{BALL}</body></body><body name="Ж">{HINGE}{BALL}'
                          f'<body name="{"x" * 90}">{HINGE}{BALL}</body><body name="{"x" * 89}y">{HINGE}{BALL}</body>'
                          '</body>'))
    code, _, errors = call("new", "--from", "odd.xml", "odd.yaml")
    assert code == 0, errors
    code, _, errors = call("run", "odd.yaml", "-q", "--quick", "--backend", "reference", "--set",
                           "run.duration=10 ms")
    assert code == 0, errors
    text = read("odd.yaml")
    names = re.findall(r"^  ([^ #]+): {mass", text, re.M)
    assert len(names) == len(set(names)) == 6 and "ground" not in names, names
    assert "left out: the name of body 'ground', which is ground-2 here" in text, text


def what_is_left_out_stands_in_the_file_and_on_the_screen():
    write("more.xml", mjcf(
        f'<body name="a"><joint name="j" axis="0 1 0" range="1 2" limited="true"/>{BALL}<body name="b">{HINGE}'
        f'{BALL}<site name="s"/><site name="e" pos="1 0 0"/></body></body>',
        '<equality><weld body1="a" body2="b" active="false"/></equality>'
        '<tendon><spatial name="t"><site site="s"/><site site="e"/></spatial></tendon>'
        '<keyframe><key name="up" qpos="1 0"/></keyframe>'
        '<actuator><adhesion name="glue" body="a" ctrlrange="0 1"/></actuator>'))
    code, _, errors = call("new", "--from", "more.xml")
    assert code == 0, errors
    said = [line for line in errors.splitlines() if line.startswith("left out: ")]
    assert [f"# {line}" for line in said] == re.findall("^# left out: .*$", read("more.yaml"), re.M)
    for words in ("limits of joint 'j'", "which is not active", "tendon 't'", "keyframe 'up'",
                  "actuator 'glue'", "2 of the shapes"):
        assert any(words in line for line in said), (words, said)


def run_changed(model, change):
    text = call("new", "-q", "--from", f"{models}/{model}", "-")[1]
    assert change(text) != text, model
    write("changed.yaml", change(text))
    code, _, errors = call("run", "changed.yaml", "-q", "--quick", "--backend", "reference", "--set",
                           "run.duration=20 ms", "--json")
    assert code == 0, (model, errors)


def a_base_that_floats_is_free_where_it_carries_something():
    inertial = '<inertial><mass value="1"/><inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial>'
    more = (f'<link name="c">{inertial}</link><joint name="k" type="continuous"><parent link="a"/><child link="c"/>'
            '<axis xyz="0 1 0"/></joint>')
    for kind in ("floating", "planar"):
        base = MOVING.replace("continuous", kind).replace('name="a"/>', f'name="a">{inertial}</link>', 1)
        write(f"{kind}.urdf", ROBOT.format(base))
        code, _, errors = call("new", "--from", f"{kind}.urdf")
        assert code == 3 and f"{kind}.urdf cannot be carried by a case: the body 'a' has no joint" in errors, errors
        write(f"{kind}.urdf", ROBOT.format(base + more))
        code, _, errors = call("new", "--from", f"{kind}.urdf")
        assert code == 0, errors
        code, _, errors = call("run", f"{kind}.yaml", "-q", "--quick", "--backend", "reference")
        assert code == 0, errors


def comments_hold_where_they_are_uncommented():
    play = lambda text: re.sub("^    # (hole|pin|width)", r"    \1", text, flags=re.M)
    for model in ("four-bar.xml", "slider-crank.xml", "delta-leg.xml", "jansen-leg.xml"):
        run_changed(model, play)
    run_changed("four-bar.xml", lambda text: text.replace("# drive: ", "drive: "))
    run_changed("double-pendulum.xml", lambda text: text.replace("# closing-", "closing-"))
    run_changed("arm.urdf", lambda text: text.replace("# closing-", "closing-").replace("[l4, ground]", "[l4, base]")
                .replace("base]", "l1]"))


def the_control_a_model_is_taken_and_nothing_is_replaced():
    assert call("new", "--from", f"{models}/four-bar.xml") == (0, "", "wrote four-bar.yaml\n")
    before = read("four-bar.yaml")
    code, _, errors = call("new", "--from", f"{models}/six-bar.xml", "four-bar.yaml")
    assert code == 5 and "is there already" in errors and read("four-bar.yaml") == before
    code, _, errors = call("new", "--from", f"{models}/six-bar.xml", "--force", "four-bar.yaml")
    assert code == 0 and read("four-bar.yaml") != before, errors
    assert call("run", "four-bar.yaml", "-q", "--set", "run.duration=50 ms")[0] == 0


tests = [value for value in list(globals().values()) if callable(value) and value.__module__ == "__main__"
         and value.__name__ not in ("call", "write", "read", "mjcf", "run_changed")]
print(f"1..{len(tests)}")
failed = 0
for number, test in enumerate(tests, 1):
    with tempfile.TemporaryDirectory() as folder:
        os.chdir(folder)
        try:
            test()
            print(f"ok {number} - {test.__name__}")
        except Exception as problem:
            failed += 1
            print(f"not ok {number} - {test.__name__}\n# {type(problem).__name__}: {problem}".replace("\n#", "\n# "))
        os.chdir("/")
sys.exit(1 if failed else 0)
