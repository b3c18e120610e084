// Does no output replace what it should not: what is read, another output, a file of another kind?
#include "write/file.h"

#include "base/claims.h"
#include "scratch.h"

#include <fcntl.h>
#include <string.h>
#include <sys/stat.h>

// two files of one kind
#define FIRST  "### jointplay check: first\n"
#define SECOND "### jointplay check: second\n"

static bool claim(const char *path, Err *err)
{
    *err = (Err){0};
    return file_claim("--markdown", FILE_COMMENT, path, err);
}

static void write_file(const char *path, const char *content)
{
    FILE *stream = fopen(path, "w");
    assert_non_null(stream);
    fputs(content, stream);
    assert_int_equal(fclose(stream), 0);
}

static void a_claim_leaves_nothing_behind(void **state)
{
    (void)state;
    char path[256];
    char other[256];
    char inside[300];
    char content[64];
    Err err = {0};
    scratch_path("claimed.txt", path, sizeof path);
    assert_true(claim(path, &err));
    assert_int_equal(access(path, F_OK), -1);
    // and leaves what is there as it is
    scratch_path("claimed-too.txt", other, sizeof other);
    write_file(other, FIRST);
    assert_true(claim(other, &err));
    read_whole(other, content, sizeof content);
    assert_string_equal(content, FIRST);
    assert_true(claim("/dev/null", &err) && claim("/dev/null", &err));
    // what cannot be written: below a file, a folder
    snprintf(inside, sizeof inside, "%s/x", other);
    assert_false(claim(inside, &err));
    assert_int_equal(err.kind, ERR_FILE);
    assert_false(claim("/tmp", &err));
    assert_string_equal(err.text, "cannot write /tmp: Is a directory");
    unlink(other);
}

static void one_file_is_no_two_outputs(void **state)
{
    (void)state;
    char path[256];
    char twisted[300];
    char words[700];
    Err err = {0};
    scratch_path("once.txt", path, sizeof path);
    char *slash = strrchr(path, '/');
    snprintf(twisted, sizeof twisted, "%.*s/./%s", (int)(slash - path), path, slash + 1);
    assert_true(claim(path, &err));
    assert_false(file_claim("--junit", FILE_JUNIT, twisted, &err));
    assert_int_equal(err.kind, ERR_USAGE);
    snprintf(words, sizeof words, "--markdown and --junit would both write %s", twisted);
    assert_string_equal(err.text, words);
    // standard output is one file, too
    assert_true(claim("-", &err));
    assert_false(file_claim("--junit", FILE_JUNIT, "/dev/stdout", &err));
    // an option that was read before is the one that claims it
    err = (Err){0};
    assert_true(claim(path, &err));
}

static void what_is_read_is_not_replaced_by_whatever_name(void **state)
{
    (void)state;
    char path[256];
    char symbolic[256];
    char hard[256];
    char fresh[256];
    Err err = {0};
    scratch_path("read.txt", path, sizeof path);
    scratch_path("read-symbolic.txt", symbolic, sizeof symbolic);
    scratch_path("read-hard.txt", hard, sizeof hard);
    scratch_path("read-not.txt", fresh, sizeof fresh);
    // of the right kind, so that only its being read stands against it
    write_file(path, FIRST);
    assert_int_equal(symlink(path, symbolic), 0);
    assert_int_equal(link(path, hard), 0);
    claims_note_read("case", path);
    const char *const names[] = {path, symbolic, hard};
    for (size_t i = 0; i < 3; i++) {
        assert_false(claim(names[i], &err));
        assert_int_equal(err.kind, ERR_USAGE);
        assert_non_null(strstr(err.text, ", which is the case that this command reads"));
        err = (Err){0};
        assert_false(file_write_text(FILE_COMMENT, names[i], SECOND, &err));
        file_remove(FILE_COMMENT, names[i]);
        assert_int_equal(access(names[i], F_OK), 0);
    }
    assert_true(claim(fresh, &err));
    // whoever comes to have its number later is another file
    unlink(path);
    unlink(symbolic);
    unlink(hard);
    write_file(fresh, FIRST);
    assert_true(file_write_text(FILE_COMMENT, fresh, SECOND, &err));
    unlink(fresh);
}

static void only_a_file_of_its_own_kind_is_replaced(void **state)
{
    (void)state;
    static const struct {
        const char *content, *what;
    } FOREIGN[] = {
        {"t,x\n1,2\n", "begins 't,x'"},
        {"\n\n Dear d\xc3\xa4iary\x1b[31m, today was a long day\n",
         "begins 'Dear d??iary?[31m, today"},
        {"title: a case\nfour-bar: {}\n", "begins 'title: a case'"},
        {"### jointplay chess\n", "begins '### jointplay chess'"},
        {"{ \"tool\" : {\"version\" : \"0.0.9\", \"ode\": \"0\"}}",
         "is a result of jointplay (JSON)"},
        {"<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"9\"><style>text{}</style>",
         "is a picture of jointplay (SVG)"},
        {"run,drive.speed,outcome,reason,alpha\n", "is a table of jointplay (CSV)"},
        {"{\"compare\":{}}\n", "is a store of a comparison"},
        {"{\n  \"format\": \"jointplay baseline 0\"", "is a baseline of jointplay check"},
    };
    char path[256];
    char content[256];
    Err err = {0};
    for (size_t i = 0; i < sizeof FOREIGN / sizeof *FOREIGN; i++) {
        char name[32];
        snprintf(name, sizeof name, "foreign-%zu.txt", i);
        scratch_path(name, path, sizeof path);
        write_file(path, FOREIGN[i].content);
        assert_false(claim(path, &err));
        assert_int_equal(err.kind, ERR_FILE);
        if (strstr(err.text, FOREIGN[i].what) == NULL) {
            fail_msg("%s", err.text);
        }
        assert_non_null(strstr(err.text, "--markdown would replace "));
        assert_non_null(strstr(err.text, "; delete it first or name another file"));
        // nor where nobody asked before
        err = (Err){0};
        assert_false(file_write_text(FILE_COMMENT, path, SECOND, &err));
        file_remove(FILE_COMMENT, path);
        read_whole(path, content, sizeof content);
        assert_string_equal(content, FOREIGN[i].content);
        // an empty file is nobody's
        write_file(path, "");
        err = (Err){0};
        assert_true(file_write_text(FILE_COMMENT, path, SECOND, &err));
        file_remove(FILE_COMMENT, path);
        assert_int_equal(access(path, F_OK), -1);
    }
}

static void a_descriptor_of_the_caller_is_written_to_and_not_emptied(void **state)
{
    (void)state;
    char path[256];
    char name[32];
    char content[64];
    Err err = {0};
    scratch_path("descriptor.txt", path, sizeof path);
    write_file(path, "kept\n");
    const int file = open(path, O_WRONLY | O_APPEND);
    snprintf(name, sizeof name, "/dev/fd/%d", file);
    assert_true(claim(name, &err));
    assert_true(file_write_text(FILE_COMMENT, name, FIRST, &err));
    close(file);
    read_whole(path, content, sizeof content);
    assert_string_equal(content, "kept\n" FIRST);
    // one that is closed, open for reading alone, or the program's own
    assert_false(file_write_text(FILE_COMMENT, name, SECOND, &err));
    assert_int_equal(err.kind, ERR_FILE);
    const int modes[] = {O_RDONLY, O_RDWR | O_CLOEXEC};
    for (size_t i = 0; i < 2; i++) {
        const int other = open(path, modes[i]);
        snprintf(name, sizeof name, "/dev/fd/%d", other);
        err = (Err){0};
        assert_false(file_write_text(FILE_COMMENT, name, SECOND, &err));
        assert_non_null(strstr(err.text, "Bad file descriptor"));
        close(other);
    }
    unlink(path);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_claim_leaves_nothing_behind),
        cmocka_unit_test(one_file_is_no_two_outputs),
        cmocka_unit_test(what_is_read_is_not_replaced_by_whatever_name),
        cmocka_unit_test(only_a_file_of_its_own_kind_is_replaced),
        cmocka_unit_test(a_descriptor_of_the_caller_is_written_to_and_not_emptied),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
