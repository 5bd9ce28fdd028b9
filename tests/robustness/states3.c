/* The complete state through FMI 3.0. */
#include "fmi3Functions.h"
#include "states.h"

static int get(void *component, void **state)
{
    return (int)fmi3GetFMUState(component, state);
}

static int set(void *component, void *state)
{
    return (int)fmi3SetFMUState(component, state);
}

static int drop(void *component, void **state)
{
    return (int)fmi3FreeFMUState(component, state);
}

static int size_of(void *component, void *state, size_t *size)
{
    return (int)fmi3SerializedFMUStateSize(component, state, size);
}

static int write(void *component, void *state, void *bytes, size_t size)
{
    return (int)fmi3SerializeFMUState(component, state, bytes, size);
}

static int read(void *component, const void *bytes, size_t size, void **state)
{
    return (int)fmi3DeserializeFMUState(component, bytes, size, state);
}

const States FMI3_STATES = {get, set, drop, size_of, write, read};
