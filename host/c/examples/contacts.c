/*
 * Prints the contacts of a skin as they come, in the frame of the robot's link: contacts PORT [FRAMES]
 *
 * PORT is /dev/ttyACM0 or tcp:HOST:PORT; without FRAMES it goes on until Ctrl-C. docs/c.md says how to compile it. A
 * controller's loop looks the same: ask for what has come once in each turn, and never wait longer than a turn takes.
 */
#include <dermatome.h>
#include <math.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>

/* Where this skin lies on its link: as [pose] in its skin file. Here: 80 mm above the link's origin, turned upside down. */
static const dermatome_pose POSE = {{0.0, 0.0, 0.08}, {1.0, 0.0, 0.0, 0.0}};

/* A turn of the loop, microseconds. */
enum { TURN_US = 5000 };

static volatile sig_atomic_t interrupted = 0;

static void interrupt(int signal) {
    (void)signal;
    interrupted = 1;
}

/* Says what went wrong with a board. */
static int failed(const dermatome_board *board, int code) {
    char words[300];
    if (dermatome_error(board, words, sizeof words) == DERMATOME_OK) {
        fprintf(stderr, "error %d: %s\n", code, words);
    }
    return code;
}

static void print_contact(const dermatome_contact *contact) {
    dermatome_contact on_link;
    if (dermatome_place(&POSE, contact, &on_link, sizeof on_link) != DERMATOME_OK) {
        return;
    }
    printf("  contact %u at (%.1f, %.1f, %.1f) mm, normal (%.2f, %.2f, %.2f), %.1f mm2", (unsigned)on_link.id,
           1e3 * on_link.position[0], 1e3 * on_link.position[1], 1e3 * on_link.position[2], on_link.normal[0],
           on_link.normal[1], on_link.normal[2], 1e6 * on_link.area);
    if (!isnan(on_link.force)) {
        printf(", %.2f N", on_link.force);
    }
    if (!isnan(on_link.significance)) {
        printf(", %.0f times the noise, +-%.1f mm", on_link.significance, 1e3 * on_link.position_deviation);
    }
    putchar('\n');
}

static void print_frame(const dermatome_frame *frame) {
    uint32_t n;
    printf("frame %lu at %.3f s, %s, lost %lu\n", (unsigned long)frame->sequence, 1e-6 * (double)frame->time_us,
           frame->valid ? "valid" : "not valid", (unsigned long)frame->counts.frames_missing);
    for (n = 0; n < frame->contact_count; n++) {
        print_contact(&frame->contacts[n]);
    }
}

/* The loop, until so many frames have come (0: for ever); it allocates nothing. */
static int run(dermatome_board *board, unsigned long frames) {
    dermatome_frame frame;
    unsigned long seen = 0;
    while (!interrupted && (frames == 0 || seen < frames)) {
        int code = dermatome_wait(board, &frame, sizeof frame, TURN_US);
        if (code == DERMATOME_FRAME) {
            print_frame(&frame);
            seen++;
        } else if (code < 0 && code != DERMATOME_SILENT) {
            return failed(board, code);
        } else {
            /* Nothing new in this turn. A robot that waits for DERMATOME_SILENT long enough should stop here. */
        }
    }
    return DERMATOME_OK;
}

/* Says who the board is and what its skin is, and has it stream. */
static int begin(dermatome_board *board) {
    dermatome_identity identity;
    dermatome_skin skin;
    int code = dermatome_get_identity(board, &identity, sizeof identity);
    if (code == DERMATOME_OK) {
        code = dermatome_get_skin(board, &skin, sizeof skin);
    }
    if (code != DERMATOME_OK) {
        return failed(board, code);
    }
    printf("%s, firmware %s: skin %s, %u electrodes, %u pixels, %.0f frames/s\n", identity.board,
           identity.firmware, skin.name, skin.electrodes, skin.pixels, skin.drive.frame_rate);
    if (!skin.has_reference) {
        puts("no reference yet: the board makes one of its first frames, so touch nothing");
    }
    code = dermatome_start(board, NULL, 0);
    return code == DERMATOME_OK ? code : failed(board, code);
}

int main(int argc, char **argv) {
    dermatome_board *board = NULL;
    char words[300];
    int code;
    if (argc < 2) {
        fprintf(stderr, "usage: %s PORT [FRAMES]\n", argv[0]);
        return 2;
    }
    code = dermatome_open(argv[1], &board, words, sizeof words);
    if (code != DERMATOME_OK) {
        fprintf(stderr, "error %d: %s\n", code, words);
        return 1;
    }
    signal(SIGINT, interrupt);
    code = begin(board);
    if (code == DERMATOME_OK) {
        code = run(board, argc > 2 ? strtoul(argv[2], NULL, 10) : 0);
    }
    dermatome_close(board);
    return code == DERMATOME_OK ? 0 : 1;
}
