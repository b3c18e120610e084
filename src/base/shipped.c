// Finds the cases that came with the program.
#include "base/shipped.h"

#include "base/prefix.h"
#include "base/text.h"

#include <dirent.h>
#include <limits.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

static const char SHIPPED_DATA[] = "share/jointplay";

static bool is_joined(char *found, size_t size, const char *folder, const char *path,
                      const char *ending)
{
    const int length = snprintf(found, size, "%s/%s%s", folder, path, ending);
    return length > 0 && (size_t)length < size && access(found, F_OK) == 0;
}

// A case of that name in one of the folders of a folder; names occur once.
static bool find_name(const char *cases, const char *name, char *found, size_t size)
{
    DIR *folder = opendir(cases);
    if (folder == NULL) {
        return false;
    }
    bool is_found = false;
    for (const struct dirent *entry; !is_found && (entry = readdir(folder)) != NULL;) {
        char inner[PATH_MAX];
        const int length = snprintf(inner, sizeof inner, "%s/%s", cases, entry->d_name);
        is_found = entry->d_name[0] != '.' && length < (int)sizeof inner &&
                   is_joined(found, size, inner, name, ".yaml");
    }
    closedir(folder);
    return is_found;
}

bool shipped_find_own(const char *path, char *found, size_t size)
{
    char prefix[PATH_MAX];
    char data[PATH_MAX + sizeof SHIPPED_DATA];
    char cases[sizeof data + sizeof "/cases"];
    text_copy(found, size, path);
    if (path[0] == '\0' || path[0] == '/' || !prefix_find(prefix, sizeof prefix)) {
        return false;
    }
    snprintf(data, sizeof data, "%s/%s", prefix, SHIPPED_DATA);
    snprintf(cases, sizeof cases, "%s/cases", data);
    if ((strncmp(path, "cases/", 6) == 0 || strncmp(path, "results/", 8) == 0) &&
        is_joined(found, size, data, path, "")) {
        return true;
    }
    // the name of a file that is missing stays an error
    if (strpbrk(path, "/.") == NULL && find_name(cases, path, found, size)) {
        return true;
    }
    text_copy(found, size, path);
    return false;
}

bool shipped_find(const char *path, char *found, size_t size)
{
    if (access(path, F_OK) == 0) {
        text_copy(found, size, path);
        return false;
    }
    return shipped_find_own(path, found, size);
}
