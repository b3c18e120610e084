# Columns and tables with numpy, and the same without it, without pandas and without scipy: what then
# is missing is said by name, and all else works. Usage: test_arrays.py [--without]. Prints TAP.
import math
import pickle
import sys
import unittest

import tap

IS_WITHOUT = "--without" in sys.argv
if IS_WITHOUT:
    sys.argv.remove("--without")
    for package in ("numpy", "pandas", "scipy"):
        sys.modules[package] = None  # as if it were not installed

import jointplay as jp


class Columns:
    @classmethod
    def setUpClass(cls):
        cls.case = jp.Case("pin-in-hole-drop")
        cls.made = cls.case.run("reference", certified=False, ranges=True)

    def test_a_column_has_its_length_unit_and_meaning(self):
        series = self.made.series
        self.assertEqual(len(series["time_s"]), int(self.case["run.samples"]) + 1)
        self.assertEqual(series.unit("hole_force_N"), "N")
        self.assertEqual(list(series), list(series.columns))
        self.assertEqual({len(column) for column in series.values()}, {len(series["time_s"])})

    def test_the_last_time_is_the_runs(self):
        self.assertAlmostEqual(self.made.series["time_s"][-1], 60e-3, delta=1e-15)

    def test_the_largest_of_the_samples_is_within_the_largest_of_the_run(self):
        force = self.made.joints["hole"].force_max
        self.assertEqual(max(self.made.series["hole_force_max_N"]), force)
        self.assertLessEqual(max(self.made.series["hole_force_N"]), force)

    def test_contacts_are_rows_by_onset(self):
        contacts = self.made.contacts
        self.assertEqual(len(contacts), self.made.joints["hole"].impacts)
        onsets = [row.onset for row in contacts]
        self.assertEqual(onsets, sorted(contacts["onset_s"]))
        self.assertEqual(contacts[0].joint, "hole")
        self.assertEqual(contacts[-1]["force_max_N"], contacts["force_max_N"][-1])
        self.assertEqual(contacts[0].force_max.unit, "N")
        # free fall through the clearance: v^2 = 2 g c
        speed = math.sqrt(2 * 9.80665 * 0.1e-3)
        self.assertAlmostEqual(contacts[0].approach_speed / speed, 1, delta=1e-6)

    def test_a_number_is_a_float_that_knows_what_it_is(self):
        force = self.made.joints["hole"].force_max
        self.assertIsInstance(force, float)
        self.assertEqual((force.name, force.unit), ("reference.joints.hole.force_max_N", "N"))
        self.assertEqual(self.made.number(force.name), force)
        self.assertTrue(force.doc)
        self.assertEqual(f"{force}", repr(float(force)))
        self.assertIs(type(force * 2), float)
        again = pickle.loads(pickle.dumps(force))
        self.assertEqual((again, again.unit, again.doc), (force, force.unit, force.doc))


@unittest.skipIf(IS_WITHOUT, "is of numpy")
class WithNumpy(Columns, unittest.TestCase):
    @tap.needs("numpy")
    def test_columns_are_arrays_without_a_copy_that_cannot_be_written(self):
        import numpy as np

        one, other = self.made.series["hole_force_N"], self.made.series["hole_force_N"]
        self.assertIsInstance(one, np.ndarray)
        self.assertEqual((one.dtype, one.flags.writeable), (np.float64, False))
        self.assertEqual(one.__array_interface__["data"], other.__array_interface__["data"])
        self.assertTrue(np.shares_memory(one, other))

    @tap.needs("numpy")
    def test_contacts_are_a_structured_array(self):
        import numpy as np

        array = np.asarray(self.made.contacts)
        self.assertEqual(array.dtype.names, self.made.contacts.columns)
        strong = self.made.contacts[self.made.contacts["force_max_N"] > 100]
        self.assertTrue((strong["force_max_N"] > 100).all())
        self.assertEqual(array["joint"][0], "hole")

    @tap.needs("pandas")
    def test_tables_go_to_pandas(self):
        frame = self.made.contacts.to_pandas()
        self.assertEqual(list(frame.columns), list(self.made.contacts.columns))
        self.assertEqual(len(self.made.series.to_pandas()), len(self.made.series["time_s"]))
        self.assertEqual(frame["force_max_N"].max(), self.made.contacts["force_max_N"].max())


@unittest.skipUnless(IS_WITHOUT, "is of what is without numpy")
class WithoutNumpy(Columns, unittest.TestCase):
    def test_columns_are_memoryviews_of_doubles_that_cannot_be_written(self):
        column = self.made.series["hole_force_N"]
        self.assertIsInstance(column, memoryview)
        self.assertEqual((column.format, column.readonly), ("d", True))

    def test_what_needs_numpy_or_pandas_names_it(self):
        for use, package in (
            (lambda: self.made.contacts.array, "numpy"),
            (lambda: self.made.contacts[1:2], "numpy"),
            (lambda: self.made.contacts.to_pandas(), "pandas"),
            (lambda: self.made.series.to_pandas(), "pandas"),
        ):
            with self.assertRaisesRegex(jp.MissingPackage, f"python3-{package}") as caught:
                use()
            self.assertEqual(caught.exception.name, package)


tap.main()
