/* Shared by fmi3.c and fmi3_not_offered.c. */
#ifndef CABLE_FMI3_REFUSE_H
#define CABLE_FMI3_REFUSE_H

#include "fmi3Functions.h"

/* Logs the message as an error through the instance's host (nothing if c is NULL); fmi3Error. */
fmi3Status fmi3_refuse(fmi3Instance c, const char *message);

#endif
