// For LeakSanitizer: libraries stay loaded to the end of the test program (Vulkan drivers are
// closed with the last instance), for a leak of a library that is gone has no name by which
// lsan.supp could tell it from one of ours.
#include <dlfcn.h>

extern "C" int dlclose(void*) noexcept { return 0; }
