// SPDX-License-Identifier: LGPL-2.1-or-later
// For LeakSanitizer: keeps libraries loaded to the end of the test program (Vulkan drivers are
// unloaded with the last instance). A leak in an unloaded library has no name, so lsan.supp could
// not match it.
#include <dlfcn.h>
#include <sanitizer/lsan_interface.h>

extern "C" int dlclose(void*) noexcept { return 0; }

// Ignores allocations of libraries while they load.
static void libraries_begin(int, char**, char**) { __lsan_disable(); }
[[gnu::section(".preinit_array"),
  gnu::used]] static void (*const before_libraries)(int, char**, char**) = libraries_begin;
[[gnu::constructor]] static void libraries_are_loaded() { __lsan_enable(); }

// GLib drops its table of quarks when it is full, since others may read it without a lock.
template <typename Function>
static auto without_leaks(const char* name, const char* text) {
  const auto next = reinterpret_cast<Function*>(dlsym(RTLD_NEXT, name));
  __lsan_disable();
  const auto result = next(text);
  __lsan_enable();
  return result;
}
using ToQuark = unsigned(const char*);
using ToInterned = const char*(const char*);
extern "C" unsigned g_quark_from_string(const char* text) {
  return without_leaks<ToQuark>(__func__, text);
}
extern "C" unsigned g_quark_from_static_string(const char* text) {
  return without_leaks<ToQuark>(__func__, text);
}
extern "C" const char* g_intern_string(const char* text) {
  return without_leaks<ToInterned>(__func__, text);
}
extern "C" const char* g_intern_static_string(const char* text) {
  return without_leaks<ToInterned>(__func__, text);
}
