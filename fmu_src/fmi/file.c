#include "file.h"

#if defined(_WIN32)

#include <errno.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <wchar.h>

/* One character; 0xfffd for what is not UTF-8. */
static uint32_t decode(const unsigned char **at)
{
    const unsigned char first = *(*at)++;
    const int more = first < 0x80 ? 0 : first >> 5 == 6 ? 1 : first >> 4 == 14 ? 2 : first >> 3 == 30 ? 3 : -1;
    if (more < 0) return 0xfffd;
    uint32_t code = more == 0 ? first : first & (0x3fu >> more);
    for (int k = 0; k < more; k++) {
        if (**at >> 6 != 2) return 0xfffd;
        code = code << 6 | (*(*at)++ & 0x3fu);
    }
    return code;
}

/* UTF-16 in fresh memory, never more units than bytes; NULL without memory. */
static wchar_t *to_utf16(const char *utf8)
{
    wchar_t *wide = malloc((strlen(utf8) + 1) * sizeof *wide), *out = wide;
    if (!wide) return NULL;
    for (const unsigned char *at = (const unsigned char *)utf8; *at;) {
        const uint32_t code = decode(&at);
        if (code >= 0x10000) {
            *out++ = (wchar_t)(0xd800 + ((code - 0x10000) >> 10));
            *out++ = (wchar_t)(0xdc00 + ((code - 0x10000) & 0x3ff));
        } else {
            *out++ = (wchar_t)code;
        }
    }
    *out = L'\0';
    return wide;
}

FILE *file_open_to_read(const char *utf8_path)
{
    wchar_t *path = to_utf16(utf8_path);
    if (!path) {
        errno = ENOMEM;
        return NULL;
    }
    FILE *file = _wfopen(path, L"rb");
    const int why = errno;
    free(path);
    errno = why;
    return file;
}

#else

FILE *file_open_to_read(const char *utf8_path)
{
    return fopen(utf8_path, "rb");
}

#endif
