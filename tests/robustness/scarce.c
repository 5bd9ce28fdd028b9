/* Here alone the names mean the library's own functions. */
#undef malloc
#undef calloc
#undef free
#undef fopen
#undef fclose

#include <errno.h>
#include <stdatomic.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>

#include "scarce.h"

/* Relaxed: a stronger order would order the threads, and so hide their races from the detector. */
enum { ORDER = memory_order_relaxed };
static atomic_long countdown, in_use;

static bool refused(void)
{
    if (atomic_load_explicit(&countdown, ORDER) == 0) return false;
    if (atomic_fetch_sub_explicit(&countdown, 1, ORDER) != 1) return false;
    errno = ENOMEM;
    return true;
}

static void *counted(void *got)
{
    if (got) atomic_fetch_add_explicit(&in_use, 1, ORDER);
    return got;
}

void *scarce_malloc(size_t size)
{
    return refused() ? NULL : counted(malloc(size));
}

void *scarce_calloc(size_t count, size_t size)
{
    return refused() ? NULL : counted(calloc(count, size));
}

void scarce_free(void *block)
{
    if (block) atomic_fetch_sub_explicit(&in_use, 1, ORDER);
    free(block);
}

FILE *scarce_fopen(const char *path, const char *mode)
{
    return refused() ? NULL : counted(fopen(path, mode));
}

int scarce_fclose(FILE *file)
{
    atomic_fetch_sub_explicit(&in_use, 1, ORDER);
    return fclose(file);
}

void scarce_fail(long k)
{
    atomic_store(&countdown, k);
}

long scarce_in_use(void)
{
    return atomic_load(&in_use);
}
