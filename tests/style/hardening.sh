#!/bin/sh
# Is the program built so that a mistake with memory ends it and no more? Prints TAP.
set -u
program=$1
readelf=$2

. "$(dirname "$0")/../support/tap.sh"

# Whether a line of what readelf says of a file has the words.
says() {
    "$readelf" -W "$1" "$2" | grep -qE "$3"
}

echo 1..6
says --file-header "$program" 'Type: +DYN'
report "it can be loaded anywhere" $?
says --program-headers "$program" GNU_RELRO && says --dynamic "$program" 'BIND_NOW|Flags:.* NOW'
report "the addresses of library functions cannot be written to" $?
says --dyn-syms "$program" '__stack_chk_fail'
report "the stack has guards" $?
says --dyn-syms "$program" '__(v?snprintf|memcpy|fprintf)_chk'
report "copies are checked" $?
says --program-headers "$program" 'GNU_STACK.* RW +0x'
report "nothing on the stack is run" $?
# the control
! says --dyn-syms "$program" '__no_such_function_chk'
report "what is not there is not found" $?
