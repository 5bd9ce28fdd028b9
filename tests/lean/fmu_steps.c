/*
 * An unpacked FMU 2 of folder argv[1] and token argv[2] in Co-Simulation, argv[3] communication steps of 0.1 s, nothing
 * read: for callgrind.
 */
#include <stdlib.h>
#include <string.h>

#include "fmi2Functions.h"

static void log_nothing(fmi2ComponentEnvironment environment, fmi2String name, fmi2Status status, fmi2String category,
                        fmi2String message, ...)
{
    (void)environment, (void)name, (void)status, (void)category, (void)message;
}

int main(int count, char **text)
{
    if (count < 4) return 2;
    const fmi2CallbackFunctions callbacks = {log_nothing, calloc, free, NULL, NULL};
    char place[4096] = "file://";
    if (strlen(text[1]) + 20 > sizeof place) return 2;
    strcat(strcat(place, text[1]), "/resources");
    fmi2Component fmu = fmi2Instantiate("counted", fmi2CoSimulation, text[2], place, &callbacks, fmi2False, fmi2False);
    if (!fmu || fmi2SetupExperiment(fmu, fmi2True, 1e-6, 0.0, fmi2False, 0.0) != fmi2OK) return 1;
    if (fmi2EnterInitializationMode(fmu) != fmi2OK || fmi2ExitInitializationMode(fmu) != fmi2OK) return 1;
    for (int k = 0; k < atoi(text[3]); k++)
        if (fmi2DoStep(fmu, 0.1 * k, 0.1, fmi2True) != fmi2OK) return 1;
    fmi2FreeInstance(fmu);
    return 0;
}
