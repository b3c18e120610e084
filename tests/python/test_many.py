# Are many runs at once what they are one by one, to the last bit? In threads, in processes, pickled;
# and are what a notebook shows and the line of progress as they should be. Prints TAP.
import base64
import copy
import io
import pickle
import unittest
from concurrent.futures import ThreadPoolExecutor
from contextlib import redirect_stderr

import jointplay as jp
import tap

PLAYS = [5e-6 * 1.3**i for i in range(8)]
PLAY = "joints.crank-coupler.radial-clearance"


def paper():
    case = jp.Case("impact-k66")
    case.set(
        {"run.start": "centred", "run.samples": 360, "run.revolutions": 0.5, "run.step": "20 us"}
    )
    return case


def bits(run):
    return [run.word("hash"), *(bytes(memoryview(column)) for column in run.series.values())]


class Many(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.one_by_one = []
        for play in PLAYS:
            case = paper()
            case[PLAY] = play
            cls.one_by_one.append(bits(case.run("reference, ode", certified=False)))

    def test_eight_threads_give_the_bits_of_one_by_one(self):
        def ask(play):
            case = paper()
            case[PLAY] = play
            return bits(case.run("reference, ode", certified=False, threads=1))

        with ThreadPoolExecutor(8) as threads:
            self.assertEqual(list(threads.map(ask, PLAYS)), self.one_by_one)

    def test_a_sweep_in_processes_gives_the_bits_of_one_by_one_in_their_order(self):
        for processes in (1, 3):
            points = list(
                jp.sweep(
                    paper(), {PLAY: PLAYS}, "reference, ode", processes=processes, certified=False
                )
            )
            self.assertEqual([point[PLAY] for point in points], PLAYS)
            self.assertEqual([bits(point.run) for point in points], self.one_by_one)

    def test_the_control_another_play_has_other_bits(self):
        self.assertEqual(len({case[0] for case in self.one_by_one}), len(PLAYS))

    def test_the_last_key_changes_fastest(self):
        grid = {PLAY: ["5 um", "6 um"], "contact.restitution": [0.5, 0.6]}
        points = list(jp.sweep(paper(), grid, "reference", certified=False))
        self.assertEqual(
            [tuple(point.settings.values()) for point in points],
            [("5 um", 0.5), ("5 um", 0.6), ("6 um", 0.5), ("6 um", 0.6)],
        )

    def test_a_run_that_fails_is_a_point_and_the_others_go_on(self):
        for processes in (1, 2):
            points = jp.sweep(
                paper(),
                {"contact.restitution": [0.5, 3, 0.6]},
                "reference",
                processes=processes,
                certified=False,
            )
            good, bad, other = list(points)
            self.assertIsInstance(bad.error, jp.CaseError)
            with self.assertRaisesRegex(jp.CaseError, "restitution"):
                bad.run
            self.assertTrue(good.error is None and other.error is None and good.run.steps > 0)

    def test_a_sweep_leaves_its_case_as_it_was(self):
        case = paper()
        before = case.settings()
        list(jp.sweep(case, {PLAY: PLAYS[:2]}, "reference", certified=False))
        self.assertEqual(case.settings(), before)

    def test_a_pickled_run_is_the_run(self):
        run = paper().run("reference, ode")
        again = pickle.loads(pickle.dumps(run))
        self.assertEqual(again.json, run.json)
        self.assertEqual(again.names, run.names)
        self.assertEqual(bits(again), bits(run))
        self.assertEqual(
            [again.number(x) for x in run.names if run.number(x) == run.number(x)],
            [run.number(x) for x in run.names if run.number(x) == run.number(x)],
        )
        self.assertEqual(again["ode"].error.against, run["ode"].error.against)
        self.assertEqual(again["ode"].series["time_s"][-1], run["ode"].series["time_s"][-1])
        self.assertEqual(len(again.contacts), len(run.contacts))
        self.assertEqual(again.contacts[0], run.contacts[0])
        self.assertEqual(again.joints["crank-coupler"].force_max.unit, "N")
        with self.assertRaises(jp.CaseError):
            again.number("joints.crank-coupler.force")
        self.assertEqual(bits(pickle.loads(pickle.dumps(again))), bits(run))

    def test_a_pickled_part_of_a_run_is_that_part(self):
        run = jp.Case("pin-in-hole-drop").run("reference", certified=False)
        for part in (run.series, run.contacts, run.spikes, run.joints, run.joints["hole"]):
            for again in (pickle.loads(pickle.dumps(part)), copy.deepcopy(part)):
                self.assertEqual(list(map(str, again)), list(map(str, part)))
        series = pickle.loads(pickle.dumps(run.series))
        self.assertEqual(bytes(memoryview(series["time_s"])), bytes(memoryview(run.series["time_s"])))
        self.assertEqual(series.unit("time_s"), "s")

    def test_a_pickled_case_is_the_case(self):
        case = paper()
        case["contact.restitution"] = 0.75
        again = pickle.loads(pickle.dumps(case))
        self.assertEqual([x for x in again.settings()], [x for x in case.settings()])
        text = jp.Case.from_text(
            "title: A\nbodies:\n  a: {mass: 1 kg, inertia: 1 kg m^2, at: [0 m, 0 m]}\n"
            "joints: {b: {between: [ground, a], at: [0 m, 0 m]}}\nrun: {duration: 1 s}\n"
        )
        text["run.duration"] = "2 s"
        self.assertEqual(pickle.loads(pickle.dumps(text))["run.duration"], 2)

    def test_a_run_without_contacts_is_pickled_and_says_so(self):
        run = paper().run("reference", certified=False, contacts=False)
        again = pickle.loads(pickle.dumps(run))
        self.assertEqual(bits(again), bits(run))
        for either in (run, again, pickle.loads(pickle.dumps(again))):
            with self.assertRaisesRegex(jp.CaseError, "contacts were not kept"):
                either.contacts["force_max_N"]
        (point,) = jp.sweep(paper(), {PLAY: PLAYS[:1]}, "reference", processes=2, contacts=False)
        self.assertGreater(point.run.joints["crank-coupler"].force_max, 0)

    def test_a_case_goes_on_from_run_to_run(self):
        case = paper()
        for _ in range(3):
            case[PLAY] = PLAYS[0]
            self.assertEqual(bits(case.run("reference, ode", certified=False)), self.one_by_one[0])
            case[PLAY] = PLAYS[1]
            self.assertEqual(bits(case.run("reference, ode", certified=False)), self.one_by_one[1])

    def test_a_notebook_shows_the_first_screen_and_the_picture(self):
        html = paper().run("reference")._repr_html_()
        self.assertIn("<pre", html)
        self.assertIn("crank-coupler", html)
        self.assertNotIn("<script", html)
        # an image of its own: its style sheet is not the page's
        self.assertNotIn("<style", html)
        data = html.split("data:image/svg+xml;base64,")[1].split('"')[0]
        self.assertIn("<style", base64.b64decode(data).decode())

    def test_progress_goes_up_to_the_end_and_says_what_is_done(self):
        said = []
        paper().run("reference, ode", progress=lambda doing, share: said.append((doing, share)))
        self.assertTrue(said)
        self.assertTrue(all(isinstance(doing, str) and 0 <= share <= 1 for doing, share in said))
        self.assertIn("reference", {doing for doing, _ in said})

    def test_a_line_at_a_terminal_comes_and_goes(self):
        class Terminal(io.StringIO):
            def isatty(self):
                return True

        case = jp.Case("impact-k66")
        case.set({"run.revolutions": 60, "run.samples": 36000, "run.start": "centred"})
        with redirect_stderr(Terminal()) as terminal:
            case.run("reference", certified=False)
        self.assertRegex(terminal.getvalue(), r"^(\r *(reference.* \d+% *\r?)*)*$")
        with redirect_stderr(io.StringIO()) as nowhere:
            case.run("reference", certified=False)
        self.assertEqual(nowhere.getvalue(), "")


tap.main()
