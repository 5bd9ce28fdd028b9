#include "text.h"

#include <math.h>
#include <string.h>

void text_start(Text *text)
{
    text->used = 0;
    text->full = false;
    text->line[0] = '\0';
}

/* How much of the string fits, not ending within a character of UTF-8, which a host could not decode. */
static size_t whole_characters(const char *string, size_t room)
{
    while (room && ((unsigned char)string[room] & 0xC0u) == 0x80u) room--;
    return room;
}

void text_add(Text *text, const char *string)
{
    if (!string || text->full) return;
    const size_t room = sizeof text->line - 1 - text->used, wanted = strlen(string);
    text->full = wanted > room;
    const size_t taken = text->full ? whole_characters(string, room) : wanted;
    memcpy(text->line + text->used, string, taken);
    text->used += taken;
    text->line[text->used] = '\0';
}

void text_doubled(const char *string, const char *characters, char doubled[TEXT_DOUBLED_BYTES])
{
    char *out = doubled;
    for (; *string; *out++ = *string++)
        if (strchr(characters, *string)) *out++ = *string;
    *out = '\0';
}

void text_integer(Text *text, uint64_t value)
{
    char digits[21];
    size_t at = sizeof digits - 1;
    digits[at] = '\0';
    do {
        digits[--at] = (char)('0' + value % 10);
        value /= 10;
    } while (value);
    text_add(text, digits + at);
}

/* Value as d.dddddd times 10^exponent; the digits as an integer of seven places. */
static uint64_t seven_digits(double value, int *exponent)
{
    int e = 0;
    while (value >= 10.0) value /= 10.0, e++;
    while (value < 1.0) value *= 10.0, e--;
    uint64_t digits = (uint64_t)(value * 1e6 + 0.5);
    if (digits == 10000000u) digits = 1000000u, e++;
    *exponent = e;
    return digits;
}

void text_number(Text *text, double value)
{
    if (isnan(value)) {
        text_add(text, "nan");
        return;
    }
    if (value < 0.0) text_add(text, "-");
    value = fabs(value);
    if (isinf(value) || value == 0.0) {
        text_add(text, value == 0.0 ? "0" : "inf");
        return;
    }
    int exponent;
    uint64_t digits = seven_digits(value, &exponent);
    int places = 6; /* digits behind the point of d.dddddd */
    while (places > 0 && digits % 10 == 0) digits /= 10, places--;

    const int plain = exponent >= -4 && exponent < 7;
    char mantissa[32];
    size_t at = sizeof mantissa - 1;
    mantissa[at] = '\0';
    int behind = plain ? places - exponent : places;
    for (; behind < 0; behind++) digits *= 10;
    for (int k = 0; k < behind || digits || k == 0; k++) {
        if (k == behind && behind > 0) mantissa[--at] = '.';
        mantissa[--at] = (char)('0' + digits % 10);
        digits /= 10;
    }
    if (mantissa[at] == '.' || (behind > 0 && sizeof mantissa - 1 - at == (size_t)behind)) {
        if (mantissa[at] != '.') mantissa[--at] = '.';
        mantissa[--at] = '0';
    }
    text_add(text, mantissa + at);
    if (plain) return;
    text_add(text, exponent < 0 ? "e-" : "e+");
    text_integer(text, (uint64_t)(exponent < 0 ? -exponent : exponent));
}
