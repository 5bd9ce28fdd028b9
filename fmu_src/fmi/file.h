/* Files by their UTF-8 names, on systems whose C library takes other names too. */
#ifndef CABLE_FILE_H
#define CABLE_FILE_H

#include <stdio.h>

/* NULL, and errno, if it cannot be opened. */
FILE *file_open_to_read(const char *utf8_path);

#endif
