# Lines of TAP, for tests in shell: sourced by them. Where the variable log names a file, it is shown
# after a check that failed.

number=0

# A check: what it says, and the status that it ended with.
report() {
    number=$((number + 1))
    if [ "$2" = 0 ]; then
        echo "ok $number - $1"
    else
        echo "not ok $number - $1"
        if [ -n "${log:-}" ]; then sed 's/^/# /' "$log"; fi
    fi
}
