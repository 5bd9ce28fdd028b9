/*
 * Messages without printf: the host's locale must not turn a point into a comma, and a message that is
 * too long is cut behind a whole character, not overrun.
 */
#ifndef CABLE_TEXT_H
#define CABLE_TEXT_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum { TEXT_BYTES = 512, TEXT_DOUBLED_BYTES = 2 * TEXT_BYTES };

typedef struct {
    char line[TEXT_BYTES];
    size_t used;
    bool full; /* something was cut; nothing is added any more */
} Text;

void text_start(Text *text);
void text_add(Text *text, const char *string); /* NULL counts as "" */
void text_integer(Text *text, uint64_t value);
/* The string with each of these characters twice, as hosts want those that mean something to them. */
void text_doubled(const char *string, const char *characters, char doubled[TEXT_DOUBLED_BYTES]);
void text_number(Text *text, double value); /* seven significant digits; nan, inf, -inf by name */

#endif
