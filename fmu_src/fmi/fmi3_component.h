/* What the functions of FMI 3.0 [fmi3.c, fmi3_*.c] share: the host's side of an instance. */
#ifndef CABLE_FMI3_COMPONENT_H
#define CABLE_FMI3_COMPONENT_H

#include "fmi3Functions.h"
#include "legal.h"

typedef struct {
    Instance *instance;
    fmi3LogMessageCallback log_message; /* may be NULL */
    fmi3InstanceEnvironment environment;
    fmi3IntermediateUpdateCallback intermediate_update; /* Co-Simulation; may be NULL */
    bool may_return_early;                              /* likewise: fmi3DoStep, if the host asks for it */
} Component;

fmi3Status fmi3_status(Status status);

/* Logs the message as an error through the host (nothing if c is NULL); fmi3Error. */
fmi3Status fmi3_refuse(fmi3Instance c, const char *message);

/* The instance if it exists and the call is legal now, else NULL after a message. */
Instance *fmi3_legal(fmi3Instance c, Call call);

/* Call-backs inside a step for these variables, if the host has one; false after a message. */
bool fmi3_listen(Component *component, const fmi3ValueReference references[], size_t count);

/* Of a type that the cable has no variables of: an empty list is fine, anything else a mistake. */
fmi3Status fmi3_no_variables(fmi3Instance c, Call call, size_t count);

#endif
