/* What the processor can do, asked of itself: no library call, since zig's runtime has none. */
#ifndef CABLE_PROCESSOR_H
#define CABLE_PROCESSOR_H

#include <stdbool.h>

/* AVX2, by the processor and by the operating system (which must save the wide registers). False but on x86-64. */
bool processor_has_avx2(void);

#endif
