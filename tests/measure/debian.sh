#!/bin/sh
# Builds the Debian packages, asks lintian about them, and runs the commands of README and tutorial and
# the examples of docs/python.md from the unpacked packages in an empty folder. Needs debhelper,
# dh-python, lintian and what packages.txt lists under build; a quarter of an hour.
# Usage: debian.sh [FOLDER for the packages]
set -eu
root=$(cd "$(dirname "$0")/../.." && pwd)
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
mkdir "$work/jointplay"
(cd "$root" && git ls-files -z | tar --null -T - -cf -) | tar -xf - -C "$work/jointplay"
(cd "$work/jointplay" && dpkg-buildpackage -us -uc -b) >"$work/log" 2>&1 || {
    tail -n 40 "$work/log"
    exit 1
}
lintian --allow-root --fail-on error,warning "$work"/jointplay_*.changes
echo "lintian has no error and no warning"
for package in "$work"/*.deb; do
    dpkg-deb -x "$package" "$work/root"
done
python3 "$root/tests/command/pages.py" "$work/root/usr/bin/jointplay" "$root/README.md" \
    "$root/docs/tutorial.md"
module=$work/root/usr/lib/python3/dist-packages
python3 "$root/tests/python/examples.py" "$root/docs/python.md" "$root/docs/examples/clearance.ipynb" "$module"
[ $# = 0 ] || cp "$work"/*.deb "$1"
