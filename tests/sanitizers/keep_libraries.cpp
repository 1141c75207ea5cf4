// SPDX-License-Identifier: LGPL-2.1-or-later
// For LeakSanitizer: keeps libraries loaded to the end of the test program (Vulkan drivers are
// unloaded with the last instance). A leak in an unloaded library has no name, so lsan.supp could
// not match it.
#include <dlfcn.h>
#include <sanitizer/lsan_interface.h>

extern "C" int dlclose(void*) noexcept { return 0; }

// Ignores allocations of libraries while they load: GLib drops its first table of quarks when it
// grows.
static void libraries_begin(int, char**, char**) { __lsan_disable(); }
[[gnu::section(".preinit_array"),
  gnu::used]] static void (*const before_libraries)(int, char**, char**) = libraries_begin;
[[gnu::constructor]] static void libraries_are_loaded() { __lsan_enable(); }
