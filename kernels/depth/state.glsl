// SPDX-License-Identifier: LGPL-2.1-or-later
// Words of the volume's state. The first three are the workgroups of a dispatch over the listed blocks.
const uint kListed = 0u;    // blocks in the list
const uint kFree = 3u;      // blocks in the stack of free ones
const uint kRefused = 4u;   // places where the last frame found no memory for a block
const uint kOutside = 5u;   // places of the last frame that are beyond what keys can say
const uint kMade = 6u;      // blocks that the last frame made
const uint kStateWords = 8u;
