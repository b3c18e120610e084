// How is a store opened?
#include "commands/study/store_inside.h"

#include <assert.h>
#include <sqlite3.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static Store *make_store(const char *path)
{
    Store *store = calloc(1, sizeof *store);
    assert(store != NULL);
    store->lock = -1;
    store->path = strdup(path);
    assert(store->path != NULL);
    return store;
}

static void destroy(Store *store)
{
    sqlite3_finalize(store->add_run);
    sqlite3_finalize(store->add_effort);
    sqlite3_finalize(store->find);
    sqlite3_finalize(store->rows);
    store_file_close(store);
    store_schema_finish(store);
    free(store->path);
    free(store);
}

// Creates the tables where there are none, and compares those that exist with what is expected.
static bool settle(Store *store, const StoreHead *head, const char *source, Err *err)
{
    bool is_there = false;
    if (!store_shape_is_there(store, &is_there, err) ||
        (!is_there && !store_schema_make(store, head, err))) {
        return false;
    }
    return store_schema_read(store, err) && store_schema_check(store, head, source, err) &&
           (!is_there || store_file_check(store, err));
}

static Store *open_to_work(const char *path, const StoreHead *head, bool is_fresh,
                           const char *source, Err *err)
{
    assert(head->key_count <= STORE_KEY_MAX);
    Store *store = make_store(path);
    if (store_file_open(store, is_fresh, err) && settle(store, head, source, err)) {
        return store;
    }
    // a file that was not there before and did not become a store is deleted
    if (store->is_made) {
        unlink(path);
    }
    destroy(store);
    return NULL;
}

Store *store_open(const char *path, const StoreHead *head, bool is_fresh, Err *err)
{
    return open_to_work(path, head, is_fresh, NULL, err);
}

Store *store_open_target(const char *path, const StoreHead *head, const char *source, Err *err)
{
    return open_to_work(path, head, false, source, err);
}

Store *store_view(const char *path, Err *err)
{
    Store *store = make_store(path);
    if (store_file_view(store, err) && store_schema_read(store, err)) {
        return store;
    }
    destroy(store);
    return NULL;
}

bool store_close(Store *store, Err *err)
{
    if (store == NULL) {
        return true;
    }
    const bool is_committed = store_commit(store, err);
    destroy(store);
    return is_committed;
}

const Layout *store_layout(const Store *store)
{
    return store->layout;
}

const char *store_key(const Store *store, const char *name)
{
    for (size_t i = 0; i < store->key_count; i++) {
        if (strcmp(store->keys[i].name, name) == 0) {
            return store->keys[i].value;
        }
    }
    return NULL;
}
