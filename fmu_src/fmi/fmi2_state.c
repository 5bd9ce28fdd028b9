/* FMI 2.0, getting and setting the complete state [state.h]. */
#include "fmi2_component.h"
#include "state.h"

fmi2Status fmi2GetFMUstate(fmi2Component c, fmi2FMUstate *FMUstate)
{
    Instance *instance = fmi2_legal(c, CALL_fmi2GetFMUstate);
    return instance ? fmi2_status(state_get(instance, FMUstate)) : fmi2Error;
}

fmi2Status fmi2SetFMUstate(fmi2Component c, fmi2FMUstate FMUstate)
{
    Instance *instance = fmi2_legal(c, CALL_fmi2SetFMUstate);
    return instance ? fmi2_status(state_set(instance, FMUstate)) : fmi2Error;
}

fmi2Status fmi2FreeFMUstate(fmi2Component c, fmi2FMUstate *FMUstate)
{
    Instance *instance = fmi2_legal(c, CALL_fmi2FreeFMUstate);
    return instance ? fmi2_status(state_free(instance, FMUstate)) : fmi2Error;
}

fmi2Status fmi2SerializedFMUstateSize(fmi2Component c, fmi2FMUstate FMUstate, size_t *size)
{
    Instance *instance = fmi2_legal(c, CALL_fmi2SerializedFMUstateSize);
    return instance ? fmi2_status(state_size(instance, FMUstate, size)) : fmi2Error;
}

fmi2Status fmi2SerializeFMUstate(fmi2Component c, fmi2FMUstate FMUstate, fmi2Byte serializedState[], size_t size)
{
    Instance *instance = fmi2_legal(c, CALL_fmi2SerializeFMUstate);
    return instance ? fmi2_status(state_serialize(instance, FMUstate, (uint8_t *)serializedState, size)) : fmi2Error;
}

fmi2Status fmi2DeSerializeFMUstate(fmi2Component c, const fmi2Byte serializedState[], size_t size,
                                   fmi2FMUstate *FMUstate)
{
    Instance *instance = fmi2_legal(c, CALL_fmi2DeSerializeFMUstate);
    if (!instance) return fmi2Error;
    return fmi2_status(state_deserialize(instance, (const uint8_t *)serializedState, size, FMUstate));
}
