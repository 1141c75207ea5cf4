// SPDX-License-Identifier: LGPL-2.1-or-later
// For LeakSanitizer: keeps libraries loaded to the end of the test program (Vulkan drivers are
// unloaded with the last instance). A leak in an unloaded library has no name, so lsan.supp could
// not match it.
#include <dlfcn.h>
#include <sanitizer/lsan_interface.h>

#include <string>

extern "C" int dlclose(void*) noexcept { return 0; }

extern "C" [[gnu::weak]] unsigned g_quark_from_string(const char* text);

// Ignores allocations of libraries while they load, and GLib's tables of quarks: it drops a table
// that is full, since others may read it without a lock. One that no test fills is made here.
static void libraries_begin(int, char**, char**) { __lsan_disable(); }
[[gnu::section(".preinit_array"),
  gnu::used]] static void (*const before_libraries)(int, char**, char**) = libraries_begin;
[[gnu::constructor]] static void libraries_are_loaded() {
  constexpr unsigned kQuarks = 20000;
  for (unsigned quark = 0; g_quark_from_string != nullptr && quark < kQuarks;)
    quark = g_quark_from_string(("gst-inverse-test-" + std::to_string(quark)).c_str());
  __lsan_enable();
}
