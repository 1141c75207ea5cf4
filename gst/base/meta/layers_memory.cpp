// SPDX-License-Identifier: LGPL-2.1-or-later
#include "layers_memory.hpp"

#include "registered_once.hpp"

namespace inverse {
namespace {

constexpr const char* kName = "GstInverseLayersAllocator";

GstAllocator* allocator();

GstMemory* make(GstMemory* parent, gsize size) {
  GstMemory* memory = g_new0(GstMemory, 1);
  gst_memory_init(memory, GST_MEMORY_FLAG_NOT_MAPPABLE, allocator(), parent, size, 0, 0, size);
  return memory;
}

/// Of a part; a negative size is up to the end.
gsize part_of(const GstMemory* memory, gssize offset, gssize size) {
  return size < 0 ? memory->size - static_cast<gsize>(offset) : static_cast<gsize>(size);
}

GType allocator_type() {
  static const GType type = type_registered_once(kName, [] {
    GTypeInfo info{};
    info.class_size = sizeof(GstAllocatorClass);
    info.class_init = [](gpointer klass, gpointer) {
      static_cast<GstAllocatorClass*>(klass)->alloc =
          [](GstAllocator*, gsize size, GstAllocationParams*) { return make(nullptr, size); };
      static_cast<GstAllocatorClass*>(klass)->free = [](GstAllocator*, GstMemory* memory) {
        g_free(memory);
      };
    };
    info.instance_size = sizeof(GstAllocator);
    info.instance_init = [](GTypeInstance* instance, gpointer) {
      auto* self = reinterpret_cast<GstAllocator*>(instance);
      self->mem_type = "InverseLayers";
      self->mem_map = [](GstMemory*, gsize, GstMapFlags) -> gpointer { return nullptr; };
      self->mem_unmap = [](GstMemory*) {};
      self->mem_copy = [](GstMemory* memory, gssize offset, gssize size) {
        return make(nullptr, part_of(memory, offset, size));
      };
      self->mem_share = [](GstMemory* memory, gssize offset, gssize size) {
        return make(memory->parent ? memory->parent : memory, part_of(memory, offset, size));
      };
      self->mem_is_span = [](GstMemory*, GstMemory*, gsize*) -> gboolean { return FALSE; };
      GST_OBJECT_FLAG_SET(self, GST_ALLOCATOR_FLAG_CUSTOM_ALLOC);
    };
    return g_type_register_static(GST_TYPE_ALLOCATOR, kName, &info, static_cast<GTypeFlags>(0));
  });
  return type;
}

GstAllocator* allocator() {
  static GstAllocator* const one = [] {
    auto* made = static_cast<GstAllocator*>(g_object_new(allocator_type(), nullptr));
    gst_object_ref_sink(made);
    GST_OBJECT_FLAG_SET(made, GST_OBJECT_FLAG_MAY_BE_LEAKED);
    return made;
  }();
  return one;
}

}  // namespace

GstMemory* new_layers_memory(gsize size) { return gst_allocator_alloc(allocator(), size, nullptr); }

}  // namespace inverse
