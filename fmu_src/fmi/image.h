/*
 * The whole state of an instance as bytes: what it takes to go on elsewhere with the same bits.
 *
 *   "CABLESTA"                     8 bytes
 *   format, layout                 2 x uint32; layout: bytes of all that does not grow with n
 *   version of the library         16 bytes, filled up with zeros
 *   token of the FMU               40 bytes, likewise
 *   n, interface                   2 x uint32
 *   size                           uint64: bytes of all this, without the checksum
 *   mode, time, parameters, inputs, solver memory    int32 and doubles, one member after the other
 *   vectors of 2 (n + 1) doubles   the state, and what the solver will read again
 *   SHA-256 of all this            32 bytes; only where the image leaves the library
 *
 * All little-endian, no padding, no pointers. What can be computed anew to the same bits is not in it: constants of the
 * model, derivatives, outputs, the linearised chain.
 */
#ifndef CABLE_IMAGE_H
#define CABLE_IMAGE_H

#include "instance.h"

enum { IMAGE_CHECKSUM = 32 };

/* Bytes of the instance's image, without the checksum. */
size_t image_size(Instance *instance);
void image_write(Instance *instance, uint8_t *bytes);

/* Whether bytes that image_write() left are an image that this instance can take; else says why not. */
bool image_fits(Instance *instance, const uint8_t *bytes, Text *why);

/* The same of bytes from anywhere, `size` of them with the checksum: they may be anything. */
bool image_is_sound(Instance *instance, const uint8_t *bytes, size_t size, Text *why);

/* After either said yes. Nothing of what the instance was before is left but its host and its memory. */
void image_read(Instance *instance, const uint8_t *bytes);

/* The checksum of `size` bytes, into the 32 behind them. */
void image_seal(uint8_t *bytes, size_t size);

#endif
