// For LeakSanitizer: libraries stay loaded to the end of the test program (Vulkan drivers are
// closed with the last instance), for a leak of a library that is gone has no name by which
// lsan.supp could tell it from one of ours.
#include <dlfcn.h>
#include <sanitizer/lsan_interface.h>

extern "C" int dlclose(void*) noexcept { return 0; }

// Nor counts what libraries allocate as they are loaded: GLib leaves its first table of quarks
// behind when it grows.
static void libraries_begin(int, char**, char**) { __lsan_disable(); }
[[gnu::section(".preinit_array"),
  gnu::used]] static void (*const before_libraries)(int, char**, char**) = libraries_begin;
[[gnu::constructor]] static void libraries_are_loaded() { __lsan_enable(); }
