/* The complete state through either version of FMI, under one face. */
#ifndef STATES_H
#define STATES_H

#include <stddef.h>

typedef struct {
    int (*get)(void *component, void **state);
    int (*set)(void *component, void *state);
    int (*drop)(void *component, void **state);
    int (*size)(void *component, void *state, size_t *size);
    int (*write)(void *component, void *state, void *bytes, size_t size);
    int (*read)(void *component, const void *bytes, size_t size, void **state);
} States;

extern const States FMI2_STATES, FMI3_STATES;

#endif
