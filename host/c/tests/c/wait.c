/* Counts the turns of a loop that waits 5 ms at most: wait PORT FRAMES. */
#include <dermatome.h>
#include <stdio.h>
#include <stdlib.h>

int main(int argc, char **argv) {
    dermatome_board *board = NULL;
    dermatome_frame frame;
    unsigned long turns = 0, seen = 0, wanted = argc > 2 ? strtoul(argv[2], NULL, 10) : 0;
    int code = argc > 1 ? dermatome_open(argv[1], &board, NULL, 0) : DERMATOME_ARGUMENT;
    if (code == DERMATOME_OK) {
        code = dermatome_start(board, NULL, 0);
    }
    while (code >= 0 && seen < wanted) {
        code = dermatome_wait(board, &frame, sizeof frame, 5000);
        seen += code == DERMATOME_FRAME;
        turns++;
    }
    printf("%lu turns for %lu frames\n", turns, seen);
    dermatome_close(board);
    return code >= 0 ? 0 : 1;
}
