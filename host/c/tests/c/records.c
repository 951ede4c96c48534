/* Prints sizes of records, and where some of their last fields lie. */
#include <dermatome.h>
#include <stddef.h>
#include <stdio.h>

int main(void) {
    size_t sizes[] = {
        sizeof(dermatome_identity),
        sizeof(dermatome_skin),
        sizeof(dermatome_drive),
        sizeof(dermatome_pixel),
        sizeof(dermatome_pose),
        sizeof(dermatome_options),
        sizeof(dermatome_contact),
        sizeof(dermatome_counts),
        sizeof(dermatome_frame),
        offsetof(dermatome_frame, contacts),
        offsetof(dermatome_contact, strength_deviation),
        offsetof(dermatome_skin, drive),
    };
    size_t n;
    for (n = 0; n < sizeof sizes / sizeof sizes[0]; n++) {
        printf("%lu\n", (unsigned long)sizes[n]);
    }
    return 0;
}
