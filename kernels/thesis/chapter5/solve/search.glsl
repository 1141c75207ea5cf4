// SPDX-License-Identifier: LGPL-2.1-or-later
// The scalars of the line search.
#define SEARCH_ENERGY 0     // without samples, of the last accepted state
#define SEARCH_FACTOR 1     // that the step is to be scaled by
#define SEARCH_SHORTENED 2  // steps of the frame that were shortened
#define SEARCH_START 3      // energy at which the frame starts
#define SEARCH_SIZE 4
