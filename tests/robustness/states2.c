/* The complete state through FMI 2.0. */
#include "fmi2Functions.h"
#include "states.h"

static int get(void *component, void **state)
{
    return (int)fmi2GetFMUstate(component, state);
}

static int set(void *component, void *state)
{
    return (int)fmi2SetFMUstate(component, state);
}

static int drop(void *component, void **state)
{
    return (int)fmi2FreeFMUstate(component, state);
}

static int size_of(void *component, void *state, size_t *size)
{
    return (int)fmi2SerializedFMUstateSize(component, state, size);
}

static int write(void *component, void *state, void *bytes, size_t size)
{
    return (int)fmi2SerializeFMUstate(component, state, bytes, size);
}

static int read(void *component, const void *bytes, size_t size, void **state)
{
    return (int)fmi2DeSerializeFMUstate(component, bytes, size, state);
}

const States FMI2_STATES = {get, set, drop, size_of, write, read};
