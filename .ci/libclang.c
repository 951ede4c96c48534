// Reads a header with libclang, as bindgen does: libclang LIBRARY HEADER [CLANG_ARGUMENT...]
// Exits with 2 where the library cannot be loaded, and with 1 where it has something to say of the header.
#include <dlfcn.h>
#include <stdio.h>

int main(int count, char **words) {
    void *library = count > 2 ? dlopen(words[1], RTLD_NOW) : NULL;
    if (!library)
        return 2;
    printf("%s:\n", words[1]);
    fflush(stdout);
    void *(*create_index)(int, int) = dlsym(library, "clang_createIndex");
    void *(*parse)(void *, const char *, char **, int, void *, unsigned, unsigned) =
        dlsym(library, "clang_parseTranslationUnit");
    unsigned (*diagnostics)(void *) = dlsym(library, "clang_getNumDiagnostics");
    if (!create_index || !parse || !diagnostics)
        return 2;
    // The index prints what is wrong.
    void *unit = parse(create_index(0, 1), words[2], words + 3, count - 3, NULL, 0, 0);
    return !unit || diagnostics(unit);
}
