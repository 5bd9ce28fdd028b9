/*
 * The complete state of an instance for its host: taken, put back, and as bytes, whatever the version of FMI [image.h].
 *
 * A state belongs to the instance that made it, and is freed with it at the latest; other instances of the same FMU may
 * take it as well. docs/state.md tells what comes back and what does not.
 */
#ifndef CABLE_STATE_H
#define CABLE_STATE_H

#include "instance.h"

/* What *handle pointed to, if anything, is used again. */
Status state_get(Instance *instance, void **handle);
Status state_set(Instance *instance, const void *handle);
Status state_free(Instance *instance, void **handle); /* NULL, or *handle NULL: nothing to do */

Status state_size(Instance *instance, const void *handle, size_t *size);
Status state_serialize(Instance *instance, const void *handle, uint8_t *bytes, size_t size);
Status state_deserialize(Instance *instance, const uint8_t *bytes, size_t size, void **handle);

/* All that the instance made. */
void states_free(Instance *instance);

#endif
