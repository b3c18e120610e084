# Is every case that 'jointplay new' writes one to start from? Each kind is written, is a case whose
# every key is used, and runs: ODE agrees with the reference within the tolerance that was asked for.
# What is there already stays. The control is the same case with a unit taken out, and with too
# coarse a step.
# Usage: new.py PROGRAM. Prints TAP.
import json, os, re, subprocess, sys, tempfile

program = sys.argv[1]
TOLERANCE = 1e-4  # run.tolerance where a case does not say otherwise


def call(*words):
    done = subprocess.run([program, *words], capture_output=True, text=True)
    return done.returncode, done.stdout, done.stderr


def read(path):
    with open(path, encoding="utf-8") as file:
        return file.read()


def write(path, text):
    with open(path, "w", encoding="utf-8") as file:
        file.write(text)


KINDS = re.findall(r"^([a-z-]+): ", call("new", "--help")[1].split("Kinds:")[1], re.M)


def errors_of(words):
    status, output, errors = call("run", *words, "--quick", "--json")
    assert status == 0, errors
    # besides progress, and how long settling may take, whatever is said is a complaint
    said = [line for line in errors.splitlines() if line.startswith("jointplay:")]
    assert all("at its present pace" in line for line in said), errors
    runs = json.loads(output)["runs"]
    assert {"reference", "ode"} <= {run["backend"] for run in runs}
    return [run["error"]["max"] for run in runs if run["backend"] == "ode"]


def every_kind_is_written_and_runs_as_it_is():
    assert len(KINDS) >= 3, KINDS
    for kind in KINDS:
        status, output, errors = call("new", "--kind", kind)
        assert (status, output, errors) == (0, "", f"wrote {kind}.yaml\n"), errors
        assert all(error <= TOLERANCE for error in errors_of([f"{kind}.yaml"])), kind


def the_comments_of_a_case_are_true_where_they_are_uncommented():
    for name in ("four-bar", "slider-crank"):
        text = re.sub(r"^# (?=[a-z-]+: {)", "  ", read(f"{name}.yaml"), flags=re.M)
        assert text != read(f"{name}.yaml"), name
        write(f"{name}-more.yaml", text)
        status, _, errors = call("run", f"{name}-more.yaml", "-q", "--backend", "reference",
                                 "--uncertified", "--set", "run.revolutions=0.01",
                                 "--set", "run.start=centred")
        assert status == 0, errors


def the_control_a_mistake_and_a_coarse_step_are_seen():
    write("mistake.yaml", read("four-bar.yaml").replace("length: 45 mm", "length: 45"))
    status, _, errors = call("run", "mistake.yaml")
    assert status == 3 and "mistake.yaml:10:" in errors, errors
    coarse = ["servo.yaml", "--step", "5 ms", "--set", "ode.stepping=plain", "--set", "ode.map=textbook"]
    assert errors_of(coarse)[0] > TOLERANCE


def without_words_it_is_a_four_bar():
    assert call("new", "-")[1] == read("four-bar.yaml")
    os.mkdir("empty")
    done = subprocess.run([os.path.abspath(program), "new", "-q"], cwd="empty", capture_output=True)
    assert (done.returncode, done.stderr) == (0, b"")
    assert os.listdir("empty") == ["four-bar.yaml"]


def nothing_is_replaced_unless_it_is_said():
    write("mine.yaml", "title: Mine\n")
    os.symlink("nowhere", "link.yaml")
    for path in ("mine.yaml", "link.yaml", "four-bar.yaml"):
        before = os.lstat(path)
        status, output, errors = call("new", path)
        assert status == 5 and f"{path} is there already" in errors, errors
        assert os.lstat(path) == before
    # and not even then where this command did not write it
    status, _, errors = call("new", "mine.yaml", "--force")
    assert status == 5 and "begins 'title: Mine'" in errors, errors
    assert read("mine.yaml") == "title: Mine\n"
    write("four-bar.yaml", read("four-bar.yaml") + "# changed\n")
    assert call("new", "--force")[0] == 0
    assert call("new", "-")[1] == read("four-bar.yaml")


HELLO = {"jointplay-driver": 1, "engine": "Lies", "version": "1", "precision": "double", "ways": ["force"]}
BODY = {"name": "b", "parent": -1, "mass_kg": 1, "position_m": [1, 0, 0], "inertia_kg_m2": [1, 1, 1, 0, 0, 0]}
JOINT = {"name": "j", "kind": "hinge", "body": 0, "position_m": [0, 0, 0], "axis": [0, 0, 1]}


def model(**changed):
    return json.dumps({"model": {"format": "XML", "gravity_m_s2": [0, -9.81, 0], "bodies": [BODY],
                                 "joints": [JOINT], **changed}})


# what a driver says behind its first line, exit status, words
LIES = [
    ([], 4, "does not read models"),
    (['{"failed": "no"}'], 3, "robot.xml: no"),
    (['{"refused": "a robot\\nthat is none"}'], 3, "robot.xml: a robot"),
    (["{}"], 4, "none of the protocol"),
    (["model"], 4, "none of the protocol"),
    (['{"model": []}'], 4, "none of the protocol"),
    (['{"model": {}}'], 3, "nothing moves"),
    ([model(bodies=[{**BODY, "mass_kg": 0}])], 4, "a model that is none"),
    ([model(bodies=[{}])], 4, "a model that is none"),
    ([model(joints=[{**JOINT, "body": 1}])], 4, "a model that is none"),
    ([model(joints=[{**JOINT, "kind": "screw"}])], 4, "a model that is none"),
    ([model(joints=[{**JOINT, "axis": [0, 0, 0]}])], 4, "a model that is none"),
    ([model(couplings=[{"joint_a": 0, "joint_b": 7}])], 4, "a model that is none"),
    ([model(actuators=[{"joint": -1}])], 4, "a model that is none"),
    ([model(bodies=[{**BODY, "inertia_kg_m2": [1, 1, -1, 0, 0, 0]}])], 3, "cannot be carried by a case"),
    ([model(loops=[{"body_a": 0, "body_b": 0, "position_m": [0, 0, 0]}])], 0, ""),
    ([model()], 0, ""),
]


def a_driver_that_lies_of_a_model_is_not_believed():
    os.mkdir("drivers")
    write("robot.xml", "<robot/>")
    for number, (lines, wanted, words) in enumerate(LIES):
        write("drivers/jointplay-mujoco", "#!/bin/sh\nread -r request\ncat <<'end'\n" + json.dumps(HELLO) +
              "\nend\ncase $request in *hello*) exit ;; esac\ncat <<'end'\n" + "".join(f"{line}\n" for line in lines) +
              "end\n")
        os.chmod("drivers/jointplay-mujoco", 0o755)
        done = subprocess.run([program, "new", "--from", "robot.xml", f"robot-{number}.yaml"], capture_output=True,
                              text=True, env={**os.environ, "JOINTPLAY_DRIVERS": os.path.abspath("drivers")})
        assert done.returncode == wanted and words in done.stderr, (lines, done.returncode, done.stderr)
        assert os.path.exists(f"robot-{number}.yaml") == (wanted == 0), lines


def without_a_driver_no_model_is_read():
    done = subprocess.run([program, "new", "--from", "robot.xml", "none.yaml"], capture_output=True, text=True,
                          env={**os.environ, "JOINTPLAY_DRIVERS": "/nowhere"})
    assert done.returncode == 2 and "where MuJoCo is installed" in done.stderr, done.stderr
    assert not os.path.exists("none.yaml")


def an_unknown_kind_names_those_that_there_are():
    status, _, errors = call("new", "--kind", "bicycle")
    assert status == 2 and "allowed: " + ", ".join(KINDS) in errors, errors


CLAIMS = [
    every_kind_is_written_and_runs_as_it_is,
    the_comments_of_a_case_are_true_where_they_are_uncommented,
    the_control_a_mistake_and_a_coarse_step_are_seen,
    without_words_it_is_a_four_bar,
    nothing_is_replaced_unless_it_is_said,
    an_unknown_kind_names_those_that_there_are,
    a_driver_that_lies_of_a_model_is_not_believed,
    without_a_driver_no_model_is_read,
]

print(f"1..{len(CLAIMS)}")
program = os.path.abspath(program)
with tempfile.TemporaryDirectory() as folder:
    os.chdir(folder)
    for number, claim in enumerate(CLAIMS, 1):
        try:
            claim()
            print(f"ok {number} - {claim.__name__}")
        except AssertionError as error:
            print(f"not ok {number} - {claim.__name__}")
            print("# " + str(error)[:800].replace("\n", "\n# "))
        sys.stdout.flush()
    os.chdir("/")
