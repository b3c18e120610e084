// What did a store hold before a write that was interrupted?
//
// SQLite keeps the former content of each page that it changes in a journal next to the file. A
// writer has SQLite write these pages back. A reader must not write, and reads them from here. The
// format (sqlite.org/fileformat2.html, section 3) is, in sectors:
//
//     header   magic 8, records 4, nonce 4, pages of the file 4, sector size 4, page size 4
//     record   page number 4, content, checksum 4: nonce + every 200th byte from the end
//
// and so on with a header at the next sector. Numbers are big-endian. A record that was incomplete
// at the interruption has a wrong checksum or is not counted, and its page was not yet changed.
#include "commands/study/store_undo.h"

#include <assert.h>
#include <errno.h>
#include <fcntl.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

enum {
    HEADER_SIZE = 28,
    RECORD_EXTRA = 8, // of a record beside the page
    CHECKSUM_STRIDE = 200,
    SECTOR_MIN = 32,
    PAGE_MIN = 512,
    SIZE_MAX_ALLOWED = 65536, // of a page and of a sector
    LOCK_OFFSET = 0x40000000, // where SQLite's locks are: that page is never written
    FIRST_ROOM = 64,
};

static const uint32_t ALL_RECORDS = 0xffffffff; // up to the end of the file
static const unsigned char MAGIC[8] = {0xd9, 0xd5, 0x05, 0xf9, 0x20, 0xa1, 0x63, 0xd7};

typedef struct Journal {
    off_t size;
    off_t offset;
    uint32_t sector_size;
    uint32_t records; // of the header that was read last
    uint32_t nonce;
    unsigned char *page; // owned: room for one
} Journal;

static uint32_t read_big_endian(const unsigned char *bytes)
{
    return (uint32_t)bytes[0] << 24 | (uint32_t)bytes[1] << 16 | (uint32_t)bytes[2] << 8 | bytes[3];
}

static bool is_size(uint32_t size, uint32_t least)
{
    return size >= least && size <= SIZE_MAX_ALLOWED && (size & (size - 1)) == 0;
}

// Reads the header at the next sector. False where there is none.
static bool read_header(Undo *undo, Journal *journal)
{
    unsigned char header[HEADER_SIZE];
    const bool is_first = journal->offset == 0;
    if (!is_first) {
        const off_t sector = (off_t)journal->sector_size;
        journal->offset = ((journal->offset - 1) / sector + 1) * sector;
    }
    if (pread(undo->journal, header, sizeof header, journal->offset) != HEADER_SIZE ||
        memcmp(header, MAGIC, sizeof MAGIC) != 0) {
        return false;
    }
    journal->records = read_big_endian(header + 8);
    journal->nonce = read_big_endian(header + 12);
    if (is_first) {
        undo->page_count = read_big_endian(header + 16);
        journal->sector_size = read_big_endian(header + 20);
        undo->page_size = read_big_endian(header + 24);
        if (!is_size(journal->sector_size, SECTOR_MIN) || !is_size(undo->page_size, PAGE_MIN)) {
            return false;
        }
    }
    if (journal->offset + (off_t)journal->sector_size > journal->size) {
        return false;
    }
    journal->offset += (off_t)journal->sector_size;
    if (journal->records == ALL_RECORDS) {
        journal->records =
            (uint32_t)((journal->size - journal->offset) / (undo->page_size + RECORD_EXTRA));
    }
    return true;
}

static void add_page(Undo *undo, uint32_t number, off_t offset)
{
    if (undo->count == undo->room) {
        undo->room = undo->room == 0 ? FIRST_ROOM : 2 * undo->room;
        undo->pages = realloc(undo->pages, undo->room * sizeof *undo->pages);
        assert(undo->pages != NULL);
    }
    undo->pages[undo->count++] = (UndoPage){number, offset};
}

static uint32_t checksum(const unsigned char *page, uint32_t size, uint32_t nonce)
{
    for (int64_t i = (int64_t)size - CHECKSUM_STRIDE; i > 0; i -= CHECKSUM_STRIDE) {
        nonce += page[i];
    }
    return nonce;
}

// Takes the next record. False where it is not whole, and all that follow are not.
static bool read_record(Undo *undo, Journal *journal)
{
    unsigned char number[4];
    unsigned char sum[4];
    const ssize_t page_size = (ssize_t)undo->page_size;
    const off_t content = journal->offset + 4;
    if (pread(undo->journal, number, 4, journal->offset) != 4 ||
        pread(undo->journal, journal->page, undo->page_size, content) != page_size ||
        pread(undo->journal, sum, 4, content + page_size) != 4) {
        return false;
    }
    journal->offset += page_size + RECORD_EXTRA;
    const uint32_t page = read_big_endian(number);
    if (page == 0 || page == LOCK_OFFSET / undo->page_size + 1) {
        return false;
    }
    // what was put behind the former end is cut off and needs no content
    if (page > undo->page_count) {
        return true;
    }
    if (checksum(journal->page, undo->page_size, journal->nonce) != read_big_endian(sum)) {
        return false;
    }
    add_page(undo, page, content);
    return true;
}

// The record that comes later counts, as where they are written back in turn.
static int compare_pages(const void *a, const void *b)
{
    const UndoPage *left = a;
    const UndoPage *right = b;
    if (left->number != right->number) {
        return left->number < right->number ? -1 : 1;
    }
    return (left->offset > right->offset) - (left->offset < right->offset);
}

static void read_all(Undo *undo, off_t size)
{
    Journal journal = {.size = size};
    undo->journal_size = size;
    undo->is_needed = read_header(undo, &journal);
    if (!undo->is_needed) {
        return;
    }
    journal.page = malloc(undo->page_size);
    assert(journal.page != NULL);
    bool is_whole = true;
    do {
        for (uint32_t i = 0; i < journal.records && is_whole; i++) {
            is_whole = read_record(undo, &journal);
        }
    } while (is_whole && read_header(undo, &journal));
    free(journal.page);
    if (undo->count > 0) {
        qsort(undo->pages, undo->count, sizeof *undo->pages, compare_pages);
    }
}

bool undo_read(Undo *undo, const char *path)
{
    struct stat status;
    *undo = (Undo){.journal = open(path, O_RDONLY | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC)};
    if (undo->journal < 0) {
        return errno == ENOENT;
    }
    const bool is_file = fstat(undo->journal, &status) == 0 && S_ISREG(status.st_mode);
    if (is_file) {
        read_all(undo, status.st_size);
    }
    if (!undo->is_needed) {
        close(undo->journal);
    }
    return is_file;
}

off_t undo_find(const Undo *undo, uint32_t number)
{
    size_t low = 0;
    size_t high = undo->count;
    // the first page of a higher number
    while (low < high) {
        const size_t middle = low + (high - low) / 2;
        if (undo->pages[middle].number <= number) {
            low = middle + 1;
        } else {
            high = middle;
        }
    }
    return low > 0 && undo->pages[low - 1].number == number ? undo->pages[low - 1].offset : -1;
}

void undo_finish(Undo *undo)
{
    if (undo->is_needed) {
        close(undo->journal);
    }
    free(undo->pages);
    *undo = (Undo){0};
}
