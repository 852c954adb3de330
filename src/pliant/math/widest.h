#pragma once

// One source for several widths of registers; the program takes the widest at start-up. Numbers
// are the same for all of them, since products and sums are never contracted.
#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__)
#define PLIANT_WIDEST __attribute__((target_clones("default", "avx2", "avx512f")))
#else
#define PLIANT_WIDEST
#endif
