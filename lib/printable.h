/* printable.h - texts for people, and what in text from files, names among it, may go to a
 * terminal.
 */
#ifndef SM_PRINTABLE_H
#define SM_PRINTABLE_H

#include <stddef.h>

/* Appends to a text that has room for `size` bytes in all; what does not fit is cut. */
void sm_append(char *text, size_t size, const char *format, ...)
    __attribute__((format(printf, 3, 4)));

/* Bytes of the UTF-8 character at `text`; 0 for what a terminal may take for a command (control
 * characters, C1's among them), what is no UTF-8, and what XML may not hold. */
int sm_character(const char *text);

/* Puts '?' for each byte of such, and a blank for an end of line or tabulator. */
void sm_printable(char *text);

#endif
