# Does the module say of a case what the program says? The JSON of ten cases, number for number, but for
# times of the processor; and every number of it by its name. The control is another case.
# Usage: test_same.py PROGRAM. Prints TAP.
import json
import math
import subprocess
import sys
import unittest

import jointplay as jp
import tap

PROGRAM = sys.argv.pop(1)
# with what is beside the first screen, and without where that takes long
CASES = {
    "ideal-nominal": True,
    "ideal-stackup": True,
    "pendulum": True,
    "bouncing-ball": True,
    "pin-in-hole-drop": True,
    "gear-pair": True,
    "stop-rebound": True,
    "shaken-lever": False,
    "impact-k66": False,
    "bennett": True,
}
# what the clock says, which is another every time
TIMES = {"wall_s", "us_per_step", "real_time_factor", "budget_wanted_s"}


def by_program(case, is_whole):
    words = [PROGRAM, "run", case, "--json", "--quiet", "--backend", backends_of(case)]
    done = subprocess.run(
        words + ([] if is_whole else ["--quick"]), capture_output=True, text=True, check=True
    )
    return json.loads(done.stdout)


def backends_of(case):
    return "reference" if case in ("impact-k66", "shaken-lever") else "reference, ode"


def differences(one, other, path=""):
    """Paths at which two JSON values are not the same to the last bit."""
    if isinstance(one, dict) and isinstance(other, dict):
        for key in {**one, **other}:
            if key not in one or key not in other:
                yield f"{path}.{key} is not in both"
            elif key not in TIMES:
                yield from differences(one[key], other[key], f"{path}.{key}")
    elif isinstance(one, list) and isinstance(other, list) and len(one) == len(other):
        for index, (x, y) in enumerate(zip(one, other)):
            yield from differences(x, y, f"{path}.{index}")
    elif one != other or str(one) != str(other):
        yield f"{path}: {one} and {other}"


def numbers_of(value, path=()):
    """The numbers, flags and nulls of a JSON value by their paths."""
    if isinstance(value, dict):
        for key, part in value.items():
            yield from numbers_of(part, (*path, key))
    elif isinstance(value, list):
        for index, part in enumerate(value):
            yield from numbers_of(part, (*path, str(index)))
    elif not isinstance(value, str):
        yield ".".join(path), math.nan if value is None else float(value)


class Same(unittest.TestCase):
    runs = {}

    @classmethod
    def setUpClass(cls):
        for case, is_whole in CASES.items():
            cls.runs[case] = jp.Case(case).run(
                backends_of(case), spread=is_whole, whole=True, contacts=False
            )

    def test_ten_cases_have_the_json_of_the_program_number_for_number(self):
        self.assertEqual(len(CASES), 10)
        for case, is_whole in CASES.items():
            with self.subTest(case):
                self.assertEqual(
                    list(differences(self.runs[case].json, by_program(case, is_whole))), []
                )

    def test_every_number_of_the_json_has_its_name(self):
        for case, run in self.runs.items():
            names = set(run.names)
            for name, value in numbers_of({x["backend"]: x for x in run.json["runs"]}):
                if math.isnan(value) and name not in names:
                    continue  # null, of a thing and not of a number
                found = run.number(name)
                self.assertTrue(
                    found == value or found != found and value != value, f"{case}: {name}"
                )

    def test_what_a_run_does_not_have_is_none(self):
        self.assertIsNone(self.runs["pendulum"].error)
        self.assertIsNone(self.runs["pendulum"].message)
        self.assertEqual(self.runs["pendulum"].status, "ok")
        self.assertGreater(self.runs["pendulum"]["ode"].error.max, 0)

    def test_the_first_backend_needs_no_name(self):
        run = self.runs["pendulum"]
        self.assertEqual(run.number("steps"), run.number("reference.steps"))
        self.assertEqual(run.steps, run["reference"].steps)
        self.assertNotEqual(run["ode"].steps, run.steps)

    def test_the_control_another_case_differs(self):
        self.assertTrue(list(differences(self.runs["pendulum"].json, self.runs["bennett"].json)))


tap.main()
