#!/usr/bin/env python3
"""A driver of the protocol of docs/drivers.md in Python, whole: the angles of an ideal four-bar by
the rates of its loop, by Euler's method or the midpoint rule.

With JOINTPLAY_TOY_FAULT it misbehaves, for the tests: see FAULTS.
"""
import json
import math
import os
import signal
import sys
import time

FAULT = os.environ.get("JOINTPLAY_TOY_FAULT", "")
LIE = os.environ.get("JOINTPLAY_TOY_LIE", "")
RECORDS = os.environ.get("JOINTPLAY_TOY_RECORDS", "")


def say(**line):
    print(json.dumps(line), flush=True)


def turned(angle, local):
    c, s = math.cos(angle), math.sin(angle)
    return (c * local[0] - s * local[1], s * local[0] + c * local[1])


class FourBar:
    """The crank turns at its speed; the angles of coupler and follower follow by integration."""

    def __init__(self, case):
        self.bodies = case["bodies"]
        crank = case["drive"]["body"]
        self.crank = crank
        # of crank and follower: the pivot in the ground, and in the body
        self.pivots = {}
        between = []
        for joint in case["joints"]:
            a, b = joint["anchor_a_m"], joint["anchor_b_m"]
            if joint["body_a"] < 0:
                self.pivots[joint["body_b"]] = (a, b)
            elif joint["body_b"] < 0:
                self.pivots[joint["body_a"]] = (b, a)
            else:
                between.append(joint)
        (self.follower,) = [b for b in self.pivots if b != crank]
        (self.coupler,) = [b for b in range(3) if b not in self.pivots]
        # the coupler's joints: with the crank and with the follower
        ends = {}
        for joint in between:
            other = joint["body_a"] if joint["body_b"] == self.coupler else joint["body_b"]
            own = "anchor_b_m" if joint["body_b"] == self.coupler else "anchor_a_m"
            its = "anchor_a_m" if joint["body_b"] == self.coupler else "anchor_b_m"
            ends[other] = (joint[own], joint[its])
        self.on_coupler = {b: ends[b][0] for b in ends}
        self.on_other = {b: ends[b][1] for b in ends}
        self.speed = case["drive"]["speed_rad_s"]
        self.start = [b["angle_rad"] for b in self.bodies]

    def arm(self, body, angle):
        """From the pivot of crank or follower to its joint with the coupler."""
        pivot = self.pivots[body][1]
        local = [self.on_other[body][i] - pivot[i] for i in range(2)]
        return turned(angle, local)

    def rates(self, t, angles):
        """Of coupler and follower: crank's pin + coupler = follower's pin, differentiated."""
        crank = self.arm(self.crank, self.start[self.crank] + self.speed * t)
        follower = self.arm(self.follower, angles[1])
        local = [self.on_coupler[self.follower][i] - self.on_coupler[self.crank][i]
                 for i in range(2)]
        coupler = turned(angles[0], local)
        # w2 perp(coupler) - w3 perp(follower) = -w1 perp(crank)
        a, b = -coupler[1], coupler[0]
        c, d = follower[1], -follower[0]
        x, y = self.speed * crank[1], -self.speed * crank[0]
        size = a * d - b * c
        return [(x * d - y * c) / size, (a * y - b * x) / size]

    def sample(self, t, angles):
        rates = self.rates(t, angles)
        turn = {self.crank: (self.start[self.crank] + self.speed * t, self.speed),
                self.follower: (angles[1], rates[1]), self.coupler: (angles[0], rates[0])}
        motions = {}
        for body in (self.crank, self.follower):
            pivot = self.pivots[body]
            motions[body] = self.about(pivot[0], (0.0, 0.0), pivot[1], *turn[body])
        x, y, angle, vx, vy, omega = motions[self.crank]
        pin = turned(angle, self.on_other[self.crank])
        motions[self.coupler] = self.about(
            (x + pin[0], y + pin[1]), (vx - omega * pin[1], vy + omega * pin[0]),
            self.on_coupler[self.crank], *turn[self.coupler])
        return [motions[i] for i in range(3)]

    @staticmethod
    def about(point, velocity, anchor, angle, omega):
        """A body one point of which is there and goes so fast."""
        arm = turned(angle, anchor)
        return [point[0] - arm[0], point[1] - arm[1], angle,
                velocity[0] + omega * arm[1], velocity[1] - omega * arm[0], omega]


def step(model, way, t, angles, h):
    rates = model.rates(t, angles)
    if way == "midpoint":
        middle = [a + 0.5 * h * r for a, r in zip(angles, rates)]
        rates = model.rates(t + 0.5 * h, middle)
    return [a + h * r for a, r in zip(angles, rates)]


def run(case):
    for joint in case["joints"]:
        if joint["kind"] != "revolute":
            say(refused=f"the {joint['kind']} '{joint['name']}'")
            return
    model = FourBar(case)
    times = case["sample_times_s"]
    t, angles = 0.0, [model.start[model.coupler], model.start[model.follower]]
    samples, steps, next_sample = [], 0, 0
    began = time.perf_counter()
    while next_sample < len(times):
        end = (steps + 1) * case["step_s"]
        while next_sample < len(times) and times[next_sample] <= end:
            # a step of its own to the sample: as accurate as the others
            at = step(model, case["way"], t, angles, times[next_sample] - t)
            samples.append((times[next_sample], model.sample(times[next_sample], at)))
            next_sample += 1
        angles = step(model, case["way"], t, angles, end - t)
        t = end
        steps += 1
    wall = time.perf_counter() - began
    # of `done` a test may replace any number: "steps=1e300", "depth=-1"
    key, _, value = LIE.partition("=")
    lie = {key: json.loads(value)} if key else {}
    FAULTS.get(FAULT, lambda s: None)(samples)
    nothing = [[0.0, 0.0] for _ in case["joints"]]
    for at, bodies in samples:
        say(sample=at, bodies=bodies, joints=nothing)
    if "record_s" in case and RECORDS:
        tell_steps(samples)
    if FAULT == "no-end":
        return
    total = [lie.get("force", 0.0), lie.get("depth", 0.0), lie.get("contacts", 0)]
    say(done={"steps": lie.get("steps", steps), "wall_s": lie.get("wall_s", wall),
              "joints": [total for _ in nothing], "settings": lie.get("settings", "none")})
    if FAULT == "goes-on":
        say(sample=0.0, bodies=samples[0][1], joints=nothing)
    if FAULT == "lingers":
        os.close(1)
        time.sleep(600)


def tell_steps(samples):
    """What happened between the samples: of these joints nothing is known."""
    for (start, _), (end, bodies) in zip(samples, samples[1:]):
        if RECORDS == "gap" and start > 0.03:
            start += 0.5 * (end - start)
        rows = [motion[3:] for motion in bodies]
        say(step=[start, end], bodies=rows[:2] if RECORDS == "few" else rows, joints=[None] * 4)
        if RECORDS == "cut":
            break


def spoil(body, number, value):
    def fault(samples):
        samples[len(samples) // 2][1][body][number] = value
    return fault


def start_over(samples):
    # what an engine does that resets itself where it has met a number that is none
    middle = len(samples) // 2
    for i in range(middle, len(samples)):
        samples[i] = (samples[i][0], samples[i - middle][1])


def hang(samples):
    time.sleep(600)


def leave_a_child(samples):
    if os.fork() == 0:
        time.sleep(600)
        os._exit(0)
    os._exit(0)


def leave_a_family(samples):
    """A child, one in a session of its own, and one whose parent is gone, all of which hold the
    pipe of JOINTPLAY_TOY_PIPE open and say there that they are."""
    pipe = int(os.environ["JOINTPLAY_TOY_PIPE"])
    for kind in range(3):
        if os.fork() == 0:
            if kind > 0:
                os.setsid()
            if kind == 2 and os.fork() > 0:
                os._exit(0)
            for i in range(3):
                os.close(i)
            os.write(pipe, b".")
            time.sleep(600)
            os._exit(0)


FAULTS = {
    "family": leave_a_family,
    "family-hangs": lambda samples: (leave_a_family(samples), time.sleep(600)),
    "nan": spoil(1, 3, math.nan),
    "fast": spoil(1, 3, 1e308),
    "faster": spoil(1, 3, 1e14),
    "turned": spoil(1, 2, 50.0),
    "far": spoil(1, 0, 1e6),
    "apart": spoil(1, 0, 0.35),
    "drive": spoil(0, 2, 0.2),
    "starts-over": start_over,
    "abort": lambda samples: os.abort(),
    "killed": lambda samples: os.kill(os.getpid(), signal.SIGKILL),
    "exit": lambda samples: sys.exit("out of luck"),
    "garbage": lambda samples: print("\x1b[31mgarbage", flush=True),
    "half": lambda samples: (sys.stdout.write('{"sample": 0.0'), sys.stdout.flush(), os._exit(0)),
    "failed": lambda samples: (say(failed="the engine warned: bad number"), os._exit(0)),
    "short": lambda samples: samples.pop(),
    "other-times": lambda samples: samples.reverse(),
    "hang": hang,
    "stops": lambda samples: os.kill(os.getpid(), signal.SIGSTOP),
    "child": leave_a_child,
}


def main():
    if FAULT == "mute":
        return
    line = sys.stdin.readline()
    request = json.loads(line)
    if request.get("jointplay-driver") != 1:
        sys.exit("this driver speaks protocol 1")
    say(**{"jointplay-driver": 99 if FAULT == "other-protocol" else 1, "engine": "Toy",
           "version": "1.0", "precision": "double", "ways": ["euler", "midpoint"]})
    if request["ask"] == "run":
        run(request)


main()
