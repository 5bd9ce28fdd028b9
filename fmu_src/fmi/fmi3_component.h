/* What the functions of FMI 3.0 [fmi3.c, fmi3_*.c] share: the host's side of an instance. */
#ifndef CABLE_FMI3_COMPONENT_H
#define CABLE_FMI3_COMPONENT_H

#include "fmi3Functions.h"
#include "instance.h"

typedef struct {
    Instance *instance;
    fmi3LogMessageCallback log_message; /* may be NULL */
    fmi3IntermediateUpdateCallback intermediate_update;
    fmi3InstanceEnvironment environment;
} Component;

fmi3Status fmi3_status(Status status);

/* Logs the message as an error through the host (nothing if c is NULL); fmi3Error. */
fmi3Status fmi3_refuse(fmi3Instance c, const char *message);

/* The instance if it exists and the call is legal now, else NULL after a message. */
Instance *fmi3_legal(fmi3Instance c, unsigned modes, const char *call);

#endif
