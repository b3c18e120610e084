// What the files of libjointplay-case share: a case, an answer, and how a call is made.
#pragma once

#include "base/call.h"
#include "base/err.h"
#include "base/text.h"
#include "casefile/casefile.h"
#include "commands/map/map.h"
#include "commands/run/case_run.h"
#include <jointplay/case.h>

#include <jansson.h>
#include <stdatomic.h>

// How a call is made: under a guard that is left where there is no memory or an assertion fails.
// What the call took is given back then.

// The work of a call. Fails with the error of the command line.
typedef bool LibraryWork(void *context, Err *err);

typedef struct LibraryCall {
    LibraryWork *work;
    void *context;
    const char *name;    // of the case, that stands before places in its text; NULL: none
    size_t threads;      // 0: as many as there are processors
    JpProgress progress; // NULL: nobody watches
    void *watcher;       // its context
    bool is_alone;       // no other such call at the same time
    locale_t callers;    // of the thread, meanwhile
} LibraryCall;

// Makes the call. `error` may be NULL. The work may have been left anywhere: what it was to hand
// out is for use where the status is JP_CASE_OK alone.
JpCaseStatus library_call(LibraryCall *call, JpCaseError *error);

// An error that needs no call: of an argument. Returns its status.
JpCaseStatus library_refuse(JpCaseError *error, const char *sentence);

// Clears the error, for what succeeds without a call.
JpCaseStatus library_accept(JpCaseError *error);

// Who watches the call of this thread: its progress is shown, and may cancel it. Zeroed at first.
typedef struct LibraryWatch {
    const LibraryCall *call;
    const char *doing;
    double shown_s; // by the clock, when it last was
} LibraryWatch;

RunWatch library_watch(LibraryWatch *watch, const char *doing);
void library_watch_show(LibraryWatch *watch, double share);

// A case.

// A case that is read once for many settings.
typedef struct CaseReader {
    CasefileRepeat *repeat; // owned
    bool is_touched;        // by the call under way: where that breaks off, it is lost
} CaseReader;

struct JpCase {
    atomic_flag is_busy;  // a call is made with it
    atomic_bool is_freed; // meanwhile
    char *name;           // all owned
    char *text;
    size_t size;
    size_t set_count;
    char **set;            // KEY=VALUE each
    CaseReader reader;     // that reads it with these
    CaseReader run_reader; // and with what a run adds to them
    Scenario *scenario;    // as it is written, before any start is looked for
    size_t setting_count;  // of those below; 0: not listed yet
    JpSetting *settings;
    size_t asked_count; // settings that were handed out without the list
    size_t asked_room;
    JpSetting *asked;
    char *notes; // NULL: not written yet
};

// Lets a call have a case; false where another has it. Takes it back from a call that ended so.
bool case_take(JpCase *of);
void case_give_back(JpCase *of, JpCaseStatus status);

// The scenario of a case for a run, with further settings; for scenario_free. In a call. Fails as
// casefile_load does.
bool case_scenario(JpCase *of, const char *const *further, size_t count, Scenario *scenario,
                   Err *err);

// Frees a case that no call has; NULL is accepted.
void case_destroy(JpCase *of);

// An answer.

typedef enum AnswerKind { ANSWER_RUN, ANSWER_SETTLED, ANSWER_MAP } AnswerKind;

// A column that was asked for.
typedef struct AnswerColumn {
    char *name; // owned
    char *unit; // owned
    const char *doc;
    bool is_made;
    size_t count;
    double *numbers;    // owned
    const char **words; // owned, but not what they point to
} AnswerColumn;

// A table of a run.
typedef enum AnswerTable {
    TABLE_SERIES,
    TABLE_CONTACTS,
    TABLE_SPIKES,
    ANSWER_TABLE_COUNT
} AnswerTable;

typedef struct AnswerColumns {
    bool is_listed;
    size_t count;
    AnswerColumn *columns; // owned
} AnswerColumns;

// A leaf of the JSON of an answer.
typedef struct AnswerLeaf {
    char *name;
    const char *word; // of the JSON; NULL: it is a number
    double value;
    size_t run; // it is of; SIZE_MAX: of none
} AnswerLeaf;

typedef struct AnswerLeaves {
    bool is_listed;
    size_t count;
    size_t room;
    AnswerLeaf *leaves; // owned
    size_t *sorted;     // by name; owned
    size_t number_count;
    size_t *numbers; // those that are numbers, in order; owned
} AnswerLeaves;

enum { ANSWER_FORM_COUNT = 3 };

struct JpAnswer {
    AnswerKind kind;
    CaseRun *run; // of a run, else NULL; owned, as all below
    Scenario *scenario;
    Mapping *mapping;
    json_t *json;
    char *json_text;
    size_t json_length;
    AnswerLeaves leaves;
    size_t asked_count; // names of numbers that were handed out without them
    size_t asked_room;
    char **asked;                                // owned, as they are
    AnswerColumns (*tables)[ANSWER_TABLE_COUNT]; // by run
    Text forms[ANSWER_FORM_COUNT];
};

// Frees an answer, whatever it has; NULL is accepted.
void answer_destroy(JpAnswer *of);

// Its JSON as values, made once. In a call.
const json_t *answer_values(JpAnswer *of);

// Which run a name is of: that of the backend in front of it, which is then taken off, or the
// first. False where the answer has no runs.
bool answer_find_run(const JpAnswer *of, const char **name, size_t *run);

// The unit that the end of a name says, and what a number means whose name, below that of its run,
// is given: empty where there is none.
const char *listing_unit(const char *name);
const char *listing_doc(const char *name);

// Which number of a run a name is, and of whom; false where it is none of one name at most.
typedef struct ListingPlace {
    NumberId id;
    NumberTurn turn;
    const char *path;
    char member[LINKAGE_NAME_SIZE]; // empty of the run as a whole
} ListingPlace;

bool listing_find(const char *name, ListingPlace *place);
