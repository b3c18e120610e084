#!/bin/sh
# Does the Debian package say what the project says? Its version, the packages it is built with, and the
# files that it takes. tests/measure/debian.sh builds it. The controls are a version and a package that
# are not there. Usage: debian.sh SOURCES VERSION. Prints TAP.
set -u
root=$1
version=$2
. "$root/tests/support/tap.sh"
work=$(mktemp -d) || exit 1
trap 'rm -rf "$work"' EXIT
log=$work/log
: >"$log"

has_version() { head -n 1 "$root/debian/changelog" | grep -qF "jointplay ($1) "; }

# Packages to build with that one list has and the other lacks; of packages.txt without what every
# build of a Debian package has, and ninja, which comes with meson. What makes the packages beside may
# be of other kinds of that list.
differences() {
    awk '$1 == "build" && $2 !~ /^(gcc|libc6-dev|ninja-build)$/ { print $2 }' "$1" | sort >"$work/ours"
    awk '$1 == "package" || $1 == "test" { print $2 }' "$1" >"$work/beside"
    awk '/^Build-Depends:/ { is_in = 1 } /^Standards/ { is_in = 0 } is_in' "$root/debian/control" |
        tr ',' '\n' | sed 's/^Build-Depends://; s/([^)]*)//; s/ //g' | grep -v '^$' |
        grep -v '^debhelper-compat$' | grep -vxFf "$work/beside" | sort >"$work/theirs"
    diff "$work/ours" "$work/theirs" >"$log"
}

has_version "$version"
report "debian/changelog has the version of the project" $?
! has_version 9.9.9
report "the control: another version is not there" $?
differences "$root/packages.txt"
report "the package is built with what packages.txt lists" $?
{ cat "$root/packages.txt"; echo 'build libnothing-dev none'; } >"$work/more"
! differences "$work/more" && grep -q libnothing-dev "$log"
report "the control: a package that one list lacks is found" $?
[ -x "$root/debian/rules" ] && [ "$(cat "$root/debian/source/format")" = '3.0 (native)' ]
report "debian/rules can be run" $?
echo "1..$number"
