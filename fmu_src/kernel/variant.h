/*
 * The right-hand side is compiled twice: for any processor, and (avx2.c) for x86-64 processors with AVX2, where the
 * compiler runs four links side by side. Both do the same operations in the same order and give the same bits;
 * nothing is fused (-ffp-contract=off). The model says which one is used.
 */
#ifndef CABLE_VARIANT_H
#define CABLE_VARIANT_H

#ifndef VARIANT
#define VARIANT(name) name##_portable
#endif

struct Model;
struct Work;

/* What exists twice, as the rest of the kernel calls it. */
typedef struct {
    void (*orientation)(const struct Model *model, const double *x, struct Work *work);
    void (*derivatives)(const struct Model *model, const double *x, const double *u, struct Work *work,
                        double *derivative);
    void (*combine)(int count, const double *x, int terms, const double *weight, double *const *slope, double *out);
    double (*largest_scaled)(int count, const double *value, const double *x, const double *y);
} Variant;

extern const Variant PORTABLE, AVX2;

/* Before a loop over links that do not depend on each other: the arrays that it reads and writes are distinct. */
#if defined(__clang__)
#define LINKS_ARE_INDEPENDENT _Pragma("clang loop vectorize(assume_safety)")
#elif defined(__GNUC__)
#define LINKS_ARE_INDEPENDENT _Pragma("GCC ivdep")
#else
#define LINKS_ARE_INDEPENDENT
#endif

#endif
