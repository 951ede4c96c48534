/* A loop whose allocations and threads are counted: loop PORT FRAMES. The linker calls the functions here instead of malloc and
 * its like (--wrap). */
#include <dermatome.h>
#include <dirent.h>
#include <stdio.h>
#include <stdlib.h>

static unsigned long allocations = 0;

void *__real_malloc(size_t size);
void *__real_calloc(size_t count, size_t size);
void *__real_realloc(void *memory, size_t size);
int __real_posix_memalign(void **memory, size_t alignment, size_t size);
void *__real_aligned_alloc(size_t alignment, size_t size);
void *__wrap_malloc(size_t size);
void *__wrap_calloc(size_t count, size_t size);
void *__wrap_realloc(void *memory, size_t size);
int __wrap_posix_memalign(void **memory, size_t alignment, size_t size);
void *__wrap_aligned_alloc(size_t alignment, size_t size);

void *__wrap_malloc(size_t size) {
    allocations++;
    return __real_malloc(size);
}

void *__wrap_calloc(size_t count, size_t size) {
    allocations++;
    return __real_calloc(count, size);
}

void *__wrap_realloc(void *memory, size_t size) {
    allocations++;
    return __real_realloc(memory, size);
}

int __wrap_posix_memalign(void **memory, size_t alignment, size_t size) {
    allocations++;
    return __real_posix_memalign(memory, alignment, size);
}

void *__wrap_aligned_alloc(size_t alignment, size_t size) {
    allocations++;
    return __real_aligned_alloc(alignment, size);
}

static int threads(void) {
    DIR *tasks = opendir("/proc/self/task");
    struct dirent *task;
    int count = 0;
    while (tasks != NULL && (task = readdir(tasks)) != NULL) {
        count += task->d_name[0] != '.';
    }
    if (tasks != NULL) {
        closedir(tasks);
    }
    return count;
}

static int failed(const dermatome_board *board, int code) {
    char words[300] = "";
    dermatome_error(board, words, sizeof words);
    fprintf(stderr, "%s: %s\n", dermatome_code_name(code), words);
    return 1;
}

int main(int argc, char **argv) {
    static float image[DERMATOME_MAX_PIXELS];
    dermatome_options options = {1, 1, 0, 0};
    dermatome_board *board = NULL;
    dermatome_frame frame;
    unsigned long before, inside, contacts = 0, seen = 0, wanted = argc > 2 ? strtoul(argv[2], NULL, 10) : 0;
    int now, code = argc > 1 ? dermatome_open(argv[1], &board, NULL, 0) : DERMATOME_ARGUMENT;
    if (code != DERMATOME_OK || (code = dermatome_start(board, &options, sizeof options)) != DERMATOME_OK) {
        return failed(board, code);
    }
    before = allocations;
    while (seen < wanted) {
        code = seen % 2 == 0 ? dermatome_wait(board, &frame, sizeof frame, 1000)
                             : dermatome_poll(board, &frame, sizeof frame);
        if (code < 0) {
            return failed(board, code);
        }
        if (code == DERMATOME_FRAME) {
            seen++;
            contacts += frame.contact_count;
            if (frame.has_image && dermatome_image(board, image, sizeof image) < 0) {
                return failed(board, code);
            }
            if (seen % 500 == 0 && (code = dermatome_ask_tare(board, 5)) < 0) {
                return failed(board, code);
            }
        }
        code = dermatome_answer(board);
        if (code < 0) {
            return failed(board, code);
        }
    }
    inside = allocations - before;
    now = threads();
    dermatome_close(board);
    printf("%lu frames, %lu contacts: %lu allocations in the loop after %lu before it, %d thread%s\n", seen, contacts,
           inside, before, now, now == 1 ? "" : "s");
    return 0;
}
