/* printable.h - text from files, names among them, that goes to a terminal. */
#ifndef SM_PRINTABLE_H
#define SM_PRINTABLE_H

/* Bytes of the UTF-8 character at `text`; 0 for what a terminal may take for an order (control
 * characters, C1's among them), what is no UTF-8, and what XML may not hold. */
int sm_character(const char *text);

/* Puts '?' for each byte of such, and a blank for an end of line or tabulator. */
void sm_printable(char *text);

#endif
