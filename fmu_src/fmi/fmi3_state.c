/* FMI 3.0, getting and setting the complete state [state.h]. */
#include "fmi3_component.h"
#include "state.h"

fmi3Status fmi3GetFMUState(fmi3Instance c, fmi3FMUState *FMUState)
{
    Instance *instance = fmi3_legal(c, CALL_fmi3GetFMUState);
    return instance ? fmi3_status(state_get(instance, FMUState)) : fmi3Error;
}

fmi3Status fmi3SetFMUState(fmi3Instance c, fmi3FMUState FMUState)
{
    Instance *instance = fmi3_legal(c, CALL_fmi3SetFMUState);
    return instance ? fmi3_status(state_set(instance, FMUState)) : fmi3Error;
}

fmi3Status fmi3FreeFMUState(fmi3Instance c, fmi3FMUState *FMUState)
{
    Instance *instance = fmi3_legal(c, CALL_fmi3FreeFMUState);
    return instance ? fmi3_status(state_free(instance, FMUState)) : fmi3Error;
}

fmi3Status fmi3SerializedFMUStateSize(fmi3Instance c, fmi3FMUState FMUState, size_t *size)
{
    Instance *instance = fmi3_legal(c, CALL_fmi3SerializedFMUStateSize);
    return instance ? fmi3_status(state_size(instance, FMUState, size)) : fmi3Error;
}

fmi3Status fmi3SerializeFMUState(fmi3Instance c, fmi3FMUState FMUState, fmi3Byte serializedState[], size_t size)
{
    Instance *instance = fmi3_legal(c, CALL_fmi3SerializeFMUState);
    return instance ? fmi3_status(state_serialize(instance, FMUState, serializedState, size)) : fmi3Error;
}

fmi3Status fmi3DeserializeFMUState(fmi3Instance c, const fmi3Byte serializedState[], size_t size,
                                   fmi3FMUState *FMUState)
{
    Instance *instance = fmi3_legal(c, CALL_fmi3DeserializeFMUState);
    return instance ? fmi3_status(state_deserialize(instance, serializedState, size, FMUState)) : fmi3Error;
}
