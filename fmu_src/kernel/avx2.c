/* The right-hand side once more, for x86-64 processors with AVX2 [variant.h]. */
#include <math.h>
#include <string.h>

#include "combine.h"
#include "dynamics.h"
#include "ends.h"
#include "sincos.h"

#if defined(__x86_64__)

#undef VARIANT
#define VARIANT(name) name##_avx2

#if defined(__clang__)
#pragma clang attribute push(__attribute__((target("avx2"))), apply_to = function)
#elif defined(__GNUC__)
#pragma GCC push_options
#pragma GCC target("avx2")
#endif

#include "chain.c"
#include "combine.c"
#include "derivatives.c"
#include "joints.c"
#include "motion.c"
#include "orientation.c"
#include "sincos.c"
#include "water.c"

#if defined(__clang__)
#pragma clang attribute pop
#elif defined(__GNUC__)
#pragma GCC pop_options
#endif

const Variant AVX2 = {orientation_avx2, cable_derivatives_avx2, combine_avx2, largest_scaled_avx2};

#else

const Variant AVX2 = {orientation_portable, cable_derivatives_portable, combine_portable,
                      largest_scaled_portable}; /* never chosen */

#endif
