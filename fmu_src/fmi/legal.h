/* Which function may be called in which state of an instance: the table is legal.def. */
#ifndef CABLE_LEGAL_H
#define CABLE_LEGAL_H

#include "instance.h"

typedef enum {
#define CALL(function, model_exchange, co_simulation) CALL_##function,
#include "legal.def"
    CALL_COUNT
} Call;

/* Whether the function may be called now; says so if it may not. */
bool instance_allows(Instance *instance, Call call);

#endif
