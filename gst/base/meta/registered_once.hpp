// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <gst/gst.h>

namespace inverse {

/// Held while a name is looked up and registered: of this process, as each of our plugins has
/// statics of its own.
class RegistrationLock {
 public:
  RegistrationLock() : mutex_(of_process()) { g_rec_mutex_lock(mutex_); }
  ~RegistrationLock() { g_rec_mutex_unlock(mutex_); }
  RegistrationLock(const RegistrationLock&) = delete;
  RegistrationLock& operator=(const RegistrationLock&) = delete;

 private:
  static GRecMutex* of_process() {
    const GQuark name = g_quark_from_string("gst-inverse-registration");
    auto* owner = G_OBJECT(gst_registry_get());
    if (auto* known = static_cast<GRecMutex*>(g_object_get_qdata(owner, name))) return known;
    auto* made = g_new(GRecMutex, 1);
    g_rec_mutex_init(made);
    if (g_object_replace_qdata(owner, name, nullptr, made, nullptr, nullptr)) return made;
    g_rec_mutex_clear(made);  // another thread was first
    g_free(made);
    return static_cast<GRecMutex*>(g_object_get_qdata(owner, name));
  }

  GRecMutex* mutex_;
};

/// What several of our plugins in one process share by its name: the first one's serves all. If its
/// instances hold C++ objects, its name ends with BUILD_STAMP, as builds may lay them out
/// otherwise. `make` registers it if it is not registered yet.
template <typename Make>
GType type_registered_once(const char* name, Make make) {
  const RegistrationLock lock;
  const GType known = g_type_from_name(name);
  return known ? known : make();
}

template <typename Make>
const GstMetaInfo* meta_registered_once(const char* name, Make make) {
  const RegistrationLock lock;
  const GstMetaInfo* known = gst_meta_get_info(name);
  return known ? known : make();
}

}  // namespace inverse
