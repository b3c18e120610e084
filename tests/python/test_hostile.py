# Does everything that a caller can do wrong end in an exception, and never in a crash? Wrong kinds and
# values, what is closed or freed, calls from a callback, Ctrl-C, a library that is not there.
# Prints TAP.
import copy
import gc
import os
import pickle
import signal
import subprocess
import sys
import threading
import time
import unittest
import weakref

import jointplay as jp
import tap

LONG = {"run.revolutions": 10000, "run.samples": 1, "run.start": "centred"}  # for minutes


def drop():
    return jp.Case("pin-in-hole-drop")


def call(script, **more):
    """A script in a process of its own: its status and what it said."""
    done = subprocess.run(
        [sys.executable, "-c", script],
        capture_output=True,
        text=True,
        env={**os.environ, **more},
        timeout=60,
    )
    return done.returncode, done.stdout + done.stderr


class Hostile(unittest.TestCase):
    def test_a_case_that_is_none_is_an_error(self):
        for source in (None, 3, b"impact-k66", ["impact-k66"], object()):
            with self.assertRaises((TypeError, jp.Error)):
                jp.Case(source)
        for source in (
            "",
            "no-such-case",
            "a\0b",
            "\n",
            "title: x\n",
            "[\n",
            "\ud800",
            "x" * 100000,
            "/",
        ):
            with self.assertRaises(jp.Error):
                jp.Case(source)
        with self.assertRaises(jp.Error):
            jp.Case.from_text("title: [")

    def test_a_case_is_a_mapping_in_what_it_lacks(self):
        case = drop()
        self.assertEqual(case.get("drive.sped", 5), 5)
        self.assertEqual(case.pop("drive.sped", 5), 5)
        for lacks in (case.__getitem__, case.__delitem__, case.pop, case.setting):
            with self.assertRaises(KeyError) as caught:
                lacks("run.sample")
            self.assertIsInstance(caught.exception, jp.CaseError)
            self.assertIn("did you mean 'run.samples'?", str(caught.exception))
        with self.assertRaises(KeyError):
            case.popitem()
        samples = case["run.samples"]
        case.set({"run.samples": 7, "contact.restitution": 0.5})
        self.assertEqual(case.popitem(), ("run.samples", 7))
        case["run.samples"] = 8
        case.clear()
        self.assertEqual(case["run.samples"], samples)
        with self.assertRaises(KeyError):
            case.popitem()

    def test_what_is_no_value_is_refused_by_its_kind(self):
        case = drop()
        for value in (b"3", bytearray(b"3"), {"mean": 3}, 3j, object()):
            with self.assertRaises(TypeError):
                case["run.samples"] = value

    def test_the_place_of_a_mistake_is_told(self):
        with self.assertRaises(jp.CaseError) as caught:
            jp.Case("title: A\nbodies:\n  ball: {mass: 1, inertia: 1 kg m^2, at: [0 m, 0 m]}\n")
        self.assertEqual((caught.exception.line, caught.exception.status), (3, 3))
        self.assertGreater(caught.exception.column, 0)

    def test_wrong_keys_and_values_change_nothing(self):
        case = drop()
        before = case.settings()
        wrong = [
            ("", "1"), ("joints", "1"), ("joints.hole.hole", "3 kg"), ("joints.hole.hole", ""), ("a\0b", "1"),
            ("joints.hole.hole", "1 mm\0"), ("joints.hole.hole", float("nan")), ("joints.hole.hole", float("inf")),
            ("joints.hole.hole", -1), ("contact.damping", 3), ("contact.damping", True), ("run.samples", 1e300),
            ("joints.hole.hole", "x" * 1000000), ("joints.hole.hole", []), ("joints.hole.hole", [[1]]),
            ("joints.*.hole", "20 mm"), ("run.backends", "no-such"), ("run.samples", 10**400),
        ]  # fmt: skip
        for key, value in wrong:
            with self.assertRaises(
                (jp.CaseError, TypeError, OverflowError), msg=f"{key!r}: {str(value)[:20]}"
            ):
                case[key] = value
        for key in (None, 3, ("a",), b"joints"):
            with self.assertRaises((jp.CaseError, TypeError)):
                case[key] = "1"
            with self.assertRaises((jp.CaseError, TypeError)):
                case[key]
        for values in (
            3,
            {"joints.hole.hole": "20.3 mm", "joints.hole.pin": "21 mm"},
            {3: "1"},
            {"a": object()},
        ):
            with self.assertRaises((jp.CaseError, TypeError)):
                case.set(values)
        self.assertEqual(case.settings(), before)

    def test_wrong_options_are_errors(self):
        case = drop()
        for backends in ("no-such", "", 3, [3], ["reference", None], "a\0b", "ode;reference"):
            with self.assertRaises((jp.CaseError, TypeError), msg=repr(backends)):
                case.run(backends)
        for options in ({"threads": -1}, {"threads": "2"}, {"threads": 1.5}, {"time_limit": "long"}, {"drivers": {"a=b": "c"}},
                        {"drivers": {"": ""}}, {"progress": 3}, {"no_such": 1}):  # fmt: skip
            with self.assertRaises((jp.CaseError, TypeError), msg=repr(options)):
                case.run("reference", certified=False, **options)
        for options in (
            {"step": "1 kg"},
            {"step": -1},
            {"step": []},
            {"maps": "no-such"},
            {"laws": 3},
            {"mass": object()},
        ):
            with self.assertRaises((jp.CaseError, TypeError), msg=repr(options)):
                jp.Case("impact-k66").map(**options)
        for processes in (0, -1, "2", True, None):
            with self.assertRaises(jp.CaseError):
                jp.sweep(case, {}, processes=processes)
        with self.assertRaises(jp.CaseError):
            jp.sweep(case, {"contact.restitution": "0.5"})

    def test_names_that_an_answer_does_not_have_are_errors(self):
        run = drop().run("reference", certified=False)
        for name in (
            "",
            ".",
            "joints",
            "joints.",
            "joints.hole.",
            "a\0b",
            "x" * 100000,
            "joints.hole.spikes.99999999999",
        ):
            with self.assertRaises(jp.CaseError, msg=name[:40]):
                run.number(name)
            with self.assertRaises((KeyError, jp.CaseError)):
                run.series[name]
        for name in (None, 3, b"steps"):
            with self.assertRaises((jp.CaseError, TypeError)):
                run.number(name)
            with self.assertRaises((KeyError, TypeError, jp.CaseError)):
                run.series[name]
        for row in (10**6, -(10**6)):
            with self.assertRaises(IndexError):
                run.contacts[row]

    def test_what_a_failed_run_has_not_says_why(self):
        run = drop().run("reference, driver", drivers={"driver": "/bin/false"})
        failed = run["driver"]
        self.assertEqual(failed.status, "failed")
        self.assertIn("ended with exit status 1", failed.message)
        for use in (
            lambda: failed.joints["hole"],
            lambda: failed.error.max,
            lambda: failed.series["time_s"],
            lambda: failed.contacts[0],
        ):
            with self.assertRaisesRegex(Exception, "driver failed: .*ended with exit status 1"):
                use()
        self.assertGreater(run.joints["hole"].force_max, 0)

    def test_what_is_closed_says_so(self):
        case = drop()
        run = case.run("reference", certified=False)
        case.close()
        case.close()
        for use in (lambda: case.run(), lambda: case["contact.restitution"], lambda: case.copy(), lambda: list(case),
                    lambda: case.set({}), lambda: pickle.dumps(case), lambda: copy.deepcopy(case)):  # fmt: skip
            with self.assertRaises(jp.CaseError):
                use()
        force, contacts = run.series["hole_force_N"], run.contacts
        peak = max(force)
        run.close()
        run.close()
        self.assertEqual(repr(run), "<run, closed>")
        for use in (lambda: run.steps, lambda: run.json, lambda: run.series["crank_deg"], lambda: contacts[0],
                    lambda: run.joints["hole"], lambda: dir(run), lambda: pickle.dumps(run)):  # fmt: skip
            with self.assertRaises((jp.Error, KeyError, AttributeError)):
                use()
        gc.collect()
        self.assertEqual(max(force), peak)

    def test_columns_outlive_what_they_came_from(self):
        run = drop().run("reference", certified=False)
        force = run.series["hole_force_N"]
        peak, gone = max(force), weakref.ref(run)
        del run
        gc.collect()
        self.assertIsNone(gone())
        for _ in range(3):
            drop().run("reference", certified=False)
        self.assertEqual(max(force), peak)
        with self.assertRaises((TypeError, ValueError)):
            force[0] = 1

    def test_calls_from_a_callback_are_refused_or_work(self):
        case, other, said = drop(), drop(), []

        def ask(doing, share):
            for use in (lambda: case.run(), lambda: case.copy(), lambda: case.close(), lambda: case["title"],
                        lambda: case.set({}), lambda: case.settings()):  # fmt: skip
                try:
                    use()
                    said.append("no error")
                except jp.CaseError as error:
                    said.append(str(error))
            if not said[6:]:
                other.run("reference", certified=False).joints["hole"].force_max

        run = case.run("reference", progress=ask)
        self.assertTrue(said)
        self.assertNotIn("no error", said)
        self.assertGreater(run.joints["hole"].force_max, 0)

    def test_callbacks_that_ask_for_each_others_cases_do_not_wait_for_ever(self):
        cases, both, said = (drop(), drop()), threading.Barrier(2), []

        def use(mine, other):
            asked = []

            def ask(doing, share):
                if asked:
                    return
                asked.append(doing)
                both.wait(30)
                for call in (lambda: other["title"], other.close):
                    with self.assertRaisesRegex(jp.CaseError, "in use by another thread"):
                        call()
                said.append(both.wait(30))

            mine.run("reference", certified=False, progress=ask)

        threads = [
            threading.Thread(target=use, args=pair, daemon=True) for pair in (cases, cases[::-1])
        ]
        [thread.start() for thread in threads]
        [thread.join(60) for thread in threads]
        self.assertEqual(sorted(said), [0, 1])
        # when the runs are over, both cases are free
        self.assertEqual(*(case["run.samples"] for case in cases))

    def test_a_handler_of_signals_may_ask_what_it_interrupts(self):
        case = drop()
        run = case.run("reference", certified=False)
        asked = []

        def ask(*_):
            asked.append(run.steps)
            try:
                asked.append(case["run.samples"])
            except jp.CaseError:  # that is being run
                pass

        before = signal.signal(signal.SIGALRM, ask)
        signal.setitimer(signal.ITIMER_REAL, 0.002, 0.002)
        try:
            begin = time.monotonic()
            while time.monotonic() - begin < 1:
                case["contact.restitution"] = 0.5
                run.number("steps"), run.series["time_s"]
        finally:
            signal.setitimer(signal.ITIMER_REAL, 0)
            signal.signal(signal.SIGALRM, before)
        self.assertGreater(len(asked), 20)

    def test_what_a_callback_raises_ends_the_run(self):
        case = jp.Case("impact-k66")
        case.set(LONG)

        class Mine(BaseException):
            pass

        def stop(doing, share):
            raise Mine(doing)

        for _ in range(3):
            with self.assertRaises(Mine):
                case.run("reference", certified=False, progress=stop)
        case.set({"run.revolutions": 0.1, "run.samples": 360})
        self.assertGreater(
            case.run("reference", certified=False).joints["crank-coupler"].force_max, 0
        )

    def test_the_last_reference_may_go_in_a_callback(self):
        holder = [drop()]
        run = holder[0].run("reference", progress=lambda doing, share: holder.clear())
        self.assertGreater(run.joints["hole"].force_max, 0)

    def test_threads_may_share_a_case_and_an_answer(self):
        case = drop()
        run = case.run("reference", certified=False)
        wanted, errors = run.joints["hole"].force_max, []

        def use(number):
            try:
                for _ in range(5):
                    mine = case.run("reference", certified=False, threads=1)
                    if mine.joints["hole"].force_max != wanted or len(run.series["time_s"]) != len(
                        mine.series["time_s"]
                    ):
                        errors.append(number)
                    run.json_text, run.names, case.settings()
            except BaseException as error:
                errors.append(error)

        threads = [threading.Thread(target=use, args=[x]) for x in range(4)]
        [thread.start() for thread in threads]
        [thread.join() for thread in threads]
        self.assertEqual(errors, [])

    def test_ctrl_c_ends_a_run(self):
        script = (
            f"import jointplay as jp, os, signal, threading; case = jp.Case('impact-k66'); case.set({LONG!r})\n"
            "threading.Timer(0.5, os.kill, (os.getpid(), signal.SIGINT)).start()\n"
            "try: case.run('reference', certified=False)\n"
            "except KeyboardInterrupt: print('interrupted', case['run.samples'])\n"
        )
        begin = time.monotonic()
        status, said = call(script)
        self.assertEqual((status, said.strip()), (0, "interrupted 1.0"))
        self.assertLess(time.monotonic() - begin, 20)

    def test_ctrl_c_ends_a_sweep_and_its_processes(self):
        script = (
            f"import jointplay as jp, os, signal, threading; case = jp.Case('impact-k66'); case.set({LONG!r})\n"
            "threading.Timer(1.5, os.kill, (os.getpid(), signal.SIGINT)).start()\n"
            "try: list(jp.sweep(case, {'contact.restitution': [0.5, 0.6, 0.7]}, 'reference', processes=2, certified=False))\n"
            "except KeyboardInterrupt: print('interrupted')\n"
        )
        status, said = call(script)
        self.assertEqual((status, said.strip()), (0, "interrupted"))

    def test_a_process_that_dies_is_one_point(self):
        def kill():
            found = subprocess.run(
                ["pgrep", "-P", str(os.getpid())], capture_output=True, text=True
            ).stdout.split()
            for one in map(int, found):
                try:
                    with open(f"/proc/{one}/cmdline", "rb") as file:
                        is_worker = b"jointplay._sweep" in file.read()
                    if is_worker:
                        os.kill(one, signal.SIGKILL)
                except OSError:
                    pass

        case = jp.Case("impact-k66")
        case.set({"run.start": "centred", "run.samples": 10})
        points = jp.sweep(
            case, {"run.revolutions": [10000, 0.1, 0.1]}, "reference", processes=2, certified=False
        )
        threading.Timer(2, kill).start()
        first, *others = list(points)
        self.assertIn("ended with status", str(first.error))
        with self.assertRaises(jp.SolverError):
            first.run
        self.assertTrue(all(point.run.joints["crank-coupler"].force_max > 0 for point in others))

    def test_a_library_that_is_not_there_is_named(self):
        status, said = call("import jointplay", JOINTPLAY_LIBRARY="/no/such/library.so")
        self.assertEqual(status, 1)
        self.assertIn("ImportError", said)
        self.assertIn("JOINTPLAY_LIBRARY", said)
        status, said = call("import jointplay", JOINTPLAY_LIBRARY="libm.so.6")
        self.assertEqual(status, 1)
        self.assertIn("older than this module", said)

    def test_the_control_a_right_call_is_no_error(self):
        case = drop()
        case["joints.hole.hole"] = "20.3 mm"
        self.assertAlmostEqual(case["joints.hole.hole"], 20.3e-3, delta=1e-15)
        self.assertGreater(
            case.run("reference", certified=False, threads=1).joints["hole"].force_max, 0
        )


tap.main()
