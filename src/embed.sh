#!/bin/sh
# Writes the assembler file that puts a file into the program, byte for byte, between SYMBOL and
# SYMBOL_end. The file's sum stands in it, so that it changes with the file: ninja knows nothing of
# an .incbin. Usage: embed.sh SYMBOL FILE
cat <<END
/* $(cksum <"$2") */
    .section .rodata
    .global $1
    .global $1_end
$1:
    .incbin "$2"
$1_end:
    .byte 0
    .section .note.GNU-stack,"",@progbits
END
