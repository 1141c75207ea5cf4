// SPDX-License-Identifier: LGPL-2.1-or-later
// find_block(): the place of a block in the pool, or kNoBlock. Needs WORD_IN `table` and push.table_mask.
#include "camera/blocks.glsl"

uint find_block(ivec3 block) {
  if (!has_key(block)) return kNoBlock;
  uint key = key_of(block), entry = hash_of(key) & push.table_mask, found = kNoBlock;
  for (uint probe = 0u; probe < kMaxProbes; ++probe) {
    uint other = FETCH1(table, int(2u * entry));
    if (other == key) found = FETCH1(table, int(2u * entry + 1u));
    if (other == key || other == kNoBlock) break;
    entry = (entry + 1u) & push.table_mask;
  }
  return found;
}
