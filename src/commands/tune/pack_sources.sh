#!/bin/sh
# Puts source files behind one another, each under a line with its folder and name, for
# tune_sources.c. Usage: pack_sources.sh FILE...
for file; do
    printf '//// %s/%s\n' "$(basename "$(dirname "$file")")" "$(basename "$file")"
    cat "$file"
done
