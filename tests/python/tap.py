# Tests of the module, as lines of TAP: each method test_... of a unittest.TestCase is one line, in the
# words of its name, and one that needs a package which is not there is skipped by that name.
import importlib
import re
import sys
import traceback
import unittest


class _Lines(unittest.TestResult):
    def __init__(self):
        super().__init__()
        self.count = 0

    def _line(self, verdict, test, behind=""):
        self.count += 1
        words = re.sub(r"^test_", "", test.id().split(".", 2)[-1]).replace("_", " ")
        print(f"{verdict} {self.count} - {words}{behind}", flush=True)

    def _failed(self, test, error):
        self._line("not ok", test)
        text = "".join(traceback.format_exception(*error))
        print("# " + text.strip().replace("\n", "\n# "), flush=True)

    def addSuccess(self, test):
        super().addSuccess(test)
        self._line("ok", test)

    def addFailure(self, test, error):
        super().addFailure(test, error)
        self._failed(test, error)

    def addError(self, test, error):
        super().addError(test, error)
        self._failed(test, error)

    def addSubTest(self, test, part, error):
        super().addSubTest(test, part, error)
        if error is not None:
            self._failed(part, error)

    def addSkip(self, test, reason):
        super().addSkip(test, reason)
        self._line("ok", test, f" # SKIP {reason}")


def needs(package):
    """Skips a test where a package is not installed, by its name."""
    try:
        importlib.import_module(package)
    except ImportError:
        return unittest.skip(f"needs python3-{package}")
    return lambda test: test


def main():
    """Runs the tests of the script that calls it."""
    lines = _Lines()
    tests = unittest.defaultTestLoader.loadTestsFromModule(sys.modules["__main__"])
    tests.run(lines)
    print(f"1..{lines.count}")
    sys.exit(0 if lines.wasSuccessful() else 1)
