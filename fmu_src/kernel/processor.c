#include "processor.h"

#if defined(__x86_64__)

#include <stdint.h>

typedef struct {
    uint32_t a, b, c, d;
} Registers;

static Registers cpuid(uint32_t leaf)
{
    Registers r;
    __asm__("cpuid" : "=a"(r.a), "=b"(r.b), "=c"(r.c), "=d"(r.d) : "a"(leaf), "c"(0));
    return r;
}

static uint32_t saved_registers(void)
{
    uint32_t low, high;
    __asm__("xgetbv" : "=a"(low), "=d"(high) : "c"(0));
    return low;
}

/* Intel's manual, volume 1, 14.7.1: CPUID.1:ECX.OSXSAVE[27], XCR0[2:1] = 11b, CPUID.7.0:EBX.AVX2[5]. */
bool processor_has_avx2(void)
{
    if (cpuid(0).a < 7 || !(cpuid(1).c >> 27 & 1u)) return false;
    return (saved_registers() & 6u) == 6u && (cpuid(7).b >> 5 & 1u);
}

#else

bool processor_has_avx2(void)
{
    return false;
}

#endif
