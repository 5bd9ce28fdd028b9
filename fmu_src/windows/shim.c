/*
 * What a DLL needs that is linked without the C run-time's start-up code: an entry point, and the three names that
 * the compiler and <math.h> of mingw take for granted. Everything else comes from ucrtbase.dll, which Windows has.
 */
#include <math.h>
#include <stdint.h>
#include <string.h>

int _fltused = 1; /* the linker looks for it where floating point is used */

int __stdcall DllMainCRTStartup(void *library, unsigned long reason, void *reserved);
int __stdcall DllMainCRTStartup(void *library, unsigned long reason, void *reserved)
{
    (void)library, (void)reason, (void)reserved;
    return 1;
}

/* isfinite() and isnan() of mingw's <math.h> */
int __fpclassify(double x)
{
    uint64_t bits;
    memcpy(&bits, &x, sizeof bits);
    const uint64_t exponent = bits >> 52 & 0x7ffu, fraction = bits & 0xfffffffffffffu;
    if (exponent == 0x7ffu) return fraction ? FP_NAN : FP_INFINITE;
    if (exponent) return FP_NORMAL;
    return fraction ? FP_SUBNORMAL : FP_ZERO;
}

int __isnan(double x)
{
    return x != x;
}
