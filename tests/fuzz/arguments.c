/* From the bytes of a record to the arguments of a call: mostly what a host might mean, and each kind of mistake. */
#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "host.h"

/* What out[] holds before a call: a number that nobody calculates. */
static const uint64_t UNTOUCHED = 0x7ff8dead0000beef;

static double value_of(uint8_t code)
{
    static const double VALUE[] = {0.0,   1.0,    -1.0,    0.1,     -0.1,     0.5,       1e-3,   1e-9,
                                   10.0,  500.0,  -2000.0, 1e5,     1e9,      1e300,     -1e300, DBL_MAX,
                                   1e-17, 1e-300, 5e-324,  NAN,     HUGE_VAL, -HUGE_VAL, 1.7e6,  3.14159,
                                   1e-6,  1e-12,  0.25,    -1e-308, 1e17,     1e12,      1e200,  2.0};
    enum { COUNT = sizeof VALUE / sizeof *VALUE };
    return code < COUNT ? VALUE[code] : (code - 144) * 0.05;
}

static uint32_t reference_of(const Scene *scene, uint8_t code)
{
    static const uint32_t WRONG[] = {UINT32_MAX, 0x80000000u, 0x7fffffffu, 10000u};
    if (code >= 252) return WRONG[code - 252];
    return code % (scene->variables + 2u);
}

static void *block(size_t count, size_t size, bool absent)
{
    if (absent) return NULL;
    void *bytes = calloc(count ? count : 1u, size);
    if (!bytes) give_up("no memory", "for arguments");
    return count ? bytes : realloc(bytes, 1u);
}

/* Names of log categories and values of strings. */
static const char *name_of(uint8_t code)
{
    static const char *const NAME[] = {"logStatusError",    "logStatusWarning", "logStatusDiscard", "logAll", "", NULL,
                                       "100% \xc3\xbc \xff"};
    return NAME[code % (sizeof NAME / sizeof *NAME)];
}

static double untouched(void)
{
    double value;
    memcpy(&value, &UNTOUCHED, sizeof value);
    return value;
}

static void fill(Arguments *a, const Slot *slot, const Record *record, bool sets)
{
    for (size_t k = 0; k < a->count; k++) {
        if (a->references) a->references[k] = reference_of(slot->scene, record->reference[k]);
        if (a->others) a->others[k] = reference_of(slot->scene, record->value[k]);
        if (a->orders) a->orders[k] = record->value[k] % 11 - 1;
        if (a->names) a->names[k] = name_of(record->value[k]);
        if (a->single) ((int64_t *)a->single)[k] = record->value[k] % 6 - 1;
    }
    for (size_t k = 0; k < a->values && a->in; k++) a->in[k] = value_of(record->value[k % 3]);
    for (size_t k = 0; k < a->values && a->out; k++) a->out[k] = untouched();
    for (size_t k = 0; k < a->state_count && a->states; k++)
        a->states[k] = sets ? value_of(record->value[k % 3]) : untouched();
    if (a->bytes && image.bytes) memcpy(a->bytes, image.bytes, fmin(a->byte_count, image.size));
}

void make_arguments(Arguments *a, const Slot *slot, const Record *record, bool sets)
{
    const uint8_t nulls = record->nulls, flags = record->flags;
    const int kept = flags >> 3 & 1;
    memset(a, 0, sizeof *a);
    a->count = record->count & 3;
    a->values = a->count + (record->count >> 2 & 1);
    a->state_count = slot->scene->states + (record->count >> 3 & 1) - (record->count >> 4 & 1);
    a->byte_count = image.size + (record->count >> 5 & 1);
    a->references = block(a->count, sizeof *a->references, nulls & 1);
    a->others = block(a->count, sizeof *a->others, nulls & 1);
    a->orders = block(a->count, sizeof *a->orders, nulls & 2);
    a->names = block(a->count, sizeof *a->names, nulls & 2);
    a->in = block(a->values, sizeof *a->in, nulls & 4);
    a->out = block(a->values, sizeof *a->out, nulls & 8);
    a->states = block(a->state_count, sizeof *a->states, nulls & 16);
    a->single = block(8, sizeof(double), nulls & 32);
    a->bytes = block(a->byte_count, 1, nulls & 64);
    for (int k = 0; k < 3; k++) a->real[k] = value_of(record->value[k]), a->flag[k] = flags >> k & 1;
    a->small = record->value[0] % 6;
    a->state = nulls & 128 ? NULL : slot->state[kept];
    a->state_place = nulls & 128 ? NULL : (void **)&slot->state[kept];
    a->step = record->value[0] ? value_of(record->value[0]) : 0.05;
    a->point = record->value[1]; /* codes of the present time, for the most part: see checked_call() */
    fill(a, slot, record, sets);
}

void check_written(const Arguments *a, bool sets, const char *name)
{
    const double *const written[] = {a->out, a->states};
    const size_t count[] = {a->values, sets ? 0 : a->state_count};
    for (int which = 0; which < 2; which++)
        for (size_t k = 0; k < count[which] && written[which]; k++)
            if (!isfinite(written[which][k]) && memcmp(&written[which][k], &UNTOUCHED, sizeof UNTOUCHED) != 0)
                give_up("OK, but not a finite number", name);
}

void free_arguments(Arguments *a)
{
    void *const blocks[] = {a->references, a->others, a->orders, (void *)a->names, a->in,
                            a->out,        a->states, a->single, a->bytes};
    for (size_t k = 0; k < sizeof blocks / sizeof *blocks; k++) free(blocks[k]);
}
