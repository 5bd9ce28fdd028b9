/* What the functions of FMI 2.0 [fmi2.c, fmi2_*.c] share: the host's side of an instance. */
#ifndef CABLE_FMI2_COMPONENT_H
#define CABLE_FMI2_COMPONENT_H

#include "fmi2Functions.h"
#include "legal.h"

typedef struct {
    Instance *instance;
    fmi2CallbackLogger logger; /* copied: the host's struct is valid during fmi2Instantiate only */
    fmi2ComponentEnvironment environment;
    char name[]; /* likewise */
} Component;

fmi2Status fmi2_status(Status status);

/* Logs the message as an error through the host (nothing if c is NULL); fmi2Error. */
fmi2Status fmi2_refuse(fmi2Component c, const char *message);

/* The instance if it exists and the call is legal now, else NULL after a message. */
Instance *fmi2_legal(fmi2Component c, Call call);

#endif
