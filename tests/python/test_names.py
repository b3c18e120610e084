# Can every key and every number that there is be had by its name, with its unit and meaning? The
# tables of both are walked, over the cases that came with the program.
# Usage: test_names.py CASES. Prints TAP.
import os
import pickle
import sys
import unittest

import jointplay as jp
import tap

FOLDER = sys.argv.pop(1)
# between them these have every number of a run
RUNS = {
    "impact-k66": ("reference", {"run.start": "centred"}),
    "shaken-lever": ("reference, ode", {}),
    "friction-circle": ("reference, ode", {}),
    "pin-in-hole-drop": ("reference, ode", {}),
    "overhung-pin": ("reference", {}),
    "slider-crank-guide": ("reference", {"run.start": "centred"}),
}


def cases():
    for folder in ("paper", "mechanisms", "literature", "space"):
        for name in sorted(os.listdir(os.path.join(FOLDER, folder))):
            if name.endswith(".yaml"):
                yield os.path.join(FOLDER, folder, name)


def fits(pattern, name):
    """Whether a name is one of a pattern, in which a star stands for a name between points."""
    of, parts = pattern.split("."), name.split(".")
    return len(of) == len(parts) and all(x in ("*", y) for x, y in zip(of, parts))


class Names(unittest.TestCase):
    def test_every_key_can_be_read_with_its_meaning_and_unit(self):
        self.assertGreater(len(jp.keys()), 200)
        found = {}
        for path in cases():
            for setting in jp.Case(path).settings():
                found.setdefault(setting.key, setting)
        case = jp.Case("shaken-lever")
        for key in jp.keys():
            self.assertTrue(key.doc, key.path)
            setting = found.get(key.path) or next(
                (x for name, x in found.items() if fits(key.path, name)), None
            )
            if key.path == "signals.*":
                setting = case.setting("signals.shaker")
            if key.path == "expect":
                # what sets no number of a run says why it cannot be read
                with self.assertRaisesRegex(jp.CaseError, "is no setting: "):
                    case.setting(key.path)
            else:
                self.assertEqual(setting.doc, key.doc, key.path)

    def test_signals_and_parts_of_sinusoids_are_keys_as_others(self):
        case = jp.Case("shaken-lever")
        case["signals.shaker.frequency"] = "25 Hz"
        case["loads.end.force.phase"] = 0.25
        self.assertEqual(case["signals.shaker.frequency"], 25)
        self.assertEqual(case["signals.shaker.frequency"].unit, "Hz")
        self.assertEqual(case["signals.shaker"], "{amplitude: 6 N, frequency: 25 Hz}")
        other = pickle.loads(pickle.dumps(case))
        for key in ("signals.shaker.frequency", "loads.end.force.phase", "loads.across.force"):
            self.assertEqual(other[key], case[key], key)
        with self.assertRaises(jp.UnknownKey):
            case["signals.shaker.no-such"]

    def test_every_setting_of_every_case_is_a_key_of_the_table(self):
        paths = {key.path for key in jp.keys()}
        for path in cases():
            for setting in jp.Case(path).settings():
                is_known = setting.key in paths or any(fits(x, setting.key) for x in paths)
                self.assertTrue(is_known, f"{path}: {setting.key}")

    def test_every_key_that_a_case_uses_can_be_set_to_what_it_is(self):
        count = 0
        for path in list(cases())[::4]:
            case = jp.Case(path)
            before = {x.key: x for x in case.settings() if x.is_used and "*" not in x.key}
            for key, setting in before.items():
                try:
                    case[key] = setting.text
                except jp.CaseError:
                    continue  # what follows from others cannot be given beside them
                count += 1
                for was, now in zip(setting.numbers, case.setting(key).numbers, strict=True):
                    self.assertAlmostEqual(
                        was, now, delta=1e-12 * max(1, abs(was)), msg=f"{path}: {key}"
                    )
        self.assertGreater(count, 200)

    def test_a_number_in_si_is_set_as_it_is(self):
        case = jp.Case("impact-k66")
        for key, value in {
            "joints.crank-coupler.radial-clearance": 17e-6,
            "drive.speed": 99.5,
            "contact.restitution": 0.7,
            "run.samples": 180,
        }.items():
            case[key] = value
            # a clearance is what the hole has more than the pin
            self.assertAlmostEqual(case[key] / value, 1, delta=1e-12, msg=key)

    def test_every_number_of_runs_is_an_attribute_with_its_unit_and_meaning(self):
        runs = []
        for name, (backends, settings) in RUNS.items():
            case = jp.Case(name)
            case.set(settings)
            runs.append(case.run(backends, whole=True))
        lacking = []
        for quantity in jp.quantities():
            found = next((x for run in runs for x in _reached(run, quantity)), None)
            if found is None:
                lacking.append(quantity.path)
            else:
                self.assertEqual(
                    (found.unit, found.doc), (quantity.unit, quantity.doc), quantity.path
                )
        self.assertEqual(lacking, [])

    def test_dir_and_completion_show_what_there_is(self):
        case = jp.Case("pin-in-hole-drop")
        run = case.run("reference", certified=False)
        self.assertIn("force_max", dir(run.joints["hole"]))
        self.assertIn("hole", run.joints._ipython_key_completions_())
        self.assertIn("joints.hole.hole", case._ipython_key_completions_())
        self.assertIn("joints", dir(run))
        self.assertIn("hole_force_N", run.series._ipython_key_completions_())
        for name in dir(run.joints["hole"]):
            getattr(run.joints["hole"], name)

    def test_what_is_meant_is_said_where_a_name_is_wrong(self):
        case = jp.Case("pin-in-hole-drop")
        run = case.run("reference", certified=False)
        with self.assertRaisesRegex(jp.CaseError, "did you mean|allowed"):
            case["joints.hole.hoel"] = "20 mm"
        with self.assertRaisesRegex(AttributeError, "did you mean 'force_max'"):
            run.joints["hole"].force_mx
        with self.assertRaisesRegex(KeyError, "hole"):
            run.joints["hol"]
        with self.assertRaisesRegex(KeyError, "did you mean 'hole_force_N'"):
            run.series["hole_forc_N"]


def _reached(run, quantity):
    """The numbers of a run that are of a quantity, by attributes and items."""
    for name in run.names:
        of, _, rest = name.partition(".")
        if rest and of in run._backends() and fits(quantity.path, rest):
            place = run[of]
            *parts, last = rest.split(".")
            for part in parts:
                place = place[part]
            number = getattr(place, quantity.name) if last == quantity.path.split(".")[-1] else None
            if number is not None:
                yield number


tap.main()
