/* SHA-256 (FIPS 180-4), for the token that binds an FMU's description to its resource file. */
#ifndef CABLE_SHA256_H
#define CABLE_SHA256_H

#include <stddef.h>
#include <stdint.h>

void sha256(const uint8_t *data, size_t size, uint8_t digest[32]);

#endif
