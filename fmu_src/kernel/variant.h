/*
 * The right-hand side is compiled twice: for any processor, and (avx2.c) for x86-64 processors with AVX2, where the
 * compiler runs four links side by side. Both do the same operations in the same order and give the same bits;
 * nothing is fused (-ffp-contract=off). dynamics.c chooses when the model is made.
 */
#ifndef CABLE_VARIANT_H
#define CABLE_VARIANT_H

#ifndef VARIANT
#define VARIANT(name) name##_portable
#endif

/* Before a loop over links that do not depend on each other: the arrays that it reads and writes are distinct. */
#if defined(__clang__)
#define LINKS_ARE_INDEPENDENT _Pragma("clang loop vectorize(assume_safety)")
#elif defined(__GNUC__)
#define LINKS_ARE_INDEPENDENT _Pragma("GCC ivdep")
#else
#define LINKS_ARE_INDEPENDENT
#endif

#endif
