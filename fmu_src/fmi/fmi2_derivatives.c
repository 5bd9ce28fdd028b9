/* Directional derivatives, and derivatives of outputs in time, of FMI 2.0. */
#include "derivatives.h"
#include "fmi2_component.h"

fmi2Status fmi2GetDirectionalDerivative(fmi2Component c, const fmi2ValueReference vUnknown_ref[], size_t nUnknown,
                                        const fmi2ValueReference vKnown_ref[], size_t nKnown, const fmi2Real dvKnown[],
                                        fmi2Real dvUnknown[])
{
    Instance *instance = fmi2_legal(c, CALL_fmi2GetDirectionalDerivative);
    if (!instance) return fmi2Error;
    if ((nUnknown && (!vUnknown_ref || !dvUnknown)) || (nKnown && (!vKnown_ref || !dvKnown)))
        return fmi2_refuse(c, "fmi2GetDirectionalDerivative: a null pointer was given");
    const References unknowns = {vUnknown_ref, nUnknown}, knowns = {vKnown_ref, nKnown};
    return fmi2_status(instance_directional(instance, unknowns, knowns, dvKnown, dvUnknown));
}

fmi2Status fmi2GetRealOutputDerivatives(fmi2Component c, const fmi2ValueReference vr[], size_t nvr,
                                        const fmi2Integer order[], fmi2Real value[])
{
    Instance *instance = fmi2_legal(c, CALL_fmi2GetRealOutputDerivatives);
    if (!instance) return fmi2Error;
    if (nvr && (!vr || !order || !value))
        return fmi2_refuse(c, "fmi2GetRealOutputDerivatives: a null pointer was given");
    return fmi2_status(instance_output_derivatives(instance, (References){vr, nvr}, order, value));
}
