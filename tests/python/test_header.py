# Does the module declare include/jointplay/case.h as it stands? Every function, with so many arguments
# of such kinds; every field of every struct, in its order; every status and its number.
# Usage: test_header.py HEADER. Prints TAP.
import ctypes
import re
import sys
import unittest

import tap
from jointplay import _library as c

with open(sys.argv[1], encoding="utf-8") as file:
    HEADER = re.sub(r"/\*.*?\*/", "", file.read(), flags=re.S)

STRUCTS = {
    "JpCaseError": c.CError, "JpSetting": c.CSetting, "JpRunOptions": c.CRunOptions,
    "JpMapOptions": c.CMapOptions, "JpNumber": c.CNumber, "JpColumn": c.CColumn, "JpKey": c.CKey,
    "JpQuantity": c.CQuantity,
}  # fmt: skip
PLAIN = {
    "int": ctypes.c_int,
    "size_t": ctypes.c_size_t,
    "double": ctypes.c_double,
    "bool": ctypes.c_bool,
}
ENUMS = {"JpCaseStatus": ctypes.c_int}


def words_of(declaration):
    """A type without its name and without const: 'const char *const *keys' is 'char**'."""
    text = re.sub(r"\b(const|struct)\b", " ", declaration)
    array = "[]" if "[" in text else ""
    name = re.sub(r"\[.*", "", text)
    stars = name.count("*")
    parts = name.replace("*", " ").split()
    return parts[0] + "*" * stars + array


def fits(kind, declared):
    """Whether a kind of ctypes is a type of the header."""
    if declared == "void":
        return kind is None
    if declared in PLAIN or declared in ENUMS:
        return kind is {**PLAIN, **ENUMS}[declared]
    if declared in STRUCTS:
        return kind is STRUCTS[declared]
    if declared == "JpProgress":
        return kind is c.CProgress
    if declared == "char*":
        return kind is ctypes.c_char_p
    if declared == "char[]":
        return kind._type_ is ctypes.c_char and kind._length_ == c.ERROR_SIZE
    if declared in ("void*", "JpCase*", "JpAnswer*"):
        return kind is ctypes.c_void_p
    if declared == "double*" and kind is ctypes.c_void_p:
        return True  # an address, of a column
    return declared.endswith("*") and hasattr(kind, "_type_") and fits(kind._type_, declared[:-1])


def functions():
    for result, name, takes in re.findall(
        r"JP_CASE_API\s+([\w\s*]+?)\s*\b(jp_\w+)\(([^)]*)\);", HEADER
    ):
        arguments = [] if takes.strip() == "void" else [words_of(x) for x in takes.split(",")]
        yield name, words_of(result + " x"), arguments


class Header(unittest.TestCase):
    def test_every_function_of_the_header_is_declared_and_no_other(self):
        self.assertEqual(sorted(name for name, *_ in functions()), sorted(c.FUNCTIONS))

    def test_every_function_takes_and_gives_back_what_the_header_says(self):
        for name, result, arguments in functions():
            kind, takes = c.FUNCTIONS[name]
            self.assertTrue(fits(kind, result), f"{name} gives back {result}")
            self.assertEqual(len(takes), len(arguments), name)
            for place, (one, declared) in enumerate(zip(takes, arguments)):
                self.assertTrue(fits(one, declared), f"{name}: argument {place} is {declared}")

    def test_every_struct_has_the_fields_of_the_header_in_their_order(self):
        found = dict(re.findall(r"typedef struct (\w+) \{(.*?)\} \w+;", HEADER, flags=re.S))
        self.assertEqual(sorted(found), sorted(STRUCTS))
        for name, body in found.items():
            fields = [x.strip() for x in body.split(";") if x.strip()]
            names = [re.search(r"(\w+)(\[\w+\])?$", field).group(1) for field in fields]
            self.assertEqual(names, [field[0] for field in STRUCTS[name]._fields_], name)
            for field, (_, kind) in zip(fields, STRUCTS[name]._fields_):
                self.assertTrue(fits(kind, words_of(field)), f"{name}: {field}")

    def test_every_status_has_its_number(self):
        for name, number in re.findall(r"JP_CASE_(?:ERROR_)?([A-Z]+) = (\d+),", HEADER):
            self.assertEqual(getattr(c, name), int(number), name)
        self.assertEqual(
            c.ERROR_SIZE, int(re.search(r"JP_CASE_ERROR_SIZE = (\d+)", HEADER).group(1))
        )

    def test_the_control_a_function_with_another_argument_is_found(self):
        self.assertFalse(fits(ctypes.c_int, "double"))
        self.assertFalse(fits(ctypes.c_char_p, "char**"))


tap.main()
