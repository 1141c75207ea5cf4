// SPDX-License-Identifier: LGPL-2.1-or-later
const int kMaxClusters = 16;  // of a palette
