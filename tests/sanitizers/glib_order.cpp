// SPDX-License-Identifier: LGPL-2.1-or-later
// Happens-before relations of GLib's locks, for ThreadSanitizer. GLib is not instrumented and uses
// futexes, so the sanitizer would report every field guarded by a GLib lock as a race. These
// functions replace GLib's in a test program, annotate the order, and call GLib's own.
#include <dlfcn.h>
#include <glib-object.h>
#include <gst/gst.h>

extern "C" {
void __tsan_acquire(void* address);
void __tsan_release(void* address);
}

namespace {

/// GLib's own function of this name.
template <typename Function>
Function* next(Function*, const char* name) {
  return reinterpret_cast<Function*>(dlsym(RTLD_NEXT, name));
}

}  // namespace

#define NEXT(function) static auto* const next_function = next(&(function), #function)

// A lock that is taken (for sure, or where the call says so) and one that is given back.
#define TAKES(function, Lock) \
  void function(Lock* lock) { \
    NEXT(function);           \
    next_function(lock);      \
    __tsan_acquire(lock);     \
  }
#define MAY_TAKE(function, Lock)                \
  gboolean function(Lock* lock) {               \
    NEXT(function);                             \
    const gboolean taken = next_function(lock); \
    if (taken) __tsan_acquire(lock);            \
    return taken;                               \
  }
#define GIVES(function, Lock) \
  void function(Lock* lock) { \
    NEXT(function);           \
    __tsan_release(lock);     \
    next_function(lock);      \
  }

extern "C" {

TAKES(g_mutex_lock, GMutex)
MAY_TAKE(g_mutex_trylock, GMutex)
GIVES(g_mutex_unlock, GMutex)
TAKES(g_rec_mutex_lock, GRecMutex)
MAY_TAKE(g_rec_mutex_trylock, GRecMutex)
GIVES(g_rec_mutex_unlock, GRecMutex)
TAKES(g_rw_lock_writer_lock, GRWLock)
MAY_TAKE(g_rw_lock_writer_trylock, GRWLock)
GIVES(g_rw_lock_writer_unlock, GRWLock)
TAKES(g_rw_lock_reader_lock, GRWLock)
MAY_TAKE(g_rw_lock_reader_trylock, GRWLock)
GIVES(g_rw_lock_reader_unlock, GRWLock)

void g_cond_wait(GCond* condition, GMutex* lock) {
  NEXT(g_cond_wait);
  __tsan_release(lock);
  next_function(condition, lock);
  __tsan_acquire(lock);
}

gboolean g_cond_wait_until(GCond* condition, GMutex* lock, gint64 end) {
  NEXT(g_cond_wait_until);
  __tsan_release(lock);
  const gboolean signaled = next_function(condition, lock, end);
  __tsan_acquire(lock);
  return signaled;
}

// Dropping the last reference happens after all other drops.
void g_object_unref(gpointer object) {
  NEXT(g_object_unref);
  __tsan_release(object);
  __tsan_acquire(object);
  next_function(object);
}

// So does a write to a buffer of which all others dropped their references.
void gst_mini_object_unref(GstMiniObject* object) {
  NEXT(gst_mini_object_unref);
  __tsan_release(object);
  next_function(object);
}

gboolean gst_mini_object_is_writable(const GstMiniObject* object) {
  NEXT(gst_mini_object_is_writable);
  const gboolean writable = next_function(object);
  if (writable) __tsan_acquire(const_cast<GstMiniObject*>(object));
  return writable;
}

// Harnesses use these to pass on what elements send.
void g_async_queue_push(GAsyncQueue* queue, gpointer data) {
  NEXT(g_async_queue_push);
  __tsan_release(queue);
  next_function(queue, data);
}

gpointer g_async_queue_try_pop(GAsyncQueue* queue) {
  NEXT(g_async_queue_try_pop);
  const gpointer data = next_function(queue);
  __tsan_acquire(queue);
  return data;
}

gpointer g_async_queue_timeout_pop(GAsyncQueue* queue, guint64 timeout) {
  NEXT(g_async_queue_timeout_pop);
  const gpointer data = next_function(queue, timeout);
  __tsan_acquire(queue);
  return data;
}

gboolean(g_once_init_enter)(volatile void* location) {
  NEXT(g_once_init_enter);
  const gboolean first = next_function(location);
  if (!first) __tsan_acquire(const_cast<void*>(location));
  return first;
}

void(g_once_init_leave)(volatile void* location, gsize result) {
  NEXT(g_once_init_leave);
  __tsan_release(const_cast<void*>(location));
  next_function(location, result);
}

}  // extern "C"
