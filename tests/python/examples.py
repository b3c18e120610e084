# Do the examples of docs/python.md work as they stand there, and print what the page shows below them?
# And the lesson: do the cells of its notebook run in their order, and is what it shows of a run HTML?
# What needs a package or a driver that is not there is skipped by its name. The control is an example
# that prints something else. With --write the page is written to stdout with what they print.
# Usage: examples.py [--write] PAGE NOTEBOOK FOLDER_OF_MODULE [MUJOCO_DRIVER]. Prints TAP.
import ast
import importlib.util
import json
import re
import subprocess
import sys
import tempfile

writes = "--write" in sys.argv
page, notebook, module, *driver = [word for word in sys.argv[1:] if word != "--write"]
BLOCK = re.compile(
    r"^### (\d+\. [^\n]*)\n(?:(?!^#).)*?^```python\n(.*?)^```\n\n```\n(.*?)^```\n", re.M | re.S
)


def lacks(code):
    """What an example needs and is not there, by name; or nothing."""
    for node in ast.walk(ast.parse(code)):
        names = [x.name for x in node.names] if isinstance(node, ast.Import) else []
        names += [node.module] if isinstance(node, ast.ImportFrom) else []
        for name in (name.split(".")[0] for name in names):
            if name != "jointplay" and importlib.util.find_spec(name) is None:
                return f"python3-{name}"
    if ".to_pandas()" in code and importlib.util.find_spec("pandas") is None:
        return "python3-pandas"
    if "mujoco" in code and not driver:
        return "the driver of MuJoCo"
    return ""


def run(code):
    with tempfile.TemporaryDirectory() as folder:
        done = subprocess.run(
            [sys.executable, "-W", "error", "-c", f"import sys; sys.path.insert(0, {module!r})\n" + code],
            capture_output=True, text=True, cwd=folder,
        )  # fmt: skip
    return done.stdout if done.returncode == 0 else f"status {done.returncode}\n{done.stderr}"


def cells_of(path):
    with open(path, encoding="utf-8") as file:
        cells = json.load(file)["cells"]
    return ["".join(cell["source"]) for cell in cells if cell["cell_type"] == "code"]


def as_shown(cells):
    """The cells as one script that shows what stands last in a cell as a notebook does."""
    lines = []
    for cell in cells:
        body = ast.parse(cell).body
        if isinstance(body[-1], ast.Expr) and not isinstance(body[-1].value, ast.Call):
            last = ast.unparse(body.pop())
            lines.append("\n".join(map(ast.unparse, body)) + f"\nprint({last}._repr_html_())")
        else:
            lines.append(cell)
    return "\n".join(lines)


def count(verdict, name, said="", skip=""):
    count.number += 1
    print(f"{verdict} {count.number} - {name}{' # SKIP needs ' + skip if skip else ''}")
    if said:
        print("# " + said.strip().replace("\n", "\n# "))
    sys.stdout.flush()


count.number = 0
with open(page, encoding="utf-8") as file:
    text = file.read()
# the first block of all stands before the ten
BEGIN = re.compile(r"\A(.*?)^```python\n(.*?)^```\n\n```\n(.*?)^```\n", re.M | re.S)
examples = [("the beginning of the page", *BEGIN.search(text).groups()[1:]), *BLOCK.findall(text)]
if writes:
    for _, code, shown in examples:
        before = f"```python\n{code}```\n\n```\n"
        if not lacks(code):
            text = text.replace(before + shown + "```\n", before + run(code) + "```\n")
    sys.stdout.write(text)
    sys.exit(0)
for name, code, shown in examples:
    lack = lacks(code)
    said = "" if lack else run(code)
    verdict = "ok" if lack or said == shown else "not ok"
    count(
        verdict,
        name,
        "" if verdict == "ok" else f"printed:\n{said}\nthe page shows:\n{shown}",
        lack,
    )
said = run(as_shown(cells_of(notebook)))
is_good = "data:image/svg+xml" in said and "<pre" in said and "status" not in said.split("\n")[0]
count(
    "ok" if is_good else "not ok",
    "10. the lesson runs, and shows a run with its picture",
    "" if is_good else said[:2000],
)
ten = {int(name.split(".")[0]) for name, *_ in examples[1:]} | {10}
count("ok" if ten == set(range(1, 11)) else "not ok", "there are ten examples")
is_found = run("print(1)") != "2\n" and run("raise SystemExit(1)").startswith("status 1")
count("ok" if is_found else "not ok", "the controls: another output, and a failure, are found")
print(f"1..{count.number}")
