// What a file of the program is, known again by how it begins: a file is only replaced by one of
// its own kind. Every writer says which kind it writes; a new one is a row of the table.
#pragma once

#include "base/err.h"

typedef enum FileKind {
    FILE_TABLE,    // CSV
    FILE_PICTURE,  // SVG
    FILE_RESULT,   // JSON
    FILE_REPORT,   // text for people
    FILE_CODE,     // of tune: a C program
    FILE_SDF,      // of tune, for Gazebo
    FILE_MJCF,     // of tune, for MuJoCo
    FILE_JUNIT,    // of check: XML
    FILE_COMMENT,  // of check: Markdown
    FILE_BASELINE, // of check: JSON
    FILE_ROWS,     // of a study: JSON Lines
    FILE_SCRIPT,   // of a study, for Slurm
    FILE_STORE,    // of a study: SQLite, written in place
    FILE_JOURNAL,  // of a comparison: JSON Lines, written in place
    FILE_KIND_COUNT,
} FileKind;

// Whether a file may be written over with one of a kind: it is not there, is empty, is no regular
// file or is of that kind. Fails with ERR_FILE, saying what is in it; `user` is what writes it,
// such as "--plot".
bool file_kind_check(FileKind kind, const char *user, const char *path, Err *err);

// Whether files of a kind are written in place, by what opens them and knows them for its own.
bool file_kind_is_kept(FileKind kind);
