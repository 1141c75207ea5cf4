// SPDX-License-Identifier: LGPL-2.1-or-later
#include "mapped_memory.hpp"

#include <cstring>
#include <exception>
#include <utility>

#include "gst/base/build_stamp.hpp"
#include "gst/base/meta/registered_once.hpp"

namespace inverse {
namespace {

constexpr const char* kName = "GstInverseMappedAllocator-" BUILD_STAMP;

struct Allocator {
  GstAllocator parent;
  std::shared_ptr<gpu::Device>* device;
};

struct Memory {
  GstMemory parent;
  gpu::BufferPtr* words;  // a part shares those of the whole
};

/// Bytes from the start of `words` to the first address that suits; `mask` as in GstMemory.
gsize offset_in(const gpu::BufferPtr& words, gsize prefix, gsize mask) {
  const auto start = reinterpret_cast<guintptr>(words->map());
  return ((start + prefix + mask) & ~mask) - start;
}

GstMemory* make(GstAllocator* allocator, GstMemory* whole, gpu::BufferPtr words, gsize offset,
                gsize size, gsize mask) {
  auto* memory = g_new0(Memory, 1);
  const gsize bytes = words->bytes();
  memory->words = new gpu::BufferPtr(std::move(words));
  const guint flags = whole ? GST_MINI_OBJECT_FLAGS(whole) | GST_MINI_OBJECT_FLAG_LOCK_READONLY : 0;
  gst_memory_init(&memory->parent, static_cast<GstMemoryFlags>(flags), allocator, whole, bytes,
                  mask, offset, size);
  return &memory->parent;
}

const gpu::BufferPtr& words_of(GstMemory* memory) {
  return *reinterpret_cast<Memory*>(memory)->words;
}

GstMemory* allocate(GstAllocator* allocator, gsize size, GstAllocationParams* params) {
  const gsize mask = params->align | gst_memory_alignment;
  const gsize bytes = params->prefix + size + params->padding;
  try {
    const auto& device = *reinterpret_cast<Allocator*>(allocator)->device;
    const auto words = [&](gsize count) {
      return gpu::Buffer::create_by_rows(device, gpu::Element::word, (count + 3) / 4,
                                         gpu::Memory::readback);
    };
    auto made = words(bytes);
    // Mapped memory is aligned for most; a longer one has room for the rest.
    if (offset_in(made, params->prefix, mask) != params->prefix) made = words(bytes + mask);
    memset(made->map(), 0, made->bytes());
    const gsize offset = offset_in(made, params->prefix, mask);
    return make(allocator, nullptr, std::move(made), offset, size, mask);
  } catch (const std::exception& error) {
    GST_WARNING_OBJECT(allocator, "system memory instead of mapped memory: %s", error.what());
    return gst_allocator_alloc(nullptr, size, params);
  }
}

GType allocator_type() {
  static const GType type = type_registered_once(kName, [] {
    GTypeInfo info{};
    info.class_size = sizeof(GstAllocatorClass);
    info.class_init = [](gpointer klass, gpointer) {
      auto* self = static_cast<GstAllocatorClass*>(klass);
      self->alloc = allocate;
      self->free = [](GstAllocator*, GstMemory* memory) {
        delete reinterpret_cast<Memory*>(memory)->words;
        g_free(memory);
      };
      G_OBJECT_CLASS(klass)->finalize = [](GObject* object) {
        delete reinterpret_cast<Allocator*>(object)->device;
        G_OBJECT_CLASS(g_type_class_peek(GST_TYPE_ALLOCATOR))->finalize(object);
      };
    };
    info.instance_size = sizeof(Allocator);
    info.instance_init = [](GTypeInstance* instance, gpointer) {
      auto* self = reinterpret_cast<GstAllocator*>(instance);
      self->mem_type = "InverseMapped";
      self->mem_map = [](GstMemory* memory, gsize, GstMapFlags) { return words_of(memory)->map(); };
      self->mem_unmap = [](GstMemory*) {};
      self->mem_share = [](GstMemory* memory, gssize offset, gssize size) {
        GstMemory* whole = memory->parent ? memory->parent : memory;
        const gsize length =
            size < 0 ? memory->size - static_cast<gsize>(offset) : static_cast<gsize>(size);
        return make(memory->allocator, whole, words_of(memory),
                    memory->offset + static_cast<gsize>(offset), length, memory->align);
      };
    };
    return g_type_register_static(GST_TYPE_ALLOCATOR, kName, &info, static_cast<GTypeFlags>(0));
  });
  return type;
}

}  // namespace

GstAllocator* mapped_allocator(const std::shared_ptr<gpu::Device>& device) {
  auto* made = static_cast<GstAllocator*>(g_object_new(allocator_type(), nullptr));
  gst_object_ref_sink(made);
  reinterpret_cast<Allocator*>(made)->device = new std::shared_ptr<gpu::Device>(device);
  return made;
}

gpu::BufferPtr mapped_words(GstBuffer* buffer) {
  if (gst_buffer_n_memory(buffer) != 1) return nullptr;
  GstMemory* memory = gst_buffer_peek_memory(buffer, 0);
  if (!G_TYPE_CHECK_INSTANCE_TYPE(memory->allocator, allocator_type()) || memory->offset > 0)
    return nullptr;
  return words_of(memory);
}

}  // namespace inverse
