// SPDX-License-Identifier: LGPL-2.1-or-later
// workgroup_sum(v): the sum over the workgroup, in every invocation, always in the same order. Uniform control flow.
shared vec4 workgroup_partials[256];

vec4 workgroup_sum(vec4 v) {
#ifdef NO_SUBGROUPS
  workgroup_partials[gl_LocalInvocationIndex] = v;
  for (uint live = gl_WorkGroupSize.x; live > 1u;) {
    uint half_live = (live + 1u) / 2u;
    barrier();
    if (gl_LocalInvocationIndex + half_live < live) {
      workgroup_partials[gl_LocalInvocationIndex] += workgroup_partials[gl_LocalInvocationIndex + half_live];
    }
    live = half_live;
  }
  barrier();
  vec4 total = workgroup_partials[0];
#else
  v = subgroupAdd(v);
  if (subgroupElect()) workgroup_partials[gl_SubgroupID] = v;
  barrier();
  vec4 total = vec4(0.0);
  for (uint i = 0u; i < gl_NumSubgroups; ++i) total += workgroup_partials[i];
#endif
  barrier();
  return total;
}
