# Do contacts whose stiffness and damping a case gives come out as they do elsewhere? The numbers are
# those of MSC Adams' IMPACT and of a ball on a soft floor, from an integration of their own kind
# (tests/physics/test_damping_that_grows.c), and of springs in closed form.
# Usage: given_contacts.py PROGRAM. Prints TAP.
import json, math, os, subprocess, sys, tempfile

program = sys.argv[1]

BALL = """title: ball
bodies:
  ball: {mass: 1 kg, inertia: 4000 kg mm^2, at: [0 mm, %g mm], velocity: [0 m/s, %g m/s]}
joints:
  floor: {between: [ground, ball], at-a: [0 mm, 0 mm], at-b: [0 mm, %g mm], normal: 90 deg,
          radius: 100 mm}
gravity: %s
contact: {%s}
run: {duration: %s, samples: 400}
"""
IMPACT = ("stiffness: 1e5 N/mm^2.2, damping: step, viscous-coefficient: 10 N s/mm, "
          "full-damping-depth: %s")
PIN = """title: pin
bodies: {pin: {mass: 0.1 kg, inertia: 2 kg mm^2, at: [0 mm, 0 mm], velocity: [10 m/s, 0 m/s]}}
joints: {hole: {between: [ground, pin], at: [0 mm, 0 mm], %s}}
gravity: 0 m/s^2
contact: {stiffness: 2e4 N/m, damping: none}
run: {duration: 10 ms, samples: 400}
"""

LEVER = """title: lever
bodies: {lever: {mass: 1 kg, inertia: 0.01 kg m^2, at: [0 mm, 0 mm], spin: 2 rad/s}}
joints: {hinge: {between: [ground, lever], at: [0 mm, 0 mm], low: -10 deg, high: 1 deg,
                 stiffness: 1e4 N m/rad, %s}}
gravity: 0 m/s^2
run: {duration: 20 ms, samples: 400}
"""
RESTING = """title: ball at rest
bodies: {ball: {mass: 1 kg, inertia: 4000 kg mm^2, at: [0 mm, 101 mm]}}
joints: {floor: {between: [ground, ball], at-a: [0 mm, 0 mm], at-b: [0 mm, 101 mm],
                 normal: 90 deg, radius: 100 mm, stiffness: 1e5 N/m, restitution: 0.3}}
gravity: 9.81 m/s^2
run: {duration: 0.2 s, samples: 400, backends: [reference]}
"""


def runs_of(text, *words):
    with open("case.yaml", "w", encoding="utf-8") as file:
        file.write(text)
    done = subprocess.run([program, "run", "case.yaml", "--json", "--budget=none", *words],
                          capture_output=True, text=True)
    return {run["backend"]: run for run in json.loads(done.stdout)["runs"]}


def is_within(value, expected, share):
    assert abs(value - expected) <= share * abs(expected), (value, expected)


def restitution_of(run):
    return run["joints"]["floor"]["impulse_N_s"] - 1.0  # of 1 kg at 1 m/s


def impacts_of_adams_come_out_as_in_adams():
    for depth, force, restitution in (("0.1 mm", 6495.6, 0.0874), ("1 mm", 5167.0, 0.798)):
        text = BALL % (100.1, -1, 100.1, "0 m/s^2", IMPACT % depth, "5 ms")
        for run in runs_of(text).values():
            joint = run["joints"]["floor"]
            is_within(joint["force_max_N"], force, 1e-4)
            is_within(restitution_of(run), restitution, 6e-4)
            if depth == "0.1 mm":
                is_within(joint["penetration_max_m"], 130.3e-6, 2e-4)


def the_control_a_damper_that_is_whole_at_the_wall_is_another():
    text = BALL % (100.1, -1, 100.1, "0 m/s^2",
                   IMPACT.split(", full")[0].replace("step", "viscous"), "5 ms")
    joint = runs_of(text, "--backend", "reference")["reference"]["joints"]["floor"]
    assert joint["force_max_N"] > 1.5 * 6495.6, joint["force_max_N"]


def a_ball_sinks_into_a_soft_floor_as_deep_as_its_stiffness_says():
    text = BALL % (200, 0, 200, "9.81 m/s^2",
                   "stiffness: 3000 N/m, damping: viscous, viscous-coefficient: 10 N s/m", "2 s")
    for run in runs_of(text).values():
        joint = run["joints"]["floor"]
        is_within(joint["penetration_max_m"], 25.262e-3, 4e-5)
        is_within(joint["force_max_N"], 76.901, 4e-5)
        assert joint["impacts"] == 6, joint["impacts"]
    peak = joint["force_spikes"][0]["peak_s"]
    is_within(peak, 0.1689, 1e-3)


def a_pin_of_no_size_has_no_limit():
    # v sqrt(m / k), more than twice the 10 mm of a pin that nobody gave
    deep = 10.0 * math.sqrt(0.1 / 2e4)
    for run in runs_of(PIN % "radial-clearance: 0.1 mm").values():
        is_within(run["joints"]["hole"]["penetration_max_m"], deep, 1e-5)


def the_control_a_pin_that_is_deeper_than_its_diameter_has_left_its_hole():
    for run in runs_of(PIN % "hole: 10.2 mm, pin: 10 mm", "--set", "run.step=10us").values():
        assert run["status"] == "failed", run["status"]
        assert "which is all of it: its size is 10 mm" in run["message"], run["message"]


def dissipation_of_a_pivot_is_in_seconds_per_radian():
    # chi = c v of 0.3 s/rad at 2 rad/s: chi (1 + e) = ln((1 + chi) / (1 - chi e))
    chi, low, high = 0.6, 0.0, 1.0
    for _ in range(60):
        e = 0.5 * (low + high)
        low, high = (e, high) if chi * (1 + e) > math.log((1 + chi) / (1 - chi * e)) else (low, e)
    for run in runs_of(LEVER % "dissipation: 0.3 s/rad").values():
        is_within(run["joints"]["hinge"]["impulse_N_m_s"], 0.01 * 2.0 * (1.0 + e), 1e-6)


def a_resting_speed_counts_where_every_joint_has_its_own_restitution():
    lost = []
    for speed in ("none", "0.001 m/s"):
        with open("case.yaml", "w", encoding="utf-8") as file:
            file.write(RESTING + "contact: {resting-speed: %s}\n" % speed)
        done = subprocess.run([program, "run", "case.yaml", "--json"], capture_output=True,
                              text=True)
        assert "no effect" not in done.stderr, done.stderr
        lost.append(json.loads(done.stdout)["runs"][0]["energy"]["dissipated_J"])
    assert abs(lost[1] - lost[0]) > 1e-4 * lost[0], lost


TESTS = [impacts_of_adams_come_out_as_in_adams,
         the_control_a_damper_that_is_whole_at_the_wall_is_another,
         a_ball_sinks_into_a_soft_floor_as_deep_as_its_stiffness_says,
         a_pin_of_no_size_has_no_limit,
         dissipation_of_a_pivot_is_in_seconds_per_radian,
         a_resting_speed_counts_where_every_joint_has_its_own_restitution,
         the_control_a_pin_that_is_deeper_than_its_diameter_has_left_its_hole]

print(f"1..{len(TESTS)}")
with tempfile.TemporaryDirectory() as folder:
    os.chdir(folder)
    failed = 0
    for number, test in enumerate(TESTS, 1):
        try:
            test()
            print(f"ok {number} - {test.__name__}")
        except Exception as error:  # whatever it is, it is the test's
            print(f"not ok {number} - {test.__name__}: {error!r}")
            failed += 1
sys.exit(failed > 0)
