// SHA-256 (FIPS 180-4), by which a browser knows the one script and the one style sheet that a page
// may use.
#pragma once

#include <stddef.h>

enum { SHA256_SIZE = 32 }; // bytes

void report_sha256(const void *bytes, size_t count, unsigned char digest[SHA256_SIZE]);
