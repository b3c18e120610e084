// A fingerprint of the very program that runs: another build of one version may give other numbers.
#pragma once

enum { BUILD_PRINT_SIZE = 17 };

// Writes 16 hexadecimal digits.
void build_print(char text[BUILD_PRINT_SIZE]);
