/*
 * In front of everything where somebody else compiles an FMU from the sources in its archive, with flags of his own:
 * all files are one translation unit then, but for kernel/avx2.c [models/cablefmu/fmu/sources.py].
 */
#ifndef CABLE_UNIT_H
#define CABLE_UNIT_H

#if !defined(__GNUC__) && !defined(__clang__)
#error "GCC or Clang is expected (on Windows MinGW or clang-cl): the kernel has vectors of two [kernel/ends.h]"
#endif
#if defined(__FAST_MATH__)
#error "-ffast-math takes the digits off sines and the sense off tests for infinity: compile without it"
#endif

/*
 * The same bits as the libraries that come with the FMU: nothing is fused. GCC's vectoriser (12.2) fuses all the same
 * wherever the processor can; in front of the system's headers, so that functions of theirs can still be inlined.
 */
#if defined(__clang__)
#pragma STDC FP_CONTRACT OFF
#else
#pragma GCC optimize("fp-contract=off")
#if defined(__FMA__) || defined(__FMA4__)
#pragma GCC target("no-fma,no-fma4")
#endif
#endif

/* All that the files want of the system, before what follows hides names. */
#include <errno.h>
#include <float.h>
#include <limits.h>
#include <math.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <wchar.h>
#if defined(__SSE2__)
#include <emmintrin.h>
#elif defined(__aarch64__)
#include <arm_neon.h>
#endif

/* Not every importer links libm. Where a root is no instruction that the compiler lets us name, it has to. */
static inline double unit_sqrt(double x)
{
#if defined(__SSE2__)
    return _mm_cvtsd_f64(_mm_sqrt_pd(_mm_set1_pd(x)));
#elif defined(__aarch64__)
    return vget_lane_f64(vsqrt_f64(vdup_n_f64(x)), 0);
#else
    return sqrt(x);
#endif
}

/* A number comes before NaN [C11, F.10.9]. */
static inline double unit_fmax(double x, double y)
{
    return x >= y || y != y ? x : y;
}

static inline double unit_fmin(double x, double y)
{
    return x <= y || y != y ? x : y;
}

#undef sqrt
#undef fmax
#undef fmin
#define sqrt(x)    unit_sqrt(x)
#define fmax(x, y) unit_fmax(x, y)
#define fmin(x, y) unit_fmin(x, y)

/* A library exports what the headers of FMI say, whether or not it is compiled with -fvisibility=hidden. */
#if !defined(_WIN32)
#pragma GCC visibility push(hidden)
#endif

#endif
