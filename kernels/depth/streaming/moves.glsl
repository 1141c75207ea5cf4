// SPDX-License-Identifier: LGPL-2.1-or-later
// Blocks on their way between the pool and the host.
const uint kMoves = 256u;         // at most in a frame, each way
const uint kBlockWords = 1536u;   // voxels, then colors
// Of blocks that leave, in words: the workgroups of a dispatch over them; how many may, by their distance from the camera; their places
// in the pool.
const uint kDistances = 64u;
const uint kLeaving = 0u, kLeavingDistances = 3u, kLeavingPlaces = kLeavingDistances + kDistances, kLeavingWords = kLeavingPlaces + kMoves;
// Of moved blocks, in words: their keys; for blocks that enter, whether their strokes are out of date, for those that left nothing; blocks.
const uint kMovedKeys = 0u, kMovedOld = kMoves, kMovedBlocks = 2u * kMoves, kMovedWords = kMovedBlocks + kMoves * kBlockWords;
