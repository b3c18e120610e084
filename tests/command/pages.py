# Do the commands of a page work as it shows them? Every line of a page that begins with four blanks and
# 'jointplay' is run in turn, in one empty folder; a YAML block whose first line names a file is that
# file; a line of output that the page shows, indented by six blanks, has to be printed by the command
# before it. With --quick, what takes a minute is asked for less. The controls are a page with an option
# that does not exist and one that shows another number.
# Usage: pages.py [--quick] PROGRAM PAGE... Prints TAP.
import os, re, shlex, subprocess, sys, tempfile

arguments = sys.argv[1:]
quick = "--quick" in arguments
program, *pages = [word for word in arguments if word != "--quick"]
# what --quick adds to a command, and where the command has that already
LESS = {
    "tune": "--schemes direct/staggered/impulse --set run.revolutions=0.2",
    "compare": "--steps 50us,30us --schemes direct/staggered --fresh",
    "study": "--dry-run",
    "check": "--quick",
}


def parts(text):
    """Files, commands and shown lines of a page, in their order."""
    for block in re.finditer(r"^```yaml\n# (\S+)\n(.*?)^```|^( {4,}\S[^\n]*)$", text, re.M | re.S):
        name, content, line = block.groups()
        if name:
            yield "file", (name, content)
        elif line.startswith("    jointplay "):
            yield "command", line.strip()
        elif line.startswith("      "):
            yield "line", line.split()


def shorter(command):
    word = shlex.split(command, comments=True)[1]
    less = LESS.get(word, "")
    if not quick or not less or less.split()[0] in command or "--bless" in command:
        return command
    return command.split("#")[0] + " " + less


def run(command):
    expected = re.search(r"# exit status (\d)", command)
    words = shlex.split(shorter(command), comments=True)[1:]
    done = subprocess.run([program, *words], capture_output=True, text=True)
    status = int(expected.group(1)) if expected else 0
    reason = "" if done.returncode == status else f"status {done.returncode}: {done.stderr}"
    return reason, [line.split() for line in done.stdout.splitlines()]


def try_page(text):
    """What is wrong with each command of a page."""
    output = []
    with tempfile.TemporaryDirectory() as folder:
        os.chdir(folder)
        os.environ["XDG_CACHE_HOME"] = folder
        for kind, what in parts(text):
            if kind == "file":
                with open(what[0], "w", encoding="utf-8") as file:
                    file.write(what[1])
            elif kind == "command":
                reason, output = run(what)
                yield what, reason
            elif output and what[0] != "Time:" and not any(what == line for line in output):
                yield "its output", "not printed: " + " ".join(what)
        os.chdir("/")


program = os.path.abspath(program)
pages = [os.path.abspath(page) for page in pages]
number = 0
for page in pages:
    with open(page, encoding="utf-8") as file:
        text = file.read()
    for command, reason in try_page(text):
        number += 1
        print(f"{'not ok' if reason else 'ok'} {number} - {os.path.basename(page)}: {command}".replace("# ", "- "))
        if reason:
            print("# " + reason[:800].replace("\n", "\n# "))
        sys.stdout.flush()
CONTROL = "    jointplay new a.yaml\n    jointplay run a.yaml --no-such\n    jointplay new - \n\n      title: Yours\n"
wrong = [bool(reason) for _, reason in try_page(CONTROL)]
number += 1
print(f"{'ok' if wrong == [False, True, False, True] else 'not ok'} {number} - the controls are found")
print(f"1..{number}")
