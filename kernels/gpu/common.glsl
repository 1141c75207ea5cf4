// SPDX-License-Identifier: LGPL-2.1-or-later
// What every kernel includes first: workgroup size, and how planes and words are read and written.
//
// The build compiles each kernel for several devices. The fast variant reads through texel buffers (twice as fast as
// storage buffers on lavapipe and cached on GPUs) and reduces with subgroup arithmetic. NO_SUBGROUPS reduces in shared
// memory, for devices whose subgroups cannot add; NO_TEXEL_VIEWS reads storage buffers, for those whose views are short.
#ifndef NO_SUBGROUPS
#extension GL_KHR_shader_subgroup_basic : require
#extension GL_KHR_shader_subgroup_arithmetic : require
#endif

layout(local_size_x_id = 0, local_size_y = 1, local_size_z = 1) in;

// Index of this invocation in a dispatch of a line (gpu::Items), which goes on along y if the device does not allow so
// many workgroups along x. Up to a workgroup and a row of them are beyond the end.
uint line_index() {
  return gl_GlobalInvocationID.y * (gl_NumWorkGroups.x * gl_WorkGroupSize.x) + gl_GlobalInvocationID.x;
}

// Inputs: PLANE_IN(binding, name) then FETCH(name, index). vec4, float and uint elements.
#ifdef NO_TEXEL_VIEWS
#define INVERSE_IN(slot, name, type) \
  layout(set = 0, binding = slot, std430) readonly restrict buffer name##_block { type name##_data[]; }
#define PLANE_IN(slot, name) INVERSE_IN(slot, name, vec4)
#define SCALAR_IN(slot, name) INVERSE_IN(slot, name, float)
#define WORD_IN(slot, name) INVERSE_IN(slot, name, uint)
#define FETCH(name, index) name##_data[index]
#define FETCH1(name, index) name##_data[index]
#else
#define PLANE_IN(slot, name) layout(set = 0, binding = slot) uniform samplerBuffer name
#define SCALAR_IN(slot, name) layout(set = 0, binding = slot) uniform samplerBuffer name
#define WORD_IN(slot, name) layout(set = 0, binding = slot) uniform usamplerBuffer name
#define FETCH(name, index) texelFetch(name, index)
#define FETCH1(name, index) texelFetch(name, index).x
#endif

// Outputs: PLANE_OUT(binding, name) then STORE(name, index, value). INOUT also reads, as a storage buffer.
#define INVERSE_OUT(slot, name, type) \
  layout(set = 0, binding = slot, std430) writeonly restrict buffer name##_block { type name##_data[]; }
#define PLANE_OUT(slot, name) INVERSE_OUT(slot, name, vec4)
#define SCALAR_OUT(slot, name) INVERSE_OUT(slot, name, float)
#define WORD_OUT(slot, name) INVERSE_OUT(slot, name, uint)
#define INVERSE_INOUT(slot, name, type) \
  layout(set = 0, binding = slot, std430) restrict buffer name##_block { type name##_data[]; }
#define PLANE_INOUT(slot, name) INVERSE_INOUT(slot, name, vec4)
#define SCALAR_INOUT(slot, name) INVERSE_INOUT(slot, name, float)
#define WORD_INOUT(slot, name) INVERSE_INOUT(slot, name, uint)
#define STORE(name, index, value) name##_data[index] = (value)
#define LOAD(name, index) name##_data[index]
// Index of an element for STORE and LOAD of a buffer that is bound by rows (gpu::by_rows). The shader has the push
// constants `size`, of the picture that it writes, and `first_row`.
#define BY_ROWS(index) (uint(index) - push.first_row * uint(push.size.x))

// Partial sums: SUM_PARTIALS(target, value) adds a vec4 over each subgroup (NO_SUBGROUPS: workgroup) and stores it in that
// group's slots of `target`, kMaxSubgroups a workgroup (gpu::partial_count); slots that a device does not use stay as they
// were, so zero the buffer once when it is made. A second kernel adds the slots up. Uniform control flow.
layout(constant_id = 99) const uint kMaxSubgroups = 32;  // of a workgroup
#define PARTIAL_BASE \
  ((gl_WorkGroupID.x + gl_NumWorkGroups.x * (gl_WorkGroupID.y + gl_NumWorkGroups.y * gl_WorkGroupID.z)) * kMaxSubgroups)
#ifdef NO_SUBGROUPS
shared vec4 inverse_sum[256];
#define SUM_PARTIALS(name, value)                                                              \
  {                                                                                            \
    inverse_sum[gl_LocalInvocationIndex] = (value);                                            \
    for (uint inverse_live = gl_WorkGroupSize.x; inverse_live > 1u;) {                         \
      uint inverse_half = (inverse_live + 1u) / 2u;                                            \
      barrier();                                                                               \
      if (gl_LocalInvocationIndex + inverse_half < inverse_live)                               \
        inverse_sum[gl_LocalInvocationIndex] += inverse_sum[gl_LocalInvocationIndex + inverse_half]; \
      inverse_live = inverse_half;                                                             \
    }                                                                                          \
    barrier();                                                                                 \
    if (gl_LocalInvocationIndex == 0u) STORE(name, PARTIAL_BASE, inverse_sum[0]);              \
  }
#else
#define SUM_PARTIALS(name, value)                                                  \
  {                                                                                \
    vec4 inverse_total = subgroupAdd(value);                                       \
    if (subgroupElect()) STORE(name, PARTIAL_BASE + gl_SubgroupID, inverse_total); \
  }
#endif
