// Finds the prefix of an installation or a build by the file that this code was loaded from.
#define _GNU_SOURCE // dladdr1
#include "base/prefix.h"

#include "base/text.h"

#include <dlfcn.h>
#include <limits.h>
#include <link.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

// PREFIX/lib/x86_64-linux-gnu/libjointplay-case.so has three names behind the prefix.
enum { NAMES_MOST = 3, NAMES_OF_PROGRAM = 2 };

static const char DATA[] = "share/jointplay";

static bool drop_name(char *path)
{
    char *slash = strrchr(path, '/');
    if (slash == NULL) {
        return false;
    }
    *slash = '\0';
    return true;
}

static bool has_data(const char *prefix)
{
    char path[PATH_MAX + sizeof DATA];
    snprintf(path, sizeof path, "%s/%s", prefix, DATA);
    return access(path, F_OK) == 0;
}

// The library that this function is in; false in the program itself.
static bool find_library(char *path)
{
    // a function has no pointer to an object in C, and dladdr wants one
    bool (*const function)(char *, size_t) = prefix_find;
    const void *address;
    struct link_map *map = NULL;
    Dl_info info;
    memcpy(&address, &function, sizeof address);
    return dladdr1(address, &info, (void **)&map, RTLD_DL_LINKMAP) != 0 && map != NULL &&
           map->l_name[0] != '\0' && realpath(map->l_name, path) != NULL;
}

static bool find_of_program(char *path)
{
    const ssize_t length = readlink("/proc/self/exe", path, PATH_MAX - 1);
    if (length <= 0) {
        return false;
    }
    path[length] = '\0';
    bool is_found = true;
    for (int i = 0; i < NAMES_OF_PROGRAM; i++) {
        is_found = is_found && drop_name(path);
    }
    return is_found;
}

bool prefix_find(char *prefix, size_t size)
{
    char path[PATH_MAX];
    bool is_found;
    if (find_library(path)) {
        is_found = drop_name(path);
        for (int i = 1; is_found && i < NAMES_MOST && !has_data(path); i++) {
            is_found = drop_name(path);
        }
        is_found = is_found && has_data(path);
    } else {
        is_found = find_of_program(path);
    }
    if (is_found && strlen(path) < size) {
        text_copy(prefix, size, path);
        return true;
    }
    return false;
}
