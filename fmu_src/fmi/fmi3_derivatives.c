/* Directional and adjoint derivatives, and derivatives of outputs in time, of FMI 3.0. */
#include "derivatives.h"
#include "fmi3_component.h"

/* As many values as references, of an array all its elements, and pointers to them. */
static bool complete(Instance *instance, const fmi3ValueReference references[], size_t count,
                     const fmi3Float64 values[], size_t n)
{
    size_t expected;
    if (count && (!references || !values)) return false;
    return instance_count(instance, references, count, &expected) == STATUS_OK && n == expected;
}

fmi3Status fmi3GetDirectionalDerivative(fmi3Instance c, const fmi3ValueReference unknowns[], size_t nUnknowns,
                                        const fmi3ValueReference knowns[], size_t nKnowns, const fmi3Float64 seed[],
                                        size_t nSeed, fmi3Float64 sensitivity[], size_t nSensitivity)
{
    Instance *instance = fmi3_legal(c, CALL_fmi3GetDirectionalDerivative);
    if (!instance) return fmi3Error;
    if (!complete(instance, unknowns, nUnknowns, sensitivity, nSensitivity) ||
        !complete(instance, knowns, nKnowns, seed, nSeed))
        return fmi3_refuse(c,
                           "fmi3GetDirectionalDerivative: a seed for every known and a sensitivity for every unknown "
                           "are expected, and no null pointers");
    const References of = {unknowns, nUnknowns}, by = {knowns, nKnowns};
    return fmi3_status(instance_directional(instance, of, by, seed, sensitivity));
}

fmi3Status fmi3GetAdjointDerivative(fmi3Instance c, const fmi3ValueReference unknowns[], size_t nUnknowns,
                                    const fmi3ValueReference knowns[], size_t nKnowns, const fmi3Float64 seed[],
                                    size_t nSeed, fmi3Float64 sensitivity[], size_t nSensitivity)
{
    Instance *instance = fmi3_legal(c, CALL_fmi3GetAdjointDerivative);
    if (!instance) return fmi3Error;
    if (!complete(instance, unknowns, nUnknowns, seed, nSeed) ||
        !complete(instance, knowns, nKnowns, sensitivity, nSensitivity))
        return fmi3_refuse(c,
                           "fmi3GetAdjointDerivative: a seed for every unknown and a sensitivity for every known are "
                           "expected, and no null pointers");
    const References of = {unknowns, nUnknowns}, by = {knowns, nKnowns};
    return fmi3_status(instance_adjoint(instance, of, by, seed, sensitivity));
}

fmi3Status fmi3GetOutputDerivatives(fmi3Instance c, const fmi3ValueReference valueReferences[], size_t nValueReferences,
                                    const fmi3Int32 orders[], fmi3Float64 values[], size_t nValues)
{
    Instance *instance = fmi3_legal(c, CALL_fmi3GetOutputDerivatives);
    if (!instance) return fmi3Error;
    if (!complete(instance, valueReferences, nValueReferences, values, nValues) || (nValues && !orders))
        return fmi3_refuse(c,
                           "fmi3GetOutputDerivatives: an order and a value for every output are expected, and no null "
                           "pointers");
    const References outputs = {valueReferences, nValueReferences};
    return fmi3_status(instance_output_derivatives(instance, outputs, orders, values));
}
